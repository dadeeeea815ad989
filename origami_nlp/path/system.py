"""The KKT system of states over a parameter, and its linear algebra: rows that are independent, or may not be.

Unknowns are the state x [n], multipliers nu of closure and held contacts, and the parameter s of a line:

    F = (grad U - C' nu, closure, openings) = 0,      dF = [H -C' F_s; C 0 c_s] (dy, dnu, ds)

Rows of one vertex are independent, or those that are are chosen (`Hold.closure`).  Those of a pattern depend on each
other as a rule, and are many: nothing here decides on their rank.  With one more row r the direction of the curve and
Newton's steps come from

    [ H  F_s C' ] [ dy  ]
    [ r  r_s 0  ] [ ds  ]
    [ C  c_s -eps] [-dnu],

where `eps` is taken back by refinement, so that what is found does not know it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from origami_nlp.errors import OutOfTime
from origami_nlp.kkt import Classification, State, classify
from origami_nlp.numerics import (
    CURVED,
    DEPENDENT,
    EPS,
    SETTLED,
    Factor,
    Normal,
    null_space,
)
from origami_nlp.path.line import ParameterLine
from origami_nlp.programme import Contact, Local, Programme

ASLANT = 10.0
"""One over the cosine between a curve and where it went before: up to here one factorisation gives a step across it."""
REFINED = 8
"""Solutions of one system at most, each of what the ones before leave."""
LOWEST = 6
"""Eigenvalues of a large programme that are computed, the smallest ones; as many again where all are negative."""


@dataclass(frozen=True)
class Hold:
    """Which equations are kept: contacts held closed, and rows of closure (all, where they are independent)."""

    contacts: tuple[Contact, ...]
    closure: tuple[int, ...]


@dataclass
class Tally:
    """What following cost: steps accepted, and evaluations of the KKT system.

    until: value of `time.monotonic` after which an evaluation raises `OutOfTime`.
    """

    steps: int = 0
    evaluations: int = 0
    until: float = math.inf

    def evaluate(self) -> None:
        """Count an evaluation, if there is time for it."""
        if self.until < math.inf and time.monotonic() > self.until:
            raise OutOfTime
        self.evaluations += 1


class System:
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
        self.programme: Programme = line.at(s)
        p = self.programme
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
        full = self.multipliers
        if kept < m:
            full = np.zeros(m + len(hold.contacts))
            full[:m][rows], full[m:] = self.multipliers[:kept], self.multipliers[kept:]
        self.all_multipliers = full
        self.hessian = self._curvature(full)
        torque, moved = p.drift(x, full, hold.contacts, line.slope(s))
        self.drift = torque / root / line.weight
        moved = moved if kept == m else np.concatenate([moved[:m][rows], moved[m:]])
        self.moved = moved / line.weight
        self.imbalance = gradient - self.jacobian.T @ self.multipliers

    def _local(self) -> Local:
        return self.programme.local(self.x)

    def _scaled(self, jacobian: Any) -> Any:
        return jacobian / self.programme.root

    def _balanced(self, gradient: np.ndarray) -> np.ndarray:
        return np.linalg.lstsq(self.jacobian.T, gradient, rcond=DEPENDENT)[0]

    def _curvature(self, multipliers: np.ndarray) -> Any:
        p = self.programme
        h = p.lagrangian_hessian(self.x, multipliers, self.hold.contacts)
        return h / (p.root[:, None] * p.root)

    @cached_property
    def seen(self) -> State:
        """Its state as it is judged: what is asked of it twice is computed once."""
        return State(self.programme, self.x)

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
        out[:n, :n], out[:n, n:-1], out[:n, -1] = self.hessian, -self.jacobian.T, self.drift
        out[n:, :n], out[n:, -1] = self.jacobian, self.moved
        return out

    @cached_property
    def eigenvalues(self) -> np.ndarray:
        """Of the Hessian on what closure and contacts leave free, ascending, scaled energy."""
        z = null_space(self.jacobian)
        return np.linalg.eigvalsh(z.T @ self.hessian @ z)

    @cached_property
    def _null(self) -> np.ndarray | None:
        _, values, vt = np.linalg.svd(self.matrix)
        if values[-1] <= CURVED * values[0]:
            return None
        n = len(self.imbalance)
        v = vt[-1]
        size = float(np.hypot(np.linalg.norm(v[:n]), v[-1]))
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
        whole = np.vstack([self.matrix, self._row(along)])
        v = np.linalg.svd(whole)[2][-1]
        across = np.append(v[:n], v[-1])
        return across / np.linalg.norm(across)

    def _row(self, row: np.ndarray) -> np.ndarray:
        """Return a row over (dy, w ds) as one over (dy, dnu, w ds)."""
        return np.concatenate([row[:-1], np.zeros(len(self.multipliers)), row[-1:]])

    def shortest_step(self, along: np.ndarray) -> np.ndarray | None:
        """Return the shortest Newton's step in (x, s); None where the curve turns far from `along` [n + 1].

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
        step = step - (step @ v) / (v @ v) * v
        if not (np.isfinite(step).all() and np.linalg.norm(v) <= ASLANT):
            return None
        return self._in_variables(step)

    def _in_variables(self, step: np.ndarray) -> np.ndarray:
        """Return a step (dy, w ds) in (x, s)."""
        return np.append(step[:-1] / self.programme.root, step[-1] / self.line.weight)

    def step(self, row: np.ndarray, right: float, short: bool = False) -> np.ndarray | None:
        """Return Newton's step in (x, s) under one more equation, row . (dy, w ds) = right.

        short: the shortest one where the matrix is all but singular.
        """
        n = len(self.imbalance)
        whole = np.vstack([self.matrix, self._row(row)])
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


