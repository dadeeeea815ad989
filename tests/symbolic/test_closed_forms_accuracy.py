"""Values and derivatives of the closed forms against 50-digit references."""

import numpy as np
import pytest
from mpmath import diff, mp, mpf, sin

from origami_nlp.closed_forms import (
    Reason,
    cone_fold_angles,
    cone_partial_angles,
    cone_roots,
    degree6,
    wedge3,
)
from tests.computed_once import thinned
from tests.symbolic.closed_forms_reference import (
    DIGITS,
    cone_reference,
    reflection_reference,
    wedge3_reference,
)

REGULAR = 1e-14  # relative, at condition number below 10
SINGULAR = 1e-12  # relative, within 1e-8 of a singular point
MIXED = 1e-14  # |error| <= MIXED (|phi| + sum |d phi/dx| |x|), everywhere
EXTENDED = np.finfo(np.longdouble).eps < 1e-18


@pytest.fixture(autouse=True)
def fifty_digits():
    with mp.workdps(DIGITS):
        yield


def _errors(point, references, coordinates, rows):
    """(relative error, condition number, error by conditioned size, |phi|) for matched points."""
    out = []
    for i, ref in zip(rows, references, strict=True):
        for k in (0, 1):
            error = float(abs(mpf(float(point.value[i, k])) - ref[k]))
            size = abs(float(ref[k]))
            spread = size + float(np.sum(np.abs(point.first[i, k] * coordinates[i])))
            out.append((error / size, spread / size, error / spread, size))
    return np.array(out)


def _degree6_sample(scale, count=200, seed=1):
    rng = np.random.default_rng(seed)
    alpha = rng.dirichlet([3, 3, 3], count) * np.pi
    if scale is None:
        folds = rng.uniform(-3.1, 3.1, (count, 2))
    else:
        turn = rng.uniform(0, 2 * np.pi, count)
        size = scale * 10 ** rng.uniform(-4, 0, count)
        folds = np.stack([np.cos(turn), np.sin(turn)], axis=-1) * size[:, None]
    return alpha, folds


@pytest.mark.parametrize("scale", [None, 1e-8])
def test_degree6_values(scale):
    alpha, folds = _degree6_sample(scale)
    point = degree6(alpha[:, 0], alpha[:, 1], folds[:, 0], folds[:, 1])
    references, rows = [], []
    for i, (a, f) in enumerate(zip(alpha, folds, strict=True)):
        azimuths = [mpf(a[0]), mpf(a[0]) + mpf(a[1])]
        ref = reflection_reference(azimuths, [mpf(f[0]), mpf(f[1])])
        assert (ref is not None) == (point.reason[i] == Reason.OK)
        if ref is not None:
            references.append(ref)
            rows.append(i)
    errors = _errors(point, references, folds, rows)
    assert len(errors) > 200
    assert errors[:, 2].max() <= MIXED
    assert errors[errors[:, 1] < 10, 0].max() <= REGULAR
    if scale is not None:
        assert errors[:, 0].max() <= SINGULAR


@pytest.mark.parametrize("distance", [1e-3, 1e-5, 1e-8])
def test_degree6_next_to_coinciding_mirror_creases(distance):
    """u = 0 at (pi/3, pi/3, pi/3): the true bound is eps/|u|, not 1e-12."""
    a = float(np.pi / 3)
    fold = np.pi - np.arccos(np.cos(a) / (1 + np.cos(a)))
    rng = np.random.default_rng(5)
    folds = fold + distance * rng.uniform(-1, 1, (60, 2))
    point = degree6(a, a, folds[:, 0], folds[:, 1])
    checked = 0
    for i, f in enumerate(folds):
        ref = reflection_reference([mpf(a), 2 * mpf(a)], [mpf(f[0]), mpf(f[1])])
        if ref is None or point.reason[i] != Reason.OK:
            continue
        error = max(float(abs(mpf(float(point.value[i, k])) - ref[k])) for k in (0, 1))
        steep = np.abs(point.first[i]).max()  # about 1/|u|
        assert error <= MIXED + (1e-17 if EXTENDED else 1e-14) * steep
        checked += 1
    assert checked > 10


def _wedge_sample(n, near, count=120, seed=3):
    rng = np.random.default_rng(seed + n)
    alpha = rng.uniform(0.05, np.pi / n - 0.05, count)
    v = rng.uniform(-1.5, 1.5, count)
    fold = rng.uniform(-3.1, 3.1, count)
    if near == "flat":
        v, fold = v * 1e-9, fold * 1e-9
    if near == "branches meet":
        # not also next to c_1 = c_3 (fold = pi, alpha_1 = alpha_2), which is singular by itself
        fold = rng.choice([-1, 1], count) * rng.uniform(0.3, 2.6, count)
        c, s = np.cos(np.pi / n), np.sin(np.pi / n)
        g = 2 * np.sin(alpha) * np.sin(np.pi / n - alpha) * np.sin(fold / 2) ** 2
        root = np.clip(np.sqrt(np.maximum(g * (2 * c + g), 0)) / s, 0, 1)
        side = rng.choice([-1, 1], count)
        v = side * (np.arcsin(root) + 10 ** rng.uniform(-12, -8, count))
    return alpha, v, fold


