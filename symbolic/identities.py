"""Trigonometric identities decided exactly, as polynomials on a product of unit circles.

An expression in cos and sin of integer combinations of given angles is turned into a polynomial in
pairs (c, s) of one `Circle` per angle.  The polynomials c^2 + s^2 - 1 of distinct circles have
coprime leading terms, so they are a Groebner basis of the ideal they generate, and that ideal is
the full vanishing ideal of the real torus: the normal form (`reduce`) is zero exactly when the
identity holds for all real angles.  No call to `simplify` takes part.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product as cartesian
from math import comb
from typing import Any

import sympy as sp
from sympy.polys.fields import FracField
from sympy.polys.polyerrors import CoercionFailed

from .rotations import Pair, rational_pair


@dataclass(frozen=True)
class Circle:
    """One angle variable: `unit` is the angle whose cosine and sine are the generators c and s.

    Give phi/2 as unit where half fold angles occur.  `tangents` are the values of tan(unit/2) tried
    in the search for counterexamples, in this order.
    """

    unit: Any
    c: sp.Symbol
    s: sp.Symbol
    tangents: tuple[Any, ...] = field(
        default=tuple(
            sp.Rational(f.numerator, f.denominator)
            for f in (Fraction(1, 2), Fraction(1, 3), Fraction(-1, 4), Fraction(2, 5), Fraction(-3))
        )
    )

    @property
    def pair(self) -> Pair:
        """The generators (c, s)."""
        return (self.c, self.s)


def circle(unit: Any, name: str, tangents: Sequence[Any] | None = None) -> Circle:
    """A `Circle` with generators ``c_name`` and ``s_name``."""
    c, s = sp.symbols(f"c_{name} s_{name}", real=True)
    if tangents is None:
        return Circle(unit, c, s)
    return Circle(unit, c, s, tuple(sp.sympify(t) for t in tangents))


def _power(pair: Pair, n: int) -> Pair:
    """(cos n a, sin n a) from (cos a, sin a), n any integer."""
    c, s = pair if n >= 0 else (pair[0], -pair[1])
    x, y = sp.Integer(1), sp.Integer(0)
    for _ in range(abs(n)):
        x, y = x * c - y * s, x * s + y * c
    return (sp.expand(x), sp.expand(y))


def _trig_pair(angle: Any, circles: Sequence[Circle]) -> Pair:
    """(cos, sin) of an integer combination of the units plus a constant, as polynomials."""
    rest = sp.expand(angle)
    x, y = sp.Integer(1), sp.Integer(0)
    for circ in circles:
        symbol = next(iter(sp.sympify(circ.unit).free_symbols))
        n = rest.coeff(symbol) / sp.sympify(circ.unit).coeff(symbol)
        if n != int(n):
            raise ValueError(f"{angle} is not an integer multiple of {circ.unit}")
        rest = sp.expand(rest - n * circ.unit)
        a, b = _power(circ.pair, int(n))
        x, y = x * a - y * b, x * b + y * a
    if rest.free_symbols:
        raise ValueError(f"{angle} contains an angle without a circle: {rest}")
    a, b = sp.cos(rest), sp.sin(rest)
    return (sp.expand(x * a - y * b), sp.expand(x * b + y * a))


def to_circles(expr: Any, circles: Sequence[Circle]) -> sp.Expr:
    """Replace every cos, sin, tan and cot of the circles' angles by the generators."""
    expr = sp.sympify(expr)
    return expr.replace(
        lambda e: isinstance(e, (sp.cos, sp.sin, sp.tan, sp.cot)),
        lambda e: _function(e, circles),
    )


def _function(e: Any, circles: Sequence[Circle]) -> Any:
    x, y = _trig_pair(e.args[0], circles)
    if isinstance(e, sp.cos):
        return x
    if isinstance(e, sp.sin):
        return y
    return y / x if isinstance(e, sp.tan) else x / y


