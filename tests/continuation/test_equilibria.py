"""Equilibria over a parameter: points, events and one-sided choices, each checked a second way."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp import State, classify, examples, find_minima
from origami_nlp.continuation import BifurcationDiagram, load_line
from origami_nlp.continuation.diagram import STEPS
from origami_nlp.kkt import project
from origami_nlp.pattern_problem import pose
from origami_nlp.search import descent_path
from tests.parameter_lines import line_between

SNAP, RESTABLE = -0.138149523101, -0.123882378029
"""Torques on crease 1 [N m] between which a state of degree 6, 5 pi/12, r_k = 1 is unstable, of a prototype."""


def minima_of(scene):
    model = pose(scene)
    found = find_minima(scene, prove=False, escape=False, max_starts=2000).minima
    return model, [model.reduce(np.array(m.fold_angles)) for m in found]


def over_ratio(alpha, low, high, **options):
    model, states = minima_of(examples.degree6(alpha, 1.0))
    line = line_between(model, pose(examples.degree6(alpha, math.e)), 1.0)
    return BifurcationDiagram(line, math.log(low), math.log(high), **options), states


def events(web):
    return [n for n in web.nodes if n.type not in ("start", "range", "corner")]


def torque_web(steps=STEPS, low=-8.0, high=8.0):
    model, states = minima_of(examples.degree6("5*pi/12", 1.0))
    return BifurcationDiagram(
        load_line(model, np.array([1.0, 0, 0, 0])), low, high, steps=steps
    ), states


@pytest.fixture(scope="module")
def torques():
    web, states = torque_web()
    web.add(states[0], 0.0)
    return web


def test_a_torque_snaps_a_state_and_another_holds_it_again(torques):
    scale = torques.line.problem.scale
    first = [(n.type, n.s * scale) for n in events(torques)[:2]]
    assert [kind for kind, _ in first] == ["fold", "nonsmooth-fold"]
    assert [s for _, s in first] == pytest.approx([SNAP, RESTABLE], abs=1e-12)
    # by descent at fixed torques, which knows nothing of curves: it stays before the snap, and leaves beyond
    fold = events(torques)[0]
    before = next(f for _, f in torques.states_at(fold.s + 0.01) if not f.index)
    stays, leaves = (
        descent_path(torques.line.at(fold.s + e), before.state).end - before.state
        for e in (0.01, -0.01)
    )
    assert np.abs(stays).max() < 1e-8 and np.abs(leaves).max() > 0.5


def test_every_located_event_is_rounding_in_both_functions(torques):
    for node in events(torques):
        assert node.located and node.residual < 1e-11 and abs(node.value) < 1e-11


def test_points_are_equilibria_and_their_tangents_are_differences(torques):
    for arc in torques.arcs:
        frame = arc.frames[len(arc.frames) // 2]
        assert frame.system.residual < 1e-11
        h = 1e-5 * abs(frame.ahead)
        a, b = (arc.at(frame.s + e) for e in (-h, h))
        slope = torques.line.problem.root * (b.state - a.state) / (2 * h)
        exact = frame.tangent[:-1] / frame.ahead * torques.line.weight
        assert slope == pytest.approx(exact, abs=1e-5 * (1 + np.abs(exact).max()))
        verdict = classify(State(frame.problem, frame.state)).verdict
        assert verdict == ("saddle" if frame.index else "minimum")


def test_the_moment_of_a_contact_ends_where_a_closed_form_says():
    """At (-a, b, b, -a), cos a = 1/3, b = pi - a, the motion d phi_2 = -d phi_1 keeps the contact without load."""
    web, states = over_ratio("pi/3", 0.01, 100)
    web.add(states[0], 0.0)
    (node,) = events(web)
    a = math.acos(1 / 3)
    assert node.type == "leaves"
    assert math.exp(node.s) == pytest.approx((math.pi - 2 * a) / (math.pi - a), rel=1e-14)


def test_a_contact_that_never_carries_leaves_at_the_first_load():
    """The book fold of pi/4 rests: any torque that opens it does so at once."""
    model = pose(examples.degree6("pi/4", 1.0))
    book = np.array([-math.pi, 0.0, 0.0, -math.pi])
    web = BifurcationDiagram(load_line(model, np.array([1.0, 0, 0, 0])), -1.0, 1.0)
    assert web.add(book, 0.0, "minimum")
    halves = {np.sign(h.frame.ahead): h.frame.hold for h in web.nodes[0].halves}
    assert len(halves[-1.0]) == 2 and len(halves[1.0]) < 2


def facets_that_begin_to_overlap(ratio, low, high):
    """The web of degree 8 without symmetry, alpha = 30 deg, from the state whose creases 3 and 7 are about to meet."""
    scenes = [
        replace(examples.degree8("pi/6", math.exp(s)), symmetry="none", mirror=None)
        for s in (0.0, 1.0)
    ]
    line = line_between(*map(pose, scenes), 1.0)
    web = BifurcationDiagram(line, math.log(low), math.log(high))
    angles = np.radians([-65.5, 142.2, -58.2, 142.0, -65.5, 142.2, -58.2, 142.0])
    start = descent_path(line.at(math.log(ratio)), angles).end
    assert web.add(start, math.log(ratio))
    return web


@pytest.mark.slow  # a second look at what other tests of the room say
def test_facets_that_begin_to_overlap_hold_each_other_by_two_contacts():
    """Two creases meet, and beyond two facets lie on each other, either way round; held by one contact they cross."""
    web = facets_that_begin_to_overlap(3.2, 3.1, 3.6)
    (event,) = events(web)
    assert event.type == "closes" and event.located
    for ratio, contacts in ((3.19, (0,)), (3.271, (2, 2)), (3.3, (2, 2)), (3.5, (2, 2))):
        found = [f for _, f in web.states_at(math.log(ratio))]
        assert tuple(len(f.hold) for f in found) == contacts
        for f in found:
            assert (f.forces > 0).all()
            assert classify(State(f.problem, f.state)).verdict == "minimum"
    for f in (f for _, f in web.states_at(math.log(3.5))):
        # by descent from beside it, which knows nothing of curves
        aside = (
            project(f.problem, f.state + 1e-4 * np.sin(k + np.arange(8.0)), ())[0]
            for k in range(20)
        )
        start = next(x for x in aside if not f.problem.refuses(x))
        assert np.abs(descent_path(f.problem, start).end - f.state).max() < 1e-7
    back = facets_that_begin_to_overlap(3.5, 3.1, 3.6)
    (again,) = events(back)
    assert again.located and again.s == pytest.approx(event.s, abs=1e-11)
    assert len(back.states_at(math.log(3.19))) == 1 and len(back.states_at(math.log(3.49))) == 2
