"""`follow` and `boundary`: what they print, write and refuse."""

import json

import pytest
from typer.testing import CliRunner

from origami_nlp import examples, format_scene
from origami_nlp.cli import app


def run(*arguments):
    return CliRunner().invoke(app, [str(a) for a in arguments])


def test_states_are_followed_over_a_parameter(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(format_scene(examples.degree6("5*pi/12")))
    files = [tmp_path / name for name in ("a.json", "a.png", "a.fold")]
    done = run(
        "follow", scene, "--parameter", "ratio=1:5", "--checks", 2, "-o", files[0], "-o", files[1],
        "-o", files[2],
    )  # fmt: skip
    assert done.exit_code == 0 and "2 to 3 symmetric minima" in done.output
    data = json.loads(files[0].read_text())
    assert [e["type"] for e in data["events"]] == ["nonsmooth-fold", "closes"]
    assert all(f.stat().st_size > 1000 for f in files)
    wrong = run("follow", scene, "--parameter", "colour=1:5")
    assert wrong.exit_code != 0 and "no parameter" in str(wrong.exception)


@pytest.mark.slow  # a survey over two parameters
def test_events_are_followed_over_two_parameters(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(format_scene(examples.degree6("pi/4")))
    out = tmp_path / "b.json"
    done = run(
        "boundary", scene, "--event", "ratio=1", "--parameter", "alpha=50deg:51deg", "--lines", 1, "-o", out
    )  # fmt: skip
    assert done.exit_code == 0
    (curve,) = json.loads(out.read_text())["curves"]
    ratios, angles = zip(*(p["t"] for p in curve["points"]), strict=True)
    assert min(ratios) < 1 < max(ratios) and len(set(angles)) == len(angles)
