"""Boxes of vertices with four stable states at most: proved by Taylor models, and looked at in other ways."""

import json
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("flint")
from flint import arb_series

import origami_nlp as o
from studies.at_most_four import candidates, holds
from studies.at_most_six import Branch
from tests.independent.at_most_six import Curve, _ball
from tests.independent.one_maximum import ALL, NoCompiler, _library, proves, share

BOXES = Path(__file__).resolve().parents[2] / "docs" / "at_most_four.json"
SIX = (119, 79, 62, 100)
"""The vertex of six states, from the first of the creases that lead."""


@pytest.fixture(autouse=True)
def _compiler():
    try:
        _library()
    except NoCompiler:
        pytest.skip("there is no C compiler")


@cache
def listed():
    stated = json.loads(BOXES.read_text())
    return [tuple(b) for b in stated["boxes"]], Fraction(stated["width"])


def some(count, seed):
    boxes, width = listed()
    rng = np.random.default_rng(seed)
    return [boxes[k] for k in rng.choice(len(boxes), count, replace=False)], width, rng


def vertex_in(box, width, rng):
    """Sectors [deg] of a vertex in a box, with three decimals."""
    one, two, four = (round(float((k + rng.random()) * width), 3) for k in box)
    return [Fraction(str(x)) for x in (one, two, round(360 - one - two - four, 3), four)]


def test_some_boxes_are_proved():
    boxes, width, _ = some(12, 0)
    assert all(proves(box, width) for box in boxes)


@pytest.mark.slow
def test_all_boxes_are_proved_and_are_the_share_that_is_stated():
    boxes, width = listed()
    assert len(set(boxes)) == len(boxes) and all(proves(box, width) for box in boxes)
    page = (BOXES.parent / "results" / "most_states.md").read_text(encoding="utf-8")
    assert f"**{100 * float(share(boxes, width)):.2f} % of all vertices**" in page
    assert f"{len(boxes):,} boxes" in page


def test_the_share_is_of_all_vertices():
    """Each vertex in one numbering of four: a fourth of the volume of sectors below 180 degrees."""
    rng = np.random.default_rng(0)
    a = rng.random((200_000, 3)) * 180
    a = np.c_[a, 360 - a.sum(axis=1)]
    inside = (a[:, 3] > 0) & (a[:, 3] < 180)
    one, two, three, four = a.T
    first = (abs(one - four) > abs(two - three)) & (abs(one - two) > abs(three - four))
    assert abs((inside & first).mean() * 180**3 / float(ALL) - 1) < 0.02
    assert abs(inside.mean() * 180**3 / 4 / float(ALL) - 1) < 0.02
    assert share([(140, 60, 65), (140, 60, 60)], Fraction(1)) == 3 / ALL


