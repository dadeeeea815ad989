"""Section 3.1: the admissible space of the degree-6 vertex, its handles, and the Morse claim."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..claims._section3_joints import JOINT_CLAIMS
from ..claims.section3_degree6 import half_form
from ..decide import Correction, as_convention, by_cases, refuted
from ..identities import vanishes
from ..intervals import certify_sign
from ..rotations import rational_pair
from ..statement import Ratio, Several, formula, one_of, row
from ..states import degree6
from ..symbols import ALPHA, HALF2, HALF3

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


def _fan_closes() -> bool:
    """At alpha = pi/3 phi_2 = phi_4 = phi_6 = sigma pi closes with phi_1 = -sigma pi - 2 phi_3.

    Three flaps turn about one edge.  Put into the derived equations for phi_1/2 and phi_4/2, both signs.
    """
    form, (c3, s3) = half_form(), HALF3.pair
    third = {ALPHA.c: _HALF, ALPHA.s: sp.sqrt(3) / 2}
    gaps = []
    for sigma in (1, -1):
        at = {**third, HALF2.c: 0, HALF2.s: sigma}
        (y1, x1), (y4, x4) = ([sp.expand(e.subs(at)) for e in f] for f in (form.first, form.last))
        cos1, sin1 = -sigma * 2 * s3 * c3, -sigma * (c3**2 - s3**2)  # of phi_1/2
        gaps += [x1 * sin1 - y1 * cos1, x4 * sigma - y4 * 0]
    return all(vanishes(g, [HALF3]) for g in gaps)


def derived_segments() -> set[Segment]:
    """The edges of the chart with states beside which there are none, at alpha_1 = pi/3.

    On phi_2 = sigma pi (creases 2, 4, 6 closed to the same side; a walk round a star of three legs keeps
    it on one side) the fold limits leave |phi_3| <= 1 and |-sigma - 2 phi_3| <= 1 in units of pi, and
    the sheet criterion excludes the neighbours where cos(phi_3) < 0; phi_3 = sigma pi alike with 2, 3
    and 1, 4 exchanged.
    """
    x = sp.Symbol("x", real=True)
    found = set()
    for sigma in (1, -1):
        fan = sp.Interval(-1, 1) & sp.solveset(sp.Abs(sigma + 2 * x) <= 1, x, sp.S.Reals)
        bare = fan - sp.Interval(-_HALF, _HALF)  # cos(pi x) >= 0: states on one side of the edge
        found |= {(name, sigma, bare.inf, bare.sup) for name in ("phi_2", "phi_3")}
    return found


def _corner(segment: Segment) -> tuple[Any, Any]:
    """Corner of the chart, (phi_2, phi_3) in units of pi, at which a segment ends."""
    name, value, low, high = segment
    end = low if abs(low) == 1 else high
    return (value, end) if name == "phi_2" else (end, value)


def _check_handles(statement: tuple[tuple[Segment, ...], tuple[Segment, ...]]) -> Verdict:
    """Whether the two handles are the derived segments, two to a corner of the chart."""
    if not (_fan_closes() and _endpoint_is_right_angle()):
        return Verdict("unproved", "exact", "the states on the edges were not derived")
    derived = derived_segments()
    wrong = [
        f"{name} = {value} pi, {low} pi to {high} pi" + (" (empty)" if low >= high else "")
        for handle in statement
        for name, value, low, high in handle
        if (name, value, low, high) not in derived
    ]
    missing = derived - {s for handle in statement for s in handle}
    split = [handle for handle in statement if len({_corner(s) for s in handle}) != 1]
    if not (wrong or missing or split):
        return Verdict(
            "proved",
            "exact",
            "On the edge creases 2, 4, 6 (or 1, 3, 5) are closed and the others fan out, phi_1 + 2 phi_3 "
            "= -+pi; the sheet criterion excludes the states beside it from pi/2 to pi.",
        )
    reason = (
        f"no such segments: {'; '.join(wrong)}"
        if wrong
        else "segments missing"
        if missing
        else "segments of one handle at different corners"
    )
    return refuted(
        f"{reason[0].upper()}{reason[1:]}.",
        "exact",
        Correction(
            r"\text{second handle: }\{\pi\}\times[-\pi,-\tfrac{\pi}{2})\cup(\tfrac{\pi}{2},\pi]\times\{-\pi\}",
            lambda: _check_handles((FIRST_HANDLE, SECOND_HANDLE_RIGHT)).verdict == "proved",
            "the image of the first handle under (phi_2, phi_3) -> -(phi_2, phi_3), as turning the vertex "
            "over maps admissible states to admissible states; the ends are exactly pi/2, where the sheet "
            "criterion Re(uv) Re(u conj v) changes sign next to the edge.",
        )
        if statement == (FIRST_HANDLE, SECOND_HANDLE)
        else None,
    )


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


CLAIMS: list[Claim] = [
    JOINT_CLAIMS["s3.flat-point"],
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
            tuple(zip(FIRST_HANDLE, SECOND_HANDLE_RIGHT, strict=True)),
        ),
    ),
    JOINT_CLAIMS["s3.handle-joints"],
    JOINT_CLAIMS["s3.corner-points"],
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
