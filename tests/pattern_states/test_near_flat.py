"""Minima beside the flat state: predicted to second order, found from there, and the same by other means."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from origami_nlp import Scene, Vertex, find_minima
from origami_nlp.pattern import panels
from origami_nlp.pattern_problem import pose
from origami_nlp.pattern_states.near_folded import beside_folded
from tests.independent.rotations import fold, rotation_vector
from tests.minima.test_single_vertex import drawn


def near_flat(scene):
    """Starts beside the flat state, [K, n]."""
    problem = pose(scene)
    found = list(beside_folded(problem, [np.zeros(problem.size)], ()))
    return np.array(found).reshape(-1, problem.size)


def polished(scene, x):
    """Minimise from x by SLSQP, in units of its size; closure by products of rotation matrices."""
    k, rest, size = np.array(scene.stiffness), np.array(scene.rest_angles), np.abs(x).max()
    sectors = np.array(scene.vertex.sector_angles)

    def closes(y):
        return rotation_vector(fold(sectors, size * y)[1])[0] / size**2

    def slopes(y):
        step = 1e-5 * np.eye(len(y))
        return np.array([(closes(y + d) - closes(y - d)) / 2e-5 for d in step]).T

    end = minimize(
        lambda y: 0.5 * (k * ((size * y - rest) ** 2 - rest**2)).sum() / size**2,
        x / size,
        jac=lambda y: k * (size * y - rest) / size,
        constraints={"type": "eq", "fun": closes, "jac": slopes},
        method="SLSQP",
        options={"ftol": 1e-12, "maxiter": 100},
    )
    return size * end.x, float(np.abs(closes(end.x)).max())


@pytest.mark.parametrize(("degree", "seed"), [(5, 275), (6, 101)])
def test_second_order_is_close_to_the_minimum(degree, seed):
    scene = drawn(seed, degree, "fold-limits")
    x = near_flat(scene)
    (near,) = x[np.abs(x).max(axis=1) < 0.12]
    size = float(np.abs(near).max())
    end, residual = polished(scene, near)
    assert residual < 1e-6 and np.abs(end - near).max() < size**2


def test_the_search_lists_what_it_missed():
    scene = drawn(275, 5, "fold-limits")
    states = np.array([m.fold_angles for m in find_minima(scene, prove=False, escape=False).minima])
    (near,) = states[np.abs(states).max(axis=1) < 0.12]
    assert np.abs(polished(scene, near)[0] - near).max() < 1e-4


def test_labels_and_sides_change_nothing():
    scene = drawn(101, 6, "fold-limits")
    x = near_flat(scene)
    order = np.roll(np.arange(6), -2)
    other = Scene(
        Vertex(tuple(np.array(scene.vertex.sector_angles)[order].tolist())),
        tuple(7.0 * np.array(scene.stiffness)[order]),
        tuple(-np.array(scene.rest_angles)[order]),
        "none",
        "fold-limits",
    )
    y = near_flat(other)
    assert len(x) == len(y) > 0
    for state in -x[:, order]:
        assert np.abs(y - state).max(axis=1).min() < 1e-9


def test_nothing_where_the_flat_state_is_none():
    cone = Scene(Vertex((1.2,) * 4, False), (1.0,) * 4, (0.0,) * 4)
    assert len(near_flat(cone)) == 0
    still = Scene(Vertex((math.pi / 3,) * 6), (1.0,) * 6, (0.0,) * 6, "none", "full")
    assert len(near_flat(still)) == 0


def test_symmetric_springs_have_pairs_or_nothing():
    """Where nothing pulls along an axis, rounding must not decide: states come with their mirror images."""
    scenes = [*panels(), *(equal(seed) for seed in range(6))]
    found = 0
    for scene in scenes:
        free = replace(scene, symmetry="none", contact="fold-limits")
        x = near_flat(free)
        for state in x:
            found += 1
            image = np.roll(state[::-1], 1)  # about crease 1
            assert np.abs(x - image).max(axis=1).min() < 1e-6
    assert found > 1


def equal(seed):
    """Equal sectors, springs that are their own mirror image about crease 1."""
    rng = np.random.default_rng(seed)
    k, rest = rng.uniform(0.5, 2.0, 6), 0.3 * rng.uniform(-1.0, 1.0, 6)
    mirror = [0, 5, 4, 3, 2, 1]
    k, rest = k + k[mirror], rest + rest[mirror]
    return Scene(Vertex((math.pi / 3,) * 6), tuple(k), tuple(rest), "none", "fold-limits")
