"""SciPy's SLSQP and trust-constr on the package's own problem, with exact gradients (and Hessians)."""

from __future__ import annotations

import importlib.util
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from benchmarks.attempt import (
    FEASIBLE,
    Attempt,
    Method,
    Pairs,
    Solver,
    StartPoint,
    keep_apart,
)
from benchmarks.nonlinear_program import Evaluator, Problem, problem, violation
from origami_nlp.problem import Model, pose_with_gaps

SLSQP_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-15)
TRUST_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
SLSQP_SEARCH, TRUST_SEARCH = (1e-12, 1e-15), (1e-8,)
"""Settings at which whole searches are compared; the others, and raw trust-constr, run on fewer starts."""


def scipy_methods(sweep: bool = True, raw: bool = True) -> list[Method]:
    """Return SLSQP and trust-constr over tolerances, from projected and from raw starts."""
    missing = ""
    if importlib.util.find_spec("scipy") is None:
        missing = "not installed: pip install scipy"
    solvers: dict[str, Solve] = {"SLSQP": _slsqp, "trust-constr": _trust_constr}
    out = []
    for name, tolerances, search in (
        ("SLSQP", SLSQP_TOLERANCES, SLSQP_SEARCH),
        ("trust-constr", TRUST_TOLERANCES, TRUST_SEARCH),
    ):
        for tolerance in tolerances:
            if sweep or tolerance in search:
                prepare = Prepare(solvers[name], tolerance)
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
            prepare = Prepare(solvers[name], tolerance, raw=True)
            title = f"{name}, raw starts"
            slow = name == "trust-constr"
            out.append(
                Method(title, f"tol {tolerance:.0e}", title, tolerance, prepare, missing, slow)
            )
    return out


Solve = Callable[..., Any]
"""Solves a problem from z within a bound to a tolerance: x, success, message, nit, as SciPy returns them."""


class Prepare:
    """Prepares a local method for a model."""

    def __init__(self, solve: Solve, tolerance: float, raw: bool = False) -> None:
        self._solve, self._tolerance, self._raw = solve, tolerance, raw

    def __call__(self, model: Model) -> Solver:
        """Return what solves from a start; functions of the model are compiled now."""
        evaluators: dict[Pairs, tuple[Problem, Evaluator]] = {}

        def get(pairs: Pairs) -> tuple[Problem, Evaluator]:
            if pairs not in evaluators:
                built = problem(model.structure, pairs)
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
    built: Problem,
    evaluate: Evaluator | _Rows,
    z: np.ndarray,
    bound: np.ndarray,
    tolerance: float,
) -> Any:
    from scipy.optimize import Bounds, minimize

    return minimize(
        _objective(evaluate),
        z,
        jac=True,
        method="SLSQP",
        bounds=Bounds(-bound, bound),
        constraints=_constraints(built, evaluate),
        options={"ftol": tolerance, "maxiter": MOST_ITERATIONS},
    )


def _objective(evaluate: Evaluator | _Rows) -> Callable[[np.ndarray], tuple[float, np.ndarray]]:
    return lambda y: (float(evaluate.at(y).f[0]), evaluate.gradient.copy())


def _constraints(built: Problem, evaluate: Evaluator | _Rows) -> list[dict[str, Any]]:
    """Return the rows of a problem as SLSQP takes them."""
    equal = np.array(built.equality)
    if equal.all() and not built.lower.any():
        return [
            {
                "type": "eq",
                "fun": lambda y: evaluate.at(y).g.copy(),
                "jac": lambda y: evaluate.at(y).jacobian.copy(),
            }
        ]
    free = ~equal  # every inequality row of the package reads g >= lower
    assert np.isinf(built.upper[free]).all()
    return [
        {
            "type": kind,
            "fun": lambda y, rows=rows: evaluate.at(y).g[rows] - built.lower[rows],
            "jac": lambda y, rows=rows: evaluate.at(y).jacobian[rows],
        }
        for kind, rows in (("eq", equal), ("ineq", free))
        if rows.any()
    ]


