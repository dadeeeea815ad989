"""Ways to the state of least energy below a start: this package's, and others that people use."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import casadi as ca
import numpy as np
from scipy.sparse.linalg import lsmr

from benchmarks.methods_casadi import silence
from benchmarks.pattern_bars import Bars, relax
from benchmarks.pattern_problems import PatternTask
from origami_nlp.pattern import Loop
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import descend

OURS = "this package"


@dataclass(frozen=True, eq=False)
class PatternAnswer:
    """What a method has at some time.

    Attributes
    ----------
    phi
        Fold angles [rad], [n]; None where it refused.
    status
        In its words; empty for what is no answer, only a moment at which it can be stopped.
    softness
        Of bars: largest strain, or fold of a facet [rad]; None of rigid facets.
    """

    phi: np.ndarray | None
    status: str
    softness: float | None = None


Solve = Callable[[], Iterator[PatternAnswer]]
"""Starts anew; times are of what it does until it yields, added up."""


@dataclass(frozen=True)
class PatternMethod:
    """A method.

    Attributes
    ----------
    name
        Of the line in a figure.
    prepare
        Builds what a pattern needs once, and returns runs by their settings.
    """

    name: str
    prepare: Callable[[PatternTask], dict[str, Solve]]


def pattern_methods() -> list[PatternMethod]:
    """Return the methods; this package's first."""
    return [
        PatternMethod(OURS, _ours),
        PatternMethod("gradient and projection", _projection),
        PatternMethod("bars and hinges, L-BFGS", _bars),
        PatternMethod("IPOPT, elastic rows", _elastic),
        PatternMethod("IPOPT, all rows", _all_rows),
    ]


CUTS = 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 30
"""Steps after which runs of this package are cut off, to show the error on the way."""


def _ours(problem: PatternTask) -> dict[str, Solve]:
    """Return runs that are cut off after so many steps, and a whole one."""
    sheet = PatternProblem(problem.pattern)

    def cut(most: int) -> Iterator[PatternAnswer]:
        end = descend(sheet, problem.start, most)
        yield PatternAnswer(end.phi, end.why)

    runs: dict[str, Solve] = {f"{k} steps": partial(cut, k) for k in CUTS}
    return runs | {"to the end": partial(cut, 200)}


# ---------------------------------------------------------------- gradient steps and projections

MOST_STEPS = 100_000
PROJECTIONS = 20
CLOSED = 1e-13
"""Closure at which a projection ends."""
AT_REST = 1e-12
"""Largest torque along the sheet over the mean stiffness at which the descent ends."""
LSMR = {"atol": 1e-14, "btol": 1e-14, "conlim": 1e12}
FARTHEST = 0.3
"""Change of a fold angle in one step [rad]: as far as this package goes."""


def _projection(problem: PatternTask) -> dict[str, Solve]:
    """Alternate steps along the torque with Newton's projections of least length, by LSMR.

    The projection is that of programs which fold rigid sheets; the descent is the plainest that can be put on top:
    along the torque less what closure balances (without that, sheets fall back into the flat state), by Barzilai's
    and Borwein's length, cut until the sheet closes and the energy is not higher than that of the last few states.
    """
    sheet = PatternProblem(problem.pattern)

    def project(phi: np.ndarray) -> tuple[np.ndarray, float]:
        for _ in range(PROJECTIONS):
            at = sheet.closure.turned(phi)
            c = sheet.closure.values(phi, at)
            if np.abs(c).max() <= CLOSED:
                break
            j = sheet.closure.jacobian(phi, at)
            phi = phi - lsmr(j, c, maxiter=10 * len(phi), **LSMR)[0]
        return phi, sheet.residual(phi)

    def free_torque(phi: np.ndarray) -> np.ndarray:
        j, torque = sheet.closure.jacobian(phi), sheet.torque(phi)
        return torque - j.T @ lsmr(j.T, torque, maxiter=10 * len(phi), **LSMR)[0]

    def run() -> Iterator[PatternAnswer]:
        phi, length, mark = problem.start, 0.5, 1
        torque, last = free_torque(phi), [sheet.scaled_energy(phi)]
        for step in range(1, MOST_STEPS + 1):
            cut = min(length, FARTHEST / max(float(np.abs(torque).max()), 1e-300))
            while cut > 1e-9:
                new, residual = project(phi - cut * torque)
                if residual <= 10 * CLOSED and sheet.scaled_energy(new) <= max(last[-5:]) * (
                    1 + 1e-13
                ):
                    break
                cut *= 0.25
            else:
                yield PatternAnswer(phi, f"{step} steps, no lower state")
                return
            move, other = new - phi, free_torque(new)
            bend = float(move @ (other - torque))
            length = float(np.clip(float(move @ move) / bend, 1e-3, 1e2)) if bend > 0 else 1.0
            phi, torque = new, other
            last.append(sheet.scaled_energy(phi))
            ends = float(np.abs(torque).max()) <= AT_REST
            if step >= mark or ends:
                mark = math.ceil(1.4 * mark)
                yield PatternAnswer(phi, f"{step} steps")
            if ends:
                return

    return {"": run}


