"""Hinge laws of the variables of a problem: energies, torques and stiffness of those that are no linear springs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.pattern import HingeLaw


@dataclass(frozen=True, eq=False)
class HingeLaws:
    """Laws in place of linear springs.

    Attributes
    ----------
    laws
        Of the n variables; None where a linear spring is.
    weight
        How often each counts: creases that a variable stands for, over `Model.scale`; 0 where there is none, [n].
    """

    laws: tuple[HingeLaw | None, ...]
    weight: np.ndarray

    def times(self, share: float) -> HingeLaws:
        """Return the same laws over another scale."""
        return replace(self, weight=share * self.weight)

    def linear(self, stiffness: np.ndarray) -> np.ndarray:
        """Return stiffnesses [..., n] with 0 where a law is in place of the spring."""
        return np.where(self.weight > 0, 0.0, stiffness)

    def _each(self) -> Iterator[tuple[HingeLaw, np.ndarray]]:
        """Go through different laws, with the variables that have them."""
        of: dict[int, tuple[HingeLaw, list[int]]] = {}
        for v, law in enumerate(self.laws):
            if law is not None:
                of.setdefault(id(law), (law, []))[1].append(v)
        for law, variables in of.values():
            yield law, np.array(variables)

    def energy(self, x: np.ndarray) -> np.ndarray:
        """Energy of states [..., n], [...]."""
        return np.sum([law.energy(x[..., v]) @ self.weight[v] for law, v in self._each()], axis=0)

    def change(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Energy of y less that of x, [...]."""
        return np.sum(
            [law.change(x[..., v], y[..., v]) @ self.weight[v] for law, v in self._each()], axis=0
        )

    def torque(self, x: np.ndarray) -> np.ndarray:
        """Torques [..., n]; 0 where there is no law."""
        out = np.zeros(x.shape)
        for law, v in self._each():
            out[..., v] = self.weight[v] * law.torque(x[..., v])
        return out

    def slope(self, x: np.ndarray) -> np.ndarray:
        """Derivatives of the torques [..., n]; 0 where there is no law."""
        out = np.zeros(x.shape)
        for law, v in self._each():
            out[..., v] = self.weight[v] * law.slope(x[..., v])
        return out