MOST_ITERATIONS = 100
"""Of SLSQP, SciPy's default: what has not converged by then hardly ever does, and takes time from other starts."""
HOPS = 50
"""Hops of a chain of basin hopping before it starts anew."""
HOP = 0.5
"""Largest change of a fold angle by a hop [rad]: SciPy's default."""


Record = Callable[[Attempt], bool]
"""Files an attempt; whether there is time for more."""


class _Stop(Exception):
    """Time is up: SciPy's own callback is not called for answers that fail."""


def basin_hopping(model: Model) -> Callable[[np.ndarray, np.random.Generator, Record], bool]:
    """Return what runs one chain of SciPy's basin hopping over SLSQP from x [n] and files every local answer.

    Facets that cross are not kept apart: a chain cannot say which of its answers needs a plane.  A chain stops as
    soon as `record` returns false, and returns that.
    """
    from scipy.optimize import basinhopping

    built = problem(model.structure, ())
    evaluate = Evaluator(built.oracle, model.parameters.vector)
    bound = built.bound(model)

    def chain(x: np.ndarray, rng: np.random.Generator, record: Record) -> bool:
        def local(fun: Any, start: np.ndarray, **rest: Any) -> Any:
            out = _slsqp(built, evaluate, np.clip(start, -bound, bound), bound, SLSQP_SEARCH[0])
            good = bool(out.success) and violation(evaluate.at(out.x).g, built) <= FEASIBLE
            if not record(Attempt(out.x, good, str(out.message)[:80], int(out.nit))):
                raise _Stop
            return out

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                basinhopping(
                    _objective(evaluate),
                    x,
                    HOPS,
                    stepsize=HOP,
                    rng=rng,
                    minimizer_kwargs={"method": local},
                )
            except _Stop:
                return False
        return True

    return chain


HELD = (0.1, 0.6, 0.3)
"""Share of starts that hold no contact, one, and two."""


def contacts_held(model: Model) -> Callable[[np.ndarray, np.random.Generator, Record], bool]:
    """Return what runs SLSQP from x [n] with a facet-pair gap or two, drawn at random, held at zero.

    What it ends at is stationary along contacts that need not press, and facets elsewhere may cross: where minima may
    be, for whoever polishes them.
    """
    nlp = pose_with_gaps(model.structure, tuple(range(len(model.structure.gaps))))
    oracle = ca.Function("gaps", [nlp.x, nlp.p], [nlp.f, nlp.g])
    evaluate = Evaluator(oracle, model.parameters.vector)
    first = model.equation_count
    pairs = [first + i for i, g in enumerate(model.structure.gaps) if g.type == "facet-pair"]
    bound = np.full(model.size, model.bound)

    def run(x: np.ndarray, rng: np.random.Generator, record: Record) -> bool:
        count = min(int(rng.choice(3, p=HELD)), len(pairs))
        rows = (
            [*range(first), *rng.choice(pairs, count, replace=False)] if count else [*range(first)]
        )
        built = Problem(oracle, np.zeros(len(rows)), np.zeros(len(rows)), ())
        held = _Rows(evaluate, np.array(rows, dtype=int))
        try:
            out = _slsqp(built, held, x, bound, SLSQP_SEARCH[0])
        except (ValueError, np.linalg.LinAlgError) as error:
            return record(Attempt(None, False, str(error)[:80]))
        good = bool(out.success) and violation(held.at(out.x).g, built) <= FEASIBLE
        return record(Attempt(out.x, good, str(out.message)[:80], int(out.nit)))

    return run


@dataclass(frozen=True)
class _Rows:
    """Some rows of an evaluator's constraints."""

    whole: Evaluator
    rows: np.ndarray

    def at(self, z: np.ndarray) -> _Rows:
        self.whole.at(z)
        return self

    @property
    def f(self) -> np.ndarray:
        return self.whole.f

    @property
    def gradient(self) -> np.ndarray:
        return self.whole.gradient

    @property
    def g(self) -> np.ndarray:
        return self.whole.g[self.rows]

    @property
    def jacobian(self) -> np.ndarray:
        return self.whole.jacobian[self.rows]


def _trust_constr(
    built: Problem, evaluate: Evaluator, z: np.ndarray, bound: np.ndarray, tolerance: float
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
