"""D_2 states of the degree-8 vertex with creases 3 and 7 on each other, tip to tip on the axis.

Frame: e3 is the two-fold axis, the mirrors are y = 0 (creases 1 and 5) and x = 0 (creases 3 and 7).
With c_1 = (C, 0, S), c_2 = (x, y, z) and c_3 = e3 the others are mirror images.  For C, x, y > 0
nothing else touches: each wedge c_1, c_2, c_3 lies in its own quadrant, and |phi_i| = pi would need
x = 0 or y = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import combinations
from typing import Any

import sympy as sp

from .rotations import E2, E3, Pair, about, cross, dot, planar, product, rational_pair
from .states import ExactState

TIPS = (2, 6)
"""Positions of creases 3 and 7."""


def tip_directions(c_1: Sequence[Any], c_2: Sequence[Any]) -> list[sp.Matrix]:
    """The eight deformed creases from c_1 = (C, 0, S) and c_2 = (x, y, z), c_3 = c_7 = e3."""
    big_c, _, s = c_1
    x, y, z = c_2
    rows = [
        (big_c, 0, s), (x, y, z), E3, (-x, y, z), (-big_c, 0, s), (-x, -y, z), E3, (x, -y, z),
    ]  # fmt: skip
    return [sp.Matrix(r) for r in rows]


def slide(c_1: Sequence[Any]) -> tuple[sp.Matrix, sp.Matrix]:
    """Two tangents of the state: the symmetric one that presses the tips together, and a sideways one.

    C d = 0 for both; the first has the symmetry D_2, the average of the second over D_2 is zero.
    """
    s = c_1[2]
    contact_descent = sp.Matrix([1, 0, -s, 0, 1, 0, -s, 0])
    aside = sp.Matrix([0, 1, 0, -1, 0, 1, 0, -1])
    return contact_descent, aside


def descent(c_1: Sequence[Any], c_2: Sequence[Any]) -> sp.Matrix:
    """Press the tips together while sliding them past each other, fast enough to open the contact."""
    contact_descent, aside = slide(c_1)
    return contact_descent + 2 * c_2[0] * c_1[0] / c_2[1] ** 2 * aside


def separating_normal(c_2: Sequence[Any]) -> sp.Matrix:
    """Normal n of a plane through the vertex with c_2, c_4 on one side and c_6, c_8 on the other."""
    return sp.Matrix([c_2[1], 2 * c_2[0], 0])


def tip_velocity(directions: Sequence[sp.Matrix], rates: sp.Matrix) -> sp.Matrix:
    """Velocity of c_3 minus that of c_7 for fold rates with C d = 0.

    From dF_{i-1}/dphi_j b_i = c_j x c_i for j < i; because c_3 = c_7 it does not depend on the frame.
    """
    first, last = TIPS
    total = sp.zeros(3, 1)
    for j in range(first, last):
        total -= rates[j] * directions[j].cross(directions[last])
    return total


def gap_gradient(directions: Sequence[sp.Matrix]) -> tuple[sp.Matrix, Any]:
    """Gradient of a smooth g(phi) that equals c_3 . e2 in every D_2 state, and a bound on its Hessian.

    In the frame that halves the fold at crease 5, c_3 = Q(b_5, -phi_5/2) Q(b_4, -phi_4) b_3; with the
    paths 5-6 to crease 7 and 1-2, 1-8 this makes four functions of two fold angles each that equal
    +-c_3 . e2 in D_2 states.  g is the mean of their signed values.  A second derivative in angles
    with factors a, b is at most |a b|; the bound is the largest row sum (Gershgorin).
    """
    gradient, bound = sp.zeros(8, 1), sp.zeros(8)
    half, quarter = sp.Rational(1, 2), sp.Rational(1, 4)
    # (tip, crease between, crease halved, +1 where the path runs towards higher numbers)
    for tip, side, middle, forward in ((2, 3, 4, -1), (6, 5, 4, 1), (2, 1, 0, 1), (6, 7, 0, -1)):
        sign = 1 if tip == TIPS[0] else -1  # c_7 . e2 = -c_3 . e2
        factors = ((side, sp.Integer(1)), (middle, half))
        for i, factor in factors:
            turn = forward * factor * directions[i].cross(directions[tip])
            gradient[i] += quarter * sign * dot(turn, E2)
            for j, other in factors:
                bound[i, j] += quarter * factor * other
    return gradient, max(sum(bound.row(i)) for i in range(8))


def folds_of(directions: Sequence[sp.Matrix]) -> list[Pair]:
    """(cos phi_i, sin phi_i) from the deformed creases; rational when the facets' sines are."""
    n = len(directions)
    normals = []
    for i in range(n):
        normal = directions[i].cross(directions[(i + 1) % n])
        normals.append(normal / sp.sqrt(normal.dot(normal)))
    return [
        (normals[i - 1].dot(normals[i]), dot(directions[i], cross(normals[i - 1], normals[i])))
        for i in range(n)
    ]


