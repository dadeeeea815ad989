"""Stable states of patterns against closed forms, scans by spherical trigonometry, and differences."""

import math

import numpy as np
import pytest

from origami_nlp.pattern import make_pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import find_states, judge, list_branches
from origami_nlp.search import descend_by_newton
from tests.independent.trigonometry import scan
from tests.patterns import miura, miura_angles, strip

VERTEX_SPRINGS = (0.005, 0.4627, 0.1299, 0.0321), (-2.163, 1.77, 2.755, 0.121)


def _miura_scan(pattern, size):
    """Energy along tan(h/2) = cos gamma tan(z/2) at its least: by thirds, no code of the package."""

    def energy(z):
        return 0.5 * np.sum((miura_angles(pattern, size, z) - pattern.rest) ** 2)

    low, high = 0.5, 2.5
    for _ in range(200):
        a, b = low + (high - low) / 3, high - (high - low) / 3
        low, high = (low, b) if energy(a) < energy(b) else (a, high)
    return 0.5 * (low + high), energy(0.5 * (low + high))


@pytest.mark.parametrize(
    ("rows", "size"),
    [
        (2, 2),
        (4, 4),
        (8, 8),
        (5, 3),
        (2, 9),
        pytest.param(32, 32, marks=pytest.mark.slow),
        (16, 16),
    ],
)
def test_miura_settles_where_its_law_says(rows, size):
    pattern = miura(rows, size)
    pattern = pattern.with_springs(1.0, list(1.2 * np.sign(miura_angles(pattern, size, 1.0))))
    zigzag, energy = _miura_scan(pattern, size)
    problem = PatternProblem(pattern)
    end = descend_by_newton(problem, miura_angles(pattern, size, 0.8))
    state = judge(problem, end.phi)
    assert (state.verdict, state.kind, state.dof) == ("minimum", "interior", 1)
    assert state.energy == pytest.approx(energy, rel=1e-12)
    assert np.abs(state.phi - miura_angles(pattern, size, zigzag)).max() < 1e-7
    # curvature per unit of the fold angles along the law: a second difference
    step = 1e-4
    way = miura_angles(pattern, size, zigzag + step) - miura_angles(pattern, size, zigzag - step)
    e = [
        0.5 * np.sum((miura_angles(pattern, size, zigzag + d) - pattern.rest) ** 2)
        for d in (-step, 0.0, step)
    ]
    curvature = (e[0] - 2 * e[1] + e[2]) / float(way @ way / 4)
    assert state.softest == pytest.approx(curvature, rel=2e-4)
    if (rows, size) == (8, 8):  # of a prototype that shares no code
        assert state.energy == pytest.approx(5.490285124421671, abs=1e-13)
        assert state.softest == pytest.approx(0.90453678, abs=5e-9)


def _same(found, expected):
    return len(found) == len(expected) and all(
        min(np.abs(s.phi - phi).max() for _, phi in expected) < 1e-6 for s in found
    )


@pytest.mark.parametrize("seed", [0, pytest.param(12, marks=pytest.mark.slow)])
def test_two_vertices_have_the_minima_of_a_scan(seed):
    _compare_strip(seed)


def _compare_strip(seed):
    pattern = strip(seed)
    result = find_states(pattern.with_contact("fold-limits"), starts=2, escape=False)
    expected = scan(pattern, 20_001 if seed in (12, 14, 15) else 2001)
    assert _same([s for s in result.minima if s.kind == "interior"], expected)
    energies = [s.energy for s in result.minima if s.kind == "interior"]
    assert energies == pytest.approx([e for e, _ in expected], abs=1e-9)
    assert (
        result.search.ended
        == result.search.curves
        == len(list_branches(PatternProblem(pattern)).lines)
    )


def test_the_flat_state():
    """Balanced springs hold it; torque that folds it away does not, whatever its sign."""
    pattern = miura(3, 3)
    assert (
        judge(PatternProblem(pattern.with_springs(1.0, [0.0] * 12)), np.zeros(12)).verdict
        == "minimum"
    )
    problem = PatternProblem(pattern)
    # rest angles that closure balances at the flat state: a combination of its equations there
    j = problem.closure.jacobian(np.zeros(12))
    rest = j.T @ np.random.default_rng(0).normal(size=j.shape[0])
    held = judge(
        PatternProblem(pattern.with_springs(1.0, list(0.5 * rest / np.abs(rest).max()))),
        np.zeros(12),
    )
    assert held.verdict == "minimum"
    lower = PatternProblem(pattern.with_springs(1.0, list(0.5 * rest / np.abs(rest).max())))
    rng = np.random.default_rng(1)
    for _ in range(30):  # no closed state beside it is lower
        phi, residual = lower.project(rng.uniform(-0.1, 0.1, 12))
        assert residual > 1e-12 or lower.energy(phi) >= lower.energy(np.zeros(12)) - 1e-14
    for sign in (1.0, -1.0):
        pulled = pattern.with_springs(1.0, list(sign * miura_angles(pattern, 3, 1.0)))
        assert judge(PatternProblem(pulled), np.zeros(12)).refuted


def test_beyond_shut_by_rounding_is_shut():
    """States of a vertex close to rounding, which may take a fully folded crease beyond pi by as much."""
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
    problem = PatternProblem(make_pattern(square, [(0, 1, 2), (0, 2, 3)], rest={(0, 2): math.pi}))
    state = judge(problem, np.array([math.pi + 1e-13]))
    assert state.verdict == "minimum" and state.phi[0] == math.pi
    assert judge(problem, np.array([math.pi + 1e-11])).verdict == "not admissible"
