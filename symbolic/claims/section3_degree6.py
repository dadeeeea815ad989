"""Section 3.1: geometry, closed form and branch of the degree-6 vertex, rest angles, stiffness."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..decide import Correction, by_cases, by_identity, refuted
from ..derive import reflection_form
from ..flat_folding import is_flat_foldable, kawasaki_sum
from ..groups import crease_images
from ..identities import circle, vanishes
from ..rotations import E1, E2, about, dot, reflect, scale
from ..statement import Maps, Ratio, Several, Text, That, formula, one_of, row
from ..symbols import ALPHA, HALF2, HALF3, alpha, phi2, phi3

NUMERATOR_6 = (
    sp.cos(alpha)
    * sp.sin(alpha)
    * (
        2 * sp.cos(alpha) ** 2 * sp.sin(phi3 / 2) ** 2 * (1 - 2 * sp.cos(phi2))
        - sp.sin(alpha) ** 2
        + sp.cos(phi3) * (1 - sp.cos(phi2) + sp.sin(alpha) ** 2)
        + sp.sin(phi2) * sp.sin(phi3)
    )
)
"""Y_6 as printed."""

DENOMINATOR_6 = sp.sin(alpha) * (
    sp.sin(phi2)
    + 2 * sp.cos(2 * alpha) * sp.sin(phi2) * sp.sin(phi3 / 2) ** 2
    + sp.cos(phi2) * sp.sin(phi3)
)
"""X_6 as printed."""

_CIRCLES = [ALPHA, HALF2, HALF3]


def half_form() -> Any:
    """The derived `ReflectionForm` of the paper's degree-6 vertex on the circles of the proofs."""
    c, s = ALPHA.pair
    return reflection_form([(c, s), (-c, s)], [HALF2.pair, HALF3.pair])


def _check_geometry(statement: tuple[Any, ...]) -> Verdict:
    """Azimuths from sector angles (alpha, pi - 2 alpha, alpha) and their mirror images."""
    total, rest = sp.Integer(0), []
    for sector in statement:
        total = total + sector
        rest.append(sp.expand(total))
    want = [alpha, sp.pi - alpha, sp.pi]
    b2 = (sp.cos(alpha), sp.sin(alpha), 0)
    b6 = reflect(E2, b2)
    mirrored = [b6[0] - sp.cos(-alpha), b6[1] - sp.sin(-alpha)]
    return by_cases(
        [
            ("creases 2, 3, 4 at alpha, pi - alpha, pi", rest == want),
            ("b_6 at azimuth -alpha", all(vanishes(m, [ALPHA]) for m in mirrored)),
            ("b_1 = -b_4", dot(E1, scale(-1, E1)) == -1),
        ],
        "Sector angles alpha, pi - 2 alpha, alpha add up to pi, so b_4 = -b_1, and the mirror "
        "e2 -> -e2 gives b_5 and b_6.",
        "exact",
    )


def _check_phi1(statement: tuple[Any, Any]) -> Verdict:
    """Put tan(phi_1/2) = (first argument)/(second) into c_4 . e2 = 0, exactly."""
    y, x = statement
    p = circle(sp.Symbol("p", real=True), "p")
    form = half_form()
    # c_4 . e2 = 0 is x_d sin p - y_d cos p = 0 with the derived pair (y_d, x_d)
    cross = form.first[1] * y - form.first[0] * x
    m = about((ALPHA.c, ALPHA.s, 0), HALF2.pair) * about((-ALPHA.c, ALPHA.s, 0), HALF3.pair)
    w = m.rotate(scale(-1, E1))
    c4 = w[1] * p.c - w[2] * p.s
    link = c4 + 2 * (form.first[1] * p.s - form.first[0] * p.c)
    return by_identity(
        [cross, link],
        [*_CIRCLES, p],
        "c_4 . e2 = -2 (x sin phi_1/2 - y cos phi_1/2) with (y, x) = (-Y_6, X_6)/2, so phi_1/2 = "
        "arctan(-Y_6, X_6) modulo pi solves it, for all alpha, phi_2, phi_3 with (X_6, Y_6) != 0.",
    )


