"""Boxes of vertices with six stable states at most: proved by Taylor models, and looked at in other ways."""

import json
from fractions import Fraction
from functools import cache
from math import factorial
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("flint")
from flint import arb_mat, arb_series

from studies.most_states import count, twice_on_a_half
from studies.two_maxima import leaves, one_on_each_half
from tests.independent.at_most_six import Curve, _ball
from tests.independent.one_maximum import ALL, NoCompiler
from tests.independent.two_maxima import SHIFTS, WHOLE, Box, _library, check, proves, share

TREE = Path(__file__).resolve().parents[2] / "docs" / "at_most_six.json"
SIX = (119, 79, 62, 100)
"""The vertex of six states, from the first of the creases that lead."""


@pytest.fixture(autouse=True)
def _compiler():
    try:
        _library()
    except NoCompiler:
        pytest.skip("there is no C compiler")


@cache
def tree():
    return "".join(json.loads(TREE.read_text())["tree"])


@cache
def boxes():
    return [Box(tuple(low), tuple(high)) for low, high in leaves(tree())]


def some(number, seed):
    rng = np.random.default_rng(seed)
    return [boxes()[k] for k in rng.choice(len(boxes()), number, replace=False)], rng


def vertex_in(box, rng):
    """Sectors [deg] of a vertex in a box, with four decimals; every other one with 180 - a for a."""
    ends = [a + (b - a) * (0.02 + 0.96 * rng.random()) for a, b in zip(*box, strict=True)]
    x, y, z = (round(end, 4) for end in ends)
    found = [Fraction(str(round(a, 4))) for a in (z, x - z, 360 - x - y + z, y - z)]
    return [180 - a for a in found] if rng.random() < 0.5 else found


def test_some_boxes_are_proved():
    for box in some(60, 0)[0]:
        assert all(any(proves(box, b, shift)[0] == 1 for shift in SHIFTS) for b in (0, 1))


@pytest.mark.slow
def test_all_boxes_are_proved_and_are_the_share_that_is_stated():
    found = list(check(tree()))
    assert found == boxes()
    page = (TREE.parent / "results" / "most_states.md").read_text(encoding="utf-8")
    assert f"**{100 * float(share(found)):.1f} % of all vertices**" in page
    assert f"{len(found):,} boxes" in page


def test_the_share_is_of_all_vertices():
    """Random vertices, numbered so that creases 1 and 2 lead, or the same with sectors 180 - a."""
    rng = np.random.default_rng(0)
    a = rng.random((6_000, 3)) * 180
    a = np.c_[a, 360 - a.sum(axis=1)]
    a = a[(a > 0).all(axis=1) & (a < 180).all(axis=1)]
    numbered = []
    for shift in range(4):
        b = np.roll(a, -shift, axis=1)
        leads = abs(b[:, 0] - b[:, 3]) > abs(b[:, 1] - b[:, 2])
        numbered.append(b[leads & (abs(b[:, 0] - b[:, 1]) > abs(b[:, 2] - b[:, 3]))])
    one, two, _, four = np.concatenate(numbered).T
    assert abs(len(one) / len(a) - 1) < 1e-12
    below = one + two < 180
    one, two, four = (np.where(below, x, 180 - x) for x in (one, two, four))
    assert ((one + two < 180) & (one + four < 180) & (two + four > 180)).all()
    place = np.array([one + np.minimum(two, four), one + np.maximum(two, four), one])
    low, high = (np.array([box[k] for box in boxes()])[:, :, None] for k in (0, 1))
    inside = sum(
        int(((low[k : k + 500] <= place) & (place < high[k : k + 500])).all(axis=1).sum())
        for k in range(0, len(low), 500)
    )
    stated, measured = float(share(iter(boxes()))), inside / len(one)
    assert abs(measured - stated) < 4 * np.sqrt(stated * (1 - stated) / len(one))
    assert share(iter([Box((100.0, 110.0, 40.0), (101.0, 111.0, 41.0))])) == 4 / ALL
    assert share(iter([Box((100.0, 100.0, 40.0), (101.0, 101.0, 41.0))])) == 2 / ALL


def test_trees_that_say_more_are_refused():
    """Another box claimed, all of them at once, a mark too many, too few, or unknown; a box that is too wide."""
    left = tree().index(".")
    box = boxes()[0]
    right = next(
        a + b
        for a, one in zip("ab", SHIFTS, strict=True)
        for b, two in zip("AB", SHIFTS, strict=True)
        if proves(box, 0, one)[0] == proves(box, 1, two)[0] == 1
    )
    assert list(check(right, box)) == [box] and list(check(".", box)) == []
    wide = Box(tuple(a - 8 for a in box.low), tuple(a + 8 for a in box.high))
    for wrong, whole, words in (
        (tree()[:left] + "aA" + tree()[left + 1 :], WHOLE, "not shown"),
        ("aA", WHOLE, "not shown"),
        (right, wide, "not shown"),
        (right + ".", box, "more than a tree"),
        (right[:1], box, "less than a tree"),
        ("3" + right * 2, box, "no mark"),
    ):
        with pytest.raises(ValueError, match=words):
            list(check(wrong, whole))


