"""How fast the uniform degree-N cone approaches the continuum cone as N grows.

Every quantity is computed from the closed forms at a ladder of degrees; its distance from the limit
gives an observed order p and coefficient c (error ~ c (2 pi/N)^p), beside the values that a series in
alpha = 2 pi/N predicts (paper section 4 "Infinite creases", appendix B; claims ``s4.limit``,
``b.half-angle-limit`` and ``b.correspondence`` hold the limits, `tests/studies/test_cone_limits.py` the series).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.closed_forms import (
    cone_contact_elevation,
    cone_fold_angles,
    cone_partial_angles,
    cone_roots,
)
from origami_nlp.errors import OptionError
from origami_nlp.numerics import ROUNDED
from origami_nlp.paper.cone import check_ratio

DEGREES = (8, 16, 32, 64, 128, 256, 512, 1024)
"""The ladder of degrees; each is twice the one before."""
ROUNDING = 10 * ROUNDED
"""Distances below this are rounding of double precision, and no order is read from them: quantities of order 1,
each within a few hundred roundings of eps."""
BISECTIONS = 200
"""Halvings of [0, pi/2]: more than the 53 + 8 that the last bit of an elevation of 0.01 needs; the rest do nothing."""


@dataclass(frozen=True)
class Limit:
    """Approach of one quantity to its continuum value.

    name, claim: what it is, and the symbolic claim that states its limit ("" where none does).
    limit: value for N -> infinity.  values: at `DEGREES`.
    order, coefficient: observed, from the last two degrees (the coefficient by Richardson, so that
    the next term of the series is removed); nan where the quantity is its limit at every degree.
    expected_order, expected_coefficient: of the leading term of the series in alpha = 2 pi/N.
    """

    name: str
    claim: str
    limit: float
    values: tuple[float, ...]
    order: float
    coefficient: float
    expected_order: int
    expected_coefficient: float

    @property
    def errors(self) -> np.ndarray:
        """|value - limit| at each degree."""
        return np.abs(np.array(self.values) - self.limit)

    @property
    def exact(self) -> bool:
        """Whether the limit is attained at every degree."""
        return bool(self.errors.max() <= ROUNDING)


def limits(elevation: float = 0.6, ratio: float = 1.0) -> list[Limit]:
    """Measure the approach to the continuum cone at one elevation.

    Parameters
    ----------
    elevation
        v in (0, pi/4) [rad], below contact at every degree of the ladder; also the rest elevation of the inverted cone.
    ratio
        r_k = k_even / k_odd > 0 (for the inverted cone only).

    Raises
    ------
    OptionError
        If an argument is out of range.
    """
    if not 0 < check_number("elevation", elevation) < math.pi / 4:
        raise OptionError(
            f"elevation = {elevation!r} must lie in (0, pi/4) [rad]: below contact at N = 8"
        )
    check_ratio(ratio)
    v, r = float(elevation), float(ratio)
    sine, cosine = math.sin(v), math.cos(v)
    inverted = 4 * r * sine**2 / ((1 + r) * v) ** 2

    def root(column: int) -> Callable[[int], float]:
        return lambda n: float(cone_roots(n, v).value[column])

    def folded(degree: int) -> np.ndarray:
        return cone_fold_angles(degree, v, [1] * (degree // 2)).value

    def odd(degree: int) -> float:
        return float(folded(degree)[0]) / 2

    def even(degree: int) -> float:
        return -float(folded(degree)[1]) / 2

    return [
        _measure("shallow partial angle rho", "s4.limit", v, root(0), 1, -sine),
        _measure("steep partial angle -rho", "s4.limit", v, lambda n: -root(1)(n), 1, sine),
        _measure("odd crease, like flaps, phi/2", "b.half-angle-limit", v, odd, 1, -sine),
        _measure("odd crease between unlike flaps, phi", "", 0.0, root(2), 1, -2 * sine),
        _measure("even crease, -phi/2", "b.half-angle-limit", v, even, 0, 0.0),
        _measure(
            "slope of the shallow angle at the flat state",
            "s4.limit",
            1.0,
            lambda n: float(cone_roots(n, 0.0).first[0]),
            1,
            -1.0,
        ),
        _measure(
            "departure from linear kinematics, max |rho - v rho'(0)|",
            "s4.limit",
            0.0,
            _departure,
            1,
            _largest_bend(),
        ),
        _measure(
            "contact elevation", "s5.contact-numbers", math.pi / 2, cone_contact_elevation, 1, -1.0
        ),
        _measure(
            "visible area ratio, shallow flaps",
            "b.correspondence",
            cosine,
            lambda n: math.cos(root(0)(n)),
            1,
            sine**2,
        ),
        _measure(
            "visible area ratio, mean of shallow and steep",
            "b.correspondence",
            cosine,
            lambda n: (math.cos(root(0)(n)) + math.cos(root(1)(n))) / 2,
            2,
            -cosine * sine**2,
        ),
        _measure(
            "energy of the inverted cone / energy of the flat sheet",
            "",
            0.0,
            lambda n: inverted_cone_energy(n, v, r),
            2,
            inverted,
        ),
    ]


def _measure(
    name: str,
    claim: str,
    limit: float,
    value: Callable[[int], float],
    order: int,
    coefficient: float,
) -> Limit:
    values = tuple(float(value(n)) for n in DEGREES)
    gap = np.array(values) - limit
    if np.abs(gap).max() <= ROUNDING:
        return Limit(name, claim, limit, values, math.nan, math.nan, order, coefficient)
    alpha = 2 * math.pi / np.array(DEGREES, dtype=float)
    scaled = gap / alpha**order
    # the next term of each series is one power of alpha higher: halving alpha twice removes it
    richardson = 2 * scaled[-1] - scaled[-2]
    observed = math.log2(abs(gap[-2] / gap[-1]))
    return Limit(name, claim, limit, values, observed, float(richardson), order, coefficient)


def _departure(degree: int) -> float:
    """Largest |rho - v rho'(0)| of the shallow root over 0 <= v <= pi/4."""
    v = np.linspace(0, math.pi / 4, 2001)
    slope = float(cone_roots(degree, 0.0).first[0])
    return float(np.abs(cone_roots(degree, v).value[:, 0] - slope * v).max())


def _largest_bend() -> float:
    """max of v - sin v over the same elevations: rho - K v = alpha (v - sin v) + .."""
    return math.pi / 4 - math.sin(math.pi / 4)


def inverted_cone_energy(degree: int, rest_elevation: float, ratio: float) -> float:
    """Energy of the popped-through cone relative to the flat sheet: min over v < 0 of U / U_flat.

    The all-valley branch below the flat state has the steep root where the rest state has the
    shallow one.  As N -> infinity both tend to |v|: the inverted cone is stress-free in the limit
    (a bistable cone), with U/U_flat ~ 4 r alpha^2 sin(v_0)^2 / ((1 + r) v_0)^2.
    """
    rest = float(cone_partial_angles(degree, rest_elevation).value[0])
    low, high = 0.0, cone_contact_elevation(degree)
    for _ in range(BISECTIONS):  # bisection on the slope, which rises through its only zero
        t = (low + high) / 2
        angles = cone_partial_angles(degree, -t)
        steep, slope = float(angles.value[0]), -float(angles.first[0])
        low, high = (
            (t, high) if (steep - rest) * slope + ratio * (t - rest_elevation) < 0 else (low, t)
        )
    steep = float(cone_partial_angles(degree, -low).value[0])
    energy = (steep - rest) ** 2 + ratio * (low - rest_elevation) ** 2
    return energy / (rest**2 + ratio * rest_elevation**2)
