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
from typing import Any

import numpy as np

from origami_nlp.numerics import (
    LEVEL,
    NONZERO,
    RANK,
    RISES,
    SAME_DIRECTION,
    nearest_in_cone,
    nonnegative_least_squares,
    null_space,
)
from origami_nlp.problem import FoldLimits, LoopClosure

MOST_CHOICES = 10_000
"""Choices of subspaces at some loops that are carried on to the others."""
MOST_NUMBERS = 4_000_000
"""Of the bases of these choices: 32 MB, and several times as much while they are chosen."""


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

    def open(self, phi: np.ndarray, limits: FoldLimits) -> Iterator[np.ndarray]:
        """Yield the lines, and their opposites, that lead from a state [n] to none beyond its fold limits [n]."""
        limit = limits.near(phi, SAME_DIRECTION)
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
        # where laws balance each hinge what is left of the torque is rounding, and rises nowhere
        steep = max(RISES * float(np.abs(gradient).max(initial=0.0)), LEVEL)
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

    def is_point(self, rows: np.ndarray) -> bool:
        """Return whether contacts with slopes [r, n], which stay open, leave no direction at all."""
        lengths = np.linalg.norm(rows, axis=1)
        along = self.lines @ rows.T
        if not all((d < -RISES * lengths).any(axis=1).all() for d in (along, -along)):
            return False
        return all(
            _only_zero(rows @ basis / np.maximum(lengths, NONZERO)[:, None])
            for basis in self.families
        )


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


def cone_of(problem: Any, x: np.ndarray) -> TangentCone:
    """Return `tangent_cone` at a closed state [n] of a problem; kept, as states are judged and left along branches."""
    cone: TangentCone = problem.kept(
        "tangent cone", x, lambda: tangent_cone(problem.loops(x), len(x), problem.check_time)
    )
    return cone


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
    # bases in the variables that were met, in this order (the others are free), stacked by dimension
    level = [np.zeros((1, 0, 0))]
    for v in by_known(variables):
        new = [c for c in variables[v].tolist() if c not in place]
        place.update(zip(new, range(len(place), n), strict=False))
        rows = [place[c] for c in variables[v].tolist()]
        level = _largest(_inside(level, len(new), rows, modes[v], check), check)
        many = sum(map(len, level))
        if many > MOST_CHOICES or sum(b.size for b in level) > MOST_NUMBERS:
            most = f"more than {MOST_CHOICES:,}" if many > MOST_CHOICES else "too many"
            reason = f"{most} choices of modes stay open"
            return TangentCone(np.zeros((0, n)), (), reason, split)
    rest = [c for c in range(n) if c not in place]
    back = np.argsort([*place, *rest])
    level = [_widened(b, len(rest))[:, back] for b in level]
    lines = [b[:, :, 0] / np.linalg.norm(b, axis=1) for b in level if b.shape[2] == 1]
    families = tuple(basis for b in level if b.shape[2] > 1 for basis in b)
    return TangentCone(np.concatenate([*lines, np.zeros((0, n))]), families, "", split)


def _widened(bases: np.ndarray, more: int) -> np.ndarray:
    """Return bases [S, k, t] with so many further rows that are free, [S, k + more, t + more]."""
    (many, k, t) = bases.shape
    wide = np.zeros((many, k + more, t + more))
    wide[:, :k, :t], wide[:, k:, t:] = bases, np.eye(more)
    return wide


def _inside(
    level: Sequence[np.ndarray],
    more: int,
    rows: Sequence[int],
    modes: Sequence[np.ndarray],
    check: Callable[[], None],
) -> list[np.ndarray]:
    """Intersect stacks of subspaces [S, k, t] with each mode [d, j] of the next loop, in its rows: by dimension."""
    parts: dict[int, list[tuple[np.ndarray, np.ndarray]]] = {}
    before = 0
    for bases in level:
        wide = _widened(bases, more)
        here = wide[:, rows]
        for m, mode in enumerate(modes):
            check()
            # what a choice has so far must lie in the mode of the next loop: the kernel of its part across that
            outside = here - mode @ (mode.T @ here)
            dimension = np.full(len(wide), wide.shape[2])
            across = np.flatnonzero(np.abs(outside).max(axis=(1, 2), initial=0.0) >= RANK)
            _, s, vt = np.linalg.svd(
                outside[across], full_matrices=outside.shape[1] < outside.shape[2]
            )
            dimension[across] -= (s > RANK).sum(axis=1)
            # in the order of choices: of each, one mode after the other
            turn = (before + np.arange(len(wide))) * len(modes) + m
            for t in sorted(set(dimension.tolist())):
                which = np.flatnonzero(dimension == t)
                found = wide[which]
                if t < wide.shape[2]:
                    kernel = vt[np.searchsorted(across, which), wide.shape[2] - t :]
                    found = found @ kernel.swapaxes(1, 2)
                parts.setdefault(t, []).append((turn[which], found))
        before += len(bases)
    out = []
    for t in sorted(parts, reverse=True):
        turns, found = (np.concatenate(x) for x in zip(*parts[t], strict=True))
        out.append(found[np.argsort(turns)])
    return out


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


