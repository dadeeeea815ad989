"""Searches that a user would write without this package, for as long as they are given: multi-starts of SciPy's SLSQP,
of NLopt's where it is installed, and of IPOPT.

They get the package's own problem (closure, planes between facets that an answer makes cross) with exact derivatives,
and none of its starts: uniform random fold angles, or some of them fully folded at random.  What they end at is
recorded as it comes, with the processor time; nothing is judged here.
"""

from __future__ import annotations

import importlib.util
import math
import os
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from origami_nlp.minima import MOST_PAIR_ROUNDS, OPTIONS, build_solver
from origami_nlp.numerics import ANSWERED
from origami_nlp.problem import Model, separating_normal

TOLERANCE = 1e-12
"""Of SLSQP; 1e-8 of IPOPT."""
MOST_ITERATIONS = 100
"""Of SLSQP, SciPy's default: what has not converged by then hardly ever does, and takes time from other starts."""
FEASIBLE = ANSWERED
"""An answer that violates a constraint by more is not claimed, whatever a solver's status says."""

Pairs = tuple[tuple[int, int], ...]
Solve = Callable[["Program", np.ndarray], tuple[np.ndarray, bool]]
"""Solves a program from z: the answer, and whether the solver says that it succeeded."""


class Program:
    """min f(z) with lower <= g(z) <= upper and |z| <= bound: fold angles [n], and one plane [3] for each pair.

    `at(z)` evaluates f [1], gradient [k], g [m] and Jacobian [m, k], overwritten by the next call at another z.
    """

    def __init__(self, model: Model, pairs: Pairs) -> None:
        built = build_solver(model.structure, pairs, 1e-8)
        self.model, self.pairs, self.oracle = model, pairs, built.solver.oracle()
        self.lower, self.upper = built.lower, built.upper
        self.equal = np.array(self.lower == self.upper)
        self.bound = np.concatenate(
            [np.full(model.size, model.bound), np.full(3 * len(pairs), 1.5)]
        )
        count, rows = self.oracle.size1_in(0), self.oracle.size1_out(1)
        z, p = ca.SX.sym("z", count), ca.SX.sym("p", self.oracle.size1_in(1))
        f, g = self.oracle(z, p)
        dense = [ca.densify(e) for e in (f, ca.gradient(f, z), g, ca.jacobian(g, z))]
        self._function = ca.Function("first", [z, p], dense)
        self._z, self._p = np.zeros(count), np.array(model.parameters.vector, dtype=float)
        self.f, self.gradient, self.g = np.zeros(1), np.zeros(count), np.zeros(rows)
        self.jacobian = np.zeros((rows, count), order="F")
        buffer: Any
        buffer, self._call = self._function.buffer()
        for i, a in enumerate((self._z, self._p)):
            buffer.set_arg(i, memoryview(a))  # type: ignore[arg-type]
        for i, r in enumerate((self.f, self.gradient, self.g, self.jacobian)):
            buffer.set_res(i, memoryview(r.ravel(order="K")))  # type: ignore[arg-type]
        self._buffer, self._last = buffer, b""

    def begin(self, x: np.ndarray) -> np.ndarray:
        """Return z at fold angles x, planes where the package starts them."""
        rays = self.model.rays(x)
        z = np.concatenate([x, *(separating_normal(rays, pair) for pair in self.pairs)])
        return np.clip(z, -self.bound, self.bound)

    def at(self, z: np.ndarray) -> Program:
        """Evaluate at z, once for repeated z."""
        key = z.tobytes()
        if key != self._last:
            self._z[:] = z
            self._call()
            self._last = key
        return self

    def violation(self, z: np.ndarray) -> float:
        """Return the largest violation of rows and bounds at z, inf if not finite."""
        if not np.isfinite(z).all():
            return math.inf
        g = self.at(z).g
        rows = np.maximum(self.lower - g, g - self.upper)
        return float(max(rows.max(initial=0.0), (np.abs(z) - self.bound).max()))


def slsqp(program: Program, z: np.ndarray) -> tuple[np.ndarray, bool]:
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
            z,
            jac=True,
            method="SLSQP",
            bounds=Bounds(-program.bound, program.bound),
            constraints=rows,
            options={"ftol": TOLERANCE, "maxiter": MOST_ITERATIONS},
        )
    return out.x, bool(out.success)


