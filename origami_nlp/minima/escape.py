"""Escape barriers of the minima of a scene: traced with one degree of freedom, bounded by descents with more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.kkt import (
    ALONE,
    TRACED,
    Escape,
    barriers,
    energy_scale,
    level_of,
)
from origami_nlp.minima.canonical import canonical_states
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.one_dof import CandidateMinima
from origami_nlp.minima.traced_passes import TracedPasses, traced_passes
from origami_nlp.numerics import SHALLOW
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem, pose
from origami_nlp.problem import Model
from origami_nlp.search import NOTHING_NEAR, find_escapes


def with_escapes(
    model: Model,
    minima: Sequence[JudgedState],
    traced: CandidateMinima | None = None,
    problem: PatternProblem | None = None,
) -> list[JudgedState]:
    """Add what it takes to leave each minimum.

    Parameters
    ----------
    model
        The problem.
    minima
        All that are known.
    traced
        The curves of a model with one degree of freedom, where they were resolved.
    problem
        The scene, posed; None: it is posed here.

    Returns
    -------
    list of JudgedState
        With `escape`.
    """
    states = np.array([model.reduce(np.array(m.fold_angles)) for m in minima])
    states = states.reshape(-1, model.size)
    energies = np.array([m.energy for m in minima])
    isolated = np.array([m.local_dimension == 0 for m in minima], dtype=bool)
    scale = energy_scale(np.array(model.scene.stiffness))
    # exact where every curve of states is known: barriers are then read off a finite graph
    found = None
    if traced is not None and traced.complete and model.has_limits and not model.parameters.dead:
        passes = traced_passes(model, traced.curves, traced.branches, states, energies)
        found = passes and _exact(model, passes, energies, isolated, scale)
    if not found:
        found = _bounded(problem or pose(model.scene), model.scene, states, isolated)
    return [replace(m, escape=e) for m, e in zip(minima, found, strict=True)]


def _exact(
    model: Model,
    passes: TracedPasses,
    energies: np.ndarray,
    isolated: np.ndarray,
    scale: float,
) -> list[Escape] | None:
    """Read barriers off the merge tree of curves; None where a minimum is on none of them."""
    if not (passes.on_curves | isolated).all():
        return None
    found = []
    listed = barriers(energies, passes.heights(), level_of(energies, scale), scale)
    for k, (barrier, to) in enumerate(listed):
        if isolated[k]:
            found.append(Escape(math.inf, ALONE, NOTHING_NEAR))
        elif to < 0:
            why = "its curve leads to no state of no higher energy: it ends at limits, contacts or itself"
            found.append(Escape(math.inf, TRACED, why))
        else:
            why = "the lowest pass of the curves of closed states, both ways, admissible all along"
            top = tuple(model.expand(passes.top(k, to)).tolist())
            found.append(Escape(barrier, TRACED, why, to + 1, top, barrier < SHALLOW * scale))
    return found


def _bounded(
    problem: PatternProblem,
    scene: Scene,
    states: np.ndarray,
    isolated: np.ndarray,
) -> list[Escape]:
    """Bound barriers by escape paths that descents show."""
    posed, group = canonical_states(problem, scene, states), scene.group
    found = find_escapes(
        posed.problem,
        posed.minima,
        isolated.tolist(),
        labels=CanonicalLabelling(np.arange(problem.size), 1.0, False, ()),
        moves=posed.moves,
        kept="" if group.is_trivial else f"; among states with symmetry {group.name}",
        unit=posed.unit,
    )
    return [
        replace(e, top=tuple(problem.expand(posed.back(np.array(e.top))).tolist())) if e.top else e
        for e in found
    ]
