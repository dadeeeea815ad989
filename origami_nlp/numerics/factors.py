"""Linear systems with rows that may depend on each other, dense for small matrices and sparse for large ones.

Closure multipliers carry a small weight, and what it leaves is taken up by another step.  Beside a singular state that
takes for ever: a singular value whose square is below the weight moves by a share of itself a step.  There, and only
there, singular vectors decide, with the bound on singular values that kernels have (`RANK`).
"""

from __future__ import annotations

import math
from functools import cached_property, lru_cache
from typing import Any, TypeAlias

import numpy as np
import scipy as sp

from origami_nlp.numerics.tolerances import EPS, RANK, ROUNDED

Matrix: TypeAlias = "np.ndarray | sp.sparse.csr_array"
"""Dense, or sparse where that is worth it."""

WEIGHT = 1e-10
"""Of closure multipliers in linear systems, beside squares of singular values of closure."""
MOST_TIMES = 60
"""Iterations that take it back, each by WEIGHT / (WEIGHT + value^2): two as a rule, more beside a singular state."""
MOST_DECOMPOSED = 400
"""Columns up to which singular vectors decide where iterations stall."""
SYMMETRIC: dict[str, Any] = {
    "options": {"SymmetricMode": True},
    "diag_pivot_thresh": 0.0,
    "permc_spec": "MMD_AT_PLUS_A",
}
"""Elimination of definite matrices without exchange of rows: a fifth of the entries and of the time."""
LONG = 1e3
"""Rows that are longer count as rows of length 1: rounding of their squares would come near `WEIGHT`.  Those of closure
are no longer than some units; gaps between sides that are all but parallel are."""
BACKWARD = 1e-12
"""Backward error of a refined solution, over norms of matrix, solution and right-hand side, up to which elimination
without exchange of rows will do: 1e-15 to 1e-14 where curvature is positive."""
FULL = 0.5
"""Share of entries from which a sparse matrix is eliminated as a dense one: the curvature of one long loop."""
STALLS = 0.9
"""Corrections that shrink no faster are rounding."""


