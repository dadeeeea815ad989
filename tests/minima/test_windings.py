"""Symmetric states wind once or several times round their axis: lists against searches that share no wedge."""

import math
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp import MinimaResult, Scene, Vertex, examples, find_minima
from origami_nlp.errors import OrigamiError
from origami_nlp.pattern import scene_from_dict, scene_to_dict
from origami_nlp.pattern_problem import pose
from origami_nlp.search import confirm
from tests.computed_once import thinned
from tests.independent.rotations import spin_sign

STAR = Scene(
    Vertex(("pi/4",) * 8),
    (1, 2) * 4,
    (math.radians(131.0604),) * 8,
    contact="fold-limits",
)
"""At rest in a star: closed, symmetric, without energy, and wound three times round its axis."""


def test_a_result_is_read_back_with_its_windings(tmp_path):
    result = find_minima(STAR, prove=False, escape=False)
    path = tmp_path / "star.json"
    result.save(path)
    again = MinimaResult.load(path)
    assert [m.winding for m in again.minima] == [m.winding for m in result.minima]
    for m in again.minima:
        state = again.state_of(m)
        assert np.abs(state.problem.closure.values(state.x)).max() < 1e-12


def test_one_winding_may_be_asked_for():
    one = replace(STAR, winding=3)
    assert [m.winding for m in find_minima(one, escape=False).minima] == [3, 3]
    assert scene_from_dict(scene_to_dict(one)) == one
    assert [s.winding for s in STAR.of_each_winding] == [None, 3]
    for wrong in (2, 5, True, "3"):
        with pytest.raises(OrigamiError, match=r"winding = .* must be one of 1, 3: symmetry D4"):
            replace(STAR, winding=wrong)
    with pytest.raises(OrigamiError, match="must be one of 1: symmetry D4, contact = 'full'"):
        replace(STAR, winding=3, contact="full")


def test_where_nothing_winds_there_is_one_search():
    for scene in (
        examples.degree6("pi/4", 1.0, contact="fold-limits"),
        examples.degree8("pi/4", 1.0, contact="none"),
        replace(STAR, contact="full"),
        replace(STAR, symmetry="C2"),
        replace(STAR, symmetry="none"),
    ):
        assert scene.windings == (1,) and scene.of_each_winding == (scene,)


def test_a_guess_goes_to_its_winding():
    star = find_minima(STAR, prove=False, escape=False).minima[0]
    away = np.array(star.fold_angles) + 0.05 * np.tile([1, -1], 4)
    d = replace(STAR, rest_angles=tuple(np.array(STAR.rest_angles) - 0.01))
    found = find_minima(d, guesses=[away], max_starts=1, prove=False, escape=False)
    assert found.minima[0].winding == 3


def test_a_period_may_close_by_itself():
    """Six facets of 60 degrees: folded over each other in three pairs, each closed."""
    scene = Scene(Vertex(("pi/3",) * 6), (1, 2) * 3, (3.0,) * 6, "D3", "fold-limits")
    result = find_minima(scene, escape=False)
    assert any(
        m.winding == 3 and np.abs(np.abs(m.fold_angles) - math.pi).max() == 0 for m in result.minima
    )
    assert result.completeness.status == "proved"
    assert not result.completeness.undecided
    sectors = np.full(6, math.pi / 3)
    assert all(spin_sign(sectors, np.array(m.fold_angles)) > 0 for m in result.minima)


def test_more_equations_than_fold_angles_are_made_independent_for_a_solver(capfd):
    """Two fold angles, three equations where states wind three times: IPOPT has rows for two, and prints nothing."""
    scene = Scene(Vertex(("pi/3",) * 6), (1, 2) * 3, (3.0,) * 6, "C3", "fold-limits")
    beyond = [m for m in find_minima(scene, escape=False).minima if m.winding == 3]
    problem = pose(scene)
    answers = [confirm(problem, problem.reduce(m.phi)) for m in beyond]
    assert beyond and all(answer.came_back == "same" for answer in answers)
    assert not "".join(capfd.readouterr())


@pytest.mark.parametrize("contact", ["none", "fold-limits"])
@pytest.mark.parametrize("group", thinned(["C6", "D6", "D7", "C7"], 4))
def test_the_flat_state_winds_once(group, contact):
    n = int(group[1])
    scene = Scene(Vertex((2 * math.pi / n,) * n), (1.0,) * n, (1.5,) * n, group, contact)
    result = find_minima(scene, escape=False)
    assert {m.winding for m in result.minima} > {1}
    for m in result.minima:
        state = result.state_of(m)
        assert np.abs(state.problem.closure.values(state.x)).max() < 1e-12
    assert [m.winding for m in result.minima if not np.any(m.fold_angles)] == [1]
