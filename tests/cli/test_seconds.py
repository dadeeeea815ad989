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
    find_minima,
    read_result,
)
from origami_nlp.cli import Ended
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


def test_barriers_of_a_pattern_that_were_found_in_time_are_written(tmp_path):
    out, figure = tmp_path / "out.json", tmp_path / "out.png"
    done = run("barriers", "yoshimura:2x2", "--seconds", 1, "-o", out, "-o", figure)
    assert done.code == Ended.OUT_OF_TIME and figure.exists(), done
    assert "interrupted by the time limit" in " ".join(done.out.split())
    assert json.loads(out.read_text())["left_out"]
