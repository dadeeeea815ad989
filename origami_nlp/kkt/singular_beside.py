"""States beside which closure loses rank: what is to first order one way down is none to the second, or the reverse."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from origami_nlp.numerics import BESIDE_SINGULAR, CLOSURE_TOL, NEAR_SINGULAR_TOL, OUTSIDE


def singular_beside(problem: Any, phi: np.ndarray) -> np.ndarray | None:
    """Return the state at which creases are flat or fully folded that all but are, if closure loses rank there.

    Beside such a state whatever obeys closure to first order closes to the square of the distance: to rounding.

    Parameters
    ----------
    problem, phi
        The problem and a closed state, [n] [rad].

    Returns
    -------
    numpy.ndarray or None
        That state, [n]; None where there is none, or it is this one.

    Examples
    --------
    >>> import math, numpy as np, origami_nlp as o
    >>> from origami_nlp.pattern_problem import PatternProblem
    >>> from origami_nlp.kkt import singular_beside
    >>> problem = PatternProblem(o.examples.pattern("miura", 2, 2))
    >>> singular_beside(problem, np.zeros(4)) is None, singular_beside(problem, np.full(4, 1e-13)) is None
    (True, True)
    """
    at_limit, flat = math.pi - np.abs(phi) < BESIDE_SINGULAR, np.abs(phi) < BESIDE_SINGULAR
    near = np.where(at_limit, np.copysign(math.pi, phi), np.where(flat, 0.0, phi))
    if np.abs(near - phi).max(initial=0.0) <= OUTSIDE:
        return None
    near, residual = problem.project(near, at_limit | flat)
    # a sheet drawn with noise: there it misses by what closes within `BESIDE_SINGULAR`, to the square of that
    lost = residual <= BESIDE_SINGULAR**2 and np.abs(near - phi).max() < NEAR_SINGULAR_TOL
    return near if lost and problem.rank(near) < problem.rank(phi, CLOSURE_TOL) else None
