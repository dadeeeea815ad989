"""Section 3.2: geometry, closed form, realness, branches and symmetry of the degree-8 vertex.

Derived (claims ``derive.dihedral-elevation`` and ``derive.degree8``): with w = Q(b_2, phi_2) e2,
A = sin(v) w_3, B = sin(v) w_2, C = -cos(v) w_1 and D = sqrt(sin^2 v - sin^2(2 alpha)
sin^4(phi_2/2)), half of phi_1 solves A cos t + B sin t = C.  The paper's J is 4 D, and its K is
4 cos(alpha) sin(alpha) cos(v) sin(phi_2) up to the signs of v and phi_2.
"""

from __future__ import annotations

from typing import Any

import mpmath
import sympy as sp

from symbolic.claim import Claim, Verdict
from symbolic.decide import Correction, as_convention, by_cases, by_identity, refuted
from symbolic.derive import TrigEquation, dihedral_form
from symbolic.identities import to_circles, vanishes
from symbolic.rotations import E1, E2, reflect, scale
from symbolic.symbols import ALPHA, HALF2, UPSILON, alpha, phi2, upsilon

J = sp.Symbol("J", nonnegative=True)
K = sp.Symbol("K", real=True)
_CIRCLES = [ALPHA, HALF2, UPSILON]
_Q = sp.cos(alpha) ** 2 * sp.cos(phi2) + sp.sin(alpha) ** 2

J_SQUARED = (
    5
    - 8 * sp.cos(upsilon)
    + 4 * sp.cos(phi2)
    - sp.cos(2 * phi2)
    + 8 * sp.cos(4 * alpha) * sp.sin(phi2 / 2) ** 4
)
"""The radicand of J as printed."""
J_SQUARED_RIGHT = J_SQUARED.subs(sp.cos(upsilon), sp.cos(2 * upsilon))
J_SQUARED_SHORT = 16 * (sp.sin(upsilon) ** 2 - sp.sin(2 * alpha) ** 2 * sp.sin(phi2 / 2) ** 4)

# (first argument, second argument, factor in front of arctan) for phi_2 > 0 and phi_2 < 0
_A, _T = sp.cos(alpha), sp.tan(phi2 / 2)
BRANCH_1 = (
    (K * _A * (sp.cos(phi2) - 1) - J * _Q, _A * sp.sin(phi2) * J - K * _Q * _T, 2),
    (-K * _A * (sp.cos(phi2) - 1) - J * _Q, -_A * sp.sin(phi2) * J - K * _Q * _T, -2),
)
BRANCH_2 = (
    (K * _A * (sp.cos(phi2) - 1) + J * _Q, _A * sp.sin(phi2) * J + K * _Q * _T, -2),
    (-K * _A * (sp.cos(phi2) - 1) + J * _Q, -_A * sp.sin(phi2) * J + K * _Q * _T, 2),
)
"""The four lines of the degree-8 formula, argument order as printed."""


def equation() -> TrigEquation:
    """The derived equation for t = phi_1/2 on the circles of the proofs."""
    return dihedral_form(2, [ALPHA.pair], [HALF2.pair], UPSILON.pair).equation


def _check_geometry(statement: tuple[Any, ...]) -> Verdict:
    """Sector angles from D_2 images of crease 2 at alpha."""
    b2 = (sp.cos(alpha), sp.sin(alpha), 0)
    azimuth = sp.Integer(0)
    images = [
        E1,
        b2,
        E2,
        reflect(E1, b2),
        scale(-1, E1),
        scale(-1, b2),
        scale(-1, E2),
        reflect(E2, b2),
    ]
    gaps = []
    for sector, image in zip(statement, images[1:], strict=False):
        azimuth += sector
        gaps += [sp.cos(azimuth) - image[0], sp.sin(azimuth) - image[1]]
    return by_identity(
        gaps,
        [ALPHA],
        "Walking round by the sector angles meets the D_2 images of b_2: e1, b_2, e2, sigma_{e1} "
        "b_2, -e1, -b_2, -e2, sigma_{e2} b_2.",
    )


_SECTORS = tuple(alpha if i in (1, 4, 5, 8) else sp.pi / 2 - alpha for i in range(1, 8))
_SECTORS_WRONG = tuple(alpha if i % 2 else sp.pi / 2 - alpha for i in range(1, 8))


