"""`origami-nlp landscape`: figure, map and JSON say the same, and nothing half-written."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.chart import fold_vertex, with_energy
from origami_nlp.paper import find_landscape, find_space
from origami_nlp.paper.landscape import metastable_stretches
from tests import computed_once
from tests.command_line import run, scene_file
from tests.computed_once import (
    PANELS,
    minima_once,
    panel_boundary,
    panel_contacts,
    panel_result,
    shared,
)

SCENE = o.examples.degree6("pi/4", 0.01)


@shared
def folder_written():
    """All files of one run of the command."""
    folder = computed_once.folder / "landscape"
    folder.mkdir()
    path = scene_file(folder, SCENE)
    files = [folder / name for name in ("l.json", "l.png")]
    options = ["-o", files[0], "-o", files[1], "--size", 31]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("origami_nlp.pattern_states.find_states", minima_once)  # a panel
        # coarse meshes, which find the same on them as on finer ones
        patch.setattr("origami_nlp.paper.find_space", lambda s: find_space(s, rings=8))
        assert run("landscape", path, *options).code == 0
    return folder


@pytest.fixture
def written():
    return folder_written()


def test_json_is_consistent(written):
    """Morse sum, Euler characteristic, minima, barriers and counts fit together."""
    data = json.loads((written / "l.json").read_text())
    space, critical = data["space"], data["critical"]
    assert critical["morse_sum"] == space["euler_characteristic"] and critical["closes"]
    assert space["euler_characteristic"] == len(space["components"]) - space["holes"]
    minima = dict(enumerate(data["result"]["minima"], start=1))
    assert data["counts"][0] == len(minima) == len(data["places"])
    verdicts = [m["full_space"]["verdict"] for m in minima.values()]
    assert data["counts"][2] == verdicts.count("stable")
    passes = data["barriers"]["passes"]
    pairs = {(b["from_state"], b["to_state"]) for b in passes}
    assert pairs == {(i, j) for i in minima for j in minima if i < j}
    for step in passes:
        if step["energy"] is not None:
            ends = (minima[step["from_state"]]["energy"], minima[step["to_state"]]["energy"])
            assert step["energy"] >= max(ends)
            assert any(abs(step["energy"] - p["energy"]) < 1e-9 for p in critical["points"])
    for point in critical["points"]:
        phi = np.array(point["fold_angles"])
        assert point["energy"] == pytest.approx(float(SCENE.energy(phi)), rel=1e-12)
        assert np.linalg.norm(fold_vertex(SCENE.vertex, phi)[1][1:]) < 1e-12
    lowest = min(p["energy"] for p in critical["points"])
    assert lowest == pytest.approx(min(m["energy"] for m in minima.values()), rel=1e-10)


def test_maps_and_lines_hold_states(written):
    exact = find_landscape(minima_once(SCENE), size=31)
    for branch in exact.chart.branches:
        good = np.isfinite(branch.energy)
        assert good.shape == (31, 31) and good.any()
        phi = branch.fold_angles[good]
        np.testing.assert_allclose(SCENE.energy(phi), branch.energy[good], rtol=1e-13)
        assert np.abs(fold_vertex(SCENE.vertex, phi)[1][:, 1:]).max() < 1e-11
    for line in exact.boundary.lines:
        phi = line.fold_angles
        assert len(phi) == len(line.points) == len(line.s)
        assert np.abs(fold_vertex(SCENE.vertex, phi)[1][:, 1:]).max() < 1e-12
        if line.contacts[0].startswith("phi = "):
            assert np.abs(np.abs(phi).max(axis=1) - math.pi).max() < 1e-12
    assert (written / "l.png").read_bytes().startswith(b"\x89PNG")


OCTAGON = o.examples.degree8("pi/12", 0.01)


def boundary():
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
