"""Exact landscapes: metastable stretches of their boundaries, and what the pointer shows."""

from __future__ import annotations

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.chart import Boundary, with_energy
from origami_nlp.landscape import find_landscape
from origami_nlp.landscape.exact import metastable_stretches
from tests.computed_once import PANELS, panel_boundary, panel_contacts, panel_result

OCTAGON = o.examples.degree8("pi/12", 0.01)


def boundary() -> Boundary:
    return panel_boundary(PANELS.index(OCTAGON))


def test_metastable_stretches_are_those_of_the_segments():
    """Lines traced for the picture have the same metastable parts as boundaries followed from states."""
    result = panel_result(OCTAGON)
    (part,) = metastable_stretches(result, boundary())
    (segment,) = panel_contacts().segments.segments
    assert part.length == pytest.approx(segment.length, rel=1e-3)
    assert not part.hidden and part.contacts == ("phi = -pi at creases 1, 5",)
    line = next(ln for ln in boundary().lines if ln.contacts == part.contacts)
    curve = with_energy(result.model, line)
    slope = np.gradient(curve.energy, curve.s)
    assert np.abs(slope - curve.slope)[5:-5].max() < 2e-3 * np.abs(curve.slope).max()


def test_map_under_the_pointer_has_the_exact_lines():
    result = panel_result(OCTAGON)
    panel = find_landscape(result, size=41, boundary=boundary())
    drawn = [line for shown in panel.view_content().panels for line in shown.lines]
    seen = [line for line in boundary().lines if not line.hidden]
    assert len(drawn) == len(seen) + sum(not part.hidden for part in panel.metastable)
    found = {id(line.points): line for line in drawn}
    for line in seen:
        assert found[id(line.points)].look == ("handle" if line.thin else "contact")
        assert "; ".join(line.contacts) in found[id(line.points)].name
    assert sum(line.look == "metastable" for line in drawn) == 1
