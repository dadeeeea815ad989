"""The KKT system of states with closed gaps: `BoxKkt` with the gaps beside closure."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.problem import FoldedRays, Model
from origami_nlp.proof.system import BoxKkt


class ContactSystem(BoxKkt):
    """The KKT system of a model on a stratum where gaps are closed.

    A gap is a product of two unit vectors, one of which the folds between turn: its derivatives in the directions
    i, j, ... are at most beta_i beta_j ..., beta = 1 a fold and 1/2 on a mirror; those of third order enter by this.

    Rounding: three rays and a sine, each as well known as closure; the sine divides.

    Parameters
    ----------
    model
        With contact ``full``.
    gaps
        Positions in `Structure.gaps`.
    """

    def __init__(self, model: Model, gaps: tuple[int, ...]) -> None:
        super().__init__(model)
        self.gaps, self.equations = gaps, self.m
        self.plain = BoxKkt(model)
        self.m += len(gaps)
        self.beta = self.factor
        sines = [math.sin(a) for a in model.parameters.sectors]
        self.noise *= 4 / min(sines)

    def vanishing(self, at: FoldedRays) -> tuple[np.ndarray, np.ndarray]:
        """Return closure and gaps [R, m] and their Jacobian [R, m, n]."""
        g, a = super().vanishing(at)
        h, b = self.kinematics.gaps(at, self._slots(g))
        return np.concatenate([g, h], axis=1), np.concatenate([a, b], axis=1)

    def curvature(self, at: FoldedRays, lam: np.ndarray) -> np.ndarray:
        """Return lam . (closure, gaps)'', [R, n, n]."""
        e = self.equations
        h = super().curvature(at, lam[:, :e])
        return h + self.kinematics.gaps_hessian(at, self._slots(lam), lam[:, e:])

    def _slots(self, of: np.ndarray) -> np.ndarray:
        return np.tile(np.array(self.gaps, dtype=int), (len(of), 1))

    def _fuzz(self, x: np.ndarray, lam: np.ndarray) -> np.ndarray:
        torque = self.most + 4.0 * self.beta * np.abs(lam).sum(axis=1)[:, None]
        return self.noise * np.concatenate([torque, np.ones((len(x), self.m))], axis=1)

    def _derivatives(self, x: np.ndarray, lam: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        e, at = self.equations, self.kinematics.fold(x)
        second, third = self.plain._derivatives(x, lam[:, :e])
        units = np.eye(len(self.gaps))
        more = [
            self.kinematics.gaps_hessian(at, self._slots(x), np.tile(unit, (len(x), 1)))
            for unit in units
        ]
        b = self.beta
        size = np.abs(lam[:, e:]).sum(axis=1)[:, None, None, None]
        bound = size * (b[:, None, None] * b[:, None] * b)
        return np.concatenate([second, np.stack(more, axis=1)], axis=1), np.abs(third) + bound
