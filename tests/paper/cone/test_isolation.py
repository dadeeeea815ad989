"""No minimum of a branch is overlooked: enclosures of curvature, and branches that hold two interior minima."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from origami_nlp.paper import cone
from origami_nlp.paper.cone import roots as cone_roots
from tests.computed_once import thinned
from tests.independent import cone_branches as brute
from tests.paper.cone.points import points


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
    side = cone.SideEnergy.of(degree, direction, v)
    low = where * cone.Cone(degree).steep_end
    high = min(low + width, math.pi / 2)
    slowest, fastest = cone_roots.curvature_bounds(side, np.array([low]), np.array([high]))
    bend, _ = side.at(np.linspace(low, high, 40)).curvatures
    assert np.all(bend >= (side.weights @ slowest.T) - 1e-12 * np.abs(bend))
    assert np.all(bend <= (side.weights @ fastest.T) + 1e-12 * np.abs(bend))
    if width < 1e-3:  # and are tight on small cells
        assert np.all(fastest - slowest < 0.1 * np.abs(fastest) + 5)


@pytest.mark.parametrize("cells", thinned([3, 1, 50], 3))
def test_counts_do_not_depend_on_the_first_grid(cells, monkeypatch):
    cases = [(10, 0.01, -0.8), (24, 0.00167, -1.04632), (24, 0.00165, -1.04632)]
    cases += [(n, r, v) for n in (6, 12) for r, v in zip(*points(n, 25, seed=9), strict=True)]
    expected = [cone.count(*case) for case in cases]
    monkeypatch.setattr(cone_roots, "CELLS", cells)
    for case, before in zip(cases, expected, strict=True):
        now = cone.count(*case)
        assert (now.stable_interior, now.stable_contact) == (
            before.stable_interior,
            before.stable_contact,
        )
        assert now.falling_at_cut == before.falling_at_cut
        np.testing.assert_allclose(now.minima.elevation, before.minima.elevation, rtol=1e-10)


def test_isolation_is_what_finds_the_second_minimum(monkeypatch):
    """Believing every cell monotone, as a plain scan does, loses minima: the enclosures do the work."""
    expected = cone.count(24, 0.00167, -1.04632).stable_interior

    def believing(branches, low, high):
        return np.ones((len(low), 3)), np.ones((len(low), 3))

    monkeypatch.setattr(cone_roots, "CELLS", 1)
    assert cone.count(24, 0.00167, -1.04632).stable_interior == expected
    monkeypatch.setattr(cone_roots, "curvature_bounds", believing)
    assert cone.count(24, 0.00167, -1.04632).stable_interior < expected


@pytest.mark.parametrize(
    "degree, flaps, r, v",
    [
        (24, (1, 1, -1) * 4, 0.00167, -1.04632),
        (28, (1, 1, -1) * 4 + (1, -1), 0.04046638655462185, -1.2835508474576272),
    ],
)
def test_a_branch_may_hold_two_interior_minima(degree, flaps, r, v):
    """Seen with plain energies of one branch on a fine grid."""
    valleys, changes = cone.class_of(flaps)
    m = cone.count(degree, r, v).minima
    own = m.of_class(valleys, changes, 1) & m.interior
    assert own.sum() == 2
    s = np.linspace(1.0, cone.Cone(degree).steep_end, 20001)[:-1]
    angles = brute.cone_fold_angles(degree, s, flaps).value
    stiffness = np.tile([1.0, r], degree // 2)
    u = ((angles - brute.rest_angles(degree, v)) ** 2 / 2) @ stiffness
    lowest = np.nonzero((u[1:-1] < u[:-2]) & (u[1:-1] < u[2:]))[0] + 1
    assert len(lowest) == 2
    np.testing.assert_allclose(s[lowest], m.elevation[own], atol=2e-3)