def _check_branch(statement: int) -> Verdict:
    """How many of S_6 = +1 and -1 satisfy compatibility; they differ by 2 pi in phi_1."""
    y, x = sp.symbols("Y X", real=True, nonzero=True)
    plus, minus = sp.Matrix([x, -y]), sp.Matrix([-x, y])
    opposite = plus + minus == sp.zeros(2, 1)  # opposite points: arguments differ by exactly pi
    difference = 2 * sp.pi  # of 2 arctan, which f_phi removes
    turn = about(E1, (sp.cos(difference / 2), sp.sin(difference / 2)))
    same_rotation = (turn.w**2, turn.vector) == (1, (0, 0, 0))
    same_angle = opposite and same_rotation and difference + _paper_wrap(difference) == 0
    point = {alpha: sp.pi / 4, phi2: sp.pi / 2, phi3: sp.pi / 3}
    y0, x0 = (e.subs(point) for e in (NUMERATOR_6, DENOMINATOR_6))
    both = [sp.N(2 * sp.atan2(-sign * y0, sign * x0), 50) for sign in (1, -1)]
    shown = [sp.N(b, 20) for b in both]
    if not same_angle:
        return Verdict("unproved", "exact", "the two signs were not compared")
    if statement == 2:
        return Verdict("proved", "exact", "Both signs give the same phi_1 modulo 2 pi.")
    return refuted(
        "arctan(-S Y, S X) for S = +1 and -1 are opposite directions, so 2 arctan differs by "
        "exactly 2 pi and f_phi returns the same phi_1: both signs always satisfy compatibility, "
        f"and S_6 selects nothing.  At alpha = pi/4, phi_2 = pi/2, phi_3 = pi/3: {shown[0]} and "
        f"{shown[1]}, equal modulo 2 pi.",
        "exact",
        Correction(
            r"\phi_1=2\arctan(-\mathcal Y_6,\mathcal X_6),\ "
            r"\phi_4=2\arctan(\operatorname{Im}u\bar v,\operatorname{Re}u\bar v)\ (\mathrm{mod}\ "
            r"2\pi);\ \text{sheet of paper iff }\operatorname{Re}(uv)\operatorname{Re}(u\bar v)\ge0",
            _sheet_criterion,
            "what selects is the common parity of phi_1 and phi_4 (missing in the paper): wrapped "
            "into [-pi, pi] they close on quaternion +1 exactly when Re(uv) Re(u conj v) >= 0, and "
            "on -1, where no sheet of paper goes, otherwise.",
        ),
    )


def _sheet_criterion() -> bool:
    """(conj(uv) u conj(v)^-1 ..): e^{i(phi_1-phi_4)/2} u^2 has the sign of s_1 s_4 (identity)."""
    a, b, c, d = sp.symbols("a b c d", real=True)
    u, v = a + sp.I * b, c + sp.I * d
    # e^{i phi_1/2} = s_1 conj(uv)/|uv|, e^{-i phi_4/2} = s_4 conj(u conj v)/|uv|
    phase = sp.conjugate(u * v) * sp.conjugate(u * sp.conjugate(v))
    square = sp.expand(sp.expand(phase * u**2) - (a**2 + b**2) ** 2 * (c**2 + d**2))
    form = half_form()
    product = form.paper - (form.first[1] * form.last[1])
    return square == 0 and vanishes(product, _CIRCLES)


def _check_wrap(statement: Any) -> Verdict:
    """f_phi on k pi/6 for |k| <= 40, against the definition 'the representative in [-pi, pi]'."""

    def wrap(angle: Any) -> Any:
        while True:
            step = statement(angle)
            if step == 0:
                return angle
            angle = angle + step
            if abs(angle) > 11 * sp.pi:
                return None

    cases = []
    for k in range(-40, 41):
        angle = sp.pi * k / 6
        value = wrap(angle)
        ok = (
            value is not None
            and -sp.pi <= value <= sp.pi
            and ((value - angle) / (2 * sp.pi)) % 1 == 0
        )
        cases.append((f"angle {angle} goes to {value}", bool(ok)))
    return by_cases(
        cases,
        "Each step moves by 2 pi towards [-pi, pi], whose length is 2 pi, so the recursion ends "
        "inside and stays in the class modulo 2 pi.  (It loses the parity of the winding, which "
        "decides the sheet: see s3.branch-6.)",
        "induction, and 81 exact angles",
    )


