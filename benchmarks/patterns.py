"""Error against time on whole patterns: this package, and IPOPT as its users pose it.

All start from the same closed state and look for the state of least energy below it, within fold limits; contact is
left out by all.  Seconds are processor time of one thread, medians of `ROUNDS`, without what is built once a pattern.
The reference is found in extended precision by code of its own: closure as a product of quaternions in `longdouble`,
balance in the full space of fold angles, by Newton from the state where the package ends.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from benchmarks.rivals import silence
from origami_nlp.display import Table
from origami_nlp.errors import OptionError
from origami_nlp.numerics import Factor
from origami_nlp.pattern import Loop, Pattern, examples
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search import descend_by_newton

SCHEMA = "origami-nlp/bench-patterns/2"
RECORD = Path(__file__).with_name("records") / "patterns.json"
ROUNDS = 3
GUESS = 0.4
"""Fold angle of mountains and valleys that all solvers start from, closed by the package [rad]."""
DECADES = 2.0
"""Of stiffness, drawn once, in patterns with many degrees of freedom: with equal springs a torque step is Newton's."""
SPRINGS: dict[str, tuple[float, bool] | None] = {
    "miura:4x4": (1.2, True),
    "miura:8x8": (1.2, True),
    "miura:16x16": (1.2, True),
    "miura:32x32": (1.2, True),
    "waterbomb:5x5": (1.0, False),
    "yoshimura:6x6": (1.0, False),
    "metasheet:4x4": None,
}
"""Patterns: rest angle of their mountains and valleys [rad], and whether all stiffnesses are 1; None: their own."""
QUICK = ("miura:4x4", "metasheet:4x4")
NEWTON_STEPS = 8
"""Of the reference: each takes off some ten digits."""
CUTS = 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 30
"""Steps after which runs of this package are cut off, to show the error on the way."""
TOLERANCES = (1e-2, 1e-5, 1e-8, 1e-12)
PENALTY = 1e8
"""Of elastic rows of IPOPT, over the mean stiffness: with 1e4 they are left open by as much as 1e-4."""
LEVELS = (1e-4, 1e-8)
"""Errors of fold angles at which times are compared [rad]."""


@dataclass(frozen=True, eq=False)
class Task:
    """One pattern with its problem, its start [n], and the state below it in extended precision [n] [rad].

    residual: largest entry of closure of that state, and of stationarity over the mean stiffness.
    """

    name: str
    sheet: PatternProblem
    start: np.ndarray
    exact: np.ndarray
    residual: float


@dataclass(frozen=True)
class Point:
    """An answer: seconds until it; largest error of a fold angle [rad] (nan: refused); closure; words of the solver."""

    pattern: str
    method: str
    setting: str
    status: str
    built: float
    seconds: float
    angle: float
    closure: float


def task(name: str) -> Task:
    """Make the problem of a key of `SPRINGS`.

    Raises
    ------
    OptionError
        If there is no state below its start that fold limits leave alone.
    """
    pattern, springs = examples.pattern(name), SPRINGS[name]
    if springs is not None:
        rest, equal = springs
        drawn = np.random.default_rng(0).uniform(-DECADES / 2, DECADES / 2, pattern.creases)
        pattern = pattern.with_springs(1.0 if equal else (10.0**drawn).tolist(), rest)
    sheet = PatternProblem(pattern)
    start, _ = sheet.project(GUESS * pattern.signs)
    end = descend_by_newton(sheet, start)
    if not end.arrived or np.abs(end.phi).max() >= math.pi:
        raise OptionError(f"pattern {name} has no free state below its start: take another")
    return Task(name, sheet, start, *refine(sheet, end.phi))


