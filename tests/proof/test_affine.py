"""Affine forms hold what they say: against 50 digits, at random points of random boxes, and at the worst corners."""

import itertools
import math

import numpy as np
import pytest
from mpmath import mp, mpf

from origami_nlp.proof.affine import (
    Affine,
    dot,
    mixed,
    turned,
    variables,
    with_centre,
)

BOXES = 5
WIDTHS = [0.0, 1e-12, 1e-7, 1e-3, 0.3, 2.0]


def random_form(rng, shape, d, width):
    """Coefficients of very different sizes, so that rounding has something to round."""

    def some(*lead):
        return rng.normal(size=(*lead, BOXES)) * 10.0 ** rng.uniform(-6, 1, (*lead, BOXES))

    return Affine(some(*shape), width * some(*shape, d), 1e-3 * width * np.abs(some(*shape)))


def exact(form, xi, eta):
    """Value in 50 digits at xi [d, K] and eta in [-1, 1], shape of the centre, as mpf objects."""
    total = np.vectorize(mpf)(form.centre) + np.vectorize(mpf)(form.error) * np.vectorize(mpf)(eta)
    for j in range(form.slopes.shape[-2]):
        total = total + np.vectorize(mpf)(form.slopes[..., j, :]) * np.vectorize(mpf)(xi[j])
    return total


def assert_holds(form, value, xi):
    """|value - centre - slopes xi| <= error, in 50 digits."""
    miss = value - exact(form, xi, np.zeros(form.centre.shape))
    assert (abs(miss) <= np.vectorize(mpf)(form.error)).all()


pytestmark = pytest.mark.usefixtures("fifty_digits")


def draws(rng, d):
    """Random points of the box, and corners of it."""
    yield rng.uniform(-1, 1, (d, BOXES))
    yield rng.choice([-1.0, 1.0], (d, BOXES))
    yield rng.choice([-1.0, 0.0, 1.0], (d, BOXES))


@pytest.mark.parametrize("width", WIDTHS)
def test_operations_hold_their_values(width):
    rng = np.random.default_rng(1)
    for _ in range(10):
        d = int(rng.integers(0, 6))
        x, y = random_form(rng, (3,), d, width), random_form(rng, (3,), d, width)
        a, b = rng.uniform(-1, 1, (2, BOXES))
        results = x + y, x - y, x * y, x.scaled(7 * a), mixed(x, a, y, b, 0.0), dot(x, y)
        for xi in draws(rng, d):
            eta = rng.choice([-1.0, 1.0], (2, 3, BOXES))
            p, q = exact(x, xi, eta[0]), exact(y, xi, eta[1])
            a_, b_ = np.vectorize(mpf)(a), np.vectorize(mpf)(b)
            values = p + q, p - q, p * q, 7 * a_ * p, a_ * p + b_ * q, (p * q).sum(axis=0)
            for form, value in zip(results, values, strict=True):
                assert_holds(form, value, xi)
                low, high = form.bounds()
                assert (np.vectorize(mpf)(low) <= value).all()
                assert (value <= np.vectorize(mpf)(high)).all()
                assert (abs(value) <= np.vectorize(mpf)(form.magnitude())).all()


def test_second_order_is_not_wasted():
    """x^2 - y^2 and a rotation of (x, y) onto itself leave a half, and no more, of what bounds apart would."""
    one = Affine(np.zeros((2, 1)), np.eye(2)[:, :, None], np.zeros((2, 1)))
    square = one[0] * one[0]
    assert square.centre[0] == 0.5 and 0.5 <= square.error[0] < 0.5 + 1e-12
    cross = dot(one, Affine(one.centre, np.array([[0.0, 1.0], [-1.0, 0.0]])[:, :, None], one.error))
    assert cross.error[0] < 1e-12  # x y - y x


@pytest.mark.parametrize("half", [0.0, 1e-9, 1e-4, 0.1, 0.5, 1.5, math.pi])
def test_turns_hold_cosine_and_sine(half):
    rng = np.random.default_rng(2)
    middle = np.append(rng.uniform(-math.pi, math.pi, BOXES - 2), [math.pi, 1e-9])
    by = with_centre(np.cos(middle), np.sin(middle), np.full(BOXES, half))
    for xi in np.linspace(-1, 1, 41):
        t = mpf(half) * mpf(xi)
        for k in range(BOXES):
            cosine, sine = mp.cos(t), mp.sin(t)
            assert abs(cosine - mpf(by.mean[k])) <= mpf(by.spread[k]) + mpf(2) ** -49
            assert abs(sine - mpf(by.slope[k]) * mpf(xi)) <= mpf(by.miss[k]) + mpf(2) ** -49
            cosine, sine = mp.cos(mpf(middle[k])), mp.sin(mpf(middle[k]))
            assert abs(cosine - mpf(by.cosine[k])) <= mpf(2) ** -50 * abs(cosine)
            assert abs(sine - mpf(by.sine[k])) <= mpf(2) ** -50 * abs(sine)


@pytest.mark.parametrize("half", [1e-8, 1e-3, 0.4, 1.5, math.pi])
def test_turning_by_a_new_variable_holds_the_turned(half):
    rng = np.random.default_rng(3)
    for _ in range(10):
        d = int(rng.integers(0, 4))
        x, y = random_form(rng, (2,), d, half), random_form(rng, (2,), d, half)
        middle = rng.uniform(-3, 3, BOXES)
        by = with_centre(np.cos(middle), np.sin(middle), np.full(BOXES, half))
        form = turned(x, y, by)
        for xi in draws(rng, d + 1):
            eta = rng.choice([-1.0, 1.0], (2, 2, BOXES))
            t = np.vectorize(lambda v: mpf(half) * mpf(v))(xi[-1])
            value = np.vectorize(mp.cos)(t) * exact(x, xi, eta[0])
            value = value + np.vectorize(mp.sin)(t) * exact(y, xi, eta[1])
            assert_holds(form, value, xi)


def test_middle_and_half_width_cover_boxes_ends_included():
    """Also after bisection: the children share their double, and together cover the parent."""
    rng = np.random.default_rng(4)
    low = rng.uniform(-math.pi, math.pi, 20_000)
    high = low + 10.0 ** rng.uniform(-16, 0, low.size)
    for lower, upper in ((low, high), (low, np.nextafter(low, 9)), (low, low)):
        middle, half = variables(lower, upper)
        for k in range(0, low.size, 97):
            m, h = mpf(middle[k]), mpf(half[k])
            assert m - h <= mpf(lower[k]) and mpf(upper[k]) <= m + h
        cut = 0.5 * (lower + upper)
        assert ((lower <= cut) & (cut <= upper)).all()


def test_products_of_tiny_numbers_are_held():
    """Underflow is an error like any other."""
    x = Affine(np.full((1, 1), 3e-200), np.full((1, 1, 1), 5e-200), np.full((1, 1), 1e-200))
    form = x * x
    for xi, eta in itertools.product((-1.0, 0.3, 1.0), (-1.0, 1.0)):
        at = np.array([[xi]])
        p = exact(x, at, np.full((1, 1), eta))
        assert_holds(form, p * p, at)
