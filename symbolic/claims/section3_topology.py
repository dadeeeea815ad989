"""Section 3.1: the admissible space of the degree-6 vertex, its handles, and the Morse claim."""

from __future__ import annotations

from typing import Any

import sympy as sp

from symbolic.claim import Claim, Verdict
from symbolic.claims.section3_degree6 import half_form
from symbolic.decide import Correction, as_convention, by_cases, refuted
from symbolic.flat_folding import is_flat_foldable
from symbolic.identities import circle, vanishes
from symbolic.intervals import certify_sign
from symbolic.rotations import E1, about, rational_pair, scale
from symbolic.statement import Ratio, Several, That, formula, one_of, row
from symbolic.states import degree6
from symbolic.symbols import ALPHA, HALF2, HALF3

_HALF = sp.Rational(1, 2)
Segment = tuple[str, Any, Any, Any]
"""(fixed fold angle, its value, lower end, upper end of the other) in units of pi."""
_SEGMENT = row(one_of("phi_2", "phi_3"), Ratio(), Ratio(), Ratio())

FIRST_HANDLE: tuple[Segment, ...] = (
    ("phi_2", -1, _HALF, 1),
    ("phi_3", 1, -1, -_HALF),
)
SECOND_HANDLE: tuple[Segment, ...] = (
    ("phi_2", 1, -_HALF, -1),
    ("phi_3", -1, -_HALF, 1),
)
SECOND_HANDLE_RIGHT: tuple[Segment, ...] = (
    ("phi_2", 1, -1, -_HALF),
    ("phi_3", -1, _HALF, 1),
)


def _negated(handle: tuple[Segment, ...]) -> tuple[Segment, ...]:
    return tuple((name, -v, -hi, -lo) for name, v, lo, hi in handle)


def _endpoint_is_right_angle() -> bool:
    """At alpha = pi/3 the sheet criterion Re(uv) Re(u conj v) factors; its sign is that of cos.

    Re(uv) ~ c_3 (2 s_2 c_2 c_3 + 2 (c_2^2 - s_2^2) s_3) and the same with 2 and 3 exchanged, with
    positive factors; on phi_3 -> -pi (c_3 -> 0+, s_3 = -1) the product has the sign of
    cos(phi_2) for 0 < phi_2 < pi.
    """
    form = half_form()
    third = {ALPHA.c: _HALF, ALPHA.s: sp.sqrt(3) / 2}
    first, last = (sp.expand(e[1].subs(third)) for e in (form.first, form.last))
    (c2, s2), (c3, s3) = HALF2.pair, HALF3.pair
    b1 = 2 * s2 * c2 * c3 + 2 * (c2**2 - s2**2) * s3
    b4 = 2 * s3 * c3 * c2 + 2 * (c3**2 - s3**2) * s2
    k = sp.sqrt(3) / 4
    factors = vanishes(first - k * c3 * b1, [HALF2, HALF3]) and vanishes(
        last - k * c2 * b4, [HALF2, HALF3]
    )
    edge = {c3: 0, s3: -1}
    on_edge1 = sp.expand(b1.subs(edge) + 2 * (c2**2 - s2**2))  # b1 = -2 cos(phi_2)
    on_edge4 = sp.expand(b4.subs(edge) + 2 * s2)  # b4 = -2 sin(phi_2/2) < 0
    return factors and on_edge1 == 0 and on_edge4 == 0


