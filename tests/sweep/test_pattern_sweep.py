"""Sweeps of patterns: each is its sheet alone; answers depend on neither workers nor interruptions."""

import json
import tomllib
import warnings

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OrigamiError
from origami_nlp.facets import Sheet, order_layers
from origami_nlp.pattern import pattern_from_dict, pattern_to_dict
from origami_nlp.sheets import sheet_frame, sheet_to_fold
from origami_nlp.sweep import (
    draw_sweep,
    load_states,
    load_sweep,
    parse_sweep,
    read_sweep,
    run_sweep,
)
from origami_nlp.sweep.run import run_scene
from tests.command_line import run
from tests.sweep.test_sweep import Inline, answers

SMALL = """
[pattern]
example = "degree6"
stiffness = 0.01
[[axes]]
set = "creases.rest_angles"
values = [0.8, 1.2]
[[axes]]
set = "mountains.stiffness"
from = 0.001
to = 0.1
count = 2
scale = "log"
[search]
starts = 2
"""


def small(**search):
    data = tomllib.loads(SMALL)
    data["search"] |= search
    return parse_sweep(data)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sheets")
    report = run_sweep(small(), folder, executor=Inline())
    assert report.counts == {"done": 4} and not report.interrupted
    return folder


@pytest.mark.slow
def test_a_sweep_is_its_sheets(finished):
    states, counts = load_states(finished), load_sweep(finished)
    assert counts["count"].shape == (2, 2)
    for index in (0, 3):
        rest, k = (0.8, 0.001) if not index else (1.2, 0.1)
        sheet = o.examples.pattern("degree6").with_springs(0.01, rest)
        sheet = sheet.with_springs(np.where(sheet.signs < 0, k, 0.01).tolist())
        alone = o.find_minima(sheet, starts=2)
        here = states[states.scene == index]
        assert np.array_equal(here["energy"], [m.energy for m in alone.minima])
        assert list(here["dimension"]) == [m.freedoms for m in alone.minima]
    assert draw_sweep(finished).axes


@pytest.mark.slow
def test_an_interrupted_sweep_goes_on_to_the_same_answers(finished, tmp_path):
    class Interrupted(Inline):
        left = 2

        def submit(self, fn, /, *args, **kwargs):
            if not self.left:
                raise KeyboardInterrupt
            self.left -= 1
            return super().submit(fn, *args, **kwargs)

    first = run_sweep(small(), tmp_path, executor=Interrupted(), workers=1)
    assert first.interrupted and first.ran < 4
    second = run_sweep(small(), tmp_path, executor=Inline())
    assert second.ran == 4 - first.ran and not second.interrupted
    assert answers(tmp_path) == answers(finished)


@pytest.mark.slow
def test_two_processes_say_what_one_says(finished, tmp_path):
    assert run_sweep(small(), tmp_path, workers=2).counts == {"done": 4}
    assert answers(tmp_path) == answers(finished)


@pytest.mark.slow
def test_a_local_dask_cluster_says_what_one_process_says(finished, tmp_path):
    distributed = pytest.importorskip(
        "distributed", reason='dask is not installed: pip install "origami_nlp[sweep]"'
    )
    spec = tmp_path / "sweep.toml"
    spec.write_text(SMALL)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the cluster's own start and end
        with distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster:
            address = cluster.scheduler_address
            code, out, err = run("sweep", spec, "--out", tmp_path / "o", "--dask", address)
    assert code == 0, (out, err)
    assert answers(tmp_path / "o") == answers(finished)


def test_orders_of_layers_of_a_file_are_those_of_every_sheet(tmp_path):
    sheet = o.examples.pattern("miura:2x2")
    flat = o.find_motion(sheet).phi[-1]
    flat = np.copysign(np.pi, flat)
    data = sheet_to_fold(sheet, [sheet_frame(sheet, flat, "flat-folded")])
    (frame,) = data.pop("file_frames")
    own = {k: v for k, v in frame.items() if k not in ("frame_inherit", "frame_parent")}
    (tmp_path / "folded.fold").write_text(json.dumps(data | own))
    read = o.read_pattern(tmp_path / "folded.fold")
    assert read.orders and order_layers(Sheet(read), flat).stated
    axes = [{"set": "creases.stiffness", "values": [0.01, 2.0]}]
    tables = {"pattern": {"file": "folded.fold"}, "axes": axes, "search": {"starts": 0}}
    sweep = parse_sweep(tables, tmp_path)
    for k in range(2):
        made = sweep.pattern(k)
        again = pattern_from_dict(json.loads(json.dumps(pattern_to_dict(made))))
        for one in (made, again):
            assert one.orders == read.orders and one.stiffness[0] == axes[0]["values"][k]
            assert order_layers(Sheet(one), flat).stated
    # orders that contradict how facets lie are refused before a sheet is searched
    f, g, s = own["faceOrders"][0]
    wrong = [[f, g, -s], *own["faceOrders"][1:]]
    (tmp_path / "folded.fold").write_text(json.dumps(data | own | {"faceOrders": wrong}))
    with pytest.raises(OrigamiError, match="faceOrders"):
        parse_sweep(tables, tmp_path)


