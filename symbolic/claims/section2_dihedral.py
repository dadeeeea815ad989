"""Section 2, second part: reflection-rotation symmetry, elevation, wedge closure, counts."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..cone import multiple
from ..decide import Correction, as_convention, by_cases, by_identity, refuted
from ..groups import crease_images, generate, symmetric_dimension
from ..identities import circle, vanishes
from ..rotations import (
    E1,
    E2,
    E3,
    Quaternion,
    about,
    cross,
    dot,
    planar,
    reflect,
)
from ..statement import Ratio, formula, has, row
from ..symbols import generic_fold, upsilon

_H = sp.Symbol("h", positive=True)
_N, _M = sp.symbols("N m", positive=True)
_MIRROR = circle(sp.Symbol("beta", real=True), "beta")
"""Azimuth beta = pi/n of the wedge's second mirror."""


def _check_group(statement: Any) -> Verdict:
    """Generate <mirror, rotation by pi/h> for h = 1..8 and count it."""
    cases = []
    for h in range(1, 9):
        n = sp.sympify(statement).subs(_H, h)
        # generated from one mirror and one turn: 2 h turns and 2 h mirrors
        order = 2 * h  # rotations by pi/h are rotations by 2 pi/(2h)
        group = generate([(1, 0), (0, 1)], order)
        cases.append(
            (
                f"h = {h}: the group has {len(group)} elements, D_{n} has {2 * n}",
                len(group) == 2 * n,
            )
        )
    return by_cases(
        cases,
        "A rotation by pi/h has order 2h and the mirror inverts it, so the group has 4h elements: "
        "D_{2h} with mirrors at multiples of pi/(2h).",
        "group presentation, enumerated",
    )


def _check_next_mirror(statement: Any) -> Verdict:
    """Mirror through the crease at `statement` times the rotation angle, as a group element."""
    half = circle(sp.Symbol("varphi", real=True) / 2, "half")
    turn = multiple(half.pair, int(2 * statement))
    normal = cross(planar(turn), E3)
    rotation = about(E3, half.pair)  # rotation by varphi
    residuals = []
    for e in (E1, E2, E3):
        left = reflect(normal, e)
        right = rotation.rotate(reflect(E2, e))
        residuals += [a - b for a, b in zip(left, right, strict=True)]
    return by_identity(
        residuals,
        [half],
        "The mirror through the crease at azimuth varphi/2 equals Q(e3, varphi) sigma_{e2}, a group "
        "element; no mirror lies in between.",
    )


def _check_elevation(statement: Any) -> Verdict:
    """Height of crease 1 after Q(e2, upsilon), with the rotation sense that makes valleys > 0."""
    half = circle(upsilon / 2, "half")
    height = dot(E3, about(E2, half.pair).rotate(E1))
    verdict = by_identity([height - statement], [half], "Crease 1 rises by sin(upsilon).")
    if statement != sp.sin(upsilon):
        return verdict
    return as_convention(
        verdict,
        "With the right-handed rotations that make phi > 0 a valley, Q(e2, upsilon) LOWERS crease 1 "
        "for upsilon > 0; 'elevate' and 'above the flat state' are right only for the vertex point "
        "relative to the rim, or with left-handed rotations, which would make phi > 0 a mountain.",
        Correction(
            r"\hat{c}_1\cdot\hat{e}_3=-\sin\upsilon",
            lambda: vanishes(height + sp.sin(upsilon), [half]),
            "e3 . Q(e2, upsilon) e1 = -sin(upsilon), identically.",
        ),
    )


def _check_wedge_convention(statement: Quaternion) -> Verdict:
    """Crease 1 must stay in its mirror plane e2 = 0 and turn by the elevation."""
    fold = generic_fold("1")
    half = circle(upsilon / 2, "half")
    first = (statement * about(E1, fold.pair)).rotate(E1)
    residuals = [first[1], first[0] - sp.cos(upsilon), first[2] + sp.sin(upsilon)]
    return by_identity(
        residuals,
        [fold, half],
        "Q(e2, upsilon) Q(b_1, phi_1/2) leaves crease 1 in the mirror plane, turned by upsilon.",
    )


_ELEVATE = about(E2, (sp.cos(upsilon / 2), sp.sin(upsilon / 2)))
_ELEVATE_E1 = about(E1, (sp.cos(upsilon / 2), sp.sin(upsilon / 2)))


