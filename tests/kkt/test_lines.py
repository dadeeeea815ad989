"""States refuted along a line of their tangent cone, where contacts cannot be listed, and those that must not be."""

import math

import numpy as np
import pytest

from origami_nlp.kkt import State, classify
from origami_nlp.kkt.descent_witness import follow_lines
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern_problem import PatternProblem, Pull
from tests.patterns import wheel


def folded_cross():
    """One vertex with creases at 0, 60, 180 and 300 degrees, folded flat, its springs at rest there."""
    angles = np.radians([0.0, 60.0, 180.0, 300.0])
    flat = math.pi * np.array([-1.0, 1.0, -1.0, -1.0])
    return wheel(np.diff(np.r_[angles, 2 * math.pi])).with_springs(1.0, list(flat)), flat


@pytest.mark.parametrize("share", [0.5, 0.999, 1.001, 1.1, 4.0])
def test_a_line_that_first_order_leaves_level_refutes_where_it_goes_down(share):
    """Two creases that lie on each other turn as one hinge: from 8/3 N on that lowers the energy, whatever touches."""
    pattern, flat = folded_cross()
    under = PatternProblem(pattern).under(Pull(pattern, (1, 3)), 8 / 3 * share)
    state = State(under, flat)
    assert not state.contacts.complete
    what = classify(state)
    assert what.verdict == ("minimum" if share < 1 else "not stationary")
    assert (follow_lines(state) is None) == (share < 1)

    def total(phi):  # springs and the pull's work, by the law of cosines across crease 2
        cosine = math.cos(math.pi / 3) * math.cos(2 * math.pi / 3)
        cosine -= math.sin(math.pi / 3) * math.sin(2 * math.pi / 3) * math.cos(phi[1])
        distance = math.sqrt(2 - 2 * cosine)
        return 0.5 * np.sum((phi - pattern.rest) ** 2) - 8 / 3 * share * distance

    if share > 1:
        assert np.abs(PatternProblem(pattern).closure(what.lower)[0]).max() <= CLOSURE_TOL
        assert not PatternProblem(pattern).refuses(what.lower)
        gain = total(state.x) - total(what.lower)
        # two creases by u = 1e-3 / sqrt(2) each: u^2 (share - 1) to second order
        assert gain == pytest.approx((share - 1) * 5e-7, rel=2e-3)
