"""Exact closed states of the paper's vertices: rational rotations, rational crease matrices.

A fold is kept as (cos phi, sin phi) with rational entries; rotations and the matrix C of deformed
creases are then rational, so ranks and kernels are exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp

from .derive import dihedral_form, reflection_form
from .rotations import E1, Pair, rational_pair


@dataclass(frozen=True)
class ExactState:
    """Creases (cos, sin of azimuth) and folds (cos phi, sin phi), all exact."""

    creases: tuple[Pair, ...]
    folds: tuple[Pair, ...]

    def directions(self) -> list[sp.Matrix]:
        """Deformed creases c_i = F_{i-1} b_i in the frame of facet N (c_1 = b_1)."""
        f, out = sp.eye(3), []
        for b, fold in zip(self.creases, self.folds, strict=True):
            axis = sp.Matrix([b[0], b[1], 0])
            out.append(f * axis)
            f = f * rodrigues(axis, fold)
        return out

    def closure(self) -> sp.Matrix:
        """F_N."""
        f = sp.eye(3)
        for b, fold in zip(self.creases, self.folds, strict=True):
            f = f * rodrigues(sp.Matrix([b[0], b[1], 0]), fold)
        return f

    def crease_matrix(self) -> sp.Matrix:
        """C = [c_1 .. c_N], 3 x N."""
        return sp.Matrix.hstack(*self.directions())

    def tangents(self) -> sp.Matrix:
        """Columns span ker C."""
        return sp.Matrix.hstack(*self.crease_matrix().nullspace())


def rodrigues(axis: sp.Matrix, fold: Pair) -> sp.Matrix:
    """Rotation matrix about a unit axis from (cos phi, sin phi)."""
    c, s = fold
    k = sp.Matrix([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return sp.eye(3) + s * k + (1 - c) * k * k


def double(pair: Pair) -> Pair:
    """(cos 2a, sin 2a) from (cos a, sin a)."""
    c, s = pair
    return (c**2 - s**2, 2 * c * s)


def doubled_direction(yx: Sequence[Any]) -> Pair:
    """(cos phi, sin phi) of phi = 2 atan2(y, x): rational in y and x, no square root."""
    y, x = yx
    r2 = x**2 + y**2
    return ((x**2 - y**2) / r2, 2 * x * y / r2)


@cache
def degree6(t_alpha: Any, t2: Any, t3: Any) -> ExactState:
    """D_1 state of the paper's degree-6 vertex.

    tan(alpha/2), tan(phi_2/4), tan(phi_3/4) rational; raises `ValueError` where the closed angles
    belong to quaternion -1.
    """
    c, s = rational_pair(t_alpha)
    h2, h3 = rational_pair(t2), rational_pair(t3)
    form = reflection_form([(c, s), (-c, s)], [h2, h3])
    if not form.paper > 0:
        raise ValueError("no sheet of paper takes these angles: they close on quaternion -1")
    f1, f4 = doubled_direction(form.first), doubled_direction(form.last)
    f2, f3 = double(h2), double(h3)
    one, zero = sp.Integer(1), sp.Integer(0)
    creases = ((one, zero), (c, s), (-c, s), (-one, zero), (-c, -s), (c, -s))
    return ExactState(creases, (f1, f2, f3, f4, f3, f2))


@cache
def degree8() -> ExactState:
    """One D_2 state of the paper's degree-8 vertex with a rational discriminant root.

    tan(alpha/2) = 1/3, tan(phi_2/4) = 1/2, and an elevation found by a small rational search.
    """
    alpha, half = rational_pair(sp.Rational(1, 3)), rational_pair(sp.Rational(1, 2))
    # D^2 = sin^2 v - g^2 is a square with g = sin(2 alpha) sin^2(phi_2/2): sin v = g (m + 1/m)/2
    g = 2 * alpha[0] * alpha[1] * half[1] ** 2
    for p in range(2, 40):
        for q in range(1, p):
            m = sp.Rational(p, q)
            sin_v = g * (m + 1 / m) / 2
            cos_v = sp.sqrt(1 - sin_v**2)
            if sin_v < 1 and cos_v.is_Rational:
                form = dihedral_form(2, [alpha], [half], (cos_v, sin_v))
                root = g * (m - 1 / m) / 2
                t = form.equation.cos_sin(1, root)
                sin_q, cos_q = form.last(*t)
                f1, f2, f3 = double(t), double(half), double((cos_q, sin_q))
                c, s = alpha
                one, zero = sp.Integer(1), sp.Integer(0)
                creases = (
                    (one, zero),
                    (c, s),
                    (zero, one),
                    (-c, s),
                    (-one, zero),
                    (-c, -s),
                    (zero, -one),
                    (c, -s),
                )
                return ExactState(creases, (f1, f2, f3, f2, f1, f2, f3, f2))
    raise AssertionError("no rational elevation found")


def flat(state: ExactState) -> ExactState:
    """The flat state of the same vertex."""
    return ExactState(state.creases, tuple((sp.Integer(1), sp.Integer(0)) for _ in state.folds))


__all__ = ["E1", "ExactState", "degree6", "degree8", "double", "doubled_direction", "flat"]
