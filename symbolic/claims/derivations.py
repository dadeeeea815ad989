"""Our derivations, and the paper's three families as special cases of them."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Origin, Verdict
from ..decide import by_cases, by_identity
from ..derive import (
    ReflectionForm,
    TrigEquation,
    cyclic_form,
    dihedral_fold_form,
    dihedral_form,
    dihedral_inner_form,
    inner_product,
    last_normal,
    reflection_form,
)
from ..identities import circle
from ..rotations import E1, E2, E3, Quaternion, about, dot, planar, scale
from ..statement import Formula, Maps, has, one_of, row
from ..symbols import ALPHA, HALF2, HALF3, UPSILON, generic_crease, generic_fold

_MIRROR = circle(sp.Symbol("beta", real=True), "beta")
_B = generic_crease("2")
_F = generic_fold("2")
_LAST = generic_fold("k")
_INNER = ([_B.pair], [_F.pair])


def _check_trig(statement: int) -> Verdict:
    """Solve A cos t + B sin t = C; statement: the sign in front of B D in cos t for branch +1."""
    a, b, d = sp.symbols("A B D", real=True)
    c = sp.Symbol("C", real=True)
    equation = TrigEquation(a, b, c)
    residuals = []
    for branch in (1, -1):
        cos_t, sin_t = equation.cos_sin(branch, d)
        cos_t += (1 + statement) * branch * b * d / (a**2 + b**2)
        num, den = equation.half_tangent(branch, d)
        residuals += [
            equation.residual(cos_t, sin_t),
            cos_t**2 + sin_t**2 - 1,
            num * (1 + cos_t) - den * sin_t,
        ]
    relation = d**2 - (a**2 + b**2 - c**2)
    zero = [
        sp.reduced(sp.expand(sp.numer(sp.together(r))), [relation], d, a, b, c)[1] == 0
        for r in residuals
    ]
    return by_cases(
        [(f"residual {i}", z) for i, z in enumerate(zero)],
        "Both branches solve the equation, lie on the unit circle and agree with the half-angle "
        "quotient (B +- D)/(A + C), modulo D^2 = A^2 + B^2 - C^2; a quadratic has no third root, "
        "and real D is the existence condition A^2 + B^2 >= C^2.",
        "polynomial reduction modulo D^2",
    )


def _check_reflection(statement: Any) -> Verdict:
    """Both tangents of `ReflectionForm` must make h_x = h_z = 0 for an arbitrary inner product."""
    w, x, y, z = sp.symbols("m_w m_x m_y m_z", real=True)
    p, q = circle(sp.Symbol("phi_1") / 4, "p"), circle(sp.Symbol("phi_k") / 4, "q")
    m = Quaternion(w, x, y, z)
    h = about(E1, p.pair) * m * about(scale(-1, E1), q.pair)
    form = statement((w, x), (y, z))
    # Im(h_u h_v) and Im(h_v conj h_u) hold one unknown angle each
    double_p = (p.c**2 - p.s**2, 2 * p.c * p.s)
    double_q = (q.c**2 - q.s**2, 2 * q.c * q.s)
    residuals = [
        (h.w * h.z + h.x * h.y) - (double_p[1] * form.first[1] - double_p[0] * form.first[0]),
        (h.w * h.z - h.x * h.y) - (double_q[1] * form.last[1] - double_q[0] * form.last[0]),
    ]
    return by_identity(
        residuals,
        [p, q],
        "Im(h_u h_v) and Im(h_v conj h_u), with h_u = h_w + i h_x and h_v = h_y + i h_z, contain "
        "phi_1 alone and phi_k alone; both vanish exactly at phi_1 = -2 arg(u v), phi_k = 2 arg(u "
        "conj v), for any inner product M, hence any even degree.",
        fixed={w: 1, x: 2, y: 3, z: 5},
    )


class _Swapped(ReflectionForm):
    """A damaged form: the two mirror creases exchanged."""

    @property
    def first(self) -> Any:
        (a, b), (c, d) = self.u, self.v
        return (b * c - a * d, a * c + b * d)


def _check_dihedral(statement: Any) -> Verdict:
    """Compare A cos t + B sin t - C with the geometry it is meant to express (one inner crease)."""
    first = generic_fold("1")
    m = inner_product(*_INNER)
    wedge = about(E1, first.pair) * m * about(planar(_MIRROR.pair), _LAST.pair)
    nk = last_normal(_MIRROR.pair)
    truth = dot(E2, wedge.rotate(nk)) - dot(E2, nk)
    # the wedge uses half fold angles: its quaternion has quarter angles, so pass those as pairs
    (cp, sp_), (cq, sq) = first.pair, _LAST.pair
    double_p, double_q = (cp**2 - sp_**2, 2 * cp * sp_), (cq**2 - sq**2, 2 * cq * sq)
    by_first = statement(_MIRROR.pair, *_INNER, double_q, "first").residual(*double_p)
    by_last = statement(_MIRROR.pair, *_INNER, double_p, "last").residual(*double_q)
    return by_identity(
        [by_first - truth, by_last - truth],
        [_MIRROR, _B, _F, first, _LAST],
        "n_1 . H n_k - n_1 . n_k is linear in (cos, sin) of phi_1/2 and of phi_k/2; both solved "
        "forms reproduce it identically for an inner crease in general position and any n.",
    )


def _swapped_dihedral(*args: Any) -> TrigEquation:
    e = dihedral_fold_form(*args)
    return TrigEquation(e.B, e.A, e.C)


def _wrong_sign_dihedral(*args: Any) -> TrigEquation:
    e = dihedral_fold_form(*args)
    return TrigEquation(e.A, e.B, -e.C)


def _check_dihedral_inner(statement: Any) -> Verdict:
    """The same wedge equation, solved for the inner crease; its whole fold angle is the unknown."""
    first = generic_fold("1")
    m = inner_product(*_INNER)
    wedge = about(E1, first.pair) * m * about(planar(_MIRROR.pair), _LAST.pair)
    nk = last_normal(_MIRROR.pair)
    truth = dot(E2, wedge.rotate(nk)) - dot(E2, nk)
    equation = statement(_MIRROR.pair, *_INNER, _double(first.pair), _double(_LAST.pair), 0)
    return by_identity(
        [equation.residual(*_double(_F.pair)) - truth],
        [_MIRROR, _B, _F, first, _LAST],
        "The rotation about the inner crease is linear in (cos phi, sin phi); with phi_1 = 0 or "
        "phi_k = 0 the mirror runs through a facet, so wedges without mirror creases are covered.",
    )


def _double(pair: Any) -> Any:
    """(cos 2a, sin 2a)."""
    return (pair[0] ** 2 - pair[1] ** 2, 2 * pair[0] * pair[1])


def _unshifted_inner(*args: Any) -> TrigEquation:
    e = dihedral_inner_form(*args)
    return TrigEquation(e.A, e.B, -e.C)


def _mirrored_inner(*args: Any) -> TrigEquation:
    e = dihedral_inner_form(*args)
    return TrigEquation(e.A, -e.B, e.C)


def _check_elevation_chart(statement: Any) -> Verdict:
    """The elevation chart must satisfy c_k . n_k = 0 and the wedge equation n_1 . H n_k = ..."""
    first = circle(sp.Symbol("phi_1", real=True) / 2, "first")
    m = inner_product(*_INNER)
    form = statement(_MIRROR.pair, *_INNER, UPSILON.pair)
    nk = last_normal(_MIRROR.pair)
    c, s = first.pair
    cv, sv = UPSILON.pair

    def outer(a: Any) -> tuple[Any, Any, Any]:
        a = (a[0], a[1] * c - a[2] * s, a[1] * s + a[2] * c)
        return (cv * a[0] + sv * a[2], a[1], -sv * a[0] + cv * a[2])

    c_k = outer(m.rotate(planar(_MIRROR.pair)))
    sin_q, cos_q = form.last(c, s)
    h_nk, h_e3 = outer(m.rotate(nk)), outer(m.rotate(scale(-1, E3)))
    residuals = [
        form.equation.residual(c, s) - dot(nk, c_k),
        cos_q - dot(nk, h_nk),
        sin_q - dot(nk, h_e3),
    ]
    return by_identity(
        residuals,
        [_MIRROR, _B, _F, UPSILON, first],
        "The equation is c_k . n_k = 0 with c_k = Q(e2, v) Q(b_1, phi_1/2) M b_k, and (cos, sin) "
        "of phi_k/2 are the components of n_k along the turned half facet and its normal.",
    )


def _no_elevation(mirror: Any, azimuths: Any, folds: Any, elevation: Any) -> Any:
    return dihedral_form(mirror, azimuths, folds, (elevation[0], -elevation[1]))


def _check_cyclic(statement: Any) -> Verdict:
    """Scalar part of one period times Q(e3, 2 pi/n), for two creases in general position."""
    b1, f1 = generic_crease("1"), generic_fold("1")
    period = about(planar(b1.pair), f1.pair) * about(planar(_B.pair), _F.pair)
    scalar = (period * about(E3, _MIRROR.pair)).w
    creases, folds = [b1.pair, _B.pair], [f1.pair, _F.pair]
    first = statement(_MIRROR.pair, creases, folds, 0).residual(*f1.pair)
    second = statement(_MIRROR.pair, creases, folds, 1).residual(*_F.pair)
    goal = scalar - _MIRROR.c
    return by_identity(
        [first - goal, second - goal],
        [_MIRROR, b1, f1, _B, _F],
        "T = (one period) Q(e3, 2 pi/n) must be a rotation by 2 pi/n so that T^n is the full turn; "
        "its scalar part is linear in (cos, sin) of any one half fold angle.",
    )


def _shifted_cyclic(n: Any, creases: Any, folds: Any, unknown: int) -> TrigEquation:
    return cyclic_form(n, creases, folds, 1 - unknown)


def _check_special_degree6(statement: tuple[Any, Any]) -> Verdict:
    """Compare the derived phi_1 with the paper's -Y_6 and X_6, up to the common factor 2."""
    from ..claims.section3_degree6 import DENOMINATOR_6, NUMERATOR_6

    c, s = ALPHA.pair
    form = reflection_form([(c, s), (-c, s)], [HALF2.pair, HALF3.pair])
    ky, kx = statement
    return by_identity(
        [ky * form.first[0] - NUMERATOR_6, kx * form.first[1] - DENOMINATOR_6],
        [ALPHA, HALF2, HALF3],
        "With b_2, b_3 at alpha and pi - alpha the derived pair (y, x) is (-Y_6, X_6)/2: the "
        "paper's formula is the special case, with S_6 = +1.",
    )


