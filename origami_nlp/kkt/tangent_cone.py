"""The tangent cone where closure loses rank, enumerated: subspaces of motions that every loop allows to second order.

Round a vertex whose closure has full rank first order is all there is.  Where rows w' J of a loop vanish (the vertex is
flat, or folded flat) motions d also obey d' Q d = 0 with Q = sum w_k Hess c_k.  A form of rank two on what first order
allows is a product of two linear ones, or vanishes where both do: the motions are two subspaces, or one.  Degree four
gives two lines, the modes of the vertex.  A motion of several loops chooses a subspace at each, which is linear once
they are chosen: all choices are gone through, and those with nothing left, or that lie in another, are cut off early.
Forms of higher rank are left out: what is listed then contains the cone, and is more.

Where the energy rises to first order along all of it but 0 the state is a strict minimum, whatever its multipliers: a
sequence of lower states that came to it would leave a direction of the cone along which the energy does not rise.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from itertools import takewhile

import numpy as np

from origami_nlp.numerics import (
    NONZERO,
    RANK,
    RISES,
    SAME_DIRECTION,
    nearest_in_cone,
    nonnegative_least_squares,
    null_space,
)
from origami_nlp.problem import LoopClosure

MOST_CHOICES = 10_000
"""Choices of subspaces at some loops that are carried on to the others."""
MOST_NUMBERS = 20_000_000
"""Of the bases of these choices: 160 MB."""


@dataclass(frozen=True, eq=False)
class TangentCone:
    """Motions of a state that closure allows to second order, loop by loop.

    Attributes
    ----------
    lines
        Unit directions where one degree of freedom is left, [L, n]; both senses of each count.
    families
        Orthonormal bases of subspaces with more, [n, k] each.
    reason
        Why nothing is listed; empty where the list contains the tangent cone.
    split
        Whether every loop's motions are a union of subspaces, so that nothing was left out to second order.
    """

    lines: np.ndarray
    families: tuple[np.ndarray, ...]
    reason: str = ""
    split: bool = True

    def open(self, phi: np.ndarray) -> Iterator[np.ndarray]:
        """Yield the lines, and their opposites, that lead from a state [n] to none beyond its fold limits [n]."""
        limit = np.sign(phi) * (math.pi - np.abs(phi) < SAME_DIRECTION)
        for line in self.lines:
            for d in (line, -line):
                if (d * limit <= SAME_DIRECTION).all():
                    yield d

    def within(self, root: np.ndarray) -> TangentCone:
        """Return the same subspaces in the metric y = root x, [n]."""
        lines = self.lines * root
        lines = lines / np.maximum(np.linalg.norm(lines, axis=1, keepdims=True), NONZERO)
        families = tuple(np.linalg.qr(root[:, None] * b)[0] for b in self.families)
        return TangentCone(lines, families, self.reason, self.split)

    def slopes(self, gradient: np.ndarray, rows: np.ndarray) -> tuple[bool, list[np.ndarray], int]:
        """Compare the energy with the directions that contacts leave open.

        Parameters
        ----------
        gradient
            Of the energy, [n].
        rows
            Slopes of contacts that stay open, [r, n].

        Returns
        -------
        rises : bool
            Whether the energy rises to first order along all directions, or there is none: a strict minimum.
        falling : list of numpy.ndarray
            Directions [n] along which it falls.
        dimension : int
            Of the largest subspace in which directions are open.
        """
        if self.reason:
            return False, [], 0
        lengths = np.linalg.norm(rows, axis=1)
        steep = RISES * float(np.abs(gradient).max(initial=0.0))
        rises, falling, dimension = True, [], 0
        # to second order a motion and its opposite are alike; contacts and the energy distinguish them
        for d in (s * line for line in self.lines for s in (1.0, -1.0)):
            if (rows @ d < -RISES * lengths).any():
                continue
            dimension = max(dimension, 1)
            rises &= bool(gradient @ d > steep)
            if gradient @ d < -steep:
                falling.append(d)
        for basis in self.families:
            dimension = max(dimension, basis.shape[1])
            inside = rows @ basis
            inside = inside[np.linalg.norm(inside, axis=1) > SAME_DIRECTION]
            rises &= _rises_on(inside, basis.T @ gradient, steep)
            down = basis @ nearest_in_cone(-basis.T @ gradient, inside)
            if np.linalg.norm(down) > steep:
                falling.append(down)
        return rises, falling, dimension


def tangent_cone(
    loops: Sequence[LoopClosure], n: int, check: Callable[[], None] = lambda: None
) -> TangentCone:
    """List subspaces that contain the tangent cone of a closed state of n variables.

    Parameters
    ----------
    loops
        Closure to second order, loop by loop.
    n
        Number of variables.
    check
        Called every now and then: may raise to end it.

    Returns
    -------
    TangentCone
        Of loops whose motions are no union of subspaces what first order allows is taken.
    """
    known = [loop_modes(loop) for loop in loops]
    modes = [
        [null_space(loop.jacobian, RANK)] if m is None else m
        for loop, m in zip(loops, known, strict=True)
    ]
    split = all(m is not None for m in known)
    return combine([loop.variables for loop in loops], modes, n, check, split)


def combine(
    variables: Sequence[np.ndarray],
    modes: Sequence[Sequence[np.ndarray]],
    n: int,
    check: Callable[[], None] = lambda: None,
    split: bool = True,
) -> TangentCone:
    """Choose a subspace of motions at each loop in all ways that agree on the variables that loops share.

    Parameters
    ----------
    variables
        Of each loop, [d].
    modes
        Of each loop orthonormal bases [d, k].
    n
        Number of variables.
    check
        Called for each choice: may raise to end it.
    split
        Of the result.

    Returns
    -------
    TangentCone
        What is left of each choice, and lies in no other.
    """
    place: dict[int, int] = {}
    level = [
        np.zeros((0, 0))
    ]  # bases in the variables that were met, in this order: the others are free
    for v in by_known(variables):
        new = [c for c in variables[v].tolist() if c not in place]
        place.update(zip(new, range(len(place), n), strict=False))
        rows = [place[c] for c in variables[v].tolist()]
        after = []
        for basis in level:
            check()
            wide = _widened(basis, len(new))
            here = wide[rows]
            for mode in modes[v]:
                # what this choice has so far must lie in the mode of the next loop: the kernel of its part across that
                outside = here - mode @ (mode.T @ here)
                if np.abs(outside).max(initial=0.0) < RANK:
                    after.append(wide)
                else:
                    after.append(wide @ null_space(outside, RANK))
        level = _largest(after, check)
        if len(level) > MOST_CHOICES or sum(b.size for b in level) > MOST_NUMBERS:
            most = f"more than {MOST_CHOICES:,}" if len(level) > MOST_CHOICES else "too many"
            reason = f"{most} choices of modes stay open"
            return TangentCone(np.zeros((0, n)), (), reason, split)
    rest = [c for c in range(n) if c not in place]
    back = np.argsort([*place, *rest])
    level = [_widened(b, len(rest))[back] for b in level]
    lines = [b[:, 0] / np.linalg.norm(b) for b in level if b.shape[1] == 1]
    families = tuple(b for b in level if b.shape[1] > 1)
    return TangentCone(np.array(lines).reshape(-1, n), families, "", split)


def _widened(basis: np.ndarray, more: int) -> np.ndarray:
    """Return a basis [k, t] with so many further rows that are free, [k + more, t + more]."""
    (k, t) = basis.shape
    wide = np.zeros((k + more, t + more))
    wide[:k, :t], wide[k:, t:] = basis, np.eye(more)
    return wide


def loop_modes(loop: LoopClosure) -> list[np.ndarray] | None:
    """Return the motions of a loop to second order.

    Parameters
    ----------
    loop
        Its closure at a state.

    Returns
    -------
    list of numpy.ndarray
        Orthonormal bases [d, k] of subspaces, whose union they are; None where they are no union of subspaces.
    """
    u, values, vt = np.linalg.svd(loop.jacobian)
    rank = int((values > RANK).sum())
    found = [vt[rank:].T]
    for w in u[:, rank:].T:
        # w' J = 0, so that w . c has no part of first order, and d' (sum w_k Hess c_k) d is the first that counts
        form = np.einsum("k,kij->ij", w, loop.hessians)
        parts = [_split(form, basis) for basis in found]
        if any(p is None for p in parts):
            return None
        found = [basis for part in parts for basis in part or ()]
    return found


def _split(form: np.ndarray, basis: np.ndarray) -> list[np.ndarray] | None:
    """Return subspaces of the span of a basis [d, k] whose union is where d' Q d vanishes; None: there are none."""
    values, vectors = np.linalg.eigh(basis.T @ form @ basis)
    low, high = np.flatnonzero(values < -RANK), np.flatnonzero(values > RANK)
    if not len(low) or not len(high):  # of one sign: only where every part vanishes
        return [basis @ vectors[:, np.abs(values) <= RANK]]
    if len(low) > 1 or len(high) > 1:
        return None
    still = vectors[:, np.abs(values) <= RANK]
    a, b = math.sqrt(-values[low[0]]), math.sqrt(values[high[0]])  # (b y_2)^2 = (a y_1)^2
    length = math.hypot(a, b)
    lines = [(b * vectors[:, low[0]] + s * a * vectors[:, high[0]]) / length for s in (1.0, -1.0)]
    return [basis @ np.column_stack([still, line]) for line in lines]


