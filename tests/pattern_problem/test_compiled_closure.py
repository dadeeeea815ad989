"""What is compiled for patterns says what NumPy says: steps onto closure, curves of states, facets that cross."""

from dataclasses import replace

import numpy as np
import pytest

from origami_nlp import examples
from origami_nlp.numerics import CLOSURE_TOL, DEEP, SWITCH
from origami_nlp.pattern_problem import PatternProblem, cross_each_other, crossings_among
from origami_nlp.pattern_states.clearance import Clearance
from origami_nlp.pattern_states.curve import ClosedStates, follow_curve
from origami_nlp.pattern_states.interpolant import interpolate
from tests.patterns import miura, strip

HOLE = ((1, 2), (1, 3), (2, 2), (2, 3))
PATTERNS = {
    "miura": lambda: examples.pattern("miura", 6, 6),
    "waterbomb": lambda: examples.pattern("waterbomb", 3, 3),
    "hole": lambda: miura(5, 5, without=HOLE),
    "strip": lambda: strip(1),
    "cell": lambda: examples.pattern("miura", 2, 2, cell=True),
}
"""Vertices, a hole (translations close as well), a pattern without symmetry, and lattice vectors."""


@pytest.fixture(params=PATTERNS)
def both(request, monkeypatch):
    """A problem with what is compiled, and the same without."""
    pattern = PATTERNS[request.param]()
    one, other = PatternProblem(pattern), PatternProblem(pattern)
    if not one.closure.compiled.usable:
        pytest.skip("no C compiler, or it is switched off")
    with monkeypatch.context() as patched:
        patched.setenv(SWITCH, "0")
        assert not other.closure.compiled.usable
    return one, other


def test_projections_and_curves(both):
    one, other = both
    rng = np.random.default_rng(1)
    start, residual = other.project(0.6 * one.pattern.signs)
    assert residual <= CLOSURE_TOL
    stays = np.zeros(one.size, bool)
    stays[rng.integers(one.size)] = True
    for held in (None, stays):
        for _ in range(3):
            near = start + 0.02 * rng.uniform(-1, 1, one.size) * (held is None)
            near[~stays] += 1e-3
            x, residual = one.project(near, held)
            y, expected = other.project(near, held)
            # where steps of Newton end they differ by rounding over squares of small singular values
            assert (residual <= CLOSURE_TOL) == (expected <= CLOSURE_TOL)
            assert np.abs(x - y).max() <= 1e-7
            assert held is None or x[held] == near[held]
            assert one.closure.lifts_to_one(x) == other.closure.lifts_to_one(y)
    x, residual = one.project(start + 0.02 * rng.uniform(-1, 1, one.size))
    assert other.residual(x) == pytest.approx(residual, abs=1e-15) and residual <= CLOSURE_TOL
    along = rng.normal(size=one.size)
    along /= np.linalg.norm(along)
    here, there = (ClosedStates(p).at(x, along) for p in both)
    assert np.abs(here.tangent - there.tangent).max() <= 1e-10
    assert np.abs(here.bend - there.bend).max() <= 1e-8 * (1 + np.abs(there.bend).max())
    # a closed curve to second order: what is left falls as the cube of the step
    assert np.abs(one.closure.jacobian(x) @ here.tangent).max() <= 1e-12
    bent = one.closure.second(x, here.tangent[:, None])[:, 0, 0]
    assert np.abs(one.closure.jacobian(x) @ here.bend + bent).max() <= 1e-6 * (
        1 + np.abs(bent).max()
    )


def test_facets_that_cross(both):
    c, rng = both[0].crossings, np.random.default_rng(2)
    # states that do not close: facets cross in all manners
    x = np.array([c.placed(phi) for phi in rng.uniform(-2, 2, (40, both[0].size))])
    first, second = np.triu_indices(len(c.pieces), 1)
    compiled = crossings_among(x, first, second, DEEP)
    reference = np.array([cross_each_other(p[first], p[second], DEEP) for p in x])
    assert reference.any() and not reference.all()
    assert (compiled == reference).all()


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
    assert (seen.crosses == told.crosses).all() and seen.unclear == told.unclear
    assert np.abs(seen.states - told.states).max() <= 1e-9
