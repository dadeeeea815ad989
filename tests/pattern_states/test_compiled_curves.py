"""What is compiled for curves of states says what NumPy says: where they go, which facets might touch along them."""

import numpy as np
import pytest

from origami_nlp.numerics import CLOSURE_TOL, RANK, dense
from origami_nlp.pattern_states.curve import ClosedStates
from tests.compiled_patterns import PATTERNS, with_and_without
from tests.computed_once import thinned


@pytest.fixture(params=thinned([*PATTERNS], 2))
def both(request, monkeypatch):
    return with_and_without(request.param, monkeypatch)


def test_where_curves_go(both):
    one, other = both
    rng = np.random.default_rng(1)
    x, residual = other.project(0.6 * one.pattern.signs)
    assert residual <= CLOSURE_TOL
    along = rng.normal(size=one.size)
    along /= np.linalg.norm(along)
    here, there = (ClosedStates(p).at(x, along) for p in both)
    assert np.abs(here.tangent - there.tangent).max() <= 1e-10
    assert np.abs(here.bend - there.bend).max() <= 1e-8 * (1 + np.abs(there.bend).max())
    # J t = 0, and phi'' = -J^+ c''(t, t)
    j = dense(one.closure.jacobian(x))
    assert np.abs(j @ here.tangent).max() <= 1e-12
    bent = one.closure.second(x, here.tangent[:, None])[:, 0, 0]
    expected = np.linalg.lstsq(j, -bent, rcond=RANK)[0]
    assert np.abs(here.bend - expected).max() <= 1e-6 * (1 + np.abs(expected).max())
