"""Barriers between stable states of a pattern that differ in the sign of an interior vertex.

Every admissible path between them passes a state in which that vertex is flat (`PopSigns`): its energy is bounded from
below in closed form, and by the states that a search with that vertex flat has found.  A way down from such a state to
both sides is a path, so that barriers are exact where both agree.  Further paths lead straight to such states and to
other minima, over any height, and are made lower where they are highest.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.barriers.passes import (
    FOLLOWED,
    LISTED,
    OPPOSITE,
    RIGID,
    SIGNED,
    STOPPED,
    Descent,
    Pass,
    both_sides,
    critical_near,
)
from origami_nlp.barriers.paths import PathDown, passes_over_paths
from origami_nlp.barriers.result import Barriers, FlatVertexBound
from origami_nlp.barriers.traced import EXPLICIT, pattern_passes
from origami_nlp.errors import OptionError, OutOfTime
from origami_nlp.kkt import energy_scale, level_of
from origami_nlp.minima import MinimaResult, TracedPasses
from origami_nlp.numerics import NEAR_SINGULAR_TOL
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import (
    FlatVertex,
    PatternTerrain,
    flat_tops,
    list_flat_vertices,
    relaxed,
    ways_between,
    ways_down,
)

MINIMA, FLAT_STATES, WAYS_DOWN, BETWEEN, LOWERED, ON_CURVES = (
    "the search for minima",
    "states with a vertex flat",
    "ways down from states with a vertex flat",
    "ways between minima",
    "paths made lower",
    "passes along traced curves",
)
"""Parts that the time may end."""
SECONDS = 60.0
"""For ways of each kind, of wall time."""


def pattern_barriers(
    result: MinimaResult, until: float = math.inf, progress: Callable[[str], object] | None = None
) -> Barriers:
    """Return the barriers of a pattern, on traced curves and through states with a vertex flat.

    Parameters
    ----------
    result
        Its minima.
    until
        Time of `time.monotonic` at which it ends with what it has.
    progress
        Called with what it is at.

    Returns
    -------
    Barriers
        With the lowest pass that is known between every two minima, and what bounds it from below.

    Raises
    ------
    OptionError
        If there is neither a curve nor a vertex with a sign.
    """
    problem, say = result.model, progress or (lambda _: None)
    before, problem.until = problem.until, until
    try:
        return _until(result, say)
    finally:
        problem.until = before


def _until(result: MinimaResult, say: Callable[[str], object]) -> Barriers:
    """Find the barriers until the time of the problem is over."""
    late = [MINIMA] * (result.search.stopped_by == "time")
    known: tuple[Barriers, TracedPasses] | None = None
    say(ON_CURVES)
    try:
        known = pattern_passes(result)
    except OutOfTime:
        late.append(ON_CURVES)
    if late and not (result.sign_vertices or known):
        return Barriers(result, (), (), left_out=(*late,))
    if not (result.sign_vertices or known):
        raise OptionError(
            "no curve of states is known and no vertex has a sign (contact on, 360 degrees of paper or less): "
            "barriers of a pattern need one of them, and the result of a search, not one from a file"
        )
    if not result.sign_vertices or not result.minima:
        found = known[0] if known else Barriers(result, (), ())
        return replace(found, left_out=(*late,))
    on_curves, traced = known or (None, None)
    return _with_signs(result, on_curves, traced, late, say)


def _with_signs(
    result: MinimaResult,
    known: Barriers | None,
    traced: TracedPasses | None,
    late: list[str],
    say: Callable[[str], object],
) -> Barriers:
    """Add paths through states with a vertex flat, and what bounds all from below."""
    problem, minima = result.model, np.array([m.phi for m in result.minima])
    bounds = list_flat_vertices(result.pattern, True, problem.until, say)
    late = [*late, *[FLAT_STATES] * (time.monotonic() > problem.until)]
    ways, cut = _ways(problem, minima, bounds, traced, say)
    scale = energy_scale(result.pattern.stiffness)
    level = level_of(np.array([m.energy for m in result.minima]), scale)
    whole, many = passes_over_paths(problem, result, minima, ways, traced, EXPLICIT), len(ways)

    def lower() -> None:
        floors = [_floor(p, result, bounds) for p in whole.passes]
        terrain = PatternTerrain(problem, minima, True, {}, {}, 0)
        for way in lower_ways(terrain, whole.passes, floors, level):
            ways.append(way)

    late += cut + _in_time(problem, LOWERED, say, lower)
    if len(ways) > many:
        whole = passes_over_paths(problem, result, minima, ways, traced, EXPLICIT)
    before = {} if known is None else {(p.from_state, p.to_state): p for p in known.passes}
    passes = []
    for p in whole.passes:
        was = before.get((p.from_state, p.to_state))
        if was is not None and (was.is_lowest or was.energy <= p.energy + level):
            p = was
        passes.append(_bounded(p, result, bounds, level))
    vertices = tuple(FlatVertexBound(b.vertex, b.least, b.listed, len(b.states)) for b in bounds)
    return replace(whole, passes=tuple(passes), flat_vertices=vertices, left_out=(*late,))


def _ways(
    problem: PatternProblem,
    minima: np.ndarray,
    bounds: Sequence[FlatVertex],
    traced: TracedPasses | None,
    say: Callable[[str], object],
) -> tuple[list[PathDown], list[str]]:
    """Go down from states with a vertex flat, and walk from minima to these and to each other; what the time ended."""
    ways, many = list[PathDown](), len(minima)
    tops = [top for top, _ in flat_tops(problem, bounds)]
    joined = [] if traced is None else [(m.first[0], m.second[0]) for m in traced.tree.merges]

    def down() -> None:
        for to, path in ways_down(problem, minima, bounds):
            joined.append((to, many + int(np.argmin([np.abs(path[0] - x).max() for x in tops]))))
            ways.append(PathDown(path, to))

    def between() -> None:
        for start, to, path in ways_between(problem, minima, tops, joined):
            ways.append(PathDown(path, to, start))

    late = _in_time(problem, WAYS_DOWN, say, down)
    return ways, late + _in_time(problem, BETWEEN, say, between)


def _in_time(
    problem: PatternProblem, part: str, say: Callable[[str], object], work: Callable[[], object]
) -> list[str]:
    """Do a part of the work for `SECONDS` at most; its name if the time ended it."""
    say(part)
    until, problem.until = problem.until, min(problem.until, time.monotonic() + SECONDS)
    try:
        problem.check_time()
        work()
    except OutOfTime:
        return [part]
    finally:
        problem.until = until
    return []


def _floor(p: Pass, result: MinimaResult, bounds: Sequence[FlatVertex]) -> float:
    """Return what a pass climbs to at least, over listed states."""
    pair = p.from_state - 1, p.to_state - 1
    return max(*(result.minima[k].energy for k in pair), *_bounds(p, result, bounds, "listed"))


def _bounds(p: Pass, result: MinimaResult, bounds: Sequence[FlatVertex], what: str) -> list[float]:
    """Return what it takes to make each vertex flat at which the signs of the two minima differ."""
    one, two = (result.signs[k - 1] for k in (p.from_state, p.to_state))
    both = zip(bounds, one, two, strict=True)
    return [getattr(b, what) for b, *pair in both if tuple(pair) in OPPOSITE]


def _bounded(p: Pass, result: MinimaResult, bounds: Sequence[FlatVertex], level: float) -> Pass:
    """Add what bounds a pass from below."""
    least = max(_bounds(p, result, bounds, "least"), default=math.nan)
    listed = max(_bounds(p, result, bounds, "listed"), default=math.nan)
    p = replace(p, least=least, listed=listed)
    if any(not result.minima[k - 1].local_dimension for k in (p.from_state, p.to_state)):
        return replace(p, why=RIGID)
    if math.isinf(least):
        return replace(p, why=STOPPED)
    if math.isnan(least) or (p.is_lowest and p.why != FOLLOWED):
        return p
    if p.energy <= least + level:  # a closed form: more than curves that were followed
        return replace(p, why=SIGNED)
    if p.is_lowest:
        return p
    return replace(p, why=LISTED) if p.energy <= listed + level else p


MOST_STRINGS = 12
"""Highest states of paths that are made lower: first those that the most pairs of minima have to pass."""
NEAR = 0.3
"""Newton finds a saddle within this distance [rad] of the highest state of a path."""


def lower_ways(
    terrain: PatternTerrain, passes: Sequence[Pass], floors: Sequence[float], level: float
) -> Iterator[PathDown]:
    """Make paths lower that climb above what bounds them.

    Parameters
    ----------
    terrain
        Of the pattern, with the minima that the passes lie between.
    passes
        With their paths.
    floors
        What each of these climbs to at least, as far as that is known.
    level
        Energies that are no more apart are the same.

    Yields
    ------
    PathDown
        Paths that climb less high.
    """
    both = zip(passes, floors, strict=True)
    high = [p for p, floor in both if floor + level < p.energy < math.inf]
    often, first = Counter(p.energy for p in high), {p.energy: p for p in reversed(high)}
    for energy, _ in sorted(often.items(), key=lambda one: (-one[1], one[0]))[:MOST_STRINGS]:
        p, path = first[energy], relaxed(terrain, first[energy].path)
        if path is not None and terrain.problem.energies(path).max() < energy - level:
            yield PathDown(path, p.to_state - 1, p.from_state - 1)
        for way in (p.path, path):
            over = () if way is None else tuple(_over_saddle(terrain, way))
            yield from over
            if over:
                break


def _over_saddle(terrain: PatternTerrain, path: np.ndarray) -> Iterator[PathDown]:
    """Go down both sides of the saddle that Newton finds beside the highest state of a path [S, n]."""
    minima = terrain.minima

    def down(_: object, start: np.ndarray, __: object) -> Descent | None:
        way = terrain.path_down(start, lambda _: False)
        apart = np.abs(minima - way[-1]).max(axis=1)
        k = int(apart.argmin())
        return Descent(way, k) if apart[k] <= NEAR_SINGULAR_TOL and len(way) > 1 else None

    top = path[int(terrain.problem.energies(path).argmax())]
    for one in critical_near(terrain.problem, top[None], NEAR):
        for side in both_sides(terrain.problem, one, list(minima), down) or ():
            assert side.lands_on is not None
            states = np.concatenate([one.x[None], side.states[:-1], minima[side.lands_on][None]])
            yield PathDown(states, side.lands_on)
