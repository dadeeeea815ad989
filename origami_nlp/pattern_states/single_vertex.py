"""What is known of a sheet's only vertex by itself."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.minima import find_minima
from origami_nlp.pattern import Contact, Pattern, Scene
from origami_nlp.pattern_problem import round_vertex


def scene_of(pattern: Pattern, contact: bool) -> tuple[Scene | None, list[int]]:
    """Return the scene of a pattern's only vertex and its creases in order; None where there are more creases."""
    (loop,) = pattern.vertices
    vertex, creases = round_vertex(pattern, loop), list(loop.creases)
    if vertex is None or len(creases) < pattern.creases:
        return None, creases
    stiffness, wound = pattern.stiffness[creases], pattern.rest[creases]
    # a torque winds springs beyond the rest angles that a scene states: what is beyond is preload
    rest = np.clip(wound, -math.pi, math.pi)
    preload = tuple((stiffness * (wound - rest)).tolist()) if np.any(wound != rest) else ()
    kind: Contact = "full" if contact else "fold-limits"
    k, at = tuple(stiffness.tolist()), tuple(rest.tolist())
    limits = tuple(pattern.limits[c] for c in creases) if pattern.limits else ()
    laws = tuple(pattern.laws[c] for c in creases) if pattern.laws else ()
    return Scene(vertex, k, at, "none", kind, preload=preload, limits=limits, laws=laws), creases


def of_vertex(
    pattern: Pattern, contact: bool, seed: int, seconds: float
) -> tuple[list[np.ndarray], bool]:
    """Return the minima that the search for single vertices finds, [n] each, and whether it came to its end."""
    scene, creases = scene_of(pattern, contact)
    if scene is None:
        return [], True
    result = find_minima(scene, seed=seed, full=False, prove=False, escape=False, seconds=seconds)
    states = np.zeros((len(result.minima), pattern.creases))
    for phi, found in zip(states, result.minima, strict=True):
        phi[creases] = found.fold_angles
    return list(states), result.search.stopped_by != "time"
