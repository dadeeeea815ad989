"""50-digit references: checked by another formulation, and derivatives by differences in extended precision."""

import math

import mpmath as mp
import numpy as np
import pytest

from benchmarks import family_scene, solve_reference
from benchmarks.exact_piece import ExactPiece, exact_angle
from benchmarks.reference import Unsolved
from origami_nlp import Scene, Vertex, examples, find_minima
from origami_nlp.problem import Contact, Model
from tests.closed_states import closed_states

SCENES = {
    "D1": examples.degree6("pi/3", 1.0),
    "D2": examples.degree8("pi/12", 0.01),
    "none": family_scene("fold-limits", 2),
    "C2": Scene(
        Vertex((0.7, 1.1, math.pi - 1.8) * 2), (1, 2, 3) * 2, (0.5, -1.0, 0.3) * 2, "C2", "full"
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_derivatives_of_closure_and_gaps_agree_with_differences(name):
    model = Model(SCENES[name])
    gaps = tuple(range(len(model.structure.gaps)))[:6]
    with mp.workdps(60):
        piece = ExactPiece(model)
        x = np.array([mp.mpf(v) for v in np.linspace(-0.9, 1.1, model.size)])
        h = mp.mpf(10) ** -18

        def everything(y):
            closure, of_gap = piece.evaluate(y, gaps)
            return [*closure, *of_gap.values()]

        middle = everything(x)
        assert len(middle) == model.equation_count + len(gaps)
        for v in range(model.size):
            step = np.array([h if u == v else mp.mpf(0) for u in range(model.size)])
            for low, mid, high in zip(
                everything(x - step), middle, everything(x + step), strict=True
            ):
                assert abs((high.value - low.value) / (2 * h) - mid.first[v]) < 1e-30
                assert max(abs((high.first - low.first) / (2 * h) - mid.second[v])) < 1e-30


@pytest.mark.parametrize("name", SCENES)
def test_closure_vanishes_where_the_programme_closes_and_gaps_are_equal(name):
    scene = SCENES[name]
    model = Model(scene)
    for start in closed_states(model, np.random.default_rng(0), 4):
        with mp.workdps(30):
            piece = ExactPiece(model)
            x = np.array([mp.mpf(v) for v in start.tolist()])
            closure, gaps = piece.evaluate(x, tuple(range(len(model.structure.gaps))))
            if np.abs(model.closure(start)[0]).max() < 1e-12:
                assert max(abs(j.value) for j in closure) < 1e-9
            for index, jet in gaps.items():
                assert abs(float(jet.value) - model.local(start).gaps[index]) < 1e-12
                assert (
                    np.abs(jet.first.astype(float) - model.local(start).gaps_jacobian[index]).max()
                    < 1e-11
                )


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
        model = Model(scene)
        x = model.reduce(np.array(m.fold_angles))
        rows = model.closed(x).combinations()[0]
        reference = solve_reference(model, x, rows)
        assert reference.angle_error(x) < 1e-13 and reference.residual < 1e-45
        assert abs(reference.energy - m.energy) <= 1e-14 * max(m.energy, model.scale)
        with mp.workdps(60):
            values = [mp.mpf(reference.digits[v]) for v in model.variable_of_crease]
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
    model = Model(SCENES["D1"])
    x = math.pi * np.array([-1.0, 0.0, 0.0, -1.0])
    rows = (Contact("limit", 0, -1), Contact("limit", 3, -1))
    reference = solve_reference(model, x, rows)
    with mp.workdps(60):
        assert abs(mp.mpf(reference.digits[0]) + mp.pi) < mp.mpf(10) ** -48
    assert reference.angle_error(x) == pytest.approx(1.2246467991473532e-16, rel=1e-9)
    with pytest.raises(Unsolved):
        solve_reference(model, np.array([0.5, 1.0, -0.7, 0.2]), ())


def test_thin_sets_have_references_too():
    scene = examples.panels()[4]
    result = find_minima(scene, max_starts=20, prove=False, escape=False)
    thin = [m for m in result.minima if m.local_dimension == 1]
    assert thin
    for m in thin:
        model = Model(scene)
        x = model.reduce(np.array(m.fold_angles))
        rows = model.closed(x).combinations()[0]
        reference = solve_reference(model, x, rows)
        assert reference.residual < 1e-45 and reference.angle_error(x) < 1e-13
