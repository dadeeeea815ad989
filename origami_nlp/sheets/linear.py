"""Linear systems of closure whose rows may depend on each other, dense for small patterns and sparse for large ones.

No step decides on a rank: closure multipliers carry a small weight, and what it leaves is taken up by another step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.linalg import splu

from origami_nlp.sheets.closure import Matrix

WEIGHT = 1e-10
"""Of closure multipliers in linear systems, beside squares of singular values of closure."""


class Factor:
    """Factors of [matrix J'; J -eps].

    Parameters
    ----------
    matrix
        Symmetric, [n, n].
    jacobian
        J, [m, n].
    """

    def __init__(self, matrix: Matrix, jacobian: Matrix) -> None:
        m = jacobian.shape[0]
        self._solve: Any
        if isinstance(jacobian, np.ndarray):
            whole = np.block([[dense(matrix), jacobian.T], [jacobian, -WEIGHT * np.eye(m)]])
            lu = linalg.lu_factor(whole, check_finite=False)
            self._solve = lambda b: linalg.lu_solve(lu, b, check_finite=False)
        else:
            damping = -WEIGHT * sparse.eye_array(m)
            blocks = [[sparse.csr_array(matrix), jacobian.T], [jacobian, damping]]
            self._solve = splu(sparse.block_array(blocks, format="csc")).solve

    def solve(self, top: np.ndarray, bottom: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return both parts of the solution, [n] and [m]."""
        both = self._solve(np.concatenate([top, bottom]))
        return both[: len(top)], both[len(top) :]


class Normal:
    """Factors of J J' + eps: steps of least length, multipliers of least squares, projections onto the kernel.

    Parameters
    ----------
    jacobian
        J, [m, n].
    """

    def __init__(self, jacobian: Matrix) -> None:
        self.jacobian = jacobian
        m = jacobian.shape[0]
        self._solve: Any
        if not m:
            self._solve = np.copy
        elif isinstance(jacobian, np.ndarray):
            square = jacobian @ jacobian.T
            square.flat[:: m + 1] += WEIGHT
            lower = linalg.cho_factor(square, lower=True, check_finite=False)
            self._solve = lambda b: linalg.cho_solve(lower, b, check_finite=False)
        else:
            square = (jacobian @ jacobian.T + WEIGHT * sparse.eye_array(m)).tocsc()
            self._solve = splu(square, options={"SymmetricMode": True}, diag_pivot_thresh=0.0,
                               permc_spec="MMD_AT_PLUS_A").solve  # fmt: skip

    def step(self, c: np.ndarray) -> np.ndarray:
        """Return the shortest d with J d = c, [n]."""
        return self.jacobian.T @ self._solve(c)

    def multipliers(self, g: np.ndarray, times: int = 3) -> np.ndarray:
        """Return the smallest lam that brings J' lam closest to g [n], [m]."""
        lam = np.zeros(self.jacobian.shape[0])
        for _ in range(times):
            lam += self._solve(self.jacobian @ (g - self.jacobian.T @ lam))
        return lam

    def along(self, v: np.ndarray) -> np.ndarray:
        """Return the part of v [n] that closure allows to first order."""
        for _ in range(2):
            v = v - self.jacobian.T @ self._solve(self.jacobian @ v)
        return v


def dense(matrix: Matrix) -> np.ndarray:
    """Return a matrix as a dense array."""
    return matrix if isinstance(matrix, np.ndarray) else matrix.toarray()