def _check_special_degree8(statement: Any) -> Verdict:
    """Discriminant of the derived degree-8 equation in closed form."""
    form = dihedral_form(2, [ALPHA.pair], [HALF2.pair], UPSILON.pair)
    return by_identity(
        [form.equation.discriminant - statement],
        [ALPHA, HALF2, UPSILON],
        "A = sin(v) w_3, B = sin(v) w_2, C = -cos(v) w_1 with w = Q(b_2, phi_2) e2, so A^2 + B^2 - "
        "C^2 = sin^2(v) - sin^2(2 alpha) sin^4(phi_2/2) = J^2/16 (J with cos 2v).",
    )


def _check_special_cone(statement: tuple[Any, Any]) -> Verdict:
    """Both branches of the derived cone: tan(rho/2) = factor * tan(upsilon/2)."""
    t = sp.Symbol("t", positive=True)  # tan(upsilon/2)
    c, s = ALPHA.pair
    cv, sv = (1 - t**2) / (1 + t**2), 2 * t / (1 + t**2)
    equation = dihedral_form((c, s), [], [], (cv, sv)).equation
    # tan(pi/4 + alpha/2) = (1 + sin alpha)/cos alpha, tan(pi/4 - alpha/2) = (1 - sin alpha)/cos
    residuals = []
    for factor in statement:
        x = factor * t
        residuals.append(
            sp.numer(sp.together(equation.residual((1 - x**2) / (1 + x**2), 2 * x / (1 + x**2))))
        )
    return by_identity(
        residuals,
        [ALPHA],
        "Substituting t = tan(upsilon/2): tan(rho/2) = tan(pi/4 - alpha/2) tan(upsilon/2) and "
        "-tan(pi/4 + alpha/2) tan(upsilon/2) solve the wedge equation identically.",
        fixed={t: sp.Rational(1, 3)},
    )