def test_no_box_is_proved_about_a_vertex_with_two_maxima_on_half_a_branch():
    """Springs that linear programs find, counted on a fine grid; the record has two on a half of both branches."""
    rng = np.random.default_rng(5)
    found = 0
    for sectors in [np.array(SIX, float), *(random_vertex(rng) for _ in range(6))]:
        for mode in (1, 2):
            margin, springs = twice_on_a_half(np.radians(sectors), mode, starts=4)
            if margin > 1e-4:
                found += 1
                assert count(np.radians(sectors), springs) >= 4
                one, two, _, four = sectors
                place = one + two, one + four, one
                tiny = Box(tuple(p - 1e-6 for p in place), tuple(p + 1e-6 for p in place))
                assert all(proves(tiny, mode - 1, shift)[0] != 1 for shift in SHIFTS)
    assert found >= 4


def random_vertex(rng):
    """Sectors [deg] numbered so that creases 1 and 2 lead."""
    while True:
        a = rng.random(3) * 180
        a = np.append(a, 360 - a.sum())
        if 10 < a.min() and a.max() < 170:
            if abs(a[0] - a[3]) > abs(a[1] - a[2]) and abs(a[0] - a[1]) > abs(a[2] - a[3]):
                return a


@pytest.mark.parametrize("number", [3, pytest.param(60, marks=pytest.mark.slow)])
def test_linear_programs_find_no_springs_with_two_maxima_on_half_a_branch(number):
    chosen, rng = some(number, 6)
    for box in chosen:
        sectors = np.radians([float(a) for a in vertex_in(box, rng)])
        for mode in (1, 2):
            assert twice_on_a_half(sectors, mode, starts=3)[0] < 1e-7


@pytest.mark.parametrize("number", [3, pytest.param(60, marks=pytest.mark.slow)])
def test_spherical_triangles_have_a_gamma_too(number):
    """At vertices in boxes, at places of either branch: Wronskians of power series, by balls."""
    chosen, rng = some(number, 7)
    for box in chosen:
        sectors = [str(float(a)) for a in vertex_in(box, rng)]
        for leader in (1, 2):
            curve = Curve(sectors, leader, 4)
            places = [Fraction(y) for y in 0.05 + 0.9 * rng.random(4)]
            assert any(all(gap(curve, y, shift) > 0 for y in places) for shift in SHIFTS)
    record = Curve([str(x) for x in SIX], 1, 4)
    for shift in SHIFTS:
        assert min(gap(record, Fraction(k, 20), shift) for k in range(1, 20)) < 0


def gap(curve, place, shift):
    """Room for gamma, from lower and upper ends of balls."""
    _ = curve.slopes(place, Fraction(0))  # sets how many terms series have
    start = [turn.rate[0] for turn in curve.folds(arb_series([_ball(Fraction(0)), 1]))]
    turns = curve.folds(arb_series([_ball(place), 1]))
    last = 3 if curve.leader == 1 else 1  # opposite the crease that leads on the other branch
    speeds = [turn.rate / first for turn, first in zip(turns, start, strict=True)]
    u, v = rows(speeds[last]), rows(speeds[2] + int(shift) * speeds[0])
    side = (u[0] * v[1] - u[1] * v[0]) * u[0]
    assert side > 0 or side < 0
    side = 1 if side > 0 else -1
    low, high = -np.inf, np.inf
    for i, turn in enumerate(turns):
        fold = turn.rate.integral() + turn.fold
        for limit in (0,) if i == last or (i == 2 and not shift) else (-1, 1):
            w = rows(turn.rate * (fold - limit * _ball(Fraction(1)).pi()))
            h, more = (
                side * arb_mat([[x[k] for k in some_] for x in (u, v, w)]).det()
                for some_ in ((0, 1, 2), (0, 1, 3))
            )
            ratio = -more / h
            if h > 0:
                low = max(low, float(ratio.upper()))
            elif h < 0:
                high = min(high, float(ratio.lower()))
            else:
                return -1.0
    return high - low


def rows(series):
    return [series[k] * factorial(k) for k in range(4)]


def test_double_precision_sees_it_wherever_it_is_proved():
    chosen, rng = some(400, 8)
    inside = np.array([[float(a) for a in vertex_in(box, rng)] for box in chosen])
    assert one_on_each_half(np.radians(inside)).all()
    assert not one_on_each_half(np.radians([SIX]))[0]


@pytest.mark.slow
def test_searches_find_no_more_than_six():
    import origami_nlp as o

    chosen, rng = some(40, 9)
    for box in chosen:
        vertex = o.Vertex.from_degrees([float(a) for a in vertex_in(box, rng)])
        k, rest = rng.exponential(size=4) + 0.005, rng.uniform(-np.pi, np.pi, 4)
        rest = np.where(rng.random(4) < 0.6, np.sign(rest) * np.pi, rest)
        scene = o.Scene(vertex, tuple(k), tuple(rest), symmetry="none", contact="fold-limits")
        assert len(o.find_minima(scene, prove=False, escape=False).minima) <= 6
