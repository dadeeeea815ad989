"""Section 3.1, where the two regions of the admissible space meet; part of `section3_topology`."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..claims.section3_degree6 import half_form
from ..decide import Correction, as_convention, refuted
from ..flat_folding import is_flat_foldable
from ..identities import circle, vanishes
from ..rotations import E1, about, scale
from ..statement import Ratio, Several, That, one_of, row
from ..symbols import ALPHA, HALF2, HALF3

CHART_POINTS = ((0, 0), (-1, 1), (1, -1), (-1, -1), (1, 1))
"""The middle and the corners of the chart, (phi_2, phi_3) in units of pi."""


def _fold_sums(part: Any, point: tuple[int, int]) -> frozenset[int]:
    """Signs of the sum of all six fold angles over the admissible states at a chart point.

    Corners: flat foldings with a layer order.  Middle: the book fold phi_1 = phi_4 = t, sum 2 t.
    """
    p, q = point
    if point == (0, 0):
        return frozenset((-1, 0, 1))
    letter = {1: "V", -1: "M"}
    return frozenset(
        sp.sign(a + b + 2 * (p + q))
        for a in (1, -1)
        for b in (1, -1)
        if is_flat_foldable(part, "".join(letter[x] for x in (a, p, q, b, q, p)))
    )


def _area_identity() -> bool:
    """L^2 - A (4 pi - A) = (sum phi)^2 for a polygon of length L = 2 pi and area A = 2 pi - sum phi."""
    total = sp.Symbol("s", real=True)
    area = 2 * sp.pi - total
    return sp.expand((2 * sp.pi) ** 2 - area * (4 * sp.pi - area) - total**2) == 0


def _book_fold() -> list[tuple[str, bool]]:
    """Over the chart point (0, 0) phi_1 = phi_4 = t closes for every t, and u = 0 frees phi_1 - phi_4."""
    form = half_form()
    origin = {HALF2.c: 1, HALF2.s: 0, HALF3.c: 1, HALF3.s: 0}
    v = [sp.expand(e.subs(origin)) for e in form.v]
    u = [sp.expand(e.subs(origin)) for e in form.u]
    t = circle(sp.Symbol("t", real=True) / 2, "t")
    book = about(E1, t.pair) * about(scale(-1, E1), t.pair)
    closes = all(vanishes(g, [t]) for g in (book.w - 1, *book.vector))
    c2a = 1 - 2 * ALPHA.c**2  # cos(pi - 2 alpha)
    u_same = [sp.expand(e.subs({HALF3.c: HALF2.c, HALF3.s: HALF2.s})) for e in form.u]
    gaps = (u_same[0] - (HALF2.c**2 - HALF2.s**2 * c2a), u_same[1])
    return [
        ("over (0, 0) phi_1 + phi_4 is free", v == [0, 0] and u == [1, 0]),
        ("the book fold closes", closes),
        (
            "phi_2 = phi_3: u = 0 at tan^2(phi_2/2) = -1/cos(2 alpha)",
            all(vanishes(g, [ALPHA, HALF2]) for g in gaps),
        ),
    ]


_AREA = (
    "A state is a closed spherical polygon of length 2 pi with sum phi = 2 pi less the area on its left "
    "(Gauss-Bonnet), and one of its sides lies in its convex hull K: but for the great circle, the flat state, "
    "|sum phi| >= 2 pi - area(K) > 0, facets that touch included (docs/validation/landscapes.md)."
)
_REMARK = (
    "over (0, 0) lies the book fold phi_1 = phi_4 = t too: t > 0 in one region, t < 0 in the other, t = 0 "
    "joins them.  For alpha_1 > pi/4 the chart has another such point: phi_2 = phi_3, "
    "tan^2(phi_2/2) = -1/cos(2 alpha_1) lays crease 4 on crease 1 and frees phi_1 - phi_4.  "
    "That each region is one piece is measured (docs/validation/landscapes.md), not decided here."
)


def _check_joints(statement: tuple[Any, tuple[tuple[int, int], ...]]) -> Verdict:
    """Whether the regions sum phi > 0 and sum phi < 0 meet over exactly these chart points.

    statement: (alpha_1 in units of pi, chart points).  One state of both regions has sum phi = 0 and
    is the flat state; in the picture over (phi_2, phi_3) the regions already meet where each of them
    has a state.  That each region is one piece is not decided here (docs/validation/landscapes.md measures it).
    """
    part, points = statement
    sums = {p: _fold_sums(part, p) for p in CHART_POINTS}
    broken = [name for name, holds in (*_book_fold(), ("area", _area_identity())) if not holds]
    if broken or any(0 in sums[p] for p in CHART_POINTS[1:]):
        return Verdict("unproved", "exact", f"a step does not hold: {broken or 'folding of sum 0'}")
    joints = {p for p in CHART_POINTS if 0 in sums[p]}
    picture = {p for p in CHART_POINTS if {1, -1} <= sums[p]}
    if set(points) == joints:
        return Verdict(
            "proved",
            "convex hull on the sphere, exact book fold",
            f"{_AREA}  So only the flat state belongs to the closures of both regions.",
            remark=_REMARK,
        )
    wrong = [f"over {_named(p)} none is common" for p in sorted(set(points) - joints)]
    wrong += [f"over {_named(p)} the flat state is" for p in sorted(joints - set(points))]
    verdict = refuted(
        f"{_AREA}  Of states common to both regions: {', '.join(wrong)}.",
        "convex hull on the sphere, exact crimping algorithm",
        None,
    )
    if set(points) != picture:
        return verdict
    return as_convention(
        verdict,
        "True of the picture over (phi_2, phi_3): over (-pi, pi) lie (phi_1, .., phi_4) = (pi, -pi, pi, "
        "pi), sum phi = 2 pi, and (-pi, -pi, pi, -pi), sum phi = -2 pi (over (pi, -pi) all signs turned): "
        "one shape with creases 1 and 4 closed to opposite sides, so that paper would have to pass "
        "through itself to get from one to the other.",
        Correction(
            rf"\alpha_1={sp.latex(part * sp.pi)}:\ \overline{{X_+}}\cap\overline{{X_-}}=\{{0\}},\ "
            r"X_\pm=\{\pm\textstyle\sum_i\phi_i>0\}",
            lambda: _check_joints((part, ((0, 0),))).verdict == "proved",
            "the regions have the flat state in common and no other.",
        ),
    )


def _named(point: tuple[int, int]) -> str:
    names = {0: "0", 1: "pi", -1: "-pi"}
    return f"({names[point[0]]}, {names[point[1]]})"


_THREE = ((0, 0), (-1, 1), (1, -1))


def _joint_claim(name: str, where: str, title: str, statement: Any, damaged: Any) -> Claim:
    """A claim on where the regions meet at one sector angle; the flat state is what is true."""
    part, points = statement
    right = (part, ((0, 0),))
    tex = ",".join(f"({sp.latex(p * sp.pi)},{sp.latex(q * sp.pi)})" for p, q in points)
    return Claim(
        name,
        where,
        title,
        statement,
        rf"\alpha_1={sp.latex(part * sp.pi)}:\ \overline{{X_+}}\text{{ and }}\overline{{X_-}}"
        rf"\text{{ meet over }}(\phi_2,\phi_3)={tex}\text{{ only}},\ "
        r"X_\pm=\{\pm\textstyle\sum_i\phi_i>0\}",
        _check_joints,
        damaged=damaged,
        corrected=None if statement == right else right,
        form=row(
            That(Ratio(), lambda r: 0 < r < sp.Rational(1, 2), "a rational between 0 and 1/2"),
            Several(one_of(*CHART_POINTS)),
        ),
        root="" if statement == right else "two states over one corner of the chart",
    )


JOINT_CLAIMS: dict[str, Claim] = {
    c.id: c
    for c in (
        _joint_claim(
            "s3.flat-point",
            "sec. 3.1, two regions connected by a point",
            "At pi/4 the two regions meet in one point, the flat state",
            (sp.Rational(1, 4), ((0, 0),)),
            damaged=(
                (sp.Rational(1, 4), ((0, 0), (-1, 1), (1, -1))),
                (sp.Rational(1, 4), ((1, 1),)),
            ),
        ),
        _joint_claim(
            "s3.handle-joints",
            "sec. 3.1, 1-handles 'also make connections'",
            "At pi/3 the 1-handles connect the two regions",
            (sp.Rational(1, 3), _THREE),
            damaged=((sp.Rational(1, 3), ((-1, 1), (1, -1))), (sp.Rational(1, 3), CHART_POINTS)),
        ),
        _joint_claim(
            "s3.corner-points",
            "sec. 3.1, 'connected at three points'",
            "At 5 pi/12 the two regions are connected at three points",
            (sp.Rational(5, 12), _THREE),
            damaged=((sp.Rational(5, 12), ((0, 0), (-1, 1))), (sp.Rational(5, 12), CHART_POINTS)),
        ),
    )
}
"""By id; `section3_topology.CLAIMS` puts them in the order of the paper."""