_CX, _CY, _BX, _BY = sp.symbols("c_x c_y b_x b_y", real=True)
RATIO = (_CY / _CX - _BY / _BX, sp.Integer(0))
HALF_PLANE = (_CX * _BY - _CY * _BX, _CX * _BX + _CY * _BY)
"""(must vanish, must not be negative) for crease k in its mirror: as printed, and corrected."""


def _check_ratio(statement: tuple[Any, Any]) -> Verdict:
    """Whether the condition says 'c_k in the mirror half-plane through b_k' for every h >= 1.

    statement: (what must vanish, what must not be negative) in the components of c_k and b_k.
    """
    zero, sign = (sp.sympify(e) for e in statement)
    # three places for c_k: in the half plane of the mirror, in the opposite one, and normal to it
    far = sp.Symbol("lambda", positive=True)  # c_k = (lambda b_k, height) or on the other side
    broken = []
    for h in range(1, 7):
        b = {_BX: sp.cos(sp.pi / (2 * h)), _BY: sp.sin(sp.pi / (2 * h))}
        at = {side: {_CX: side * far * b[_BX], _CY: side * far * b[_BY]} for side in (1, -1)}
        aside = {_CX: -far * b[_BY], _CY: far * b[_BX]}
        inside = [sp.radsimp(e.subs({**b, **at[1]})) for e in (zero, sign)]
        if any(e.has(sp.nan, sp.zoo) for e in inside):
            broken.append(f"h = {h}: no value at b_k = ({b[_BX]}, {b[_BY]})")
            continue
        if not (inside[0] == 0 and inside[1].is_nonnegative):
            broken.append(f"h = {h}: not satisfied in the half-plane through b_k")
        back = [sp.radsimp(e.subs({**b, **at[-1]})) for e in (zero, sign)]
        if back[0] == 0 and back[1].is_negative is not True:
            broken.append(f"h = {h}: satisfied in the opposite half-plane as well")
        if sp.radsimp(zero.subs({**b, **aside})) == 0:
            broken.append(f"h = {h}: satisfied normal to b_k as well")
    if not broken:
        return Verdict(
            "proved",
            "exact evaluation, h = 1..6",
            "Holds where c_k = (lambda b_k, height), lambda > 0, fails for lambda < 0 and beside "
            "the plane.",
        )
    return refuted(
        f"{broken[0]}" + (f"; {broken[1]}" if len(broken) > 1 else "") + ".",
        "exact evaluation",
        Correction(
            r"\hat{c}_k\cdot(\hat{b}_k\times\hat{e}_3)=0,\qquad \hat{c}_k\cdot\hat{b}_k\ge 0",
            lambda: _check_ratio(HALF_PLANE).verdict == "proved" and _orbit_closes(),
            "for h = 1, the degree-8 vertex of section 3.2, b_k = e2 and the printed right-hand side "
            "is 1/0; in the opposite half-plane, which the ratio admits for every h, mirror images "
            "cross.  Cleared of denominators the condition is c_k . (b_k x e3) = 0, which closes the "
            "orbit of the wedge (claim s2.orbit), and the sign keeps crease k on its own side.",
        )
        if statement == RATIO
        else None,
    )


def _orbit_closes() -> bool:
    """Sector = wedge and its image; (sector . Q(e3, 2 pi/n)) is h n_k h^-1 n_1 as quaternions."""
    w, x, y, z = sp.symbols("h_w h_x h_y h_z", real=True)
    h = Quaternion(w, x, y, z)
    bx, by = _MIRROR.pair
    n1, nk = Quaternion(0, 0, 1, 0), Quaternion(0, by, -bx, 0)
    turn = (nk * n1).expand()
    rotation = about(E3, _MIRROR.pair)
    mirrored = nk * h.inverse * nk.inverse  # sigma_k h^-1 sigma_k
    left = h * mirrored * turn
    right = h * nk * h.inverse * n1
    gaps = [
        *(a - b for a, b in zip((left.w, *left.vector), (right.w, *right.vector), strict=True)),
        turn.w - rotation.w,
        turn.x,
        turn.y,
        turn.z - rotation.z,
        right.w + dot((0, 1, 0), h.rotate(nk.vector)),
    ]
    return all(vanishes(g, [_MIRROR]) for g in gaps)


