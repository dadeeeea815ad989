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
from origami_nlp.kkt.terrain import Terrain
from origami_nlp.numerics import NEAR_SINGULAR_TOL, SETTLED, coarse

DescentPath: TypeAlias = Callable[[np.ndarray, Callable[[np.ndarray], bool]], np.ndarray]
Method = Literal[
    "exact (traced)", "merge tree", "upper bound (descents)", "not determined", "isolated"
]
TRACED: Final = "exact (traced)"
TREE: Final = "merge tree"
BOUND: Final = "upper bound (descents)"
OPEN: Final = "not determined"
ALONE: Final = "isolated"
SECTIONS, ROUNDS = 9, 2
"""States that a step is cut at in one round, and rounds: a step is cut to a hundredth."""
MOST_CONFIRMED = 5
"""Escape paths from a state that are gone down carefully, the one of the least height first."""


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
        ``exact (traced)`` (curves of one degree of freedom), ``merge tree`` (of a graph of states, with exact passes),
        ``upper bound (descents)`` (an explicit escape path: there may be lower ones), ``isolated`` (no other state is
        near: geometry holds it), or ``not determined``.
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
    found = (
        (k, next(ways, None))
        for k, ways in escape_paths_of_each(terrain, which, sections, confirmed)
    )
    return {k: way for k, way in found if way is not None}


def escape_paths_of_each(
    terrain: Terrain,
    which: Sequence[int],
    sections: int = SECTIONS,
    confirmed: int = MOST_CONFIRMED,
) -> Iterator[tuple[int, Iterator[EscapePath]]]:
    """Yield escape paths of states by number, as `escape_paths`: all that are gone down, the lowest beginning first."""
    partings = _partings(terrain, which, confirmed)
    _sharpen(terrain, [p for parts in partings.values() for p in parts], sections)
    for k, parts in partings.items():
        found = (_way(terrain, part) for part in sorted(parts, key=_rank))
        yield k, filter(None, found)


@dataclass
class _Parting:
    """A ray of state k whose descents end there up to `low`, elsewhere from `high` on; before: its states up to `low`.

    height: the largest energy up to `high`.
    """

    k: int
    before: list[np.ndarray]
    low: np.ndarray
    high: np.ndarray
    height: float


def _partings(terrain: Terrain, which: Sequence[int], most: int) -> dict[int, list[_Parting]]:
    """Return where descents along rays begin to end elsewhere, by state: the `most` lowest, the lowest first."""
    rays = [(k, ray) for k, ray in terrain.rays(which) if len(ray) > 1]
    tops = [np.maximum.accumulate(terrain.rise(k, ray)) for k, ray in rays]
    ranks = [coarse(top[:, None])[:, 0] for top in tops]
    lower = [np.flatnonzero(terrain.are_lower(k, ray)) for k, ray in rays]
    # of each ray: its first state that is known to be away, or its length, and the first that was not descended from
    first = [
        int(some[0]) if len(some) else len(r) for some, (_, r) in zip(lower, rays, strict=True)
    ]
    begin = [1] * len(rays)
    while some := _next_descents(terrain, [k for k, _ in rays], ranks, first, begin, most):
        away = _away(terrain, [(rays[r][0], rays[r][1][i]) for r, i in some])
        for (r, i), gone in zip(some, away.tolist(), strict=True):
            begin[r] = i + 1
            first[r] = min(first[r], i) if gone else first[r]
    out: dict[int, list[_Parting]] = {}
    for (k, ray), top, at in zip(rays, tops, first, strict=True):
        if at < len(ray):
            part = _Parting(k, list(ray[:at]), ray[at - 1], ray[at], float(top[at]))
            out.setdefault(k, []).append(part)
    return {k: sorted(parts, key=_rank)[:most] for k, parts in out.items()}


def _next_descents(
    terrain: Terrain,
    of: Sequence[int],
    ranks: Sequence[np.ndarray],
    first: Sequence[int],
    begin: Sequence[int],
    most: int,
) -> list[tuple[int, int]]:
    """Return states (ray, place) to descend from next: of rays of each state the lowest, up to its `most` partings."""
    out: list[tuple[int, int]] = []
    if terrain.together is None:
        return [(r, i) for r, rank in enumerate(ranks) for i in range(begin[r], len(rank))]
    for k in dict.fromkeys(of):
        mine = [r for r, owner in enumerate(of) if owner == k]
        known = sorted(ranks[r][first[r]] for r in mine if first[r] < len(ranks[r]))
        bar = known[most - 1] if len(known) >= most else math.inf
        left = ((ranks[r][i], r, i) for r in mine for i in range(begin[r], first[r]))
        some = sorted(state for state in left if state[0] <= bar)
        out += [(r, i) for _, r, i in some[: terrain.together]]
    return out


def _rank(part: _Parting) -> float:
    """Return the height, such that of those that are equal but for rounding the one found first comes first."""
    return float(coarse(np.array([part.height]))[0])


