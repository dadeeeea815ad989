"""Loop closure posed in other ways, for comparison only: IPOPT and everything else stay the same.

All use the whole vertex, with fold angles of one orbit tied to one variable where the scene has a symmetry:

- quaternion: the vector part of the product of all folds (the package's form, three equations);
- axial: the axial part of F - F^T, F the rotation matrix of the whole loop (three equations; also zero at half turns);
- logarithm: the rotation vector of F (three equations; singular at half turns);
- entries: all nine entries of F - I.

`wedge` is the package's own problem of the symmetric piece.
"""

from __future__ import annotations

import time

import casadi as ca
import numpy as np

from benchmarks.attempt import FEASIBLE, Attempt, Method, Solver, StartPoint
from benchmarks.methods_casadi import ipopt_options
from benchmarks.nonlinear_program import problem
from origami_nlp.numerics import quaternion as quat
from origami_nlp.problem import Model

FORMS = {
    "quaternion": "vector part of the quaternion",
    "axial": "axial part of F - F^T",
    "logarithm": "rotation logarithm of F",
    "entries": "nine entries of F - I",
}
TOLERANCE = 1e-8


def closures() -> list[Method]:
    """Return the ways to pose closure in the full vertex, from projected and from raw starts."""
    return [_method(form, FORMS[form], raw) for form in FORMS for raw in (False, True)]


def wedge_against_tied() -> list[Method]:
    """Return the symmetric piece against tied angles in the closure of the whole vertex."""
    return [
        _method(form, name, raw)
        for form, name in (
            ("wedge", "symmetric piece (wedge)"),
            ("quaternion", "tied angles, full closure"),
        )
        for raw in (False, True)
    ]


def _method(form: str, name: str, raw: bool) -> Method:
    setting = "raw starts" if raw else "projected starts"
    return Method(name, setting, name, TOLERANCE, _Prepare(form, raw))


def closure_residual(form: str, model: Model, x: ca.SX) -> ca.SX:
    """Return the equations of closure of the whole vertex in one of `FORMS`, from the variables x [n]."""
    angles = [x[int(v)] for v in model.variable_of_crease]
    creases = [tuple(map(float, b)) for b in model.scene.vertex.creases]
    q = tuple(ca.SX(v) for v in quat.IDENTITY)
    for angle, b in zip(angles, creases, strict=True):
        q = quat.multiply(q, quat.fold(ca.cos(angle / 2), ca.sin(angle / 2), b))  # type: ignore[assignment]
    if form == "quaternion":
        return ca.vertcat(*q[1:])
    f = ca.SX.eye(3)
    for angle, (bx, by, _) in zip(angles, creases, strict=True):
        cross = ca.SX(np.array([[0.0, 0.0, by], [0.0, 0.0, -bx], [-by, bx, 0.0]]))
        f = f @ (ca.SX.eye(3) + ca.sin(angle) * cross + (1 - ca.cos(angle)) * cross @ cross)
    if form == "entries":
        return ca.vec(f - ca.SX.eye(3))
    axial = 0.5 * ca.vertcat(f[2, 1] - f[1, 2], f[0, 2] - f[2, 0], f[1, 0] - f[0, 1])
    if form == "axial":
        return axial
    cosine = 0.5 * (ca.trace(f) - 1)
    square = ca.dot(axial, axial)
    sine = ca.sqrt(ca.fmax(square, 1e-16))  # its derivative at zero is infinite
    near = ca.logic_and(square < 1e-16, cosine > 0)
    return axial * ca.if_else(near, 1 + square / 6, ca.atan2(sine, cosine) / sine)


class _Prepare:
    """Prepares one form for a model."""

    def __init__(self, form: str, raw: bool) -> None:
        self._form, self._raw = form, raw

    def __call__(self, model: Model) -> Solver:
        n = model.size
        if self._form == "wedge":
            built = problem(model.structure, ())
            nlp: ca.Function | dict[str, ca.SX] = built.oracle
            lower, upper = built.lower, built.upper
        else:
            f = model.functions
            g = closure_residual(self._form, model, f.x)
            nlp = {"x": f.x, "p": f.p, "f": f.energy, "g": g}
            lower = upper = np.zeros(g.shape[0])
        options = {"print_time": False, "error_on_fail": False, **ipopt_options(TOLERANCE)}
        solver = ca.nlpsol("closure", "ipopt", nlp, options)

        def run(start: StartPoint) -> Attempt:
            x0 = start.raw if self._raw else start.x
            bound = np.full(n, model.bound)
            out = solver(
                x0=x0, p=model.parameters.vector, lbx=-bound, ubx=bound, lbg=lower, ubg=upper
            )
            stats = solver.stats()
            g = np.asarray(out["g"]).ravel()
            good = bool(stats["success"]) and bool(np.abs(g).max(initial=0.0) <= FEASIBLE)
            answer = np.asarray(out["x"]).ravel()
            return Attempt(answer, good, str(stats["return_status"]), int(stats["iter_count"]))

        return run


def evaluation_time(form: str, model: Model, repeats: int = 2000) -> float:
    """Return the seconds that closure and its Jacobian take in one form (the fastest of three loops)."""
    x = ca.SX.sym("phi", model.size)
    g = closure_residual(form, model, x)
    function = ca.Function("g", [x], [ca.densify(g), ca.densify(ca.jacobian(g, x))]).map(repeats)
    states = np.random.default_rng(0).uniform(-1.0, 1.0, (model.size, repeats))
    times = []
    for _ in range(3):
        begin = time.process_time()
        function(states)
        times.append((time.process_time() - begin) / repeats)
    return min(times)