def _check_orbit(statement: int) -> Verdict:
    """Statement: the sign in n_1 . H n_k = sign * n_1 . n_k that must give quaternion +1."""
    if not _orbit_closes():
        return Verdict("unproved", "quaternion identity", "sector identity fails")
    cases = []
    for n in range(2, 13):
        # T = h n_k h^-1 n_1 has scalar part -n_1.Hn_k = statement * cos(pi/n); T^n must be -1
        # because Q(e3, 2 pi/n)^n is the quaternion -1 of a full turn.
        theta = sp.acos(statement * sp.cos(sp.pi / n))
        cases.append(
            (
                f"n = {n}: total quaternion {-sp.cos(n * theta)} instead of 1",
                sp.cos(n * theta) == -1 and sp.sin(n * theta) == 0,
            )
        )
    return by_cases(
        cases,
        "One sector times Q(e3, 2 pi/n) is T = h n_k h^-1 n_1 with scalar part -n_1 . H n_k; when "
        "that is cos(pi/n), T^n = -1 and the product over the vertex is +1: the orbit of the wedge "
        "closes on the sheet of paper.  c_k . n_k = 0 with crease k's half facet facing its mirror "
        "is the same equation in the elevation chart.",
        "quaternion identity; n = 2..12 for the power",
    )


def _check_assignment(statement: tuple[int, ...]) -> Verdict:
    """Statement: (offsets) phi_{k+1} = phi_{k-1+a}, phi_{2k-1} = phi_{1+b}, phi_{2k} = phi_{2+c}."""
    a, b, c = statement
    cases = []
    for n in range(2, 9):
        for wedge in range(1, 7):
            degree, k = 2 * n * wedge, wedge + 1
            images = crease_images(n, degree)

            def same(i: int, j: int, images: Any = images, degree: int = degree) -> bool:
                i, j = (i - 1) % degree, (j - 1) % degree
                return any(p[i] == j for p in images.values())

            pairs = [(k + i, k - i + a) for i in range(1, k)]
            pairs += [(2 * k - 1, 1 + b), (2 * k, 2 + c)]
            cases.append((f"D_{n}, {wedge} facets a wedge", all(same(i, j) for i, j in pairs)))
    return by_cases(
        cases,
        "Mirrors at creases 1 and k send index i to 2 - i and 2k - i; the fold angle is a function "
        "of the orbit, the triangle wave 1, 2, .., k, k-1, .., 1, 2, ..  Enumerated for "
        "D_2..D_8 with 1..6 facets a wedge.",
        "group orbits, enumerated",
    )


def _check_count(statement: Any) -> Verdict:
    """Compare the printed number of unknowns with the dimension counted by characters."""

    def agrees(formula: Any) -> str | None:
        for h in range(1, 7):
            for wedge in range(1, 7):
                n, m = 2 * h, 2 * h
                degree = 2 * n * wedge
                counted = symmetric_dimension(n, degree)
                printed = sp.sympify(formula).subs({_N: degree, _M: m})
                if printed != counted:
                    return (
                        f"D_{n}, N = {degree}, m = {m}: the formula gives {printed}, the symmetric "
                        f"tangent space has dimension {counted}."
                    )
        return None

    wrong = agrees(statement)
    if wrong is None:
        return Verdict("proved", "character count", "Orbits of creases minus fixed vectors of R^3.")
    return refuted(
        f"{wrong}  (For the degree-8 vertex the paper itself later counts 2, not 8/2 = 4.)",
        "character count",
        Correction(
            r"N-3\ \to\ N/(2m)",
            lambda: agrees(_N / (2 * _M)) is None,
            "a wedge between neighbouring mirrors has N/(2m) facets, N/(2m) + 1 creases and one "
            "closing equation: N/(2m) degrees of freedom (or N/(2m) + 1 unknowns, elevation and "
            "fold angles 1..k-1, with one equation).",
        ),
    )


def _check_search(statement: tuple[Any, ...]) -> Verdict:
    """Statement: exponents (full, reduced) of q for degree 6 with D_1 and degree 8 with D_2."""
    counted = (3, symmetric_dimension(1, 6), 5, symmetric_dimension(2, 8))
    return by_cases(
        [(f"exponents {statement}, counted {counted}", tuple(statement) == counted)],
        "q^(N-3) against q^(d_sym) runs with d_sym counted by characters: q^3 -> q^2 for degree 6, "
        "q^5 -> q^2 for degree 8; the factor is q^(N-3-d_sym).",
        "character count",
    )


