"""Landscapes: figure, map and JSON say the same; metastable stretches are those of the boundaries that are followed."""

from __future__ import annotations

import json

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.chart import with_energy
from origami_nlp.paper import find_landscape, find_space
from tests.command_line import run, scene_file
from tests.computed_once import minima_once, panel_barriers, panel_contacts, panel_result

OCTAGON = o.examples.degree8("pi/12", 0.01)


def test_what_is_known_of_a_landscape_fits_together(tmp_path, monkeypatch):
    """Morse sum, Euler characteristic, minima, barriers and counts."""
    scene = o.examples.degree6("pi/4", 0.01)
    monkeypatch.setattr("origami_nlp.pattern_states.find_states", minima_once)  # a panel
    file, picture = tmp_path / "l.json", tmp_path / "l.png"
    done = run("landscape", scene_file(tmp_path, scene), "-o", file, "-o", picture, "--size", 31)
    assert done.code == 0 and picture.stat().st_size > 10_000
    data = json.loads(file.read_text())
    space, critical, minima = (
        find_space(scene, rings=8),
        o.find_critical_points(scene),
        data["result"]["minima"],
    )
    assert critical.morse_sum == space.euler_characteristic and critical.closes
    assert space.euler_characteristic == len(space.components) - space.holes
    assert data["counts"][0] == len(minima) == len(data["places"])
    assert data["counts"][2] == [m["full_space"]["verdict"] for m in minima].count("stable")
    energies = np.array([p.energy for p in critical.points])
    for step in panel_barriers().passes:
        assert np.abs(energies - step.energy).min() < 1e-9
    assert energies.min() == pytest.approx(min(m["energy"] for m in minima), rel=1e-10)


def test_stretches_are_those_of_the_segments_and_on_the_map():
    result = panel_result(OCTAGON)
    exact = find_landscape(result, size=41)
    (part,), (segment,) = exact.metastable, panel_contacts().segments.segments
    assert part.length == pytest.approx(segment.length, rel=1e-3)
    assert not part.hidden and part.contacts == ("phi = -pi at creases 1, 5",)
    line = next(ln for ln in exact.boundary if ln.contacts == part.contacts)
    curve = with_energy(result.model, line)
    slope = np.gradient(curve.energy, curve.s)
    assert np.abs(slope - curve.slope)[5:-5].max() < 2e-3 * np.abs(curve.slope).max()
