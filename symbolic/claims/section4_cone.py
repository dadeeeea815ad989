"""Section 4, first part: deformation of the cone and the construction of its facets.

Every proof runs on the rational form of `origami_nlp.symbolic.cone`, hence for all N at once.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..claims._section4_angles import ANGLE_CLAIMS, ROOTS, compare
from ..cone import (
    ALPHA_PAIR,
    ELEVATION,
    K,
    azimuth,
    lift,
    mirror,
    multiple,
    root,
    turn,
)
from ..decide import Correction, as_convention, by_cases, refuted
from ..rotations import E1, E2, E3, Vector, dot, reflect
from ..statement import WHOLE, Several, formula, one_of, row


def _check_deformation(statement: tuple[str, ...]) -> Verdict:
    """The factors of F_1, in the printed order, must elevate crease 1 inside its mirror plane."""
    rho = root("valley", 1)
    factors = {"elevate": (E2, ELEVATION), "fold": (E1, rho)}
    image = E1
    for name in reversed(statement):
        axis, pair = factors[name]
        image = turn(axis, pair, image)
    wanted = (ELEVATION[0], sp.Integer(0), -ELEVATION[1])
    return compare(
        "F_1 b_1 = (cos v, 0, -sin v) and c_2 in its mirror plane",
        [
            (image, wanted, 1),
            (dot(_apply(statement, factors, azimuth(1)), mirror(1)), sp.Integer(0), 1),
        ],
        "Q(b_1, rho) fixes b_1 and Q(e2, v) keeps the mirror plane e2 = 0; c_2 then lies in its own.",
        None,
    )


def _apply(order: tuple[str, ...], factors: dict[str, Any], vector: Vector) -> Vector:
    for name in reversed(order):
        axis, pair = factors[name]
        vector = turn(axis, pair, vector)
    return vector


def _check_facet_mirror(statement: Vector) -> Verdict:
    """The mirror with normal `statement` must fix c_2 and send facet 1 to the flat place of facet 2."""
    pairs: list[tuple[Any, Any, int]] = [(reflect(statement, azimuth(0)), azimuth(2), 0)]
    for kind, side in ROOTS:
        c2 = lift(azimuth(1), root(kind, side))
        pairs.append((reflect(statement, c2), c2, side))
    return compare(
        "mirror image of facet 1",
        pairs,
        "b_2 x e3 is the normal of the vertical plane through b_2: the mirror swaps b_1 and b_3 and "
        "fixes c_2 on both roots.",
        None,
    )


def _check_mapped_gradient(statement: Vector) -> Verdict:
    """sigma F_1 sigma must equal F_1 Q(b_2, phi_2): same image of b_2, b_3 and e3."""
    pairs: list[tuple[Any, Any, int]] = []
    for kind, side in ROOTS:
        rho = root(kind, side)
        sense = side if kind == "valley" else -side  # phi_2 = -2 v on the shallow root
        fold = multiple(ELEVATION, -2 * sense)
        for v in (azimuth(1), azimuth(2), E3):
            mapped = reflect(statement, lift(reflect(statement, v), rho))
            pairs.append((mapped, lift(turn(azimuth(1), fold, v), rho), side))
    return compare(
        "F_2 = sigma F_1 sigma^T",
        pairs,
        "It equals F_1 Q(b_2, phi_2) with phi_2 = -+2 v on both roots, for all N and v.",
        None,
    )


def crease3(axis_multiple: Any) -> Vector:
    """Q(Q(e3, m alpha) e2, v) b_3 with m = `axis_multiple`."""
    axis = turn(E3, multiple(ALPHA_PAIR, int(axis_multiple)), E2)
    return turn(axis, ELEVATION, azimuth(2))


def _check_crease3(statement: Any) -> Verdict:
    """Where crease 3 goes: the mirror image of c_1 against the printed rotation of b_3."""
    pairs = []
    for kind, side in ROOTS:
        c1 = lift(E1, root(kind, side))
        pairs.append((reflect(mirror(1), c1), crease3(statement), side))
    return compare(
        "c_3 = Q(Q(e3, m alpha) e2, v) b_3",
        pairs,
        "The axis Q(e3, 2 alpha) e2 is the image of e2 under the rotation that takes b_1 to b_3, so "
        "c_3 is c_1 carried along.",
        Correction(
            r"\hat{c}_3=\mathbf{Q}_{\mathbf{Q}_{\hat{e}_3}(2\alpha)\hat{e}_2}(\upsilon)\,\hat{b}_3",
            lambda: _check_crease3(2).verdict == "proved",
            "the axis is Q(e3, 2 alpha) e2; identity on both roots, all N.",
        )
        if statement == 1
        else None,
    )


def _check_copies(statement: tuple[Any, Any]) -> Verdict:
    """Azimuth (in units of alpha) of the first crease of the copy that is to be facet j.

    statement: (rotation angle in units of alpha as a function of m = floor((j-1)/2), source facet
    of an even j).
    """
    m = sp.Symbol("m", integer=True)
    angle, even_source = (sp.sympify(s) for s in statement)
    odd = angle + 0 - 2 * m  # j = 2m + 1: the copy of facet 1 must start at azimuth 2 m alpha
    even = angle + (even_source - 1) - (2 * m + 1)  # j = 2m + 2 must start at (2m + 1) alpha
    if sp.expand(odd) == 0 and sp.expand(even) == 0:
        return Verdict(
            "proved",
            "polynomial identity in floor((j-1)/2)",
            "The copy of facet j starts at azimuth (j-1) alpha for odd and even j.",
        )
    return refuted(
        f"For j = 3 the copy of facet 1 starts at azimuth {angle.subs(m, 1)} alpha instead of "
        f"2 alpha; for j = 2 the source is facet {even_source}.",
        "exact evaluation",
        Correction(
            r"\Omega^{(j)}=\mathbf{Q}_{\hat{e}_3}\bigl(2\alpha\lfloor (j-1)/2\rfloor\bigr)"
            r"\,\Omega^{(1+((j-1)\bmod 2))},\quad \alpha=2\pi/N",
            lambda: _check_copies((2 * m, 2)).verdict == "proved",
            "the angle is 4 pi floor((j-1)/2)/N (printed: half of it), and even j copies facet 2 "
            "(j mod 2 would be facet 0).",
        ),
    )


def _check_odd_equal(statement: Any) -> Verdict:
    """Fold angle at crease 3 of the symmetric folding, in multiples of rho_1, from the geometry.

    Facet 2 seen from the elevated frame at crease 3 is facet 1 seen from crease 1, mirrored: it is
    turned by -rho_1 about b_3, and facet 3 by +rho_1.
    """
    pairs = []
    for kind, side in ROOTS:
        rho = root(kind, side)
        frame = turn(E3, multiple(ALPHA_PAIR, 2), E2)
        for v in (azimuth(1), E3):
            facet2 = reflect(mirror(1), lift(reflect(mirror(1), v), rho))
            folded = turn(frame, ELEVATION, turn(azimuth(2), multiple(rho, 1 - int(statement)), v))
            pairs.append((facet2, folded, side))
    return compare(
        f"phi_3 = {statement} rho_1",
        pairs,
        "F_2 = Q(axis_3, v) Q(b_3, -rho_1) and F_3 = Q(axis_3, v) Q(b_3, rho_1), so phi_3 = 2 rho_1; "
        "the rotation by 2 alpha repeats it at every odd crease.",
        None,
    )


_WITH_MIRROR, _ROTATIONS = "mirror and rotations", "rotations"


def _check_unit_cell(statement: tuple[tuple[int, ...], str]) -> Verdict:
    """Orbit of a union of facets under rotations by 2 alpha, with or without the mirror e2, N = 6..30.

    statement: (facets of the cell, group).
    """
    facets, group = statement
    cases = []
    for n in range(6, 31, 2):
        covered = [0] * n
        for r in range(n // 2):
            for facet in facets:
                covered[(facet - 1 + 2 * r) % n] += 1
                if group == _WITH_MIRROR:
                    covered[(-facet + 2 * r) % n] += 1  # the mirror sends facet i to -i
        cases.append((f"N = {n}: each facet is covered {covered[0]} times", set(covered) == {1}))
    fix = Correction(
        r"\Omega_0^{c}=\Omega_0^{(1)}\quad(\text{for }G=\langle\boldsymbol{\sigma}_{\hat{e}_2},"
        r"\mathbf{Q}_{\hat{e}_3}(2\alpha)\rangle)",
        lambda: all(_check_unit_cell(s).verdict == "proved" for s in _ORBITS),
        "facet 1 is the cell of G, facets 1 and 2 (the flap) that of its rotations; the paper takes "
        "both orbits with the right cell.",
    )
    verdict = by_cases(cases, "Each facet is an image of the cell exactly once.", "enumeration")
    if verdict.verdict == "proved" or group == _ROTATIONS:
        return verdict
    if _check_unit_cell((facets, _ROTATIONS)).verdict != "proved":
        return verdict
    return as_convention(
        verdict,
        "A matter of names, no formula is wrong: the orbits the paper takes, Orb_G of facet 1 (text) and "
        "of the flap under rotations (caption of the figure), are ours.  Only section 2's word 'unit "
        "cell', the cell of G, is given to the flap here.",
        fix,
    )


_ORBITS = (((1,), _WITH_MIRROR), ((1, 2), _ROTATIONS))


def _check_order(statement: Any) -> Verdict:
    """|<sigma_{e2}, Q(e3, 2 alpha)>| = 2n must be the order of D_{statement(N)}."""
    n_symbol = sp.Symbol("N")
    cases = []
    for n in range(6, 31, 2):
        rotations = {(2 * r) % n for r in range(n)}  # creases moved by multiples of 2
        order = 2 * len(rotations)
        claimed = 2 * sp.sympify(statement).subs(n_symbol, n)
        cases.append((f"N = {n}: order {order} against {claimed}", order == claimed))
    return by_cases(
        cases,
        "Rotations by 2 alpha = 2 pi/(N/2) and one mirror: D_{N/2}; the folding is its orbit, so it "
        "has that symmetry.",
        "enumeration N = 6..30",
    )


def _check_sectors(statement: Any) -> Verdict:
    """N equal sector angles must make a flat sheet."""
    n = sp.Symbol("N", positive=True)
    return by_cases(
        [("N alpha = 2 pi", sp.cancel(n * statement - 2 * sp.pi) == 0)], "N alpha = 2 pi.", "exact"
    )


_N, _M = sp.Symbol("N"), sp.Symbol("m", integer=True)
_VECTOR = row(*[formula(K)] * 3)

CLAIMS: list[Claim] = [
    Claim(
        "s4.sectors",
        "sec. 4, opening",
        "Equal sector angles",
        2 * sp.pi / sp.Symbol("N", positive=True),
        r"\alpha_1=\dots=\alpha_N=2\pi/N",
        _check_sectors,
        damaged=(sp.pi / sp.Symbol("N", positive=True),),
    ),
    Claim(
        "s4.unit-cell",
        "sec. 4, opening",
        "Facets 1 and 2 are called the unit cell",
        ((1, 2), _WITH_MIRROR),
        r"\Omega_0^{c}=\Omega_0^{(1)}\cup\Omega_0^{(2)}\quad(\text{unit cell of }G=\langle"
        r"\boldsymbol{\sigma}_{\hat{e}_2},\mathbf{Q}_{\hat{e}_3}(2\alpha)\rangle)",
        _check_unit_cell,
        damaged=(((1, 2, 3), _WITH_MIRROR), ((1, 3), _WITH_MIRROR), ((1,), _ROTATIONS)),
        corrected=_ORBITS[0],
        form=row(Several(WHOLE), one_of(_WITH_MIRROR, _ROTATIONS)),
    ),
    Claim(
        "s4.deformation",
        "sec. 4, eq:cone-deformation",
        "Elevate, then fold by the partial angle",
        ("elevate", "fold"),
        r"\mathbf{F}_1=\mathbf{Q}_{\hat{e}_2}(\upsilon)\mathbf{Q}_{\hat{b}_1}(\rho_1)",
        _check_deformation,
        damaged=(("fold", "elevate"), ("elevate",)),
        form=Several(one_of("elevate", "fold")),
    ),
    ANGLE_CLAIMS["s4.two-roots"],
    ANGLE_CLAIMS["s4.partial-valley"],
    ANGLE_CLAIMS["s4.partial-mountain"],
    Claim(
        "s4.group-order",
        "sec. 4, symmetry of the folded cone",
        "The folded cone has D_{N/2} symmetry",
        _N / 2,
        r"\langle\boldsymbol{\sigma}_{\hat{e}_2},\mathbf{Q}_{\hat{e}_3}(2\alpha)\rangle\cong D_{N/2}",
        _check_order,
        damaged=(_N, _N / 2 + 1),
    ),
    Claim(
        "s4.facet-mirror",
        "sec. 4, construction of facet 2",
        "Facet 2 is the mirror image of facet 1",
        mirror(1),
        r"\Omega^{(2)}=\boldsymbol{\sigma}_{\hat{b}_2\times\hat{e}_3}\,\Omega^{(1)}",
        _check_facet_mirror,
        damaged=(azimuth(1), mirror(2), E2),
        form=_VECTOR,
    ),
    Claim(
        "s4.facet-copies",
        "sec. 4, construction of facet j",
        "Facet j as a rotated copy",
        (_M, 0),
        r"\Omega^{(j)}=\mathbf{Q}_{\hat{e}_3}\bigl(2\pi\lfloor (j-1)/2\rfloor/N\bigr)"
        r"\,\Omega^{(j\bmod 2)}",
        _check_copies,
        damaged=((_M, 2), (2 * _M, 0), (2 * _M + 1, 2)),
        corrected=(2 * _M, 2),
        form=row(formula(_M), WHOLE),
    ),
    Claim(
        "s4.odd-creases",
        "sec. 4, fold angle of odd creases",
        "All odd creases fold by 2 rho_1",
        2,
        r"\phi_{1}=\phi_3=\dots=\phi_{N-1}=2\rho_1",
        _check_odd_equal,
        damaged=(1, 3),
    ),
    ANGLE_CLAIMS["s4.even-by-normals"],
    ANGLE_CLAIMS["s4.even"],
    ANGLE_CLAIMS["s4.limit"],
    Claim(
        "s4.mapped-gradient",
        "sec. 4, symmetry breaking, F_2",
        "Deformation gradient of the mirrored facet",
        mirror(1),
        r"\mathbf{F}_2=\boldsymbol{\sigma}_{\hat{b}_2\times\hat{e}_3}\mathbf{F}_1"
        r"\boldsymbol{\sigma}_{\hat{b}_2\times\hat{e}_3}^{T}",
        _check_mapped_gradient,
        damaged=(E2, mirror(2)),
        form=_VECTOR,
    ),
    Claim(
        "s4.crease-3",
        "sec. 4, symmetry breaking, where crease 3 goes",
        "Deformed crease 3",
        1,
        r"\hat{c}_3=\mathbf{Q}_{\mathbf{Q}_{\hat{e}_3}(\alpha)\hat{e}_2}(\upsilon)\,\hat{b}_3",
        _check_crease3,
        damaged=(0, 3, -2),
        corrected=2,
    ),
]
