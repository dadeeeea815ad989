"""The stable expressions solve the equations of `origami_nlp.symbolic.derive`: exact polynomial identities."""

import pytest
import sympy as sp
from origami_nlp.symbolic.derive import dihedral_form, reflection_form
from origami_nlp.symbolic.generate_forms import dihedral_pieces, families, require_equal
from origami_nlp.symbolic.identities import circle, to_circles, vanishes

A1, A2, FOLD, ELEV = sp.symbols("alpha1 alpha2 phi2 v", real=True)
CIRCLES = [circle(A1, "1"), circle(A2, "2"), circle(FOLD / 2, "f"), circle(ELEV, "v")]
D = sp.Symbol("D", real=True)


def _wedge():
    """Pieces, derived form, and cos t, sin t of both mirror creases over a common denominator."""
    one, two, fold, elev = (c.pair for c in CIRCLES)
    mirror = (one[0] * two[0] - one[1] * two[1], one[1] * two[0] + one[0] * two[1])
    form = dihedral_form(mirror, [one], [fold], elev)
    pieces = dihedral_pieces(*mirror, one, two, fold, elev, D)
    return form, mirror, pieces


def _zero_with_root(expr, square):
    """Whether a polynomial in D vanishes when D^2 = square, for all angles."""
    even, odd = sp.Integer(0), sp.Integer(0)
    for (power,), coefficient in sp.Poly(sp.expand(expr), D).terms():
        term = coefficient * square ** (power // 2)
        even, odd = (even + term, odd) if power % 2 == 0 else (even, odd + term)
    return vanishes(even, CIRCLES) and vanishes(odd, CIRCLES)


@pytest.mark.slow
def test_wedge3_solves_the_derived_equation_on_both_branches():
    form, mirror, (g, e, p, _, q, _) = _wedge()
    c, s = mirror
    sv = CIRCLES[3].s
    ring = p[0] ** 2 + p[1] ** 2
    square = s**2 * sv**2 - g * (2 * c + g)
    cos_t, sin_t = p[0] * q[0] + p[1] * q[1], p[0] * q[1] - p[1] * q[0]  # times e * ring
    eq = form.equation
    assert _zero_with_root(eq.A * cos_t + eq.B * sin_t - eq.C * e * ring, square)
    assert _zero_with_root(q[0] ** 2 + q[1] ** 2 - e**2 * ring, square)
    assert vanishes(eq.discriminant - square, CIRCLES)
    damaged = eq.A * cos_t - eq.B * sin_t - eq.C * e * ring
    assert not _zero_with_root(damaged, square)


@pytest.mark.slow
def test_wedge3_last_crease_equals_the_derived_one():
    form, mirror, (g, e, p, p_last, q, q_last) = _wedge()
    c, s = mirror
    sv = CIRCLES[3].s
    ring = p[0] ** 2 + p[1] ** 2
    square = s**2 * sv**2 - g * (2 * c + g)
    scale = e * ring
    cos_t, sin_t = p[0] * q[0] + p[1] * q[1], p[0] * q[1] - p[1] * q[0]
    t = sp.symbols("x_t y_t")
    sin_k, cos_k = form.last(*t)
    swap = {t[0]: cos_t / scale, t[1]: sin_t / scale}
    ours = (
        p_last[0] * q_last[1] - p_last[1] * q_last[0],
        sum(a * b for a, b in zip(p_last, q_last, strict=True)),
    )
    ring_last = p_last[0] ** 2 + p_last[1] ** 2
    assert vanishes(ring_last - ring, CIRCLES)
    for derived, stable in ((sin_k, ours[0]), (cos_k, ours[1])):
        numerator = sp.fraction(sp.together(derived.subs(swap) - stable / ring))[0]
        assert _zero_with_root(numerator, square)


def test_degree6_pieces_equal_the_derived_quaternion():
    a1, a2, two, three = sp.symbols("alpha1 alpha2 phi2 phi3", real=True)
    circles = [circle(a1, "a"), circle(a2, "b"), circle(two / 2, "2"), circle(three / 2, "3")]
    form = reflection_form([a1, a1 + a2], [two, three])
    outputs = dict(next(f for f in families() if f.name == "degree6").outputs)
    (mw, mx), (my, mz) = form.u, form.v
    assert vanishes(outputs["u_squared"] - (mw**2 + mx**2), circles)
    assert vanishes(outputs["v_squared"] - (my**2 + mz**2), circles)
    value = outputs["phi_first"].args[1]  # 2 atan2(sheet y, sheet x)
    y, x = (to_circles(a, circles) for a in value.args)
    sheet = next(iter(value.args[0].atoms(sp.core.function.AppliedUndef)))
    sheet = to_circles(sheet, circles)
    assert vanishes(y / sheet + (mw * mz + mx * my), circles)
    assert vanishes(x / sheet - (mw * my - mx * mz), circles)


def test_generation_stops_when_a_stable_form_is_wrong():
    a = sp.Symbol("a", real=True)
    require_equal(sp.sin(a + 1), sp.sin(a) * sp.cos(1) + sp.cos(a) * sp.sin(1))
    try:
        require_equal(sp.sin(2 * a), sp.sin(a) * sp.cos(a))
    except AssertionError:
        return
    raise AssertionError("a wrong identity passed")
