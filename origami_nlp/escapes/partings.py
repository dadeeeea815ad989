"""Rays out of stable states, and where descents from them begin to end elsewhere: partings.

Rays lead along directions, single variables, to the flat state and on, and to other states.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.escapes.terrain import Terrain
from origami_nlp.numerics import OUTSIDE, SETTLED, coarse
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search import at_limits

SECTIONS, ROUNDS = 9, 2
"""States that a step is cut at in one round, and rounds: a step is cut to a hundredth."""
MOST_CONFIRMED = 5
"""Partings from a state that are looked at, those of the least height."""
CERTAIN = 1e-3
"""The highest state of a path is located to this share of its height: printed are two digits."""


def rays(terrain: Terrain, which: Sequence[int]) -> list[tuple[int, np.ndarray]]:
    """Go along directions, turn variables, go to the flat state and on, and to other states."""
    flat, n = np.zeros(terrain.problem.size), terrain.problem.size
    unit = np.eye(n) if n <= 12 else np.zeros((0, n))
    asked, nowhere = list[Any](), np.full(n, math.nan)
    for k in which:
        turns = [*softest_modes(terrain.problem, terrain.minima[k]), *unit, *-unit]
        ways = [*((d, nowhere) for d in turns), *((flat, x) for x in (flat, *terrain.others(k)))]
        # contacts of the state are held, and opened, in turn
        rows = terrain.contacts(terrain.minima[k])
        closed = rows or at_limits(terrain.problem, terrain.minima[k]).any()
        for held in (True, False) if closed else (True,):
            asked += [(k, *way, rows if held else (), not held) for way in ways]
    if not asked:
        return []
    of, along, goals, slots, free = zip(*asked, strict=True)
    given = np.array(along), np.array(goals), slots, np.array(free)
    out = list(zip(of, terrain.walk(terrain.minima[[*of]], *given), strict=True))
    return out + over_flat(out)


def softest_modes(problem: PatternProblem, x: np.ndarray) -> list[np.ndarray]:
    """Return the softest motions of a state that closure allows, fully folded creases held, where they are single."""
    at_limit = np.flatnonzero(problem.fold_limits.room(x) <= OUTSIDE)
    z = problem.kernel(x, at_limit)
    lam, _, _ = problem.multipliers(x, at_limit)
    values, vectors = np.linalg.eigh(z.T @ (problem.hessian(x, lam) @ z))
    if not len(values) or (len(values) > 1 and values[1] - values[0] <= SETTLED):
        return []
    mode = coarse(z @ vectors[:, 0])
    return [mode, -mode]


def over_flat(paths: Iterable[tuple[int, np.ndarray]]) -> list[tuple[int, np.ndarray]]:
    """Join ways from states to the flat state, the shortest of each, to ways from each to every other one.

    Parameters
    ----------
    paths
        States [S, n] with the number of the first.

    Returns
    -------
    list of tuple
        The same of the ways over the flat state.
    """
    to_flat: dict[int, np.ndarray] = {}
    for k, path in paths:
        if not np.abs(path[-1]).max() and (k not in to_flat or len(path) < len(to_flat[k])):
            to_flat[k] = path
    # down to the flat state, and up a path on which another state came to it
    return [
        (k, np.concatenate([path, back[-2::-1]]))
        for k, path in to_flat.items()
        for j, back in to_flat.items()
        if j != k
    ]


@dataclass
class Parting:
    """A way from state k whose descents end there up to `low`, elsewhere from `high` on.

    before: its states up to `low`.  height: the largest energy up to `high`, over that of the state.
    """

    k: int
    before: list[np.ndarray]
    low: np.ndarray
    high: np.ndarray
    height: float


def partings_of(terrain: Terrain, which: Sequence[int]) -> Iterator[tuple[int, list[Parting]]]:
    """Yield partings of each state, cut finer, the lowest first."""
    partings = _partings(terrain, which)
    parts = [p for of in partings.values() for p in of]
    _sharpen(terrain, parts)
    for k, of in partings.items():
        yield k, sorted(of, key=_rank)


def _partings(terrain: Terrain, which: Sequence[int]) -> dict[int, list[Parting]]:
    """Return where descents along rays begin to end elsewhere, by state: the lowest, the lowest first."""
    ways = [(k, ray) for k, ray in rays(terrain, which) if len(ray) > 1]
    tops = [np.maximum.accumulate(terrain.rise(k, ray)) for k, ray in ways]
    ranks = [coarse(top[:, None])[:, 0] for top in tops]
    lower = [np.flatnonzero(terrain.is_lower(k, ray)) for k, ray in ways]
    # of each ray: its first state that is known to be away, or its length, and the first that was not descended from
    first = [
        int(some[0]) if len(some) else len(r) for some, (_, r) in zip(lower, ways, strict=True)
    ]
    begin = [1] * len(ways)
    while some := _next_descents(terrain, [k for k, _ in ways], ranks, first, begin):
        away = _away(terrain, [(ways[r][0], ways[r][1][i]) for r, i in some])
        for (r, i), gone in zip(some, away.tolist(), strict=True):
            begin[r] = i + 1
            first[r] = min(first[r], i) if gone else first[r]
    out: dict[int, list[Parting]] = {}
    for (k, ray), top, at in zip(ways, tops, first, strict=True):
        if at < len(ray):
            part = Parting(k, list(ray[:at]), ray[at - 1], ray[at], float(top[at]))
            out.setdefault(k, []).append(part)
    return {k: sorted(parts, key=_rank)[:MOST_CONFIRMED] for k, parts in out.items()}


def _next_descents(
    terrain: Terrain,
    of: Sequence[int],
    ranks: Sequence[np.ndarray],
    first: Sequence[int],
    begin: Sequence[int],
) -> list[tuple[int, int]]:
    """Return states (ray, place) to descend from next: of rays of each state the lowest, up to `MOST_CONFIRMED`."""
    out: list[tuple[int, int]] = []
    for k in dict.fromkeys(of):
        mine = [r for r, owner in enumerate(of) if owner == k]
        known = sorted(ranks[r][first[r]] for r in mine if first[r] < len(ranks[r]))
        bar = known[MOST_CONFIRMED - 1] if len(known) >= MOST_CONFIRMED else math.inf
        left = ((ranks[r][i], r, i) for r in mine for i in range(begin[r], first[r]))
        some = sorted(state for state in left if state[0] <= bar)
        out += [(r, i) for _, r, i in some[: terrain.together]]
    return out


def _rank(part: Parting) -> float:
    """Return the height, such that of those that are equal but for rounding the one found first comes first."""
    return float(coarse(np.array([part.height]))[0])


def _away(terrain: Terrain, starts: Sequence[tuple[int, np.ndarray]]) -> np.ndarray:
    """Return whether descents from them leave the state, of some number, for good."""
    away = np.array([terrain.is_lower(k, x) for k, x in starts], dtype=bool)
    left = np.flatnonzero(~away).tolist()
    if left:
        ends = terrain.land(np.array([starts[i][1] for i in left]))
        away[left] = [terrain.is_way(starts[i][0], x) for i, x in zip(left, ends, strict=True)]
    return away


def _sharpen(terrain: Terrain, parts: Sequence[Parting]) -> None:
    """Cut the steps in which descents part finer, those of several states together."""
    # each round cuts the step in which descents part into SECTIONS + 1
    even = np.arange(1, SECTIONS + 1) / (SECTIONS + 1)
    # what is left in the first step may be left much sooner
    narrow = 4.0 ** np.arange(-SECTIONS, 0)
    for _ in range(ROUNDS):
        inner = {
            i: terrain.between(p.low, p.high, narrow if p.low is p.before[0] else even)
            for i, p in enumerate(parts)
        }
        cut = {i: x for i, x in inner.items() if x is not None}
        away = iter(_away(terrain, [(parts[i].k, x) for i, xs in cut.items() for x in xs]).tolist())
        for i, xs in cut.items():
            p, points = parts[i], [parts[i].low, *xs, parts[i].high]
            first = [False, *(next(away) for _ in xs), True].index(True)
            p.low, p.high = points[first - 1], points[first]
    for p in parts:
        states = np.array([*p.before, p.low, p.high])
        p.height = float(terrain.rise(p.k, states).max())