def refine(sheet: PatternProblem, phi: np.ndarray) -> tuple[np.ndarray, float]:
    """Take a stationary state [n] without contact to `numpy.longdouble`; return it and its residual."""
    wide = np.longdouble
    k = sheet.pattern.stiffness.astype(wide) / wide(sheet.pattern.stiffness.mean())
    rest, state = sheet.pattern.rest.astype(wide), phi.astype(wide)
    lam = sheet.multipliers(phi)[0].astype(wide)
    best, smallest = state, math.inf
    for _ in range(NEWTON_STEPS):
        closure, pull = wide_closure(sheet.pattern, state, lam)
        balance = k * (state - rest) - pull
        residual = float(max(np.abs(closure).max(), np.abs(balance).max()))
        if residual >= smallest:
            break
        best, smallest = state, residual
        near = state.astype(float)
        h, j = sheet.hessian(near, lam.astype(float)), sheet.closure.jacobian(near)
        d, other = Factor(h, j).solve(-balance.astype(float), -closure.astype(float))
        state, lam = state + d, lam - other
    return best, smallest


def wide_closure(
    pattern: Pattern, phi: np.ndarray, multipliers: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Evaluate closure of the vertices [m], and its gradient weighed by multipliers [n], in the precision of phi.

    A vertex's product of quaternions is cut before each crease: vec(A f' B) with f' = (-sin, cos b)/2 in between.
    """
    closure, pull = np.zeros(3 * len(pattern.vertices), phi.dtype), np.zeros(len(phi), phi.dtype)
    axes = (pattern.corners[pattern.ends[:, 1]] - pattern.corners[pattern.ends[:, 0]]).astype(
        phi.dtype
    )
    axes /= np.sqrt((axes**2).sum(axis=1, keepdims=True))
    for v, loop in enumerate(pattern.vertices):
        creases, signs = np.array(loop.creases), np.array(loop.signs, phi.dtype)
        half, b = phi[creases, None] / 2, signs[:, None] * axes[creases]
        folds = np.hstack([np.cos(half), np.sin(half) * b])
        slopes = np.hstack([-np.sin(half), np.cos(half) * b]) / 2
        before, after = [np.array([1, 0, 0, 0], phi.dtype)], [np.array([1, 0, 0, 0], phi.dtype)]
        for i in range(len(creases)):
            before.append(_times(before[-1], folds[i]))
            after.append(_times(folds[-1 - i], after[-1]))
        closure[3 * v : 3 * v + 3] = before[-1][1:]
        for i, crease in enumerate(creases):
            turned = _times(_times(before[i], slopes[i]), after[len(creases) - 1 - i])
            pull[crease] += turned[1:] @ multipliers[3 * v : 3 * v + 3]
    return closure, pull


def _times(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Multiply quaternions [4]."""
    vector = p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])
    return np.array([p[0] * q[0] - p[1:] @ q[1:], *vector], p.dtype)


Answer = tuple[np.ndarray | None, str]
"""Fold angles [n], None where a solver refused, and its words."""


def ours(task: Task) -> dict[str, Callable[[], Answer]]:
    """Return runs of this package that are cut off after so many steps, and a whole one."""
    sheet = PatternProblem(task.sheet.pattern)

    def cut(most: int) -> Answer:
        end = descend_by_newton(sheet, task.start, most)
        return end.phi, end.why

    runs: dict[str, Callable[[], Answer]] = {f"{k} steps": partial(cut, k) for k in CUTS}
    return runs | {"to the end": partial(cut, 200)}


def elastic(task: Task) -> dict[str, Callable[[], Answer]]:
    """Return IPOPT with a slack and a penalty for each row of closure, at several tolerances."""
    phi, energy, closure = _posed(task)
    left = ca.SX.sym("w", closure.numel())
    f, both = energy + 0.5 * PENALTY * ca.sumsqr(left), ca.vertcat(phi, left)
    return {f"tol {tol:.0e}": _ipopt(task, both, f, closure - left, tol) for tol in TOLERANCES}


def all_rows(task: Task) -> dict[str, Callable[[], Answer]]:
    """Return IPOPT with all rows of closure as they are."""
    return {"": _ipopt(task, *_posed(task), 1e-8)}


METHODS = {"this package": ours, "IPOPT, elastic rows": elastic, "IPOPT, all rows": all_rows}


