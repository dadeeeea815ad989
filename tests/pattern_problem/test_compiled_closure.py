"""What is compiled for patterns says what NumPy says: steps onto closure, facets that cross."""

import copy
import pickle

import numpy as np
import pytest

from origami_nlp.numerics import CLOSURE_TOL, DEEP
from origami_nlp.pattern_problem import ContactPair, cross_each_other, crossings_among
from origami_nlp.pattern_problem.contact_pairs import gaps_and_rows
from tests.compiled_patterns import PATTERNS, with_and_without


@pytest.fixture(params=PATTERNS)
def both(request, monkeypatch):
    return with_and_without(request.param, monkeypatch)


def test_projections(both):
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
            begin = None if held is None else start
            x, residual = one.project(near, held, near=begin)
            y, expected = other.project(near, held, near=begin)
            # where steps of Newton end they differ by rounding over squares of small singular values
            assert (residual <= CLOSURE_TOL) == (expected <= CLOSURE_TOL)
            assert np.abs(x - y).max() <= 1e-7
            assert held is None or x[held] == near[held]
            assert one.closure.lifts_to_one(x) == other.closure.lifts_to_one(y)
    x, residual = one.project(start + 0.02 * rng.uniform(-1, 1, one.size))
    assert other.residual(x) == pytest.approx(residual, abs=1e-15) and residual <= CLOSURE_TOL


def test_problems_are_copied_and_pickled(both):
    one = both[0]
    x, residual = one.project(0.6 * one.pattern.signs)
    for copied in (pickle.loads(pickle.dumps(one)), copy.deepcopy(one)):
        y, again = copied.project(0.6 * one.pattern.signs)
        assert (x == y).all() and residual == again and copied.closure.compiled.usable
        assert (copied.crossings.placed(x) == one.crossings.placed(x)).all()


def test_where_facets_are(both):
    one, other = (p.crossings.poses for p in both)
    for phi in np.random.default_rng(3).uniform(-3, 3, (5, both[0].size)):
        for x, y in zip(one.motions(phi), other.motions(phi), strict=True):
            assert np.abs(x - y).max() <= 1e-13
            assert not x.flags.writeable


def test_hessians_of_closure(both):
    one, other = both
    rng = np.random.default_rng(5)
    for phi in rng.uniform(-2, 2, (5, one.size)):
        multipliers = rng.normal(size=one.closure.count)
        h = one.closure.hessian(phi, multipliers)
        assert np.abs(h - other.closure.hessian(phi, multipliers)).max() <= 1e-13
        assert (h == h.T).all()


def test_features_that_face_each_other(both):
    """The same features in the same order; those that rounding puts on a border or beside it are left out."""
    one, other = both
    rng, seen = np.random.default_rng(6), 0
    for size in (0.3, 1.0, 2.0):
        at = other.placed(size * rng.uniform(-1, 1, one.size))  # closed or not
        found, expected = (p.features.facing(at, 0.3137, 1e-9) for p in both)
        assert [touch for touch, _ in found] == [touch for touch, _ in expected]
        assert np.allclose([g for _, g in found], [g for _, g in expected], rtol=0, atol=1e-13)
        seen += len(found)
    assert seen or one.pattern.facets < 9
    assert one.pattern.facets < 9 or {t.type for t, _ in found} == {"edge-edge", "vertex-face"}


def test_facets_that_cross(both):
    c, rng = both[0].crossings, np.random.default_rng(2)
    # states that do not close: facets cross in all manners
    x = np.array([c.placed(phi) for phi in rng.uniform(-2, 2, (40, both[0].size))])
    first, second = np.triu_indices(len(c.pieces), 1)
    compiled = crossings_among(x, first, second, DEEP)
    reference = np.array([cross_each_other(p[first], p[second], DEEP) for p in x])
    assert reference.any() and not reference.all()
    assert (compiled == reference).all()


def test_equations_and_gaps(both):
    """Values and rows at closed states, and that sides which run along each other have no gap."""
    one, other = both
    rng, seen = np.random.default_rng(4), 0
    start, _ = other.project(0.6 * one.pattern.signs)
    for size in (0.0, 0.02, 0.1):
        x, residual = other.project(start + size * rng.uniform(-1, 1, one.size))
        values, jacobian = one.closure(x)
        expected, slopes = other.closure(x)
        assert np.abs(values - expected).max() <= 1e-14
        assert np.abs(jacobian - slopes).max() <= 1e-13
        assert one.closure.lifts_to_one(x) == other.closure.lifts_to_one(x.copy())
        if residual > CLOSURE_TOL:
            continue
        pairs = [pair for pair, _ in other.features.facing(other.placed(x), 0.3)][:60]
        if pairs:
            seen += len(pairs)
            gaps, rows = gaps_and_rows(pairs, one.placed(x))
            expected, slopes = gaps_and_rows(pairs, other.placed(x))
            assert np.abs(gaps - expected).max() <= 1e-12
            assert np.abs(rows - slopes).max() <= 1e-11 * max(1.0, np.abs(slopes).max())
    assert seen or one.pattern.cell or one.pattern.facets < 9
    side = ContactPair("edge-edge", (0, 0), (*one.pattern.polygons[0][:2],) * 2, 1.0)
    for problem in both:
        with pytest.raises(ArithmeticError, match="run along"):
            gaps_and_rows([side], problem.placed(start))