def _check_handles(statement: tuple[tuple[Segment, ...], tuple[Segment, ...]]) -> Verdict:
    """Intervals must be non-empty, and the two handles exchanged by turning the vertex over."""
    first, second = statement
    correction = Correction(
        r"\text{second handle: }\{\pi\}\times[-\pi,-\tfrac{\pi}{2})\cup(\tfrac{\pi}{2},\pi]\times\{-\pi\}",
        lambda: (
            set(_negated(FIRST_HANDLE)) == set(SECOND_HANDLE_RIGHT) and _endpoint_is_right_angle()
        ),
        "the image of the first handle under (phi_2, phi_3) -> -(phi_2, phi_3); the ends are "
        "exactly pi/2, where the sheet criterion Re(uv) Re(u conj v) changes sign next to the edge.",
    )
    for handle in statement:
        for name, value, lo, hi in handle:
            if not lo < hi:
                extra = ""
                if set(_negated(first)) != set(second):
                    extra = (
                        "  Turning the vertex over, phi -> -phi, maps admissible states to "
                        "admissible states and the first handle to {pi} x [-pi, -pi/2) u (pi/2, "
                        "pi] x {-pi}, not to the printed second one, whose last interval starts "
                        "at -pi/2."
                    )
                return refuted(
                    f"The interval of the segment {name} = {value} pi runs from {lo} pi to {hi} "
                    f"pi: empty as printed.{extra}",
                    "exact",
                    correction,
                )
    return by_cases(
        [
            ("the handles are images of each other", set(_negated(first)) == set(second)),
            ("ends at pi/2", _endpoint_is_right_angle()),
            (
                "ends as derived",
                {abs(x) for h in statement for s in h for x in s[2:]} == {_HALF, 1},
            ),
            ("first handle as derived", set(first) == set(FIRST_HANDLE)),
        ],
        "Odd symmetry of the admissible space and the sign of the sheet criterion at the edge.",
        "exact",
    )


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
    "A state is a closed spherical polygon of length 2 pi and area A = 2 pi - sum phi (Gauss-Bonnet); "
    "(2 pi)^2 - A (4 pi - A) = (sum phi)^2, and by the isoperimetric inequality on the sphere only a "
    "circle has none: a state with sum phi = 0 is the great circle, the flat state."
)
_REMARK = (
    "over the chart point (0, 0) lies more than the flat state, the book fold phi_1 = phi_4 = t "
    "(Q(e1, t/2) Q(-e1, t/2) = 1 for all t): t > 0 belongs to one region, t < 0 to the other, and t = 0 "
    "joins them.  For alpha_1 > pi/4 the chart has another such point: phi_2 = phi_3 with "
    "tan^2(phi_2/2) = -1/cos(2 alpha_1) lays crease 4 on crease 1 and frees phi_1 - phi_4."
)