def _bars(problem: PatternTask) -> dict[str, Solve]:
    bars = Bars(problem)

    def run() -> Iterator[PatternAnswer]:
        for phi, softness, rests in relax(bars):
            yield PatternAnswer(phi, rests, softness)

    return {"": run}


# ---------------------------------------------------------------- IPOPT, as its users pose it

TOLERANCES = (1e-2, 1e-5, 1e-8, 1e-12)
PENALTY = 1e8
"""Of elastic rows, over the mean stiffness: with 1e4 they are left open by as much as 1e-4."""


def _all_rows(problem: PatternTask) -> dict[str, Solve]:
    phi = ca.SX.sym("phi", problem.pattern.creases)
    return {"": _ipopt(problem, phi, _energy(problem, phi), _closure(problem, phi), 1e-8)}


def _elastic(problem: PatternTask) -> dict[str, Solve]:
    phi = ca.SX.sym("phi", problem.pattern.creases)
    closure = _closure(problem, phi)
    left = ca.SX.sym("w", closure.numel())
    energy = _energy(problem, phi) + 0.5 * PENALTY * ca.sumsqr(left)
    both = ca.vertcat(phi, left)
    return {
        f"tol {tol:.0e}": _ipopt(problem, both, energy, closure - left, tol) for tol in TOLERANCES
    }


def _energy(problem: PatternTask, phi: ca.SX) -> ca.SX:
    p = problem.pattern
    return 0.5 * ca.dot(p.stiffness / p.stiffness.mean(), (phi - p.rest) ** 2)


def _closure(problem: PatternTask, phi: ca.SX) -> ca.SX:
    """Multiply the quaternions of each vertex, as anyone would."""
    p = problem.pattern

    def vertex(loop: Loop) -> ca.SX:
        w, v = ca.SX(1), ca.SX.zeros(3)
        for crease, sign in zip(loop.creases, loop.signs, strict=True):
            c, s = ca.cos(phi[crease] / 2), ca.sin(phi[crease] / 2)
            b = s * (sign * p.directions[crease])
            w, v = w * c - ca.dot(v, b), w * b + c * v + ca.cross(v, b)
        return v

    return ca.vertcat(*(vertex(loop) for loop in p.vertices))


def _ipopt(problem: PatternTask, x: ca.SX, f: ca.SX, g: ca.SX, tol: float) -> Solve:
    options: dict[str, Any] = {
        "print_time": False,
        "ipopt": {"print_level": 0, "sb": "yes", "tol": tol, "bound_relax_factor": 0.0},
    }
    with silence():
        solver = ca.nlpsol("solver", "ipopt", {"x": x, "f": f, "g": g}, options)
    n, size = problem.pattern.creases, x.numel()
    start, bound = np.zeros(size), np.full(size, np.inf)
    start[:n], bound[:n] = problem.start, np.pi

    def run() -> Iterator[PatternAnswer]:
        with silence():
            found = solver(x0=start, lbx=-bound, ubx=bound, lbg=0, ubg=0)
        status = str(solver.stats()["return_status"])
        refused = "Degrees" in status or "Invalid" in status
        yield PatternAnswer(None if refused else np.array(found["x"]).ravel()[:n], status)

    return run