def disjoint(a: Sequence[sp.Matrix], b: Sequence[sp.Matrix]) -> bool:
    """Whether two facets, cones over a pair of creases each, meet at the vertex only.

    A common ray is a kernel vector of [a_1 a_2 -b_1 -b_2] without a change of sign; the four creases
    must span space, so that there is one kernel vector (`ValueError` otherwise).
    """
    kernel = sp.Matrix.hstack(a[0], a[1], -b[0], -b[1]).nullspace()
    if len(kernel) != 1:
        raise ValueError("the two facets lie in one plane")
    return any(v > 0 for v in kernel[0]) and any(v < 0 for v in kernel[0])


def touching_facets(directions: Sequence[sp.Matrix]) -> set[tuple[int, int]]:
    """Pairs of facets without a common crease that meet away from the vertex (0-based)."""
    n = len(directions)
    facets = [(directions[i], directions[(i + 1) % n]) for i in range(n)]
    found = set()
    for i, j in combinations(range(n), 2):
        if (j - i) % n in (1, n - 1):
            continue
        common = any(p == q for p in facets[i] for q in facets[j])
        if common or not disjoint(facets[i], facets[j]):
            found.add((i, j))
    return found


@cache
def tip_example() -> tuple[ExactState, tuple[Any, Any, Any], tuple[Any, Any, Any]]:
    """An exact state, with its c_1 and c_2: tan(alpha/2) = 1/3, c_1 = (35, 0, 12)/37.

    c_2 = (16, 12, 15)/25.  Raises `AssertionError` unless the loop closes on the sheet of paper
    (quaternion +1) in exactly these directions.
    """
    ca, sa = rational_pair(sp.Rational(1, 3))
    c_1 = tuple(sp.Rational(p, 37) for p in (35, 0, 12))
    c_2 = tuple(sp.Rational(p, 25) for p in (16, 12, 15))
    directions = tip_directions(c_1, c_2)
    one, zero = sp.Integer(1), sp.Integer(0)
    quarter = [(one, zero), (ca, sa), (zero, one), (-ca, sa)]
    state = ExactState((*quarter, *((-c, -s) for c, s in quarter)), tuple(folds_of(directions)))
    placed, wanted = state.crease_matrix(), sp.Matrix.hstack(*directions)
    closed = state.closure() == sp.eye(3)
    if not (closed and placed.T * placed == wanted.T * wanted and _scalar(state) > 0):
        raise AssertionError("the example does not close")
    return state, (c_1[0], c_1[1], c_1[2]), (c_2[0], c_2[1], c_2[2])


def fold_angles(state: ExactState, digits: int = 30) -> list[Any]:
    """Fold angles in (-pi, pi] to the given number of digits [rad]."""
    return [sp.atan2(s, c).evalf(digits) for c, s in state.folds]


def _scalar(state: ExactState) -> Any:
    """Scalar part of the closed loop's quaternion: +1 or -1 exactly, so a few digits tell which."""
    angles = fold_angles(state)
    halves = [(sp.cos(a / 2), sp.sin(a / 2)) for a in angles]
    return product(about(planar(b), h) for b, h in zip(state.creases, halves, strict=True)).w.evalf(
        20
    )


__all__ = [
    "TIPS",
    "descent",
    "disjoint",
    "fold_angles",
    "folds_of",
    "gap_gradient",
    "separating_normal",
    "slide",
    "tip_directions",
    "tip_example",
    "tip_velocity",
    "touching_facets",
]
