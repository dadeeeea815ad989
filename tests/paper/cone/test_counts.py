"""Minima of cone branches: exact counts against brute force on every branch, and what is counted."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from origami_nlp.paper import cone
from tests.computed_once import thinned
from tests.independent import cone_branches as brute
from tests.paper.cone.points import points


def disagreements(degree, number, seed):
    wrong = []
    for r, v in zip(*points(degree, number, seed), strict=True):
        found = cone.count(degree, r, v)
        assert not found.undecided
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
            own = m.of_class(valleys, changes, direction)
            ours = np.abs(m.elevation[own & m.interior])
            theirs = brute.minimum_on(degree, flaps, direction, r, v)
            assert len(ours) == len(theirs)
            np.testing.assert_allclose(ours, theirs, rtol=1e-9)
            compared += len(ours)
    assert compared > 10


# ---------------------------------------------------------------- what is counted


def test_multiplicities_are_exact_at_degree_1000():
    classes = cone.assignment_classes(1000)
    assert sum(classes.multiplicity) == 2**500
    found = cone.count(1000, 3.0, 0.2)
    m = found.minima
    assert found.branches == 2**501
    of_kind = {"interior": 0, "contact": 0, "cut": 0}
    for number, kind in zip(m.multiplicity, m.kind.tolist(), strict=True):
        of_kind[kind] += number
    numbers = (found.stable_interior, found.stable_contact, found.falling_at_cut)
    assert tuple(of_kind.values()) == numbers
    # (assignment, up) and (complement, down) leave the flat state with opposite slopes
    assert found.branches_with_minimum >= 2**500


@given(
    st.sampled_from([6, 8, 14, 40]),
    st.floats(-4, 4),
    st.floats(0.001, 0.999),
    st.sampled_from(["waterbomb", "paper"]),
)
@settings(max_examples=30)
def test_at_least_half_of_the_branches_hold_a_minimum(degree, exponent, share, rest):
    low = -cone.Cone(degree).steep_end
    elevation = low + share * (math.pi / 2 - low)
    found = cone.count(cone.Cone(degree, rest), 10**exponent, elevation)
    if abs(elevation) > 1e-6 and not found.undecided:
        assert 2 * found.branches_with_minimum >= found.branches
    total = found.stable_interior + found.stable_contact + found.falling_at_cut
    assert found.branches_with_minimum <= total <= 2 * found.branches
    assert np.all(found.minima.energy >= 0) and np.all(found.minima.depth <= 1)
    assert np.all(found.minima.multiplier >= 0)


def test_flat_rest_state_has_no_minimum_off_the_flat_state():
    found = cone.count(8, 2.0, 0.0)
    assert (found.stable_interior, found.stable_contact, len(found.minima)) == (0, 0, 0)


@pytest.mark.parametrize("degree", [6, 8, 12, 100])
def test_rest_state_is_a_stress_free_minimum_of_its_branch(degree):
    for v in (-cone.Cone(degree).steep_end, -0.1, 1e-9, 0.5, math.pi / 2):
        m = cone.count(degree, 1.3, v).minima
        own = (m.valleys == degree // 2) & (np.sign(m.elevation) == np.sign(v))
        k = np.nonzero(own)[0][np.argmin(np.abs(m.elevation[own] - v))]
        assert m.elevation[k] == pytest.approx(v, rel=1e-13)
        assert m.energy[k] == pytest.approx(0, abs=1e-25)
        assert m.depth[k] == pytest.approx(1, abs=1e-15)
        # at the ends of the range the stress-free state is at contact, and bears nothing
        at_end = v in (-cone.Cone(degree).steep_end, math.pi / 2)
        assert bool(m.contact[k]) == at_end and m.multiplier[k] == 0


@pytest.mark.parametrize("degree", [6, 8, 30])
def test_the_papers_rest_state_is_its_printed_formula(degree):
    alpha = 2 * math.pi / degree
    for v in (-1.2, -0.2, 0.2, 1.2):
        top, bottom = abs(math.cos(v) + math.sin(alpha)), 1 + math.cos(v) * math.sin(alpha)
        rest = cone.Cone(degree, "paper").at_rest(v)
        assert rest.odd == pytest.approx(2 * math.acos(top / bottom), rel=1e-12)
        assert rest.even == -2 * v
    for v in (0.2, 1.2):  # for v_0 > 0 it is the waterbomb
        printed, waterbomb = (cone.Cone(degree, rule).at_rest(v) for rule in ("paper", "waterbomb"))
        assert printed.odd == waterbomb.odd


def test_a_tie_is_reported():
    assert cone.count(6, 1.0, math.pi / 2).undecided == ((3, 0, 1),)


def test_depth_counts_deeper_wells_only():
    r, v = 1.3, -0.1
    every = cone.count(12, r, v)
    for depth in (1e-3, 0.05, 0.5):
        deep = cone.count(12, r, v, depth=depth)
        assert np.all(deep.minima.depth > depth)
        kept = every.minima.where(every.minima.depth > depth)
        total = deep.stable_interior + deep.stable_contact + deep.falling_at_cut
        assert sum(kept.multiplicity) == total
    assert cone.count(12, r, v, depth=0.5).stable_interior < every.stable_interior


def test_a_branch_may_hold_an_interior_minimum_and_fall_again_at_its_end():
    """Degree 10, four valleys up: over a barrier the energy falls again, to the cut and past it."""
    m = cone.count(10, 0.01, -0.8).minima
    own = (m.valleys == 4) & (m.direction == 1)
    assert m.kind[own].tolist() == ["interior", "cut"]
    side = cone.SideEnergy.of(10, 1, -0.8)
    row = cone.assignment_classes(10).index((1, 1, 1, 1, -1))
    s = np.linspace(0, cone.Cone(10).steep_end, 2001)
    odd, even = side.at(s).energies
    u = odd[row] + 0.01 * even[row]
    inner = int(np.argmin(u[:1000]))
    assert (
        0 < inner < 999 and u[inner:].max() > u[-1] > u[0]
    )  # the one at the end is above the flat state
    assert m.depth[own][1] < 0 < m.depth[own][0]


# ---------------------------------------------------------------- maps


@pytest.mark.parametrize(
    ("degree", "depth"), thinned([(n, d) for n in (6, 130, 24) for d in (0.0, 1e-3)], 6)
)
def test_maps_equal_points(degree, depth):
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
    plane = cone.count_map(degree, ratios, elevations, depth=depth)
    for i, r in enumerate(ratios):
        for k, v in enumerate(elevations):
            point = cone.count(degree, r, v, depth=depth)
            assert plane.interior[i, k] == point.stable_interior
            assert plane.contact[i, k] == point.stable_contact
            assert plane.cut[i, k] == point.falling_at_cut


def test_maps_follow_the_other_rules():
    ratios, elevations = np.geomspace(1e-3, 1e3, 9), np.linspace(-1.5, 1.5, 7)
    other = cone.Cone(8, rest="paper", end="contact")
    plane = cone.count_map(other, ratios, elevations, depth=0.02)
    for i, r in enumerate(ratios):
        for k, v in enumerate(elevations):
            point = cone.count(other, r, v, depth=0.02)
            assert plane.interior[i, k] == point.stable_interior
            assert plane.contact[i, k] == point.stable_contact
            assert plane.cut[i, k] == point.falling_at_cut
