"""50-digit references: checked by another formulation, and derivatives by differences in extended precision."""

import math

import mpmath as mp
import numpy as np
import pytest

from benchmarks import family_scene, solve_reference
from benchmarks.exact_vertex import ExactVertex, exact_angle
from benchmarks.reference import Unsolved
from origami_nlp import Scene, State, Vertex, examples, find_minima
from origami_nlp.pattern_problem import pose
from origami_nlp.problem import Contact
from tests.closed_states import closed_states

SCENES = {
    "D1": examples.degree6("pi/3", 1.0),
    "D2": examples.degree8("pi/12", 0.01),
    "none": family_scene("fold-limits", 2),
    "C2": Scene(
        Vertex((0.7, 1.1, math.pi - 1.8) * 2), (1, 2, 3) * 2, (0.5, -1.0, 0.3) * 2, "C2", "full"
    ),
}


GAPS = ((3, 1), (0, 2))
"""Rays off facets."""


@pytest.mark.parametrize("name", SCENES)
def test_derivatives_of_closure_and_gaps_agree_with_differences(name):
    problem = pose(SCENES[name])
    with mp.workdps(60):
        vertex = ExactVertex(problem)
        x = np.array([mp.mpf(v) for v in np.linspace(-0.9, 1.1, problem.size)])
        h = mp.mpf(10) ** -18

        def everything(y):
            closure, of_gap = vertex.evaluate(y, GAPS)
            return [*closure, *of_gap]

        middle = everything(x)
        for v in range(problem.size):
            step = np.array([h if u == v else mp.mpf(0) for u in range(problem.size)])
            for low, mid, high in zip(
                everything(x - step), middle, everything(x + step), strict=True
            ):
                assert abs((high.value - low.value) / (2 * h) - mid.first[v]) < 1e-30
                assert max(abs((high.first - low.first) / (2 * h) - mid.second[v])) < 1e-30


@pytest.mark.parametrize("name", SCENES)
def test_closure_vanishes_where_the_programme_closes(name):
    problem = pose(SCENES[name])
    for start in closed_states(problem, np.random.default_rng(0), 4):
        with mp.workdps(30):
            x = np.array([mp.mpf(v) for v in start.tolist()])
            closure, _ = ExactVertex(problem).evaluate(x)
            assert max(abs(j.value) for j in closure) < 1e-8
            slopes = np.array([j.first.astype(float) for j in closure])
        # the same row space
        ours = problem.constraints(start)[1]
        u, sizes, _ = np.linalg.svd(ours.T, full_matrices=False)
        rows = u[:, sizes > 1e-6]
        assert np.abs(slopes.T - rows @ (rows.T @ slopes.T)).max() < 1e-6


def whole_rotation(scene, phi):
    """Product of all folds of the whole vertex, b_i from exact sector angles; and deformed creases."""
    f, azimuth, creases = mp.eye(3), mp.mpf(0), []
    for a, angle in zip(scene.vertex.sector_angles, phi, strict=True):
        c, s = mp.cos(azimuth), mp.sin(azimuth)
        turn = mp.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        creases.append(f * turn * mp.matrix([1, 0, 0]))
        c, s = mp.cos(angle), mp.sin(angle)
        f = f * turn * mp.matrix([[1, 0, 0], [0, c, -s], [0, s, c]]) * turn.T
        azimuth += exact_angle(a)
    return f, creases


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(examples.panels()[8], marks=pytest.mark.slow),
        examples.panels()[17],
        SCENES["none"],
    ],
    ids=repr,
)
def test_references_close_and_balance_in_the_whole_vertex(scene):
    """Independent residual with 50 digits: the loop of all N folds closes; torques are in the row space of C."""
    result = find_minima(scene, max_starts=40, prove=False, escape=False)
    checked = 0
    for m in result.minima:
        model = pose(scene)
        x = model.reduce(np.array(m.fold_angles))
        rows = State(model, x).pieces[0]
        reference = solve_reference(model, x, rows)
        assert reference.angle_error(x) < 1e-13 and reference.residual < 1e-45
        assert abs(reference.energy - m.energy) <= 1e-14 * max(m.energy, model.scale)
        with mp.workdps(60):
            values = [
                mp.mpf(reference.digits[v])
                for v in (range(model.size) if model.orbits is None else model.orbits.orbit)
            ]
            f, creases = whole_rotation(scene, values)
            assert mp.norm(f - mp.eye(3), mp.inf) < mp.mpf(10) ** -46
            if (
                not rows
            ):  # symmetric criticality: stationary in the whole vertex, torque_i = c_i . force
                k = [mp.mpf(v) for v in scene.stiffness]
                rest = [exact_angle(v) for v in scene.rest_angles]
                torque = mp.matrix([a * (p - r) for a, p, r in zip(k, values, rest, strict=True)])
                c = mp.matrix([[crease[j] for j in range(3)] for crease in creases])
                force = mp.lu_solve(c.T * c, c.T * torque)
                # stiffnesses of images agree to rounding of doubles only
                assert mp.norm(c * force - torque, mp.inf) < mp.mpf(10) ** -17 * max(
                    scene.stiffness
                )
                checked += 1
    assert checked


def test_a_flat_folding_is_known_exactly_and_a_wrong_state_is_refused():
    model = pose(SCENES["D1"])
    x = math.pi * np.array([-1.0, 0.0, 0.0, -1.0])
    rows = (Contact("limit", 0, -1), Contact("limit", 3, -1))
    reference = solve_reference(model, x, rows)
    with mp.workdps(60):
        assert abs(mp.mpf(reference.digits[0]) + mp.pi) < mp.mpf(10) ** -48
    assert reference.angle_error(x) == pytest.approx(1.2246467991473532e-16, rel=1e-9)
    with pytest.raises(Unsolved):
        solve_reference(model, np.array([0.5, 1.0, -0.7, 0.2]), ())
