"""Searches that a user would write without this package, for as long as they are given: multi-starts of SciPy's SLSQP,
of NLopt's where it is installed, and of IPOPT.

They get the package's own problem (closure, gaps between facets that are near or that an answer makes cross) with exact
derivatives, and none of its starts: uniform random fold angles, or some of them fully folded at random, closed.  What
they end at is recorded as it comes, with the processor time of the solver alone; nothing is judged here.
"""

from __future__ import annotations

import importlib.util
import math
import os
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

import casadi as ca
import numpy as np

from origami_nlp.kkt import Solve
from origami_nlp.numerics import ANSWERED
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.problem import Contact
from origami_nlp.search import OPTIONS, Solved, solve_apart

TOLERANCE = 1e-12
"""Of SLSQP; 1e-8 of IPOPT."""
MOST_ITERATIONS = 100
"""Of SLSQP, SciPy's default: what has not converged by then hardly ever does, and takes time from other starts."""
FEASIBLE = ANSWERED
"""An answer that violates a constraint by more is not claimed, whatever a solver's status says."""

Answer = tuple[np.ndarray, bool]
"""Fold angles [n], and whether the solver says that it succeeded."""


class Program:
    """min f(x) with lower <= g(x) <= upper, low <= x <= high: closure, and the gaps that are rows.

    `at(x)` evaluates f [1], gradient [n], g [m] and Jacobian [m, n], overwritten by the next call at another x.
    """

    def __init__(self, problem: PatternProblem, start: np.ndarray, rows: Sequence[Contact]) -> None:
        symbols = problem.symbols()
        nlp = symbols.nlp(start, rows)
        self.p, self.lower, self.upper = symbols.values, nlp.lower, nlp.upper
        self.low, self.high = problem.fold_limits.low, problem.fold_limits.high
        self.form = {"x": nlp.x, "p": nlp.p, "f": nlp.f, "g": nlp.g}
        self.equal = np.array(self.lower == self.upper)
        every = (nlp.f, ca.gradient(nlp.f, nlp.x), nlp.g, ca.jacobian(nlp.g, nlp.x))
        self._function = ca.Function("first", [nlp.x, nlp.p], [ca.densify(e) for e in every])
        self._x, m = np.zeros(problem.size), len(self.lower)
        self.f, self.gradient, self.g = np.zeros(1), np.zeros(problem.size), np.zeros(m)
        self.jacobian = np.zeros((m, problem.size), order="F")
        buffer: Any
        buffer, self._call = self._function.buffer()
        for i, a in enumerate((self._x, self.p)):
            buffer.set_arg(i, memoryview(a))  # type: ignore[arg-type]
        for i, r in enumerate((self.f, self.gradient, self.g, self.jacobian)):
            buffer.set_res(i, memoryview(r.ravel(order="K")))  # type: ignore[arg-type]
        self._buffer, self._last = buffer, b""

    def at(self, x: np.ndarray) -> Program:
        """Evaluate at x, once for repeated x."""
        key = x.tobytes()
        if key != self._last:
            self._x[:] = x
            self._call()
            self._last = key
        return self

    def violation(self, x: np.ndarray) -> float:
        """Return the largest violation of rows and bounds at x, inf if not finite."""
        if not np.isfinite(x).all():
            return math.inf
        g = self.at(x).g
        off = [self.lower - g, g - self.upper, self.low - x, x - self.high]
        return float(np.concatenate(off).max(initial=0.0))


