"""Appendix B: continuum cone, areal stretch, visible area of the origami cone."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..cone import (
    K,
    identical,
    lift,
    root,
    separating_point,
)
from ..decide import Correction, as_convention, by_cases, by_identity, refuted
from ..identities import circle, vanishes
from ..rotations import E1, E2, E3, Vector, cross, dot
from ..statement import Ratio, formula, one_of, row
from ..symbols import upsilon

RADIUS, RAD = sp.symbols("R r", positive=True)
AZIMUTH = sp.Symbol("varphi", real=True)
_CIRCLES = [circle(upsilon, "u"), circle(AZIMUTH, "az")]
_S, _C = sp.sin(upsilon), sp.cos(upsilon)

SURFACE: Vector = (
    RAD * sp.cos(AZIMUTH) * _S,
    RAD * sp.sin(AZIMUTH) * _S,
    (RADIUS - RAD) * _C,
)
"""The printed parameterisation: upsilon is measured from the axis."""

ELEVATED: Vector = (
    RAD * sp.cos(AZIMUTH) * _C,
    RAD * sp.sin(AZIMUTH) * _C,
    (RADIUS - RAD) * _S,
)
"""The same cone with section 4's elevation, upsilon = 0 flat (tip up for upsilon > 0)."""


def tangents(surface: Vector) -> tuple[Vector, Vector]:
    """Derivatives by r and by the azimuth."""
    by_r, by_az = (tuple(sp.diff(x, p) for x in surface) for p in (RAD, AZIMUTH))
    return by_r, by_az  # type: ignore[return-value]


def determinant(surface: Vector) -> Any:
    """det of the metric g_ab = e_a . e_b."""
    a, b = tangents(surface)
    return dot(a, a) * dot(b, b) - dot(a, b) ** 2


def _check_surface(statement: Vector) -> Verdict:
    """Fibres of constant length, an axisymmetric cone, and flat at zero elevation as in section 4."""
    by_r, _ = tangents(statement)
    rim = tuple(x.subs(RAD, RADIUS) for x in statement)
    tip = tuple(x.subs(RAD, 0) for x in statement)
    fibre = by_identity(
        [dot(by_r, by_r) - 1, rim[2], tip[0], tip[1]],
        _CIRCLES,
        "Fibres are straight with |dy/dr| = 1, the rim lies in the plane and the tip on the axis.",
        fixed={RAD: sp.Integer(2), RADIUS: sp.Integer(3)},
    )
    if fibre.verdict != "proved":
        return fibre
    flat = vanishes(sp.sympify(tip[2]).subs(upsilon, 0), _CIRCLES)
    if flat:
        return fibre
    return as_convention(
        refuted(
            f"At upsilon = 0 the tip stands at height {tip[2].subs(upsilon, 0)}: a closed spike, "
            "where section 4 has the flat sheet (F_1 = I at upsilon = 0).",
            "exact evaluation",
            None,
        ),
        "True with upsilon measured from the axis (flat at pi/2); section 4, and the limit "
        "|phi/2| -> |upsilon| used at the end of this appendix, measure it from the flat sheet.",
        Correction(
            r"\mathbf{y}=(r\cos\varphi\cos\upsilon,\ r\sin\varphi\cos\upsilon,\ (R-r)\sin\upsilon)",
            lambda: _check_surface(ELEVATED).verdict == "proved",
            "with the elevation of section 4: unit fibres, flat at upsilon = 0.",
        ),
    )


def _check_tangent(statement: tuple[int, Vector]) -> Verdict:
    """One printed basis vector against the derivative of the printed surface."""
    index, vector = statement
    derivative = tangents(SURFACE)[index]
    return by_identity(
        [a - b for a, b in zip(derivative, vector, strict=True)],
        _CIRCLES,
        "Derivative of the printed surface, component by component.",
        fixed={RAD: sp.Integer(2), RADIUS: sp.Integer(3)},
    )