def _check_joints(statement: tuple[Any, tuple[tuple[int, int], ...]]) -> Verdict:
    """Whether the regions sum phi > 0 and sum phi < 0 meet over exactly these chart points.

    statement: (alpha_1 in units of pi, chart points).  One state of both regions has sum phi = 0 and
    is the flat state; in the picture over (phi_2, phi_3) the regions already meet where each of them
    has a state.  That each region is one piece is not decided here (docs/space.md measures it).
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
            "isoperimetric inequality, exact book fold",
            f"{_AREA}  So only the flat state belongs to the closures of both regions.",
            remark=_REMARK,
        )
    wrong = [f"over {_named(p)} none is common" for p in sorted(set(points) - joints)]
    wrong += [f"over {_named(p)} the flat state is" for p in sorted(joints - set(points))]
    verdict = refuted(
        f"{_AREA}  Of states common to both regions: {', '.join(wrong)}.",
        "isoperimetric inequality, exact crimping algorithm",
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


def _check_holes(statement: tuple[Any, tuple[tuple[int, int], ...]]) -> Verdict:
    """No sheet of paper over a box near each of the corners (signs of phi_2, phi_3), certified."""
    azimuth, corners = statement
    form = half_form()
    x, y = sp.symbols("phi_2 phi_3", real=True)
    trig = {
        ALPHA.c: sp.cos(azimuth),
        ALPHA.s: sp.sin(azimuth),
        HALF2.c: sp.cos(x / 2),
        HALF2.s: sp.sin(x / 2),
        HALF3.c: sp.cos(y / 2),
        HALF3.s: sp.sin(y / 2),
    }
    (a, b), (c, d) = ([e.subs(trig) for e in pair] for pair in (form.u, form.v))
    criterion = (a * c) ** 2 - (b * d) ** 2  # Re(uv) Re(u conj v)
    cases, boxes = [], 0
    for sx, sy in corners:
        wide, near = (sp.pi * 3 / 4, sp.pi * 17 / 20), (sp.pi * 19 / 20, sp.pi * 99 / 100)
        box = {
            x: tuple(sorted((sx * wide[0], sx * wide[1]))),
            y: tuple(sorted((sy * near[0], sy * near[1]))),
        }
        got = certify_sign(criterion, box, -1)
        boxes += got.boxes
        cases.append((f"corner ({sx}, {sy}): an excluded box exists", got.holds))
    return by_cases(
        cases,
        "Re(uv) Re(u conj v) < 0, so no angles in [-pi, pi] close on quaternion +1, over the boxes "
        "3/4 < |phi_2|/pi < 17/20, 19/20 < |phi_3|/pi < 99/100 in all four corners, certified with "
        f"{boxes} intervals: the corners hold excluded regions.",
        "interval arithmetic over stated boxes",
    )


def degenerate_example() -> dict[str, Any]:
    """Stiffness and torques for which a D_1 degree-6 equilibrium has a singular Hessian, exactly."""
    t_alpha, t2, t3 = _HALF, sp.Rational(1, 3), sp.Rational(1, 4)
    x, y = sp.symbols("phi_2 phi_3", real=True)
    form = half_form()
    ca, sa = rational_pair(t_alpha)
    trig = {
        ALPHA.c: ca,
        ALPHA.s: sa,
        HALF2.c: sp.cos(x / 2),
        HALF2.s: sp.sin(x / 2),
        HALF3.c: sp.cos(y / 2),
        HALF3.s: sp.sin(y / 2),
    }
    (c2, s2), (c3, s3) = rational_pair(t2), rational_pair(t3)
    at = {sp.cos(x / 2): c2, sp.sin(x / 2): s2, sp.cos(y / 2): c3, sp.sin(y / 2): s3}

    def jet(pair: Any) -> tuple[sp.Matrix, sp.Matrix]:
        """Exact gradient and Hessian of 2 atan2(Y, X)."""
        num, den = (sp.sympify(e).subs(trig) for e in pair)
        r2 = num**2 + den**2
        grad = [2 * (den * sp.diff(num, v) - num * sp.diff(den, v)) / r2 for v in (x, y)]
        hess = [[sp.diff(g, v) for v in (x, y)] for g in grad]
        return (
            sp.Matrix([sp.expand(g.subs(at)) for g in grad]),
            sp.Matrix([[sp.expand(h.subs(at)) for h in row] for row in hess]),
        )

    (g1, h1), (g4, h4) = jet(form.first), jet(form.last)
    k2 = sp.Symbol("k_2")
    sizes = [sp.Rational(n, 10) for n in (-20, -10, -5, 5, 10, 20)]
    for tau1 in sizes:
        for tau4 in sizes:
            hessian = g1 * g1.T + g4 * g4.T + tau1 * h1 + tau4 * h4 + sp.diag(2 * k2, 2)
            roots = [r for r in sp.roots(sp.Poly(hessian.det(), k2)) if r.is_rational and r > 0]
            if roots:
                return {
                    "k2": roots[0],
                    "tau": (tau1, tau4),
                    "hessian": hessian.subs(k2, roots[0]),
                    "rank": degree6(t_alpha, t2, t3).crease_matrix().rank(),
                }

    raise AssertionError("no degenerate example found")


def _milnor_identity() -> bool:
    """Hessian of half the squared distance equals the Jacobian of the end-point map.

    Manifold as a graph x(u) = (u_1, u_2, f(u)) with normal n = (-f_1, -f_2, 1): at the point
    x + v n the Hessian is x_i . x_j - v n . x_ij, and x_j . d_i(x + v n) is the same matrix.
    """
    u = sp.symbols("u_1 u_2", real=True)
    v = sp.Symbol("v", real=True)
    f = sp.Function("f")(*u)
    x = sp.Matrix([*u, f])
    n = sp.Matrix([-sp.diff(f, u[0]), -sp.diff(f, u[1]), 1])
    gaps = []
    for a in u:
        for b in u:
            hessian = sp.diff(x, a).dot(sp.diff(x, b)) - v * n.dot(sp.diff(x, a, b))
            gaps.append(sp.expand(sp.diff(x + v * n, a).dot(sp.diff(x, b)) - hessian))
        gaps.append(sp.expand(n.dot(sp.diff(x, a))))
    return all(g == 0 for g in gaps)


_NONE, _NULL, _OPEN = "empty", "of measure zero", "of positive measure"


def _check_morse(statement: str) -> Verdict:
    """Size of the set of rest angles for which the energy has a degenerate critical point.

    Not empty: a degenerate critical point at a regular state with positive stiffness.  Of measure
    zero: they are the critical values of an end-point map (Sard).
    """
    data = degenerate_example()
    singular = sp.expand(data["hessian"].det()) == 0
    if not (singular and data["k2"] > 0 and data["rank"] == 3 and _milnor_identity()):
        return Verdict("unproved", "exact example", "the degenerate example does not apply")
    if statement == _NULL:
        return Verdict("proved", "Sard's theorem", f"{_SARD[0].upper()}{_SARD[1:]}")
    if statement == _OPEN:
        return refuted(f"{_SARD[0].upper()}{_SARD[1:]}", "Sard's theorem", None)
    return as_convention(
        refuted(
            "Degree 6, D_1, tan(alpha/2) = 1/2, tan(phi_2/4) = 1/3, tan(phi_3/4) = 1/4 (regular): "
            f"with k_1 = k_3 = k_4 = 1, k_2 = {sp.N(data['k2'], 12)} (an exact rational), torques "
            f"{data['tau']} in creases 1, 4 and balancing ones in 2 and 3 the state is critical "
            "and the Hessian determinant is exactly 0.  At the flat state the space is not even a "
            "manifold.",
            "exact example",
            None,
        ),
        "True of generic rest angles on the regular part, as such sentences are often meant.",
        Correction(
            r"\text{on the regular part, for almost every }\phi^0\ "
            r"(k_i>0\text{ fixed}),\ U\text{ is a Morse function}",
            _milnor_identity,
            _SARD,
        ),
    )


_SARD = (
    "in the coordinates sqrt(k_i) phi_i the energy is half a squared distance to the rest point; its "
    "Hessian at a critical point equals the Jacobian of the end-point map x + v n, so degenerate rest "
    "points are critical values: measure zero (Sard)."
)


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


CLAIMS: list[Claim] = [
    _joint_claim(
        "s3.flat-point",
        "sec. 3.1, two regions connected by a point",
        "At pi/4 the two regions meet in one point, the flat state",
        (sp.Rational(1, 4), ((0, 0),)),
        damaged=((sp.Rational(1, 4), ((0, 0), (-1, 1), (1, -1))), (sp.Rational(1, 4), ((1, 1),))),
    ),
    Claim(
        "s3.handles",
        "sec. 3.1, 1-handles",
        "Ranges of the two 1-handles at alpha_1 = pi/3",
        (FIRST_HANDLE, SECOND_HANDLE),
        r"\{-\pi\}\times(\approx\tfrac{\pi}{2},\pi]\cup[-\pi,\approx-\tfrac{\pi}{2})\times\{\pi\}"
        r"\ \text{and}\ \{\pi\}\times(\approx-\tfrac{\pi}{2},-\pi]\cup(\approx-\tfrac{\pi}{2},\pi]"
        r"\times\{-\pi\}",
        _check_handles,
        corrected=(FIRST_HANDLE, SECOND_HANDLE_RIGHT),
        form=row(*[row(_SEGMENT, _SEGMENT)] * 2),
        damaged=(
            (SECOND_HANDLE_RIGHT, SECOND_HANDLE_RIGHT),
            (FIRST_HANDLE, (SECOND_HANDLE_RIGHT[0], ("phi_3", -1, -_HALF, 1))),
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
    Claim(
        "s3.holes",
        "sec. 3.1, holes of the admissible space",
        "At alpha_1 = pi/4 all four corners hold excluded regions",
        (sp.pi / 4, ((1, 1), (1, -1), (-1, 1), (-1, -1))),
        r"\alpha_1=\tfrac{\pi}{4}:\ \text{holes top left, top right, bottom left, bottom right}",
        _check_holes,
        damaged=((sp.pi * 5 / 12, ((1, 1), (1, -1), (-1, 1), (-1, -1))),),
        form=row(formula(), Several(row(one_of(1, -1), one_of(1, -1)))),
    ),
    Claim(
        "s3.morse",
        "sec. 3.1, 'is a Morse function'",
        "The energy is a Morse function",
        _NONE,
        r"\{\phi^0:U\text{ is no Morse function}\}=\varnothing",
        _check_morse,
        damaged=(_OPEN,),
        corrected=_NULL,
        form=one_of(_NONE, _NULL, _OPEN),
    ),
]
