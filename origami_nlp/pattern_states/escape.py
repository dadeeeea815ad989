"""Escape barriers of the stable states of a sheet: along traced curves, and by descents out of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.escapes import TRACED, Escape, barriers, energy_scale, find_escapes, level_of
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import SHALLOW
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states.curves import TracedCurves
from origami_nlp.pattern_states.traced_passes import CurvePasses, curve_passes


def with_escapes(
    curves: TracedCurves,
    states: Sequence[JudgedState],
    moves: Sequence[Callable[[np.ndarray], np.ndarray]],
    contact: bool,
    most: float,
) -> list[JudgedState]:
    """Add what it takes to leave each stable state.

    Parameters
    ----------
    curves
        Of the sheet, those that were traced.
    states
        Judged; ways lead to minima among them, numbered in their order.
    moves
        Symmetries of the origami and its springs, of states [n].
    contact
        Whether facets must not cross.
    most
        Counted work of descents.

    Returns
    -------
    list of JudgedState
        With `escape` where they are minima.
    """
    minima = [s for s in states if s.verdict == "minimum"]
    if not minima:
        return list(states)
    found = iter(_escapes(curves, minima, moves, contact, most))
    return [replace(s, escape=next(found)) if s.verdict == "minimum" else s for s in states]


def _escapes(
    curves: TracedCurves,
    minima: Sequence[JudgedState],
    moves: Sequence[Callable[[np.ndarray], np.ndarray]],
    contact: bool,
    most: float,
) -> list[Escape]:
    problem = curves.problem
    at = np.array([problem.reduce(s.phi) for s in minima])
    energies = np.array([s.energy for s in minima])
    scale = energy_scale(problem.pattern.stiffness)
    level = level_of(energies, scale)
    traced = curve_passes(problem, curves.found, at)
    heights, sure = (np.full((len(at),) * 2, math.inf) for _ in range(2))
    if traced is not None:
        heights, sure = (t.heights() * problem.scale for t in (traced.passes, traced.sure))
    exact = _exact(problem, minima, traced, sure, level, scale, contact)
    alone = [not s.local_dimension for s in minima]
    found = find_escapes(
        problem.with_contact(contact),
        at,
        alone,
        labels=curves.labels,
        moves=moves,
        exact=exact,
        heights=heights,
        most=most,
    )
    return [
        replace(e, top=tuple(problem.expand(np.array(e.top)).tolist())) if e.top else e
        for e in found
    ]


def _exact(
    problem: PatternProblem,
    minima: Sequence[JudgedState],
    traced: CurvePasses | None,
    sure: np.ndarray,
    level: float,
    scale: float,
    contact: bool,
) -> dict[int, Escape]:
    """Return the barriers that curves give exactly: a way that climbs no higher than every way does."""
    if traced is None:
        return {}
    energies = np.array([s.energy for s in minima])
    found = {}
    for k, (barrier, to) in enumerate(barriers(energies, sure, level, scale)):
        if minima[k].dof != 1 or not traced.sure.on_curves[k]:
            continue
        equal = np.flatnonzero(energies <= energies[k] + level).tolist()
        others = [*equal, *([to] if to >= 0 else [])]
        least = traced.least(k, others, level / problem.scale) * problem.scale
        if math.isinf(least):
            if contact:  # samples at which facets cross are no proof that no way leads past
                continue
            why = "its curve leads to no state of no higher energy: it ends at limits"
            found[k] = Escape(math.inf, TRACED, why)
        elif math.isfinite(barrier) and energies[k] + barrier <= least + level:
            why = "the lowest pass of the curves of closed states, both ways"
            top = tuple(traced.sure.top(k, to).tolist())
            found[k] = Escape(barrier, TRACED, why, to + 1, top, barrier < SHALLOW * scale)
    return found