def _check_metric(statement: Any) -> Verdict:
    """Area element squared: det of the metric of the printed surface."""
    return by_identity(
        [determinant(SURFACE) - statement**2],
        _CIRCLES,
        "det g = r^2 sin^2 upsilon, so da = r |sin upsilon| dr dvarphi.",
        fixed={RAD: sp.Integer(2), RADIUS: sp.Integer(3)},
    )


def _check_stretch(statement: Any) -> Verdict:
    """mu^2 against det g / r^2 for the printed surface and for section 4's elevation."""
    fits = vanishes(statement**2 - determinant(SURFACE) / RAD**2, _CIRCLES)
    elevated = vanishes(statement**2 - determinant(ELEVATED) / RAD**2, _CIRCLES)
    if elevated:
        return Verdict("proved", "identity modulo c^2+s^2-1", "det g = r^2 cos^2 upsilon, dA = r.")
    if not fits:
        gaps = [statement**2 - determinant(SURFACE) / RAD**2]
        return by_identity(gaps, _CIRCLES, "", fixed={RAD: sp.Integer(2)})
    return as_convention(
        refuted(
            f"At upsilon = 0, the flat sheet of section 4, it gives mu = {statement.subs(upsilon, 0)} "
            "instead of 1.",
            "exact evaluation",
            None,
        ),
        "True of the appendix's own surface (upsilon from the axis).",
        Correction(
            r"\mu=|\cos\upsilon|",
            lambda: vanishes(determinant(ELEVATED) - RAD**2 * _C**2, _CIRCLES),
            "for section 4's elevation, to which the hidden area is compared, det g = r^2 cos^2.",
        ),
    )


def _check_modulus(statement: Any) -> Verdict:
    """|sin upsilon| = `statement` for |upsilon| <= pi, by the sign of sin on each half."""
    side = {s: statement.subs(sp.Abs(upsilon), s * upsilon) for s in (1, -1)}
    right = all(vanishes(side[s] - s * _S, _CIRCLES) for s in (1, -1))
    if right:
        return Verdict(
            "proved",
            "case split on the sign of upsilon",
            "sin is nonnegative on [0, pi], so |sin v| = sin v there and = sin(-v) on [-pi, 0].",
        )
    at = -sp.pi / 6
    return refuted(
        f"At upsilon = -pi/6: {statement.subs(upsilon, at)} against {sp.Abs(sp.sin(at))}.",
        "exact evaluation",
        None,
    )


def facet_cosine(kind: str, side: int) -> Any:
    """Cosine between the normal of facet 1 and the normal of the cone along crease 1."""
    rho = root(kind, side)
    normal = lift(E3, rho)
    cone = cross(lift(E1, rho), E2)  # along c_1 the cone is spanned by c_1 and e2
    return dot(normal, cone)


_PHI = sp.Symbol("phi", real=True)


def _check_visible(statement: Any) -> Verdict:
    """A'/A as a function of phi: projection factor onto the cone at crease 1, phi_1 = 2 rho_1."""
    pairs = []
    for kind, side in (("valley", 1), ("valley", -1), ("mountain", 1), ("mountain", -1)):
        rho = root(kind, side)
        trig = {sp.cos(_PHI / 2): rho[0], sp.sin(_PHI / 2): rho[1]}
        pairs.append((facet_cosine(kind, side), statement.subs(trig)))
    flat = statement.subs(_PHI, 0)
    apart = [separating_point(a, b) for a, b in pairs if not identical(a, b)]
    if not apart:
        return Verdict(
            "proved",
            "identity in (cos v/2, sin v/2, tan(pi/4 - alpha/2)), all N at once",
            "The facet's normal makes the angle rho_1 = phi_1/2 with the cone's normal at crease 1, "
            "exactly for every N; its projection shrinks by the cosine.",
        )
    if statement != sp.sin(_PHI / 2):
        return refuted(f"Not the projection at {apart[0]}.", "exact counterexample", None)
    return refuted(
        f"Flat sheet, phi = 0: nothing is hidden, yet the printed ratio A'/A is {flat}; at phi = pi "
        f"(facets folded onto each other) it is {statement.subs(_PHI, sp.pi)}.",
        "exact evaluation",
        Correction(
            r"A_i'=A_i\left|\cos\tfrac{\phi_i}{2}\right|",
            lambda: _check_visible(sp.cos(_PHI / 2)).verdict == "proved",
            "facet and cone normals make the angle phi_1/2, identically for all N; with "
            "|phi/2| -> |upsilon| the ratio tends to cos(upsilon), the areal stretch for section "
            "4's elevation.",
        ),
    )


