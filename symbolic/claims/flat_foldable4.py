"""Flat-foldable vertices of degree 4: two curves of closed states, and at most two stable states on each.

Along a curve phi_1 = p, phi_3 = +-p, phi_2 = psi(p), phi_4 = -+psi, tan(psi/2) = mu tan(p/2): springs of opposite
creases add up to one, so that U = K1/2 (p - a)^2 + K2/2 (psi - b)^2 up to a constant.  With 0 < mu < 1 (else the pairs
change places, or phi_2 and phi_4 change their signs) and b >= 0 (else p and psi change theirs), U'' < 0 on at most one
interval: no more than one maximum between the ends.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import mpmath
import sympy as sp

from ..claim import Claim, Origin, Verdict
from ..decide import by_cases, by_identity
from ..degree4 import neighbours
from ..identities import Circle, circle
from ..rotations import Quaternion, planar, product, scale
from ..statement import formula, row

_OWN: Origin = "own derivation"
_HALF = (
    circle(sp.Symbol("alpha", real=True) / 2, "h1"),
    circle(sp.Symbol("beta", real=True) / 2, "h2"),
)
"""Halves of the sectors a_1 = alpha and a_2 = beta; a_3 = pi - alpha, a_4 = pi - beta."""
_C1, _S1, _C2, _S2 = (g for h in _HALF for g in h.pair)
MU = (
    -(_C1 * _C2 - _S1 * _S2) / (_C1 * _C2 + _S1 * _S2),
    (_S1 * _C2 + _C1 * _S2) / (_S1 * _C2 - _C1 * _S2),
)
"""tan(phi_2/2)/tan(phi_1/2) of the curves phi_3 = phi_1, phi_4 = -phi_2 and phi_3 = -phi_1, phi_4 = phi_2."""

_P, _M, _KAPPA = sp.Symbol("p", real=True), sp.Symbol("mu", positive=True), sp.Symbol("kappa")
A, B, C = sp.Symbol("A", positive=True), sp.Symbol("B", positive=True), sp.Symbol("c", real=True)
"""A = (1 + mu^2)/(2 mu) > B = (1 - mu^2)/(2 mu) > 0, c = cos p."""
_G = 2 * B + A * C - B * C**2
F = (B - A * C - 2 * B * C**2) / _G
DF = -3 * B * (A + 2 * B * C + A * C**2) / _G**2


def _doubled(h: Circle) -> tuple[Any, Any]:
    return (h.c**2 - h.s**2, 2 * h.c * h.s)


def _turned(x: tuple[Any, Any], y: tuple[Any, Any]) -> tuple[Any, Any]:
    return (x[0] * y[0] - x[1] * y[1], x[0] * y[1] + x[1] * y[0])


def _creases() -> list[Any]:
    """Directions of the creases: azimuths 0, alpha, alpha + beta, pi + beta."""
    one, two = (_doubled(h) for h in _HALF)
    return [
        planar(pair) for pair in ((1, 0), one, _turned(one, two), tuple(-entry for entry in two))
    ]


def _check_curves(statement: tuple[Any, Any]) -> Verdict:
    """Both curves close for every tangent."""
    t, residuals = sp.Symbol("t", real=True), []
    for sign, mu in zip((1, -1), statement, strict=True):
        tangents = (t, mu * t, sign * t, -sign * mu * t)
        total = product(
            Quaternion(1, *scale(value, crease))
            for value, crease in zip(tangents, _creases(), strict=True)
        )
        residuals += list(total.vector)
    return by_identity(
        residuals,
        _HALF,
        "1 + tan(phi/2) b is a multiple of the rotation; the product of all four has no vector part, for every t;"
        " at t = 0 it is 1 and it vanishes nowhere, so this is the lift of the flat sheet up to t = infinity, all"
        " creases at 180 degrees.",
        fixed={t: sp.Rational(1, 3)},
    )


def _check_no_other(statement: tuple[Any, Any]) -> Verdict:
    """The relation of neighbours must split into the two lines, with nothing beside them."""
    t1, t2 = sp.symbols("t_1 t_2", real=True)
    one, two = (_doubled(h) for h in _HALF)
    names = {"a1": one, "a2": two, "a3": (-one[0], one[1])}
    values = {
        sp.Symbol(f"{part}_{name}", real=True): pair[i]
        for name, pair in names.items()
        for i, part in enumerate("cs")
    }
    a, b, c, d = (sp.sympify(entry).xreplace(values) for entry in neighbours(1))
    plus, minus = statement
    lines = a * (t1 - t2 / plus) * (t1 - t2 / minus)
    return by_identity(
        [d, a * t1**2 + b * t2**2 + c * t1 * t2 - lines],
        _HALF,
        "Where a_1 + a_3 = pi the relation has no constant: tan(phi_2/2) is one of two multiples of tan(phi_1/2) "
        "at every closed state with phi_1, phi_2 between the limits; the opposite law has q = q' = 1, so that "
        "phi_3 = +-phi_1, phi_4 = +-phi_2. Other points are the 16 with all folds at +-180 degrees: 4 are ends of"
        " curves, 12 stand alone.",
        fixed={t1: sp.Rational(1, 2), t2: sp.Rational(1, 3)},
    )


def _check_turn(statement: tuple[Any, Any, Any]) -> Verdict:
    """First three derivatives of psi = 2 arctan(mu tan(p/2))."""
    tangent = sp.Symbol("T", real=True)  # tan(p/2)
    c, s = (1 - tangent**2) / (1 + tangent**2), 2 * tangent / (1 + tangent**2)
    swap = {A: (1 + _M**2) / (2 * _M), B: (1 - _M**2) / (2 * _M), C: c}
    value, cases = 2 * sp.atan(_M * tangent), []
    for order, printed in enumerate(statement, 1):
        value = sp.together(sp.diff(value, tangent) * (1 + tangent**2) / 2)
        stated = printed.subs({sp.Symbol("s", real=True): s}).subs(swap)
        cases.append((f"derivative {order}", sp.simplify(value - stated) == 0))
    return by_cases(
        cases, "Rational functions of tan(p/2) and mu, dp = 2 dT/(1 + T^2).", "rational functions"
    )


def _check_slope_of_g(statement: Any) -> Verdict:
    """G' psi''^2 of G = psi + (kappa + psi'^2)/psi''."""
    psi = sp.Function("psi")(_P)
    d1, d2, d3 = (sp.Symbol(f"psi_{i}") for i in (1, 2, 3))
    g = psi + (_KAPPA + psi.diff(_P) ** 2) / psi.diff(_P, 2)
    slope = sp.expand(g.diff(_P) * psi.diff(_P, 2) ** 2)
    slope = slope.subs(psi.diff(_P, 3), d3).subs(psi.diff(_P, 2), d2).subs(psi.diff(_P), d1)
    return by_cases(
        [("G' psi''^2", sp.expand(slope - statement) == 0)],
        "U''/K2 = kappa + psi'^2 + (psi - b) psi'': for p > 0, where psi'' > 0, it is negative exactly where b > "
        "G. For p <= 0, psi'' <= 0 and psi <= 0 <= b: positive. G rises where psi''' <= 0; elsewhere G' has the "
        "sign of H - kappa, H = 3 psi' psi''^2/psi''' - psi'^2.",
        "expansion",
    )


def _check_f(statement: tuple[Any, Any]) -> Verdict:
    """H = psi'^2 F in c = cos p, and its derivative over c, with the signs that the theorem needs."""
    f, df = statement
    d1 = 1 / (A + B * C)
    d2_squared, d3 = B**2 * (1 - C**2) * d1**4, B * _G * d1**3
    h = 3 * d1 * d2_squared / d3 - d1**2
    quadratic = sp.Poly(A + 2 * B * C + A * C**2, C)
    at_zero = sp.rem(sp.Poly(sp.numer(F), C), sp.Poly(_G, C)).as_expr()
    ends = [sp.expand(_G.subs(C, value)) for value in (1, -1)]
    cases = [
        ("H = psi'^2 F", sp.simplify(h - d1**2 * f) == 0),
        ("dF/dc", sp.simplify(sp.diff(f, C) - df) == 0),
        (
            "A + 2 B c + A c^2 > 0: its discriminant is 4 (B^2 - A^2) = -4",
            sp.expand(quadratic.discriminant() - 4 * (B**2 - A**2)) == 0,
        ),
        (
            "G's denominator g is A + B > 0 at c = 1 and B - A < 0 at c = -1, and concave",
            ends == [A + B, B - A] and sp.diff(_G, C, 2) == -2 * B,
        ),
        ("F = -1 at c = 1", sp.simplify(f.subs(C, 1)) == -1),
        (
            "F's numerator is 3 B (1 - c^2) > 0 where g = 0",
            sp.rem(sp.Poly(at_zero - 3 * B * (1 - C**2), C), sp.Poly(_G, C)).is_zero,
        ),
    ]
    return by_cases(
        cases,
        "psi''' > 0 exactly for 0 <= p < p*, g(cos p*) = 0. There F rises from -1 to infinity as p grows (c "
        "falls, dF/dc < 0). Where F < 0, H < 0 <= kappa; where F >= 0, H = psi'^2 F is a product of two growing "
        "functions. So H - kappa changes its sign once, G falls and then rises, and {b > G} is an interval or "
        "empty.",
        "rational functions",
    )


