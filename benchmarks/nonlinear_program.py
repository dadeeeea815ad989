"""The package's own nonlinear program, for any solver: same variables, constraints, bounds and derivatives."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from benchmarks.attempt import Pairs
from origami_nlp.minima import TOLERANCE, build_solver
from origami_nlp.problem import Model, Structure, separating_normal


@dataclass(frozen=True)
class Problem:
    """min f(z, p) with lower <= g(z, p) <= upper, z = fold angles [n] and one plane [3] for each pair.

    oracle: the CasADi function (x, p) -> (f, g) that the package hands to IPOPT.
    """

    oracle: ca.Function
    lower: np.ndarray
    upper: np.ndarray
    pairs: Pairs

    @property
    def equality(self) -> list[bool]:
        """For each row of g, whether it is an equation."""
        return [bool(a == b) for a, b in zip(self.lower, self.upper, strict=True)]

    def begin(self, model: Model, x: np.ndarray) -> np.ndarray:
        """Return z at fold angles x, planes where the package starts them."""
        if not self.pairs:
            return np.array(x, dtype=float)
        rays = model.rays(x)
        return np.concatenate([x, *(separating_normal(rays, pair) for pair in self.pairs)])

    def bound(self, model: Model) -> np.ndarray:
        """Return the bound on |z|, as the package sets it."""
        return np.concatenate([np.full(model.size, model.bound), np.full(3 * len(self.pairs), 1.5)])


@lru_cache(maxsize=512)
def problem(structure: Structure, pairs: Pairs) -> Problem:
    """Return the problem that the package gives to IPOPT (cached)."""
    built = build_solver(structure, pairs, TOLERANCE)
    return Problem(built.solver.oracle(), built.lower, built.upper, pairs)


class Evaluator:
    """Function values, exact gradients and Hessians of a problem, without copies.

    `at(z)` returns f, gradient [n], g [m], Jacobian [m, n]; `curvature(z, s, v)` the Hessian of s f + v . g.
    Results are overwritten by the next call at another z.
    """

    def __init__(self, oracle: ca.Function, parameters: np.ndarray) -> None:
        count, rows = oracle.size1_in(0), oracle.size1_out(1)
        z, p = ca.SX.sym("z", count), ca.SX.sym("p", oracle.size1_in(1))
        s, v = ca.SX.sym("s"), ca.SX.sym("v", rows)
        f, g = oracle(z, p)
        dense = [ca.densify(e) for e in (f, ca.gradient(f, z), g, ca.jacobian(g, z))]
        first = ca.Function("first", [z, p], dense)
        second = ca.Function(
            "second", [z, p, s, v], [ca.densify(ca.hessian(s * f + ca.dot(v, g), z)[0])]
        )
        self._keep = (first, second)
        self._z, self._p = np.zeros(count), np.array(parameters, dtype=float)
        self._s, self._v = np.zeros(1), np.zeros(rows)
        self.f, self.gradient, self.g = np.zeros(1), np.zeros(count), np.zeros(rows)
        self.jacobian = np.zeros((rows, count), order="F")
        self.hessian = np.zeros((count, count), order="F")
        self._first = _call(
            first, [self._z, self._p], [self.f, self.gradient, self.g, self.jacobian]
        )
        self._second = _call(second, [self._z, self._p, self._s, self._v], [self.hessian])
        self._last = b""

    def at(self, z: np.ndarray) -> Evaluator:
        """Evaluate f, gradient, g and Jacobian at z, once for repeated z."""
        key = z.tobytes()
        if key != self._last:
            self._z[:] = z
            self._first()
            self._last = key
        return self

    def curvature(self, z: np.ndarray, s: float, v: np.ndarray) -> np.ndarray:
        """Return a copy of the Hessian of s f + v . g at z."""
        if z.tobytes() != self._last:
            self._z[:] = z
            self._last = b""
        self._s[0], self._v[:] = s, v
        self._second()
        return self.hessian.copy()


def _call(
    function: ca.Function, arguments: list[np.ndarray], results: list[np.ndarray]
) -> Callable[[], None]:
    """Bind a CasADi function to arrays that it reads and fills."""
    buffer: Any
    buffer, call = function.buffer()
    for i, a in enumerate(arguments):
        buffer.set_arg(i, memoryview(a))  # type: ignore[arg-type]
    for i, r in enumerate(results):
        buffer.set_res(i, memoryview(r.ravel(order="K")))  # type: ignore[arg-type]
    keep = (buffer, arguments, results)

    def run() -> None:
        assert keep
        call()

    return run


def violation(g: np.ndarray, built: Problem) -> float:
    """Return the largest violation of the rows, inf if not finite."""
    if not np.isfinite(g).all():
        return math.inf
    return float(max(np.max(built.lower - g, initial=0.0), np.max(g - built.upper, initial=0.0)))
