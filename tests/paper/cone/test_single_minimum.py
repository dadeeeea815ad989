"""At most one interior minimum on a branch for N up to 22: proved by boxes; not so at N = 24."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from origami_nlp.paper import cone
from tests.computed_once import thinned
from tests.independent.cone_single import Range, bends, setup, undecided


def open_boxes(degree):
    classes = cone.assignment_classes(degree)
    return {
        (a, c, d): left
        for a, c in zip(classes.valleys.tolist(), classes.changes.tolist(), strict=True)
        for d in (1, -1)
        if (left := undecided(degree, a, c, d))
    }


@pytest.mark.parametrize("degree", thinned([6, 12], 2))
def test_no_branch_holds_two_interior_minima(degree):
    assert open_boxes(degree) == {}


@pytest.mark.slow
@pytest.mark.parametrize("degree", [14, 16, 18, 20, 22])
def test_no_branch_holds_two_interior_minima_up_to_degree_22(degree):
    assert open_boxes(degree) == {}


def test_the_proof_fails_where_two_minima_exist():
    """Degree 24, eight valleys in four runs, up: see `test_isolation`."""
    assert undecided(24, 8, 8, 1, levels=6) > 0
    assert undecided(24, 8, 6, 1, levels=6) == 0


@given(st.data())
@settings(max_examples=60)
def test_enclosures_hold_the_energies_derivatives(data):
    degree = data.draw(st.sampled_from([6, 8, 10, 12, 22]))
    classes = cone.assignment_classes(degree)
    row = data.draw(st.integers(0, len(classes) - 1))
    direction, side = (data.draw(st.sampled_from([1, -1])) for _ in range(2))
    valleys, changes = int(classes.valleys[row]), int(classes.changes[row])
    weights, _, _, kind = setup(degree, valleys, changes, direction, side)
    low = data.draw(st.floats(0.01, 0.95)) * cone.Cone(degree).steep_end
    high = min(low + data.draw(st.floats(1e-3, 0.2)), cone.Cone(degree).steep_end)
    rest = sorted(data.draw(st.floats(0.01, 0.99)) * cone.Cone(degree).steep_end for _ in range(2))
    s = Range(np.array([low]), np.array([high]))
    v = Range(np.array([rest[0]]), np.array([rest[1]]))
    two, three, whole, _, _, arm = bends(degree, weights, direction, kind, valleys, s, v)
    for share in (0.0, 0.3, 1.0):
        own = rest[0] + share * (rest[1] - rest[0])
        branches = cone.SideEnergy.of(degree, direction, side * own)
        points = np.linspace(low, high, 9)
        slope = branches.at(points).slopes[0][row]
        bend = branches.at(points).curvatures[0][row]
        h = 1e-5
        third = (
            branches.at(points + h).curvatures[0][row] - branches.at(points - h).curvatures[0][row]
        ) / (2 * h)
        away = points - branches.even_vertex[row]
        for enclosure, values, slack in (
            (two, bend, 1e-9),
            (three, third, 1e-5),
            (whole, bend * away - slope, 1e-9),
            (arm, away, 1e-12),
        ):
            slack = slack * (1 + np.abs(values).max())
            assert np.all(values >= enclosure.low[0] - slack)
            assert np.all(values <= enclosure.high[0] + slack)
    assert math.isfinite(whole.high[0])