def _check_radicand(statement: Any) -> Verdict:
    """J^2 must be 16 times the discriminant of the derived equation."""
    gap = statement - 16 * equation().discriminant
    return by_identity(
        [gap],
        _CIRCLES,
        "J^2 = 16 (A^2 + B^2 - C^2): J real is exactly the existence condition.",
        Correction(
            r"\mathcal J=\sqrt{5-8\cos 2\upsilon+4\cos\phi_2-\cos 2\phi_2+8\cos 4\alpha\,"
            r"\sin^4\tfrac{\phi_2}{2}}=4\sqrt{\sin^2\upsilon-\sin^2 2\alpha\,"
            r"\sin^4\tfrac{\phi_2}{2}}",
            lambda: all(
                vanishes(r - 16 * equation().discriminant, _CIRCLES)
                for r in (J_SQUARED_RIGHT, J_SQUARED_SHORT)
            ),
            "with cos(2 upsilon) in place of cos(upsilon) the radicand is 16 (A^2 + B^2 - C^2) "
            "identically, and it collapses to the short form.",
        ),
    )


def _cases(
    line: tuple[Any, Any, int], order: str, v_sign: int, fold_sign: int, k_factor: Any
) -> tuple[Any, Any]:
    """(cos t, sin t) up to a positive factor for one printed line, K written out per sign case."""
    first, second, factor = line
    k = 4 * sp.cos(alpha) * sp.sin(alpha) * sp.cos(upsilon) * v_sign * fold_sign
    k = k * sp.sin(phi2) * k_factor
    x, y = (first, second) if order == "xy" else (second, first)
    # phi_1 = factor * arctan: t = phi_1/2 = (factor/2) * arctan, factor/2 = +-1
    y = y * sp.sign(factor)
    tangent = sp.sin(phi2 / 2) / sp.cos(phi2 / 2)
    return tuple(e.subs(_T, tangent).subs(K, k) for e in (x, y))  # type: ignore[return-value]


def _line_gaps(lines: Any, order: str, branch: int, k_factor: Any = 1) -> list[Any]:
    """Residuals that vanish when both lines give branch * sign(v) of the derived solution."""
    eq = equation()
    gaps = []
    for fold_sign, line in zip((1, -1), lines, strict=True):
        for v_sign in (1, -1):
            x, y = _cases(line, order, v_sign, fold_sign, k_factor)
            br = branch * v_sign
            # derived direction of t on branch br, with D = J/4
            cos_t = 4 * (eq.A * eq.C - br * eq.B * J / 4)
            sin_t = 4 * (eq.B * eq.C + br * eq.A * J / 4)
            sine = v_sign * UPSILON.s  # |sin v|, the positive factor between the two
            gaps += [x * sine - cos_t, y * sine - sin_t]
    return gaps


def _check_formula(statement: tuple[Any, Any, str, Any]) -> Verdict:
    """All four lines, both signs of v, with J the (right) square root."""
    first, second, order, k_factor = statement
    gaps = _line_gaps(first, order, 1, k_factor) + _line_gaps(second, order, -1, k_factor)
    verdict = by_identity(
        gaps,
        _CIRCLES,
        "In each of the 2 x 2 x 2 sign cases |sin v| times the two arguments is 4 (A C -+ B D, "
        "B C +- A D): the printed lines are the two solutions of A cos t + B sin t = C, "
        "read as arctan(x, y).",
        fixed={J: sp.Rational(1, 2)},
    )
    if statement != (BRANCH_1, BRANCH_2, "yx", 1):
        return verdict
    return as_convention(
        verdict,
        "The lines are right when the FIRST argument is the abscissa, arctan(x, y) (Mathematica's "
        "order); section 3.1 defines arctan(y, x) and eq:phi1-6-fold needs that order.",
        Correction(
            r"\phi_1=f_\phi\bigl(2\operatorname{atan2}(BC\pm AD,\,AC\mp BD)\bigr),\ "
            r"A=\sin\upsilon\cos\alpha\sin\phi_2,\ B=\sin\upsilon(\sin^2\alpha+\cos^2\alpha"
            r"\cos\phi_2),\ C=-\cos\upsilon\sin 2\alpha\,\sin^2\tfrac{\phi_2}{2},\ "
            r"D=\sqrt{\sin^2\upsilon-\sin^2 2\alpha\sin^4\tfrac{\phi_2}{2}}",
            lambda: all(
                vanishes(g, _CIRCLES)
                for g in (
                    *_line_gaps(BRANCH_1, "xy", 1),
                    *_line_gaps(BRANCH_2, "xy", -1),
                    *_coefficients(),
                )
            ),
            "with the arguments exchanged all eight sign cases hold identically; the short form "
            "needs no cases.",
        ),
    )