def test_places_of_a_pattern(tmp_path):
    sheet = o.examples.pattern("metasheet:2x2")
    (tmp_path / "sheet.fold").write_text(json.dumps(sheet_to_fold(sheet)))
    (tmp_path / "sweep.toml").write_text(
        '[pattern]\nfile = "sheet.fold"\n'
        '[[axes]]\nset = ["creases.stiffness[2]", "creases.stiffness[4]"]\nvalues = [3, 5]\n'
        '[[axes]]\nset = "creases.rest_angles[1]"\nvalues = ["-pi/3", 1]\n'
        '[search]\nmode = "list"\nstarts = 1\n'
    )
    sweep = read_sweep(tmp_path / "sweep.toml")
    (tmp_path / "sheet.fold").unlink()  # the sweep has it
    made = sweep.pattern(1)
    assert sweep.count == 2 and made.stiffness[[1, 3]].tolist() == [5, 5] and made.rest[0] == 1
    assert made.stiffness[[0, 2]] == pytest.approx(sheet.stiffness[[0, 2]])
    drawn = parse_sweep(
        {
            "pattern": {"example": "miura:2x2", "rest_angle": 1.0},
            "axes": [{"set": "alpha", "values": [1.0, "pi/3"]}, {"set": "rows", "values": [2, 3]}],
        }
    )
    assert drawn.pattern(3).facets == 6
    same = o.examples.pattern("miura", 2, 2, alpha=1.0).with_springs(rest=1.0)
    assert pattern_to_dict(drawn.pattern(0)) == pattern_to_dict(same)
    assert pattern_to_dict(pattern_from_dict(pattern_to_dict(made))) == pattern_to_dict(made)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"pattern": {"example": "nothing"}}, "nothing"),
        ({"pattern": {"example": "miura:2x2", "file": "a.fold"}}, "example"),
        ({"pattern": {"example": "miura:2x2", "size": 3}}, "size"),
        ({"axes": []}, "axes"),
        ({"axes": [{"set": "creases.stiffness[9]", "values": [1]}]}, r"\[6\]"),
        ({"axes": [{"set": "creases.stiffness", "values": [-1]}]}, "stiffness"),
        ({"axes": [{"set": "rows", "values": [2.5]}]}, "whole"),
        ({"axes": [{"set": "beta", "values": [2.5]}]}, "beta"),
        ({"search": {"effort": "quick"}}, "effort"),
        ({"search": {"starts": -1}}, "starts"),
        ({"search": {"contact": 1}}, "contact"),
        ({"scene": {}}, "scene"),
    ],
)
def test_what_is_wrong_is_named(change, word):
    with pytest.raises(OrigamiError, match=word):
        parse_sweep(tomllib.loads(SMALL) | change)


def test_a_sheet_that_cannot_be_made_is_invalid():
    data = tomllib.loads(SMALL)
    data["axes"][0] = {"set": "alpha", "values": [1.0, 4.0]}
    assert run_scene(parse_sweep(data), 2, ()).status == "invalid"


@pytest.mark.slow
def test_the_command_says_when_it_was_interrupted(tmp_path, monkeypatch):
    file = tmp_path / "sheets.toml"
    file.write_text(SMALL)
    monkeypatch.setattr("origami_nlp.sweep.run.worker_pool", lambda workers: _Broken())
    code, out, _ = run("sweep", file, "--out", tmp_path / "out", "--workers", "1")
    assert code == 130 and "goes on from here" in out
    monkeypatch.setattr("origami_nlp.sweep.run.worker_pool", lambda workers: Inline())
    code, out, _ = run("sweep", file, "--out", tmp_path / "out", "--figure", tmp_path / "a.png")
    assert code == 0 and "4 done" in out and (tmp_path / "a.png").stat().st_size > 1000


class _Broken(Inline):
    """Stops as Ctrl-C does."""

    def submit(self, fn, /, *args, **kwargs):
        raise KeyboardInterrupt
