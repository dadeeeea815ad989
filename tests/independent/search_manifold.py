"""Closure of one piece of a vertex with mirror symmetry, by rotation matrices, in batches.

Half a vertex (D1, degree 6) or a quarter (D2, degree 8) is a chain of facets between mirror creases:

    K = Rx(phi_1/2) Rz(alpha_1) Rx(phi_2) Rz(alpha_2) ... Rx(phi_n/2).

e2 is normal to the mirror at both ends of the chain in the local frame, and the whole vertex closes
when the two mirrors meet at the angle that they have in the flat sheet: K e2 = -e2 for half a vertex
(two equations: its components along e1 and e3 vanish), K e2 perpendicular to e2 for a quarter (one).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from origami_nlp import Scene
from tests.independent.admissible import admissible

E2 = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True)
class Piece:
    """A vertex of degree 6 with D1, or of degree 8 with D2, as arrays.

    sectors: all sector angles.  orbit: the variable of each crease.  stiffness: k of each variable
    times the creases that share it.  rest: rest angle of each variable.
    """

    sectors: np.ndarray
    orbit: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray

    @classmethod
    def of(cls, scene: Scene) -> Piece:
        n = len(scene.stiffness)
        orbit = {6: [0, 1, 2, 3, 2, 1], 8: [0, 1, 2, 1, 0, 1, 2, 1]}[n]
        first = [orbit.index(v) for v in range(max(orbit) + 1)]
        shared = np.bincount(orbit)
        return cls(
            np.array(scene.vertex.sector_angles),
            np.array(orbit),
            np.array(scene.stiffness)[first] * shared,
            np.array(scene.rest_angles)[first],
        )

    @property
    def size(self) -> int:
        return len(self.rest)

    @property
    def half(self) -> bool:
        """Whether the piece is half a vertex (two equations) or a quarter (one)."""
        return self.size == 4

    @cached_property
    def chain(self) -> np.ndarray:
        """Sector angles of the piece."""
        return self.sectors[: self.size - 1]

    @cached_property
    def root(self) -> np.ndarray:
        """Scale z = root * x in which the energy is half a squared distance."""
        return np.sqrt(self.stiffness)

    def energy(self, x: np.ndarray) -> np.ndarray:
        return 0.5 * (np.asarray(x) - self.rest) ** 2 @ self.stiffness

    def expand(self, x: np.ndarray) -> np.ndarray:
        """Fold angles of all creases."""
        return np.asarray(x)[..., self.orbit]

    def admissible(self, x: np.ndarray) -> np.ndarray:
        return admissible(self.sectors, self.expand(np.atleast_2d(x)))

    def closure(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the equations [B, e] and their Jacobian [B, e, n] at x [B, n]."""
        creases, image = self.fold(x)
        weight = np.ones(self.size)
        weight[[0, -1]] = 0.5
        slope = np.cross(creases, image[:, None]) * weight[:, None]
        rows = [0, 2] if self.half else [1]
        return image[:, rows], slope[:, :, rows].transpose(0, 2, 1)

    def fold(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the creases of the piece [B, n, 3], mirror of the first at y = 0, and K e2 [B, 3]."""
        x = np.atleast_2d(x)
        angle = x.copy()
        angle[:, [0, -1]] /= 2
        a, b, c = (np.tile(e, (len(x), 1)) for e in np.eye(3))
        creases = np.empty((*x.shape, 3))
        for i in range(self.size):
            creases[:, i] = a
            co, si = np.cos(angle[:, i, None]), np.sin(angle[:, i, None])
            b, c = co * b + si * c, co * c - si * b
            if i < self.size - 1:
                co, si = math.cos(self.chain[i]), math.sin(self.chain[i])
                a, b = co * a + si * b, co * b - si * a
        return creases, b

    def retract(self, x: np.ndarray, steps: int = 8) -> tuple[np.ndarray, np.ndarray]:
        """Newton onto closure, least change of z = root * x; returns states and residuals."""
        x = np.array(np.atleast_2d(x), dtype=float)
        for _ in range(steps):
            g, jac = self.closure(x)
            if np.abs(g).max(initial=0.0) < 1e-15:
                break
            x -= solve_least(jac / self.root, g) / self.root
        return x, np.abs(self.closure(x)[0]).max(axis=1)


def solve_least(jac: np.ndarray, g: np.ndarray) -> np.ndarray:
    """Return the smallest solutions of jac d = g for one or two equations, [B, n]."""
    gram = np.einsum("bin,bjn->bij", jac, jac)
    if gram.shape[1] == 1:
        weight = g / np.maximum(gram[:, 0], 1e-14)
    else:
        det = gram[:, 0, 0] * gram[:, 1, 1] - gram[:, 0, 1] ** 2
        det = np.maximum(det, 1e-14)
        weight = np.stack(
            [
                gram[:, 1, 1] * g[:, 0] - gram[:, 0, 1] * g[:, 1],
                gram[:, 0, 0] * g[:, 1] - gram[:, 0, 1] * g[:, 0],
            ],
            axis=1,
        )
        weight /= det[:, None]
    return np.einsum("bin,bi->bn", jac, weight)
