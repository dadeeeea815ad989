"""Barriers between stable states of a pattern that differ in the sign of an interior vertex.

Every admissible path between them passes a state in which that vertex is flat (`PopSigns`): its energy is bounded from
below in closed form, and by the states that a search with that vertex flat has found.  A way down from such a state to
both sides is a path, so that barriers are exact where both agree.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.barriers.passes import FOLLOWED, LISTED, OPPOSITE, SIGNED, STOPPED, Pass
from origami_nlp.barriers.paths import PathDown, passes_over_paths
from origami_nlp.barriers.result import Barriers, FlatVertexBound
from origami_nlp.barriers.traced import EXPLICIT, pattern_passes
from origami_nlp.errors import OptionError, OutOfTime
from origami_nlp.kkt import energy_scale, level_of
from origami_nlp.minima import MinimaResult, TracedPasses
from origami_nlp.pattern_states import FlatVertex, list_flat_vertices, ways_down

MINIMA, FLAT_STATES, WAYS_DOWN, ON_CURVES = (
    "the search for minima",
    "states with a vertex flat",
    "ways down from states with a vertex flat",
    "passes along traced curves",
)
"""Parts that the time may end."""


def pattern_barriers(
    result: MinimaResult,
    until: float = math.inf,
    progress: Callable[[str], object] | None = None,
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
    ways: list[PathDown] = []
    say(WAYS_DOWN)
    try:
        for to, path in ways_down(problem, minima, bounds):
            ways.append(PathDown(path, to))
    except OutOfTime:
        late.append(WAYS_DOWN)
    whole = passes_over_paths(problem, result, minima, ways, traced, EXPLICIT)
    scale = energy_scale(result.pattern.stiffness)
    level = level_of(np.array([m.energy for m in result.minima]), scale)
    before = {} if known is None else {(p.from_state, p.to_state): p for p in known.passes}
    passes = []
    for p in whole.passes:
        was = before.get((p.from_state, p.to_state))
        if was is not None and (was.is_lowest or was.energy <= p.energy + level):
            p = was
        passes.append(_bounded(p, result, bounds, level))
    vertices = tuple(FlatVertexBound(b.vertex, b.least, b.listed, len(b.states)) for b in bounds)
    return replace(whole, passes=tuple(passes), flat_vertices=vertices, left_out=(*late,))


def _bounded(p: Pass, result: MinimaResult, bounds: Sequence[FlatVertex], level: float) -> Pass:
    """Add what bounds a pass from below."""
    one, two = (result.signs[k - 1] for k in (p.from_state, p.to_state))
    differ = [b for b, *pair in zip(bounds, one, two, strict=True) if tuple(pair) in OPPOSITE]
    least = max((b.least for b in differ), default=math.nan)
    listed = max((b.listed for b in differ), default=math.nan)
    p = replace(p, least=least, listed=listed)
    if math.isinf(least):
        return replace(p, why=STOPPED)
    if math.isnan(least) or (p.is_lowest and p.why != FOLLOWED):
        return p
    if p.energy <= least + level:  # a closed form: more than curves that were followed
        return replace(p, why=SIGNED)
    if p.is_lowest:
        return p
    return replace(p, why=LISTED) if p.energy <= listed + level else p
