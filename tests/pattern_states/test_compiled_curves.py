"""What is compiled for curves of states says what NumPy says: where they go, which facets might touch along them."""

from dataclasses import replace

import numpy as np
import pytest

from origami_nlp.numerics import CLOSURE_TOL, RANK, SWITCH, dense
from origami_nlp.pattern_states.clearance import Clearance
from origami_nlp.pattern_states.curve import ClosedStates, follow_curve
from origami_nlp.pattern_states.interpolant import interpolate
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


def test_facets_that_might_touch(both, monkeypatch):
    one, other = both
    if one.pattern.cell:
        return  # gaps of copies are not asked for
    x, _ = other.project(0.3 * one.pattern.signs)
    whole = interpolate(other, follow_curve(other, x, other.kernel(x)[:, 0]))
    curve = replace(whole, states=whole.states[-13:], control=whole.control[-12:], odd=False)
    clearance, plain = Clearance(one), Clearance(other)
    motions = [one.crossings.poses.motions(phi) for phi in curve.states]
    turn, shift = (np.array(m) for m in zip(*motions, strict=True))
    ends = (turn[:-1], shift[:-1]), (turn[1:], shift[1:])
    every = np.arange(len(clearance.first))
    # of long steps more might touch
    for longer in (1.0, 30.0):
        middle = curve.control.mean(axis=1, keepdims=True)
        control = middle + longer * (curve.control - middle)
        found = clearance.touching(*ends, control, every)
        with monkeypatch.context() as patched:
            patched.setenv(SWITCH, "0")
            expected = plain.touching(*ends, control, every)
        assert plain._compiled.library is None and clearance._compiled.library is not None
        one_by_one, those = (sorted(zip(*x, strict=True)) for x in (found, expected))
        assert one_by_one == those
    seen = clearance.along(curve)
    with monkeypatch.context() as patched:
        patched.setenv(SWITCH, "0")
        told = plain.along(curve)
    assert (seen.crosses == told.crosses).all() and (seen.unclear == told.unclear).all()
    assert np.abs(seen.states - told.states).max() <= 1e-9
