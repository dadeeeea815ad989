"""``--seconds`` bounds the wall time of every command that searches; what was found until then is reported, by name."""

import itertools
import json
import time
from types import SimpleNamespace

import numpy as np
import pytest

from origami_nlp import (
    Scene,
    Vertex,
    examples,
    find_bifurcation_set,
    find_minima,
    follow,
    load_path,
    read_result,
)
from origami_nlp.cli import Ended
from origami_nlp.errors import OUT_OF_TIME, OptionError
from tests.command_line import run, scene_file


def slow_vertex():
    rng = np.random.default_rng(2)
    sectors = rng.uniform(0.5, 1.5, 12)
    return Scene(
        Vertex(tuple(sectors * 2 * np.pi / sectors.sum())),
        tuple(rng.uniform(0.5, 2, 12)),
        tuple(rng.uniform(-1, 1, 12)),
        "none",
        "fold-limits",
    )


def test_a_search_keeps_to_its_limit_of_wall_time_and_says_so():
    begin = time.process_time()
    result = find_minima(slow_vertex(), seconds=0.5)
    assert time.process_time() - begin < 60  # unbounded: minutes
    assert result.search.stopped_by == "time" and result.flags.search_stopped_early


COMMANDS = {
    "follow": ("--parameter", "ratio=1:10", "--checks", "1", "--effort", "quick"),
    "load": ("--crease", "1", "--to", "-0.15", "--effort", "quick"),
    "boundary": ("--event", "ratio=1:10", "--parameter", "alpha=74deg:75deg", "--lines", "1"),
}


def clock_of_tracers(monkeypatch):
    """Let tracers see an hour more after ten steps, so that a curve is cut on every machine."""
    calls = itertools.count()
    clock = SimpleNamespace(monotonic=lambda: time.monotonic() + 3600.0 * (next(calls) >= 10))
    monkeypatch.setattr("origami_nlp.continuation.tracer.time", clock)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n == "boundary")) for n in COMMANDS]
)
def test_what_was_followed_until_the_time_was_over_is_told_and_written(tmp_path, monkeypatch, name):
    clock_of_tracers(monkeypatch)
    scene, out = scene_file(tmp_path, examples.degree6("5*pi/12")), tmp_path / "out.json"
    figure = tmp_path / "out.png"
    files = "-o", out, "-o", figure
    done = run(name, scene, *COMMANDS[name], "--seconds", 1000, *files)
    assert done.code == Ended.OUT_OF_TIME and figure.exists(), done
    assert "interrupted by the time limit" in " ".join(done.out.split())
    data = json.loads(out.read_text())
    assert data["interrupted"]
    if name == "boundary":
        assert all(line["intervals"] == [] for line in data["lines"])
    else:
        states = [p for b in data["branches"] for p in b["points"]]
        assert 5 < len(states) <= 12
        assert read_result(out).interrupted


def test_states_of_a_path_that_was_cut_are_those_of_the_whole_one(monkeypatch):
    """And where it was cut no event is: it is no limit point, and nothing snaps there."""
    scene, few = examples.degree6("5*pi/12"), {"max_starts": 16}
    whole = load_path(scene, 1, to=-0.15, **few)
    clock_of_tracers(monkeypatch)
    cut = load_path(scene, 1, to=-0.15, seconds=1000.0, **few)
    (leg,) = cut.legs
    assert leg.why == OUT_OF_TIME and not cut.snaps and not cut.events
    assert "does not snap" in " ".join(str(cut).split())
    known = {p.t: p.fold_angles for p in whole.legs[0].points}
    assert len(leg.points) > 5 and all(known[p.t] == p.fold_angles for p in leg.points)


def test_a_time_that_is_over_before_a_path_begins_is_said():
    with pytest.raises(OptionError, match="the time was over before"):
        load_path(examples.degree6("5*pi/12"), 1, to=-0.15, seconds=0.0)


def test_nothing_followed_is_no_count_of_nothing():
    found = find_bifurcation_set(
        examples.degree6("5*pi/12"), "ratio=1:10", "alpha=74deg:75deg", seconds=0.0
    )
    assert found.interrupted and not found.curves
    assert all(not line.intervals for line in found.lines)
    atlas = follow(examples.degree6("5*pi/12"), "ratio=1:10", seconds=0.0)
    assert atlas.interrupted and not atlas.branches and "time limit" in str(atlas)


def test_barriers_of_a_pattern_that_were_found_in_time_are_written(tmp_path):
    out, figure = tmp_path / "out.json", tmp_path / "out.png"
    done = run("barriers", "yoshimura:2x2", "--seconds", 1, "-o", out, "-o", figure)
    assert done.code == Ended.OUT_OF_TIME and figure.exists(), done
    assert "interrupted by the time limit" in " ".join(done.out.split())
    assert json.loads(out.read_text())["left_out"]
