"""Small linear and convex quadratic programmes, solved by HiGHS through CasADi."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

MOST_ITERATIONS = 10_000
"""Far more than programmes of a few contacts need."""


@lru_cache(maxsize=128)
def _solver(n: int, m: int, quadratic: bool) -> ca.Function:
    sparsity = {
        "h": ca.Sparsity.diag(n) if quadratic else ca.Sparsity(n, n),
        "a": ca.Sparsity.dense(m, n),
    }
    highs = {
        "output_flag": False,
        "primal_feasibility_tolerance": 1e-10,
        "dual_feasibility_tolerance": 1e-10,
        # without limits its active-set method can cycle for ever: seen where rows are nearly parallel
        "simplex_iteration_limit": MOST_ITERATIONS,
        "qp_iteration_limit": MOST_ITERATIONS,
    }
    options: dict[str, Any] = {"print_time": False, "error_on_fail": False, "highs": highs}
    return ca.conic("small", "highs", sparsity, options)


def minimise(
    cost: np.ndarray,
    rows: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    x_lower: np.ndarray | float,
    x_upper: np.ndarray | float,
    *,
    squares: bool = False,
) -> np.ndarray | None:
    """Minimise cost . x (plus |x|^2 / 2 with `squares`) over lower <= rows x <= upper and bounds on
    x.

    Returns the minimiser [n], or None where there is none, or none was found in `MOST_ITERATIONS`.
    """
    m, n = rows.shape
    solver = _solver(n, m, squares)
    out = solver(
        h=ca.DM.eye(n) if squares else ca.DM(n, n),
        g=cost,
        a=rows,
        lba=lower,
        uba=upper,
        lbx=x_lower,
        ubx=x_upper,
    )
    if not solver.stats()["success"]:
        return None
    return np.asarray(out["x"]).ravel()