def _check_half_limit(statement: Any) -> Verdict:
    """lim |phi_i|/2 = f |v| for odd and even creases; f = `statement`."""
    h = sp.Symbol("h", positive=True)
    odd = [sp.limit(e, K, 1, dir="-") for e in (K * h, h / K)]
    cases = [
        (f"odd creases: tan(|phi|/4) -> {odd}", odd == [h, h]),
        (f"|phi_i/2| = |upsilon|, not {statement} |upsilon|", statement == 1),
    ]
    return by_cases(
        cases,
        "tan(|phi_odd|/4) = K h or h/K with K -> 1, h = tan(|v|/2), so |phi_odd|/2 -> |v|; "
        "|phi_even|/2 = |v| for every N.",
        "limit of a rational function",
    )


def _check_correspondence(statement: tuple[Any, Any]) -> Verdict:
    """lim A'/A (a function of phi) against the stretch (a function of v), and 1 on the flat sheet."""
    visible, stretch = statement
    limit = visible.subs(_PHI, 2 * upsilon)  # |phi_i/2| -> |v|; both are even in v
    agree = vanishes(limit**2 - stretch**2, _CIRCLES)
    flat = limit.subs(upsilon, 0) == 1
    if agree and flat:
        return Verdict(
            "proved", "limit and identity", "A'/A -> cos(upsilon) = areal stretch; 1 when flat."
        )
    verdict = refuted(
        "The two expressions agree with each other, but on the flat sheet both are "
        f"{limit.subs(upsilon, 0)}: all area hidden."
        if agree
        else f"At upsilon = pi/6 the limits are {limit.subs(upsilon, sp.pi / 6)} and "
        f"{stretch.subs(upsilon, sp.pi / 6)}.",
        "exact evaluation",
        None,
    )
    if not agree:
        return verdict
    return as_convention(
        verdict,
        "The correspondence is right, its two sides are both the sine where section 4's elevation "
        "needs the cosine (the visible part tends to mu, the hidden part to 1 - mu).",
        Correction(
            r"\lim_{N\to\infty}\frac{A_i'}{A_i}=\lim_{N\to\infty}\left|\cos\tfrac{\phi_i}{2}\right|"
            r"=|\cos\upsilon|=\mu",
            lambda: _check_correspondence((sp.cos(_PHI / 2), _C)).verdict == "proved",
            "visible area and stretch are both cos(upsilon).",
        ),
    )


_E_R: Vector = (sp.cos(AZIMUTH) * _S, sp.sin(AZIMUTH) * _S, -_C)
_E_AZ: Vector = (-RAD * sp.sin(AZIMUTH) * _S, RAD * sp.cos(AZIMUTH) * _S, sp.Integer(0))

_POINT = row(*[formula(RADIUS, RAD, AZIMUTH, upsilon)] * 3)
_SINE = "sine for cosine: elevation from the axis or from the sheet"