def _signs(energy: tuple[Any, ...], places: tuple[Any, ...]) -> list[int]:
    """Signs of U'/K2 at these p for (mu, kappa, a, b), by intervals; 0 where one is not decided."""
    iv = mpmath.iv
    mu, kappa, a, b = (iv.mpf(x.p) / iv.mpf(x.q) for x in energy)
    found = []
    for place in places:
        p = iv.mpf(place.p) / iv.mpf(place.q)
        psi = 2 * iv.atan2(mu * iv.sin(p / 2), iv.cos(p / 2))
        slope = 2 * mu / (1 + mu**2 + (1 - mu**2) * iv.cos(p))
        value = kappa * (p - a) + (psi - b) * slope
        found.append(1 if value.a > 0 else -1 if value.b < 0 else 0)
    return found


WELLS = tuple(sp.Rational(x) for x in ("1/10", "1/2", "-3", "5/2"))
"""mu, kappa, a, b of an energy with a maximum between two minima."""
PLACES = tuple(sp.Rational(x) for x in ("-3", "5/3", "29/10", "157/50"))


def _check_most(statement: int) -> Verdict:
    """Largest number of maxima between the ends of a curve: reached by signs of U', not passed by the three claims."""
    signs = _signs(WELLS, PLACES)
    changes = [pair for pair in pairwise(signs) if pair == (1, -1)]
    steps: tuple[Callable[[], Verdict], ...] = (
        lambda: _check_turn(TURN),
        lambda: _check_slope_of_g(G_SLOPE),
        lambda: _check_f((F, DF)),
    )
    cases = [
        ("no sign of U' is open", 0 not in signs),
        (f"U' changes from + to - {len(changes)} times", len(changes) == statement),
        ("its three steps hold", all(step().verdict == "proved" for step in steps)),
    ]
    return by_cases(
        cases,
        "U'' < 0 on one interval at most: U is convex, concave, convex; with the ends, two minima at most. Two "
        "curves: four. "
        f"One maximum is reached: signs of U' {signs} at p = {', '.join(map(str, PLACES))} for mu, kappa, a, b = "
        f"{', '.join(map(str, WELLS))}, by intervals.",
        "three claims and interval arithmetic",
    )


