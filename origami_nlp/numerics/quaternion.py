"""Unit quaternions (w, x, y, z) and 3-vectors over any scalars: CasADi, NumPy arrays, mpmath,
SymPy.

A fold by phi about the unit crease b is the quaternion (cos phi/2, sin phi/2 b).  Products of folds
stay polynomial in half-angle sines and cosines: no logarithm, no branch cut (design: loop closure
as q = +1).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Scalars = Sequence[Any]

IDENTITY = (1, 0, 0, 0)


def multiply(p: Scalars, q: Scalars) -> tuple[Any, Any, Any, Any]:
    """Return the Hamilton product p q; as rotations, q acts first."""
    a, b, c, d = p
    e, f, g, h = q
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    )


def fold(cos_half: Any, sin_half: Any, axis: Scalars) -> tuple[Any, Any, Any, Any]:
    """Return the rotation about unit `axis` whose half angle has the given cosine and sine."""
    return (cos_half, sin_half * axis[0], sin_half * axis[1], sin_half * axis[2])


def rotate(q: Scalars, v: Scalars) -> tuple[Any, Any, Any]:
    """Rotate the vector v by the unit quaternion q: vec(q v q*)."""
    w, x, y, z = q
    # twice the cross product, the cheapest exact form
    tx = 2 * (y * v[2] - z * v[1])
    ty = 2 * (z * v[0] - x * v[2])
    tz = 2 * (x * v[1] - y * v[0])
    return (
        v[0] + w * tx + y * tz - z * ty,
        v[1] + w * ty + z * tx - x * tz,
        v[2] + w * tz + x * ty - y * tx,
    )


def dot(u: Scalars, v: Scalars) -> Any:
    """Return u . v."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def cross(u: Scalars, v: Scalars) -> tuple[Any, Any, Any]:
    """Return u x v."""
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
