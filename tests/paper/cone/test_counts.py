"""Minima of cone branches: exact counts against brute force on every branch, and what is counted."""

import json
import math

import numpy as np
import pytest

from origami_nlp.paper import cone
from tests.command_line import run
from tests.computed_once import thinned
from tests.independent import cone_branches as brute
from tests.paper.cone.points import points


def disagreements(degree, number, seed):
    wrong = []
    for r, v in zip(*points(degree, number, seed), strict=True):
        found = cone.count(degree, r, v)
        assert not len(found.undecided)
        ours = (found.stable_interior, found.stable_contact, found.falling_at_cut)
        if ours != brute.count(degree, r, v):
            wrong.append((r, v))
    return wrong


@pytest.mark.parametrize("degree", thinned([6, 12], 2))
def test_counts_equal_brute_force(degree):
    assert disagreements(degree, 40, seed=1) == []


@pytest.mark.parametrize("degree", thinned([8, 6, 12, 10], 4))
def test_minima_of_random_branches_are_where_bisection_finds_them(degree):
    rng = np.random.default_rng(3)
    compared = 0
    for r, v in zip(*points(degree, 12, seed=4), strict=True):
        m = cone.count(degree, r, v).minima
        for _ in range(4):
            flaps = tuple(rng.choice([1, -1], degree // 2).tolist())
            direction = int(rng.choice([1, -1]))
            valleys, changes = cone.class_of(flaps)
            own = m.branches.of_class(valleys, changes, direction)
            ours = np.abs(m.elevation[own & (m.kind == "interior")])
            theirs = brute.minimum_on(degree, flaps, direction, r, v)
            assert len(ours) == len(theirs)
            np.testing.assert_allclose(ours, theirs, rtol=1e-9)
            compared += len(ours)
    assert compared > 10


# ---------------------------------------------------------------- maps


@pytest.mark.parametrize("degree", thinned([6, 130, 24], 3))
def test_maps_equal_points(degree):
    rng = np.random.default_rng(degree)
    ratios = 10 ** rng.uniform(-4, 4, 12 if degree < 100 else 4)
    elevations = [
        -cone.Cone(degree).steep_end,
        0.0,
        math.pi / 2,
        *rng.uniform(-cone.Cone(degree).steep_end, 1.57, 5),
    ]
    if degree == 24:  # where a branch holds two minima
        ratios, elevations = np.append(ratios, [0.00167, 0.00165]), [*elevations, -1.04632]
    plane = cone.count_map(degree, ratios, elevations)
    for i, r in enumerate(ratios):
        for k, v in enumerate(elevations):
            point = cone.count(degree, r, v)
            assert plane.interior[i, k] == point.stable_interior
            assert plane.contact[i, k] == point.stable_contact
            assert plane.cut[i, k] == point.falling_at_cut


# ---------------------------------------------------------------- what the command writes


def test_long_integers_are_strings(tmp_path):
    target = tmp_path / "cone.json"
    asked = "paper cone count --degree 200 --ratio 2 --rest-elevation pi/6 -o"
    assert run(*asked.split(), target).code == 0
    data = json.loads(target.read_text())
    assert data["branches"] == str(2**101)
    keys = ("stable_interior", "stable_contact", "falling_at_cut")
    number = sum(int(data[k]) for k in keys)
    assert number == sum(int(row["multiplicity"]) for row in data["classes"]) > 2**53
    for row in data["classes"]:
        assert isinstance(row["multiplicity"], int if int(row["multiplicity"]) <= 2**53 else str)
