"""Ways out of stable states that climb little: over partings of descents.

Rays lead along directions, single variables, to the flat state and on, and to other states; where descents from them
begin to end elsewhere they part.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.escapes.escape import EscapePath
from origami_nlp.escapes.terrain import Terrain
from origami_nlp.numerics import NONZERO, OUTSIDE, SETTLED, coarse
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search import at_limits

SECTIONS, ROUNDS = 9, 2
"""States that a step is cut at in one round, and rounds: a step is cut to a hundredth."""
MOST_CONFIRMED = 5
"""Partings from a state that are looked at, those of the least height."""
CERTAIN = 1e-3
"""The highest state of a path is located to this share of its height: printed are two digits."""
LONGER = 2.0
"""A step along closed states is longer than its chord, by less than this once steps are short."""


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
    """Join ways [S, n] from states, by number, to the flat state, the shortest of each, to ways to every other one."""
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


def escape_paths(terrain: Terrain, which: Sequence[int]) -> dict[int, EscapePath]:
    """Find an escape path from states of a terrain that climbs little.

    Each state is displaced along rays; where descents begin to end elsewhere is cut finer, and the lowest of these ways
    gone down step by step, which is the way: an upper bound of the barrier.  Descents from either side of where they
    part stay together up to next to a pass: there the way goes across.

    Parameters
    ----------
    terrain
        States, energies and descents.
    which
        Numbers of the states.

    Returns
    -------
    dict
        A way by number, where one was found.
    """
    found = dict[int, EscapePath]()
    for k, parts in partings_of(terrain, which):
        # the lowest first, as long as one may be lower than those before
        for part in parts:
            least = found[k].height if k in found else math.inf
            way = _way(terrain, part) if part.height < least else None
            if way is not None and way.height < least:
                found[k] = way
    return found


def escape_paths_of_each(
    terrain: Terrain, which: Sequence[int]
) -> Iterator[tuple[int, Iterator[EscapePath]]]:
    """Yield escape paths of states by number, as `escape_paths`: all that are gone down, the lowest beginning first."""
    for k, parts in partings_of(terrain, which):
        yield k, filter(None, (_way(terrain, part) for part in parts))


def highest(
    terrain: Terrain, k: int, states: np.ndarray, known: float = 0.0
) -> tuple[float, np.ndarray, np.ndarray] | None:
    """Return an upper bound of the energy along a way over state k, the highest state that was looked at, and all.

    Between two states that are d apart the energy is at most (u + v + L d) / 2, where L is the largest slope along what
    moves; where the step is half of one that hardly turns, the slope along its chord and a share of that across it.
    Steps that may be higher than what was seen, or is `known`, are cut until that is little.  None where a cut does not
    close, is not admissible, or lies aside: then it is no way.
    """
    # states in order along the way, their heights and torques; each cut puts one more in
    x, u = states, terrain.rise(k, states)
    torque, d = terrain.torque(x), terrain.distance(x[:-1], x[1:])
    turns = np.full(len(d), math.inf)  # angle between the halves of the step that each is a half of
    cuts = 0
    while True:
        most = (u[:-1] + u[1:] + _slopes(terrain, x, torque, turns) * d) / 2
        top = float(u.max())
        enough = max(top * (1 + CERTAIN), terrain.floor, known)
        # a longer step is cut in any case: whether it is a way at all
        cut = np.flatnonzero(d > 0.1)
        # 32 cuts in a round, 400 in all
        if not len(cut) and cuts < 400:
            high = np.flatnonzero(most > enough)
            cut = np.sort(high[np.argsort(-coarse(most)[high], kind="stable")[:32]])
        if not len(cut):
            return float(most.max(initial=top)), x[int(np.argmax(u))], x
        cuts += len(cut)
        halves = terrain.between(x[cut], x[cut + 1], 0.5)
        if halves is None:
            return None
        parts = np.array([terrain.distance(x[cut + e], halves) for e in (0, 1)])
        # the middle of a step lies between its ends
        if (parts > 0.75 * d[cut]).any():
            return None
        ways = [terrain.problem.root * (b - a) for a, b in ((x[cut], halves), (halves, x[cut + 1]))]
        turn = np.linalg.norm(np.subtract(*(_unit(way) for way in ways)), axis=1)
        d[cut], turns[cut] = parts[0], turn
        d, turns = np.insert(d, cut + 1, parts[1]), np.insert(turns, cut + 1, turn)
        u = np.insert(u, cut + 1, terrain.rise(k, halves))
        torque = np.insert(torque, cut + 1, terrain.torque(halves), axis=0)
        x = np.insert(x, cut + 1, halves, axis=0)


def _slopes(terrain: Terrain, x: np.ndarray, torque: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Return the largest slope along each step, times how much longer than its chord it may be: what it holds stays."""
    moves = x[:-1] != x[1:]
    chord = _unit(terrain.problem.root * np.diff(x, axis=0))
    unit = 2.0 ** math.frexp(float(np.abs(torque).max()))[1]  # squares in N m may overflow
    ends = [torque[e : len(moves) + e] / unit * moves for e in (0, 1)]
    size = np.maximum(*(np.linalg.norm(end, axis=1) for end in ends))
    along = np.maximum(*(np.abs(np.einsum("ki,ki->k", end, chord)) for end in ends))
    turned = np.minimum(turns, 1.0)
    least = np.minimum(LONGER * size, (along + size * turned) * (1 + turned))
    return np.asarray(unit * np.where(np.isfinite(turns), least, LONGER * size))


