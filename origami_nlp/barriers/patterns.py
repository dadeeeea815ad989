"""Barriers between stable states of a pattern: along traced curves, and along paths over any height.

With contact on, walks lead from minima straight to the flat state and to each other, over any height (`ways_between`),
and saddles are looked for where they are highest: what they climb to at their states bounds barriers from above.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.barriers.passes import (
    RIGID,
    Descent,
    Pass,
    both_sides,
    critical_near,
)
from origami_nlp.barriers.paths import PathDown, passes_over_paths
from origami_nlp.barriers.result import Barriers
from origami_nlp.barriers.traced import EXPLICIT, pattern_passes
from origami_nlp.errors import OptionError, OutOfTime
from origami_nlp.kkt import energy_scale, level_of
from origami_nlp.minima import MinimaResult, TracedPasses
from origami_nlp.numerics import NEAR_SINGULAR_TOL
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import ways_between
from origami_nlp.search import DescentTerrain

MINIMA, BETWEEN, SADDLES, ON_CURVES = (
    "the search for minima",
    "ways between minima",
    "saddles beside paths",
    "passes along traced curves",
)
"""Parts that the time may end."""
SECONDS = 60.0
"""For ways of each kind, of wall time."""


def pattern_barriers(
    result: MinimaResult, until: float = math.inf, progress: Callable[[str], object] | None = None
) -> Barriers:
    """Return the barriers of a pattern, on traced curves and, with contact, on paths between its minima.

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
        With the lowest pass that is known between every two minima.

    Raises
    ------
    OptionError
        If facets may cross and no curve is known.
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
    contact = getattr(result.search, "contact", "full") == "full"
    if not (late or contact or known):
        raise OptionError(
            "no curve of states is known, and facets may cross: barriers of a pattern need curves or contact, and the "
            "result of a search, not one from a file"
        )
    if not contact or not result.minima:
        found = known[0] if known else Barriers(result, (), ())
        return replace(found, left_out=(*late,))
    on_curves, traced = known or (None, None)
    return _with_ways(result, on_curves, traced, late, say)


def _with_ways(
    result: MinimaResult,
    known: Barriers | None,
    traced: TracedPasses | None,
    late: list[str],
    say: Callable[[str], object],
) -> Barriers:
    """Add paths between minima, over any height."""
    problem, minima = result.model, np.array([m.phi for m in result.minima])
    ways = list[PathDown]()
    late = late + _in_time(
        problem, BETWEEN, say, lambda: ways.extend(_ways(result, minima, traced))
    )
    many = len(ways)
    level = level_of(
        np.array([m.energy for m in result.minima]), energy_scale(result.pattern.stiffness)
    )
    whole = passes_over_paths(problem, result, minima, ways, traced, EXPLICIT)

    def lower() -> None:
        terrain = DescentTerrain(problem, minima)
        ways.extend(over_saddles(terrain, whole.passes, level))

    late += _in_time(problem, SADDLES, say, lower)
    if len(ways) > many:
        whole = passes_over_paths(problem, result, minima, ways, traced, EXPLICIT)
    before = {} if known is None else {(p.from_state, p.to_state): p for p in known.passes}
    passes = []
    for p in whole.passes:
        was = before.get((p.from_state, p.to_state))
        if was is not None and (was.is_lowest or was.energy <= p.energy + level):
            p = was
        ends = (result.minima[k - 1] for k in (p.from_state, p.to_state))
        passes.append(p if all(m.local_dimension for m in ends) else replace(p, why=RIGID))
    return replace(whole, passes=tuple(passes), left_out=(*late,))


def _ways(
    result: MinimaResult, minima: np.ndarray, traced: TracedPasses | None
) -> Iterator[PathDown]:
    """Walk from minima to the flat state, and to each other where no way is known yet."""
    tops = [np.zeros(result.model.size)] * result.pattern.lies_flat
    joined = [] if traced is None else [(m.first[0], m.second[0]) for m in traced.tree.merges]
    for start, to, path in ways_between(result.model, minima, tops, joined):
        yield PathDown(path, to, start)


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


MOST_SADDLES = 12
"""Highest states of paths beside which saddles are looked for: first those that the most pairs of minima pass."""
NEAR = 0.3
"""Newton finds a saddle within this distance [rad] of the highest state of a path."""


def over_saddles(
    terrain: DescentTerrain, passes: Sequence[Pass], level: float
) -> Iterator[PathDown]:
    """Go over saddles beside the highest states of paths that climb above both their ends.

    Parameters
    ----------
    terrain
        Of the pattern, with the minima that the passes lie between.
    passes
        With their paths.
    level
        Energies that are no more apart are the same.

    Yields
    ------
    PathDown
        Paths from saddles down to minima.
    """
    some = (p for p in passes if p.energy < math.inf)
    high = [p for p in some if p.energy > max(p.path_energy[0], p.path_energy[-1]) + level]
    often, first = Counter(p.energy for p in high), {p.energy: p for p in reversed(high)}
    for energy, _ in sorted(often.items(), key=lambda one: (-one[1], one[0]))[:MOST_SADDLES]:
        yield from _over_saddle(terrain, first[energy].path)


def _over_saddle(terrain: DescentTerrain, path: np.ndarray) -> Iterator[PathDown]:
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
