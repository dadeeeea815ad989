"""The KKT system of states over a parameter, and its linear algebra; sparse where the problem is large.

Unknowns are the state y = root x [n], multipliers nu of closure and held contacts, and the parameter s of a line:

    F = (grad U - C' nu, closure, openings) = 0,      dF = [H -C' F_s; C 0 c_s] (dy, dnu, ds)

Rows of closure may depend on each other all along a set, so nothing here decides on a rank.  With one more row r the
direction of the curve and Newton's steps come from

    [ H  F_s C' ] [ dy  ]
    [ r  r_s 0  ] [ ds  ]
    [ C  c_s -eps] [-dnu],

where `eps` is taken back by refinement, so that what is found does not know it.  Newton carries multipliers along:
those of least squares change so fast beside the flat state that it would be slow.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy as sp

from origami_nlp.continuation.line import Line
from origami_nlp.kkt import Classification, State, classify
from origami_nlp.numerics import EPS, RANK, SETTLED, Factor, Normal, dense, null_space
from origami_nlp.problem import Contact

ASLANT = 10.0
"""One over the cosine between a curve and where it went before: up to here one factorisation gives a step across it."""
REFINED = 8
"""Solutions of one system at most, each of what the ones before leave."""
LOWEST = 6
"""Eigenvalues of a large problem that are computed, the smallest ones; as many again where all are negative."""


@dataclass(frozen=True)
class Hold:
    """Which contacts are held closed."""

    contacts: tuple[Contact, ...] = ()


@dataclass
class Tally:
    """What following cost: steps accepted, and evaluations of the KKT system."""

    steps: int = 0
    evaluations: int = 0


class BorderedSystem:
    """The KKT system of a point (x, s) with contacts held, in the metric of all fold angles.

    Parameters
    ----------
    line
        Of the parameter.
    point
        State and parameter (x, s), [n + 1].
    hold
        The contacts.
    multipliers
        Of closure and contacts, over `scale`, [m + r]; None: those of least squares.
    span
        Orthonormal columns [m + r, q]: Newton solves for these combinations of the rows.  Rows that depend on each
        other at closed states are nearly independent beside them; None: all rows.
    """

    def __init__(
        self,
        line: Line,
        point: np.ndarray,
        hold: Hold,
        multipliers: np.ndarray | None = None,
        span: np.ndarray | None = None,
    ) -> None:
        x, s = point[:-1], float(point[-1])
        self.line, self.hold, self.x, self.span = line, hold, x, span
        self.after: np.ndarray | None = None
        """Multipliers after the last step of Newton."""
        p: Any = line.at(s)
        self.problem = p
        local, root = p.rows(x), p.root
        self._plain = not (root != 1.0).any()
        self.values, self.jacobian = local.closure, self._in_metric(local.closure_jacobian)
        if hold.contacts:
            values, slopes = local.openings(hold.contacts)
            self.jacobian = stacked(self.jacobian, slopes / root)
            self.values = np.concatenate([local.closure, values])
        gradient = local.gradient / root
        self.size = 1.0 + float(np.abs(gradient).max(initial=0.0))
        if multipliers is None:
            multipliers = self._least_squares(gradient)
        self.multipliers = multipliers
        h = p.curvature(x, multipliers, hold.contacts)
        self.hessian = self._in_metric(self._in_metric(h).T)
        torque, moved = line.drift(p, s, x, multipliers, hold.contacts)
        self.drift = torque / root / line.weight
        self.moved = moved / line.weight
        self.imbalance = gradient - self.jacobian.T @ multipliers

    def _in_metric(self, matrix: Any) -> Any:
        """Return derivatives by y = root x, of those by x, in the columns of a matrix."""
        if self._plain:
            return matrix
        root = self.problem.root
        if isinstance(matrix, np.ndarray):
            return matrix / root
        return sp.sparse.csr_array(matrix @ sp.sparse.diags_array(1.0 / root))

    @cached_property
    def seen(self) -> State:
        """Its state as it is judged: what is asked of it twice is computed once."""
        return State(self.problem, self.x)

    @cached_property
    def judged(self) -> Classification:
        """What `kkt.classify` says of it."""
        return classify(self.seen)

    def _least_squares(self, gradient: np.ndarray) -> np.ndarray:
        if self.span is None:
            return Normal(self.jacobian).multipliers(gradient)
        return np.asarray(self.span @ Normal(self.span.T @ self.jacobian).multipliers(gradient))

    @cached_property
    def shortest_multipliers(self) -> np.ndarray:
        """Multipliers of smallest norm: those that Newton carries along say nothing of dependent rows, [m + r]."""
        return Normal(self.jacobian).multipliers(
            self.imbalance + self.jacobian.T @ self.multipliers
        )

    @cached_property
    def range(self) -> np.ndarray | None:
        """Basis of the row space of closure here, and all contacts, [m + r, q]; None: of a large problem."""
        if not isinstance(self.jacobian, np.ndarray):
            return None
        r = len(self.hold.contacts)
        u, sizes, _ = np.linalg.svd(self.jacobian[: len(self.values) - r], full_matrices=False)
        return np.asarray(sp.linalg.block_diag(u[:, sizes > RANK], np.eye(r)))

    @property
    def residual(self) -> float:
        """Largest entry of the KKT system, torques relative to the largest."""
        balance = float(np.abs(self.imbalance).max(initial=0.0)) / self.size
        return max(balance, self.missing)

    @property
    def missing(self) -> float:
        """Largest entry of closure and openings."""
        return float(np.abs(self.values).max(initial=0.0))

    @cached_property
    def kernel(self) -> np.ndarray:
        """Orthonormal basis of the null space of closure and active constraints, [n, t]."""
        p = self.problem
        at_limit = [c.index for c in self.hold.contacts if c.is_limit]
        z = p.kernel(self.x, at_limit)
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
        p = self.problem
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
        """Of the Hessian on what closure and contacts leave free, ascending; of a large problem the smallest ones."""
        if not self.problem.sparse:
            z = self.kernel
            return np.linalg.eigvalsh(z.T @ (self.hessian @ z))
        return self._smallest()

    def _smallest(self) -> np.ndarray:
        n, count = len(self.imbalance), LOWEST
        h = sp.sparse.csr_array(self.hessian)
        # below every eigenvalue (Gershgorin), the closest ones are the smallest
        below = -float(abs(h).sum(axis=1).max()) - 1.0
        # H - below I > 0, and with rows of J as constraints its inverse on the kernel has eigenvalues 1 / (lambda -
        # below)
        shifted = (h - below * sp.sparse.eye_array(n)).tocsr()
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
            operator = sp.sparse.linalg.LinearOperator((n, n), matvec=inverse, dtype=float)
            try:
                values = sp.sparse.linalg.eigsh(
                    operator, k=min(count, n - 1), v0=np.ones(n), return_eigenvectors=False
                )
            except sp.sparse.linalg.ArpackNoConvergence as failed:
                values = failed.eigenvalues
            values = values[
                values > SETTLED / -below
            ]  # the others are of directions that nothing leaves free
            found = np.sort(below + 1 / values)
            if not len(found) or found[-1] >= 0 or len(found) < count:
                return found
            count *= 2

    @property
    def matrix(self) -> np.ndarray:
        """Derivative of the system by (y, nu, w s), dense, [n + k, n + k + 1]."""
        c = dense(self.jacobian)
        k, n = c.shape
        out = np.zeros((n + k, n + k + 1))
        out[:n, :n], out[:n, n:-1], out[:n, -1] = dense(self.hessian), -c.T, self.drift
        out[n:, :n], out[n:, -1] = c, self.moved
        return out

    def _in_variables(self, step: np.ndarray) -> np.ndarray:
        """Return a step (dy, w ds) in (x, s)."""
        return np.append(step[:-1] / self.problem.root, step[-1] / self.line.weight)

    def _bordered(self, row: np.ndarray) -> Callable[..., tuple[np.ndarray, np.ndarray] | None]:
        """Factorise with one more row over (dy, w ds); return what solves for that and minus the change of nu."""
        # curvature that multipliers add beside singular states would let eps be taken back slowly
        size = max(1.0, float(abs(self.hessian).max()))
        h, c, moved, span = self.hessian / size, self.jacobian, self.moved, self.span
        if span is not None:
            c, moved = span.T @ c, span.T @ moved
        if isinstance(c, np.ndarray):
            matrix: Any = np.vstack([np.column_stack([h, self.drift / size]), row])
            below: Any = np.column_stack([c, moved])
            across: Any = np.vstack([c.T, np.zeros(len(c))])
        else:
            top = sp.sparse.hstack(
                [sp.sparse.csr_array(h), sp.sparse.csr_array(self.drift[:, None] / size)]
            )
            matrix = sp.sparse.vstack([top, sp.sparse.csr_array(row[None])]).tocsr()
            below = sp.sparse.hstack([c, sp.sparse.csr_array(self.moved[:, None])]).tocsr()
            across = sp.sparse.vstack([c.T, sp.sparse.csr_array((1, len(self.values)))]).tocsr()
        try:
            factor = Factor(matrix, below, across)
        except RuntimeError:  # of a sparse matrix that is exactly singular
            return lambda top, right, bottom: None

        def solve(
            top: np.ndarray, right: float, bottom: np.ndarray
        ) -> tuple[np.ndarray, np.ndarray] | None:
            want, left = np.append(top / size, right), math.inf
            bottom = bottom if span is None else span.T @ bottom
            d, change = np.zeros(len(want)), np.zeros(len(bottom))
            for _ in range(REFINED):
                more = factor.solve(want - matrix @ d - across @ change, bottom - below @ d)
                d, change = d + more[0], change + more[1]
                before, left = left, float(np.abs(more[0]).max())
                if not left < before or left <= EPS * float(np.abs(d).max()):
                    break
            change = -size * (change if span is None else span @ change)
            return (d, change) if np.isfinite(d).all() else None

        return solve

    def direction(self, along: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the direction (dy, w ds) of the curve, of length 1, and the change of multipliers along it."""
        n, m = len(self.imbalance), len(self.values)
        # bordered by (row, 1): the solution is the tangent over its cosine with the row
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
        if self.problem.sparse:
            return None
        z, n = self.kernel, len(self.imbalance)
        # on the kernel the KKT system is Z' H Z dz + Z' F_s ds = 0; multipliers follow
        inside = np.column_stack([z.T @ (self.hessian @ z), z.T @ self.drift])
        whole = np.vstack([inside, np.append(z.T @ along[:n], along[-1])])
        v = np.linalg.svd(whole)[2][-1]
        return np.append(z @ v[:-1], v[-1])

    def shortest_step(self, along: np.ndarray) -> np.ndarray | None:
        """Return the corrector's step in (x, s), across the curve; None where the curve turns far from `along` [n +
        1]."""
        solve = self._bordered(along)
        step = solve(-self.imbalance, 0.0, -self.values)
        way = solve(np.zeros(len(self.imbalance)), 1.0, np.zeros(len(self.values)))
        if step is None or way is None or not np.linalg.norm(way[0]) <= ASLANT:
            return None
        d, v = step[0], way[0]
        # takes off what the step has along the curve, in multipliers as well
        share = float(d @ v) / float(v @ v)
        self.after = self.multipliers + step[1] - share * way[1]
        return self._in_variables(d - share * v)

    def step(self, row: np.ndarray, right: float) -> np.ndarray | None:
        """Return Newton's step in (x, s) of the bordered system (pseudo-arclength): row . (dy, w ds) = right is
        added."""
        found = self._bordered(row)(-self.imbalance, right, -self.values)
        if found is None:
            return None
        self.after = self.multipliers + found[1]
        return self._in_variables(found[0])


def stacked(matrix: Any, rows: np.ndarray) -> Any:
    """Return a matrix with more rows."""
    if isinstance(matrix, np.ndarray):
        return np.concatenate([matrix, rows])
    return sp.sparse.vstack([matrix, sp.sparse.csr_array(rows)]).tocsr()
