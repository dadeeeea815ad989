"""States beside which closure loses rank: what is to first order one way down is none to the second, or the reverse."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from origami_nlp.numerics import (
    BESIDE_SINGULAR,
    CLOSURE_TOL,
    DUPLICATE_TOL,
    NEAR_SINGULAR_TOL,
    OUTSIDE,
)


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
    whole = math.pi * np.round(phi / math.pi)
    flat = np.abs(phi - whole) < BESIDE_SINGULAR
    near = np.where(flat, whole, phi)
    if np.abs(near - phi).max(initial=0.0) <= OUTSIDE:
        return None
    near, residual = problem.project(near, flat)
    # a sheet drawn with noise: there it misses by what closes within `BESIDE_SINGULAR`, to the square of that
    lost = residual <= BESIDE_SINGULAR**2 and np.abs(near - phi).max() < NEAR_SINGULAR_TOL
    return near if lost and problem.rank(near) < problem.rank(phi, CLOSURE_TOL) else None


def not_told_apart(problem: Any, phi: np.ndarray) -> str:
    """Return why nothing is decided on a state, as it is not told from a singular one beside it; "" where it may be.

    Parameters
    ----------
    problem, phi
        The problem and a closed state, [n] [rad].

    Returns
    -------
    str
        Empty as well where linear springs are at rest, each to `DUPLICATE_TOL`: no state at all has less energy.
    """
    p = problem.parameters
    linear = p.laws is None and p.dead is None
    if linear and (np.abs(problem.torque(phi)) <= DUPLICATE_TOL * p.stiffness).all():
        return ""
    if singular_beside(problem, phi) is None:
        return ""
    return (
        f"not decided: within {BESIDE_SINGULAR:g} rad of a state where closure loses rank, "
        "and not distinguished from it"
    )
