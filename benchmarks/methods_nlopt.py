"""NLopt's SLSQP on the package's own problem, with exact gradients: `pip install nlopt`."""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass

import numpy as np

from benchmarks.attempt import FEASIBLE, Method
from benchmarks.methods_scipy import MOST_ITERATIONS, Prepare
from benchmarks.nonlinear_program import Evaluator, Problem

TOLERANCE = 1e-12
"""Of steps, relative, and of constraints: that of SciPy's SLSQP in searches."""


def nlopt_slsqp() -> Method:
    """Return NLopt's SLSQP, from projected starts."""
    found = importlib.util.find_spec("nlopt") is not None
    missing = "" if found else "not installed: pip install nlopt"
    name = "NLopt SLSQP"
    return Method(
        name, f"tol {TOLERANCE:.0e}", name, TOLERANCE, Prepare(_solve, TOLERANCE), missing
    )


@dataclass(frozen=True)
class _Answer:
    """What SciPy's methods return, of NLopt."""

    x: np.ndarray
    success: bool
    message: str
    nit: int


def _solve(
    built: Problem, evaluate: Evaluator, z: np.ndarray, bound: np.ndarray, tolerance: float
) -> _Answer:
    import nlopt

    equal = np.array(built.equality)
    solver = nlopt.opt(nlopt.LD_SLSQP, len(z))

    def objective(y: np.ndarray, gradient: np.ndarray) -> float:
        at = evaluate.at(y)
        if gradient.size:
            gradient[:] = at.gradient
        return float(at.f[0])

    def rows(which: np.ndarray, result: np.ndarray, y: np.ndarray, gradient: np.ndarray) -> None:
        at = evaluate.at(y)
        if gradient.size:
            gradient[:] = -at.jacobian[which]
        result[:] = built.lower[which] - at.g[which]

    solver.set_min_objective(objective)
    for which, add in (
        (np.flatnonzero(equal), solver.add_equality_mconstraint),
        (np.flatnonzero(~equal), solver.add_inequality_mconstraint),
    ):
        if len(which):
            add(
                lambda result, y, gradient, which=which: rows(which, result, y, gradient),
                np.full(len(which), tolerance),
            )
    solver.set_lower_bounds(-bound)
    solver.set_upper_bounds(bound)
    solver.set_xtol_rel(tolerance)
    solver.set_maxeval(3 * MOST_ITERATIONS)
    try:
        x, said = solver.optimize(z), solver.last_optimize_result()
    except (nlopt.runtime_error, nlopt.RoundoffLimited, RuntimeError) as error:
        return _Answer(z, False, str(error), solver.get_numevals())
    stopped = said in (nlopt.MAXEVAL_REACHED, nlopt.MAXTIME_REACHED)
    worst = np.abs(evaluate.at(x).g[equal] - built.lower[equal]).max(initial=0.0)
    return _Answer(x, not stopped and worst <= FEASIBLE, f"NLopt {said}", solver.get_numevals())
