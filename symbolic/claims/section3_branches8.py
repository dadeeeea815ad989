"""Section 3.2: domain, range, branches, odd symmetry and boundary of the degree-8 formula."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import mpmath
import sympy as sp

from ..claim import Claim, Verdict
from ..claims.section3_degree6 import CLAIMS as DEGREE_6
from ..claims.section3_degree8 import (
    BRANCH,
    BRANCH_1,
    BRANCH_2,
    CIRCLES,
    J_SQUARED_SHORT,
    J,
    K,
    equation,
    line_direction,
    line_gaps,
)
from ..decide import IDENTITY, Correction, by_cases, refuted
from ..derive import dihedral_form
from ..identities import to_circles, vanishes
from ..statement import Maps, Ratio, Several, Subset, That, formula, one_of, row
from ..symbols import ALPHA, HALF2, UPSILON, alpha, phi2, upsilon


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


_HALF = sp.Rational(1, 2)
_CHART = sp.Interval(-sp.pi, sp.pi)
_CASES = sp.Union(sp.Interval.Lopen(0, sp.pi), sp.Interval.Ropen(-sp.pi, 0))
"""Where phi_2 > 0 or phi_2 < 0, within the chart."""


def _check_domain(statement: sp.Set) -> Verdict:
    """Whether the printed lines give phi_1 for every phi_2 of the set `statement`.

    A line is chosen by phi_2 > 0 or phi_2 < 0 and has a value where tan(phi_2/2) has one.  States
    exist over every phi_2: at upsilon = pi/2 the radicand is 1 - sin^2(2 alpha) sin^4(phi_2/2) >= 0.
    """
    poles = sp.FiniteSet(-sp.pi, sp.pi)  # of tan(phi_2/2)
    domain = _CASES - poles
    at_zero = [
        sp.expand(sp.sympify(e).subs({HALF2.c: 1, HALF2.s: 0}))
        for e in (equation().A, equation().B, equation().C)
    ]
    phi1_zero = at_zero[0] == 0 and at_zero[2] == 0 and vanishes(at_zero[1] - UPSILON.s, CIRCLES)
    wedge = dihedral_form(2, [ALPHA.pair], [(sp.Integer(1), sp.Integer(0))], UPSILON.pair)
    sin_q, cos_q = wedge.last(1, 0)  # phi_3/2 at phi_2 = 0, phi_1 = 0
    book = vanishes(sin_q + UPSILON.s, CIRCLES) and vanishes(cos_q - UPSILON.c, CIRCLES)
    gaps = [*line_gaps(BRANCH_1, "xy", 1), *line_gaps(BRANCH_2, "xy", -1)]
    if not all(vanishes(g, CIRCLES) for g in gaps):
        return Verdict("unproved", IDENTITY, "the printed lines are not the derived branches")
    if statement.is_subset(domain):
        return Verdict("proved", IDENTITY, "There one line applies, and it is the derived branch.")
    missing = statement - domain
    points = [str(p) for p in (-sp.pi, sp.Integer(0), sp.pi) if missing.contains(p) == sp.true]
    return refuted(
        f"No line gives phi_1 at phi_2 = {', '.join(points)}.  At 0 no case applies, although the "
        "vertex folds there (the book fold about creases 3 and 7, phi_1 = 0, phi_3 = -2 upsilon, any "
        "elevation); at +-pi the factor tan(phi_2/2) is infinite and meets K = 0.",
        "exact evaluation",
        Correction(
            r"\phi_2=0:\ \phi_1=0,\ \phi_3=-2\upsilon,\ \upsilon\ \text{free};\qquad \text{no case distinction in }"
            r"\phi_1=2\operatorname{atan2}(BC\pm AD,\,AC\mp BD)",
            lambda: phi1_zero and book,
            "at phi_2 = 0 the equation reads sin(v) sin t = 0, so phi_1 = 0 modulo 2 pi; at "
            "phi_2 = 0 = upsilon all coefficients vanish: phi_1 is free (book fold about crease 1).",
        )
        if statement == _CHART
        else None,
    )


_TWO_TURNS = sp.Interval(-2 * sp.pi, 2 * sp.pi)


def _check_range(statement: sp.Set) -> Verdict:
    """Whether all values of +-2 arctan(...) lie in the set `statement`."""
    if _TWO_TURNS.is_subset(statement):
        return Verdict(
            "proved", "range of arctan", "arctan(y, x) lies in (-pi, pi]; the factor is +-2."
        )
    with mpmath.workdps(60):
        a, v, p = mpmath.pi / 4, mpmath.pi / 3, mpmath.pi / 2
        for sign in (1, -1):
            value = _numeric(BRANCH_1, a, sign * v, sign * p)
            if statement.contains(sp.Float(str(value), 50)) == sp.false:
                break
        else:
            return Verdict("unproved", "50-digit evaluation", "no value outside was found")
        shown = mpmath.nstr(value, 30)
    at = "" if sign > 0 else "-"
    return refuted(
        f"At alpha = pi/4, upsilon = {at}pi/3, phi_2 = {at}pi/2 the first branch gives phi_1 = "
        f"{shown} (50-digit arithmetic), outside {statement}: f_phi of section 3.1 is missing.",
        "50-digit counterexample",
        Correction(
            r"\pm2\arctan(\cdot,\cdot)\in[-2\pi,2\pi],\quad \phi_1=f_\phi\bigl(\pm2\arctan(\cdot,"
            r"\cdot)\bigr)",
            lambda: (
                all(vanishes(g, CIRCLES) for g in line_gaps(BRANCH_1, "xy", 1))
                and _wrap_verdict().verdict == "proved"
            ),
            "2 arctan is defined modulo 2 pi only, so f_phi may and must be applied.",
        )
        if statement == _CHART
        else None,
    )


def _wrap_verdict() -> Verdict:
    """What f_phi does to any angle: claim s3.wrap, decided anew."""
    (wrap,) = (c for c in DEGREE_6 if c.id == "s3.wrap")
    return wrap.decide()


def _check_k(statement: Any) -> Verdict:
    """K written out in the four sign cases of upsilon and phi_2, |alpha| < pi/2."""
    sines = 4 * sp.sin(upsilon) * sp.sin(phi2) * sp.cos(alpha) * sp.sin(alpha)
    cases = []
    for v_sign in (1, -1):
        for fold_sign in (1, -1):
            printed = v_sign * fold_sign * sines * sp.cos(upsilon) / sp.sin(upsilon)
            given = statement(v_sign, fold_sign)
            name = (
                f"upsilon {'>' if v_sign > 0 else '<'} 0, phi_2 {'>' if fold_sign > 0 else '<'} 0"
            )
            cases.append((name, vanishes(printed - given, CIRCLES)))
    return by_cases(
        cases,
        "|sin v| cot v = sgn(v) cos v: K = 2 sin(2 alpha) |sin phi_2| cos(v) sgn(v).  At upsilon = 0 "
        "the printed product is 0 times infinity with different limits from the two sides, but "
        "there J is real only for sin(2 alpha) sin^2(phi_2/2) = 0, where K = 0.",
        "identity modulo c^2+s^2-1, four sign cases",
    )


def _short_k(v_sign: int, fold_sign: int) -> Any:
    return 2 * sp.sin(2 * alpha) * fold_sign * sp.sin(phi2) * sp.cos(upsilon) * v_sign


def _even_k(v_sign: int, fold_sign: int) -> Any:
    return _short_k(1, fold_sign)


def _half_k(v_sign: int, fold_sign: int) -> Any:
    return _short_k(v_sign, fold_sign) / 2


_LINES = (
    *((line, sign) for line, sign in zip(BRANCH_1, (1, -1), strict=True)),
    *((line, sign) for line, sign in zip(BRANCH_2, (1, -1), strict=True)),
)
"""The four printed lines from top to bottom, each with the sign of phi_2 it is printed for."""


def _branch_of(line: Any, fold_sign: int) -> int:
    """Derived branch (+1 or -1, times sgn upsilon) that one printed line gives."""
    eq = equation()
    for branch in (1, -1):
        gaps: list[Any] = []
        for v_sign in (1, -1):
            x, y = line_direction(line, "xy", v_sign, fold_sign, 1)
            # A cos t + B sin t = C has (A C - B D, B C + A D) as directions of (cos t, sin t), D = +- the root
            root, sine = branch * v_sign * J / 4, v_sign * UPSILON.s
            gaps += [x * sine - 4 * (eq.A * eq.C - eq.B * root)]
            gaps += [y * sine - 4 * (eq.B * eq.C + eq.A * root)]
        if all(vanishes(g, CIRCLES) for g in gaps):
            return branch
    raise ValueError("a line that gives no branch")


def _check_labels(statement: tuple[tuple[int, ...], ...]) -> Verdict:
    """Whether these groups of the four printed lines are the two branches.

    statement: groups of line numbers 1..4, from top to bottom.
    """
    branch = {i: _branch_of(*line) for i, line in enumerate(_LINES, start=1)}
    found = [{branch[i] for i in group} for group in statement]
    if all(len(b) == 1 for b in found) and {min(b) for b in found} == {1, -1} and len(found) == 2:
        return Verdict(
            "proved", IDENTITY, "Each group gives one solution of A cos t + B sin t = C."
        )
    for group in statement:
        twice = {_LINES[i - 1][1] for i in group}
        if len({branch[i] for i in group}) > 1:
            evidence = (
                f"Lines {group} give different branches"
                + (f", all for phi_2 {'>' if twice == {1} else '<'} 0" if len(twice) == 1 else "")
                + "."
            )
            break
    else:
        evidence = f"{len(found)} groups for two branches."
    return refuted(
        f"{evidence}  The inner cases are phi_2 > 0 and phi_2 < 0: both lines of one outer case give "
        "the same branch, and for a given phi_2 only one of them applies.",
        IDENTITY,
        Correction(
            r"\text{the two OUTER cases are the branches }\pm\operatorname{sgn}\upsilon;\ "
            r"\text{the inner ones are the signs of }\phi_2",
            lambda: _check_labels(_OUTER).verdict == "proved",
            "the outer cases are the two solutions of A cos t + B sin t = C.",
        )
        if statement == _INNER
        else None,
    )


_INNER, _OUTER = ((1, 3), (2, 4)), ((1, 2), (3, 4))
"""Lines grouped by the inner case (sign of phi_2), and by the outer case."""


def _check_odd(statement: tuple[Any, Any]) -> Verdict:
    """Branch `statement[1]` at (-v, -phi_2) must be minus branch `statement[0]` at (v, phi_2)."""
    source, image = statement
    gaps = []
    for fold_sign in (1, -1):
        for v_sign in (1, -1):
            line = source[0] if fold_sign > 0 else source[1]
            other = image[1] if fold_sign > 0 else image[0]
            x, y = line_direction(line, "xy", v_sign, fold_sign, 1)
            a, b = line_direction(other, "xy", -v_sign, -fold_sign, 1)
            # (v, phi_2) -> (-v, -phi_2): sines change their sign
            flip = {HALF2.s: -HALF2.s, UPSILON.s: -UPSILON.s}
            a, b = (to_circles(e, CIRCLES).subs(flip, simultaneous=True) for e in (a, b))
            x, y = (to_circles(e, CIRCLES) for e in (x, y))
            gaps += [x - a, y + b]
    if all(vanishes(g, CIRCLES) for g in gaps):
        return Verdict(
            "proved", IDENTITY, "Each argument pair maps to its mirror image (x, -y), all signs."
        )
    with mpmath.workdps(60):
        a_, v_, p_ = mpmath.pi / 5, mpmath.mpf(1) / 2, mpmath.mpf(1) / 2
        one, two = _numeric(source, a_, v_, p_), -_numeric(image, a_, -v_, -p_)
        turns = (one - two) / (2 * mpmath.pi)
        if abs(turns - mpmath.nint(turns)) < mpmath.mpf(10) ** -40:
            return Verdict("unproved", "50-digit evaluation", "neither an identity nor refuted")
        same = mpmath.nstr(-_numeric(source, a_, -v_, -p_), 20)
        shown = mpmath.nstr(one, 20), mpmath.nstr(two, 20)
    return refuted(
        f"At alpha = pi/5, upsilon = phi_2 = 1/2 the branch gives {shown[0]}; minus the other "
        f"branch at (-1/2, -1/2) is {shown[1]}, minus the same branch there is {same}.",
        "50-digit counterexample",
        Correction(
            r"\phi_1^{(i)}(-\upsilon,-\phi_2)=-\phi_1^{(i)}(\upsilon,\phi_2),\quad i=1,2",
            lambda: all(_check_odd((b, b)).verdict == "proved" for b in (BRANCH_1, BRANCH_2)),
            "as printed (|sin upsilon| in K) each branch is odd by itself: flipping the vertex "
            "maps it to the SAME branch; the two branches are different shapes and meet where "
            "J = 0.  (Call the inner cases branches, as s3.branches-8 does, and the sentence holds: the "
            "line for phi_2 < 0 is the line for phi_2 > 0 flipped over.)",
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


def _check_slope(statement: tuple[Any, ...]) -> Verdict:
    """Whether the boundary sin v = sin(2 alpha) sin^2(phi_2/2) gets steeper in this order of alpha.

    statement: sector angles in units of pi.
    """
    v = sp.asin(sp.sin(2 * alpha) * sp.sin(phi2 / 2) ** 2)
    on_boundary = sp.expand(J_SQUARED_SHORT.subs(sp.sin(upsilon), sp.sin(v)))
    curvature = sp.diff(v, phi2, 2).subs(phi2, 0)
    values = [sp.radsimp(curvature.subs(alpha, sp.pi * r)) for r in statement]
    increasing = all(bool(a < b) for a, b in pairwise(values))
    # dv/dphi_2 = sin(2a) sin(phi_2)/2 / sqrt(1 - sin^2(2a) s^4) grows with sin(2a): derivative > 0
    g, s4 = sp.symbols("g s4", positive=True)
    # slope^2 but for a factor without g = sin 2 alpha; it grows with g where this derivative is positive
    squared = sp.diff(g**2 / (1 - g**2 * s4), g)
    growth = sp.cancel(squared * (1 - g**2 * s4) ** 2 / (2 * g) - 1)
    return by_cases(
        [
            ("the curve lies on J = 0", sp.expand(on_boundary) == 0),
            ("slope grows with sin 2 alpha", growth == 0),
            (f"curvatures at the flat state {values} increase", increasing),
        ],
        f"J = 0 is sin v = sin(2 alpha) sin^2(phi_2/2) for v > 0; its slope sin(2 alpha) "
        f"sin(phi_2)/(2 cos v) grows with alpha up to pi/4, with curvature {values} at the flat "
        "state for pi/12, pi/6, pi/4 (beyond pi/4 it falls again; at phi_2 = 0 itself it is 0).",
        "exact differentiation",
    )


CLAIMS: list[Claim] = [
    Claim(
        "s3.K",
        "sec. 3.2, definition of K",
        "K without modulus and cotangent",
        _short_k,
        r"\mathcal K=4|\cos\alpha\sin\upsilon\sin\phi_2|\sin\alpha\cot\upsilon"
        r"=2\sin 2\alpha\,|\sin\phi_2|\cos\upsilon\,\operatorname{sgn}\upsilon",
        _check_k,
        damaged=(_even_k, _half_k),
        form=Maps((1, -1), formula(alpha, phi2, upsilon)),
        origin="own derivation",
    ),
    Claim(
        "s3.domain-8",
        "sec. 3.2, cases phi_2 > 0 and phi_2 < 0",
        "The printed cases cover the chart",
        _CHART,
        r"\phi_2>0\ \text{or}\ \phi_2<0\quad\text{for every state, }\phi_2\in[-\pi,\pi]",
        _check_domain,
        damaged=(sp.Interval.Ropen(0, sp.pi), _CASES, sp.Interval.open(-sp.pi, sp.pi)),
        corrected=_CASES - sp.FiniteSet(-sp.pi, sp.pi),
        form=That(Subset(_CHART), lambda s: s.measure > 0, "a set with an interval in it"),
    ),
    Claim(
        "s3.range-8",
        "sec. 3.2, range of phi_1",
        "phi_1 = 2 arctan lies in [-pi, pi]",
        _CHART,
        r"\pm2\arctan(\cdot,\cdot)\in[-\pi,\pi]",
        _check_range,
        damaged=(sp.Interval(-sp.pi / 2, sp.pi / 2), sp.Interval(0, sp.pi)),
        corrected=_TWO_TURNS,
        form=Subset(sp.S.Reals),
    ),
    Claim(
        "s3.branches-8",
        "sec. 3.2, 'the two inner cases represent two branches'",
        "The inner cases are the branches",
        _INNER,
        r"\text{two inner cases}=\text{two branches}",
        _check_labels,
        damaged=(((1, 4), (2, 3)), ((1,), (2, 3, 4))),
        corrected=_OUTER,
        form=That(
            Several(Several(one_of(1, 2, 3, 4))),
            lambda groups: sorted(i for g in groups for i in g) == [1, 2, 3, 4],
            "groups with each of the lines 1..4 once",
        ),
        root="inner and outer cases",
    ),
    Claim(
        "s3.odd-symmetry",
        "sec. 3.2, odd symmetry of the branches",
        "The second branch is the first one flipped over",
        (BRANCH_1, BRANCH_2),
        r"\phi_1^{(2)}(-\upsilon,-\phi_2)=-\phi_1^{(1)}(\upsilon,\phi_2)",
        _check_odd,
        damaged=((BRANCH_2, BRANCH_1),),
        corrected=(BRANCH_2, BRANCH_2),
        form=row(BRANCH, BRANCH),
        root="inner and outer cases",
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
        tuple(sp.Rational(1, n) for n in (12, 6, 4)),
        r"\text{slope of }\mathcal J=0\text{ at }\alpha_1=\pi/12<\pi/6<\pi/4\text{ increases}",
        _check_slope,
        damaged=(
            tuple(sp.Rational(1, n) for n in (4, 6, 12)),
            tuple(sp.Rational(1, n) for n in (12, 4, 6)),
        ),
        form=row(*[That(Ratio(), lambda r: 0 < r < _HALF, "a rational between 0 and 1/2")] * 3),
    ),
]