def _away(terrain: Terrain, starts: Sequence[tuple[int, np.ndarray]]) -> np.ndarray:
    """Return whether descents from them leave the state, of some number, for good."""
    away = np.zeros(len(starts), dtype=bool)
    of = np.array([k for k, _ in starts], dtype=int)
    for k in dict.fromkeys(of.tolist()):
        mine = np.flatnonzero(of == k).tolist()
        away[mine] = terrain.are_lower(k, np.array([starts[i][1] for i in mine]))
    todo = np.flatnonzero(~away).tolist()
    if len(todo):
        ends = terrain.land(np.array([starts[i][1] for i in todo]))
        left = np.flatnonzero(~away)
        for k in dict.fromkeys(of[left].tolist()):
            mine = of[left] == k
            away[left[mine]] = terrain.are_ways(k, ends[mine])
    return away


def _sharpen(terrain: Terrain, parts: Sequence[_Parting], sections: int) -> None:
    """Cut the steps in which descents part finer, those of several states together."""
    # each round cuts the step in which descents part into sections + 1
    even = np.arange(1, sections + 1) / (sections + 1)
    # what is left in the first step may be left much sooner
    narrow = 4.0 ** np.arange(-sections, 0)
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


CERTAIN = 1e-3
"""The highest state of a path is located to this share of its height: printed are two digits."""
MOST_CUTS, A_ROUND = 150, 16
"""Cuts of a way, and cuts made before the steps that may be highest are looked for again."""
LONG = 0.1
"""A step that is longer [rad] is cut in any case: whether it is a way at all."""


def highest(
    terrain: Terrain, k: int, states: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray] | None:
    """Return an upper bound of the energy along a way over state k, the highest state that was looked at, and all.

    Between two states that are d apart the energy is at most (u + v + L d) / 2, where L is the largest slope along what
    moves: steps that may be higher than what was seen are cut until that is little.  None where a cut does not close,
    is not admissible, or lies aside: then it is no way.
    """
    # states in order along the way, their heights and torques; each cut puts one more in
    x, u = states, terrain.rise(k, states)
    torque, d = terrain.torque(x), terrain.distances(x[:-1], x[1:])
    cuts = 0
    while True:
        most = (u[:-1] + u[1:] + LONGER * _slopes(x, torque) * d) / 2
        top = float(u.max())
        enough = max(top * (1 + CERTAIN), terrain.floor)
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
        d[cut] = parts[0]
        d = np.insert(d, cut + 1, parts[1])
        u = np.insert(u, cut + 1, terrain.rise(k, halves))
        torque = np.insert(torque, cut + 1, terrain.torque(halves), axis=0)
        x = np.insert(x, cut + 1, halves, axis=0)


def _slopes(x: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Return the larger slope at the ends of each step along the angles that it changes: what it holds stays."""
    moves = x[:-1] != x[1:]
    unit = 2.0 ** math.frexp(float(np.abs(torque).max()))[1]  # squares in N m may overflow
    ends = [np.square(torque[e : len(moves) + e] / unit * moves).sum(axis=1) for e in (0, 1)]
    return np.asarray(unit * np.sqrt(np.maximum(*ends)))


LONGER = 2.0
"""A step along closed states is longer than its chord, by less than this once steps are short."""
JUMP = 0.3
"""Steps of a descent are no longer [rad], or it left the curve or surface that it is on."""
ASIDE = 0.75
"""The middle of a step is nearer to either end than this share of the step."""


def _way(terrain: Terrain, part: _Parting) -> EscapePath | None:
    """Follow the way over a parting, state by state; None where it does not lead elsewhere.

    Long steps first: where these do not lead elsewhere careful ones slide along what contacts leave open.
    """
    descents = (terrain.quick_path_down, terrain.path_down)
    return next(filter(None, (_way_by(terrain, part, down) for down in descents)), None)


def _way_by(terrain: Terrain, part: _Parting, path_down: DescentPath) -> EscapePath | None:
    """Follow the way over a parting by one kind of descent."""
    k = part.k
    down = path_down(part.high, lambda x: terrain.is_lower(k, x))
    lower = terrain.is_lower(k, down[-1])
    # gaps alone do not see that layers have no order
    if lower and terrain.problem.refuses(down[-1]):
        return None
    # it went on until it was lower: where that leads is what descents in batches say
    # lower than the state: any state that this descends to has been reached without climbing
    last = terrain.land(down[-1:])[0] if lower else down[-1]
    to = _listed(terrain, last) if np.isfinite(last).all() else -1
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
        if _listed(terrain, back[-1]) == k:
            for states, meets in _over_passes(terrain, back, down):
                over = highest(terrain, k, states)
                if over is not None and (best is None or over[0] < best[0]):
                    best, after = over, meets
    if best is None:
        return None
    height, top, states = best
    way = np.concatenate([states, down[after + 1 :]])
    return EscapePath(height, top, -1 if to == k else to, way)


def down_to(terrain: Terrain, state: np.ndarray) -> tuple[np.ndarray, int] | None:
    """Go down carefully to a listed state: states [S, n], and its number; None where that fails, or a step is long."""
    down = terrain.path_down(state, lambda _: False)
    to = _listed(terrain, down[-1])
    if to < 0 or any(terrain.distance(a, b) > JUMP for a, b in itertools.pairwise(down)):
        return None
    return np.concatenate([down, terrain.minima[to][None]]), to


def _listed(terrain: Terrain, x: np.ndarray) -> int:
    apart = np.abs(terrain.minima - x).max(axis=1)
    nearest = int(apart.argmin())
    return nearest if apart[nearest] <= NEAR_SINGULAR_TOL else -1


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
