"""The numbers of a problem, by name: what may change without another compiled function."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.numerics import EPS, STEP_NOISE
from origami_nlp.pattern import DeadLoads
from origami_nlp.problem.hinge_laws import HingeLaws


@dataclass(frozen=True, eq=False)
class Parameters:
    """Values that the compiled functions of a problem take beside the fold angles.

    Attributes
    ----------
    sectors
        Sector angles of the modelled piece [rad], shape [s].
    stiffness
        Of the n variables, summed over the creases that each stands for, over the problem's scale, shape [n].
    rest
        Angles without torque [rad], shape [n]: `Scene.wound_angles`, the rest angles where nothing is preloaded.
    load
        Moment conjugate to each variable over the problem's scale: the energy is U - load . phi, shape [n].
    dead
        Forces in space, over the problem's scale, where there are any; they ask for a model of all N fold angles.  Of a
        pattern what has the same methods: a load on what is not linear in the fold angles (`pattern_problem.Worked`).
    laws
        Of hinges that are no linear springs; their `stiffness` is a measure for metrics, their `rest` a lowest angle.
    """

    sectors: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray
    load: np.ndarray
    dead: DeadLoads | Any = None
    laws: HingeLaws | None = None

    @cached_property
    def vector(self) -> np.ndarray:
        """All of them in the order in which compiled functions take them, shape [s + 3 n + 5 l]; laws add 2 n."""
        dead = [] if self.dead is None else [self.dead.vector]
        laws = [] if self.laws is None else [self.laws.vector]
        return np.concatenate([self.sectors, self.stiffness, self.rest, self.load, *dead, *laws])

    def at(self, x: np.ndarray) -> np.ndarray:
        """What compiled functions of a vertex take at states [..., n]: all, and of laws the pieces there, [..., p]."""
        vector = self.vector
        if x.ndim > 1:
            vector = np.broadcast_to(vector, (*x.shape[:-1], len(vector)))
        if self.laws is None:
            return vector
        return np.concatenate([vector, self.laws.pieces_at(x)], axis=-1)

    @property
    def plain(self) -> bool:
        """Whether all energy is that of linear springs and of torques."""
        return self.dead is None and self.laws is None

    @cached_property
    def linear(self) -> np.ndarray:
        """Stiffness of the linear springs, 0 where a law is, as `stiffness`."""
        return self.stiffness if self.laws is None else self.laws.linear(self.stiffness)

    def scaled(self, share: float) -> Parameters:
        """Return the same springs and loads over another scale: `share` times the numbers."""
        return replace(
            self,
            stiffness=share * self.stiffness,
            load=share * self.load,
            dead=None if self.dead is None else self.dead.times(share),
            laws=None if self.laws is None else self.laws.times(share),
        )

    @property
    def softness(self) -> float:
        """Softest spring over the mean one, but for hinges that yield: how small a torque still matters."""
        springs = self.stiffness[self.stiffness > 0]
        return float(springs.min() / springs.mean()) if len(springs) else 1.0

    @property
    def step_noise(self) -> float:
        """Length of a Newton step [rad] that is only rounding: more with very soft springs."""
        return max(STEP_NOISE, 4 * EPS / self.softness)

    def energy(self, x: np.ndarray) -> np.ndarray:
        """Energy of states [..., n] over the problem's scale, the work of the load included, shape [...]."""
        # paper, eq. 3.1
        energy = 0.5 * np.sum(self.linear * (x - self.rest) ** 2, axis=-1)
        energy = energy - np.einsum("...i,...i", x, self.load)
        if self.laws is not None:
            energy = energy + self.laws.energy(x)
        return energy if self.dead is None else energy + self.dead.energy(self.sectors, x)

    def energy_change(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Energy of y less that of x, without cancellation for nearby states [..., n], shape [...]."""
        step = y - x
        # (y - r)^2 - (x - r)^2 = (y - x) ((x - r) + (y - r)): the small difference is a factor, not a remainder
        torque = self.linear * ((x - self.rest) + 0.5 * step) - self.load
        change = np.sum(step * torque, axis=-1)
        if self.laws is not None:
            change = change + self.laws.change(*np.broadcast_arrays(x, y))
        if self.dead is None:
            return change
        return change + self.dead.energy_change(self.sectors, *np.broadcast_arrays(x, y))

    def excess(self, x: np.ndarray) -> np.ndarray:
        """Energy of states [..., n] above that of springs at rest under the load, over the scale, shape [...].

        inf under forces in space, with laws and with hinges that yield: no state is known to have the least energy.
        """
        if not self.plain or not self.stiffness.all():
            return np.full(x.shape[:-1], np.inf)
        # U - load . phi is least at phi0 + load / k, where the torque is 0
        return 0.5 * np.sum(self.torque(x) ** 2 / self.stiffness, axis=-1)

    def torque(self, x: np.ndarray) -> np.ndarray:
        """Gradient of the energy over the problem's scale at states [..., n], same shape."""
        torque = self.linear * (x - self.rest) - self.load
        if self.laws is not None:
            torque = torque + self.laws.torque(x)
        return torque if self.dead is None else torque + self.dead.gradient(self.sectors, x)

    def curvature(self, x: np.ndarray) -> np.ndarray:
        """Stiffness of the hinges at states [..., n] over the problem's scale, same shape or [n]."""
        return self.linear if self.laws is None else self.linear + self.laws.slope(x)

    def hessian(self, x: np.ndarray) -> np.ndarray:
        """Hessian of the energy over the problem's scale at states [..., n], shape [..., n, n]."""
        springs = np.diag(self.linear)
        if self.laws is not None:
            springs = springs + self.laws.slope(x)[..., None] * np.eye(len(self.rest))
            return springs if self.dead is None else springs + self.dead.hessian(self.sectors, x)
        if self.dead is None:
            return np.broadcast_to(springs, (*x.shape[:-1], *springs.shape))
        return springs + self.dead.hessian(self.sectors, x)


class Energies:
    """Energies of a problem in the units of its springs, from its `parameters`, which are over `scale`."""

    parameters: Any
    scale: float

    def energy(self, x: np.ndarray) -> float:
        """Elastic energy of a state, less the work of the load if there is one.

        Parameters
        ----------
        x
            The state, shape [n] [rad].

        Returns
        -------
        float
            In the scene's units.
        """
        return self.scale * float(self.parameters.energy(np.asarray(x)))

    def energies(self, x: np.ndarray) -> np.ndarray:
        """Elastic energies of states, less the work of the load if there is one.

        Parameters
        ----------
        x
            States, shape [..., n] [rad].

        Returns
        -------
        numpy.ndarray
            Shape [...], in the scene's units.
        """
        return self.scale * self.parameters.energy(np.asarray(x))

    def energy_change(self, x: np.ndarray, y: np.ndarray) -> float:
        """Energy of y less that of x, without cancellation for nearby states.

        Parameters
        ----------
        x, y
            States, shape [n] [rad].

        Returns
        -------
        float
            In the scene's units.
        """
        return self.scale * float(self.parameters.energy_change(x, y))

    def excess(self, x: np.ndarray) -> float:
        """Energy of a state above that of springs at rest under the load, over `scale`; inf under forces in space."""
        return float(self.parameters.excess(x))
