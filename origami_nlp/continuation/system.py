"""The KKT system of states over a parameter, and its linear algebra.

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
from functools import cached_property
from typing import Any

import numpy as np
import scipy as sp

from origami_nlp.continuation.line import Line, Rates
from origami_nlp.kkt import Classification, State, classify
from origami_nlp.numerics import EPS, RANK, Factor, Normal, null_space
from origami_nlp.problem import Contact

ASLANT = 10.0
"""One over the cosine between a curve and a row: up to here one factorisation gives its direction."""
REFINED = 8
"""Solutions of one system at most, each of what the ones before leave."""


class BorderedSystem:
    """The KKT system of a point (x, s) with contacts held, in the metric of all fold angles.

    Parameters
    ----------
    line
        Of the parameter.
    point
        State and parameter (x, s), [n + 1].
    hold
        The contacts that are held closed.
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
        hold: tuple[Contact, ...] = (),
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
        self.values, self.jacobian = local.closure, local.closure_jacobian / root
        if hold:
            values, slopes = local.openings(hold)
            self.jacobian = np.concatenate([self.jacobian, slopes / root])
            self.values = np.concatenate([local.closure, values])
        gradient = local.gradient / root
        self.size = 1.0 + float(np.abs(gradient).max(initial=0.0))
        if multipliers is None:
            multipliers = self._least_squares(gradient)
        self.multipliers = multipliers
        self.hessian = (p.curvature(x, multipliers, hold) / root).T / root
        torque, moved = line.drift(p, s, x, multipliers, hold)
        self.drift = torque / root / line.weight
        self.moved = moved / line.weight
        self.imbalance = gradient - self.jacobian.T @ multipliers

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
        gradient = self.imbalance + self.jacobian.T @ self.multipliers
        return Normal(self.jacobian).multipliers(gradient)

    @cached_property
    def range(self) -> np.ndarray:
        """Basis of the row space of closure here, and all contacts, [m + r, q]."""
        r = len(self.hold)
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
        at_limit = [c.index for c in self.hold if c.is_limit]
        z, first = np.asarray(p.kernel(self.x, at_limit)), p.equation_count
        gaps = [first + k for k, c in enumerate(self.hold) if not c.is_limit]
        return z @ null_space(self.jacobian[gaps] @ z) if gaps else z

    @property
    def free(self) -> int:
        """Number of directions that closure and contacts leave, at least."""
        return len(self.eigenvalues)

    @cached_property
    def least(self) -> float:
        """Smallest singular value of contacts along what closure leaves free."""
        if not (r := len(self.hold)):
            return 1.0
        rows = self.jacobian[len(self.values) - r :] @ self.problem.kernel(self.x)
        sizes = np.linalg.svd(rows, compute_uv=False)
        return float(sizes.min()) if r <= rows.shape[1] else 0.0

    @cached_property
    def eigenvalues(self) -> np.ndarray:
        """Of the Hessian on what closure and contacts leave free, ascending."""
        z = self.kernel
        return np.linalg.eigvalsh(z.T @ (self.hessian @ z))

    @property
    def matrix(self) -> np.ndarray:
        """Derivative of the system by (y, nu, w s), [n + k, n + k + 1]."""
        c = self.jacobian
        k, n = c.shape
        out = np.zeros((n + k, n + k + 1))
        out[:n, :n], out[:n, n:-1], out[:n, -1] = self.hessian, -c.T, self.drift
        out[n:, :n], out[n:, -1] = c, self.moved
        return out

    def _bordered(self, row: np.ndarray) -> Callable[..., Rates | None]:
        """Factorise with one more row over (dy, w ds); return what solves for that and minus the change of nu."""
        # curvature that multipliers add beside singular states would let eps be taken back slowly
        size = max(1.0, float(abs(self.hessian).max()))
        h, c, moved, span = self.hessian / size, self.jacobian, self.moved, self.span
        if span is not None:
            c, moved = span.T @ c, span.T @ moved
        matrix = np.vstack([np.column_stack([h, self.drift / size]), row])
        below, across = np.column_stack([c, moved]), np.vstack([c.T, np.zeros(len(c))])
        factor = Factor(matrix, below, across)

        def solve(top: np.ndarray, right: float, bottom: np.ndarray) -> Rates | None:
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

    def other_direction(self, along: np.ndarray) -> np.ndarray:
        """Return the direction (dy, w ds) across one at a branching, of length 1."""
        z, n = self.kernel, len(self.imbalance)
        # on the kernel the KKT system is Z' H Z dz + Z' F_s ds = 0; multipliers follow
        inside = np.column_stack([z.T @ (self.hessian @ z), z.T @ self.drift])
        whole = np.vstack([inside, np.append(z.T @ along[:n], along[-1])])
        v = np.linalg.svd(whole)[2][-1]
        return np.append(z @ v[:-1], v[-1])

    def step(self, row: np.ndarray, right: float) -> np.ndarray | None:
        """Return Newton's step in (x, s) of the bordered system (pseudo-arclength): row . (dy, w ds) = right is
        added."""
        found = self._bordered(row)(-self.imbalance, right, -self.values)
        if found is None:
            return None
        step, self.after = found[0], self.multipliers + found[1]
        return np.append(step[:-1] / self.problem.root, step[-1] / self.line.weight)
