"""Closed states of a flat vertex of degree 4: relations of creases, the closed form, and its slopes."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Origin, Verdict
from ..decide import by_cases, by_identity
from ..degree4 import (
    AZIMUTHS,
    HYPERBOLA,
    PAIRS,
    Q_PRIME,
    SECTORS,
    TANH2,
    E,
    Q,
    W,
    X,
    half_tangent,
    neighbours,
    sine,
)
from ..rotations import Quaternion, about, dot, planar, product, scale
from ..statement import Formula, formula, row
from ..symbols import generic_fold

_OWN: Origin = "own derivation"
_GENERATORS = [g for c in SECTORS for g in c.pair]
_IN_SECTORS = Formula(frozenset(_GENERATORS))
_Q, _T = sp.Symbol("q", positive=True), sp.Symbol("t", positive=True)
_CREASES = [planar(pair) for pair in AZIMUTHS]


def _check_opposite(statement: Any) -> Verdict:
    """Where crease 2 is, seen from crease 4 over crease 1 and, the loop being closed, over crease 3."""
    one, three = generic_fold("1"), generic_fold("3")
    over_1 = dot(_CREASES[3], about(_CREASES[0], one.pair).rotate(_CREASES[1]))
    over_3 = dot(_CREASES[3], about(_CREASES[2], three.pair).inverse.rotate(_CREASES[1]))
    apart = 2 * sine(2) * sine(3) * (statement * one.s**2 - three.s**2)
    return by_identity(
        [over_1 - over_3 - apart],
        [*SECTORS, one, three],
        "F = 1 gives Q_1 b_2 = Q_4^-1 Q_3^-1 b_2, and Q_4 fixes b_4: the cosine of the arc between creases 2 and "
        "4 is the same over either side, where it is cos(a_1 + a_4) + 2 sin a_1 sin a_4 sin(phi_1/2)^2 and the "
        "like.",
    )


def _check_neighbours(statement: tuple[Any, ...]) -> Verdict:
    """Creases 4, 1, 2, 3 as a chain: its ends must be a_3 apart."""
    t1, t2 = sp.symbols("t_1 t_2", real=True)
    chain = Quaternion(1, *scale(t1, _CREASES[0])) * Quaternion(1, *scale(t2, _CREASES[1]))
    ends = dot(_CREASES[3], chain.rotate(_CREASES[2])) - PAIRS[2][0] * (1 + t1**2) * (1 + t2**2)
    a, b, c, d = statement
    residual = ends - 2 * (a * t1**2 + b * t2**2 + c * t1 * t2 + d * t1**2 * t2**2)
    return by_identity(
        [residual],
        SECTORS,
        "With t = tan(phi/2) the cosine of the arc from crease 4 to crease 3 is a polynomial of degree (2, 2); "
        "the sectors sum to 2 pi, so that it has no constant term: divided by t_1^2 t_2^2 it is quadratic in X = "
        "1/t.  Given folds 1 and 2 that fulfil it, the other two exist and are unique while crease 4 is not on "
        "crease 2 or opposite it.",
        fixed={t1: sp.Rational(1, 2), t2: sp.Rational(2, 3)},
    )


def _check_numbers(statement: tuple[Any, Any, Any]) -> Verdict:
    """The relations of all four pairs of neighbours must be those of sinh u, sinh(u + d), cosh u, cosh(u + d)."""
    q, p, tanh2 = statement
    squares = {1: 1 - q, 2: 1 - p, 3: (1 - q) / q, 4: (1 - p) / p}
    cosh2, sinh2 = 1 / (1 - tanh2), tanh2 / (1 - tanh2)
    # of neighbours i, j: k (+-Y_i^2 +- Y_j^2 - 2 (+-mixed^(1/2)) Y_i Y_j + constant) = 0 with Y = X/c
    relations = {
        1: (1, 1, -sinh2, cosh2),
        2: (-1, 1, -cosh2, sinh2),
        3: (1, 1, sinh2, cosh2),
        4: (1, -1, -cosh2, sinh2),
    }
    residuals = []
    for i, (sign_i, sign_j, constant, mixed) in relations.items():
        j = i % 4 + 1
        of_j, of_i, of_both, rest = neighbours(i)
        k = sign_i * of_i * squares[i]
        residuals += [
            sign_j * of_j * squares[j] - k,
            rest - k * constant,
            of_both**2 * squares[i] * squares[j] - 4 * k**2 * mixed,
        ]
    return by_identity(
        residuals,
        SECTORS,
        "sinh(A)^2 + sinh(B)^2 - 2 sinh A sinh B cosh(A-B) = sinh(A-B)^2 and its three relatives are the relations of "
        "neighbours, coefficient by coefficient.",
    )


def _check_addition(statement: Any) -> Verdict:
    """The four identities of hyperbolic functions that the relations are compared with."""
    s, sd, c, cd = statement
    cosh_d, sinh_d = (E + 1 / E) / 2, (E - 1 / E) / 2
    residuals = [
        s**2 + sd**2 - 2 * s * sd * cosh_d - sinh_d**2,
        c**2 + cd**2 - 2 * c * cd * cosh_d + sinh_d**2,
        c**2 - sd**2 + 2 * c * sd * sinh_d - cosh_d**2,
        cd**2 - s**2 - 2 * cd * s * sinh_d - cosh_d**2,
    ]
    return by_cases(
        [(f"relation {i}", sp.expand(r) == 0) for i, r in enumerate(residuals, 1)],
        "Laurent polynomials in w = exp(u) and E = exp(d).",
        "expansion",
    )


def _check_closed(statement: tuple[Any, ...]) -> Verdict:
    """The product of all four rotations, for every q, q', E: creases are the directions of four planar vectors."""
    x, y, z = sp.symbols("x y z", real=True)
    two, four = (
        (x, y),
        (z, sp.Integer(0)),
    )  # s b_2/c_2 and -s b_4/c_4; the sheet is turned so that the latter is along e1
    one = [sp.expand((-(a + b) / E + E * (b - a)) / 2) for a, b in zip(two, four, strict=True)]
    three = [sp.expand((-(a + b) / E - E * (b - a)) / 2) for a, b in zip(two, four, strict=True)]
    factors = [
        Quaternion(value, vector[0], vector[1], sp.Integer(0))
        for value, vector in zip(statement, (one, two, three, four), strict=True)
    ]
    unit = x**2 + y**2 - z**2 - 1
    total = product(factors)

    def zero(value: Any) -> bool:
        numerator = sp.numer(sp.together(sp.expand(value)))
        return sp.rem(sp.Poly(numerator, y), sp.Poly(unit, y)).is_zero

    norm = sum(a * a - b * b for a, b in zip(one, three, strict=True)) - 1
    cases = [(f"component {i} of F's quaternion", zero(c)) for i, c in enumerate(total.vector, 1)]
    cases.append(("|b_1/c_1|^2 - |b_3/c_3|^2 = 1", zero(norm)))
    return by_cases(
        cases,
        "cos(phi/2) + sin(phi/2) b is a multiple of Y + V, X = c Y, V = +-b/c. The product of all four has no "
        "vector part, so its square is the product of the four norms, positive: the loop is closed for every w, "
        "on the lift of the flat sheet while no crease has gone past 180 degrees.  V are the flat velocities of "
        "both modes: V_1 + V_3 + (V_2 + V_4)/E = 0 and V_3 - V_1 + E (V_4 - V_2) = 0.",
        "polynomial remainder",
    )


