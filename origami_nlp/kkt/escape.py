"""How much energy it takes to leave a stable state: passes between states, and upper bounds of them from descents.

For whatever has states, energies and descents (`Terrain`).  The **escape barrier** is the least energy that a path to
a state of no higher energy has to climb; where there is none such, to one that is not shallow itself (the elder rule).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal, NamedTuple, TypeAlias

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.kkt.partings import (
    CERTAIN,
    MOST_CONFIRMED,
    SECTIONS,
    Parting,
    listed,
    tracked_partings,
)
from origami_nlp.kkt.terrain import Terrain
from origami_nlp.numerics import NONZERO, SETTLED, coarse

DescentPath: TypeAlias = Callable[[np.ndarray, Callable[[np.ndarray], bool]], np.ndarray]
Method = Literal["exact (traced)", "upper bound (descents)", "not determined", "isolated"]
TRACED: Final = "exact (traced)"
BOUND: Final = "upper bound (descents)"
OPEN: Final = "not determined"
ALONE: Final = "isolated"


@dataclass(frozen=True, repr=False)
class Escape(ShortRepr):
    """What it takes to leave a stable state.

    Attributes
    ----------
    barrier
        Energy that has to be put in [the scene's units]; of a vertex upper bounds are rounded up to two digits.  inf
        where no way leads to another state, nan where it is not determined.  Under an imposed symmetry it is that of
        ways that keep the symmetry.
    method
        ``exact (traced)`` (curves of one degree of freedom), ``upper bound (descents)`` (an explicit escape path: there
        may be lower ones), ``isolated`` (no other state is near: geometry holds it), or ``not determined``.
    why
        What that rests on.
    to
        Number (1-based) of the state that the way leads to; 0 for none, or one that is not listed.
    top
        Fold angles where the way is highest [rad], shape [N]; empty where that is not known.
    shallow
        Whether the barrier is below `SHALLOW` of the energy that it takes to fold every crease by pi.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.miura("pi/3"))
    >>> result.minima[1].escape.method
    'exact (traced)'
    """

    barrier: float
    method: Method
    why: str
    to: int = 0
    top: tuple[float, ...] = field(default=(), repr=False)
    shallow: bool = False

    def __post_init__(self) -> None:
        if math.isnan(self.barrier) and self.method in (TRACED, ALONE):  # read from a file
            object.__setattr__(self, "barrier", math.inf)  # no escape path

    @property
    def known(self) -> bool:
        """Whether there is a number."""
        return math.isfinite(self.barrier)

    def words(self) -> str:
        """Format it for a cell of a table: "0.0123", "<= 0.013", "none" (no escape path), "?" (not determined)."""
        if not self.known:
            return {ALONE: "isolated", OPEN: "?"}.get(self.method, "no escape path")
        return f"<= {rounded_up(self.barrier)}" if self.method == BOUND else f"{self.barrier:.3g}"


def rounded_up(value: float) -> str:
    """Return a positive number with two digits, not below it: an upper bound stays one."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1) if value > 0 else 1.0
    # what rounding, and the accuracy of a bisection, may change does not show
    return f"{math.ceil(value / unit * (1 - SETTLED)) * unit:.2g}"


class EscapePath(NamedTuple):
    """An escape path: how high it climbs over its state, where, and number of the listed state it leads to, or -1.

    states: on the way, [S, n], to where descents in batches take over; empty where they are not kept.
    """

    height: float
    top: np.ndarray
    to: int
    states: np.ndarray = np.zeros((0, 0))


def escape_paths(
    terrain: Terrain,
    which: Sequence[int],
    sections: int = SECTIONS,
    confirmed: int = MOST_CONFIRMED,
) -> dict[int, EscapePath]:
    """Find an escape path from states of a terrain that climbs little.

    Each state is displaced along rays; where descents begin to end elsewhere is cut finer, and the lowest of these ways
    gone down step by step, which is the way: an upper bound of the barrier.  Descents from either side of where they
    part stay together up to next to a pass; where Newton finds that, the way goes over it.

    Parameters
    ----------
    terrain
        States, energies and descents.
    which
        Numbers of the states.
    sections
        That a step is cut at in one round.
    confirmed
        Escape paths from a state that are gone down carefully.

    Returns
    -------
    dict
        A way by number, where one was found.
    """
    found = dict[int, EscapePath]()
    for k, (least, states, to) in terrain.proved_paths(which).items():
        over = highest(terrain, k, states)
        if over is not None and over[0] <= max(least * (1 + CERTAIN), terrain.floor):
            found[k] = EscapePath(over[0], over[1], to, over[2])
    left = [k for k in which if k not in found]
    for k, parts in tracked_partings(terrain, left, sections, confirmed):
        # long steps first: where these lead nowhere else careful ones slide along what contacts leave open
        descents = (terrain.quick_path_down, terrain.path_down)
        ways = (_lowest_way(terrain, parts, path_down) for path_down in descents)
        if (way := next(filter(None, ways), None)) is not None:
            found[k] = way
    return found


def _lowest_way(
    terrain: Terrain, parts: Sequence[Parting], path_down: DescentPath
) -> EscapePath | None:
    """Follow the ways over partings, the lowest first, as long as one may be lower than those before."""
    best: EscapePath | None = None
    for part in parts:
        if best is not None and part.height >= best.height:
            break
        way = _way_by(terrain, part, path_down)
        best = way if best is None or (way is not None and way.height < best.height) else best
    return best


