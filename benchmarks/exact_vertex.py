"""A vertex in extended precision, with analytic first and second derivatives.

Rotation matrices, where the problem has quaternions.  With R the product of the folds before it, a flat vector v is
carried to u = R v, and folding about a deformed crease c_i turns all that follows:

    d u / d phi_i = c_i x u,    d2 u / d phi_i d phi_j = c_i x (c_j x u)   (i before or equal to j).

Closure is e2 . R e1 = e3 . R e1 = e3 . R e2 = 0, R the product of all folds; under a symmetry these depend on each
other.

Arrays hold mpmath numbers (dtype object); precision is that of the caller's `mp.workdps`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np

from origami_nlp.pattern_problem import PatternProblem

LARGEST_DENOMINATOR = 720
"""Angles that are a multiple of pi with a denominator up to this, to rounding, stand for that multiple."""
ROUNDING = 1e-15


@dataclass(frozen=True)
class Jet:
    """A number and its derivatives: value, first [n], second [n, n]."""

    value: Any
    first: np.ndarray
    second: np.ndarray

    def times(self, factor: Any) -> Jet:
        """Return the jet of so many times the number."""
        return Jet(factor * self.value, factor * self.first, factor * self.second)


@dataclass(frozen=True)
class TargetTolerance:
    """A vector carried along by folds: value [3], first [n, 3], second [n, n, 3]."""

    value: np.ndarray
    first: np.ndarray
    second: np.ndarray


def exact_angle(angle: float) -> Any:
    """Return the multiple of pi that a double stands for, or the double itself."""
    share = Fraction(angle / math.pi).limit_denominator(LARGEST_DENOMINATOR)
    multiple = mp.pi * share.numerator / share.denominator
    return multiple if abs(multiple - mp.mpf(angle)) <= ROUNDING else mp.mpf(angle)


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a x b along the last axis, for any scalars."""
    x, y, z = (a[..., k] for k in range(3))
    u, v, w = (b[..., k] for k in range(3))
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)


def dot(p: TargetTolerance, q: TargetTolerance) -> Jet:
    """Return the jet of p . q."""
    mixed = p.first @ q.first.T
    return Jet(
        p.value @ q.value,
        p.first @ q.value + q.first @ p.value,
        p.second @ q.value + q.second @ p.value + mixed + mixed.T,
    )


def cross_moving(p: TargetTolerance, q: TargetTolerance) -> TargetTolerance:
    """Return p x q with its derivatives."""
    mixed = cross(p.first[:, None, :], q.first[None, :, :])
    second = cross(p.second, q.value) + cross(p.value, q.second) + mixed + mixed.transpose(1, 0, 2)
    return TargetTolerance(
        cross(p.value, q.value), cross(p.first, q.value) + cross(p.value, q.first), second
    )


class ExactVertex:
    """The problem of a scene in extended precision; make and use it inside `mp.workdps`.

    stiffness, rest: stiffness / scale, and rest angles, of the n variables.
    """

    def __init__(self, problem: PatternProblem) -> None:
        p, self.size = problem.parameters, problem.size
        many = len(p.sectors)
        self.variable = (
            np.arange(many) if problem.orbits is None else problem.orbits.orbit
        ).tolist()
        self.sectors = [exact_angle(a) for a in p.sectors.tolist()]
        self.stiffness = np.array([mp.mpf(k) for k in p.stiffness.tolist()])
        self.rest = np.array([exact_angle(a) for a in p.rest.tolist()])
        self.scale = mp.mpf(problem.scale)
        self._flat = [_direction(mp.fsum(self.sectors[:i])) for i in range(many)]

    def energy(self, x: np.ndarray) -> Any:
        """Elastic energy in the scene's units."""
        return self.scale * sum(self.stiffness * (x - self.rest) ** 2) / 2

    def evaluate(
        self, x: np.ndarray, gaps: tuple[tuple[int, int], ...] = ()
    ) -> tuple[list[Jet], list[Jet]]:
        """Return the jets of closure, and of rays k off facets from ray j, by the sine of the sector."""
        rotations, self._axes = self._fold(x)
        many = len(self._flat)

        def at(ray: int) -> TargetTolerance:
            ray %= many
            return self._carry(rotations[ray] @ self._flat[ray], ray)

        def end(v: np.ndarray) -> TargetTolerance:
            return self._carry(rotations[many] @ v, many)

        e2, e3 = (self._fixed(_unit(k)) for k in (1, 2))
        first = end(_unit(0))
        closure = [dot(e2, first), dot(e3, first), dot(e3, end(_unit(1)))]
        triples = [dot(cross_moving(at(j), at(j + 1)), at(k)) for k, j in gaps]
        sines = [mp.sin(self.sectors[j]) for _, j in gaps]
        return closure, [t.times(1 / s) for t, s in zip(triples, sines, strict=True)]

    def _fold(self, x: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Return the rotation before each ray (and after the last), and the deformed rays."""
        rotation = np.array([[mp.mpf(int(i == j)) for j in range(3)] for i in range(3)])
        rotations, rays = [rotation], []
        for b, v in zip(self._flat, self.variable, strict=True):
            rays.append(rotation @ b)
            rotation = rotation @ _rotation(b, x[v])
            rotations.append(rotation)
        return rotations, rays

    def _fixed(self, v: np.ndarray) -> TargetTolerance:
        n, zero = self.size, mp.mpf(0)
        return TargetTolerance(v, np.full((n, 3), zero), np.full((n, n, 3), zero))

    def _carry(self, u: np.ndarray, before: int) -> TargetTolerance:
        """Return u, which every fold about a ray before number `before` turns, with its derivatives."""
        moving = self._fixed(u)
        first, second = moving.first, moving.second
        turning = list(zip(self.variable[:before], self._axes[:before], strict=True))
        for j, (vj, cj) in enumerate(turning):
            slope = cross(cj, u)
            first[vj] = first[vj] + slope
            for vi, ci in turning[: j + 1]:
                bend = cross(ci, slope)
                second[vi, vj] = second[vi, vj] + bend
                if ci is not cj:
                    second[vj, vi] = second[vj, vi] + bend
        return moving


def _unit(k: int) -> np.ndarray:
    return np.array([mp.mpf(int(i == k)) for i in range(3)])


def _direction(azimuth: Any) -> np.ndarray:
    return np.array([mp.cos(azimuth), mp.sin(azimuth), mp.mpf(0)])


def _rotation(axis: np.ndarray, angle: Any) -> np.ndarray:
    """Rotate about a unit axis (Rodrigues)."""
    x, y, z = axis
    k = np.array([[0 * x, -z, y], [z, 0 * x, -x], [-y, x, 0 * x]])
    one = np.array([[mp.mpf(int(i == j)) for j in range(3)] for i in range(3)])
    return one + mp.sin(angle) * k + (1 - mp.cos(angle)) * (k @ k)
