"""Events of load paths that steps could pass: creases kept fully folded, facets that meet between two steps."""

import numpy as np
import pytest

from origami_nlp.continuation import BifurcationDiagram, EquilibriumCurve
from tests.paths.test_loads_in_contact import Turned, loaded


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