class RedundantSystem(System):
    """The same where rows of closure may depend on each other all along a set; sparse where the programme is large.

    Newton carries multipliers along: those of least squares change so fast beside the flat state that it would be slow.
    """

    def _local(self) -> Local:
        p: Any = self.programme
        return cast(Local, p.rows(self.x))

    def _scaled(self, jacobian: Any) -> Any:
        return jacobian  # its metric is that of all fold angles

    def _balanced(self, gradient: np.ndarray) -> np.ndarray:
        return Normal(self.jacobian).multipliers(gradient)

    def _curvature(self, multipliers: np.ndarray) -> Any:
        p: Any = self.programme
        return p.curvature(self.x, multipliers, self.hold.contacts)

    @cached_property
    def kernel(self) -> np.ndarray:
        """Orthonormal basis of what closure and contacts leave free, [n, t]."""
        p: Any = self.programme
        shut = [c.index for c in self.hold.contacts if c.is_limit]
        z = p.kernel(self.x, shut)
        gaps = [k for k, c in enumerate(self.hold.contacts) if not c.is_limit]
        if not gaps:
            return np.asarray(z)
        first = len(self.jacobian) - len(self.hold.contacts)
        return np.asarray(z @ null_space(self.jacobian[[first + k for k in gaps]] @ z))

    @property
    def free(self) -> int:
        """Number of directions that closure and contacts leave, at least."""
        return len(self.eigenvalues)

    @cached_property
    def least(self) -> float:
        """Smallest singular value of contacts along what closure leaves free."""
        p: Any = self.programme
        rows = self.jacobian[len(self.values) - len(self.hold.contacts) :]
        if not len(self.hold.contacts) or p.sparse:
            return 1.0
        rows = rows @ p.kernel(self.x)
        return (
            float(np.linalg.svd(rows, compute_uv=False).min())
            if len(rows) <= rows.shape[1]
            else 0.0
        )

    @cached_property
    def eigenvalues(self) -> np.ndarray:
        """Of the Hessian on what closure and contacts leave free, ascending; of a large programme the smallest ones."""
        if not self.programme.sparse:
            z = self.kernel
            return np.linalg.eigvalsh(z.T @ (self.hessian @ z))
        return self._smallest()

    def _smallest(self) -> np.ndarray:
        n, count = len(self.imbalance), LOWEST
        h = sparse.csr_array(self.hessian)
        # below every eigenvalue (Gershgorin), the closest ones are the smallest
        below = -float(abs(h).sum(axis=1).max()) - 1.0
        shifted = (h - below * sparse.eye_array(n)).tocsr()
        factor = Factor(shifted, self.jacobian)

        def inverse(v: np.ndarray) -> np.ndarray:
            """Solve on what is left free; zero across it."""
            d, change = np.zeros(n), np.zeros(len(self.values))
            for _ in range(2):
                left = v - shifted @ d - self.jacobian.T @ change
                more = factor.solve(left, -(self.jacobian @ d))
                d, change = d + more[0], change + more[1]
            return d

        while True:
            operator = LinearOperator((n, n), matvec=inverse, dtype=float)
            try:
                values = eigsh(
                    operator, k=min(count, n - 1), v0=np.ones(n), return_eigenvectors=False
                )
            except ArpackNoConvergence as failed:
                values = failed.eigenvalues
            values = values[
                values > SETTLED / -below
            ]  # the others are of directions that nothing leaves free
            found = np.sort(below + 1 / values)
            if not len(found) or found[-1] >= 0 or len(found) < count:
                return found
            count *= 2

    def _bordered(self, row: np.ndarray) -> Callable[..., tuple[np.ndarray, np.ndarray] | None]:
        """Factorise with one more row over (dy, w ds); return what solves for that and minus the change of nu."""
        # curvature that multipliers add beside singular states would let eps be taken back slowly
        size = max(1.0, float(abs(self.hessian).max()))
        h, c = self.hessian / size, self.jacobian
        if isinstance(c, np.ndarray):
            matrix: Any = np.vstack([np.column_stack([h, self.drift / size]), row])
            below: Any = np.column_stack([c, self.moved])
            across: Any = np.vstack([c.T, np.zeros(len(self.values))])
        else:
            top = sparse.hstack([sparse.csr_array(h), sparse.csr_array(self.drift[:, None] / size)])
            matrix = sparse.vstack([top, sparse.csr_array(row[None])]).tocsr()
            below = sparse.hstack([c, sparse.csr_array(self.moved[:, None])]).tocsr()
            across = sparse.vstack([c.T, sparse.csr_array((1, len(self.values)))]).tocsr()
        try:
            factor = Factor(matrix, below, across)
        except RuntimeError:  # of a sparse matrix that is exactly singular
            return lambda top, right, bottom: None

        def solve(
            top: np.ndarray, right: float, bottom: np.ndarray
        ) -> tuple[np.ndarray, np.ndarray] | None:
            want, left = np.append(top / size, right), math.inf
            d, change = np.zeros(len(want)), np.zeros(len(bottom))
            for _ in range(REFINED):
                more = factor.solve(want - matrix @ d - across @ change, bottom - below @ d)
                d, change = d + more[0], change + more[1]
                before, left = left, float(np.abs(more[0]).max())
                if not left < before or left <= EPS * float(np.abs(d).max()):
                    break
            return (d, -size * change) if np.isfinite(d).all() else None

        return solve

    def direction(self, along: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the direction (dy, w ds) of the curve, of length 1, and the change of multipliers along it."""
        n, m = len(self.imbalance), len(self.values)
        row = np.append(np.zeros(n), 1.0) if along is None else along
        for _ in range(2):
            found = self._bordered(row)(np.zeros(n), 1.0, np.zeros(m))
            if found is None:
                return None
            v, change = found
            size = float(np.linalg.norm(v))
            if not np.isfinite(size) or size == 0.0:
                return None
            v, change = v / size, change / size
            if size <= ASLANT:
                across = 1.0 if along is None else float(v @ along)
                return np.copysign(1.0, across) * v, np.copysign(1.0, across) * change
            row = v  # the curve turns across the row: once more under what was found
        return None

    def other_direction(self, along: np.ndarray) -> np.ndarray | None:
        """Return the direction (dy, w ds) across one at a branching, of length 1."""
        if self.programme.sparse:
            return None
        z, n = self.kernel, len(self.imbalance)
        inside = np.column_stack([z.T @ (self.hessian @ z), z.T @ self.drift])
        whole = np.vstack([inside, np.append(z.T @ along[:n], along[-1])])
        v = np.linalg.svd(whole)[2][-1]
        return np.append(z @ v[:-1], v[-1])

    def shortest_step(self, along: np.ndarray) -> np.ndarray | None:
        """Return the shortest Newton's step in (x, s); None where the curve turns far from `along` [n + 1]."""
        solve = self._bordered(along)
        step = solve(-self.imbalance, 0.0, -self.values)
        way = solve(np.zeros(len(self.imbalance)), 1.0, np.zeros(len(self.values)))
        if step is None or way is None or not np.linalg.norm(way[0]) <= ASLANT:
            return None
        d, v = step[0], way[0]
        share = float(d @ v) / float(v @ v)
        self.after = self.multipliers + step[1] - share * way[1]
        return self._in_variables(d - share * v)

    def step(self, row: np.ndarray, right: float, short: bool = False) -> np.ndarray | None:
        """Return Newton's step in (x, s) under one more equation, row . (dy, w ds) = right."""
        found = self._bordered(row)(-self.imbalance, right, -self.values)
        if found is None:
            return None
        self.after = self.multipliers + found[1]
        return self._in_variables(found[0])


def system_at(
    line: ParameterLine, point: np.ndarray, hold: Hold, multipliers: np.ndarray | None = None
) -> System:
    """Return the KKT system of a point (x, s) with contacts held; by default multipliers are those of least squares."""
    kind = RedundantSystem if line.programme.redundant else System
    return kind(line, point, hold, multipliers)


def stacked(matrix: Any, rows: np.ndarray) -> Any:
    """Return a matrix with more rows."""
    if isinstance(matrix, np.ndarray):
        return np.concatenate([matrix, rows])
    return sparse.vstack([matrix, sparse.csr_array(rows)]).tocsr()