def _paper_wrap(angle: Any) -> Any:
    return 2 * sp.pi if angle < -sp.pi else -2 * sp.pi if angle > sp.pi else 0


def _half_wrap(angle: Any) -> Any:
    return sp.pi if angle < -sp.pi else -sp.pi if angle > sp.pi else 0


def _reversed_wrap(angle: Any) -> Any:
    return -_paper_wrap(angle)


_MV_SMALL, _MV_LARGE = "MVVMVV", "VVMVMV"


def _check_rest(statement: tuple[str, str]) -> Verdict:
    """Kawasaki and a layer-order test (Big-Little-Big reduction) on both ranges of alpha_1."""
    small, large = statement
    cases: list[tuple[str, bool]] = [("Kawasaki for every alpha", kawasaki_sum() == 0)]
    for part in (sp.Rational(1, 12), sp.Rational(1, 4), sp.Rational(3, 10), sp.Rational(1, 3)):
        cases.append((f"{small} at alpha = {part} pi", is_flat_foldable(part, small)))
    for part in (sp.Rational(17, 50), sp.Rational(2, 5), sp.Rational(5, 12), sp.Rational(12, 25)):
        cases.append((f"{large} at alpha = {part} pi", is_flat_foldable(part, large)))
    cases.append(
        ("case 1 is not foldable beyond pi/3", not is_flat_foldable(sp.Rational(2, 5), small))
    )
    cases.append(
        ("case 2 is not foldable below pi/3", not is_flat_foldable(sp.Rational(1, 4), large))
    )
    return by_cases(
        cases,
        "alpha - (pi - 2 alpha) + alpha - alpha + (pi - 2 alpha) - alpha = 0 (Kawasaki).  The "
        "smallest sectors are alpha_1, alpha_3, alpha_4, alpha_6 for alpha < pi/3 and alpha_2, "
        "alpha_5 beyond; the crimping test compares only alpha with pi - 2 alpha, so one exact "
        "angle on each side and the tie at pi/3 decide each range.",
        "exact crimping algorithm",
    )


def _check_rest_symmetry(statement: tuple[tuple[int, str], ...]) -> Verdict:
    """Each assignment (n of D_n, letters of creases 1..N) must be constant on the group's orbits."""
    cases = []
    for n, letters in statement:
        images = crease_images(n, len(letters))
        same = all(letters[i] == letters[j] for p in images.values() for i, j in enumerate(p))
        cases.append((f"{letters} under D_{n}", same))
    return by_cases(
        cases,
        "Rest angles (and with them stiffnesses, which follow the letters) are equal on creases "
        "that the symmetry exchanges: assumption (c) of section 3 holds for all three patterns; "
        "the degree-8 one even has D_4.",
        "group orbits, enumerated",
    )


_RATIO = sp.Symbol("r_k", positive=True)


def _check_stiffness(statement: tuple[Any, Any]) -> Verdict:
    """k_m / k_v must be r_k."""
    k_m, k_v = (k(_RATIO) for k in statement)
    ratio = sp.powsimp(k_m / k_v)
    return by_cases(
        [
            (f"k_m/k_v = {ratio}", ratio == _RATIO),
            ("geometric mean fixed", sp.powsimp(k_m * k_v) == sp.Rational(1, 1600)),
        ],
        "0.025 sqrt(r) / (0.025 / sqrt(r)) = r, and the product stays 0.025^2.",
        "exact",
    )


def _k_m(r: Any) -> Any:
    return sp.Rational(1, 40) * sp.sqrt(r)


def _k_v(r: Any) -> Any:
    return sp.Rational(1, 40) / sp.sqrt(r)


