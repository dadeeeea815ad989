"""The numbers of a programme, by name: what may change without another compiled function."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class Parameters:
    """Values that the compiled functions of a programme take beside the fold angles.

    Attributes
    ----------
    sectors
        Sector angles of the modelled piece [rad], shape [s].
    stiffness
        Of the n variables, summed over the creases that each stands for, over `Model.scale`, shape [n].
    rest
        Angles without torque [rad], shape [n]: `Scene.wound_angles`, the rest angles where nothing is preloaded.
    load
        Moment conjugate to each variable over `Model.scale`: the energy is U - load . phi, shape [n].
    """

    sectors: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray
    load: np.ndarray

    @cached_property
    def vector(self) -> np.ndarray:
        """All of them in the order in which compiled functions take them, shape [s + 3 n]."""
        return np.concatenate([self.sectors, self.stiffness, self.rest, self.load])

    @property
    def softness(self) -> float:
        """Softest spring over the mean one: how small a torque still matters."""
        return float(self.stiffness.min() / self.stiffness.mean())

    def energy(self, x: np.ndarray) -> np.ndarray:
        """Energy of states [..., n] over `Model.scale`, the work of the load included, shape [...]."""
        return 0.5 * np.sum(self.stiffness * (x - self.rest) ** 2, axis=-1) - x @ self.load

    def energy_change(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Energy of y less that of x, without cancellation for nearby states [..., n], shape [...]."""
        step = y - x
        torque = self.stiffness * ((x - self.rest) + 0.5 * step) - self.load
        return np.sum(step * torque, axis=-1)

    def excess(self, x: np.ndarray) -> np.ndarray:
        """Energy of states [..., n] above that of springs at rest under the load, over `Model.scale`, shape [...]."""
        return 0.5 * np.sum(self.torque(x) ** 2 / self.stiffness, axis=-1)

    def torque(self, x: np.ndarray) -> np.ndarray:
        """Gradient of the energy over `Model.scale` at states [..., n], same shape."""
        return self.stiffness * (x - self.rest) - self.load