CLAIMS: list[Claim] = [
    Claim(
        "b.surface",
        "app. B, parameterisation",
        "Continuum cone with fibres of constant length",
        SURFACE,
        r"\mathbf{y}=(r\cos\varphi\sin\upsilon,\ r\sin\varphi\sin\upsilon,\ (R-r)\cos\upsilon)",
        _check_surface,
        damaged=((SURFACE[0], SURFACE[1], RADIUS - RAD), (SURFACE[0], SURFACE[1], -RAD * _C)),
        corrected=ELEVATED,
        form=_POINT,
        root=_SINE,
    ),
    Claim(
        "b.tangent-r",
        "app. B, basis vectors",
        "Tangent vector along the fibre",
        (0, _E_R),
        r"\mathbf{e}_r=(\cos\varphi\sin\upsilon,\ \sin\varphi\sin\upsilon,\ -\cos\upsilon)",
        _check_tangent,
        damaged=((0, (_E_R[0], _E_R[1], _C)), (1, _E_R)),
        form=row(one_of(0, 1), _POINT),
    ),
    Claim(
        "b.tangent-azimuth",
        "app. B, basis vectors",
        "Tangent vector along the parallel",
        (1, _E_AZ),
        r"\mathbf{e}_\varphi=(-r\sin\varphi\sin\upsilon,\ r\cos\varphi\sin\upsilon,\ 0)",
        _check_tangent,
        damaged=((1, (-_E_AZ[0], _E_AZ[1], _E_AZ[2])), (0, _E_AZ)),
        form=row(one_of(0, 1), _POINT),
    ),
    Claim(
        "b.metric",
        "app. B, metric and area element",
        "Area element of the printed surface",
        RAD * _S,
        r"\mathrm{d}a=\sqrt{\det\mathbf{g}}\,\mathrm{d}r\,\mathrm{d}\varphi="
        r"r|\sin\upsilon|\,\mathrm{d}r\,\mathrm{d}\varphi",
        _check_metric,
        damaged=(RAD * _C, RADIUS * _S, _S),
        form=formula(RADIUS, RAD, upsilon),
    ),
    Claim(
        "b.stretch",
        "app. B, eq:cone-areal-stretch",
        "Areal stretch of the continuum cone",
        _S,
        r"\mu=\mathrm{d}a/\mathrm{d}A=|\sin\upsilon|",
        _check_stretch,
        damaged=(sp.tan(upsilon), _S**2),
        corrected=_C,
        root=_SINE,
    ),
    Claim(
        "b.modulus",
        "app. B, eq:cone-areal-stretch, second equality",
        "|sin v| = sin|v| on [-pi, pi]",
        sp.sin(sp.Abs(upsilon)),
        r"|\sin\upsilon|=\sin|\upsilon|",
        _check_modulus,
        damaged=(_S, -sp.sin(sp.Abs(upsilon))),
    ),
    Claim(
        "b.visible-area",
        "app. B, visible area",
        "Visible area of a facet",
        sp.sin(_PHI / 2),
        r"A_i'=A_i\left|\sin\tfrac{\phi_i}{2}\right|",
        _check_visible,
        damaged=(sp.cos(_PHI / 2) ** 2, 2 * sp.sin(_PHI / 2)),
        corrected=sp.cos(_PHI / 2),
        root=_SINE,
    ),
    Claim(
        "b.half-angle-limit",
        "app. B, limit",
        "Half fold angles tend to the elevation",
        1,
        r"\lim_{N\to\infty}\left|\tfrac{\phi_i}{2}\right|=|\upsilon|",
        _check_half_limit,
        damaged=(2, sp.Rational(1, 2)),
        form=Ratio(),
    ),
    Claim(
        "b.correspondence",
        "app. B, last sentence; sec. 4, infinite creases",
        "Visible area ratio equals the areal stretch",
        (sp.sin(_PHI / 2), _S),
        r"\lim_{N\to\infty}A_i'/A_i=\mu",
        _check_correspondence,
        damaged=((sp.sin(_PHI / 2), _C), (sp.cos(_PHI / 2), _S)),
        corrected=(sp.cos(_PHI / 2), _C),
        root=_SINE,
    ),
]