def nlopt_slsqp(program: Program, z: np.ndarray) -> tuple[np.ndarray, bool]:
    """Solve by NLopt's SLSQP (`pip install nlopt`)."""
    import nlopt

    solver = nlopt.opt(nlopt.LD_SLSQP, len(z))

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
    solver.set_lower_bounds(-program.bound)
    solver.set_upper_bounds(program.bound)
    solver.set_xtol_rel(TOLERANCE)
    solver.set_maxeval(3 * MOST_ITERATIONS)
    try:
        x, said = solver.optimize(z), solver.last_optimize_result()
    except (nlopt.runtime_error, nlopt.RoundoffLimited, RuntimeError):
        return z, False
    return x, said != nlopt.MAXEVAL_REACHED


class Ipopt:
    """IPOPT with the package's options at a tolerance of 1e-8; solvers are kept by their pairs."""

    def __init__(self) -> None:
        tight = dict.fromkeys(("tol", "constr_viol_tol", "compl_inf_tol"), 1e-8)
        self._options: dict[str, Any] = {"print_time": False, "ipopt": {**OPTIONS, **tight}}
        self._solvers: dict[Pairs, ca.Function] = {}

    def __call__(self, program: Program, z: np.ndarray) -> tuple[np.ndarray, bool]:
        """Solve from z."""
        if program.pairs not in self._solvers:
            made = ca.nlpsol("rival", "ipopt", program.oracle, self._options)
            self._solvers[program.pairs] = made
        solver, bound = self._solvers[program.pairs], program.bound
        out = solver(
            x0=z,
            p=program.model.parameters.vector,
            lbx=-bound,
            ubx=bound,
            lbg=program.lower,
            ubg=program.upper,
        )
        return np.asarray(out["x"]).ravel(), bool(solver.stats()["success"])


def uniform(model: Model, rng: np.random.Generator) -> np.ndarray:
    """Draw fold angles uniformly."""
    return rng.uniform(-model.bound, model.bound, model.size)


def at_limit(model: Model, rng: np.random.Generator) -> np.ndarray:
    """Draw fold angles uniformly, then fully folded (+-pi) a random share of them."""
    x = uniform(model, rng)
    return np.where(rng.random(model.size) < rng.random(), np.copysign(np.pi, x), x)


@dataclass(frozen=True)
class Rival:
    """A search: its name, what makes its solver (of a model), and how a start is drawn."""

    name: str
    make: Callable[[], Solve]
    start: Callable[[Model, np.random.Generator], np.ndarray] = uniform


def rivals() -> list[Rival]:
    """Return the searches that can run here."""
    out = [
        Rival("SLSQP", lambda: slsqp),
        Rival("SLSQP, some fully folded", lambda: slsqp, at_limit),
        Rival("IPOPT", Ipopt),
    ]
    if importlib.util.find_spec("nlopt"):
        out.append(Rival("NLopt SLSQP", lambda: nlopt_slsqp))
    return out


@dataclass(frozen=True)
class Ends:
    """Where the attempts of one search ended.

    seconds: processor time at the end of each attempt, from the first start [a].  claims: whether the method says that
    it is a minimum and constraints hold to 1e-6 [a].  x: the state [a, n]; NaN where there is none.
    """

    name: str
    seconds: np.ndarray
    claims: np.ndarray
    x: np.ndarray


def run_rival(rival: Rival, model: Model, seed: int, budget: float) -> Ends:
    """Run a search for `budget` seconds of processor time (the attempt under way is finished)."""
    rng, programs = np.random.default_rng([seed, 7]), dict[Pairs, Program]()
    solve = rival.make()

    def attempt(x: np.ndarray) -> tuple[np.ndarray, bool]:
        """Solve; facet pairs that the answer makes cross get a plane, and it is solved again, as the package does."""
        pairs: Pairs = ()
        for _ in range(MOST_PAIR_ROUNDS):
            if pairs not in programs:
                programs[pairs] = Program(model, pairs)
            program = programs[pairs]
            try:
                z, good = solve(program, program.begin(x))
            except (ValueError, RuntimeError, np.linalg.LinAlgError):
                return np.full(model.size, np.nan), False
            if not np.isfinite(z).all():
                return np.full(model.size, np.nan), False
            answer, good = z[: model.size], good and program.violation(z) <= FEASIBLE
            crossed = model.crossed(answer, ANSWERED)
            if not crossed or set(crossed) <= set(pairs):
                break
            pairs = tuple(sorted({*pairs, *crossed}))
        return np.clip(answer, -model.bound, model.bound), good

    with silence():
        attempt(np.zeros(model.size))  # warm-up
        first = time.process_time()
        seconds: list[float] = []
        answers: list[tuple[np.ndarray, bool]] = []
        while not seconds or seconds[-1] < budget:
            answers.append(attempt(rival.start(model, rng)))
            seconds.append(time.process_time() - first)
    claims = np.array([good for _, good in answers])
    return Ends(rival.name, np.array(seconds), claims, np.array([x for x, _ in answers]))


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
