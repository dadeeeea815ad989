"""Starts of a sheet brought onto closure."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, EXPLORED, RESOLVED
from origami_nlp.pattern_problem import PatternProblem

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
