"""Escape barriers of the stable states of a sheet: along traced curves, and by descents out of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.escapes import (
    ALONE,
    TRACED,
    Escape,
    barriers,
    energy_scale,
    find_escapes,
    level_of,
)
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import SHALLOW
from origami_nlp.pattern_states.curves import TracedCurves
from origami_nlp.pattern_states.pass_graph import PassGraph, graph_of_curves

NOTHING_NEAR = "no other admissible state is near"
"""Of a state that stands alone."""


def with_escapes(
    curves: TracedCurves,
    states: Sequence[JudgedState],
    most: float,
) -> list[JudgedState]:
    """Add what it takes to leave each stable state.

    Parameters
    ----------
    curves
        Of the sheet, those that were traced.
    states
        Judged; ways lead to minima among them, numbered in their order.
    most
        Counted work of descents.

    Returns
    -------
    list of JudgedState
        With `escape` where they are minima.
    """
    minima, problem = [s for s in states if s.verdict == "minimum"], curves.problem
    if not minima:
        return list(states)
    at, energies = np.array([problem.reduce(s.phi) for s in minima]), [s.energy for s in minima]
    scale = energy_scale(problem.pattern.stiffness)
    traced = graph_of_curves(problem, curves.found, at)
    known = _exact(minima, traced, level_of(np.array(energies), scale), scale)
    alone = [k for k, s in enumerate(minima) if not s.local_dimension]
    known |= {k: Escape(math.inf, ALONE, NOTHING_NEAR) for k in alone}
    heights = traced.heights() * problem.scale
    found = iter(find_escapes(problem, at, known, heights, most))

    def told(e: Escape) -> Escape:
        return replace(e, top=tuple(problem.expand(np.array(e.top)).tolist())) if e.top else e

    return [replace(s, escape=told(next(found))) if s.verdict == "minimum" else s for s in states]


def _exact(
    minima: Sequence[JudgedState], traced: PassGraph, level: float, scale: float
) -> dict[int, Escape]:
    """Return the barriers that curves give exactly: a way that climbs no higher than every way does."""
    energies, sure = np.array([s.energy for s in minima]), traced.sure
    unit, on_curves = traced.problem.scale, set(sure.pairs.ravel().tolist())
    found = {}
    for k, (barrier, to) in enumerate(barriers(energies, unit * sure.heights(), level, scale)):
        if minima[k].dof != 1 or k not in on_curves:
            continue
        equal = np.flatnonzero(energies <= energies[k] + level).tolist()
        others = [*equal, *([to] if to >= 0 else [])]
        least = traced.least(k, others, level / unit) * unit
        if math.isinf(least):
            if (
                traced.problem.contact
            ):  # samples at which facets cross are no proof that no way leads past
                continue
            why = "its curve leads to no state of no higher energy: it ends at limits"
            found[k] = Escape(math.inf, TRACED, why)
        elif math.isfinite(barrier) and energies[k] + barrier <= least + level:
            why = "the lowest pass of the curves of closed states, both ways"
            merge = sure.tree.barrier(k, to)
            top = () if merge is None else tuple(sure.states[sure.top(merge.edge)].tolist())
            found[k] = Escape(barrier, TRACED, why, to + 1, top, barrier < SHALLOW * scale)
    return found
