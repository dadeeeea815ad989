"""A sheet under a load: the same programme with one more term of the energy."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from origami_nlp.facets import Matrix, PatternProblem
from origami_nlp.sheet_loading.work import Work


class LoadedSheet(PatternProblem):
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

    def __init__(self, sheet: PatternProblem, work: Work, t: float) -> None:
        vars(self).update(vars(sheet))  # all that does not know of loads, what it has kept included
        self.work, self.t = work, t

    def torque(self, phi: np.ndarray) -> np.ndarray:
        """Gradient of the energy, load included, over `scale`, [n]."""
        return super().torque(phi) - self.t / self.scale * self.work.gradient(phi)

    def scaled_energy(self, phi: np.ndarray) -> float:
        """Energy, load included, over `scale`; with a constant, so that it is positive."""
        work = self.work.room(self.t) - self.t * float(self.work.conjugate(phi))
        return super().scaled_energy(phi) + work / self.scale

    def hessian(self, phi: np.ndarray, multipliers: np.ndarray) -> Matrix:
        """Hessian of the Lagrangian, load included, over `scale`, [n, n]."""
        plain = super().hessian(phi, multipliers)
        bent = self.work.hessian(phi)
        if bent is None:
            return plain
        bent = self.t / self.scale * bent
        return plain - bent if isinstance(plain, np.ndarray) else plain - sparse.csr_array(bent)