def _largest(level: Sequence[np.ndarray], check: Callable[[], None]) -> list[np.ndarray]:
    """Keep of stacks of subspaces [S, k, t], the largest first, those that lie in no other, each once."""
    kept: list[np.ndarray] = []
    for bases in level:
        if not bases.shape[2]:
            continue
        generic = np.cos(np.outer(np.arange(4.0) + 1.0, np.arange(bases.shape[1]) ** 2 + 1.0))
        # where fixed vectors go in each subspace: equal ones take them to the same place
        shadow = (bases @ (bases.swapaxes(1, 2) @ generic[0])[:, :, None])[:, :, 0]
        inside = np.zeros(len(bases), bool)
        # entries off by SAME_DIRECTION move the shadow by no more than this
        most = SAME_DIRECTION * bases.shape[2] * float(np.linalg.norm(generic[0]))
        for larger in (c for stack in kept for c in _blocks(stack, shadow.size)):
            check()
            # what is missing of a shadow, squared, before the entries of that are looked at
            left = (shadow**2).sum(axis=1) - ((shadow @ larger) ** 2).sum(axis=2)
            c, i = np.nonzero((left < bases.shape[1] * most**2) & ~inside)
            inside[i[_lie_in(bases[i], larger[c])]] = True
        seen = shadow @ generic.T
        bases, seen = bases[~inside], seen[~inside]
        if len(bases):
            kept.append(bases[_distinct(bases, seen, check)])
    return kept or [level[0][:1]]


def _blocks(stack: np.ndarray, each: int) -> list[np.ndarray]:
    """Cut a stack such that a block times so many numbers each is at most `MOST_NUMBERS`."""
    many = max(1, MOST_NUMBERS // max(each, 1))
    return [stack[at : at + many] for at in range(0, len(stack), many)]


def _lie_in(b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return whether subspaces with bases [..., k, t] lie in others, [...]."""
    out: np.ndarray = np.abs(b - c @ (c.swapaxes(-2, -1) @ b)).max(axis=(-2, -1)) < SAME_DIRECTION
    return out


def _distinct(bases: np.ndarray, seen: np.ndarray, check: Callable[[], None]) -> np.ndarray:
    """Return which to keep of subspaces [S, k, t] that numbers [S, r], alike where they are equal, distinguish."""
    near = SAME_DIRECTION * bases.shape[1]
    order = np.argsort(seen[:, 0], kind="stable")
    first = np.arange(len(bases))
    # only neighbours in the order of the first number are compared: the next but one, and so on, while any are near
    for apart in range(1, len(bases)):
        check()
        one, other = order[apart:], order[:-apart]
        close = seen[one, 0] - seen[other, 0] < near
        if not close.any():
            break
        close &= (np.abs(seen[one] - seen[other]) < near).all(axis=1)
        one, other = one[close], other[close]
        equal = _lie_in(bases[one], bases[other])
        np.minimum.at(first, one[equal], other[equal])
        np.minimum.at(first, other[equal], one[equal])
    return np.flatnonzero(first == np.arange(len(bases)))


def _only_zero(rows: np.ndarray) -> bool:
    """Return whether rows y >= 0, [r, k], for y = 0 alone: rows that span, with weights > 0, sum to 0 (Stiemke)."""
    rows = rows[np.linalg.norm(rows, axis=1) > SAME_DIRECTION]
    k = rows.shape[1]
    if len(rows) <= k or np.linalg.svd(rows, compute_uv=False)[-1] < RISES:
        return False
    return _rises_on(rows, np.zeros(k), 1.0)


def _rises_on(rows: np.ndarray, gradient: np.ndarray, steep: float) -> bool:
    """Return whether gradient . y > 0 for all y != 0 with rows y >= 0, [r, k].

    So it is where the gradient is a sum of rows with positive factors, and rows span.
    """
    if len(rows) < len(gradient) or np.linalg.svd(rows, compute_uv=False)[-1] < SAME_DIRECTION:
        return False
    aim = gradient - steep * rows.sum(axis=0)
    left = rows.T @ nonnegative_least_squares(rows.T, aim) - aim
    return float(np.abs(left).max()) <= SAME_DIRECTION * steep
