"""Starts of a sheet brought onto closure, lowest states of planes, and what is known of a vertex alone."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.minima import find_minima
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, EXPLORED, nearest
from origami_nlp.pattern import Contact, Pattern, Scene
from origami_nlp.pattern_problem import PatternProblem, round_vertex


def close(problem: PatternProblem, start: np.ndarray) -> np.ndarray | None:
    """Close a start within the fold limits, fully folded creases left so if possible; None where it does not close."""
    limits = problem.fold_limits
    start = limits.clip(start)
    at_limit = limits.room(start) == 0
    for held in (at_limit, None) if at_limit.any() else (None,):
        phi, residual = problem.project(start, held)
        within = limits.inside(phi, EXPLORED).all()
        phi = limits.clip(phi)
        if residual <= CLOSURE_TOL and within and problem.closure.lifts_to_one(phi):
            return phi
    return None


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


def lowest_on(problem: PatternProblem, phi: np.ndarray, basis: np.ndarray) -> np.ndarray | None:
    """Return the state of lowest energy on a plane of closed states phi + basis y within limits; None with laws.

    Where the energy is no square of a distance descents find what is lowest.
    """
    if problem.pattern.laws:
        return None
    root = np.sqrt(problem.stiffness)[:, None]
    _, r = np.linalg.qr(root * basis)  # energy = |r y - r y0|^2 / 2 and what stays
    y0 = np.linalg.lstsq(root * basis, root[:, 0] * (problem.pattern.rest - phi), rcond=None)[0]
    # in coordinates r y the energy is half a squared distance: the state is the nearest point of a polytope
    limits = problem.fold_limits
    rows = np.linalg.solve(r.T, np.vstack([basis, -basis]).T).T
    y = nearest(r @ y0, rows, np.concatenate([limits.low - phi, phi - limits.high]))
    if y is None:
        return None
    state = phi + basis @ np.linalg.solve(r, y)
    state = limits.hold(state, limits.near(state, 10 * DUPLICATE_TOL))
    state[np.abs(state) < 10 * DUPLICATE_TOL] = 0.0
    return close(problem, state)