_SA, _CA = ALPHA.s, ALPHA.c
_J2 = UPSILON.s**2 - (2 * _SA * _CA) ** 2 * HALF2.s**4

_PAIR = row(Formula(None), Formula(None))
_EQUATION = has(A=Formula(None), B=Formula(None), C=Formula(None))
_OWN: Origin = "own derivation"

CLAIMS: list[Claim] = [
    Claim(
        "derive.trig",
        "derivation",
        "A cos t + B sin t = C, both branches",
        -1,
        r"t=\operatorname{atan2}(B,A)\pm\operatorname{atan2}(\sqrt{A^2+B^2-C^2},C)",
        _check_trig,
        damaged=(1,),
        form=one_of(-1, 1),
        origin=_OWN,
    ),
    Claim(
        "derive.reflection",
        "derivation, D_1 of any even degree",
        "Both mirror creases in closed form",
        ReflectionForm,
        r"\phi_1=-2\arg(uv),\ \phi_{N/2+1}=2\arg(u\bar v),\ \prod_{i=2}^{N/2}q_i=u+v\,j",
        _check_reflection,
        damaged=(_Swapped,),
        form=Maps((ALPHA.pair, HALF2.pair), has(first=_PAIR, last=_PAIR)),
        origin=_OWN,
    ),
    Claim(
        "derive.dihedral",
        "derivation, D_n wedge",
        "Wedge equation in fold angles",
        dihedral_fold_form,
        r"\hat n_1\cdot\mathbf H\hat n_k=-\cos(\pi/n):\ A\cos\tfrac{\phi_1}{2}"
        r"+B\sin\tfrac{\phi_1}{2}=C",
        _check_dihedral,
        damaged=(_swapped_dihedral, _wrong_sign_dihedral),
        form=Maps((_MIRROR.pair, *_INNER, ALPHA.pair, "first"), _EQUATION),
        origin=_OWN,
    ),
    Claim(
        "derive.dihedral-inner",
        "derivation, D_n wedge",
        "Wedge equation for an inner crease",
        dihedral_inner_form,
        r"\bigl(\hat a\cdot\hat w-(\hat a\cdot\hat b)(\hat w\cdot\hat b)\bigr)\cos\phi"
        r"+\hat a\cdot(\hat b\times\hat w)\sin\phi=\hat n_1\cdot\hat n_k"
        r"-(\hat a\cdot\hat b)(\hat w\cdot\hat b)",
        _check_dihedral_inner,
        damaged=(_unshifted_inner, _mirrored_inner),
        form=Maps((_MIRROR.pair, *_INNER, ALPHA.pair, HALF2.pair, 0), _EQUATION),
        origin=_OWN,
    ),
    Claim(
        "derive.dihedral-elevation",
        "derivation, D_n wedge",
        "Wedge equation with an elevation",
        dihedral_form,
        r"\hat n_k\cdot\mathbf Q_{\hat e_2}(\upsilon)\mathbf Q_{\hat b_1}(\phi_1/2)\mathbf M"
        r"\hat b_k=0",
        _check_elevation_chart,
        damaged=(_no_elevation,),
        form=Maps(
            (_MIRROR.pair, *_INNER, UPSILON.pair),
            has(equation=_EQUATION, last=Maps(ALPHA.pair, _PAIR)),
        ),
        origin=_OWN,
    ),
    Claim(
        "derive.cyclic",
        "derivation, C_n period",
        "Period equation",
        cyclic_form,
        r"\operatorname{Sc}\bigl(\textstyle\prod q_i\,q_{\hat e_3}(2\pi/n)\bigr)=\cos(\pi/n)",
        _check_cyclic,
        damaged=(_shifted_cyclic,),
        form=Maps((_MIRROR.pair, [ALPHA.pair, _B.pair], [HALF2.pair, _F.pair], 0), _EQUATION),
        origin=_OWN,
    ),
    Claim(
        "derive.degree6",
        "derivation, special case",
        "The degree-6 form is a special case",
        (-2, 2),
        r"(y,x)=(-\mathcal Y_6,\mathcal X_6)/2",
        _check_special_degree6,
        damaged=((2, 2), (-2, -2)),
        origin=_OWN,
    ),
    Claim(
        "derive.degree8",
        "derivation, special case",
        "The degree-8 form is a special case",
        _J2,
        r"A^2+B^2-C^2=\sin^2\upsilon-\sin^2 2\alpha\,\sin^4\tfrac{\phi_2}{2}",
        _check_special_degree8,
        damaged=(UPSILON.s**2 - 2 * (_SA * _CA) ** 2 * HALF2.s**4, UPSILON.c**2 - _J2),
        form=Formula(frozenset((*ALPHA.pair, *UPSILON.pair, *HALF2.pair))),
        origin=_OWN,
    ),
    Claim(
        "derive.cone",
        "derivation, special case",
        "The cone is a special case",
        ((1 - _SA) / _CA, -(1 + _SA) / _CA),
        r"\tan\tfrac{\rho}{2}=\tan\bigl(\tfrac{\pi}{4}-\tfrac{\alpha}{2}\bigr)"
        r"\tan\tfrac{\upsilon}{2}\ \text{or}\ -\tan\bigl(\tfrac{\pi}{4}+\tfrac{\alpha}{2}\bigr)"
        r"\tan\tfrac{\upsilon}{2}",
        _check_special_cone,
        damaged=(((1 + _SA) / _CA, (1 - _SA) / _CA), ((1 + _SA) / _CA, -(1 - _SA) / _CA)),
        origin=_OWN,
    ),
]