def reduce(expr: Any, circles: Sequence[Circle]) -> sp.Poly:
    """Normal form of a polynomial: every s^n becomes (1 - c^2)^(n // 2) s^(n % 2).

    This is the remainder of `sympy.reduced` by the relations in an order with s > c, done in one
    pass.  Coefficients may contain further symbols (stiffnesses, signs) and algebraic numbers.
    """
    gens = [g for circ in circles for g in circ.pair]
    poly = sp.Poly(expr, *gens)
    terms = _on_circles(poly.as_dict(native=True), len(circles), poly.domain.zero)
    return sp.Poly.from_dict(terms, *gens, domain=poly.domain)


def _on_circles(terms: Mapping[tuple[int, ...], Any], many: int, zero: Any) -> dict[Any, Any]:
    """Normal form of terms, coefficients by powers: c and s of each circle in turn, then others."""
    for i in range(many):
        out: dict[tuple[int, ...], Any] = {}
        for powers, coefficient in terms.items():
            half, odd = divmod(powers[2 * i + 1], 2)
            for k in range(half + 1):  # the binomial theorem for (1 - c^2)^half
                low = (*powers[: 2 * i], powers[2 * i] + 2 * k, odd, *powers[2 * i + 2 :])
                out[low] = out.get(low, zero) + (-1) ** k * comb(half, k) * coefficient
        terms = out
    return {powers: c for powers, c in terms.items() if c != zero}


def vanishes(expr: Any, circles: Sequence[Circle]) -> bool:
    """Whether the expression is zero for all values of the angles (exact).

    A rational function is brought over one denominator first; the identity is then meant wherever
    the denominator does not vanish.
    """
    expr = to_circles(expr, circles)
    gens = [g for circ in circles for g in circ.pair]
    others = sorted(expr.free_symbols - set(gens), key=str)
    try:  # rational coefficients: other symbols are variables as well
        numerator = FracField([*gens, *others], sp.QQ).from_expr(expr).numer
    except (ValueError, CoercionFailed):
        poly = reduce(sp.fraction(sp.together(expr))[0], circles)
        return all(sp.expand(c) == 0 or _algebraic_zero(c) for c in poly.coeffs())
    return not _on_circles(numerator, len(circles), sp.QQ.zero)


def _algebraic_zero(coefficient: Any) -> bool:
    """Exact zero test of a coefficient: radicals by minimal polynomial, symbols by expansion."""
    coefficient = sp.radsimp(sp.expand(coefficient))
    if coefficient == 0:
        return True
    if coefficient.free_symbols:
        return False
    x = sp.Symbol("x")
    return bool(sp.minimal_polynomial(coefficient, x) == x)


@dataclass(frozen=True)
class Counterexample:
    """An exact point where an expression that should vanish does not."""

    tangents: Mapping[str, Any]
    value: Any

    def __str__(self) -> str:
        """Text for the evidence column."""
        where = ", ".join(f"tan({angle}) = {t}" for angle, t in self.tangents.items())
        number = sp.N(self.value, 15)
        return f"at {where} the two sides differ by {number}" + (
            f" = {self.value}" if len(str(self.value)) < 30 else ""
        )


def counterexample(
    expr: Any, circles: Sequence[Circle], fixed: Mapping[Any, Any] | None = None
) -> Counterexample | None:
    """First rational point of the torus where `expr` is not zero; None if there is none.

    fixed: exact values for the symbols that are not angles.
    """
    poly = to_circles(expr, circles).subs(dict(fixed or {}))
    circles = [circ for circ in circles if poly.free_symbols & {circ.c, circ.s}]
    for tangents in cartesian(*(circ.tangents for circ in circles)):
        point: dict[Any, Any] = {}
        for circ, t in zip(circles, tangents, strict=True):
            point[circ.c], point[circ.s] = rational_pair(t)
        value = poly.xreplace(point)
        if value.has(sp.zoo, sp.nan, sp.oo):
            continue
        value = sp.radsimp(sp.expand(value))
        if value != 0 and abs(sp.N(value, 50)) > sp.Rational(1, 10**40):
            names = {str(c.unit / 2): t for c, t in zip(circles, tangents, strict=True)}
            return Counterexample(names, value)
    return None