CLAIMS: list[Claim] = [
    Claim(
        "s2.d2h-group",
        "sec. 2, group of reflections and rotations",
        "<sigma, Q(e3, pi/h)> is D_2h",
        2 * _H,
        r"\langle\boldsymbol{\sigma}_{\hat{e}_2},\mathbf{Q}_{\hat{e}_3}(\pi/h)\rangle\cong D_{2h}",
        _check_group,
        damaged=(_H, 4 * _H),
    ),
    Claim(
        "s2.next-mirror",
        "sec. 2, crease k",
        "The next mirror runs through b_k = Q(e3, varphi/2) b_1",
        sp.Rational(1, 2),
        r"\hat{b}_k=\mathbf{Q}_{\hat{e}_3}(\varphi/2)\hat{b}_1,\quad"
        r"\boldsymbol{\sigma}_{\hat{b}_k\times\hat{e}_3}\in\mathcal{G}",
        _check_next_mirror,
        damaged=(sp.Integer(1), sp.Rational(3, 2)),
        form=Ratio(sp.Rational(1, 2)),
    ),
    Claim(
        "s2.elevation",
        "sec. 2, 'elevate crease 1 by upsilon'",
        "Q(e2, upsilon) elevates crease 1",
        sp.sin(upsilon),
        r"\hat{e}_3\cdot\mathbf{Q}_{\hat{e}_2}(\upsilon)\hat{b}_1=\sin\upsilon",
        _check_elevation,
        damaged=(sp.sin(2 * upsilon), sp.cos(upsilon)),
        corrected=-sp.sin(upsilon),
        root="sense of the elevation",
    ),
    Claim(
        "s2.d2h-convention",
        "sec. 2, reflection-rotation convention",
        "F_1 = Q(e2, upsilon) Q(b_1, phi_1/2) keeps crease 1 in its mirror plane",
        _ELEVATE,
        r"\mathbf{F}_1=\mathbf{Q}_{\hat{e}_2}(\upsilon)\mathbf{Q}_{\hat{b}_1}(\phi_1/2)",
        _check_wedge_convention,
        damaged=(_ELEVATE.inverse, _ELEVATE_E1),
        form=has(**dict.fromkeys("wxyz", formula(upsilon))),
    ),
    Claim(
        "s2.ratio-condition",
        "sec. 2, eq:rotation-reflection-condition",
        "Reduced compatibility as a ratio of components",
        RATIO,
        r"\frac{\hat{c}_k\cdot\hat{e}_2}{\hat{c}_k\cdot\hat{e}_1}"
        r"=\frac{\hat{b}_k\cdot\hat{e}_2}{\hat{b}_k\cdot\hat{e}_1}",
        _check_ratio,
        damaged=(
            (HALF_PLANE[0], sp.Integer(0)),
            (HALF_PLANE[0], -HALF_PLANE[1]),
            (HALF_PLANE[1], HALF_PLANE[1]),
        ),
        corrected=HALF_PLANE,
        form=row(*[formula(_CX, _CY, _BX, _BY)] * 2),
    ),
    Claim(
        "s2.orbit",
        "sec. 2, group orbit of the folded wedge",
        "A wedge with both edges in their mirrors generates a closed vertex",
        1,
        r"\hat{n}_1\cdot\mathbf{H}\hat{n}_k=\hat{n}_1\cdot\hat{n}_k\Rightarrow\prod q_i=+1",
        _check_orbit,
        damaged=(-1, sp.Rational(1, 2)),
        form=Ratio(),
    ),
    Claim(
        "s2.d2h-assignments",
        "sec. 2, eq:general-reflection-rotation-angle-assignments",
        "Fold angles of the group orbit",
        (0, 0, 0),
        r"\phi_{k+1}=\phi_{k-1},\ \ldots,\ \phi_{2k-1}=\phi_1,\ \phi_{2k}=\phi_2,\ \ldots",
        _check_assignment,
        damaged=((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ),
    Claim(
        "s2.d2h-count",
        "sec. 2, number of unknowns with reflection-rotation symmetry",
        "Unknowns reduce from N - 3 to N/m",
        _N / _M,
        r"N-3\ \to\ N/m,\quad \mathbf{Q}_{\hat{e}_3}(m\varphi)=\mathbf{I}",
        _check_count,
        damaged=(_N / (4 * _M), _N / (2 * _M) - 1),
        corrected=_N / (2 * _M),
    ),
    Claim(
        "s2.search-cost",
        "sec. 2, q^(N-3-d_sym)",
        "Cost of a grid search before and after reduction",
        (3, 2, 5, 2),
        r"q^{3}\to q^{2}\ (N=6),\qquad q^{5}\to q^{2}\ (N=8)",
        _check_search,
        damaged=((3, 2, 5, 4), (3, 1, 5, 2)),
    ),
]
