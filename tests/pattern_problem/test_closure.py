"""Closure and poses of patterns, against differences, closed forms and trees of creases."""

from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.numerics import dense
from origami_nlp.pattern_problem import MOST_DENSE, Closure, PatternCrossings, PatternProblem
from tests.patterns import miura, miura_angles, strip

HOLE = ((1, 2), (1, 3), (2, 2), (2, 3))


@pytest.mark.parametrize("pattern", [miura(3, 3), miura(5, 5, without=HOLE), strip(1)], ids=repr)
def test_derivatives_against_differences(pattern):
    closure, rng = Closure(pattern), np.random.default_rng(1)
    phi = rng.uniform(-1, 1, pattern.creases)
    multipliers = rng.normal(size=closure.count)
    hessian = closure.hessian(phi, multipliers)
    z = rng.normal(size=(pattern.creases, 2))
    forms = np.einsum("m,mtu->tu", multipliers, closure.second(phi, z))
    assert forms == pytest.approx(z.T @ (hessian @ z), abs=1e-11)
    j = closure.jacobian(phi)
    step = 1e-6
    for i in rng.integers(0, pattern.creases, 6):
        e = np.zeros(pattern.creases)
        e[i] = step
        slope = (closure.values(phi + e) - closure.values(phi - e)) / (2 * step)
        assert j[:, [i]] @ np.ones(1) == pytest.approx(slope, abs=1e-9)
        bent = (closure.jacobian(phi + e) - closure.jacobian(phi - e)).T @ multipliers / (2 * step)
        assert hessian[:, [i]] @ np.ones(1) == pytest.approx(bent, abs=1e-8)


@pytest.mark.parametrize("size", [2, 4, 8, 16])
def test_miura_folds_by_its_law(size):
    """tan(h/2) = cos gamma tan(z/2) closes every vertex, and facets meet at creases outside the tree of poses."""
    pattern = miura(size, size)
    for zigzag in (0.4, -1.2, 2.9):
        phi = miura_angles(pattern, size, zigzag)
        assert np.abs(Closure(pattern).values(phi)).max() < 1e-14
        assert PatternCrossings(pattern).poses.apart(phi) < 1e-12
        assert PatternCrossings(pattern).find(phi) == []


def test_a_hole_needs_equations_of_its_own():
    """Miura 5 x 5 less 2 x 2 facets: seven degrees of freedom at vertices alone, two with the hole."""
    pattern = miura(5, 5, without=HOLE)
    problem = PatternProblem(pattern)
    phi = miura_angles(pattern, 5, 1.2)
    assert problem.residual(phi) < 1e-13
    at_vertices = 3 * len(pattern.vertices)
    j = problem.closure.jacobian(phi)[:at_vertices]
    j = j if isinstance(j, np.ndarray) else j.toarray()
    assert pattern.creases - np.linalg.matrix_rank(j, 1e-7) == 7
    assert pattern.creases - problem.rank(phi) == 2


@pytest.mark.parametrize("scale", [2.0**-30, 2.0**-10, 2.0**20])
def test_the_unit_of_length_does_not_close_holes(scale):
    """By powers of two nothing rounds differently: a small sheet is as open as a large one."""
    pattern = miura(5, 5, without=HOLE)
    closure, scaled = (
        PatternProblem(replace(pattern, corners=k * pattern.corners)).closure for k in (1, scale)
    )
    phi = np.random.default_rng(0).uniform(-1, 1, pattern.creases)
    assert np.abs(closure.values(phi)[-3:]).max() > 0.1
    assert (closure.values(phi) == scaled.values(phi)).all()
    for name in ("jacobian", "hessian"):
        args = (phi,) if name == "jacobian" else (phi, np.ones(closure.count))
        one, other = (np.asarray(getattr(c, name)(*args)) for c in (closure, scaled))
        assert np.abs(one - other).max() == 0


@pytest.mark.parametrize("folded", [False, True])
def test_the_rank_of_a_large_sheet_is_that_of_all_singular_values(folded):
    """Flat, 253 singular values vanish at once: pivots count all of them."""
    pattern = o.examples.pattern("yoshimura", 15, 15)
    problem = PatternProblem(pattern)
    assert problem.size > MOST_DENSE
    phi = problem.project(0.4 * pattern.signs)[0] if folded else np.zeros(pattern.creases)
    values = np.linalg.svd(dense(problem.closure.jacobian(phi)), compute_uv=False)
    assert problem.rank(phi) == int((values > 1e-7).sum())
    if not folded:
        assert problem.rank(phi) == 2 * len(pattern.vertices)