def escape_paths_of_each(
    terrain: Terrain,
    which: Sequence[int],
    sections: int = SECTIONS,
    confirmed: int = MOST_CONFIRMED,
) -> Iterator[tuple[int, Iterator[EscapePath]]]:
    """Yield escape paths of states by number, as `escape_paths`: all that are gone down, the lowest beginning first."""
    for k, parts in tracked_partings(terrain, which, sections, confirmed):
        yield k, filter(None, (_way(terrain, part) for part in parts))


MOST_CUTS, A_ROUND = 400, 32
"""Cuts of a way, and cuts made before the steps that may be highest are looked for again."""
LONG = 0.1
"""A step that is longer [rad] is cut in any case: whether it is a way at all."""


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
    torque, d = terrain.torque(x), terrain.distances(x[:-1], x[1:])
    turns = np.full(len(d), math.inf)  # angle between the halves of the step that each is a half of
    cuts = 0
    while True:
        most = (u[:-1] + u[1:] + _slopes(terrain, x, torque, turns) * d) / 2
        top = float(u.max())
        enough = max(top * (1 + CERTAIN), terrain.floor, known)
        cut = np.flatnonzero(d > LONG)
        if not len(cut) and cuts < MOST_CUTS:
            high = np.flatnonzero(most > enough)
            cut = np.sort(high[np.argsort(-coarse(most)[high], kind="stable")[:A_ROUND]])
        if not len(cut):
            return float(most.max(initial=top)), x[int(np.argmax(u))], x
        cuts += len(cut)
        halves = terrain.middles(x[cut], x[cut + 1])
        if halves is None:
            return None
        parts = np.array([terrain.distances(x[cut + e], halves) for e in (0, 1)])
        if (parts > ASIDE * d[cut]).any():
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
JUMP = 0.3
"""Steps of a descent are no longer [rad], or it left the curve or surface that it is on."""
ASIDE = 0.75
"""The middle of a step is nearer to either end than this share of the step."""


def _way(terrain: Terrain, part: Parting) -> EscapePath | None:
    """Follow the way over a parting, state by state; None where it does not lead elsewhere.

    Long steps first: where these do not lead elsewhere careful ones slide along what contacts leave open.
    """
    descents = (terrain.quick_path_down, terrain.path_down)
    return next(filter(None, (_way_by(terrain, part, down) for down in descents)), None)


def _way_by(terrain: Terrain, part: Parting, path_down: DescentPath) -> EscapePath | None:
    """Follow the way over a parting by one kind of descent."""
    k = part.k
    down = path_down(part.high, lambda x: terrain.is_lower(k, x))
    lower = terrain.is_lower(k, down[-1])
    # gaps alone do not see that layers have no order
    if lower and terrain.problem.refuses(down[-1]):
        return None
    # lower than the state: any state that this descends to has been reached without climbing
    last = _end(terrain, down[-1]) if lower else down[-1]
    to = listed(terrain, last) if np.isfinite(last).all() else -1
    if any(terrain.distance(a, b) > JUMP for a, b in itertools.pairwise(down)):
        return None
    # beside the state itself what closure and contacts leave open to rounding may be lower: that is nowhere else
    if np.abs(down[-1] - terrain.minima[k]).max() <= SETTLED:
        return None
    if not lower and (to in (k, -1) or not terrain.is_way(k, down[-1])):
        return None
    best, after = highest(terrain, k, np.array([*part.before, part.low, part.high])), 0
    if best is None or best[0] > terrain.worth:
        back = path_down(part.low, lambda x: False)
        if listed(terrain, back[-1]) == k:
            for states, meets in _over_passes(terrain, back, down):
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


def _end(terrain: Terrain, state: np.ndarray) -> np.ndarray:
    """Return where a descent from a state ends whose steps are looked at, or, where there is none such, in batches."""
    steps = terrain.quick_path_down(state, lambda _: False)
    return steps[-1] if len(steps) > 1 else terrain.land(state[None])[0]


def down_to(terrain: Terrain, state: np.ndarray) -> tuple[np.ndarray, int] | None:
    """Go down carefully to a listed state: states [S, n], and its number; None where that fails, or a step is long."""
    down = terrain.path_down(state, lambda _: False)
    to = listed(terrain, down[-1])
    if to < 0 or any(terrain.distance(a, b) > JUMP for a, b in itertools.pairwise(down)):
        return None
    return np.concatenate([down, terrain.minima[to][None]]), to


def _over_passes(
    terrain: Terrain, back: np.ndarray, down: np.ndarray
) -> list[tuple[np.ndarray, int]]:
    """Return ways across to the other descent where these part, over passes as well, and where in `down` each ends."""
    apart = np.linalg.norm(back[:, None] - down[None], axis=2)
    # across where both are still side by side, as low as that is
    beside = np.argwhere(apart <= 2 * apart[0, 0])
    i, j = (int(v[-1]) for v in beside[np.lexsort(beside.T)].T)
    ways = [(np.array([*back[i:][::-1], down[j]]), j)] if j else []
    near = apart <= 2 * max(float(apart[0, 0]), TOGETHER)
    j = int(np.flatnonzero(near.any(axis=0))[-1])
    # the last state of `down` that is near the other descent, and the nearest one of that
    i = int(apart[:, j].argmin())
    for middle in ([], *([x] for x in terrain.passes(back[i], down[j]))):
        ways.append((np.array([*back[i:][::-1], *middle, down[j]]), j))
    return ways


TOGETHER = 0.1
"""Descents that are no further apart [rad] are together."""