_SIN = sp.Symbol("s", real=True)
TURN = (
    1 / (A + B * C),
    B * _SIN / (A + B * C) ** 2,
    B * _G / (A + B * C) ** 3,
)
_D1, _D2, _D3 = (sp.Symbol(f"psi_{i}") for i in (1, 2, 3))
G_SLOPE = 3 * _D1 * _D2**2 - (_KAPPA + _D1**2) * _D3

CLAIMS: list[Claim] = [
    Claim(
        "d4.flat-foldable",
        "derivation, flat-foldable of degree 4",
        "Two curves of closed states",
        MU,
        r"\phi_3=\pm\phi_1,\ \phi_4=\mp\phi_2,\ \tan\tfrac{\phi_2}{2}=\mu_\pm\tan\tfrac{\phi_1}{2}",
        _check_curves,
        damaged=((MU[1], MU[0]), (-MU[0], MU[1])),
        form=row(*[formula(_C1, _S1, _C2, _S2)] * 2),
        origin=_OWN,
    ),
    Claim(
        "d4.flat-foldable-all",
        "derivation, flat-foldable of degree 4",
        "No other closed states between the limits",
        MU,
        r"\sin a_4\sin(a_1+a_2)(t_1-t_2/\mu_+)(t_1-t_2/\mu_-)=0",
        _check_no_other,
        damaged=((-MU[0], MU[1]),),
        form=row(*[formula(_C1, _S1, _C2, _S2)] * 2),
        origin=_OWN,
    ),
    Claim(
        "d4.turn",
        "derivation, flat-foldable of degree 4",
        "Derivatives of the second fold over the first",
        TURN,
        r"\psi'=\frac{1}{A+Bc},\ \psi''=\frac{B\sin p}{(A+Bc)^2},\ "
        r"\psi'''=\frac{B(2B+Ac-Bc^2)}{(A+Bc)^3}",
        _check_turn,
        damaged=((TURN[0], TURN[1], B * (A * C - B * C**2) / (A + B * C) ** 3),),
        form=row(*[formula(A, B, C, _SIN)] * 3),
        origin=_OWN,
    ),
    Claim(
        "d4.convexity",
        "derivation, flat-foldable of degree 4",
        "Slope of the rest angle beyond which the energy is concave",
        G_SLOPE,
        r"G'\psi''^2=3\psi'\psi''^2-(\kappa+\psi'^2)\psi'''",
        _check_slope_of_g,
        damaged=(2 * _D1 * _D2**2 - (_KAPPA + _D1**2) * _D3,),
        form=formula(_D1, _D2, _D3, _KAPPA),
        origin=_OWN,
    ),
    Claim(
        "d4.one-interval",
        "derivation, flat-foldable of degree 4",
        "It falls, then rises",
        (F, DF),
        r"F=\frac{B-Ac-2Bc^2}{2B+Ac-Bc^2},\ \frac{dF}{dc}=-\frac{3B(A+2Bc+Ac^2)}{(2B+Ac-Bc^2)^2}<0",
        _check_f,
        damaged=((F, -DF), ((B - A * C + 2 * B * C**2) / _G, DF)),
        form=row(*[formula(A, B, C)] * 2),
        origin=_OWN,
    ),
    Claim(
        "d4.most-maxima",
        "derivation, flat-foldable of degree 4",
        "Most maxima between the ends of a curve",
        1,
        r"\max\#\{\text{maxima of }U\text{ on a curve}\}=1",
        _check_most,
        damaged=(0, 2),
        origin=_OWN,
    ),
]
