"""The expressions behind `origami_nlp.closed_forms`, in numerically stable form.

Each `Family` lists symbols, outputs (value, first and second derivatives) and the sentences that go
into the generated docstring.  Everything is polynomial in half-angle sines and cosines, with atan2
and one square root; nowhere an arccos.  Derivations, on top of `origami_nlp.symbolic.derive`:

degree 6 in D_1
    `reflection_form` gives phi_1 = -2 arg(u v), phi_k = 2 arg(u conj v) with u = m_w + i m_x,
    v = m_y + i m_z, modulo 2 pi with a common parity.  Both lie in [-pi, pi] on the lift q = +1
    exactly when |arg u| + |arg v| <= pi/2 (args modulo pi), that is |m_w m_y| >= |m_x m_z|.

degree 4n in D_n (creases 1, 2, 3 in a wedge pi/n)
    The equation of `dihedral_form` says that c_3 lies in the plane with normal n_3 and makes the
    angle l with c_1, cos l = p_x.  Seen from crease 1 it is
    Q_y = s (p_x c cos v - b D sin v),  Q_z = -(p_x s^2 cos v sin v + b D c),
    both over E = c^2 + s^2 sin^2 v;
    seen from crease 3 crease 1 is (s cos v, b D); c, s = cos, sin of pi/n, b = +-1 the branch and
    D^2 = 1 - p_x^2 - s^2 cos^2 v = (s sin v - kappa)(s sin v + kappa), kappa^2 = g (2 c + g),
    g = p_x - c = 2 sin alpha_1 sin alpha_2 sin^2(phi_2/2): no cancellation at the flat state.

cone of degree N
    With h = tan(v/2) the condition is a quadratic in tan(rho/2) whose roots are
    h tan(pi/4 - alpha/2) ("shallow") and -h cot(pi/4 - alpha/2) ("steep").  Their sum is
    -2 atan(tan(alpha) sin v): the odd crease between two flaps of different kind.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from .derive import ReflectionForm, reflection_form

SIGN_OF = sp.Function(
    "sign_of"
)  # +1 for arguments >= 0, else -1; printed by `origami_nlp.symbolic.generate`
POSITIVE_PART = sp.Function("positive_part")  # max(x, 0), so that roundoff on J = 0 gives no nan


@dataclass(frozen=True)
class Family:
    """One generated function: `name(*inputs)` returns the outputs as a flat tuple.

    outputs: (output name, expression), in order; derivatives are named like ``phi1_d_phi2``.
    """

    name: str
    inputs: tuple[sp.Symbol, ...]
    outputs: tuple[tuple[str, Any], ...]
    summary: str


def require_equal(left: Any, right: Any) -> None:
    """Fail generation unless two trigonometric polynomials are identical (angle addition only)."""
    gap = sp.expand(sp.expand_trig(left - right))
    for a in gap.atoms(sp.sin):
        gap = sp.expand(gap.subs(sp.cos(a.args[0]) ** 2, 1 - a**2))
    if gap != 0:
        raise AssertionError(f"the stable form differs from the derived one by {gap}")


def _jets(
    named: list[tuple[str, Any]], slopes: list[list[Any]], variables: list[sp.Symbol], total: Any
) -> list[tuple[str, Any]]:
    """Values, then all first and all second derivatives; `total(f, i)` differentiates."""
    out = list(named)
    for (name, _), slope in zip(named, slopes, strict=True):
        out += [(f"{name}_d_{v.name}", s) for v, s in zip(variables, slope, strict=True)]
    for (name, _), slope in zip(named, slopes, strict=True):
        for i, a in enumerate(variables):
            for j in range(i, len(variables)):
                out.append((f"{name}_d_{a.name}_d_{variables[j].name}", total(slope[i], j)))
    return out


def _mirror_outputs(form: ReflectionForm, variables: list[sp.Symbol]) -> list[tuple[str, Any]]:
    """phi_1, phi_k, |u|^2, |v|^2 and the margin |m_w m_y| - |m_x m_z|, with derivatives."""
    (mw, mx), (my, mz) = form.u, form.v
    lift = SIGN_OF(mw * my)  # the sign common to Re(u v) and Re(u conj v)
    (y1, x1), (y4, x4) = form.first, form.last
    values = [
        ("phi_first", 2 * sp.atan2(lift * y1, lift * x1)),
        ("phi_last", 2 * sp.atan2(lift * y4, lift * x4)),
    ]

    def slope(pair: Any, v: sp.Symbol) -> Any:
        a, b = pair
        return (a * sp.diff(b, v) - b * sp.diff(a, v)) / (a**2 + b**2)

    du = [slope(form.u, v) for v in variables]
    dv = [slope(form.v, v) for v in variables]
    slopes = [
        [-2 * (a + b) for a, b in zip(du, dv, strict=True)],
        [2 * (a - b) for a, b in zip(du, dv, strict=True)],
    ]
    jets = _jets(values, slopes, variables, lambda f, i: sp.diff(f, variables[i]))
    return [
        *jets,
        ("u_squared", mw**2 + mx**2),
        ("v_squared", my**2 + mz**2),
        ("margin", sp.Abs(mw * my) - sp.Abs(mx * mz)),
    ]


def _degree6() -> Family:
    alpha1, alpha2, phi2, phi3 = sp.symbols("alpha1 alpha2 phi2 phi3", real=True)
    derived = reflection_form([alpha1, alpha1 + alpha2], [phi2, phi3])
    (c2, s2), (c3, s3) = ((sp.cos(f / 2), sp.sin(f / 2)) for f in (phi2, phi3))
    b1, b2 = alpha1, alpha1 + alpha2
    form = ReflectionForm(  # the same, with the differences of azimuths merged into alpha_2
        (c2 * c3 - s2 * s3 * sp.cos(alpha2), s2 * c3 * sp.cos(b1) + c2 * s3 * sp.cos(b2)),
        (s2 * c3 * sp.sin(b1) + c2 * s3 * sp.sin(b2), s2 * s3 * sp.sin(alpha2)),
    )
    for ours, theirs in zip((*form.u, *form.v), (*derived.u, *derived.v), strict=True):
        require_equal(ours, theirs)
    outputs = _mirror_outputs(form, [phi2, phi3])
    return Family(
        "degree6",
        (alpha1, alpha2, phi2, phi3),
        tuple(outputs),
        "D_1, degree 6: the mirror creases 1 and 4 from the fold angles 2 and 3.",
    )


def dihedral_pieces(c: Any, s: Any, a1: Any, a2: Any, fold: Any, elev: Any, d: Any) -> Any:
    """(g, E, P, P', Q, Q'): building blocks of the D_n wedge with three creases.

    All arguments are (cos, sin) pairs except c = cos pi/n, s = sin pi/n and d = branch times D.
    fold: of phi_2/2; elev: of the elevation.  P = (p_y, p_z) is crease 3 seen from crease 1 at
    phi_1 = 0, Q the same in the folded state times E, P' and Q' are crease 1 seen from crease 3.
    """
    (c1, s1), (c2, s2), (cf, sf), (cv, sv) = a1, a2, fold, elev
    g = 2 * s1 * s2 * sf**2
    px = c + g
    first = (s - 2 * s2 * c1 * sf**2, 2 * s2 * sf * cf)
    last = (s - 2 * s1 * c2 * sf**2, 2 * s1 * sf * cf)
    e = c**2 + s**2 * sv**2
    q_first = (s * (px * c * cv - d * sv), -(px * s**2 * cv * sv + d * c))
    q_last = (s * cv, d)
    return g, e, first, last, q_first, q_last


def _dihedral3() -> Family:
    c, s, alpha1, alpha2 = sp.symbols("c s alpha1 alpha2", real=True)
    v, phi2, branch = sp.symbols("elevation phi2 branch", real=True)
    d = sp.Symbol("D", real=True)  # branch * sqrt(existence); differentiated by the chain rule
    a1, a2, fold, elev = ((sp.cos(a), sp.sin(a)) for a in (alpha1, alpha2, phi2 / 2, v))
    g, e, p, p_last, q, q_last = dihedral_pieces(c, s, a1, a2, fold, elev, d)
    sf, both = fold[1], a1[1] * a2[1]
    kappa = 2 * sp.Abs(sf) * sp.sqrt(both * (c + both * sf**2))  # sqrt(g (2 c + g)), no sqrt(2)
    existence = (s * sp.sin(v) - kappa) * (s * sp.sin(v) + kappa)
    square = s**2 * sp.sin(v) ** 2 - g * (2 * c + g)
    variables = [v, phi2]

    def total(f: Any, i: int) -> Any:
        x = variables[i]
        return sp.diff(f, x) + sp.diff(f, d) * sp.diff(square, x) / (2 * d)

    def minus(a: Any, b: Any) -> Any:
        return 2 * sp.atan2(a[1] * b[0] - a[0] * b[1], a[0] * b[0] + a[1] * b[1])

    def turn(pair: Any, norm: Any, i: int) -> Any:
        return (pair[0] * total(pair[1], i) - pair[1] * total(pair[0], i)) / norm

    ring = p[0] ** 2 + p[1] ** 2
    ring_last = p_last[0] ** 2 + p_last[1] ** 2
    slopes = [
        [2 * (turn(q, e**2 * ring, i) - turn(p, ring, i)) for i in (0, 1)],
        [2 * (turn(q_last, ring_last, i) - turn(p_last, ring_last, i)) for i in (0, 1)],
    ]
    values = [("phi1", minus(q, p)), ("phi3", minus(q_last, p_last))]
    jets = _jets(values, slopes, variables, total)
    extra = [("existence", existence), ("ring", ring), ("pole", e), ("side", q[0])]
    outputs = [(n, f.subs(d, branch * sp.sqrt(POSITIVE_PART(existence)))) for n, f in jets + extra]
    return Family(
        "dihedral3",
        (c, s, alpha1, alpha2, v, phi2, branch),
        tuple(outputs),
        "D_n wedge with three creases (degree 4n): creases 1 and 3 from (elevation, phi_2).",
    )


def _cone() -> Family:
    alpha, v = sp.symbols("alpha elevation", real=True)
    k = sp.cos(alpha) / (1 + sp.sin(alpha))  # tan(pi/4 - alpha/2) without rounding pi/4
    c, s = sp.cos(v / 2), sp.sin(v / 2)
    values = [
        ("shallow", 2 * sp.atan2(k * s, c)),
        ("steep", -2 * sp.atan2(s, k * c)),
        ("mixed", -2 * sp.atan(sp.tan(alpha) * sp.sin(v))),
    ]
    slopes = [
        [k / (c**2 + k**2 * s**2)],
        [-k / (k**2 * c**2 + s**2)],
        [-2 * sp.tan(alpha) * sp.cos(v) / (1 + (sp.tan(alpha) * sp.sin(v)) ** 2)],
    ]
    jets = _jets(values, slopes, [v], lambda f, i: sp.diff(f, v))
    return Family(
        "cone",
        (alpha, v),
        tuple(jets),
        "Cone of degree N (alpha = 2 pi/N): both partial fold angles and their sum.",
    )


def families() -> list[Family]:
    """All generated families, in file order."""
    return [_degree6(), _dihedral3(), _cone()]
