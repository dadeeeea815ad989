"""Ways out of stable states that climb little: over partings of descents, and over the flat state."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from origami_nlp.escapes.escape import EscapePath
from origami_nlp.escapes.partings import CERTAIN, Parting, partings_of
from origami_nlp.escapes.terrain import Terrain
from origami_nlp.numerics import NONZERO, SETTLED, coarse


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


LONGER = 2.0
"""A step along closed states is longer than its chord, by less than this once steps are short."""


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
