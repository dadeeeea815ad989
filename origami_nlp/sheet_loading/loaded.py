"""A sheet under a load: the same programme with one more term of the energy."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from origami_nlp.facets import Matrix, Sheet
from origami_nlp.sheet_loading.work import Work


class LoadedSheet(Sheet):
    """The programme of a pattern under a load.

    Parameters
    ----------
    sheet
        Without the load; its closure and its crossing test are shared.
    work
        What the load works on.
    t
        The load.
    """

    def __init__(self, sheet: Sheet, work: Work, t: float) -> None:
        vars(self).update(vars(sheet))  # all that does not know of loads, what it has kept included
        self.work, self.t = work, t
        self._seen = {}

    def torque(self, phi: np.ndarray) -> np.ndarray:
        """Gradient of the energy, load included, over `scale`, [n]."""
        return super().torque(phi) - self.t / self.scale * self.work.gradient(phi)

    def scaled_energy(self, phi: np.ndarray) -> float:
        """Energy, load included, over `scale`; with a constant, so that it is positive."""
        work = self.work.room(self.t) - self.t * float(self.work.conjugate(phi))
        return super().scaled_energy(phi) + work / self.scale

    def energy_change(self, x: np.ndarray, y: np.ndarray) -> float:
        """Energy of y less that of x, load included; what springs store without cancellation."""
        springs = float((y - x) @ (self.pattern.stiffness * (0.5 * (x + y) - self.pattern.rest)))
        return springs - self.t * float(self.work.conjugate(y) - self.work.conjugate(x))

    def excess(self, x: np.ndarray) -> float:
        """inf: under a load no state is known to have the least energy."""
        return np.inf

    def hessian(self, phi: np.ndarray, multipliers: np.ndarray) -> Matrix:
        """Hessian of the Lagrangian, load included, over `scale`, [n, n]."""
        plain = super().hessian(phi, multipliers)
        bent = self.work.hessian(phi)
        if bent is None:
            return plain
        bent = self.t / self.scale * bent
        return plain - bent if isinstance(plain, np.ndarray) else plain - sparse.csr_array(bent)