@pytest.mark.parametrize(
    "near", ["flat", "branches meet", pytest.param("", marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("n", thinned([2, 3, 5], 3))
def test_wedge3_values(n, near):
    alpha, v, fold = _wedge_sample(n, near)
    coordinates = np.stack([v, fold], axis=-1)
    for branch in (1, -1):
        point = wedge3(n, alpha, v, fold, branch)
        references, rows = [], []
        for i in range(len(alpha)):
            found, square = wedge3_reference(n, mpf(alpha[i]), mpf(v[i]), mpf(fold[i]))
            if square < 0:
                assert point.reason[i] == Reason.NO_SOLUTION
                continue
            ref = found[0 if branch == 1 else 1]
            assert (ref is not None) == (point.reason[i] == Reason.OK)
            if ref is not None:
                references.append(ref)
                rows.append(i)
        errors = _errors(point, references, coordinates, rows)
        assert len(errors) > 20
        assert errors[:, 2].max() <= MIXED
        assert errors[errors[:, 1] < 10, 0].max(initial=0) <= REGULAR
        if near and EXTENDED:  # a fold angle that happens to cross zero has no relative accuracy
            relevant = errors[:, 3] > 0.05 if near == "branches meet" else slice(None)
            assert errors[relevant, 0].max() <= SINGULAR


@pytest.mark.parametrize("degree", [6, 8, 10, 12, 50, 1000])
def test_cone_values(degree):
    for size in (1e-10, 1e-8, 1e-3, 0.3, 1.0, 1.5):
        for v in (size, -size):
            shallow, steep = cone_reference(degree, mpf(v))
            got = cone_roots(degree, v).value
            pair = cone_partial_angles(degree, v).value
            valley, mountain = (shallow, steep) if v > 0 else (steep, shallow)
            wanted = [(got[0], shallow), (got[1], steep), (got[2], shallow + steep)]
            wanted += [(pair[0], valley), (pair[1], mountain)]
            for value, ref in wanted:
                assert abs(mpf(float(value)) / ref - 1) <= REGULAR


def test_cone_fold_angles_keep_small_sums():
    v = 1e-10
    shallow, steep = cone_reference(1000, mpf(v))
    flaps = [1, -1] * 250
    angles = cone_fold_angles(1000, v, flaps).value
    assert abs(mpf(float(angles[2])) / (shallow + steep) - 1) <= REGULAR
    assert abs(float(angles[2])) < 1e-2 * abs(float(angles[1]))  # a sum of nearly opposite angles


def check_derivatives(point, one, at):
    """First and second derivatives of two fold angles, of which one(k) is the k-th, against differences of it."""
    where = tuple(mpf(x) for x in at)
    for k in (0, 1):
        for order, got in (
            ((1, 0), point.first[k, 0]),
            ((0, 1), point.first[k, 1]),
            ((2, 0), point.second[k, 0, 0]),
            ((1, 1), point.second[k, 0, 1]),
            ((0, 2), point.second[k, 1, 1]),
        ):
            exact = float(diff(one(k), where, order))
            scale = np.abs(point.first if sum(order) == 1 else point.second).max()
            assert abs(got - exact) <= 1e-12 * scale


@pytest.mark.parametrize("at", [(0.4, -1.1), (1e-4, 2e-4), (-2.0, 0.7)])
def test_degree6_derivatives(at):
    a1, a2 = 0.7, 1.3

    def one(k):
        def f(x, y):
            ref = reflection_reference([mpf(a1), mpf(a1) + mpf(a2)], [x, y])
            assert ref is not None
            return ref[k]

        return f

    point = degree6(a1, a2, *at)
    check_derivatives(point, one, at)


@pytest.mark.parametrize("n", [2, 3])
@pytest.mark.parametrize("at", [(0.9, 0.5), (-0.8, -0.4), (1e-3, 1e-4)])
def test_wedge3_derivatives(n, at):
    a1 = 0.37 * np.pi / n
    checked = 0
    for branch in (1, -1):
        point = wedge3(n, a1, *at, branch)
        if not point.ok:
            continue

        def one(k, column=0 if branch == 1 else 1):
            return lambda v, f: wedge3_reference(n, mpf(a1), v, f)[0][column][k]

        check_derivatives(point, one, at)
        checked += 1
    assert checked


@pytest.mark.parametrize("degree", [6, 8, 1000])
@pytest.mark.parametrize("v", [1e-10, -0.4, 1.2])
def test_cone_derivatives(degree, v):
    got = cone_roots(degree, v)
    for k, f in enumerate(
        (
            lambda x: cone_reference(degree, x)[0],
            lambda x: cone_reference(degree, x)[1],
            lambda x: sum(cone_reference(degree, x)),
        )
    ):
        first, second = float(diff(f, mpf(v), 1)), float(diff(f, mpf(v), 2))
        assert abs(got.first[k] - first) <= REGULAR * abs(first)
        assert abs(got.second[k] - second) <= 1e-13 * abs(second) + 1e-15 * abs(sin(mpf(v)))