CLAIMS: list[Claim] = [
    Claim(
        "s3.geometry-6",
        "sec. 3.1, degree-6 geometry",
        "Sector angles of the degree-6 vertex",
        (alpha, sp.pi - 2 * alpha, alpha),
        r"\alpha_3=\alpha_1,\ \alpha_2=\pi-2\alpha_1,\ \hat b_4=-\hat b_1",
        _check_geometry,
        damaged=((alpha, sp.pi / 2 - alpha, alpha),),
    ),
    Claim(
        "s3.phi1-6",
        "sec. 3.1, eq:phi1-6-fold",
        "Degree-6 closed form of phi_1",
        (-NUMERATOR_6, DENOMINATOR_6),
        r"\phi_1=f_\phi\bigl(2\arctan(-\mathcal S_6\mathcal Y_6,\mathcal S_6\mathcal X_6)\bigr)",
        _check_phi1,
        damaged=(
            (NUMERATOR_6, DENOMINATOR_6),
            (DENOMINATOR_6, -NUMERATOR_6),
            (-NUMERATOR_6.subs(phi2, phi3), DENOMINATOR_6),
            (-NUMERATOR_6, DENOMINATOR_6.subs(sp.cos(2 * alpha), sp.cos(alpha))),
        ),
    ),
    Claim(
        "s3.branch-6",
        "sec. 3.1, S_6 = +-1",
        "Only one sign of S_6 satisfies compatibility",
        1,
        r"\text{of } \mathcal S_6=\pm1 \text{ only one satisfies compatibility}",
        _check_branch,
        damaged=(0,),
        corrected=2,
        form=one_of(0, 1, 2),
    ),
    Claim(
        "s3.wrap",
        "sec. 3.1, f_phi",
        "f_phi brings an angle into [-pi, pi]",
        _paper_wrap,
        r"f_\phi(\gamma)\in[-\pi,\pi],\ f_\phi(\gamma)\equiv\gamma\ (\mathrm{mod}\ 2\pi)",
        _check_wrap,
        damaged=(_half_wrap, _reversed_wrap),
        form=Maps((sp.pi / 6,), formula()),
    ),
    Claim(
        "s3.rest-6",
        "sec. 3.1, rest fold angles",
        "Rest assignments follow flat foldability",
        (_MV_SMALL, _MV_LARGE),
        r"MVVMVV\ (\alpha_1\le\pi/3),\quad VVMVMV\ (\alpha_1>\pi/3)",
        _check_rest,
        damaged=((_MV_LARGE, _MV_SMALL), ("MVVVVV", _MV_LARGE), (_MV_SMALL, "MVMVMV")),
        form=row(*[Text("[MV]{6}", "6 letters M or V")] * 2),
    ),
    Claim(
        "s3.rest-symmetry",
        "sec. 3, assumption (c); rest angles of sec. 3.1 and 3.2",
        "Rest angles and stiffnesses share the symmetry",
        ((1, _MV_SMALL), (1, _MV_LARGE), (2, "MVMVMVMV")),
        r"\phi^0_{g(i)}=\phi^0_i,\ k_{g(i)}=k_i\quad\forall g\in\mathcal G",
        _check_rest_symmetry,
        damaged=(((1, "MVVMVM"),), ((2, "MVMVVMVM"),)),
        form=Several(
            That(
                row(Ratio(1, least=1), Text("[MV]+", "letters M or V")),
                lambda pair: len(pair[1]) % (2 * pair[0]) == 0,
                "a group D_n with a multiple of 2 n letters",
            )
        ),
    ),
    Claim(
        "s3.stiffness",
        "sec. 3.1 and 3.2, crease stiffnesses",
        "k_m / k_v = r_k",
        (_k_m, _k_v),
        r"k_m=0.025\sqrt{r_k},\ k_v=0.025/\sqrt{r_k},\ r_k=k_m/k_v",
        _check_stiffness,
        damaged=((_k_v, _k_m), (_k_m, _k_m)),
        form=row(*[Maps((_RATIO,), formula(_RATIO))] * 2),
    ),
]