def _unit(ways: np.ndarray) -> np.ndarray:
    """Return directions of steps [S, n]; of none nothing."""
    return np.asarray(ways / np.maximum(np.linalg.norm(ways, axis=1), NONZERO)[:, None])


def _way(terrain: Terrain, part: Parting) -> EscapePath | None:
    """Follow the way over a parting, state by state; None where it does not lead elsewhere."""
    k = part.k
    down = terrain.path_down(part.high, lambda x: terrain.is_lower(k, x))
    lower = terrain.is_lower(k, down[-1])
    # lower than the state: any state that this descends to has been reached without climbing
    last = terrain.path_down(down[-1])[-1] if lower else down[-1]
    to = terrain.listed(last) if np.isfinite(last).all() else -1
    if not _is_shown(terrain, down):
        return None
    # beside the state itself what closure and contacts leave open to rounding may be lower: that is nowhere else
    if np.abs(down[-1] - terrain.minima[k]).max() <= SETTLED:
        return None
    if not lower and (to in (k, -1) or not terrain.is_way(k, down[-1])):
        return None
    best, after = highest(terrain, k, np.array([*part.before, part.low, part.high])), 0
    if best is None or best[0] > terrain.worth:
        back = terrain.path_down(part.low)
        if terrain.listed(back[-1]) == k:
            for states, meets in _across(terrain, back, down):
                over = highest(terrain, k, states)
                if over is not None and (best is None or over[0] < best[0]):
                    best, after = over, meets
    if best is None:
        return None
    height, top, states = best
    # what leads down: below the top already, but for what lies between its states
    rest = highest(terrain, k, np.concatenate([states[-1:], down[after + 1 :]]), height)
    if rest is None:
        return None
    way = np.concatenate([states, rest[2][1:]])
    return EscapePath(max(height, rest[0]), top, -1 if to == k else to, way)


def _is_shown(terrain: Terrain, path: np.ndarray) -> bool:
    """Whether no step of a descent [S, n] is longer than it was told to be, and facets cross at none of its states.

    Gaps alone do not see that layers have no order, nor facets that swing through each other about a common line.
    """
    # by a longer step it left the curve or surface that it is on
    jumps = bool((np.abs(np.diff(path, axis=0)) > 0.3).any())
    return not (jumps or any(map(terrain.problem.refuses, path[1:])))


def down_to(terrain: Terrain, state: np.ndarray) -> tuple[np.ndarray, int] | None:
    """Go down carefully to a listed state: states [S, n], and its number; None where that fails, or a step is long."""
    down = terrain.path_down(state)
    to = terrain.listed(down[-1])
    if to < 0 or not _is_shown(terrain, down):
        return None
    return np.concatenate([down, terrain.minima[to][None]]), to


def _across(terrain: Terrain, back: np.ndarray, down: np.ndarray) -> list[tuple[np.ndarray, int]]:
    """Return ways across to the other descent where these part, and where in `down` each ends."""
    apart = np.linalg.norm(back[:, None] - down[None], axis=2)
    # across where both are still side by side, as low as that is
    beside = np.argwhere(apart <= 2 * apart[0, 0])
    i, j = (int(v[-1]) for v in beside[np.lexsort(beside.T)].T)
    ways = [(np.array([*back[i:][::-1], down[j]]), j)] if j else []
    # descents within 0.1 rad are together
    near = apart <= 2 * max(float(apart[0, 0]), 0.1)
    j = int(np.flatnonzero(near.any(axis=0))[-1])
    # the last state of `down` that is near the other descent, and the nearest one of that
    i = int(apart[:, j].argmin())
    return [*ways, (np.array([*back[i:][::-1], down[j]]), j)]