class Factor:
    """Factors of [matrix C; J -eps].

    Parameters
    ----------
    matrix
        Of shape [n, n].
    jacobian
        J, [m, n].
    across
        C, [n, m]; J' by default.
    weight
        eps.
    """

    def __init__(
        self, matrix: Matrix, jacobian: Matrix, across: Matrix | None = None, weight: float = WEIGHT
    ) -> None:
        m = jacobian.shape[0]
        symmetric = across is None
        across = jacobian.T if across is None else across
        self._solve: Any  # LAPACK itself: checks of `scipy.linalg` cost more than small systems
        n = jacobian.shape[1]
        full = not isinstance(matrix, np.ndarray) and matrix.nnz > FULL * n * n
        if full or isinstance(jacobian, np.ndarray):
            whole = np.zeros((n + m, n + m), order="F")
            whole[:n, :n], whole[:n, n:], whole[n:, :n] = (
                dense(m) for m in (matrix, across, jacobian)
            )
            # the diagonal from entry (n, n) on
            whole.T.flat[n * (n + m + 1) :: n + m + 1] = -weight
            lu, pivots, _ = sp.linalg.lapack.dgetrf(whole, overwrite_a=True)
            self._solve = lambda b: sp.linalg.lapack.dgetrs(lu, pivots, b)[0]
        else:
            blocks = [
                [sp.sparse.csr_array(matrix), sp.sparse.csr_array(across)],
                [jacobian, -_damping(m, weight)],
            ]
            whole = sp.sparse.block_array(blocks, format="csc")
            self._solve = (
                _SymmetricSolve(whole) if symmetric else sp.sparse.linalg.splu(whole).solve
            )

    def solve(self, top: np.ndarray, bottom: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return both parts of the solution, [n] and [m]."""
        both = self._solve(np.concatenate([top, bottom]))
        return both[: len(top)], both[len(top) :]


class _SymmetricSolve:
    """Solves a sparse symmetric system: without exchange of rows and refined once, with it if an error is left.

    A quasi-definite matrix, as of positive curvature with closure, has such factors in any order (Vanderbei, SIAM J.
    Optim. 5, 1995); of others, and of small weights, they grow, which the backward error shows.
    """

    def __init__(self, matrix: sp.sparse.csc_array) -> None:
        self._matrix, self._size = matrix, float(abs(matrix).sum(axis=0).max())
        try:
            self._factors, self._exchanged = sp.sparse.linalg.splu(matrix, **SYMMETRIC), False
        except RuntimeError:  # a pivot is zero
            self._factors, self._exchanged = sp.sparse.linalg.splu(matrix), True

    def __call__(self, b: np.ndarray) -> np.ndarray:
        x: np.ndarray = self._factors.solve(b)
        if self._exchanged:
            return x
        x += self._factors.solve(b - self._matrix @ x)
        left = float(np.abs(b - self._matrix @ x).max())
        if left <= BACKWARD * (self._size * float(np.abs(x).max()) + float(np.abs(b).max())):
            return x
        self._factors, self._exchanged = sp.sparse.linalg.splu(self._matrix), True
        return self(b)


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
            lengths = np.sqrt(square.flat[:: m + 1])
            size = np.where(lengths > LONG, lengths, 1.0)
            if (size > 1.0).any():
                square = (jacobian / size[:, None]) @ (jacobian / size[:, None]).T
            square.flat[:: m + 1] += WEIGHT
            lower, failed = sp.linalg.lapack.dpotrf(
                square.T, lower=True, clean=False, overwrite_a=True
            )
            if failed:
                raise np.linalg.LinAlgError("J J' is not positive definite")
            self._solve = lambda b: sp.linalg.lapack.dpotrs(lower, b / size, lower=True)[0] / size
        else:
            square = (jacobian @ jacobian.T + _damping(m)).tocsc()
            self._solve = sp.sparse.linalg.splu(square, **SYMMETRIC).solve

    def step(self, c: np.ndarray) -> np.ndarray:
        """Return the shortest d with J d = c, [n]; along singular vectors whose values are small a share of it."""
        # J' (J J' + eps)^-1 c
        return self.jacobian.T @ self._solve(c)

    def multipliers(self, g: np.ndarray) -> np.ndarray:
        """Return the Lagrange multipliers lam [m] of smallest norm that bring J' lam closest to g [n]."""
        lam = np.zeros(self.jacobian.shape[0])
        before = math.inf
        for _ in range(MOST_TIMES):
            # iterated Tikhonov regularisation: what the weight leaves of each singular direction shrinks by w / (w +
            # s^2)
            step = self._solve(self.jacobian @ (g - self.jacobian.T @ lam))
            lam += step
            size = float(np.abs(step).max(initial=0.0))
            if size <= EPS * np.abs(lam).max(initial=0.0):
                return lam
            if size > STALLS * before:
                break
            before = size
        moved = float(np.abs(self.jacobian.T @ step).max(initial=0.0))
        if moved <= ROUNDED * np.abs(g).max(initial=0.0) or not self._decomposable:
            return lam
        u, values, vt = self._decomposed
        exact: np.ndarray = u @ ((vt @ g) / values)
        return exact

    def along(self, v: np.ndarray) -> np.ndarray:
        """Return the part of v [n] that closure allows to first order."""
        whole, longest = v, float(np.abs(v).max(initial=0.0))
        before = math.inf
        for _ in range(MOST_TIMES):
            step = self.jacobian.T @ self._solve(self.jacobian @ v)
            v = v - step
            size = float(np.abs(step).max(initial=0.0))
            if size <= EPS * longest:
                return v
            if size > STALLS * before:
                break
            before = size
        if size <= ROUNDED * longest or not self._decomposable:
            return v
        _, _, vt = self._decomposed
        return whole - vt.T @ (vt @ whole)

    @property
    def _decomposable(self) -> bool:
        """Whether singular vectors are to be had."""
        return self.jacobian.shape[1] <= MOST_DECOMPOSED

    @cached_property
    def _decomposed(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Singular vectors and values of J above `RANK`: [m, r], [r], [r, n]."""
        u, values, vt = np.linalg.svd(dense(self.jacobian), full_matrices=False)
        rank = int((values > RANK).sum())
        return u[:, :rank], values[:rank], vt[:rank]


@lru_cache(maxsize=4)
def _damping(m: int, weight: float = WEIGHT) -> sp.sparse.csr_array:
    return sp.sparse.csr_array(weight * sp.sparse.eye_array(m))


def dense(matrix: Matrix) -> np.ndarray:
    """Return a matrix as a dense array."""
    return matrix if isinstance(matrix, np.ndarray) else matrix.toarray()
