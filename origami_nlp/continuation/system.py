"""The KKT system of states over a parameter, and its linear algebra.

Unknowns are the state x [n], multipliers nu of closure and held contacts, and the parameter s of a line:

    F = (grad U - C' nu, closure, openings) = 0,      dF = [H -C' F_s; C 0 c_s] (dy, dnu, ds)

Rows of one vertex are independent, or those that are are chosen (`Hold.closure`); for others see `redundant`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy as sp

from origami_nlp.continuation.line import ParameterLine
from origami_nlp.kkt import Classification, State, classify
from origami_nlp.numerics import CURVED, DEPENDENT, SETTLED, null_space
from origami_nlp.problem import Contact, Local, Problem

ASLANT = 10.0
"""One over the cosine between a curve and where it went before: up to here one factorisation gives a step across it."""


@dataclass(frozen=True)
class Hold:
    """Which equations are kept: contacts held closed, and rows of closure (all, where they are independent)."""

    contacts: tuple[Contact, ...]
    closure: tuple[int, ...]


@dataclass
class Tally:
    """What following cost: steps accepted, and evaluations of the KKT system."""

    steps: int = 0
    evaluations: int = 0


class BorderedSystem:
    """The KKT system of a point (x, s) with contacts held, in the metric; its rows are independent."""

    jacobian: Any
    hessian: Any
    after: np.ndarray | None = (
        None  # multipliers after the last Newton's step, where they are carried along
    )

    def __init__(
        self,
        line: ParameterLine,
        point: np.ndarray,
        hold: Hold,
        multipliers: np.ndarray | None = None,
    ) -> None:
        x, s = point[:-1], float(point[-1])
        self.line, self.hold, self.x = line, hold, x
        self.problem: Problem = line.at(s)
        p = self.problem
        root, local = p.root, self._local()
        rows = slice(None) if len(hold.closure) == p.equation_count else list(hold.closure)
        closure, jacobian = local.closure[rows], self._scaled(local.closure_jacobian[rows])
        self.values, self.jacobian = closure, jacobian
        if hold.contacts:
            values, slopes = local.openings(hold.contacts)
            self.jacobian = stacked(jacobian, slopes / root)
            self.values = np.concatenate([closure, values])
        gradient = local.gradient / root
        self.size = 1.0 + float(np.abs(gradient).max(initial=0.0))
        self.multipliers = self._balanced(gradient) if multipliers is None else multipliers
        m, kept = p.equation_count, len(closure)
        # `hold.closure` names independent rows: multipliers of all others are 0
        full = self.multipliers
        if kept < m:
            full = np.zeros(m + len(hold.contacts))
            full[:m][rows], full[m:] = self.multipliers[:kept], self.multipliers[kept:]
        self.all_multipliers = full
        self.hessian = self._curvature(full)
        torque, moved = p.drift(x, full, hold.contacts, line.slope(s))
        torque = torque + line.moved_torque(p, s, self.x)
        self.drift = torque / root / line.weight
        moved = moved if kept == m else np.concatenate([moved[:m][rows], moved[m:]])
        self.moved = moved / line.weight
        self.imbalance = gradient - self.jacobian.T @ self.multipliers

    def _local(self) -> Local:
        return self.problem.local(self.x)

    def _scaled(self, jacobian: Any) -> Any:
        return jacobian / self.problem.root

    def _balanced(self, gradient: np.ndarray) -> np.ndarray:
        return np.linalg.lstsq(self.jacobian.T, gradient, rcond=DEPENDENT)[0]

    def _curvature(self, multipliers: np.ndarray) -> Any:
        p = self.problem
        h = p.lagrangian_hessian(self.x, multipliers, self.hold.contacts)
        return h / (p.root[:, None] * p.root)

    @cached_property
    def seen(self) -> State:
        """Its state as it is judged: what is asked of it twice is computed once."""
        return State(self.problem, self.x)

    @cached_property
    def judged(self) -> Classification:
        """What `kkt.classify` says of it."""
        return classify(self.seen)

    @property
    def residual(self) -> float:
        """Largest entry of the KKT system, torques relative to the largest."""
        balance = float(np.abs(self.imbalance).max(initial=0.0)) / self.size
        return max(balance, self.missing)

    @property
    def missing(self) -> float:
        """Largest entry of closure and openings."""
        return float(np.abs(self.values).max(initial=0.0))

    @property
    def least(self) -> float:
        """Smallest singular value of closure and contacts."""
        return float(np.linalg.svd(self.jacobian, compute_uv=False).min(initial=1.0))

    @property
    def free(self) -> int:
        """Number of directions that closure and contacts leave, at least."""
        return max(len(self.imbalance) - len(self.values), 0)

    @cached_property
    def matrix(self) -> np.ndarray:
        """Derivative of the system by (y, nu, w s), shape [n + k, n + k + 1]."""
        k, n = self.jacobian.shape
        out = np.zeros((n + k, n + k + 1))
        # dF over (dy, dnu, w ds): one column more than rows, so that a regular point has one null vector, the tangent
        out[:n, :n], out[:n, n:-1], out[:n, -1] = self.hessian, -self.jacobian.T, self.drift
        out[n:, :n], out[n:, -1] = self.jacobian, self.moved
        return out

    @cached_property
    def eigenvalues(self) -> np.ndarray:
        """Of the Hessian on what closure and contacts leave free, ascending, scaled energy."""
        # reduced Hessian Z' H Z (Nocedal & Wright, 16.2): its negative eigenvalues are the index of the state
        z = null_space(self.jacobian)
        return np.linalg.eigvalsh(z.T @ self.hessian @ z)

    @cached_property
    def _null(self) -> np.ndarray | None:
        _, values, vt = np.linalg.svd(self.matrix)
        # rank lost: a branch point (two curves cross) or a singular one; no tangent is unique
        if values[-1] <= CURVED * values[0]:
            return None
        n = len(self.imbalance)
        v = vt[-1]
        size = float(np.hypot(np.linalg.norm(v[:n]), v[-1]))
        # of unit length in state and parameter; where multipliers alone change there is no motion at all
        return v / size if size > SETTLED * np.linalg.norm(v) else None

    def direction(self, along: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the direction (dy, w ds) of the curve, of length 1, and the change of multipliers along it.

        On the side of `along` [n + 1], either where that is None; None where it is not unique, or across `along`.
        """
        v, n = self._null, len(self.imbalance)
        if v is None:
            return None
        tangent = np.append(v[:n], v[-1])
        across = 1.0 if along is None else float(tangent @ along)
        if across == 0.0:
            return None
        return np.sign(across) * tangent, np.sign(across) * v[n:-1]

    def other_direction(self, along: np.ndarray) -> np.ndarray | None:
        """Return the direction (dy, w ds) across one at a branching, of length 1."""
        n = len(self.imbalance)
        # at a branch point the null space is a plane: the one more row leaves what is across `along` in it
        whole = np.vstack([self.matrix, self._row(along)])
        v = np.linalg.svd(whole)[2][-1]
        across = np.append(v[:n], v[-1])
        return across / np.linalg.norm(across)

    def _row(self, row: np.ndarray) -> np.ndarray:
        """Return a row over (dy, w ds) as one over (dy, dnu, w ds)."""
        return np.concatenate([row[:-1], np.zeros(len(self.multipliers)), row[-1:]])

    def shortest_step(self, along: np.ndarray) -> np.ndarray | None:
        """Return the corrector's step in (x, s), across the curve; None where the curve turns far from `along` [n + 1].

        It is the step across `direction`, by one factorisation instead of singular values.
        """
        n = len(self.imbalance)
        whole = np.zeros((len(self.matrix) + 1,) * 2)
        whole[:-1], whole[-1, :n], whole[-1, -1] = self.matrix, along[:n], along[-1]
        right = np.zeros((len(whole), 2))
        right[:-1, 0], right[-1, 1] = -np.concatenate([self.imbalance, self.values]), 1.0
        try:
            d = np.linalg.solve(whole, right)
        except np.linalg.LinAlgError:
            return None
        step, v = np.vstack([d[:n], d[-1:]]).T  # a step across `along`, and one along the curve
        # Gauss-Newton in the sense of Moore and Penrose (Allgower & Georg): the step has no part along the curve
        step = step - (step @ v) / (v @ v) * v
        if not (np.isfinite(step).all() and np.linalg.norm(v) <= ASLANT):
            return None
        return self._in_variables(step)

    def _in_variables(self, step: np.ndarray) -> np.ndarray:
        """Return a step (dy, w ds) in (x, s)."""
        return np.append(step[:-1] / self.problem.root, step[-1] / self.line.weight)

    def step(self, row: np.ndarray, right: float, short: bool = False) -> np.ndarray | None:
        """Return Newton's step in (x, s) of the bordered system (pseudo-arclength): row . (dy, w ds) = right is added.

        short: the shortest one where the matrix is all but singular.
        """
        n = len(self.imbalance)
        whole = np.vstack([self.matrix, self._row(row)])
        # bordered system: regular at limit points, where the KKT matrix alone is singular
        minus = -np.concatenate([self.imbalance, self.values, [-right]])
        try:
            # at a branching the matrix is singular: no step along the other branch
            if short:
                d = np.linalg.lstsq(whole, minus, rcond=DEPENDENT)[0]
            else:
                d = np.linalg.solve(whole, minus)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(d).all():
            return None
        return self._in_variables(np.append(d[:n], d[-1]))


def stacked(matrix: Any, rows: np.ndarray) -> Any:
    """Return a matrix with more rows."""
    if isinstance(matrix, np.ndarray):
        return np.concatenate([matrix, rows])
    return sp.sparse.vstack([matrix, sp.sparse.csr_array(rows)]).tocsr()
