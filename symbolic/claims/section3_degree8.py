"""Section 3.2: geometry, closed form, realness, branches and symmetry of the degree-8 vertex.

Derived (claims ``derive.dihedral-elevation`` and ``derive.degree8``): with w = Q(b_2, phi_2) e2,
A = sin(v) w_3, B = sin(v) w_2, C = -cos(v) w_1 and D = sqrt(sin^2 v - sin^2(2 alpha)
sin^4(phi_2/2)), half of phi_1 solves A cos t + B sin t = C.  The paper's J is 4 D, and its K is
4 cos(alpha) sin(alpha) cos(v) sin(phi_2) up to the signs of v and phi_2.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..decide import IDENTITY, Correction, as_convention, by_identity
from ..derive import TrigEquation, dihedral_form
from ..identities import to_circles, vanishes
from ..rotations import E1, E2, rational_pair, reflect, scale
from ..statement import WHOLE, formula, one_of, row
from ..symbols import ALPHA, HALF2, UPSILON, alpha, phi2, upsilon

J = sp.Symbol("J", nonnegative=True)
K = sp.Symbol("K", real=True)
CIRCLES = [ALPHA, HALF2, UPSILON]
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
BRANCH = row(*[row(*[formula(J, K, alpha, phi2)] * 2, one_of(2, -2))] * 2)
"""Form of a pair of lines, for phi_2 > 0 and phi_2 < 0."""


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
        CIRCLES,
        "J^2 = 16 (A^2 + B^2 - C^2): J real is exactly the existence condition.",
        Correction(
            r"\mathcal J=\sqrt{5-8\cos 2\upsilon+4\cos\phi_2-\cos 2\phi_2+8\cos 4\alpha\,"
            r"\sin^4\tfrac{\phi_2}{2}}=4\sqrt{\sin^2\upsilon-\sin^2 2\alpha\,"
            r"\sin^4\tfrac{\phi_2}{2}}",
            lambda: all(
                vanishes(r - 16 * equation().discriminant, CIRCLES)
                for r in (J_SQUARED_RIGHT, J_SQUARED_SHORT)
            ),
            "with cos(2 upsilon) in place of cos(upsilon) the radicand is 16 (A^2 + B^2 - C^2) "
            "identically, and it collapses to the short form.",
        ),
    )


def line_direction(
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


def line_gaps(lines: Any, order: str, branch: int, k_factor: Any = 1) -> list[Any]:
    """Residuals that vanish when both lines give branch * sign(v) of the derived solution."""
    eq = equation()
    gaps = []
    for fold_sign, line in zip((1, -1), lines, strict=True):
        for v_sign in (1, -1):
            x, y = line_direction(line, order, v_sign, fold_sign, k_factor)
            br = branch * v_sign
            # derived direction of t on branch br, with D = J/4
            cos_t = 4 * (eq.A * eq.C - br * eq.B * J / 4)
            sin_t = 4 * (eq.B * eq.C + br * eq.A * J / 4)
            sine = v_sign * UPSILON.s  # |sin v|, the positive factor between the two
            gaps += [x * sine - cos_t, y * sine - sin_t]
    return gaps


def _witness(branches: Any, order: str, k_factor: Any) -> Verdict:
    """Put phi_1 of the printed lines into A cos t + B sin t = C at exact points, 50 digits."""
    eq, t2, ta = equation(), sp.Rational(1, 2), sp.Rational(1, 3)
    tv = sp.Rational(2, 3)
    for i, lines in enumerate(branches, start=1):
        for fold_sign, line in zip((1, -1), lines, strict=True):
            point: dict[Any, Any] = {}
            for circ, t in ((ALPHA, ta), (HALF2, fold_sign * t2), (UPSILON, tv)):
                point[circ.c], point[circ.s] = rational_pair(t)
            root = 4 * sp.sqrt(eq.discriminant.xreplace(point))
            if not root.is_positive:
                raise AssertionError("the witness must be a regular point")
            x, y = (
                to_circles(e, CIRCLES).xreplace({**point, J: root})
                for e in line_direction(line, order, 1, fold_sign, k_factor)
            )
            a, b, c = (e.xreplace(point) for e in (eq.A, eq.B, eq.C))
            residual = sp.N((a * x + b * y) / sp.sqrt(x**2 + y**2) - c, 50)
            if abs(residual) > sp.Float("1e-40", 50):
                return Verdict(
                    "refuted",
                    "50-digit counterexample",
                    f"Branch {i}, tan(alpha/2) = {ta}, tan(phi_2/4) = {fold_sign * t2}, "
                    f"tan(upsilon/2) = {tv}: the printed phi_1 leaves A cos(phi_1/2) + B "
                    f"sin(phi_1/2) - C = {sp.N(residual, 15)}.",
                )
    return Verdict("unproved", "50-digit evaluation", "neither an identity nor refuted")


def _check_formula(statement: tuple[Any, Any, str, Any]) -> Verdict:
    """All four lines, both signs of v, with J the (right) square root."""
    first, second, order, k_factor = statement
    gaps = line_gaps(first, order, 1, k_factor) + line_gaps(second, order, -1, k_factor)
    if all(vanishes(g, CIRCLES) for g in gaps):
        verdict = Verdict(
            "proved",
            IDENTITY,
            "In each of the 2 x 2 x 2 sign cases |sin v| times the two arguments is 4 (A C -+ B D, "
            "B C +- A D): the printed lines are the two solutions of A cos t + B sin t = C, "
            "read as arctan(x, y).",
        )
    else:
        verdict = _witness((first, second), order, k_factor)
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
                vanishes(g, CIRCLES)
                for g in (
                    *line_gaps(BRANCH_1, "xy", 1),
                    *line_gaps(BRANCH_2, "xy", -1),
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


def _check_real(statement: Any) -> Verdict:
    """Existence condition of the derived equation against sin^2 v >= statement."""
    return by_identity(
        [equation().discriminant - (sp.sin(upsilon) ** 2 - statement)],
        CIRCLES,
        "A cos t + B sin t = C has real solutions exactly when A^2 + B^2 - C^2 = (J/4)^2 >= 0 "
        "(with the corrected J), that is |sin v| >= |sin 2 alpha| sin^2(phi_2/2).",
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
            (BRANCH_1[::-1], BRANCH_2, "xy", 1),
            (BRANCH_1, BRANCH_2, "xy", 2),
            (BRANCH_1, BRANCH_2, "xy", -1),
        ),
        corrected=(BRANCH_1, BRANCH_2, "xy", 1),
        form=row(BRANCH, BRANCH, one_of("xy", "yx"), WHOLE),
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
        corrected=J_SQUARED_RIGHT,
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
]
