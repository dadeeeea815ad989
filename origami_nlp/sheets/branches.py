"""Ways out of a closed state of a pattern whose flat vertices have degree four or less: its tangent cone, enumerated.

Round a vertex with axes c_i of its creases, where they have been brought, motions d obey sum d_i c_i = 0 to first
order.  Where the axes span space that is all.  Where they lie in a plane (the vertex is flat, or folded flat) they
also obey sum_(i<j) d_i d_j (c_i x c_j) = 0 to second order: for degree four that leaves two lines, its modes.
A way out of a state moves every vertex along one of its modes (or not at all), which is linear once modes are
chosen: all choices are gone through, and those with nothing left, or that lie in another, are cut off early.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from itertools import takewhile

import numpy as np

from origami_nlp.facets import Closure
from origami_nlp.numerics import RANK, cross, null_space
from origami_nlp.pattern import Pattern

MOST_CHOICES = 10_000
"""Choices of modes of some vertices that are carried on to the others."""
MOST_NUMBERS = 20_000_000
"""Of the bases of these choices: 160 MB."""
SAME_WAY = 1e-5
"""Unit directions that differ by less are one."""


@dataclass(frozen=True, eq=False)
class Branches:
    """Ways out of a state.

    Attributes
    ----------
    lines
        Unit directions of ways with one freedom, [L, n]; both senses of each are ways.
    families
        Orthonormal bases of ways with more, [n, k] each.
    reason
        Why the list is not complete; empty where it is.
    """

    lines: np.ndarray
    families: tuple[np.ndarray, ...]
    reason: str = ""

    def open(self, phi: np.ndarray) -> Iterator[np.ndarray]:
        """Yield the lines, and their opposites, that lead from a state [n] to none beyond its fold limits [n]."""
        limit = np.sign(phi) * (math.pi - np.abs(phi) < SAME_WAY)
        for line in self.lines:
            for d in (line, -line):
                if (d * limit <= SAME_WAY).all():
                    yield d


def list_branches(
    pattern: Pattern, phi: np.ndarray | None = None, check: Callable[[], None] = lambda: None
) -> Branches:
    """Enumerate the ways out of a closed state.

    Parameters
    ----------
    pattern
        The pattern.
    phi
        The state [n] [rad]; the reference state without.
    check
        Called every now and then: may raise to end it.

    Returns
    -------
    Branches
        Candidates to second order at each vertex: whether states follow is seen when they are walked.
    """
    n = pattern.creases
    nothing = np.zeros((0, n))
    if phi is None:
        phi = pattern.reference
        if not pattern.is_flat:
            return Branches(nothing, (), "the reference state is not flat")
    if pattern.holes:
        return Branches(nothing, (), "ways round holes are not enumerated")
    modes = list_modes(pattern, phi)
    if any(m is None for m in modes):
        degree = max(len(loop.creases) for loop in pattern.vertices)
        return Branches(nothing, (), f"vertices of degree {degree} have no modes to be enumerated")
    return combine(pattern, [m or [] for m in modes], check)


def list_modes(pattern: Pattern, phi: np.ndarray) -> list[list[np.ndarray] | None]:
    """Return the motions of each vertex of a closed state by itself, as `vertex_modes` does."""
    return [vertex_modes(axes) for axes in Closure(pattern).axes(phi)]


def combine(
    pattern: Pattern,
    modes: Sequence[Sequence[np.ndarray]],
    check: Callable[[], None] = lambda: None,
) -> Branches:
    """Choose a mode at each vertex in all ways that agree on the creases between vertices.

    Parameters
    ----------
    pattern
        The pattern.
    modes
        Of each of its vertices, orthonormal bases [d, k] in the order of its loop's creases.
    check
        Called for each choice: may raise to end it.

    Returns
    -------
    Branches
        What is left of each choice, and lies in no other.
    """
    n = pattern.creases
    place: dict[
        int, int
    ] = {}  # of creases that were met, in rows of the bases: the others are free
    level = [np.zeros((0, 0))]
    for v in by_known(pattern):
        creases = pattern.vertices[v].creases
        new = [c for c in creases if c not in place]
        place.update(zip(new, range(len(place), n), strict=False))
        rows = [place[c] for c in creases]
        after = []
        for basis in level:
            check()
            wide = _widened(basis, len(new))
            here = wide[rows]
            for mode in modes[v]:
                outside = here - mode @ (mode.T @ here)
                if np.abs(outside).max(initial=0.0) < RANK:
                    after.append(wide)
                else:
                    after.append(wide @ null_space(outside, RANK))
        level = _largest(after, check)
        if len(level) > MOST_CHOICES or sum(b.size for b in level) > MOST_NUMBERS:
            most = f"more than {MOST_CHOICES:,}" if len(level) > MOST_CHOICES else "too many"
            reason = f"{most} choices of modes stay open"
            return Branches(np.zeros((0, n)), (), reason)
    rest = [c for c in range(n) if c not in place]
    back = np.argsort([*place, *rest])
    level = [_widened(b, len(rest))[back] for b in level]
    lines = [b[:, 0] / np.linalg.norm(b) for b in level if b.shape[1] == 1]
    return Branches(np.array(lines).reshape(-1, n), tuple(b for b in level if b.shape[1] > 1))


def _widened(basis: np.ndarray, more: int) -> np.ndarray:
    """Return a basis [k, t] with so many further rows that are free, [k + more, t + more]."""
    (k, t) = basis.shape
    wide = np.zeros((k + more, t + more))
    wide[:k, :t], wide[k:, t:] = basis, np.eye(more)
    return wide


def vertex_modes(axes: np.ndarray) -> list[np.ndarray] | None:
    """Return the motions of a vertex to second order.

    Parameters
    ----------
    axes
        Of its creases where they have been brought, [d, 3].

    Returns
    -------
    list of numpy.ndarray
        Orthonormal bases [d, k] of subspaces, whose union they are; None where they are no union of subspaces.
    """
    kernel = null_space(axes.T, RANK)
    products = cross(axes[:, None], axes[None])
    sizes = np.linalg.norm(products.reshape(-1, 3), axis=1)
    axis = products.reshape(-1, 3)[sizes.argmax()]
    size = float(sizes.max())
    if size == 0.0 or np.abs(axes @ (axis / size)).max() > RANK:
        return [kernel]  # of one line, or not in a plane: first order is all there is
    form = np.triu(products @ (axis / size), 1)
    form = kernel.T @ (form + form.T) @ kernel
    dimension = kernel.shape[1]
    zero = np.zeros((len(axes), 0))
    if not form.size or np.abs(form).max() <= RANK:
        return [kernel] if dimension else [zero]
    if dimension == 1:
        return [zero]
    if dimension > 2:
        return None
    values, vectors = np.linalg.eigh(form)
    if values[0] * values[1] > RANK**2:
        return [zero]
    low, high = np.sqrt(np.abs(values))  # y'Fy = 0: high y_2 = +-low y_1 in its axes
    lines = [kernel @ vectors @ np.array([high, s * low]) for s in (1.0, -1.0)]
    return [(u / np.linalg.norm(u))[:, None] for u in lines]


def by_known(pattern: Pattern, cost: Sequence[int] | None = None) -> Iterator[int]:
    """Go through the vertices so that each shares as many creases as can be with those before it, then by a cost."""
    around: dict[int, list[int]] = {}
    for v, loop in enumerate(pattern.vertices):
        for c in loop.creases:
            around.setdefault(c, []).append(v)
    shared = [0] * len(pattern.vertices)
    waiting = [(0, cost[v] if cost else 0, v) for v in range(len(shared))]
    heapify(waiting)
    gone: set[int] = set()
    known: set[int] = set()
    while waiting:
        many, _, v = heappop(waiting)
        if v in gone or -many != shared[v]:
            continue  # a later entry has what it shares now
        gone.add(v)
        yield v
        for c in set(pattern.vertices[v].creases) - known:
            known.add(c)
            for w in around[c]:
                shared[w] += 1
                heappush(waiting, (-shared[w], cost[w] if cost else 0, w))


def _largest(subspaces: list[np.ndarray], check: Callable[[], None]) -> list[np.ndarray]:
    """Keep the subspaces that lie in no other, once: what lies in another leads to nothing else."""
    kept: list[np.ndarray] = []
    for k in sorted({b.shape[1] for b in subspaces if b.shape[1]}, reverse=True):
        check()
        new = [
            b
            for b in subspaces
            if b.shape[1] == k and all(np.abs(b - c @ (c.T @ b)).max() >= SAME_WAY for c in kept)
        ]
        kept += _distinct(new) if new else []
    return kept or subspaces[:1]


def _distinct(subspaces: list[np.ndarray]) -> list[np.ndarray]:
    """Keep one of each of subspaces of one dimension [n, k]."""
    n = len(subspaces[0])
    # equal ones see a fixed vector at the same angle: only neighbours in that order are compared
    seen = np.linalg.norm(np.cos(np.arange(n) ** 2 + 1.0) @ np.array(subspaces), axis=-1)
    order = np.argsort(seen, kind="stable")
    kept: list[int] = []
    for i in order:
        b = subspaces[i]
        close = takewhile(lambda j, i=i: seen[i] - seen[j] < SAME_WAY * n, reversed(kept))  # type: ignore[misc]
        if all(np.abs(b - subspaces[j] @ (subspaces[j].T @ b)).max() >= SAME_WAY for j in close):
            kept.append(int(i))
    return [subspaces[i] for i in sorted(kept)]
