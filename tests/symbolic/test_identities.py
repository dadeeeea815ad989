"""The exact engine: normal forms, counterexamples, intervals."""

import mpmath
import pytest
import sympy as sp
from hypothesis import given, settings, strategies as st
from origami_nlp.symbolic.identities import (
    circle,
    counterexample,
    reduce,
    to_circles,
    vanishes,
)
from origami_nlp.symbolic.intervals import certify_sign

A, B = sp.symbols("a b", real=True)
CA, CB = circle(A, "a"), circle(B / 2, "b")


@pytest.mark.parametrize(
    "identity",
    [
        sp.sin(A + B) - sp.sin(A) * sp.cos(B) - sp.cos(A) * sp.sin(B),
        sp.cos(3 * A) - 4 * sp.cos(A) ** 3 + 3 * sp.cos(A),
        sp.tan(B / 2) * sp.sin(B) - (1 - sp.cos(B)),
        sp.sin(A + sp.pi / 3) - sp.sin(A) / 2 - sp.sqrt(3) / 2 * sp.cos(A),
        sp.cot(B / 2) * sp.tan(B / 2) - 1,
    ],
)
def test_identities_vanish(identity):
    assert vanishes(identity, [CA, CB])
    assert counterexample(identity, [CA, CB]) is None


@pytest.mark.parametrize(
    "wrong", [sp.sin(A) - sp.sin(B), sp.cos(A) ** 2 - 1, sp.sin(A) * sp.cos(B)]
)
def test_non_identities_have_exact_counterexamples(wrong):
    assert not vanishes(wrong, [CA, CB])
    found = counterexample(wrong, [CA, CB])
    assert found is not None
    assert found.value.is_Rational and found.value != 0


def test_an_angle_without_a_circle_is_an_error():
    with pytest.raises(ValueError, match="without a circle"):
        to_circles(sp.cos(A), [CB])
    with pytest.raises(ValueError, match="integer multiple"):
        to_circles(sp.cos(B / 4), [CB])


@settings(max_examples=25)
@given(st.floats(-3, 3), st.floats(-3, 3), st.integers(-3, 3), st.integers(-3, 3))
def test_circle_polynomials_keep_the_value(a, b, m, n):
    expr = sp.cos(m * A + n * B / 2) * sp.sin(A) ** 3 + sp.sin(n * B) ** 2
    poly = reduce(to_circles(expr, [CA, CB]), [CA, CB]).as_expr()
    a, b = sp.Float(a, 50), sp.Float(b, 50)
    point = {CA.c: sp.cos(a), CA.s: sp.sin(a), CB.c: sp.cos(b / 2), CB.s: sp.sin(b / 2)}
    gap = poly.xreplace(point) - expr.xreplace({A: a, B: b})
    assert abs(sp.N(gap, 50)) < sp.Float("1e-35", 50)


def test_normal_form_is_the_groebner_remainder():
    expr = sp.expand((CA.s + CA.c * CB.s) ** 4)
    relations = [CA.s**2 + CA.c**2 - 1, CB.s**2 + CB.c**2 - 1]
    remainder = sp.reduced(expr, relations, CA.s, CB.s, CA.c, CB.c, order="lex")[1]
    assert sp.expand(remainder - reduce(expr, [CA, CB]).as_expr()) == 0


def test_intervals_certify_and_refuse():
    x = sp.Symbol("x", real=True)
    box = {x: (sp.pi / 8, sp.pi / 3)}
    assert certify_sign(sp.sin(x) - x / 2, box, 1).holds
    wrong = certify_sign(sp.sin(x) - x / 2, box, -1)
    assert not wrong.holds and wrong.failed is not None
    assert not certify_sign(sp.cos(x) - sp.Rational(2, 3), box, 1).holds
    # one third is no binary fraction: it must enter as an interval, not as the nearest double
    assert not certify_sign(x * 3 - 1, {x: (sp.Rational(1, 3), sp.Rational(1, 3))}, 1, 10).holds
    with pytest.raises(ValueError, match="rational"):
        certify_sign(x, {x: (sp.sqrt(2), 2)}, 1)


def test_interval_bounds_agree_with_fifty_digits():
    x = sp.Symbol("x", real=True)
    with mpmath.workdps(50):
        root = mpmath.findroot(lambda t: mpmath.sin(t) - t / 3, 2.2)
        low, high = sp.Rational(str(root - mpmath.mpf("1e-9"))), sp.Rational(str(root))
    low, high = sp.Rational(low), sp.Rational(high) - sp.Rational(1, 10**12)
    assert certify_sign(sp.sin(x) - x / 3, {x: (low, high)}, 1).holds
