"""A scene as numbers, and what follows from them without any model: energies, torques, closure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import mpmath as mp
import numpy as np

from tests.independent.closing import LONG
from tests.independent.layering import Map
from tests.independent.relations import DIGITS, exact_sectors


@dataclass(frozen=True)
class PatternProblem:
    """A scene as numbers.

    sectors [N]; orbit: for each crease its variable, from 0; stiffness, rest [N]; contact: "full",
    "fold-limits" or "none"; maps: the symmetries that layers must have.
    """

    sectors: np.ndarray
    orbit: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray
    contact: str
    maps: tuple[Map, ...] = ()

    @classmethod
    def of(cls, scene) -> PatternProblem:
        """Read the numbers of a scene of the package."""
        n = len(scene.stiffness)
        maps = []
        for shift, mirrored in scene.group.elements:
            to = tuple((shift - i if mirrored else i + shift) % n for i in range(n))
            if mirrored or shift:
                maps.append((to, bool(mirrored)))
        return cls(
            np.array(scene.vertex.sector_angles),
            np.unique(scene.group.orbit, return_inverse=True)[1],
            np.array(scene.stiffness),
            np.array(scene.rest_angles),
            scene.contact,
            tuple(maps),
        )

    @property
    def size(self) -> int:
        return int(self.orbit.max()) + 1

    @cached_property
    def first(self) -> np.ndarray:
        """The first crease of each orbit."""
        return np.array([int(np.flatnonzero(self.orbit == v)[0]) for v in range(self.size)])

    @cached_property
    def exact(self) -> list[mp.mpf]:
        return exact_sectors(self.sectors)

    @cached_property
    def long(self) -> np.ndarray:
        with mp.workdps(DIGITS):
            return np.array([to_long(a) for a in self.exact])

    def change(self, x: np.ndarray, start: np.ndarray) -> np.ndarray:
        """U(x) - U(start) without cancellation."""
        d = (x - start)[..., self.orbit]
        return (d * (d / 2 + start[self.orbit] - self.rest)) @ self.stiffness.astype(LONG)

    def torques(self, x: np.ndarray) -> np.ndarray:
        """dU/dx of the variables."""
        k = self.stiffness * (x[self.orbit].astype(float) - self.rest)
        return np.bincount(self.orbit, weights=k, minlength=self.size)

    def scale(self, x: np.ndarray) -> float:
        """Sum of the sizes of all torques [N m]."""
        return float(np.abs(self.stiffness * (x[self.orbit].astype(float) - self.rest)).sum())


def to_long(value: mp.mpf) -> np.longdouble:
    return LONG(mp.nstr(value, 30))


def product_of_folds(sectors: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Return prod_i Rx(phi_i) Rz(alpha_i), factor by factor."""
    m = np.eye(3)
    for a, f in zip(sectors, phi, strict=True):
        c, s = math.cos(f), math.sin(f)
        m = m @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        c, s = math.cos(a), math.sin(a)
        m = m @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return m