def _check_slopes(statement: tuple[Any, Any]) -> Verdict:
    """Slopes of opposite creases over t must be multiples of (1 + x)/D and (1 - x)/D, in either mode."""
    (first, third), cases = statement, []
    for mode, creases in ((1, (1, 3)), (2, (2, 4))):
        for crease, top in zip(creases, (first, third), strict=True):
            tangent = half_tangent(crease, _Q, E, _T, mode)
            slope = sp.diff(tangent, _T) * 2 / (1 + tangent**2)
            ratio = sp.simplify(slope / top.subs(X, _T**2))
            constant = sp.simplify(sp.diff(ratio, _T)) == 0 and ratio.is_positive is not False
            cases.append((f"mode {mode}, crease {crease}", bool(constant)))
    return by_cases(
        cases,
        "d phi/dt = 2 tan'/(1 + tan^2): creases of a pair share the denominator D(x) = (1-q)(1+x^2) + (2+2q) x, x"
        " = t^2, with 1 + x and 1 - x above it; the other pair has x/E^2 in place of x.  All folds are monotone "
        "within the limits; the four slopes span the cubics in x over D_a D_b where D_a and D_b have no common "
        "root, so that pure torques balance at no more than three x.",
        "rational functions",
    )


def _check_span(statement: Any) -> Verdict:
    """Determinant of the four numerators over 1, x, x^2, x^3, as printed."""
    p = sp.Symbol("p", positive=True)
    a = (1 - _Q) * (1 + X**2) + (2 + 2 * _Q) * X
    b = sp.expand(E**2 * ((1 - p) * (1 + X**2 / E**4) + (2 + 2 * p) * X / E**2))
    tops = [(1 + X) * b, (1 - X) * b, (E + X / E) * a, (E - X / E) * a]
    rows = [[sp.Poly(sp.expand(t), X).coeff_monomial(X**k) for k in range(4)] for t in tops]
    determinant = sp.factor(sp.Matrix(rows).det())
    resultant = sp.resultant(a, b, X)
    return by_cases(
        [
            (
                "determinant as printed, in the resultant of the two denominators",
                sp.expand(determinant - statement * resultant) == 0,
            )
        ],
        "The determinant is a multiple of the resultant of D_a and D_b: the span is all cubics unless these share"
        " a root.",
        "determinant",
    )


