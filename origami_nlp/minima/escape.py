"""Escape barriers of the minima of a scene: traced with one degree of freedom, bounded by descents with more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.kkt import (
    ALONE,
    BOUND,
    TRACED,
    Escape,
    EscapePath,
    barriers,
    bounds,
    energy_scale,
    escape_paths,
    level_of,
)
from origami_nlp.minima.canonical import canonical_states
from origami_nlp.minima.descents import compiled
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.one_dof import CandidateMinima
from origami_nlp.minima.terrain import VertexTerrain
from origami_nlp.minima.traced_passes import TracedPasses, traced_passes
from origami_nlp.numerics import (
    DUPLICATE_TOL,
    SHALLOW,
)
from origami_nlp.pattern import Relabelling, symmetries
from origami_nlp.problem import Model

MOST_STATES = 8
"""Minima out of which ways are sought: those of lowest energy."""
MOST_VARIABLES = 12
"""Variables up to which escape paths are sought."""
NOTHING_NEAR = "no other admissible state is near"


def with_escapes(
    model: Model, minima: Sequence[JudgedState], traced: CandidateMinima | None = None
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
        found = _bounded(model, minima, states, energies, isolated, scale)
    return [replace(m, escape=e) for m, e in zip(minima, found, strict=True)]


def with_merge_tree(
    model: Model,
    minima: Sequence[JudgedState],
    heights: np.ndarray,
    why: str,
    beyond: np.ndarray,
) -> list[JudgedState]:
    """Add what the merge tree of paths says of leaving each minimum.

    Parameters
    ----------
    model
        The problem.
    minima
        Its minima.
    heights
        Energy of the lowest pass between two of them, [M, M]; inf where there is none.
    why
        What that rests on.
    beyond
        What a way from each to a lower state that is not listed climbs, [M]; inf for none.

    Returns
    -------
    list of JudgedState
        With `escape` where the tree knows an escape path from a minimum; the others as they were.
    """
    energies = np.array([m.energy for m in minima])
    scale = energy_scale(np.array(model.scene.stiffness))
    listed = barriers(energies, heights, level_of(energies, scale), scale, beyond)
    return [
        replace(m, escape=Escape(barrier, BOUND, why, to + 1, (), barrier < SHALLOW * scale))
        if math.isfinite(barrier)
        else m
        for m, (barrier, to) in zip(minima, listed, strict=True)
    ]


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
    model: Model,
    minima: Sequence[JudgedState],
    states: np.ndarray,
    energies: np.ndarray,
    isolated: np.ndarray,
    scale: float,
) -> list[Escape]:
    """Bound barriers by escape paths that descents show."""
    why = ""
    if model.scene.loads:
        why = "forces in space: escape paths are not sought under them"
    elif compiled() is None:
        why = "no C compiler was found: escape paths, which many descents show, are not sought"
    elif model.size > MOST_VARIABLES:
        why = f"more than {MOST_VARIABLES} variables: escape paths are not sought"
    loose = [k for k in range(len(minima)) if not isolated[k]]
    images = _images(model, states)
    lowest = [] if why else loose[:MOST_STATES]
    sought = [k for k in lowest if k not in images]
    modes = [_modes(model, m) for m in minima]
    ways = _ways(model, states, modes, sought) if sought else {}
    # an image may be that of an image: earlier ones first
    for k, (first, move, to) in sorted(images.items(), key=lambda item: item[0]):
        if k in lowest and (way := ways.get(first)):
            top = _moved(model, move, way.top)
            ways[k] = way._replace(top=top, to=int(to[way.to]) if way.to >= 0 else -1)
    reported = {k: Escape(math.inf, ALONE, NOTHING_NEAR) for k in np.flatnonzero(isolated).tolist()}

    def unknown(k: int) -> str:
        if not why and k not in lowest:
            return f"more than {MOST_STATES} minima: sought for those of lowest energy"
        if not why and len(loose) == 1:
            return "no other state is known that it could be left for"
        return why or "no descent from near it ended at a state of lower energy"

    group = model.scene.group
    kept = "" if group.is_trivial else f"; among states with symmetry {group.name}"
    heights = np.full((len(minima),) * 2, math.inf)
    found = bounds(energies, ways, heights, scale, reported, unknown, kept)
    return [
        replace(e, top=tuple(model.expand(np.array(e.top)).tolist())) if e.top else e for e in found
    ]


def _ways(
    model: Model, states: np.ndarray, modes: Sequence[list[np.ndarray]], which: Sequence[int]
) -> dict[int, EscapePath]:
    """Find escape paths from minima [M, n] of some numbers, under labels that do not depend on the scene's."""
    posed = canonical_states(model, states, modes)
    terrain = VertexTerrain(posed.model, posed.minima, posed.modes)
    return {
        k: EscapePath(posed.unit * way.height, posed.back(way.top), way.to)
        for k, way in escape_paths(terrain, which).items()
    }


def _images(model: Model, states: np.ndarray) -> dict[int, tuple[int, Relabelling, np.ndarray]]:
    """Return which states [M, n] are images of earlier ones: of which, by which symmetry, and where that takes each.

    Symmetries are those of creases and springs that take all states to one another.
    """
    found: dict[int, tuple[int, Relabelling, np.ndarray]] = {}
    for move in symmetries(model.scene) if len(states) > 1 else ():
        apart = np.abs(_moved(model, move, states)[:, None] - states).max(axis=2)
        to = apart.argmin(axis=1)
        if len(set(to.tolist())) < len(to) or apart.min(axis=1).max() > DUPLICATE_TOL:
            continue
        for first, k in enumerate(to.tolist()):
            if first < k and first not in found and k not in found:
                found[k] = first, move, to
    return found


def _moved(model: Model, move: Relabelling, x: np.ndarray) -> np.ndarray:
    """Return the states, in the model's variables [..., n], to which a symmetry takes others."""
    return np.asarray(model.reduce(move.back(model.expand(x))))


def _modes(model: Model, minimum: JudgedState) -> list[np.ndarray]:
    """Return the softest mode of a minimum in the model's variables, where it is one."""
    return [model.reduce(np.array(minimum.softest_mode))] if minimum.softest_mode else []
