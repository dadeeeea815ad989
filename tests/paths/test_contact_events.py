"""Events of load paths that steps could pass: creases kept fully folded, facets that meet between two steps."""

import math

import numpy as np
import pytest

from origami_nlp.continuation import BifurcationDiagram, EquilibriumCurve
from origami_nlp.pattern_problem import PatternProblem, Torque
from tests.paths.test_loads_in_contact import Turned, by_small_steps, loaded, sprung
from tests.patterns import downhill


@pytest.mark.slow
def test_facets_that_touch_keep_a_crease_shut():
    """It shares what it bears with a corner on a facet, in more than one way, and stays fully folded to rounding."""
    path = loaded(41, 8.0)
    beyond = [p for p in path.legs[-1].points if p.t > path.snaps[0].t + 0.01]
    opened = [math.pi - abs(p.fold_angles[13]) for p in beyond]
    assert len(beyond) > 5 and min(opened) >= 0.0 and max(opened) < 1e-13 and not path.alarms
    shared = [m for m in path.branches[-1].points[-1].multipliers if m.text.endswith("crease 14")]
    assert len(shared) == 1 and not shared[0].unique
    assert by_small_steps(41, 8.0) == pytest.approx(np.array(beyond[-1].fold_angles), abs=1e-9)


def test_a_descent_beyond_a_fold_in_contact_does_not_creep():
    """Where curvature along a contact is all but zero, and that across it is not."""
    pattern, _, crease = sprung(6)
    (snap,) = loaded(6, 4.1).snaps
    for share in (1e-5, 1e-4):
        under = PatternProblem(pattern).under(Torque(pattern, (crease,)), snap.t * (1 + share))
        end = downhill(under, np.array(snap.before))
        assert end.arrived and end.steps < 30


def test_facets_that_meet_between_two_steps_are_not_passed():
    """A side swings onto a facet while a crease shuts: beyond, without the contact, another program sees them cross."""
    path = loaded(39, -5.1)
    event = next(e for e in path.events if "facet 8 on facet 1" in e.contact and e.located)
    assert event.t == pytest.approx(-4.952537364, abs=1e-8)
    rigid = Turned(path.driver.origami)
    for p in path.legs[0].points:
        assert not rigid.crossing(np.array(p.fold_angles))
    web = BifurcationDiagram(path.driver.line(), -5.1, 0.0)
    before = next(p for p in path.legs[0].points if -4.9 < p.t < -4.5)
    held = tuple(c for c in web.line.at(before.t).closed(np.array(before.fold_angles)).base)
    curve = EquilibriumCurve(web.line, held)
    point = np.append(before.fold_angles, before.t)
    for t in np.linspace(before.t, -5.05, 6):
        along = np.append(np.zeros(len(point) - 1), -1.0)
        point = curve.at(point, t, along).x
    assert (0, 7) in rigid.crossing(point[:-1])