_D = (1 - _Q) * (1 + X**2) + (2 + 2 * _Q) * X
_P, _C, _TAU, _BETA = sp.symbols("p c tau beta", positive=True)
_NEAR = (_C + _TAU) ** 2 + _BETA * (1 - _C**2)
_FAR = 1 - _Q * _C**2
SPEEDS = (1 / _FAR, (1 + _TAU * _C) / _NEAR, _C / _FAR, (_C + _TAU) / _NEAR)
"""Speeds of the four folds over theta, tan(theta/2) = t, up to constants > 0: c = cos(theta), tau = tanh(d)."""


def _check_speeds(statement: tuple[Any, ...]) -> Verdict:
    """Mode I: the ratio of each to the slope of the closed form must be a positive constant."""
    cosine, tau = (1 - _T**2) / (1 + _T**2), (E**2 - 1) / (E**2 + 1)
    values = {_C: cosine, _TAU: tau, _BETA: (1 - tau**2) / (1 - _P)}
    cases = []
    for crease, stated in enumerate(statement, 1):
        tangent = half_tangent(crease, _Q if crease % 2 else _P, E, _T)
        slope = sp.diff(tangent, _T) / (1 + tangent**2) * (1 + _T**2)
        ratio = sp.simplify(slope / stated.subs(values, simultaneous=True))
        some = {_T: sp.Rational(1, 3), _Q: sp.Rational(1, 2), _P: sp.Rational(1, 3), E: 2}
        constant = sp.simplify(sp.diff(ratio, _T)) == 0 and ratio.subs(some).is_positive
        cases.append((f"crease {crease}", bool(constant)))
    return by_cases(
        cases,
        "d phi/d theta = 2 tan'(1 + t^2)/2/(1 + tan^2): linear functions of c over two denominators; c falls from 1 "
        "at the flat state to 0 at the limit. Mode II is mode I with the pairs of creases exchanged.",
        "rational functions",
    )


_U, _V = sp.symbols("u w", positive=True)


def _check_convexity(statement: Any) -> Verdict:
    """The second derivative of f/u by v/u, from Wronskians; and what a common factor does to these."""
    s = sp.Symbol("s")
    f, u, v, g = (sp.Function(name)(s) for name in "fuvg")

    def wronskian(*some: Any) -> Any:
        return sp.Matrix([[sp.diff(x, s, k) for x in some] for k in range(len(some))]).det()

    two, three = wronskian(u, v), wronskian(u, v, f)
    slope = sp.diff(f / u, s) / sp.diff(v / u, s)
    second = sp.diff(slope, s) / sp.diff(v / u, s)
    stated = statement.subs({_U: u, _V: two}, simultaneous=True) * three
    scaled = wronskian(g * u, g * v, g * f) - g**3 * three
    return by_cases(
        [
            ("second derivative of f/u by v/u", sp.simplify(second - stated) == 0),
            ("W(gu, gv, gf) = g^3 W(u, v, f)", sp.expand(scaled) == 0),
        ],
        "Where u > 0 and W(u, v) > 0, f/u is convex as a function of v/u where W(u, v, f) > 0. With "
        "h = W(u, v, f)/W(u, v) and a factor g > 0 common to u, v and f, h' + gamma h > 0 says the same with another "
        "gamma.",
        "derivatives of functions",
    )


