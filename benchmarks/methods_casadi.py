"""IPOPT alone, and CasADi's other solvers that ship in its wheel, on the package's own problem."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
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
from benchmarks.nonlinear_program import Problem, problem, violation
from origami_nlp.minima import OPTIONS
from origami_nlp.problem import Model, Structure

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
QUIET_QP = {
    "print_iter": False,
    "print_header": False,
    "print_info": False,
    "error_on_fail": False,
    "max_iter": 200,
}
QUIET_SQP = {"print_header": False, "print_iteration": False, "print_status": False}


def ipopt_options(tolerance: float, hessian: str = "exact", ours: bool = True) -> dict[str, Any]:
    """Return nlpsol options for IPOPT alone: the package's own ones (or IPOPT's defaults) at a tolerance."""
    options = dict(OPTIONS) if ours else {"print_level": 0, "sb": "yes"}
    options["tol"] = tolerance
    if ours:  # the other tolerances are absolute and would stop at 1e-4 or 1e-6 on their own scale
        options |= {"constr_viol_tol": tolerance, "compl_inf_tol": tolerance}
    if hessian == "l-bfgs":
        options |= {"hessian_approximation": "limited-memory", "max_iter": 400}
    return {"ipopt": options}


OTHERS: dict[str, dict[str, Any]] = {
    "sqpmethod": {
        "qpsol": "qrqp",
        "qpsol_options": QUIET_QP,
        "convexify_strategy": "regularize",
        "max_iter": 100,
        **QUIET_SQP,
    },
    "feasiblesqpmethod": {
        "qpsol": "qrqp",
        "qpsol_options": QUIET_QP,
        "max_iter": 100,
        **QUIET_SQP,
    },
    "fatrop": {"fatrop": {"print_level": 0}, "structure_detection": "none"},
    "uno": {"uno": {"logger": "SILENT"}},
    "sleqp": {"print_level": 0},
    "alpaqa": {"alpaqa": {"alm.tolerance": 1e-9, "alm.dual_tolerance": 1e-9}},
}
"""Other solvers and the options that served them best here; tolerances are their defaults, but
for alpaqa, whose defaults leave constraints open by 1e-5."""

LEFT_OUT = {
    "bonmin": "a mixed-integer solver: without integers it is IPOPT",
    "blocksqp": "needs the linear solver MA27 (libhsl), which the wheel does not hold",
    "qrsqp": "its QP solver stops with an error at the first indefinite Hessian, and no option reaches it",
    "scpgen": "accepts MX problems only, and is marked as under development",
}
"""Solvers of the wheel that do not run on this problem."""


def ipopt_alone(sweep: bool = True) -> list[Method]:
    """Return IPOPT without polish: exact Hessian and L-BFGS over tolerances, and IPOPT's own defaults."""
    out = []
    for tolerance in TOLERANCES:
        if sweep or tolerance == 1e-8:
            for hessian, name in (("exact", "IPOPT alone"), ("l-bfgs", "IPOPT L-BFGS")):
                options = ipopt_options(tolerance, hessian)
                out.append(
                    _method(
                        name, f"tol {tolerance:.0e}", tolerance, "ipopt", options, tolerance != 1e-8
                    )
                )
    out.append(
        _method("IPOPT, its defaults", "", 1e-8, "ipopt", ipopt_options(1e-8, ours=False), True)
    )
    return out


def others(names: tuple[str, ...] = tuple(OTHERS)) -> list[Method]:
    """Return the other solvers of the wheel; one that is not there says so."""
    return [_method(name, "", 1e-8, name, OTHERS[name], sweep=True) for name in names]


def _method(
    name: str,
    setting: str,
    accuracy: float,
    plugin: str,
    options: dict[str, Any],
    sweep: bool = False,
) -> Method:
    missing = "" if ca.has_nlpsol(plugin) else f"this CasADi has no solver '{plugin}'"
    return Method(name, setting, name, accuracy, _Prepare(plugin, _freeze(options)), missing, sweep)


def _freeze(options: Any) -> Any:
    """Turn nested options into a hashable value."""
    if isinstance(options, dict):
        return tuple((key, _freeze(value)) for key, value in options.items())
    return options


def _thaw(options: Any) -> Any:
    return {key: _thaw(value) for key, value in options} if isinstance(options, tuple) else options


class _Prepare:
    """Prepares one plugin with one set of options for a model."""

    def __init__(self, plugin: str, options: Any) -> None:
        self._plugin, self._options = plugin, options

    def __call__(self, model: Model) -> Solver:
        def once(x: np.ndarray, pairs: Pairs) -> Attempt:
            begin = time.process_time()
            built = problem(model.structure, pairs)
            solver = _solver(model.structure, pairs, self._plugin, self._options)
            building = time.process_time() - begin
            return _solve(model, built, solver, x, building)

        def run(start: StartPoint) -> Attempt:
            return keep_apart(model, start.x, start.pairs, once)

        if model.structure.pairs:
            _solver(model.structure, model.structure.pairs[:6], self._plugin, self._options)
        _solver(model.structure, (), self._plugin, self._options)
        return run


@lru_cache(maxsize=4096)
def _solver(structure: Structure, pairs: Pairs, plugin: str, options: Any) -> ca.Function:
    built = problem(structure, pairs)
    given = {"print_time": False, "error_on_fail": False, **_thaw(options)}
    if plugin == "fatrop":
        given["equality"] = built.equality
    with silence():
        return ca.nlpsol("rival", plugin, built.oracle, given)


def _solve(
    model: Model, built: Problem, solver: ca.Function, x: np.ndarray, building: float
) -> Attempt:
    bound = built.bound(model)
    try:
        out = solver(
            x0=built.begin(model, x),
            p=model.parameters.vector,
            lbx=-bound,
            ubx=bound,
            lbg=built.lower,
            ubg=built.upper,
        )
    except RuntimeError as error:  # a plugin that gives up with an exception
        return Attempt(None, False, str(error).splitlines()[-1][:80], 0, None, building)
    stats = solver.stats()
    n = model.size
    answer = np.asarray(out["x"]).ravel()
    good = bool(stats.get("success")) and violation(np.asarray(out["g"]).ravel(), built) <= FEASIBLE
    good &= bool((np.abs(answer) <= bound + FEASIBLE).all())
    return Attempt(
        answer[:n] if np.isfinite(answer).all() else None,
        good,
        str(stats.get("return_status", stats.get("unified_return_status", ""))),
        int(stats.get("iter_count", 0) or 0),
        np.abs(np.asarray(out["lam_x"]).ravel()[:n]),
        building,
    )


@contextmanager
def silence() -> Iterator[None]:
    """Send what compiled solvers print to nowhere (they write to the file descriptors themselves)."""
    import sys

    sys.stdout.flush()
    sys.stderr.flush()
    kept, nowhere = (os.dup(1), os.dup(2)), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        for number, copy in enumerate(kept, start=1):
            os.dup2(copy, number)
            os.close(copy)
        os.close(nowhere)
