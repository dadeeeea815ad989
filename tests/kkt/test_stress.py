"""Multipliers of closure and states of self-stress, on differences of loops of rotations by scipy."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from origami_nlp import Scene, Vertex
from origami_nlp.kkt import State, find_stress
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.pattern_states import judge
from origami_nlp.search import descend_by_newton
from tests.patterns import metasheet, miura, miura_angles

RANK = 1e-6
"""Of differences: singular values that vanish are below 1e-9 here, others above 1e-3."""


def turns(pattern, loop, phi):
    """Rotations up to each crease of a loop, and the last."""
    out = [Rotation.identity()]
    for c, s in zip(loop.creases, loop.signs, strict=True):
        out.append(out[-1] * Rotation.from_rotvec(s * phi[c] * pattern.directions[c]))
    return out


def slopes(pattern, phi, h=1e-6):
    """Derivatives of the vector parts of the quaternions of all vertices by fold angles, differences, [m, n]."""
    out = np.zeros((len(pattern.vertices), 3, len(phi)))

    def vector(loop, c, step):
        x = phi.copy()
        x[c] += step
        q = turns(pattern, loop, x)[-1].as_quat()
        return np.copysign(1.0, q[3]) * q[:3]

    for v, loop in enumerate(pattern.vertices):
        for c in loop.creases:
            out[v, :, c] = (vector(loop, c, h) - vector(loop, c, -h)) / (2 * h)
    return out.reshape(-1, len(phi))


def rank(matrix):
    return int((np.linalg.svd(matrix, compute_uv=False) > RANK).sum())


@pytest.mark.parametrize("size", [(2, 2), (2, 5), (3, 3), (3, 4), (5, 3), (4, 4), (6, 5)])
def test_a_folded_miura_has_a_stress_for_each_facet_inside(size):
    """(m - 2)(n - 2) stresses, of which springs feel nothing, whatever the springs; one a vertex where it is flat."""
    m, n = size
    pattern = miura(m, n)
    phi, j = miura_angles(pattern, n, 1.2), slopes(pattern, miura_angles(pattern, n, 1.2))
    stress = find_stress(State(PatternProblem(pattern), phi))
    assert stress.states == stress.basis.shape[1] == (m - 2) * (n - 2) == len(j) - rank(j)
    assert stress.basis.T @ stress.basis == pytest.approx(np.eye(stress.states), abs=1e-12)
    assert np.abs(j.T @ stress.basis).max(initial=0.0) < 1e-9
    flat = find_stress(State(PatternProblem(pattern), np.zeros(pattern.creases)))
    assert flat.states == len(pattern.vertices)
    # axes of creases lie in the sheet: what they do not feel are moments about its normal
    assert np.abs(flat.basis.reshape(-1, 3, flat.states)[:, :2]).max() < 1e-12


def stable(pattern, start):
    problem = PatternProblem(pattern)
    state = judge(problem, descend_by_newton(problem, start).phi)
    assert state.verdict == "minimum" and state.kind == "interior"
    return problem, state.phi


def redundant():
    """Stable states at which rows of closure depend on each other: of springs that are not those of its symmetry."""
    rng = np.random.default_rng(4)
    pattern = miura(4, 5)
    start = miura_angles(pattern, 5, 1.0)
    rest = 1.2 * np.sign(start) + rng.uniform(-0.3, 0.3, pattern.creases)
    yield stable(
        pattern.with_springs(list(rng.uniform(0.5, 2, pattern.creases)), list(rest)), start
    )
    pattern, classes = metasheet(4)
    k, rest = rng.uniform(0.5, 2, pattern.creases), np.array((1.686, -0.133, 1.719, 0.126))[classes]
    problem = PatternProblem(pattern)
    start, residual = problem.project(0.5 * rest)
    assert residual < 1e-12
    yield stable(pattern.with_springs(list(k), list(0.6 * rest)), start)


def test_multipliers_balance_whatever_stress_is_added():
    for problem, phi in redundant():
        pattern = problem.pattern
        springs = pattern.stiffness * (phi - pattern.rest)
        stress, j = find_stress(State(problem, phi)), slopes(pattern, phi)
        assert stress.states == len(j) - rank(j) > 0 and stress.unique
        assert stress.left < 1e-11 < 1e-3 < np.abs(springs).max()
        assert stress.torque == pytest.approx(springs, abs=1e-11)
        assert np.abs(stress.basis.T @ stress.multipliers).max() < 1e-9  # of smallest norm
        rng = np.random.default_rng(0)
        for _ in range(5):
            lam = stress.multipliers + stress.basis @ rng.normal(size=stress.states)
            assert np.abs(lam - stress.multipliers).max() > 0.1
            assert j.T @ lam == pytest.approx(springs, abs=1e-8)
            # half of them about the axes of a crease where turns have brought it, at both of its ends
            carried = np.zeros(pattern.creases)
            for loop, moment in zip(pattern.vertices, lam.reshape(-1, 3), strict=True):
                before = turns(pattern, loop, phi)
                for k, (c, s) in enumerate(zip(loop.creases, loop.signs, strict=True)):
                    carried[c] += 0.5 * moment @ before[k].apply(s * pattern.directions[c])
            assert carried == pytest.approx(springs, abs=1e-11)


def test_what_held_creases_feel_is_not_unique():
    """Stresses of the free creases that held ones feel leave torques open; those of all creases are counted alone."""
    pattern = miura(4, 4)
    problem = PatternProblem(pattern.with_springs(1.0, list(np.linspace(-1, 1, pattern.creases))))
    phi = miura_angles(pattern, 4, 1.2)
    rng, seen = np.random.default_rng(1), set()
    j = slopes(pattern, phi)
    for many in (0, 1, 2, 4, 8, 16):
        held = rng.choice(pattern.creases, many, replace=False)
        free = np.setdiff1d(np.arange(pattern.creases), held)
        stress = find_stress(State(problem, phi), held.tolist())
        assert stress.states == len(j) - rank(j)
        assert stress.unique == (rank(j[:, free]) == rank(j))
        assert np.abs(j.T @ stress.basis).max() < 1e-9
        # what is left is as little as multipliers can leave to free creases
        springs = problem.pattern.stiffness * (phi - problem.pattern.rest)
        best = np.linalg.lstsq(j[:, free].T, springs[free], rcond=RANK)[0]
        least = np.abs(springs[free] - j[:, free].T @ best).max()
        assert stress.left == pytest.approx(least, abs=1e-6)
        seen.add(stress.unique)
    assert seen == {True, False}


def test_a_vertex_has_a_stress_where_its_closure_loses_rank():
    """None where it is folded; one where it is flat: axes of creases do not feel moments about the sheet's normal."""
    for degree in (4, 5, 8):
        rng = np.random.default_rng(degree)
        sectors = rng.uniform(0.5, 1.5, degree)
        vertex = Vertex(tuple(2 * math.pi * sectors / sectors.sum()))
        k, rest = rng.uniform(0.5, 2, degree), rng.uniform(-1, 1, degree)
        model = pose(Scene(vertex, tuple(k), tuple(rest), "none", "fold-limits"))
        phi, residual = model.project(rest)
        assert residual < 1e-12
        folded, flat = (find_stress(State(model, x)) for x in (phi, np.zeros(degree)))
        assert (folded.states, flat.states) == (0, 1)
        j = model.closure.jacobian(phi)
        torque = k * (phi - rest)
        best = np.linalg.lstsq(j.T, torque, rcond=None)[0]
        assert folded.multipliers == pytest.approx(best, abs=1e-9)
        assert folded.left == pytest.approx(np.abs(torque - j.T @ best).max(), abs=1e-9)