def slsqp(program: Program, x: np.ndarray) -> Answer:
    """Solve by SciPy's SLSQP."""
    from scipy.optimize import Bounds, minimize

    rows = [
        {
            "type": kind,
            "fun": lambda y, of=of: program.at(y).g[of] - program.lower[of],
            "jac": lambda y, of=of: program.at(y).jacobian[of],
        }
        for kind, of in (("eq", program.equal), ("ineq", ~program.equal))
        if of.any()
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        out = minimize(
            lambda y: (float(program.at(y).f[0]), program.gradient.copy()),
            x,
            jac=True,
            method="SLSQP",
            bounds=Bounds(program.low, program.high),
            constraints=rows,
            options={"ftol": TOLERANCE, "maxiter": MOST_ITERATIONS},
        )
    return out.x, bool(out.success)


def nlopt_slsqp(program: Program, x: np.ndarray) -> Answer:
    """Solve by NLopt's SLSQP (`pip install nlopt`)."""
    import nlopt

    solver = nlopt.opt(nlopt.LD_SLSQP, len(x))

    def objective(y: np.ndarray, gradient: np.ndarray) -> float:
        at = program.at(y)
        if gradient.size:
            gradient[:] = at.gradient
        return float(at.f[0])

    def rows(of: np.ndarray, result: np.ndarray, y: np.ndarray, gradient: np.ndarray) -> None:
        at = program.at(y)
        if gradient.size:
            gradient[:] = -at.jacobian[of]
        result[:] = program.lower[of] - at.g[of]

    solver.set_min_objective(objective)
    for of, add in (
        (np.flatnonzero(program.equal), solver.add_equality_mconstraint),
        (np.flatnonzero(~program.equal), solver.add_inequality_mconstraint),
    ):
        if len(of):
            room = np.full(len(of), TOLERANCE)
            add(lambda result, y, gradient, of=of: rows(of, result, y, gradient), room)
    solver.set_lower_bounds(program.low)
    solver.set_upper_bounds(program.high)
    solver.set_xtol_rel(TOLERANCE)
    solver.set_maxeval(3 * MOST_ITERATIONS)
    try:
        answer, said = solver.optimize(x), solver.last_optimize_result()
    except (nlopt.runtime_error, nlopt.RoundoffLimited, RuntimeError):
        return x, False
    return answer, said != nlopt.MAXEVAL_REACHED


def ipopt(program: Program) -> Callable[[np.ndarray], Answer]:
    """Build IPOPT with the package's options at a tolerance of 1e-8."""
    tight = dict.fromkeys(("tol", "constr_viol_tol", "compl_inf_tol"), 1e-8)
    options: Any = {"print_time": False, "error_on_fail": False, "ipopt": {**OPTIONS, **tight}}
    solver = ca.nlpsol("rival", "ipopt", program.form, options)
    bounds = {"lbx": program.low, "ubx": program.high, "lbg": program.lower, "ubg": program.upper}

    def solve(x: np.ndarray) -> Answer:
        out = solver(x0=x, p=program.p, **bounds)
        return np.asarray(out["x"]).ravel(), bool(solver.stats()["success"])

    return solve


def uniform(problem: PatternProblem, rng: np.random.Generator) -> np.ndarray:
    """Draw fold angles uniformly."""
    return rng.uniform(problem.fold_limits.low, problem.fold_limits.high)


def at_limit(problem: PatternProblem, rng: np.random.Generator) -> np.ndarray:
    """Draw fold angles uniformly, then fully folded (+-pi) a random share of them."""
    x = uniform(problem, rng)
    return np.where(rng.random(problem.size) < rng.random(), np.copysign(np.pi, x), x)


@dataclass(frozen=True)
class Rival:
    """A search: its name, what builds its solver of a program, and how a start is drawn."""

    name: str
    build: Callable[[Program], Callable[[np.ndarray], Answer]]
    start: Callable[[PatternProblem, np.random.Generator], np.ndarray] = uniform


def rivals() -> list[Rival]:
    """Return the searches that can run here."""
    out = [
        Rival("SLSQP", lambda program: partial(slsqp, program)),
        Rival("SLSQP, some fully folded", lambda program: partial(slsqp, program), at_limit),
        Rival("IPOPT", ipopt),
    ]
    if importlib.util.find_spec("nlopt"):
        out.append(Rival("NLopt SLSQP", lambda program: partial(nlopt_slsqp, program)))
    return out


@dataclass(frozen=True)
class Ends:
    """Where the attempts of one search ended.

    seconds: processor time that the solver has taken by the end of each attempt [a].  claims: whether the method says
    that it is a minimum and constraints hold to 1e-6 [a].  x: the state [a, n].
    """

    name: str
    seconds: np.ndarray
    claims: np.ndarray
    x: np.ndarray


def run_rival(rival: Rival, problem: PatternProblem, seed: int, budget: float) -> Ends:
    """Run a search until its solver has taken `budget` seconds of processor time (what is under way is finished)."""
    rng, spent = np.random.default_rng([seed, 7]), 0.0

    def solver(problem: PatternProblem, start: np.ndarray, rows: Sequence[Contact]) -> Solved:
        nonlocal spent
        program = Program(problem, start, rows)
        solve = rival.build(program)
        begin = time.process_time()
        try:
            x, good = solve(start)
        except (ValueError, RuntimeError, np.linalg.LinAlgError):
            x, good = start, False
        spent += time.process_time() - begin
        residual = program.violation(x)
        x = problem.fold_limits.clip(x) if residual < math.inf else start
        good = good and max(residual, problem.residual(x)) <= FEASIBLE
        status = "Solve_Succeeded" if good else "failed"
        return Solve(x, status, 0, residual, np.zeros(len(x))), (), np.zeros(0)

    seconds: list[float] = []
    answers: list[Solve] = []
    with silence():
        while spent < budget:
            start = rival.start(problem, rng)
            answers.append(solve_apart(problem, start, solver)[0])
            seconds.append(spent)
    claims = np.array([a.succeeded for a in answers])
    return Ends(rival.name, np.array(seconds), claims, np.array([a.x for a in answers]))


@contextmanager
def silence() -> Iterator[None]:
    """Send what compiled solvers print to nowhere (they write to the file descriptors themselves)."""
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
