"""Stable states of a problem with descents between them: what `escape_paths` searches."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from origami_nlp.numerics import LEVEL, NEAR_SINGULAR_TOL, SETTLED, SHALLOW
from origami_nlp.problem import Problem

NEAREST = 3
"""Other stable states that rays lead towards, those at equal distances counted as one."""
FARTHEST = 12.0
"""How far rays go [rad]: fifteen creases turned by pi are as far."""
FLOOR = SHALLOW / 100
"""Share of `energy_scale` below which no bound is stated: how much less a way climbs is not looked at."""


def energy_scale(stiffness: np.ndarray) -> float:
    """Return the energy that it takes to fold every crease by pi from rest: what barriers are measured by.

    Parameters
    ----------
    stiffness
        Of all creases, [N].

    Returns
    -------
    float
        sum k pi^2 / 2, in the units of the stiffness.
    """
    return float(np.sum(stiffness)) * math.pi**2 / 2


class Terrain(ABC):
    """Stable states with descents between them.

    Parameters
    ----------
    problem
        Whose states they are.
    minima
        The states, by number, [M, n].
    scale
        Of energies, see `energy_scale`.

    Attributes
    ----------
    problem, minima
        As given.
    floor
        Energies over a state that are not distinguished from nothing.
    worth
        Heights above this are made lower where a pass shows how.
    together
        Descents from states along the rays of one state that are made at once, from low ones before high ones.
    """

    together = 64

    def __init__(self, problem: Problem, minima: np.ndarray, scale: float) -> None:
        self.problem, self.minima = problem, minima
        self.floor, self.worth = FLOOR * scale, SHALLOW * scale
        self.noise = LEVEL * np.maximum(np.abs(problem.energies(minima)), problem.scale)

    @abstractmethod
    def rays(self, which: Sequence[int]) -> Sequence[tuple[int, np.ndarray]]:
        """Closed admissible states [S, n] along escape paths, with the number of the state that each begins at."""

    @abstractmethod
    def between(self, a: np.ndarray, b: np.ndarray, shares: np.ndarray) -> np.ndarray | None:
        """Closed admissible states [S, n] at shares of the way from a to b; None where there are none."""

    @abstractmethod
    def land(self, states: np.ndarray) -> np.ndarray:
        """Where descents from states [S, n] end, fast: what is not known to end is nan."""

    @abstractmethod
    def path_down(self, state: np.ndarray, until: Callable[[np.ndarray], bool]) -> np.ndarray:
        """A descent that cannot jump: its states [S, n] from `state` to where it ends, or `until` says so."""

    def quick_path_down(self, state: np.ndarray, until: Callable[[np.ndarray], bool]) -> np.ndarray:
        """The same by fewer, longer steps, tried first: no state but `state` where there is none such."""
        return state[None]

    @abstractmethod
    def passes(self, a: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
        """Stationary states near two states that go down to different sides."""

    def proved_paths(self, which: Sequence[int]) -> dict[int, tuple[float, np.ndarray, int]]:
        """Paths [S, n] from states of some numbers to listed ones, none of which can be left for climbing less.

        With what that takes at least, and the number of the other: by number.  None where nothing is known of that.
        """
        return {}

    def middles(self, a: np.ndarray, b: np.ndarray) -> np.ndarray | None:
        """States half way from each of a to each of b, [S, n], as `between`; None where one is lacking."""
        found = [self.between(y, z, np.array([0.5])) for y, z in zip(a, b, strict=True)]
        have = [y[0] for y in found if y is not None]
        return np.array(have) if len(have) == len(found) else None

    def over(self, at: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Energies of states [..., n] over those of others, without cancellation."""
        p = self.problem
        return np.asarray(p.scale * p.parameters.energy_change(at, states))

    def rise(self, k: int, states: np.ndarray) -> np.ndarray:
        """Energies of states [..., n] over that of state k."""
        return self.over(self.minima[k], states)

    def torque(self, x: np.ndarray) -> np.ndarray:
        """The energy's gradient at states [..., n], in the metric of all fold angles, same shape."""
        p = self.problem
        return np.asarray(p.scale * p.parameters.torque(x) / p.root)

    def slope(self, x: np.ndarray) -> np.ndarray:
        """Norm of that, [...]."""
        p = self.problem  # squares of torques in N m may overflow
        return np.asarray(p.scale * np.linalg.norm(p.parameters.torque(x) / p.root, axis=-1))

    def distance(self, a: np.ndarray, b: np.ndarray) -> float:
        """Distance of two states, in the same metric."""
        return float(np.linalg.norm(self.problem.root * (a - b)))

    def distances(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Distances of states [S, n] from others, [S]."""
        return np.asarray(np.linalg.norm(self.problem.root * (a - b), axis=1))

    def are_lower(self, k: int, x: np.ndarray) -> np.ndarray:
        """Which states [S, n] have less energy than state k, by more than rounding."""
        return self.rise(k, x) < -self.noise[k]

    def is_lower(self, k: int, x: np.ndarray) -> bool:
        """Whether a state [n] has less energy than state k, by more than rounding."""
        return bool(self.are_lower(k, x))

    def are_ways(self, k: int, ends: np.ndarray) -> np.ndarray:
        """Which ends [S, n] are another state, of no more energy; of any for a state than which none listed has less.

        nan is none.
        """
        at = self.minima[k]
        apart = np.abs(ends - at).max(axis=-1) > NEAR_SINGULAR_TOL
        others = np.arange(len(self.minima)) != k
        if not (self.rise(k, self.minima[others]) <= self.noise[k]).any():
            return np.asarray(apart)
        # known to `NEAR_SINGULAR_TOL` only: that is no more energy as well as can be determined
        slopes = self.slope(ends) + self.slope(at)
        return np.asarray(apart & (self.rise(k, ends) <= slopes * NEAR_SINGULAR_TOL))

    def is_way(self, k: int, end: np.ndarray) -> bool:
        """Whether an end [n] is one, as `are_ways`."""
        return bool(self.are_ways(k, end))

    def others(self, k: int) -> np.ndarray:
        """The other states that are nearest to one, [S, n]."""
        apart = np.linalg.norm(self.problem.root * (self.minima - self.minima[k]), axis=1)
        apart[k] = math.inf
        # all at the distance of the last one: labels do not choose among them
        last = np.sort(apart)[min(NEAREST, len(apart)) - 1]
        near = (apart <= last * (1 + SETTLED)) & np.isfinite(apart)
        return np.asarray(self.minima[near])


def over_flat(paths: Iterable[tuple[int, np.ndarray]]) -> list[tuple[int, np.ndarray]]:
    """Join ways from states to the flat state, the shortest of each, to ways from each to every other one.

    Parameters
    ----------
    paths
        States [S, n] with the number of the first.

    Returns
    -------
    list of tuple
        The same of the ways over the flat state.
    """
    to_flat: dict[int, np.ndarray] = {}
    for k, path in paths:
        if not np.abs(path[-1]).max() and (k not in to_flat or len(path) < len(to_flat[k])):
            to_flat[k] = path
    # down to the flat state, and up a path on which another state came to it
    return [
        (k, np.concatenate([path, back[-2::-1]]))
        for k, path in to_flat.items()
        for j, back in to_flat.items()
        if j != k
    ]
