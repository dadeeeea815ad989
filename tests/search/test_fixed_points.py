"""Descents with an active set: minima are fixed points, ends are exact, and what is held stays until it may go."""

import json
from pathlib import Path

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.kkt import State, classify
from origami_nlp.pattern import scene_from_dict
from origami_nlp.search import CompiledDescent, Follower, Slot, StartState, at_limits

SHEETS = "miura:2x3", "squaretwist", "waterbomb:1x1", "metasheet:2x3"


def recorded(name):
    """A scene of the oracle's random vertices."""
    path = Path(__file__).parents[1] / "oracle" / "data" / "cff19e43" / "random_vertices.json"
    questions = json.loads(path.read_text("utf-8"))
    (q,) = [q for q in questions if q["name"] == name]
    return scene_from_dict(q["q"]["stated"]["scene"])


PINNED = recorded("degree 6, 106, full"), recorded("degree 7, 106, full")
VERTICES = [o.examples.degree6("pi/3", ratio=100.0), o.examples.degree8("pi/6", 1.0), *PINNED]


def minima(origami):
    problem = o.pose(origami)
    found = o.find_minima(origami, escape=False, prove=False)
    assert found.minima
    return problem, [problem.reduce(np.array(m.fold_angles)) for m in found.minima]


@pytest.mark.parametrize("origami", [*SHEETS, *VERTICES], ids=lambda x: getattr(x, "label", x))
def test_minima_are_fixed_points_and_neighbours_lead_to_them(origami):
    problem, states = minima(origami)
    follow, rng = Follower(problem), np.random.default_rng(0)
    aside = rng.normal(size=problem.size)
    if not follow.usable:
        pytest.skip("no compiler: descents are not compiled")
    reached = 0
    for x in states:
        end, why = follow(StartState(x, at_limits(problem, x)), aside)
        assert not why and np.abs(end - x).max() < 1e-7
        for _ in range(4):
            y, residual = problem.project(x + 1e-3 * rng.normal(size=problem.size))
            if residual > 1e-12 or problem.refuses(y):
                continue
            end, why = follow(StartState(y, at_limits(problem, y)), aside)
            lower = problem.energy_change(x, end) < -1e-9 * problem.scale
            assert why or lower or np.abs(end - x).max() < 1e-2
            reached += np.abs(end - x).max() < 1e-6
    assert reached or all(classify(State(problem, x)).kind != "interior" for x in states)


def test_an_end_is_stationary_with_multipliers_that_push_and_judged_a_minimum():
    """Springs at half a turn push a crease into its limit: the multiplier is what is left of their torque."""
    problem = o.pose("miura:2x2")
    descents, rng = CompiledDescent(problem), np.random.default_rng(1)
    if not descents.usable:
        pytest.skip("no compiler: descents are not compiled")
    none = np.zeros(4, int)
    starts = [StartState(problem.project(x)[0], none) for x in rng.uniform(-2, 2, (40, 4))]
    ends = descents(starts, np.tile(np.sin(1.0 + np.arange(4)), (40, 1)))
    arrived = [e for e in ends if e.arrived]
    assert arrived and all((e.forces >= 0).all() for e in arrived)
    for e in arrived:
        assert problem.residual(e.x) < 1e-12 and e.work >= e.steps
        assert classify(State(problem, e.x)).verdict in ("minimum", "saddle")


@pytest.mark.parametrize("scene", PINNED, ids=lambda s: s.label)
def test_gaps_are_held_where_features_touch_and_their_curvature_is_exact(scene):
    """Newton's steps are quadratic on a contact only with the second derivatives of its gap."""
    problem, states = minima(scene)
    descents = CompiledDescent(problem)
    if not descents.usable:
        pytest.skip("no compiler: descents are not compiled")
    corners = problem.crossings.pattern.corners
    pinned = [x for x in states if any(not c.is_limit for c in State(problem, x).contacts.base)]
    assert pinned
    for x in pinned:
        gaps = [c for c in State(problem, x).contacts.base if not c.is_limit]
        touches = [problem.touch(c) for c in gaps]
        slots = [
            Slot((-1, -1), (-1, -1), t.sign, t.facets, t.type == "edge-edge", t.reference(corners))
            for t in touches
        ]
        y, _ = problem.project(x + 1e-3 * np.sin(np.arange(problem.size)))
        start = StartState(y, at_limits(problem, x), tuple(slots), hold=True)
        (end,) = descents([start], np.ones((1, problem.size)))
        assert end.steps <= 12
        assert np.abs(problem.local(end.x).openings(gaps)[0]).max() < 1e-9 or end.arrived


def test_a_list_is_the_same_whatever_the_machine_does_and_however_creases_are_numbered():
    one, again = (o.find_minima("waterbomb:1x1", escape=False, prove=False) for _ in range(2))
    assert [m.fold_angles for m in one.minima] == [m.fold_angles for m in again.minima]
    assert one.search.by_source == again.search.by_source