def test_no_box_is_proved_that_holds_a_vertex_without_it():
    """Vertices where no gamma is good, the vertex of six, and boxes that are too wide or no vertices."""
    rng = np.random.default_rng(3)
    low = rng.random((4_000, 3)) * 180
    a = np.c_[low[:, :2], 360 - low.sum(axis=1), low[:, 2]]
    leads = abs(a[:, 0] - a[:, 3]) > abs(a[:, 1] - a[:, 2])
    leads &= abs(a[:, 0] - a[:, 1]) > abs(a[:, 2] - a[:, 3])
    a = a[leads & (a > 1).all(axis=1) & (a < 179).all(axis=1)]
    without = a[~holds(np.radians(a))]
    assert len(without) > 100
    for width in (Fraction(1), Fraction(1, 8), Fraction(1, 1000)):
        for one, two, _, four in without[:40]:
            assert not proves(tuple(int(x / width) for x in (one, two, four)), width)
    assert not proves((SIX[0] * 8, SIX[1] * 8, SIX[3] * 8), Fraction(1, 8))
    boxes, width, _ = some(3, 1)
    for one, two, four in boxes:
        assert not proves((one // 8, two // 8, four // 8), 8 * width)
    assert not proves((179, 60, 65), Fraction(2)) and not proves((20, 20, 20), Fraction(1))


@pytest.mark.parametrize("seed", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_spherical_triangles_have_a_gamma_too(seed):
    """At vertices in boxes, at places of either branch: derivatives by p of power series, by balls."""
    boxes, width, rng = some(3 if seed == 2 else 60, seed)
    for box in boxes:
        sectors = [str(float(x)) for x in vertex_in(box, width, rng)]
        for leader in (1, 2):
            curve = Curve(sectors, leader, 4)
            for y in 0.02 + 0.95 * rng.random(4):  # at the ends balls say nothing
                assert gap(curve, Fraction(y)) > 0
    assert min(gap(Curve([str(x) for x in SIX], 1, 4), Fraction(k, 20)) for k in range(1, 20)) < 0


def gap(curve, place):
    """Room for gamma, from lower and upper ends of balls."""
    _ = curve.slopes(place, Fraction(0))  # sets how many terms series have
    turns = curve.folds(arb_series([_ball(place), 1]))
    along, low, high = turns[2].rate, -np.inf, np.inf
    for turn in (turns[0], turns[1], turns[3]):
        fold = turn.rate.integral() + turn.fold
        for limit in (_ball(Fraction(1)).pi(), -_ball(Fraction(1)).pi()):
            g = (fold - limit) * turn.rate / along
            for _ in range(2):
                g = g.derivative() / along
            slope = g.derivative()
            ratio = -slope[0] / g[0]
            if g[0] > 0:
                low = max(low, float(ratio.upper()))
            else:
                assert g[0] < 0
                high = min(high, float(ratio.lower()))
    return high - low


def test_random_springs_have_one_maximum_on_each_branch():
    """The closed form as the package's claims have it; the record has two on one branch."""
    boxes, width, rng = some(6, 4)
    for box in boxes:
        sectors = vertex_in(box, width, rng)
        folds = [branch_folds(sectors, mode) for mode in (1, 2)]
        for _ in range(200):
            k, rest = rng.exponential(size=4), rng.uniform(-np.pi, np.pi, 4)
            rest = np.where(rng.random(4) < 0.5, np.sign(rest) * np.pi, rest)
            assert max(maxima(phi, k, rest) for phi in folds) <= 1
    record = (
        branch_folds([Fraction(x) for x in SIX], 1),
        branch_folds([Fraction(x) for x in SIX], 2),
    )
    k, rest = np.array([0.0129, 0.0135, 0.02, 0.0186]), np.radians([180, 180, -180, -141])
    assert max(maxima(phi, k, rest) for phi in record) == 2


def branch_folds(sectors, mode):
    """Folds [4, places] along a branch, by half angles of the closed form."""
    from studies.most_states import branch

    found = branch(
        np.radians([float(x) for x in sectors]),
        mode,
        np.sin(np.linspace(-1, 1, 2001)[1:-1] * np.pi / 2),
    )
    assert found is not None and Branch([str(x) for x in sectors], mode).leader in (1, 2)
    return found[0]


def maxima(phi, k, rest):
    energy = (k[:, None] * (phi - rest[:, None]) ** 2).sum(axis=0)
    inside = energy[1:-1]
    return int(((inside > energy[:-2]) & (inside > energy[2:])).sum())


@pytest.mark.slow
def test_searches_find_four_states_and_no_more():
    boxes, width, rng = some(60, 5)
    counts = []
    for box in boxes:
        vertex = o.Vertex.from_degrees([float(x) for x in vertex_in(box, width, rng)])
        k, rest = rng.exponential(size=4) + 0.005, rng.uniform(-np.pi, np.pi, 4)
        rest = np.where(rng.random(4) < 0.6, np.sign(rest) * np.pi, rest)
        scene = o.Scene(vertex, tuple(k), tuple(rest), symmetry="none", contact="fold-limits")
        counts.append(len(o.find_minima(scene, prove=False, escape=False).minima))
    assert max(counts) == 4


@pytest.mark.slow
def test_boxes_are_found_again():
    """Where double precision sees a gamma all boxes are that are listed."""
    boxes, width = listed()
    assert set(boxes) <= set(candidates(width))