CLAIMS: list[Claim] = [
    Claim(
        "d4.opposite",
        "derivation, degree 4",
        "Opposite creases: sines in a fixed ratio",
        Q,
        r"\sin^2\tfrac{\phi_3}{2}=q\sin^2\tfrac{\phi_1}{2},\ q=\frac{\sin a_1\sin a_4}{\sin a_2\sin a_3}",
        _check_opposite,
        damaged=(1 / Q, Q_PRIME),
        form=_IN_SECTORS,
        origin=_OWN,
    ),
    Claim(
        "d4.neighbours",
        "derivation, degree 4",
        "Neighbours: a quadratic relation of half-angle cotangents",
        neighbours(1),
        r"\sin a_4\sin(a_1+a_2)X_2^2-\sin a_2\sin(a_2+a_3)X_1^2+2\sin a_2\sin a_4X_1X_2"
        r"=\sin a_1\sin(a_1+a_3)",
        _check_neighbours,
        damaged=(neighbours(2), (*neighbours(1)[:3], 0)),
        form=row(*[_IN_SECTORS] * 4),
        origin=_OWN,
    ),
    Claim(
        "d4.addition",
        "derivation, degree 4",
        "Relations between sinh u, sinh(u + d), cosh u and cosh(u + d)",
        HYPERBOLA,
        r"\sinh u,\ \sinh(u+d),\ \cosh u,\ \cosh(u+d)",
        _check_addition,
        damaged=((*HYPERBOLA[:2], HYPERBOLA[3], HYPERBOLA[2]),),
        form=row(*[formula(W, E)] * 4),
        origin=_OWN,
    ),
    Claim(
        "d4.numbers",
        "derivation, degree 4",
        "Three numbers of a vertex",
        (Q, Q_PRIME, TANH2),
        r"q=\frac{\sin a_1\sin a_4}{\sin a_2\sin a_3},\ q'=\frac{\sin a_1\sin a_2}{\sin a_3\sin a_4},\ "
        r"\tanh^2d=\frac{\sin a_1\sin a_3}{\sin a_2\sin a_4}",
        _check_numbers,
        damaged=((Q_PRIME, Q, TANH2), (Q, Q_PRIME, 1 / TANH2)),
        form=row(*[_IN_SECTORS] * 3),
        origin=_OWN,
    ),
    Claim(
        "d4.closed-form",
        "derivation, degree 4",
        "All closed states in one parameter",
        HYPERBOLA,
        r"\cot\tfrac{\phi_1}{2}=c_1\sinh u,\ \cot\tfrac{\phi_2}{2}=sc_2\sinh(u+d),\ "
        r"\cot\tfrac{\phi_3}{2}=c_3\cosh u,\ \cot\tfrac{\phi_4}{2}=-sc_4\cosh(u+d)",
        _check_closed,
        damaged=(
            (HYPERBOLA[2], HYPERBOLA[1], HYPERBOLA[0], HYPERBOLA[3]),
            (HYPERBOLA[0], HYPERBOLA[1].subs(E, 1 / E), HYPERBOLA[2], HYPERBOLA[3]),
        ),
        form=row(*[formula(W, E)] * 4),
        origin=_OWN,
    ),
    Claim(
        "d4.slopes",
        "derivation, degree 4",
        "Slopes of opposite creases share their denominator",
        ((1 + X) / _D, (1 - X) / _D),
        r"\frac{d\phi_1}{dt}\propto\frac{1+x}{D(x)},\ \frac{d\phi_3}{dt}\propto\frac{1-x}{D(x)},\ "
        r"D=(1-q)(1+x^2)+(2+2q)x,\ x=t^2",
        _check_slopes,
        damaged=(((1 - X) / _D, (1 + X) / _D), ((1 + X) / _D**2, (1 - X) / _D)),
        form=row(*[formula(_Q, X)] * 2),
        origin=_OWN,
    ),
    Claim(
        "d4.span",
        "derivation, degree 4",
        "The slopes of the four creases span all cubics over their denominators",
        4,
        r"\det=4\operatorname{Res}(D_a,D_b)",
        _check_span,
        damaged=(0, 2),
        origin=_OWN,
    ),
    Claim(
        "d4.speeds",
        "derivation, degree 4",
        "Speeds of the four folds over an angle from flat (0) to the limit (90 degrees)",
        SPEEDS,
        r"\frac{1}{1-qc^2},\ \frac{1+\tau c}{R},\ \frac{c}{1-qc^2},\ \frac{c+\tau}{R},\ "
        r"R=(c+\tau)^2+\beta(1-c^2),\ \beta=\frac{1-\tau^2}{1-q'}",
        _check_speeds,
        damaged=(
            (SPEEDS[2], SPEEDS[1], SPEEDS[0], SPEEDS[3]),
            (*SPEEDS[:3], SPEEDS[3].subs(_BETA, 1 - _BETA)),
        ),
        form=row(*[formula(_Q, _C, _TAU, _BETA)] * 4),
        origin=_OWN,
    ),
    Claim(
        "d4.one-turn",
        "derivation, degree 4",
        "Where a slope over a speed is convex, as a function of the ratio of two speeds",
        _U**3 / _V**3,
        r"\frac{d^2(f/u)}{d(v/u)^2}=\frac{u^3}{W(u,v)^3}W(u,v,f)",
        _check_convexity,
        damaged=(_U**2 / _V**3, -(_U**3) / _V**3),
        form=formula(_U, _V),
        origin=_OWN,
    ),
]
