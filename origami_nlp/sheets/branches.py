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
from itertools import takewhile

import numpy as np

from origami_nlp.facets import Closure
from origami_nlp.numerics import RANK, cross, null_space
from origami_nlp.pattern import Pattern

MOST_CHOICES = 10_000
"""Choices of modes of some vertices that are carried on to the others."""
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
    level = [np.eye(n)]
    for v in _order(pattern):
        creases = list(pattern.vertices[v].creases)
        after = []
        for basis in level:
            check()
            here = basis[creases]
            for mode in modes[v]:
                outside = here - mode @ (mode.T @ here)
                left = basis if np.abs(outside).max() < RANK else basis @ null_space(outside, RANK)
                if left.shape[1]:
                    after.append(left)
        level = _largest(after)
        if len(level) > MOST_CHOICES:
            reason = f"more than {MOST_CHOICES:,} choices of modes stay open"
            return Branches(np.zeros((0, n)), (), reason)
    lines = [b[:, 0] / np.linalg.norm(b) for b in level if b.shape[1] == 1]
    return Branches(np.array(lines).reshape(-1, n), tuple(b for b in level if b.shape[1] > 1))


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


def _order(pattern: Pattern) -> list[int]:
    """Order the vertices so that each shares as many creases as can be with those before it."""
    left = list(range(len(pattern.vertices)))
    known: set[int] = set()
    order = []
    while left:
        best = max(left, key=lambda v: (len(known & set(pattern.vertices[v].creases)), -v))
        left.remove(best)
        order.append(best)
        known |= set(pattern.vertices[best].creases)
    return order


def _largest(subspaces: list[np.ndarray]) -> list[np.ndarray]:
    """Keep the subspaces that lie in no other, once: what lies in another leads to nothing else."""
    kept: list[np.ndarray] = []
    for k in sorted({b.shape[1] for b in subspaces}, reverse=True):
        new = [
            b
            for b in subspaces
            if b.shape[1] == k and all(np.abs(b - c @ (c.T @ b)).max() >= SAME_WAY for c in kept)
        ]
        kept += _distinct(new) if new else []
    return kept


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
