"""What tests share is what they would have computed: the same minima, and once per run."""

import dataclasses
import importlib
import math
import multiprocessing
from pathlib import Path

import pytest

from origami_nlp import Scene, Vertex, examples, find_minima
from origami_nlp.io import to_plain
from origami_nlp.problem import Model
from origami_nlp.proof import prove
from tests import computed_once
from tests.computed_once import PANELS, by_minima, by_scene, once, panel_result


def test_a_shared_panel_is_that_of_a_search():
    scene = PANELS[9]
    fresh, shared = find_minima(scene, full=False), panel_result(scene)
    assert shared.scene == scene and shared.minima == fresh.minima
    # of no minimum some residuals are nan, and a nan that was read from a file differs from itself
    assert to_plain(shared.search.rejected) == to_plain(fresh.search.rejected) != []
    assert shared.search.statuses == fresh.search.statuses
    judged = panel_result(scene, full=True).minima
    assert judged == find_minima(scene, full=True).minima != fresh.minima


def test_a_shared_proof_is_that_of_its_scene():
    vertex = Vertex.from_degrees((70, 80, 120, 90))
    scenes = [
        Scene(vertex, (1, 2, 3, k), (1.0, -0.5, 0.3, 0.8), "none", "fold-limits")
        for k in (2.0, math.nextafter(2.0, 3.0))
    ]
    shared = by_scene(prove)
    one, other = (shared(Model(scene), boxes=100_000) for scene in scenes)
    assert one is not other and [p.x for p in one.points] != [p.x for p in other.points]
    kept = shared(Model(dataclasses.replace(scenes[0], name="another")), boxes=100_000)
    fresh = prove(Model(scenes[0]), boxes=100_000)
    assert kept.seconds == one.seconds  # it was read
    assert repr(dataclasses.replace(fresh, seconds=one.seconds)) == repr(kept)
    assert [p.x for p in fresh.points] == [p.x for p in kept.points]
    assert not shared(Model(scenes[0]), boxes=9).finished


def test_shared_barriers_are_those_of_their_minima():
    with_escapes = importlib.import_module("origami_nlp.minima.escape").with_escapes
    calls = []

    def with_barriers(*given):
        calls.append(given)
        return with_escapes(*given)

    result = find_minima(examples.degree6("pi/4", 0.02), max_starts=16, prove=False, escape=False)
    model = Model(result.scene)
    shared, fresh = by_minima(with_barriers), with_escapes(model, result.minima)
    assert fresh == shared(model, result.minima) == shared(model, result.minima)
    assert len(calls) == 1 and all(m.escape.barrier > 0 for m in fresh)
    assert shared(model, result.minima[:1]) != fresh[:1] and len(calls) == 2


@pytest.mark.slow  # eight searches with proofs
def test_a_shared_search_of_a_pattern_is_that_of_its_springs():
    """Proof and barriers of it are computed once, and others for the least other spring."""
    proved = importlib.import_module("origami_nlp.pattern_states.proved")
    find = importlib.import_module("origami_nlp.pattern_states.find")
    sheet = examples.pattern("metasheet", 2, 2)
    stiffer = sheet.with_springs([math.nextafter(sheet.stiffness[0], 1), *sheet.stiffness[1:]])
    with pytest.MonkeyPatch.context() as patch:
        for owner, name in ((proved, "prove_sheet"), (find, "with_escapes")):
            patch.setattr(owner, name, getattr(owner, name).__wrapped__)
        fresh = find_minima(sheet, starts=1)
    shared = [find_minima(one, starts=1) for one in (sheet, sheet, stiffer)]
    assert len({one.completeness.seconds for one in (fresh, *shared)}) == 3
    assert shared[0].minima == shared[1].minima == fresh.minima != shared[2].minima
    assert all(m.escape.barrier > 0 for m in fresh.minima) and fresh.completeness.proved
    short = [find_minima(sheet, starts=1, seconds=60.0).completeness.seconds for _ in range(2)]
    assert len({*short, shared[0].completeness.seconds}) == 3


def test_a_scene_that_only_has_the_name_of_a_panel_is_refused():
    scene = examples.degree6("pi/4", 0.01, contact="none")
    assert scene.name == PANELS[0].name
    with pytest.raises(ValueError, match="not in list"):
        panel_result(scene)


def ask(folder, gate, answers):
    def compute():
        with (folder / "calls.txt").open("a") as file:
            file.write("called\n")
        return {"x": 0.1 + 0.2}

    computed_once.folder = folder
    gate.wait()
    answers.put(once("number", compute))


@pytest.mark.slow  # two processes that import the package
def test_processes_that_ask_at_once_compute_once(tmp_path: Path):
    context = multiprocessing.get_context("spawn")
    gate, answers = context.Barrier(2), context.Queue()
    asking = [context.Process(target=ask, args=(tmp_path, gate, answers)) for _ in range(2)]
    for process in asking:
        process.start()
    assert [answers.get(timeout=120) for _ in asking] == [{"x": 0.1 + 0.2}] * 2
    for process in asking:
        process.join()
    assert (tmp_path / "calls.txt").read_text() == "called\n"


def test_what_fails_is_not_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(computed_once, "folder", tmp_path)
    with pytest.raises(ZeroDivisionError):
        once("number", lambda: 1 / 0)
    assert once("number", lambda: 2) == 2 == once("number", lambda: 3)
