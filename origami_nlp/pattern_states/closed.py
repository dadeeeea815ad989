"""Starts of a sheet brought onto closure, lowest states of planes, and what is known of a vertex alone."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.minima import find_minima
from origami_nlp.numerics import (
    CLOSURE_TOL,
    DUPLICATE_TOL,
    EXPLORED,
    LEVEL,
    RESOLVED,
    ROUNDED,
    nearest,
)
from origami_nlp.pattern import Contact, Pattern, Scene
from origami_nlp.pattern_problem import PatternProblem, round_vertex

MOST_STEPS = 60
"""Of the search for the lowest state of a plane with laws."""
SOFT = 1e-3
"""Slope of a law over its mean stiffness that counts as a spring at least: a step goes no further."""
BESIDE_FLAT = math.sqrt(RESOLVED)
"""Starts that end with all fold angles smaller [rad] lead back to the flat state."""


def close(problem: PatternProblem, start: np.ndarray) -> np.ndarray | None:
    """Close a start within the fold limits, fully folded creases left so if possible; None where it does not close.

    What comes as near to the flat state as `BESIDE_FLAT` without closing is that state: closure holds to the square of
    the distance there and has singular values of its size, so that rounding says in which step, if ever, it closes.
    """
    limits = problem.fold_limits
    start = limits.clip(start)
    at_limit = limits.room(start) == 0
    for held in (at_limit, None) if at_limit.any() else (None,):
        phi, residual = problem.project(start, held)
        within = limits.inside(phi, EXPLORED).all()
        phi = limits.clip(phi)
        if residual <= CLOSURE_TOL and within and problem.closure.lifts_to_one(phi):
            return phi
    flat = np.zeros(problem.size)
    beside = problem.pattern.lies_flat and bool(np.abs(phi).max() < BESIDE_FLAT)
    return flat if beside and limits.inside(flat).all() else None


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
    """Return the state of lowest energy on a plane of closed states phi + basis y within limits.

    Of springs in one step.  With laws that step is made again from where it led, by springs of their torque and slope
    there, stiffer ones where it climbs; None where a torque falls, so that several states may be lowest near by.
    """
    springs, weight, laws = problem.springs, problem.stiffness, problem.pattern.laws
    if not all(law is None or law.monotone for law in laws):
        return None
    x, stiffer, rest = phi, 1.0, problem.pattern.rest
    for _ in range(MOST_STEPS if laws else 1):
        if laws:
            weight = stiffer * np.maximum(springs.curvature(x), SOFT * problem.stiffness)
            rest = x - springs.torque(x) / weight
        state = _lowest_of_springs(problem, phi, basis, weight, rest)
        if state is None or not laws or np.abs(state - x).max() <= ROUNDED:
            return None if state is None else close(problem, state)
        climbs = springs.energy_change(x, state) > LEVEL * problem.stiffness.sum()
        x, stiffer = (x, 2 * stiffer) if climbs else (state, 1.0)
    return None


def _lowest_of_springs(
    problem: PatternProblem,
    phi: np.ndarray,
    basis: np.ndarray,
    stiffness: np.ndarray,
    rest: np.ndarray,
) -> np.ndarray | None:
    """Return the state of lowest energy of springs on a plane phi + basis y within limits."""
    root = np.sqrt(stiffness)[:, None]
    _, r = np.linalg.qr(root * basis)  # energy = |r y - r y0|^2 / 2 and what stays
    y0 = np.linalg.lstsq(root * basis, root[:, 0] * (rest - phi), rcond=None)[0]
    # in coordinates r y the energy is half a squared distance: the state is the nearest point of a polytope
    limits = problem.fold_limits
    rows = np.linalg.solve(r.T, np.vstack([basis, -basis]).T).T
    y = nearest(r @ y0, rows, np.concatenate([limits.low - phi, phi - limits.high]))
    if y is None:
        return None
    state = phi + basis @ np.linalg.solve(r, y)
    state = limits.hold(state, limits.near(state, 10 * DUPLICATE_TOL))
    state[np.abs(state) < 10 * DUPLICATE_TOL] = 0.0
    return state