def by_known(variables: Sequence[np.ndarray], cost: Sequence[int] | None = None) -> Iterator[int]:
    """Go through loops so that each shares as many variables as can be with those before it, then by a cost."""
    sets = [set(map(int, v)) for v in variables]
    around: dict[int, list[int]] = {}
    for v, loop in enumerate(sets):
        for c in loop:
            around.setdefault(c, []).append(v)
    shared = [0] * len(sets)
    waiting = [(0, cost[v] if cost else 0, v) for v in range(len(sets))]
    heapify(waiting)
    gone: set[int] = set()
    known: set[int] = set()
    while waiting:
        many, _, v = heappop(waiting)
        if v in gone or -many != shared[v]:
            continue  # a later entry has what it shares now
        gone.add(v)
        yield v
        for c in sets[v] - known:
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
            if b.shape[1] == k
            and all(np.abs(b - c @ (c.T @ b)).max() >= SAME_DIRECTION for c in kept)
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
        close = takewhile(lambda j, i=i: seen[i] - seen[j] < SAME_DIRECTION * n, reversed(kept))  # type: ignore[misc]
        if all(
            np.abs(b - subspaces[j] @ (subspaces[j].T @ b)).max() >= SAME_DIRECTION for j in close
        ):
            kept.append(int(i))
    return [subspaces[i] for i in sorted(kept)]


def _rises_on(rows: np.ndarray, gradient: np.ndarray, steep: float) -> bool:
    """Return whether gradient . y > 0 for all y != 0 with rows y >= 0, [r, k].

    So it is where the gradient is a sum of rows with positive factors, and rows span.
    """
    if len(rows) < len(gradient) or np.linalg.svd(rows, compute_uv=False)[-1] < SAME_DIRECTION:
        return False
    aim = gradient - steep * rows.sum(axis=0)
    left = rows.T @ nonnegative_least_squares(rows.T, aim) - aim
    return float(np.abs(left).max()) <= SAME_DIRECTION * steep