def _posed(task: Task) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return fold angles, energy, and closure: the quaternions of each vertex multiplied, as anyone would."""
    p = task.sheet.pattern
    phi = ca.SX.sym("phi", p.creases)

    def vertex(loop: Loop) -> ca.SX:
        w, v = ca.SX(1), ca.SX.zeros(3)
        for crease, sign in zip(loop.creases, loop.signs, strict=True):
            c, s = ca.cos(phi[crease] / 2), ca.sin(phi[crease] / 2)
            b = s * (sign * p.directions[crease])
            w, v = w * c - ca.dot(v, b), w * b + c * v + ca.cross(v, b)
        return v

    energy = 0.5 * ca.dot(p.stiffness / p.stiffness.mean(), (phi - p.rest) ** 2)
    return phi, energy, ca.vertcat(*(vertex(loop) for loop in p.vertices))


def _ipopt(task: Task, x: ca.SX, f: ca.SX, g: ca.SX, tol: float) -> Callable[[], Answer]:
    quiet: Any = {"print_level": 0, "sb": "yes", "tol": tol, "bound_relax_factor": 0.0}
    with silence():
        posed = {"x": x, "f": f, "g": g}
        solver = ca.nlpsol("solver", "ipopt", posed, {"print_time": False, "ipopt": quiet})
    n, size = len(task.start), x.numel()
    start, bound = np.zeros(size), np.full(size, np.inf)
    start[:n], bound[:n] = task.start, np.pi

    def run() -> Answer:
        with silence():
            found = solver(x0=start, lbx=-bound, ubx=bound, lbg=0, ubg=0)
        status = str(solver.stats()["return_status"])
        refused = "Degrees" in status or "Invalid" in status
        return None if refused else np.array(found["x"]).ravel()[:n], status

    return run


def measure_patterns(
    names: Sequence[str] = tuple(SPRINGS), progress: Callable[[str], object] = lambda text: None
) -> dict[str, Any]:
    """Solve patterns with every method, in turn; returns plain data."""
    points: list[Point] = []
    for name in names:
        progress(name)
        one, runs = task(name), []
        for method, make in METHODS.items():
            begin = time.process_time()
            prepared = make(one)
            built = time.process_time() - begin
            runs += [(method, setting, built, run) for setting, run in prepared.items()]
        seconds: dict[tuple[str, str], list[float]] = {}
        answers: dict[tuple[str, str], Answer] = {}
        for turn in range(ROUNDS):
            for method, setting, _, run in [*runs[turn:], *runs[:turn]]:
                begin = time.process_time()
                answers[method, setting] = run()
                spent = time.process_time() - begin
                seconds.setdefault((method, setting), []).append(spent)
        for method, setting, built, _ in runs:
            phi, status = answers[method, setting]
            angle = math.nan if phi is None else float(np.abs(phi - one.exact).max())
            closure = math.nan if phi is None else one.sheet.residual(phi)
            middle = float(np.median(seconds[method, setting]))
            points.append(Point(name, method, setting, status, built, middle, angle, closure))
    return {"schema": SCHEMA, "points": [asdict(p) for p in points]}


def seconds_to(points: Sequence[Point], error: float) -> float:
    """Return the seconds until fold angles were right to an error; inf where they never were."""
    return min((p.seconds for p in points if p.angle <= error), default=math.inf)


def patterns_table(data: dict[str, Any]) -> Table:
    """Return a row a pattern and method."""
    groups: dict[tuple[str, str], list[Point]] = {}
    for plain in data["points"]:
        angle = math.nan if plain["angle"] is None else plain["angle"]
        point = Point(**{**plain, "angle": angle})
        groups.setdefault((point.pattern, point.method), []).append(point)
    heads = ("pattern", "method", "built [s]", *(f"s to {e:.0e}" for e in LEVELS), "s in all")
    rows = []
    for (name, method), of in groups.items():
        times = (of[0].built, *(seconds_to(of, e) for e in LEVELS), of[-1].seconds)
        cells = (f"{t:.2g}" if math.isfinite(t) else "-" for t in times)
        error = f"{of[-1].angle:.0e}" if math.isfinite(of[-1].angle) else "-"
        rows.append((name, method, *cells, error, of[-1].status))
    return Table((*heads, "error [rad]", "ended"), rows)
