"""The uniform cone in exact rational form, shared by the claims of sections 4, 5 and appendix B.

Generators: the circle of v/2 (v the elevation) and K = tan(pi/4 - alpha/2), 0 < K < 1, so that
cos alpha = 2K/(1+K^2), sin alpha = (1-K^2)/(1+K^2).  Both partial fold angles are then rational:
tan(rho/2) = K tan(v/2) ("shallow") or -tan(v/2)/K ("steep").  An identity proved here holds for
every N and v where no denominator vanishes.  For a valley flap rho_v is shallow when v > 0 and
steep when v < 0; for a mountain flap the other way round.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

import sympy as sp

from .identities import Circle, circle, to_circles, vanishes
from .rotations import E1, E2, E3, Pair, Vector, cross, dot, rational_pair
from .symbols import ALPHA, upsilon

HALF: Circle = circle(upsilon / 2, "v")
"""Circle of half the elevation."""

K = sp.Symbol("K", positive=True)
COS_ALPHA = 2 * K / (1 + K**2)
SIN_ALPHA = (1 - K**2) / (1 + K**2)
ALPHA_PAIR: Pair = (COS_ALPHA, SIN_ALPHA)

CV, SV = HALF.pair
ELEVATION: Pair = (CV**2 - SV**2, 2 * CV * SV)
"""(cos v, sin v)."""

SHALLOW: Pair = (
    (CV**2 - K**2 * SV**2) / (CV**2 + K**2 * SV**2),
    2 * K * SV * CV / (CV**2 + K**2 * SV**2),
)
"""(cos rho, sin rho) of tan(rho/2) = K tan(v/2)."""

STEEP: Pair = (
    (K**2 * CV**2 - SV**2) / (K**2 * CV**2 + SV**2),
    -2 * K * SV * CV / (K**2 * CV**2 + SV**2),
)
"""(cos rho, sin rho) of tan(rho/2) = -tan(v/2)/K."""

K_OF_DEGREE: Mapping[int, Any] = {
    6: 2 - sp.sqrt(3),
    8: sp.sqrt(2) - 1,
    12: 1 / sp.sqrt(3),
}
"""tan(pi/4 - pi/N) for degrees with short radicals (N = 10 needs nested ones)."""

QUARTER_TANGENTS = (sp.Rational(1, 4), sp.Rational(-1, 3), sp.Rational(1, 7), sp.Rational(-2, 5))
"""tan(v/4) of the points tried for counterexamples; all elevations below pi/2 in size."""


def root(kind: str, side: int) -> Pair:
    """(cos rho, sin rho) of a "valley" or "mountain" flap for elevations of sign `side`."""
    return SHALLOW if (kind == "valley") == (side > 0) else STEEP


def turn(axis: Vector, pair: Pair, vector: Vector) -> Vector:
    """Rotate by the angle with (cos, sin) = pair about a unit axis (Rodrigues)."""
    c, s = pair
    along = dot(axis, vector) * (1 - c)
    around = cross(axis, vector)
    return tuple(  # type: ignore[return-value]
        c * v + s * w + along * a for v, w, a in zip(vector, around, axis, strict=True)
    )


def azimuth(times: int) -> Vector:
    """Unit vector in the sheet at azimuth `times` alpha."""
    c, s = multiple(ALPHA_PAIR, times)
    return (c, s, sp.Integer(0))


def multiple(pair: Pair, n: int) -> Pair:
    """(cos n a, sin n a) from (cos a, sin a)."""
    c, s = pair if n >= 0 else (pair[0], -pair[1])
    x, y = sp.Integer(1), sp.Integer(0)
    for _ in range(abs(n)):
        x, y = x * c - y * s, x * s + y * c
    return (x, y)


def lift(vector: Vector, rho: Pair) -> Vector:
    """F_1 applied: Q(e2, v) Q(b_1, rho) vector (paper eq:cone-deformation)."""
    return turn(E2, ELEVATION, turn(E1, rho, vector))


def mirror(times: int) -> Vector:
    """Unit normal b x e3 of the mirror plane through the crease at azimuth `times` alpha."""
    return cross(azimuth(times), E3)


def exact(expr: Any, side: int = 1) -> Any:
    """A trigonometric expression in upsilon and alpha, in the generators, for sgn v = `side`."""
    expr = sp.sympify(expr).subs({sp.Abs(upsilon): side * upsilon, sp.sign(upsilon): side})
    if expr.has(sp.acos):
        raise ValueError(f"{expr} is not rational on the circles")
    inner = to_circles(expr, [HALF, ALPHA])
    return inner.subs({ALPHA.c: COS_ALPHA, ALPHA.s: SIN_ALPHA})


def identical(left: Any, right: Any) -> bool:
    """Whether two expressions (or vectors) in the generators agree identically."""
    if isinstance(left, tuple):
        return all(identical(a, b) for a, b in zip(left, right, strict=True))
    return vanishes(left - right, [HALF])


def separating_point(left: Any, right: Any, side: int = 0) -> str | None:
    """A point (N, v) where two expressions or vectors differ, described; None if none is found.

    side: +1 or -1 restricts the search to elevations of that sign, 0 does not.
    """
    pairs = zip(left, right, strict=True) if isinstance(left, tuple) else [(left, right)]
    gaps = [a - b for a, b in pairs]
    for (degree, k), t in product(K_OF_DEGREE.items(), QUARTER_TANGENTS):
        if side * t < 0:
            continue
        c, s = rational_pair(t)  # cos and sin of v/2
        for gap in gaps:
            value = sp.sympify(gap).subs({K: k, CV: c, SV: s})
            number = sp.N(value, 50)
            if number.is_finite and abs(number) > sp.Rational(1, 10**40):
                return (
                    f"N = {degree}, tan(upsilon/4) = {t}: the two sides differ by "
                    f"{sp.N(number, 12)}"
                )
    return None
