"""The modelled piece of a vertex in extended precision, with analytic first and second derivatives.

Rotation matrices, where the problem has quaternions.  With R the product of the folds before it, a flat
vector v is carried to u = R v, and folding about a deformed crease c_i turns all that follows:

    d u / d phi_i = w_i c_i x u,    d2 u / d phi_i d phi_j = w_i w_j c_i x (c_j x u)   (i before or equal to j),

w = 1/2 at a mirror crease of D_n, else 1.  Closure is posed as

- D_1: e1 . R e2 = e3 . R e2 = 0;  D_n: e2 . R n_k = -cos(pi/n), n_k the inward normal of the last mirror;
- C_1: e2 . R e1 = e3 . R e1 = e3 . R e2 = 0;  C_n: trace(R Q(e3, 2 pi/n)) = 1 + 2 cos(2 pi/n).

Arrays hold mpmath numbers (dtype object); precision is that of the caller's `mp.workdps`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.problem import Gap, Model

LARGEST_DENOMINATOR = 720
"""Angles that are a multiple of pi with a denominator up to this, to rounding, stand for that multiple."""
ROUNDING = 1e-15


@dataclass(frozen=True)
class Jet:
    """A number and its derivatives: value, first [n], second [n, n]."""

    value: Any
    first: np.ndarray
    second: np.ndarray


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


class ExactPiece:
    """The problem of a `Model` in extended precision; make and use it inside `mp.workdps`.

    Of states that wind once round the axis of their symmetry.

    stiffness, rest: weighted stiffness / scale, and rest angles, of the n variables.

    Raises
    ------
    OptionError
        If the model is of another winding.
    """

    def __init__(self, model: Model) -> None:
        s, n = model.structure, model.size
        if s.winding > 1:
            raise OptionError(f"winding = {s.winding}: 50 digits are had of states that wind once")
        self.kind, self.order, self.size = s.kind, s.order, n
        self.gap_list, self.count = s.gaps, len(s.has_crease)
        p = model.parameters
        self.sectors = [exact_angle(a) for a in p.sectors.tolist()]
        self.stiffness = np.array([mp.mpf(k) for k in p.stiffness.tolist()])
        self.rest = np.array([exact_angle(a) for a in p.rest.tolist()])
        self.scale = mp.mpf(model.scale)
        self._flat: list[np.ndarray] = []  # flat directions of all rays, images of C_n included
        self._variable: list[int | None] = []
        self._weight: list[Any] = []
        azimuth, used = mp.mpf(0), 0
        for r, crease in enumerate(s.has_crease):
            end = self.kind == "D" and r == self.count - 1
            self._flat.append(_direction(mp.pi / self.order if end else azimuth))
            azimuth += 0 if end else self.sectors[r]
            self._variable.append(used if crease else None)
            on_mirror = self.kind == "D" and r in (0, self.count - 1)
            self._weight.append(mp.mpf(1) / 2 if on_mirror else mp.mpf(1))
            used += crease
        for m in range(1, self.order if self.kind == "C" else 1):
            turn = 2 * mp.pi * m / self.order
            flat = self._flat[: self.count]
            self._flat += [_direction(turn + mp.atan2(b[1], b[0])) for b in flat]
            self._variable += self._variable[: self.count]
            self._weight += self._weight[: self.count]

    def energy(self, x: np.ndarray) -> Any:
        """Elastic energy in the scene's units."""
        return self.scale * sum(self.stiffness * (x - self.rest) ** 2) / 2

    def evaluate(
        self, x: np.ndarray, gaps: tuple[int, ...] = ()
    ) -> tuple[list[Jet], dict[int, Jet]]:
        """Return the jets of closure, and of the gaps at these positions of `Structure.gaps` (without sign)."""
        rotations, creases = self._fold(x)
        self._axes = creases
        piece = rotations[self.count]

        def at(ray: int) -> TargetTolerance:
            ray %= len(self._flat)
            return self._carry(rotations[ray] @ self._flat[ray], ray)

        def end(v: np.ndarray) -> TargetTolerance:
            return self._carry(piece @ v, self.count)

        return self._closure(end), {g: self._gap(self.gap_list[g], at, end) for g in gaps}

    def _closure(self, end: Any) -> list[Jet]:
        e1, e2, e3 = (self._fixed(_unit(k)) for k in range(3))
        if self.kind == "D" and self.order == 1:
            image = end(_unit(1))
            return [dot(e1, image), dot(e3, image)]
        if self.kind == "D":
            return [_shifted(dot(e2, end(self._last_normal())), mp.cos(mp.pi / self.order))]
        if self.order == 1:
            first = end(_unit(0))
            return [dot(e2, first), dot(e3, first), dot(e3, end(_unit(1)))]
        turn = 2 * mp.pi / self.order
        q = _rotation(_unit(2), turn)
        parts = [dot(e, end(q @ e.value)) for e in (e1, e2, e3)]
        a, b, c = parts
        total = Jet(
            a.value + b.value + c.value, a.first + b.first + c.first, a.second + b.second + c.second
        )
        return [_shifted(total, -1 - 2 * mp.cos(turn))]

    def _gap(self, gap: Gap, at: Any, end: Any) -> Jet:
        if gap.type == "facet-pair":
            k, j = gap.rays
            jet = dot(cross_moving(at(j), at(j + 1)), at(k))
            sine = mp.sin(self.sectors[j % len(self.sectors)])
            return Jet(jet.value / sine, jet.first / sine, jet.second / sine)
        r, side = gap.rays
        return dot(at(r), end(self._last_normal()) if side else self._fixed(_unit(1)))

    def _last_normal(self) -> np.ndarray:
        angle = mp.pi / self.order
        return np.array([mp.sin(angle), -mp.cos(angle), mp.mpf(0)])

    def _fold(self, x: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Return the rotation before each ray (and after the last), and the deformed rays."""
        rotation = np.array([[mp.mpf(int(i == j)) for j in range(3)] for i in range(3)])
        rotations, rays = [rotation], []
        for b, v, w in zip(self._flat, self._variable, self._weight, strict=True):
            rays.append(rotation @ b)
            if v is not None:
                rotation = rotation @ _rotation(b, w * x[v])
            rotations.append(rotation)
        return rotations, rays

    def _fixed(self, v: np.ndarray) -> TargetTolerance:
        n, zero = self.size, mp.mpf(0)
        return TargetTolerance(v, np.full((n, 3), zero), np.full((n, n, 3), zero))

    def _carry(self, u: np.ndarray, before: int) -> TargetTolerance:
        """Return u, which every fold about a ray before number `before` turns, with its derivatives."""
        moving = self._fixed(u)
        first, second = moving.first, moving.second
        turning = [
            (v, w * c)
            for v, w, c in zip(
                self._variable[:before], self._weight[:before], self._axes[:before], strict=True
            )
            if v is not None
        ]
        for j, (vj, cj) in enumerate(turning):
            slope = cross(cj, u)
            first[vj] = first[vj] + slope
            for vi, ci in turning[: j + 1]:
                bend = cross(ci, slope)
                second[vi, vj] = second[vi, vj] + bend
                if ci is not cj:
                    second[vj, vi] = second[vj, vi] + bend
        return moving


def _shifted(jet: Jet, by: Any) -> Jet:
    return Jet(jet.value + by, jet.first, jet.second)


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
