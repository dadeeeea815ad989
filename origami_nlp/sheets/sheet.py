"""A pattern as a nonlinear programme: energy over fold angles, closure as equations, fold limits as bounds.

Closure rows are redundant as a rule (a Miura sheet of m x n facets has (m - 2)(n - 2) that say nothing new, and they
carry self-stress), so that no step here decides on a rank: linear systems are those of the proximal method,

    [ H   J' ] [ d       ]   [ -grad L ]
    [ J  -eps] [ d lambda] = [ -c      ],

whose solution does not notice dependent rows, and minima are certified by positive curvature on the kernel of J,
which is enough whether or not rows are dependent.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh

from origami_nlp.numerics import RANK, ROUNDED
from origami_nlp.pattern import Pattern
from origami_nlp.sheets.closure import Closure, Matrix
from origami_nlp.sheets.crossings import Crossings
from origami_nlp.sheets.linear import Normal, dense

MOST_DENSE = 400
"""Creases up to which kernels are formed by a singular value decomposition; sparse factors beyond."""
SQUARED = 1e-12
"""Eigenvalues of J'J below this are zero: rounding leaves some 1e-15, and of `RANK` nothing could be told."""
LONGEST = 0.5
"""Steps of a projection are cut to this largest change of a fold angle [rad]."""


class Sheet:
    """The programme of a pattern.

    Parameters
    ----------
    pattern
        With its springs.

    Attributes
    ----------
    closure
        Its equations.
    crossings
        Its test of facets that cross.
    scale
        Mean stiffness [N m/rad]: residuals of torques are over it.
    """

    def __init__(self, pattern: Pattern) -> None:
        self.pattern = pattern
        self.closure = Closure(pattern)
        self.crossings = Crossings(pattern)
        self.scale = float(pattern.stiffness.mean())

    @property
    def size(self) -> int:
        """Number of creases n."""
        return self.pattern.creases

    @cached_property
    def stiffness(self) -> np.ndarray:
        """Over `scale`, [n]."""
        return self.pattern.stiffness / self.scale

    def torque(self, phi: np.ndarray) -> np.ndarray:
        """Gradient of the energy over `scale`, [n]."""
        return self.stiffness * (phi - self.pattern.rest)

    def energy(self, phi: np.ndarray) -> float:
        """Elastic energy over `scale`."""
        return float(0.5 * self.stiffness @ (phi - self.pattern.rest) ** 2)

    def residual(self, phi: np.ndarray) -> float:
        """Largest entry of closure."""
        return float(np.abs(self.closure.values(phi)).max(initial=0.0))

    def project(
        self, phi: np.ndarray, held: np.ndarray | None = None, steps: int = 40
    ) -> tuple[np.ndarray, float]:
        """Move fold angles onto closure by steps of least length.

        Parameters
        ----------
        phi
            Shape [n] [rad].
        held
            Of bool: those that stay, shape [n].
        steps
            Of Gauss-Newton at most.

        Returns
        -------
        phi : numpy.ndarray
            Where the steps ended.
        residual : float
            Largest entry of closure there: whether that is close enough is for the caller to say.
        """
        phi = phi.copy()
        free = None if held is None else np.flatnonzero(~held)
        for _ in range(steps):
            at = self.closure.turned(phi)
            c = self.closure.values(phi, at)
            if np.abs(c).max(initial=0.0) <= ROUNDED:
                break
            j = self.closure.jacobian(phi, at)
            j = j if free is None else j[:, free]
            d = Normal(j).step(-c)
            d *= min(1.0, LONGEST / max(float(np.abs(d).max(initial=0.0)), 1e-300))
            if free is None:
                phi += d
            else:
                phi[free] += d
        return phi, self.residual(phi)

    def multipliers(
        self, phi: np.ndarray, held: Iterable[int] = ()
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Balance the springs by closure, and by fold limits that are held.

        Parameters
        ----------
        phi
            A closed state, [n].
        held
            Creases at a fold limit.

        Returns
        -------
        closure : numpy.ndarray
            Multipliers of smallest norm, [m].
        limits : numpy.ndarray
            Moments over `scale` of the limits held, positive where they push, one each.
        imbalance : numpy.ndarray
            Torque that is left, [n].
        """
        held = list(held)
        j, g = self.closure.jacobian(phi), self.torque(phi)
        free = np.setdiff1d(np.arange(self.size), held)
        lam = Normal(j[:, free]).multipliers(g[free])
        balance = g - j.T @ lam
        limits = np.array([-math.copysign(1.0, phi[i]) * balance[i] for i in held])
        balance[held] = 0.0
        return lam, limits, balance

    def hessian(self, phi: np.ndarray, multipliers: np.ndarray) -> Matrix:
        """Hessian of U - multipliers . closure over `scale`, [n, n]."""
        bent = self.closure.hessian(phi, multipliers)
        if isinstance(bent, np.ndarray):
            return np.diag(self.stiffness) - bent
        return sparse.diags_array(self.stiffness).tocsr() - bent

    def along(self, phi: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return the part of v [n] that closure allows to first order at a state."""
        return self.normal(phi).along(v)

    def normal(self, phi: np.ndarray) -> Normal:
        """Factorise J J' at a state."""
        return Normal(self.closure.jacobian(phi))

    def kernel(self, phi: np.ndarray, held: Iterable[int] = ()) -> np.ndarray:
        """Orthonormal basis of the motions that closure allows to first order with creases held, [n, t]; dense."""
        free = np.setdiff1d(np.arange(self.size), list(held))
        j = dense(self.closure.jacobian(phi))[:, free]
        _, values, vt = np.linalg.svd(j, full_matrices=True)
        rank = int((values > RANK).sum())
        z = np.zeros((self.size, len(free) - rank))
        z[free] = vt[rank:].T
        return z

    def rank(self, phi: np.ndarray) -> int:
        """Rank of the Jacobian of closure, singular values below `RANK` being zero."""
        j = self.closure.jacobian(phi)
        if not j.shape[0]:
            return 0
        if self.size <= MOST_DENSE:
            return int((np.linalg.svd(dense(j), compute_uv=False) > RANK).sum())
        # singular values of a large sheet shrink as one over its length: the smallest ones of J'J are counted
        square = sparse.csc_array(j.T @ j)
        for many in (6, 24, 96, 384):
            values = eigsh(square, k=min(many, self.size - 2), sigma=-1e-9, return_eigenvectors=False,
                           v0=np.ones(self.size))  # fmt: skip
            zero = int((values < SQUARED).sum())
            if zero < len(values):
                return self.size - zero
        return int((np.linalg.svd(dense(j), compute_uv=False) > RANK).sum())
