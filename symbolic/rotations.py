"""Exact rotations: unit quaternions and vectors whose entries are SymPy expressions.

A rotation by angle ``a`` about the unit vector ``b`` is the quaternion ``(cos a/2, sin a/2 b)``;
products compose like matrices (the right factor acts first).  A fold of angle phi at a crease is
given by the pair
``(cos phi/2, sin phi/2)``: `half_pair` makes it from trigonometric functions, `rational_pair`
from t = tan(phi/4), and the proofs use free symbols bound by c^2 + s^2 = 1
(`origami_nlp.symbolic.identities`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

import sympy as sp

Vector = tuple[Any, Any, Any]
Pair = tuple[Any, Any]

E1: Vector = (sp.Integer(1), sp.Integer(0), sp.Integer(0))
E2: Vector = (sp.Integer(0), sp.Integer(1), sp.Integer(0))
E3: Vector = (sp.Integer(0), sp.Integer(0), sp.Integer(1))


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """Scalar product of two 3-vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Sequence[Any], b: Sequence[Any]) -> Vector:
    """Vector product of two 3-vectors."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def scale(k: Any, a: Sequence[Any]) -> Vector:
    """K times the vector a."""
    return (k * a[0], k * a[1], k * a[2])


def reflect(normal: Sequence[Any], a: Sequence[Any]) -> Vector:
    """Mirror image of a in the plane through the vertex with unit normal `normal`."""
    d = 2 * dot(normal, a)
    return (a[0] - d * normal[0], a[1] - d * normal[1], a[2] - d * normal[2])


@dataclass(frozen=True)
class Quaternion:
    """w + x i + y j + z k, entries symbolic or numeric; unit by construction, not renormalised."""

    w: Any
    x: Any
    y: Any
    z: Any

    def __mul__(self, o: Quaternion) -> Quaternion:
        """Hamilton product: the rotation `o` first, then `self`."""
        return Quaternion(
            self.w * o.w - self.x * o.x - self.y * o.y - self.z * o.z,
            self.w * o.x + self.x * o.w + self.y * o.z - self.z * o.y,
            self.w * o.y - self.x * o.z + self.y * o.w + self.z * o.x,
            self.w * o.z + self.x * o.y - self.y * o.x + self.z * o.w,
        )

    @property
    def vector(self) -> Vector:
        """The vector part (x, y, z)."""
        return (self.x, self.y, self.z)

    @property
    def inverse(self) -> Quaternion:
        """The conjugate, which is the inverse of a unit quaternion."""
        return Quaternion(self.w, -self.x, -self.y, -self.z)

    def expand(self) -> Quaternion:
        """Expand every entry as a polynomial."""
        return Quaternion(*(sp.expand(c) for c in (self.w, self.x, self.y, self.z)))

    def rotate(self, a: Sequence[Any]) -> Vector:
        """The rotated vector q a q^-1 (homogeneous of degree 2 in the quaternion)."""
        return (self * Quaternion(0, *a) * self.inverse).vector


IDENTITY = Quaternion(sp.Integer(1), sp.Integer(0), sp.Integer(0), sp.Integer(0))


def half_pair(angle: Any) -> Pair:
    """(cos angle/2, sin angle/2) as SymPy functions."""
    return (sp.cos(angle / 2), sp.sin(angle / 2))


def rational_pair(t: Any) -> Pair:
    """Point of the unit circle with t = tan(angle/2); t = oo is the point (-1, 0)."""
    if t in (sp.oo, -sp.oo):
        return (sp.Integer(-1), sp.Integer(0))
    t = sp.sympify(t)
    return ((1 - t**2) / (1 + t**2), 2 * t / (1 + t**2))


def about(axis: Sequence[Any], half: Pair) -> Quaternion:
    """Rotation about the unit vector `axis` whose HALF angle has (cos, sin) = `half`."""
    c, s = half
    return Quaternion(c, s * axis[0], s * axis[1], s * axis[2])


def planar(pair: Pair) -> Vector:
    """Crease direction in the sheet from (cos azimuth, sin azimuth)."""
    return (pair[0], pair[1], sp.Integer(0))


def product(factors: Iterable[Quaternion]) -> Quaternion:
    """Ordered product; the identity for no factor."""
    return reduce(lambda a, b: a * b, factors, IDENTITY)


def matrix(q: Quaternion) -> sp.Matrix:
    """The 3 x 3 rotation matrix of a unit quaternion."""
    return sp.Matrix([q.rotate(e) for e in (E1, E2, E3)]).T
