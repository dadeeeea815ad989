"""50-digit references: checked by another formulation, and derivatives by differences in extended precision."""

import math

import mpmath as mp
import numpy as np
import pytest

from benchmarks import family_scene, solve_reference
from benchmarks.exact_vertex import ExactVertex
from benchmarks.reference import Unsolved
from origami_nlp import Scene, Vertex, examples
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
