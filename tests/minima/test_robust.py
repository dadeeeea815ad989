"""Nothing ends a search: one crease, sides that become parallel, linear algebra that fails, time; popped vertices."""

import importlib
import math
import time

import numpy as np
import pytest

from origami_nlp import load_path
from origami_nlp.errors import OptionError
from origami_nlp.kkt import newton, project
from origami_nlp.numerics import Normal
from origami_nlp.pattern import Pattern, make_pattern
from origami_nlp.pattern_problem import (
    ContactPair,
    FoldedGeometry,
    Parallel,
    PatternProblem,
)
from origami_nlp.pattern_states import find_states
from tests.computed_once import thinned
from tests.patterns import miura

FIND = importlib.import_module("origami_nlp.pattern_states.search")


def hinge(rest: float) -> Pattern:
    """Two triangles: no vertex, no equation."""
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    return make_pattern(square, [(0, 1, 2), (0, 2, 3)]).with_springs([1.0], [rest])


@pytest.mark.parametrize("rest", thinned([math.pi, 0.5], 2))
def test_one_crease(rest):
    """There is no row of closure that could lose rank: searches and load paths met an index out of bounds."""
    found = find_states(hinge(rest), starts=2, escape=False)
    assert [s.phi.tolist() for s in found.minima] == [[pytest.approx(rest)]]
    assert found.search.curves == found.search.ended == 1
    path = load_path(hinge(0.5), 1, to=0.2, starts=2)
    assert path.legs[0].points[-1].fold_angles[0] == pytest.approx(0.7)


@pytest.mark.parametrize("rest", [3e-8, 3e-7, math.pi - 3e-8])
def test_a_minimum_beside_a_state_that_is_listed_exactly(rest):
    """The flat state, listed and not stationary, stood for the minimum 3e-8 rad beside it, which no list had."""
    found = find_states(hinge(rest), starts=2)
    assert [s.phi.tolist() for s in found.minima] == [[pytest.approx(rest, rel=1e-6)]]


def test_sides_along_each_other_have_no_gap():
    """A trial state at which a gap is not defined is none; it was a division by zero."""
    problem = PatternProblem(miura(3, 1))
    place = FoldedGeometry(problem.crossings.poses, np.zeros(2))
    touch = ContactPair("edge-edge", (0, 2), (0, 1, 4, 5), 1.0)
    assert {0, 1} <= problem.features.rings[0] and {4, 5} <= problem.features.rings[2]
    for of in (touch.gap, touch.slopes, touch.bends):
        with pytest.raises(Parallel):
            of(place)
    contact = problem.contact_of(touch)
    assert project(problem, np.zeros(2), [contact])[1] == math.inf
    assert project(problem, np.zeros(2))[1] == 0.0
    assert newton(problem, np.zeros(2), (contact,))[0] is None


def test_rows_of_very_different_lengths():
    """Rounding of the square of the longest exceeds the weight: "J J' is not positive definite" it was."""
    j, c = np.array([[1e8, 1e8, 0.0], [0.0, 0.3, 0.1], [1e8, 1e8, 0.0]]), np.array([1e3, 0.2, 1e3])
    normal = Normal(j)
    assert np.allclose(j @ normal.step(c), c, rtol=1e-4)
    balanced = j.T @ normal.multipliers(j.T @ [1e-8, 2.0, 0.0])
    assert np.allclose(balanced, j.T @ [1e-8, 2.0, 0.0], rtol=1e-6)


def test_a_failure_is_counted_and_ends_nothing(monkeypatch):
    pattern, judge_end, calls = miura(2, 2), FIND.judge_end, []

    def failing(*given, **named):
        calls.append(1)
        if len(calls) == 2:
            raise np.linalg.LinAlgError("SVD did not converge")
        return judge_end(*given, **named)

    whole = find_states(pattern.with_contact("fold-limits"), starts=2, escape=False)
    monkeypatch.setattr(FIND, "judge_end", failing)
    found = find_states(pattern.with_contact("fold-limits"), starts=2, escape=False)
    assert found.search.failed == {"LinAlgError: SVD did not converge": 1}
    assert len(whole.minima) - 1 <= len(found.minima) <= len(whole.minima)
    assert not whole.search.failed


def test_seconds_are_those_of_a_clock():
    """The escape paths from a sheet of 1,104 creases are not gone through in half a second, nor is more time taken."""
    begun = time.process_time()
    found = find_states("miura:24x24", seconds=0.5)
    assert found.search.left_out and time.process_time() - begun < 6.0
    with pytest.raises(OptionError, match="the time was over"):
        load_path("metasheet:3x3", [1, 2], to=0.05, seconds=0.0)
