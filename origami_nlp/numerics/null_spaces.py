"""Rank and null spaces of a matrix by orthogonal factors with pivoted columns, a fifth of the time of singular vectors.

The rank is proved: what the factors leave bounds the singular values below, the inverse of the triangle those above
(Golub and Van Loan, Matrix Computations, section 5.4).  Where a bound asked for lies between, singular values decide.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.numerics.tolerances import FOLLOWED, RANK, ROUNDED

ROOM = 10.0
"""Between proved bounds of singular values and what they are compared with: for rounding of the factors."""


def _lapack() -> Any:
    import scipy.linalg.lapack  # heavy

    return scipy.linalg.lapack


class NullSpaces:
    """Null spaces of a matrix from both sides; singular values below `RANK` count as zero.

    Parameters
    ----------
    matrix
        A, [m, n]; n at least 1.

    Attributes
    ----------
    gap
        Bounds between which there is no singular value, unless the first is larger.

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp.numerics import NullSpaces
    >>> of = NullSpaces(np.array([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]))
    >>> of.rank(), of.kernel.shape, bool(abs(of.lost @ [1.0, 2.0]).max() < 1e-15)
    (1, (3, 2), True)
    """

    def __init__(self, matrix: np.ndarray) -> None:
        self._matrix = matrix
        if not len(matrix):
            matrix = np.zeros((1, matrix.shape[1]))
        # A' P = Q R
        self._qr, order, self._tau, _, _ = _lapack().dgeqp3(matrix.T)
        self._order = order - 1
        diagonal = np.abs(self._qr.diagonal())
        self._count = int((diagonal > RANK).sum())
        self._inverse = np.zeros((0, 0))
        largest, smallest = 0.0, math.inf
        r = self._count
        if r < len(diagonal):
            largest = float(np.linalg.norm(np.triu(self._qr[r:, r:])))
        if r:
            self._inverse, failed = _lapack().dtrtri(self._qr[:r, :r])
            self._inverse = np.triu(self._inverse)
            smallest = 0.0 if failed else 1 / float(np.linalg.norm(self._inverse))
        # of the singular values: the r largest are above the second, the others below the first
        self.gap = largest, smallest

    @cached_property
    def _singular(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        u, values, vt = np.linalg.svd(self._matrix)
        return u, values, vt

    def _is_known(self, below: float) -> bool:
        return ROOM * self.gap[0] < below < self.gap[1] / ROOM

    def rank(self, below: float = RANK) -> int:
        """Return how many singular values are above a bound."""
        if self._is_known(below):
            return self._count
        return int((self._singular[1] > below).sum())

    def any_between(self, low: float, high: float) -> bool:
        """Return whether there is a singular value above one bound and below another."""
        if self._is_known(low) and self._is_known(high):
            return False
        values = self._singular[1]
        return bool(((values > low) & (values < high)).any())

    def left_out(self, f: np.ndarray) -> float:
        """Return what `left_out` says, with no singular values where none can be among those it asks for."""
        return 0.0 if self._is_known(FOLLOWED) else left_out(self._matrix, f)

    @cached_property
    def kernel(self) -> np.ndarray:
        """Orthonormal basis of what A takes to zero, [n, n - rank]."""
        n, rank = self._matrix.shape[1], self.rank()
        if not self._is_known(RANK):
            return np.array(self._singular[2][rank:].T, order="C")
        rest = np.zeros((n, n - rank))
        rest[rank:] = np.eye(n - rank)
        first = self._qr[:, :rank], self._tau[:rank]
        z, _, _ = _lapack().dormqr("L", "N", *first, rest, 64 * n) if rank else (rest, 0, 0)
        return np.array(z, order="C")

    @cached_property
    def lost(self) -> np.ndarray:
        """Orthonormal rows w with w A = 0, [m - rank, m]."""
        m, rank = len(self._matrix), self.rank()
        if not self._is_known(RANK):
            rows: np.ndarray = self._singular[0].T[rank:]
            return rows
        # A' P = Q [R1 R2; 0 0]: w = P [-R1^-1 R2; 1]
        if not m:
            return np.zeros((0, 0))
        free = np.zeros((m, m - rank))
        free[self._order[:rank]] = -self._inverse @ self._qr[:rank, rank:]
        free[self._order[rank:]] = np.eye(m - rank)
        return np.linalg.qr(free)[0].T


def left_out(matrix: np.ndarray, f: np.ndarray) -> float:
    """Return the length of the part of Newton's step for values that singular values counted as zero stand for.

    Those that only rounding keeps from zero, below `FOLLOWED`, have no part in it; of the others no value is known to
    better than `ROUNDED`.

    Parameters
    ----------
    matrix
        A, [m, n].
    f
        What A times the step is to be, [m].

    Returns
    -------
    float
        The length.

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp.numerics.null_spaces import left_out
    >>> left_out(np.diag([1.0, 1e-8]), np.array([1.0, 3e-8])) > 2.9
    True
    """
    u, values, _ = np.linalg.svd(matrix, full_matrices=False)
    small = np.flatnonzero((values > FOLLOWED) & (values <= RANK))
    return float(np.linalg.norm(np.maximum(np.abs(u.T[small] @ f), ROUNDED) / values[small]))
