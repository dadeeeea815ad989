"""Newton's direction of a vertex without symmetry in time that grows as N, not N^3: one sweep back, one forward.

On the stratum of a closed state the Lagrangian has the Hessian H = 1 - (lam x a_i) . a_j / 4 (i < j) in the metric
y = sqrt(k) phi, a_i = c_i / sqrt(k_i), which couples a crease to those before it only through the turn
theta_j = sum over i < j of a_i d_i, three numbers.  So the step is a problem of optimal control with three states,

    min  sum d_j^2 / 2 - d_j lam . (theta_j x a_j) / 4 + R_j d_j,    theta_(j+1) = theta_j + a_j d_j,    theta_end = 0,

solved by the backward recursion of Riccati (J. C. Dunn and D. P. Bertsekas, "Efficient dynamic programming
implementations of Newton's method", J. Optim. Theory Appl. 63, 1989) for the value as a quadratic form of theta and of
the multipliers of theta_end = 0.  Its pivots are those of an L D L' decomposition: where all are positive the Hessian
is so on the stratum; one that is not is made so, which adds to the diagonal of H, and shows a direction of negative
curvature.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import EPS, NONZERO, cross
from origami_nlp.starts import ClosurePoint, Samples

LEAST_PIVOT = 1e-2
"""Pivots (1 for springs alone) are at least this."""
STIFF = 1e3
"""Stiffness against what does not close, relative to the largest of the Hessian: closed states do not feel it, but it
makes pivots positive where only states that do not close have negative curvature."""


@dataclass(frozen=True, eq=False)
class NewtonSweep:
    """Newton's directions of samples, and how curved they are.

    Attributes
    ----------
    direction
        Shape [K, n], in the metric; where the Hessian is not positive, of one that was made so.
    bent
        A unit direction of the stratum along which a pivot was not positive, shape [K, n]; 0 where all were.
    curvature
        Of the Lagrangian along `bent`, [K]; positive where that is 0.
    """

    direction: np.ndarray
    bent: np.ndarray
    curvature: np.ndarray


def sweep(s: Samples, p: ClosurePoint, root: np.ndarray, soft: np.ndarray) -> NewtonSweep:
    """Sweep over the creases of samples that hold nothing but fold limits.

    Parameters
    ----------
    s, p
        Samples of a model without symmetry, and what they are at their states.
    root
        Square roots of the stiffness, shape [n].
    soft
        Stiffness of hinges over that of the metric: 1 for springs; of laws it may be negative, shape [n] or [K, n].

    Returns
    -------
    NewtonSweep
        Directions along the strata of the samples; all moves keep the creases fully folded that are.
    """
    free = s.at_limit == 0
    a = np.where(free[..., None], p.at.axes / root[:, None], 0.0)
    lam = p.multipliers[:, :3]
    bend = -0.25 * cross(a, lam[:, None])
    down = np.where(free, p.left, 0.0)
    soft = np.where(free, soft, 1.0)
    back = _Backward(a, bend, down, lam, soft)
    d = back.forward(np.zeros(len(a), dtype=int), down=True)
    bent = back.forward(back.first, down=False)
    # what does not close is taken off, by the shortest way
    rows = p.free_rows
    along = (rows @ bent[..., None])[..., 0]
    bent -= (rows.transpose(0, 2, 1) @ (p.inverse @ along[..., None]))[..., 0]
    size = np.linalg.norm(bent, axis=1)
    bent /= np.maximum(size, NONZERO)[:, None]
    turn = np.cumsum(a * bent[..., None], axis=1) - a * bent[..., None]
    # bent' H bent: H is the unit matrix, what laws change of it, and twice its part above the diagonal
    curvature = 1 + 2 * np.einsum("kj,kjx,kjx->k", bent, turn, bend)
    curvature += ((soft - 1) * bent**2).sum(axis=1)
    none = (back.first < 0) | (size <= EPS)
    bent[none], curvature[none] = 0.0, 1.0
    return NewtonSweep(d, bent, curvature)


class _Backward:
    """The backward recursion, over arrays [n, ., K].

    first: the last crease whose pivot is not positive, -1 where all are, [K].
    """

    def __init__(
        self, a: np.ndarray, bend: np.ndarray, down: np.ndarray, lam: np.ndarray, soft: np.ndarray
    ) -> None:
        self._a, bend = (np.ascontiguousarray(v.transpose(1, 2, 0)) for v in (a, bend))
        n, _, count = self._a.shape
        largest = (self._a**2).sum(axis=1).max(axis=0)
        stiff = 1 / np.maximum(largest, NONZERO) + np.abs(lam).max(axis=1)
        stiff *= STIFF * np.maximum(1.0, np.abs(soft).max(axis=1))
        # value: half a quadratic form of (theta, multipliers), and its linear part in the last column
        v = np.zeros((6, 7, count))
        # at the end: stiff |theta|^2 / 2 + multipliers . theta
        for i in range(3):
            v[i, i], v[i, i + 3], v[i + 3, i] = stiff, 1.0, 1.0
        self._row, self._pivot = np.empty((n, 7, count)), np.empty((n, count))
        self.first = np.full(count, -1)
        for j in range(n - 1, -1, -1):
            # theta_(j+1) = theta_j + a_j d_j put into the value: `row` is what multiplies d_j, `pivot` what d_j^2 / 2
            row = (v[:3] * self._a[j][:, None]).sum(axis=0)
            pivot = soft[:, j] + (row[:3] * self._a[j]).sum(axis=0)
            row[:3] += bend[j]
            row[6] += down[:, j]
            self.first = np.where((self.first < 0) & (pivot <= 0), j, self.first)
            self._row[j], self._pivot[j] = row, np.maximum(np.abs(pivot), LEAST_PIVOT)
            # minimised over d_j: a Schur complement
            v -= row[:6, None] * (row / self._pivot[j])
        self._value = v

    def forward(self, start: np.ndarray, *, down: bool) -> np.ndarray:
        """Return d [K, n]: Newton's, or that of a unit move of crease `start` and what follows from it."""
        n, _, count = self._a.shape
        theta = np.zeros((7, count))  # with the multipliers and 1
        if down:
            w = self._value[3:, 3:].transpose(2, 0, 1)
            size = np.abs(w).max(axis=(1, 2))[:, None, None]
            # stationary in the multipliers; shifted by rounding for creases that all lie on one line or in one plane
            matrix = w[..., :3] - (4 * EPS * size + NONZERO) * np.eye(3)
            theta[3:6] = -np.linalg.solve(matrix, w[..., 3:])[..., 0].T
            theta[6] = 1.0
        d = np.empty((n, count))
        for j in range(n):
            d[j] = -(self._row[j] * theta).sum(axis=0) / self._pivot[j]
            if not down:
                d[j] = np.where(j == start, 1.0, d[j])
            theta[:3] += self._a[j] * d[j]
        return d.T