def _coefficients() -> list[Any]:
    eq = equation()
    return [
        eq.A - sp.sin(upsilon) * sp.cos(alpha) * sp.sin(phi2),
        eq.B - sp.sin(upsilon) * _Q,
        eq.C + sp.cos(upsilon) * sp.sin(2 * alpha) * sp.sin(phi2 / 2) ** 2,
    ]


def _numeric(lines: Any, a: Any, v: Any, p: Any, order: str = "xy") -> Any:
    """One branch in 50 digits, with the corrected J."""
    first, second, factor = lines[0] if p > 0 else lines[1]
    with mpmath.workdps(60):
        j = mpmath.sqrt(16 * (mpmath.sin(v) ** 2 - mpmath.sin(2 * a) ** 2 * mpmath.sin(p / 2) ** 4))
        k = 4 * abs(mpmath.cos(a) * mpmath.sin(v) * mpmath.sin(p)) * mpmath.sin(a) * mpmath.cot(v)
        x, y = (
            sp.lambdify((alpha, upsilon, phi2, J, K), e, "mpmath")(a, v, p, j, k)
            for e in (first, second)
        )
        return factor * (mpmath.atan2(y, x) if order == "xy" else mpmath.atan2(x, y))


def _check_real(statement: Any) -> Verdict:
    """Existence condition of the derived equation against sin^2 v >= statement."""
    return by_identity(
        [equation().discriminant - (sp.sin(upsilon) ** 2 - statement)],
        _CIRCLES,
        "A cos t + B sin t = C has real solutions exactly when A^2 + B^2 - C^2 = (J/4)^2 >= 0 "
        "(with the corrected J), that is |sin v| >= |sin 2 alpha| sin^2(phi_2/2).",
    )


def _check_domain(statement: str) -> Verdict:
    """Whether the cases phi_2 > 0 and phi_2 < 0 cover the chart."""
    at_zero = [
        sp.expand(sp.sympify(e).subs({HALF2.c: 1, HALF2.s: 0}))
        for e in (equation().A, equation().B, equation().C)
    ]
    phi1_zero = at_zero[0] == 0 and at_zero[2] == 0 and vanishes(at_zero[1] - UPSILON.s, _CIRCLES)
    tangent_at_pi = sp.tan(phi2 / 2).subs(phi2, sp.pi)
    if statement == "phi_2 != 0, |phi_2| < pi":
        return by_cases([("phi_2 = 0 gives phi_1 = 0", phi1_zero)], "exact", "exact")
    return refuted(
        f"phi_2 = 0 has no line, although the vertex folds there (the book fold about crease 3, "
        f"phi_1 = 0, phi_3 = 2 upsilon, any elevation); at phi_2 = +-pi the factor tan(phi_2/2) = "
        f"{tangent_at_pi} meets K = 0.",
        "exact evaluation",
        Correction(
            r"\phi_2=0:\ \phi_1=0,\ \upsilon\ \text{free};\qquad \text{no case distinction in }"
            r"\phi_1=2\operatorname{atan2}(BC\pm AD,\,AC\mp BD)",
            lambda: phi1_zero,
            "at phi_2 = 0 the equation reads sin(v) sin t = 0, so phi_1 = 0 modulo 2 pi; at "
            "phi_2 = 0 = upsilon all coefficients vanish: phi_1 is free (book fold about crease 1).",
        ),
    )


def _check_range(statement: str) -> Verdict:
    """2 arctan(...) lies in (-2 pi, 2 pi]; look for a value outside [-pi, pi]."""
    with mpmath.workdps(60):
        a, v, p = mpmath.pi / 4, mpmath.pi / 3, mpmath.pi / 2
        value = _numeric(BRANCH_1, a, v, p)
        outside = abs(value) > mpmath.pi + mpmath.mpf(10) ** -40
        shown = mpmath.nstr(value, 30)
    if statement == "wrapped" or not outside:
        return Verdict(
            "proved" if statement == "wrapped" else "unproved",
            "range of arctan",
            "f_phi maps into [-pi, pi] (claim s3.wrap).",
        )
    return refuted(
        f"At alpha = pi/4, upsilon = pi/3, phi_2 = pi/2 the first branch gives phi_1 = {shown} "
        "(50-digit arithmetic), outside [-pi, pi]: f_phi of section 3.1 is missing.",
        "50-digit counterexample",
        Correction(
            r"\phi_1=f_\phi\bigl(2\arctan(\cdot,\cdot)\bigr)",
            lambda: all(vanishes(g, _CIRCLES) for g in _line_gaps(BRANCH_1, "xy", 1)),
            "2 arctan is defined modulo 2 pi only, so f_phi may and must be applied.",
        ),
    )


