"""SciPy's SLSQP and trust-constr on the package's own programme, with exact gradients (and Hessians)."""

from __future__ import annotations

import importlib.util
import time
import warnings
from typing import Any

import numpy as np

from origami_nlp.bench.attempt import (
    FEASIBLE,
    Attempt,
    Method,
    Pairs,
    Solver,
    StartPoint,
    keep_apart,
)
from origami_nlp.bench.programme import Evaluator, Programme, programme, violation
from origami_nlp.programme import Model

SLSQP_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-15)
TRUST_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
SLSQP_SEARCH, TRUST_SEARCH = (1e-12, 1e-15), (1e-8,)
"""Settings at which whole searches are compared; the others, and raw trust-constr, run on fewer starts."""


def scipy_methods(sweep: bool = True, raw: bool = True) -> list[Method]:
    """Return SLSQP and trust-constr over tolerances, from projected and from raw starts."""
    missing = ""
    if importlib.util.find_spec("scipy") is None:
        missing = "not installed: pip install scipy"
    out = []
    for name, tolerances, search in (
        ("SLSQP", SLSQP_TOLERANCES, SLSQP_SEARCH),
        ("trust-constr", TRUST_TOLERANCES, TRUST_SEARCH),
    ):
        for tolerance in tolerances:
            if sweep or tolerance in search:
                prepare = _Prepare(name, tolerance, raw=False)
                setting = f"tol {tolerance:.0e}"
                out.append(
                    Method(
                        name,
                        setting,
                        name,
                        tolerance,
                        prepare,
                        missing,
                        sweep=tolerance not in search,
                    )
                )
        if raw:
            tolerance = search[0]
            prepare = _Prepare(name, tolerance, raw=True)
            title = f"{name}, raw starts"
            slow = name == "trust-constr"
            out.append(
                Method(title, f"tol {tolerance:.0e}", title, tolerance, prepare, missing, slow)
            )
    return out


class _Prepare:
    """Prepares one of SciPy's methods for a model."""

    def __init__(self, name: str, tolerance: float, raw: bool) -> None:
        self._solve = _slsqp if name == "SLSQP" else _trust_constr
        self._tolerance, self._raw = tolerance, raw

    def __call__(self, model: Model) -> Solver:
        evaluators: dict[Pairs, tuple[Programme, Evaluator]] = {}

        def get(pairs: Pairs) -> tuple[Programme, Evaluator]:
            if pairs not in evaluators:
                built = programme(model.structure, pairs)
                evaluators[pairs] = built, Evaluator(built.oracle, model.parameters.vector)
            return evaluators[pairs]

        def once(x: np.ndarray, pairs: Pairs) -> Attempt:
            begin = time.process_time()
            built, evaluate = get(pairs)
            building = time.process_time() - begin
            bound = built.bound(model)
            z = np.clip(built.begin(model, x), -bound, bound)
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    out = self._solve(built, evaluate, z, bound, self._tolerance)
            except (ValueError, np.linalg.LinAlgError) as error:
                return Attempt(None, False, str(error)[:80], 0, None, building)
            good = bool(out.success) and np.isfinite(out.x).all()
            good = good and violation(evaluate.at(out.x).g, built) <= FEASIBLE
            good = bool(good and (np.abs(out.x) <= bound + FEASIBLE).all())
            answer = out.x[: model.size] if np.isfinite(out.x).all() else None
            return Attempt(answer, good, str(out.message)[:80], int(out.nit), None, building)

        def run(start: StartPoint) -> Attempt:
            return keep_apart(model, start.raw if self._raw else start.x, start.pairs, once)

        get(())
        return run


def _slsqp(
    built: Programme, evaluate: Evaluator, z: np.ndarray, bound: np.ndarray, tolerance: float
) -> Any:
    from scipy.optimize import Bounds, minimize

    equal = np.array(built.equality)
    constraints = [
        {
            "type": "eq",
            "fun": lambda y: evaluate.at(y).g[equal] - built.lower[equal],
            "jac": lambda y: evaluate.at(y).jacobian[equal],
        }
    ]
    if not equal.all():  # every inequality row of the package reads g >= lower
        free = ~equal
        assert np.isinf(built.upper[free]).all()
        constraints.append(
            {
                "type": "ineq",
                "fun": lambda y: evaluate.at(y).g[free] - built.lower[free],
                "jac": lambda y: evaluate.at(y).jacobian[free],
            }
        )
    return minimize(
        lambda y: (float(evaluate.at(y).f[0]), evaluate.gradient.copy()),
        z,
        jac=True,
        method="SLSQP",
        bounds=Bounds(-bound, bound),
        constraints=constraints,
        options={"ftol": tolerance, "maxiter": 300},
    )


def _trust_constr(
    built: Programme, evaluate: Evaluator, z: np.ndarray, bound: np.ndarray, tolerance: float
) -> Any:
    from scipy.optimize import Bounds, NonlinearConstraint, minimize

    nothing = np.zeros(len(built.lower))
    curvature = evaluate.curvature(
        z, 1.0, nothing
    )  # the energy is a quadratic form: constant Hessian
    constraint = NonlinearConstraint(
        lambda y: evaluate.at(y).g.copy(),
        built.lower,
        built.upper,
        jac=lambda y: evaluate.at(y).jacobian.copy(),
        hess=lambda y, v: evaluate.curvature(y, 0.0, v),
    )
    return minimize(
        lambda y: (float(evaluate.at(y).f[0]), evaluate.gradient.copy()),
        z,
        jac=True,
        hess=lambda y: curvature,
        method="trust-constr",
        bounds=Bounds(-bound, bound),
        constraints=[constraint],
        options={
            "gtol": tolerance,
            "xtol": min(tolerance, 1e-8) * 1e-2,
            "barrier_tol": tolerance,
            "maxiter": 500,
        },
    )
