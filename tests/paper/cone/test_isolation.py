"""No minimum of a branch is overlooked: enclosures of curvature, and branches that hold two interior minima."""

import math

import numpy as np
from hypothesis import given, settings, strategies as st

from origami_nlp.paper import cone
from origami_nlp.paper.cone import roots as cone_roots


@given(
    st.sampled_from([6, 8, 10, 12, 24, 200]),
    st.floats(-1, 1),
    st.floats(0, 1),
    st.floats(1e-6, 1),
    st.sampled_from([1, -1]),
)
@settings(max_examples=150)
def test_enclosures_hold_what_they_enclose(degree, rest, where, width, direction):
    v = rest * (math.pi / 2 if rest > 0 else cone.Cone(degree).steep_end)
    every = cone.Branches.of(degree)
    every = every[every.direction == direction][:, None]
    low = where * cone.Cone(degree).steep_end
    high = min(low + width, math.pi / 2)

    def at(s):
        return cone.BranchEnergy(every, every.cone.at_rest(v), s=np.asarray(s))

    slowest, fastest = cone_roots.curvature_bounds(at(low), at(high))
    bend, _ = at(np.linspace(low, high, 40)).curvatures
    assert np.all(bend >= slowest - 1e-12 * np.abs(bend))
    assert np.all(bend <= fastest + 1e-12 * np.abs(bend))
    if width < 1e-3:  # and are tight on small cells
        assert np.all(fastest - slowest < 0.1 * np.abs(fastest) + 5 * every.cone.flaps)


def test_isolation_is_what_finds_the_second_minimum(monkeypatch):
    """Believing every cell monotone, as a plain scan does, loses minima: the enclosures do the work."""
    expected = cone.count(24, 0.00167, -1.04632).stable_interior

    def believing(low, high):
        return np.ones(low.s.shape), np.ones(low.s.shape)

    monkeypatch.setattr(cone_roots, "curvature_bounds", believing)
    assert cone.count(24, 0.00167, -1.04632).stable_interior < expected
