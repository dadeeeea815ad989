"""`follow` and `boundary`: what they print, write and refuse."""

import json

import pytest

from origami_nlp import examples
from tests.command_line import run, scene_file


def test_states_are_followed_over_a_parameter(tmp_path):
    scene = scene_file(tmp_path, examples.degree6("5*pi/12"))
    files = [tmp_path / name for name in ("a.json", "a.png", "a.fold")]
    done = run(
        "follow", scene, "--parameter", "ratio=1:5", "--checks", 1, "-o", files[0], "-o", files[1],
        "-o", files[2],
    )  # fmt: skip
    assert done.code == 0
    data = json.loads(files[0].read_text())
    assert [e["type"] for e in data["events"]] == ["nonsmooth-fold", "closes"]
    assert all(f.stat().st_size > 1000 for f in files)
    wrong = run("follow", scene, "--parameter", "colour=1:5")
    assert wrong.code == 2 and "no number" in wrong.err


@pytest.mark.slow  # a survey over two parameters
def test_events_are_followed_over_two_parameters(tmp_path):
    scene = scene_file(tmp_path, examples.degree6("pi/4"))
    out = tmp_path / "b.json"
    done = run(
        "boundary", scene, "--event", "ratio=0.8:1.3", "--parameter", "alpha=50deg:51deg", "--lines", 1, "-o", out
    )  # fmt: skip
    assert done.code == 0
    (curve,) = json.loads(out.read_text())["curves"]
    ratios, angles = zip(*(p["t"] for p in curve["points"]), strict=True)
    assert min(ratios) < 1 < max(ratios) and len(set(angles)) == len(angles)
