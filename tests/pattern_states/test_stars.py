"""Stars: a hub of 400 creases, and sheets whose vertices have degree 8 and 4 in turn, up to 400 creases and beyond."""

import itertools
import tracemalloc

import numpy as np

from origami_nlp.kkt import State, smallest_curvature
from origami_nlp.numerics import dense
from origami_nlp.pattern import Pattern, make_pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import judge
from origami_nlp.search import descend_by_newton, given


def _stars(m: int, n: int) -> Pattern:
    """Squares with both diagonals."""
    at = np.arange((m + 1) * (n + 1)).reshape(m + 1, n + 1)
    corners = [(float(i), float(j)) for i in range(m + 1) for j in range(n + 1)]
    middles, triangles = [], []
    for i, j in itertools.product(range(m), range(n)):
        ring = [at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]]
        middle = len(corners) + len(middles)
        middles.append((i + 0.5, j + 0.5))
        triangles += [(middle, int(ring[k]), int(ring[(k + 1) % 4])) for k in range(4)]
    return make_pattern(np.array(corners + middles), triangles)


def _sprung(pattern: Pattern) -> Pattern:
    rng = np.random.default_rng(0)
    k, rest = 10 ** rng.uniform(-0.5, 0.5, pattern.creases), rng.uniform(-0.6, 0.6, pattern.creases)
    return pattern.with_springs(list(k), list(rest))


def test_choices_of_modes_at_stars_are_given_up_in_little_memory() -> None:
    problem = PatternProblem(_stars(8, 8))
    tracemalloc.start()
    cone = State(problem, np.zeros(problem.size)).tangent_cone
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert "choices of modes stay open" in cone.reason
    assert peak < 300e6


def test_a_star_beyond_dense_algebra_is_decided() -> None:
    """403 creases: closure has singular values down to 6e-4, beside which a small penalty does not show curvature."""
    pattern = _sprung(_stars(7, 10))
    problem = PatternProblem(pattern)
    assert pattern.creases == 403 and problem.sparse
    start, _ = problem.project(next(given(pattern)))
    end = descend_by_newton(problem, start)
    state = judge(problem.with_contact(False), end.phi)
    assert end.arrived and end.steps < 40 and state.verdict == "minimum"
    # curvature along an orthonormal basis of the kernel from NumPy alone
    j = problem.closure.jacobian(end.phi)
    h = problem.hessian(end.phi, problem.multipliers(end.phi)[0])
    _, values, vt = np.linalg.svd(dense(j))
    z = vt[(values > 1e-7).sum() :].T
    assert np.abs(z.T @ problem.torque(end.phi)).max() < 1e-11
    bound, _ = smallest_curvature(h, j)
    assert 0 < bound <= np.linalg.eigvalsh(z.T @ dense(h) @ z)[0]