def _check_odd(statement: tuple[Any, Any]) -> Verdict:
    """Branch `statement[1]` at (-v, -phi_2) must be minus branch `statement[0]` at (v, phi_2)."""
    source, image = statement
    gaps = []
    for fold_sign in (1, -1):
        for v_sign in (1, -1):
            line = source[0] if fold_sign > 0 else source[1]
            other = image[1] if fold_sign > 0 else image[0]
            x, y = _cases(line, "xy", v_sign, fold_sign, 1)
            a, b = _cases(other, "xy", -v_sign, -fold_sign, 1)
            flip = {HALF2.s: -HALF2.s, UPSILON.s: -UPSILON.s}
            a, b = (to_circles(e, _CIRCLES).subs(flip, simultaneous=True) for e in (a, b))
            x, y = (to_circles(e, _CIRCLES) for e in (x, y))
            gaps += [x - a, y + b]
    verdict = by_identity(
        gaps,
        _CIRCLES,
        "Each argument pair maps to its mirror image (x, -y) in all sign cases.",
        fixed={J: sp.Rational(1, 2)},
    )
    if verdict.verdict != "refuted" or statement != (BRANCH_1, BRANCH_2):
        return verdict
    with mpmath.workdps(60):
        a_, v_, p_ = mpmath.pi / 5, mpmath.mpf(1) / 2, mpmath.mpf(1) / 2
        one = mpmath.nstr(_numeric(BRANCH_1, a_, v_, p_), 20)
        two = mpmath.nstr(-_numeric(BRANCH_2, a_, -v_, -p_), 20)
        same = mpmath.nstr(-_numeric(BRANCH_1, a_, -v_, -p_), 20)
    return refuted(
        f"At alpha = pi/5, upsilon = phi_2 = 1/2 the first branch gives {one}; minus the second "
        f"branch at (-1/2, -1/2) is {two}, minus the first branch there is {same}.",
        "50-digit counterexample",
        Correction(
            r"\phi_1^{(i)}(-\upsilon,-\phi_2)=-\phi_1^{(i)}(\upsilon,\phi_2),\quad i=1,2",
            lambda: all(_check_odd((b, b)).verdict == "proved" for b in (BRANCH_1, BRANCH_2)),
            "as printed (|sin upsilon| in K) each branch is odd by itself: flipping the vertex "
            "maps it to the SAME branch; the two branches are different shapes and meet where "
            "J = 0.",
        ),
    )


def _check_energy_odd(statement: Any) -> Verdict:
    """U(-phi) - U(phi) for one crease with a rest angle."""
    k, phi, rest = sp.symbols("k phi phi^0", real=True)
    gap = sp.expand(k / 2 * (-phi - rest) ** 2 - k / 2 * (phi - rest) ** 2)
    return by_cases(
        [("U(-phi) - U(phi)", sp.expand(gap - statement) == 0)],
        "U(-phi) - U(phi) = 2 sum k_i phi_i phi^0_i, not zero unless torques balance: the energy "
        "has no odd symmetry while the kinematics has.",
        "exact",
    )


def _check_slope(statement: str) -> Verdict:
    """Slope of the boundary sin v = sin(2 alpha) sin^2(phi_2/2) as a function of alpha."""
    v = sp.asin(sp.sin(2 * alpha) * sp.sin(phi2 / 2) ** 2)
    on_boundary = sp.expand(J_SQUARED_SHORT.subs(sp.sin(upsilon), sp.sin(v)))
    curvature = sp.diff(v, phi2, 2).subs(phi2, 0)
    values = [
        sp.radsimp(curvature.subs(alpha, sp.pi * r))
        for r in (sp.Rational(1, 12), sp.Rational(1, 6), sp.Rational(1, 4))
    ]
    increasing = bool(values[0] < values[1]) and bool(values[1] < values[2])
    # dv/dphi_2 = sin(2a) sin(phi_2)/2 / sqrt(1 - sin^2(2a) s^4) grows with sin(2a): derivative > 0
    g, s4 = sp.symbols("g s4", positive=True)
    growth = sp.together(
        sp.diff(g / sp.sqrt(1 - g**2 * s4), g) * (1 - g**2 * s4) ** sp.Rational(3, 2)
    )
    ok = {"increasing": increasing, "decreasing": not increasing}[statement]
    return by_cases(
        [
            ("the curve lies on J = 0", sp.expand(on_boundary) == 0),
            ("slope grows with sin 2 alpha", sp.simplify(growth - 1) == 0),
            (f"curvatures at the flat state {values}", ok),
        ],
        f"J = 0 is sin v = sin(2 alpha) sin^2(phi_2/2) for v > 0; its slope sin(2 alpha) "
        f"sin(phi_2)/(2 cos v) grows with alpha up to pi/4, with curvature {values} at the flat "
        "state for pi/12, pi/6, pi/4 (beyond pi/4 it falls again; at phi_2 = 0 itself it is 0).",
        "exact differentiation",
    )


