"""What tests share is what they would have computed: the same minima, and once per run."""

import dataclasses
import math

import pytest

from origami_nlp import Scene, Vertex, examples, find_minima
from origami_nlp.io import to_plain
from origami_nlp.proof import ReducedVertex, prove
from tests import computed_once
from tests.computed_once import PANELS, by_scene, once, panel_result


def test_a_shared_panel_is_that_of_a_search():
    scene = PANELS[9]
    fresh, shared = find_minima(scene, full=False), panel_result(scene)
    assert shared.scene == scene and shared.minima == fresh.minima
    # of no minimum some residuals are nan, and a nan that was read from a file differs from itself
    assert to_plain(shared.search.rejected) == to_plain(fresh.search.rejected) != []
    judged = panel_result(scene, full=True).minima
    assert judged == find_minima(scene, full=True).minima != fresh.minima


def states(proof):
    return [p.fold_angles.tolist() for p in proof.points]


def test_a_shared_proof_is_that_of_its_scene():
    vertex = Vertex.from_degrees((70, 80, 120, 90))
    scenes = [
        Scene(vertex, (1, 2, 3, k), (1.0, -0.5, 0.3, 0.8), "none", "fold-limits")
        for k in (2.0, math.nextafter(2.0, 3.0))
    ]
    shared = by_scene(prove)
    one, other = (shared(ReducedVertex(scene), boxes=100_000) for scene in scenes)
    assert one is not other and states(one) != states(other)
    kept = shared(ReducedVertex(dataclasses.replace(scenes[0], name="another")), boxes=100_000)
    fresh = prove(ReducedVertex(scenes[0]), boxes=100_000)
    assert kept.seconds == one.seconds  # it was read
    assert states(fresh) == states(kept)
    assert not shared(ReducedVertex(scenes[0]), boxes=9).finished


def test_a_scene_that_only_has_the_name_of_a_panel_is_refused():
    scene = examples.degree6("pi/4", 0.01, contact="none")
    assert scene.name == PANELS[0].name
    with pytest.raises(ValueError, match="not in list"):
        panel_result(scene)


def test_what_fails_is_not_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(computed_once, "folder", tmp_path)
    with pytest.raises(ZeroDivisionError):
        once("number", lambda: 1 / 0)
    assert once("number", lambda: 2) == 2 == once("number", lambda: 3)
