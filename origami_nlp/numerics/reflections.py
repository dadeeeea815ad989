"""An orthonormal basis of what a few rows leave, as the reflections that make it: products without the basis itself."""

from __future__ import annotations

import numpy as np

from origami_nlp.numerics.tolerances import ROUNDED


class KernelBasis:
    """Basis Z of the vectors at right angles to a few orthonormal rows, as Householder reflections.

    Products take O(n^2 r), where Z' M Z with the basis itself takes O(n^3).

    Parameters
    ----------
    rows
        Orthonormal, [r, n].

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp.numerics import KernelBasis
    >>> basis = KernelBasis(np.array([[0.0, 1.0, 0.0]]))
    >>> basis.within(np.diag([1.0, 2.0, 3.0])).tolist()
    [[1.0, 0.0], [0.0, 3.0]]
    """

    def __init__(self, rows: np.ndarray) -> None:
        import scipy as sp

        self._rank = len(rows)
        self._factors, self._scales, _, _ = sp.linalg.lapack.dgeqrf(rows.T)

    def _turned(self, x: np.ndarray, transposed: str) -> np.ndarray:
        if not self._rank:
            return x
        import scipy as sp

        work = max(1, 64 * x.shape[1])
        out: np.ndarray = sp.linalg.lapack.dormqr(
            "L", transposed, self._factors, self._scales, x, work
        )[0]
        return out

    def coordinates(self, x: np.ndarray) -> np.ndarray:
        """Return Z' x of vectors in columns [n, k], [n - r, k]."""
        return self._turned(x, "T")[self._rank :]

    def spread(self, y: np.ndarray) -> np.ndarray:
        """Return Z y of coordinates in columns [n - r, k], [n, k]."""
        return self._turned(np.vstack([np.zeros((self._rank, y.shape[1])), y]), "N")

    def within(self, matrix: np.ndarray) -> np.ndarray:
        """Return Z' M Z of a symmetric matrix [n, n], [n - r, n - r]."""
        return self.coordinates(self.coordinates(matrix).T)


def solve_symmetric(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve a symmetric system [n, n]: by Cholesky's factors where it is positive definite, else by least squares.

    Directions of singular values below `ROUNDED` over the largest are left out.
    """
    import scipy as sp

    lower, failed = sp.linalg.lapack.dpotrf(matrix, lower=True)
    if not failed:
        inverse, _ = sp.linalg.lapack.dpocon(lower, np.abs(matrix).sum(axis=0).max(), uplo="L")
        if inverse > len(matrix) * ROUNDED:  # norms differ by that factor at most
            found: np.ndarray = sp.linalg.lapack.dpotrs(lower, right, lower=True)[0]
            return found
    least: np.ndarray = np.linalg.lstsq(matrix, right, rcond=ROUNDED)[0]
    return least