CLAIMS: list[Claim] = [
    Claim(
        "s3.geometry-8",
        "sec. 3.2, degree-8 geometry",
        "Sector angles of the degree-8 vertex",
        _SECTORS,
        r"\alpha_1=\alpha_4=\alpha_5=\alpha_8,\ \alpha_2=\alpha_3=\alpha_6=\alpha_7"
        r"=\pi/2-\alpha_1",
        _check_geometry,
        damaged=(_SECTORS_WRONG,),
    ),
    Claim(
        "s3.phi1-8",
        "sec. 3.2, degree-8 formula",
        "Degree-8 closed form: order of arguments",
        (BRANCH_1, BRANCH_2, "yx", 1),
        r"\phi_1=\pm2\arctan\bigl(\mathcal K\cos\alpha(\cos\phi_2-1)\mp\mathcal J(\ldots),\ "
        r"\cos\alpha\sin\phi_2\mathcal J\mp\mathcal K(\ldots)\tan\tfrac{\phi_2}{2}\bigr)",
        _check_formula,
        damaged=(
            (BRANCH_2, BRANCH_1, "xy", 1),
            (BRANCH_1, BRANCH_2, "xy", 2),
            (BRANCH_1, BRANCH_2, "xy", -1),
        ),
    ),
    Claim(
        "s3.J",
        "sec. 3.2, definition of J",
        "Radicand of J",
        J_SQUARED,
        r"\mathcal J=\sqrt{5-8\cos\upsilon+4\cos\phi_2-\cos 2\phi_2+8\cos 4\alpha\,"
        r"\sin^4\tfrac{\phi_2}{2}}",
        _check_radicand,
        damaged=(
            J_SQUARED_RIGHT.subs(sp.cos(4 * alpha), sp.cos(2 * alpha)),
            J_SQUARED_RIGHT + 2 * sp.cos(2 * phi2),
        ),
    ),
    Claim(
        "s3.real-8",
        "sec. 3.2, realness condition",
        "Real exactly when J is real",
        sp.sin(2 * alpha) ** 2 * sp.sin(phi2 / 2) ** 4,
        r"\phi_1\in\mathbb R\iff\mathcal J\in\mathbb R",
        _check_real,
        damaged=(
            sp.sin(alpha) ** 2 * sp.sin(phi2 / 2) ** 4,
            sp.sin(2 * alpha) ** 2 * sp.sin(phi2 / 2) ** 2,
        ),
    ),
    Claim(
        "s3.domain-8",
        "sec. 3.2, cases phi_2 > 0 and phi_2 < 0",
        "The printed cases cover the chart",
        "all",
        r"\phi_2>0\ \text{or}\ \phi_2<0",
        _check_domain,
    ),
    Claim(
        "s3.range-8",
        "sec. 3.2, range of phi_1",
        "phi_1 = 2 arctan lies in [-pi, pi]",
        "bare",
        r"\pm2\arctan(\cdot,\cdot)\in[-\pi,\pi]",
        _check_range,
    ),
    Claim(
        "s3.odd-symmetry",
        "sec. 3.2, odd symmetry of the branches",
        "The second branch is the first one flipped over",
        (BRANCH_1, BRANCH_2),
        r"\phi_1^{(2)}(-\upsilon,-\phi_2)=-\phi_1^{(1)}(\upsilon,\phi_2)",
        _check_odd,
        damaged=((BRANCH_2, BRANCH_1),),
    ),
    Claim(
        "s3.energy-not-odd",
        "sec. 3.2, energy without odd symmetry",
        "The energy landscape is not odd symmetric",
        2 * sp.Symbol("k", real=True) * sp.Symbol("phi", real=True) * sp.Symbol("phi^0", real=True),
        r"U(-\phi)-U(\phi)=2\textstyle\sum k_i\phi_i\phi_i^0\ne0",
        _check_energy_odd,
        damaged=(sp.Integer(0),),
    ),
    Claim(
        "s3.boundary-slope-8",
        "sec. 3.2, boundary above the flat state",
        "The boundary's slope increases with alpha_1",
        "increasing",
        r"\text{slope of }\mathcal J=0\text{ at }\alpha_1=\pi/12<\pi/6<\pi/4\text{ increases}",
        _check_slope,
        damaged=("decreasing",),
    ),
]
