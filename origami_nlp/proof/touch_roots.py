"""The KKT system of states with closed gaps: `roots.System` with the gaps beside closure."""

from __future__ import annotations

import numpy as np

from origami_nlp.programme import Model
from origami_nlp.proof.roots import System


class TouchSystem(System):
    """The KKT system of a model on a stratum where gaps are closed.

    A gap is a product of two unit vectors one of which is turned by the folds between, so that its derivatives of
    order p are at most beta_i beta_j ..., beta = 1 a fold, 1/2 on a mirror: `roots` holds with these.

    Parameters
    ----------
    model
        With contact ``full``.
    gaps
        Positions in `Structure.gaps`.
    """

    def __init__(self, model: Model, gaps: tuple[int, ...]) -> None:
        super().__init__(model)
        self.gaps = gaps
        self.equations = self.m
        self.m += len(gaps)
        if gaps and self.equations > 1:  # closure by a quaternion: half as steep
            self.beta = 2 * self.beta

    def constraints(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return closure and gaps [K, m] and their Jacobian [K, m, n]."""
        folded = self.kinematics.fold(x)
        g, a = self.kinematics.closure(folded)
        h, b = self.kinematics.gaps(folded, self._slots(x))
        return np.concatenate([g, h], axis=1), np.concatenate([a, b], axis=1)

    def curvature(self, x: np.ndarray, lam: np.ndarray) -> np.ndarray:
        """Return the Hessian [K, n, n] of lam . (closure, gaps)."""
        folded, e = self.kinematics.fold(x), self.equations
        h = self.kinematics.closure_hessian(folded, lam[:, :e])
        return h + self.kinematics.gaps_hessian(folded, self._slots(x), lam[:, e:])

    def _slots(self, x: np.ndarray) -> np.ndarray:
        return np.tile(np.array(self.gaps, dtype=int), (len(x), 1))
