"""Vectors of three as plain numbers: of single ones arrays take ten times as long."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

Vector: TypeAlias = tuple[float, float, float]


def vector(x: Sequence[float] | np.ndarray) -> Vector:
    """Return an array of three as plain numbers."""
    a, b, c = map(float, x)
    return a, b, c


def dot(u: Sequence[float], v: Sequence[float]) -> float:
    """Return u . v."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def times(u: Sequence[float], v: Sequence[float]) -> Vector:
    """Return u x v."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def minus(u: Sequence[float], v: Sequence[float]) -> Vector:
    """Return u - v."""
    return u[0] - v[0], u[1] - v[1], u[2] - v[2]


def scaled(u: Sequence[float], by: float) -> Vector:
    """Return a multiple of u."""
    return by * u[0], by * u[1], by * u[2]
