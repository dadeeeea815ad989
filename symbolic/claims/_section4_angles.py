"""Section 4, partial and even fold angles of the cone; part of the claims of `section4_cone`."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..cone import (
    ALPHA_PAIR,
    COS_ALPHA,
    ELEVATION,
    SIN_ALPHA,
    azimuth,
    exact,
    identical,
    lift,
    mirror,
    root,
    separating_point,
    turn,
)
from ..decide import Correction, by_cases, refuted
from ..rotations import E1, Pair, cross, dot, reflect
from ..statement import Ratio, Table, formula
from ..symbols import alpha, upsilon

ROOTS = [(kind, side) for kind in ("valley", "mountain") for side in (1, -1)]
"""Kind of flap and sign of the elevation: the four cases of eq:partial-N."""

ON_RATIONAL_CONE = "identity in (cos v/2, sin v/2, tan(pi/4 - alpha/2)), all N at once"


def compare(
    name: str, pairs: list[tuple[Any, Any, int]], sketch: str, fix: Correction | None
) -> Verdict:
    """Proved when all pairs agree identically on the cone; else refuted at an exact point.

    pairs: (left, right, side); side = +1 or -1 says for which sign of v the pair was formed, 0 for
    both.
    """
    for left, right, side in pairs:
        if identical(left, right):
            continue
        point = separating_point(left, right, side)
        if point is None:
            return Verdict("unproved", ON_RATIONAL_CONE, f"{name}: neither proved nor refuted")
        return refuted(f"{name} fails at {point}.", "exact counterexample", fix)
    return Verdict("proved", ON_RATIONAL_CONE, sketch)


def condition(rho: tuple[Any, Any]) -> Any:
    """c_2 . (b_2 x e3): zero exactly when eq:rotation-reflection-condition holds for k = 2."""
    return dot(lift(azimuth(1), rho), mirror(1))


def _partial_equation(cos_rho: Any, sin_rho: Any) -> Any:
    """c_2 . n_2 / sin alpha = cos alpha cos v - cos alpha cos rho + sin alpha sin v sin rho."""
    return COS_ALPHA * (ELEVATION[0] - cos_rho) + SIN_ALPHA * ELEVATION[1] * sin_rho


_SIN, _COS = sp.sin(alpha), sp.cos(upsilon)
_PLUS = sp.acos(sp.Abs(_COS + _SIN) / (1 + _COS * _SIN))
_MINUS = sp.acos(sp.Abs(_COS - _SIN) / (1 - _COS * _SIN))
VALLEY = {1: _PLUS, -1: _MINUS}
MOUNTAIN = {1: -_MINUS, -1: -_PLUS}
_PLUS_FREE = sp.acos((_COS + _SIN) / (1 + _COS * _SIN))
_MINUS_FREE = sp.acos((_COS - _SIN) / (1 - _COS * _SIN))
VALLEY_CORRECTED = {1: _PLUS_FREE, -1: _MINUS_FREE}
MOUNTAIN_CORRECTED = {1: -_MINUS_FREE, -1: -_PLUS_FREE}
BOTH_SIDES = Table((1, -1), formula(alpha, upsilon))
"""Form of a formula for each sign of the elevation."""
_GRID = [
    (n, side * sp.pi * f)
    for n in (6, 8, 12)
    for side in (1, -1)
    for f in (
        sp.Rational(1, 12),
        sp.Rational(1, 6),
        sp.Rational(1, 3),
        sp.Rational(5, 12),
    )
]


def _bad_point(statement: dict[int, Any], sign: int) -> str | None:
    """A point with |v| < pi/2 where the printed angle breaks closure or has the wrong sign."""
    for n, v in _GRID:
        at = {alpha: 2 * sp.pi / n, upsilon: v}
        rho = sp.N(statement[1 if v > 0 else -1].subs(at), 50)
        gap = sp.N(
            (sp.cos(alpha) * (_COS - sp.cos(rho)) + _SIN * sp.sin(upsilon) * sp.sin(rho)).subs(at),
            50,
        )
        if abs(sp.im(rho)) > 0 or abs(gap) > sp.Rational(1, 10**40) or sign * rho <= 0:
            shown = sp.N(rho * 180 / sp.pi, 8)
            return (
                f"N = {n}, upsilon = {v}: rho = {shown} deg leaves c_2 . n_2 / sin(alpha) = "
                f"{sp.N(gap, 8)} (50 digits)"
            )
    return None


def arc_pair(term: Any, side: int) -> Pair | None:
    """(cos rho, sin rho) of rho = +-arccos(X / Y) for elevations of sign `side`, |v| < pi.

    None unless the term is one arccos without |.| and 1 - (X/Y)^2 = (cos alpha sin v / Y)^2, which is
    proved: the sign of arccos is then the sign of sin rho (cos alpha > 0 for N >= 6, Y > 0).
    """
    arcs = sp.sympify(term).atoms(sp.acos)
    if len(arcs) != 1:
        return None
    (arc,) = arcs
    sign = term / arc
    if sign not in (1, -1) or arc.args[0].has(sp.Abs):
        return None
    x = exact(arc.args[0])
    _, below = sp.fraction(arc.args[0])
    height = COS_ALPHA * ELEVATION[1] / exact(below)
    if not identical(x**2 + height**2, sp.Integer(1)):
        return None
    return (x, sign * side * height)


def _partial_proof(statement: dict[int, Any], sign: int) -> bool:
    """Exact: the printed arccos, with the sign of the flap, solve the condition on each side."""
    for side in (1, -1):
        pair = arc_pair(statement[side], side)
        if pair is None or not isinstance(sign * statement[side], sp.acos):
            return False
        if not identical(_partial_equation(*pair), sp.Integer(0)):
            return False
    return True


def check_partial(statement: dict[int, Any], sign: int) -> Verdict:
    """Decide one line of eq:partial-N over 0 < |v| <= pi/2, N >= 6."""
    if _partial_proof(statement, sign):
        return Verdict(
            "proved",
            ON_RATIONAL_CONE,
            "cos rho = X and sin rho = +-cos(alpha)|sin v|/Y satisfy the condition for 0 < |v| < pi.",
        )
    found = _bad_point(statement, sign)
    if found is None:
        return Verdict("unproved", ON_RATIONAL_CONE, "neither proved nor refuted")
    printed = (VALLEY, MOUNTAIN)[sign < 0]
    right = (VALLEY_CORRECTED, MOUNTAIN_CORRECTED)[sign < 0]
    name = ("v", "m")[sign < 0]
    fix = Correction(
        rf"\rho_{name}={'-' if sign < 0 else ''}\arccos"
        r"\frac{\cos\upsilon\pm\sin\alpha}{1\pm\cos\upsilon\sin\alpha}\ (\text{no modulus};\ +\text{ for }"
        + (r"\upsilon>0" if sign > 0 else r"\upsilon<0")
        + r"),\qquad \tan\tfrac{\rho}{2}=\tan\tfrac{\upsilon}{2}\tan(\tfrac{\pi}{4}-\tfrac{\alpha}{2})"
        r"\ \text{or}\ -\tan\tfrac{\upsilon}{2}\cot(\tfrac{\pi}{4}-\tfrac{\alpha}{2})",
        lambda: _partial_proof(right, sign) and both_roots(),
        "without the modulus the formula holds for all 0 < |v| < pi; with it, it holds up to contact "
        "|v| <= pi/2 (1 - 4/N) and then follows the wrong root (|rho| would turn back at pi/2).",
    )
    return refuted(
        f"Counterexample {found}.", "50-digit counterexample", fix if statement == printed else None
    )


def both_roots() -> bool:
    """Shallow and steep solve the condition identically."""
    return all(identical(condition(root(k, s)), sp.Integer(0)) for k, s in ROOTS)


def _check_root_count(statement: Any) -> Verdict:
    """Number of solutions rho_1 for given v: degree of the quadratic in tan(rho/2)."""
    t, h = sp.symbols("t h", real=True)
    cos_v, sin_v = (1 - h**2) / (1 + h**2), 2 * h / (1 + h**2)
    cos_r, sin_r = (1 - t**2) / (1 + t**2), 2 * t / (1 + t**2)
    equation = COS_ALPHA * (cos_v - cos_r) + SIN_ALPHA * sin_v * sin_r
    numerator = sp.Poly(sp.fraction(sp.together(equation))[0], t)
    roots = sp.roots(numerator)
    at_infinity = sp.cancel(COS_ALPHA * (cos_v + 1)) == 0  # rho = pi
    real = {sp.factor(r) for r in roots}
    count = len(real) + int(at_infinity)
    return by_cases(
        [
            (
                f"there are {count} solutions {sorted(map(str, real))} for tan(rho/2)",
                count == statement,
            )
        ],
        f"The condition is a quadratic in tan(rho/2) with the two distinct real roots "
        f"{sorted(map(str, real))}, h = tan(v/2); rho = pi solves it only at v = pi.",
        "polynomial roots",
    )


def normals_cosine(kind: str, side: int) -> Any:
    """n_1 . (sigma n_1) / |n_1|^2 with n_1 = c_1 x c_2 and sigma the mirror through crease 2."""
    rho = root(kind, side)
    n = cross(lift(E1, rho), lift(azimuth(1), rho))
    return dot(n, reflect(mirror(1), n)) / dot(n, n)


def _check_even_by_normals(statement: Any) -> Verdict:
    """phi_2 = f arccos(n_1 . sigma n_1 / |n_1|^2): f = `statement` against |phi_2| = 2 |v|."""
    factor = sp.Rational(statement)
    angle_is_2v = compare(
        "n_1 . sigma n_1 / |n_1|^2 = cos 2v",
        [(normals_cosine(k, s), exact(sp.cos(2 * upsilon)), s) for k, s in ROOTS],
        "n_1 . sigma n_1/|n_1|^2 = cos(2 v) on both roots, so arccos of it is |phi_2| = 2|v|.",
        None,
    )
    elevation = sp.pi / 5
    gap = factor * sp.acos(sp.cos(2 * elevation)) - 2 * elevation
    if angle_is_2v.verdict != "proved" or gap == 0:
        return angle_is_2v
    return refuted(
        f"n_1 . sigma n_1/|n_1|^2 = cos(2 upsilon) identically, so at upsilon = pi/5 the printed "
        f"angle is {factor * 2 * elevation} where |phi_2| = 2 pi/5.",
        "identity, then exact evaluation",
        Correction(
            r"|\phi_2|=\arccos\bigl(\mathbf{n}_1\cdot\boldsymbol{\sigma}\mathbf{n}_1"
            r"/|\mathbf{n}_1|^2\bigr)=2|\upsilon|",
            lambda: _check_even_by_normals(1).verdict == "proved",
            "the angle between the normals is |phi_2| itself; twice it would be 4|upsilon|, against "
            "the equation printed next.",
        )
        if factor == 2
        else None,
    )


def _check_even(statement: dict[str, Any]) -> Verdict:
    """The period closes: e3-turned fold pair is a rotation by 2 alpha, four sign cases.

    T = Q(b_1, 2 rho) Q(b_2, phi_2) Q(e3, 2 alpha) has quaternion scalar cos(alpha) exactly when the
    orbit of the flap closes on the lift q = +1.
    """
    pairs = []
    for kind, side in ROOTS:
        c, s = root(kind, side)
        half = (exact(sp.cos(statement[kind] / 2), side), exact(sp.sin(statement[kind] / 2), side))
        ca, sa = ALPHA_PAIR
        # (c, s e1)(ch, sh b_2) has scalar c ch - s sh cos(alpha) and e3 component s sh sin(alpha)
        scalar = (c * half[0] - s * half[1] * ca) * ca - s * half[1] * sa * sa
        pairs.append((scalar, ca, side))
        # and H n_2 = n_2 asks for the fold's half angle about b_2 (orientation, not only closure)
        back = turn(azimuth(1), half, mirror(1))
        pairs.append((lift(back, (c, s)), mirror(1), side))
    return compare(
        "closure with the printed phi_2",
        pairs,
        "Scalar part of Q(b_1, 2 rho) Q(b_2, phi_2) Q(e3, 2 alpha) is cos(alpha) and the mirror normal "
        "at crease 2 is mapped to itself, in all four cases (flap, sign of v).",
        None,
    )


def _check_limit(statement: tuple[Any, Any]) -> Verdict:
    """phi_1 and phi_2 for alpha -> 0 on both roots, statement = (phi_1, phi_2)/v on the shallow one."""
    a = sp.Symbol("a", positive=True)
    h = sp.Symbol("h", real=True)
    shallow = sp.limit(h * sp.cos(a) / (1 + sp.sin(a)), a, 0)
    steep = sp.limit(-h * (1 + sp.sin(a)) / sp.cos(a), a, 0)
    first, second = statement
    cases = [
        (f"shallow root: rho -> v (tan(rho/2) -> {shallow}), phi_1/v = {first}", first == 2),
        (f"steep root: rho -> -v (tan(rho/2) -> {steep})", shallow == h and steep == -h),
        (f"phi_2 = -phi_1: phi_2/v = {second} against -2", second == -2),
    ]
    return by_cases(
        cases,
        "tan(rho/2) -> +-tan(v/2), so rho -> +-v and phi_1 = 2 rho -> +-2 v exactly, linear in v for "
        "|v| < pi; phi_2 = -+2 v already for finite N.",
        "limit of a rational function of cos, sin alpha",
    )


ANGLE_CLAIMS: dict[str, Claim] = {
    c.id: c
    for c in (
        Claim(
            "s4.two-roots",
            "sec. 4, partial fold angle cases",
            "Two partial fold angles for each elevation",
            2,
            r"\rho_1(\upsilon)\in\{\rho_v(\upsilon),\rho_m(\upsilon)\}",
            _check_root_count,
            damaged=(1, 3),
        ),
        Claim(
            "s4.partial-valley",
            "sec. 4, eq:partial-valley-N",
            "Valley partial fold angle, |upsilon| <= pi/2",
            VALLEY,
            r"\rho_v=\arccos\frac{|\cos\upsilon+\sin\alpha|}{1+\cos\upsilon\sin\alpha}\ (\upsilon>0),\ "
            r"\arccos\frac{|\cos\upsilon-\sin\alpha|}{1-\cos\upsilon\sin\alpha}\ (\upsilon<0)",
            lambda s: check_partial(s, 1),
            damaged=({1: _MINUS, -1: _PLUS}, {1: _PLUS, -1: _PLUS}, {1: 2 * _PLUS, -1: _MINUS}),
            corrected=VALLEY_CORRECTED,
            form=BOTH_SIDES,
            root="modulus in the partial fold angles",
        ),
        Claim(
            "s4.partial-mountain",
            "sec. 4, eq:partial-mountain-N",
            "Mountain partial fold angle, |upsilon| <= pi/2",
            MOUNTAIN,
            r"\rho_m=-\arccos\frac{|\cos\upsilon-\sin\alpha|}{1-\cos\upsilon\sin\alpha}\ (\upsilon>0),\ "
            r"-\arccos\frac{|\cos\upsilon+\sin\alpha|}{1+\cos\upsilon\sin\alpha}\ (\upsilon<0)",
            lambda s: check_partial(s, -1),
            damaged=(VALLEY, {1: -_PLUS, -1: -_MINUS}, {1: _MINUS, -1: -_PLUS}),
            corrected=MOUNTAIN_CORRECTED,
            form=BOTH_SIDES,
            root="modulus in the partial fold angles",
        ),
        Claim(
            "s4.even-by-normals",
            "sec. 4, phi_2 from facet normals",
            "Even fold angle from the normals of two facets",
            2,
            r"\phi_2=2\arccos\bigl(\mathbf{n}_1\cdot(\boldsymbol{\sigma}_{\hat{b}_2\times\hat{e}_3}"
            r"\mathbf{n}_1)/|\mathbf{n}_1|^2\bigr)",
            _check_even_by_normals,
            damaged=(sp.Rational(1, 2), 4),
            corrected=1,
            form=Ratio(),
        ),
        Claim(
            "s4.even",
            "sec. 4, eq:cone-phi-even",
            "Even fold angle: twice the elevation, opposite parity",
            {"valley": -2 * sp.Abs(upsilon), "mountain": 2 * sp.Abs(upsilon)},
            r"\phi_2=-2|\upsilon|\ (\phi_1=2\rho_v),\quad 2|\upsilon|\ (\phi_1=2\rho_m)",
            _check_even,
            damaged=(
                {"valley": 2 * sp.Abs(upsilon), "mountain": -2 * sp.Abs(upsilon)},
                {"valley": -2 * upsilon, "mountain": 2 * upsilon},
                {"valley": -sp.Abs(upsilon), "mountain": sp.Abs(upsilon)},
            ),
            form=Table(("valley", "mountain"), formula(upsilon)),
        ),
        Claim(
            "s4.limit",
            "sec. 4, infinite creases",
            "N -> infinity: phi_1 -> +-2 upsilon, phi_2 = -phi_1, linear kinematics",
            (2, -2),
            r"\lim_{N\to\infty}\phi_1=\pm2\upsilon,\quad\phi_2=-\phi_1",
            _check_limit,
            damaged=((1, -1), (2, 2)),
        ),
    )
}
"""By id; `section4_cone.CLAIMS` puts them in the order of the paper."""
