"""Springs for states of whole patterns: as for the vertex that they are, checked by the search and by differences."""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.inverse_design import EnergyBounds, Target, Targets, scene_of, solve
from origami_nlp.pattern_problem import PatternProblem
from tests.patterns import scene_pattern

QUAD = o.Vertex(("pi/3", "2*pi/3", "2*pi/3", "pi/3"))


def wanted(minima):
    return tuple(Target(f"state {k}", tuple(m.fold_angles)) for k, m in enumerate(minima, start=1))


def test_a_pattern_of_one_vertex_gets_the_springs_of_the_vertex():
    scene = o.Scene(QUAD, (1, 1, 1, 1), (1.2, -1.2, -0.6, -1.2), symmetry="none")
    states = wanted(o.find_minima(scene, prove=False, escape=False).minima)
    one = o.design(Targets(QUAD, states))
    same = o.design(Targets(scene_pattern(scene), states))
    assert one.verified and same.verified
    assert same.margin == pytest.approx(one.margin, rel=1e-7)  # to the accuracy of the conic solver
    for a, b in zip(one.states, same.states, strict=True):
        assert b.fold_angles == pytest.approx(a.fold_angles, abs=1e-9) and b.found < 1e-9


def test_a_design_of_a_metasheet_holds_its_states_by_differences():
    """Two states of nine facets; along every closed motion the energy rises on both sides of each."""
    pattern = o.examples.pattern("metasheet:3x3")
    minima = o.find_minima(pattern, effort="quick", escape=False).minima
    answer = o.design(Targets(pattern, wanted(minima), stiffness=(0.05, 5.0)), effort="quick")
    assert answer.verified and answer.margin > 0.01 and len(answer.states) == 2
    made = answer.scene
    assert made.stiffness.min() >= 0.05 * (1 - 1e-9) and made.stiffness.max() <= 5 * (1 + 1e-9)
    problem = PatternProblem(made)
    for held in answer.states:
        x = np.array(held.fold_angles)
        z = problem.kernel(x)
        assert z.shape[1] == 1
        d, h = z[:, 0], 1e-4
        states = [problem.project(x + sign * h * d)[0] for sign in (1, -1)]
        arc = [np.linalg.norm(y - x) for y in states]
        rises = [float(made.energy(y) - made.energy(x)) for y in states]
        assert min(rises) > 0
        second = 2 * rises[0] / arc[0] ** 2, 2 * rises[1] / arc[1] ** 2
        assert np.mean(second) >= answer.margin * made.stiffness.mean() * (1 - 1e-3)


def test_a_barrier_of_a_sheet_is_as_low_as_asked():
    """Along closed states from the first to the second, followed by steps along the kernel."""
    pattern = o.examples.pattern("metasheet:2x3")
    states = wanted(o.find_minima(pattern, effort="quick", escape=False).minima[3:5])
    asks = (EnergyBounds("state 1", "state 2", 0.0, 0.5),)
    answer = o.design(
        Targets(pattern, states, stiffness=(0.01, 10.0), barriers=asks), effort="quick"
    )
    assert answer.verified and answer.barriers[0].rise <= 0.5 * (1 + 1e-9)
    problem, made = PatternProblem(answer.scene), answer.scene
    x, end = (np.array(s.fold_angles) for s in answer.states)
    crest, way = made.energy(x), -problem.kernel(x)[:, 0]
    way *= np.sign(way @ (end - x))
    for _ in range(1000):
        along = problem.kernel(x)[:, 0]
        way = along * np.sign(along @ way)
        x, residual = problem.project(x + 0.01 * way)
        assert residual < 1e-9
        crest = max(crest, made.energy(x))
        if np.linalg.norm(end - x) < 0.02:
            break
    else:
        pytest.fail("the second state was not reached")
    assert crest - answer.states[0].energy == pytest.approx(answer.barriers[0].rise, abs=1e-3)


def test_a_sheet_without_springs_says_what_would_help():
    pattern = o.examples.pattern("metasheet:2x3")
    states = wanted(o.find_minima(pattern, effort="quick", escape=False).minima[1:2])
    answer = o.design(Targets(pattern, states, rest_angles=(0.0, 0.1)))
    assert answer.refuted and answer.reason.bounds
    assert any("rest angles reach" in change for change in answer.reason.changes)


def test_creases_of_one_letter_may_have_equal_springs():
    pattern = o.examples.pattern("miura:2x2")
    lowest = o.find_minima(pattern, effort="quick", escape=False).minima[:1]
    asked = Targets(pattern, wanted(lowest), equal="letters")
    posed = solve(asked)
    assert posed.feasible
    made, letters = scene_of(posed), np.array(list(pattern.assignment))
    for letter in "MV":
        assert (
            np.ptp(made.stiffness[letters == letter]) == 0 == np.ptp(made.rest[letters == letter])
        )
