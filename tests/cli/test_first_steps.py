"""What people want first, as the help shows it: from a file of their own to an answer, end to end."""

import json
import re

import pytest

from origami_nlp.pattern import examples
from tests.command_line import run


def asked(*words, code=0):
    """Run a command as a new user types it; return what it prints."""
    done = run(*words)
    assert done.code == code, done.err
    return done.out


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder, in which the user is."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_vertex_with_measured_sector_angles(folder):
    text = asked("example", "miura")
    assert "sector_angles_deg, rest_angles_deg take degrees" in text
    text = re.sub(r"sector_angles = .*", "sector_angles_deg = [99.6, 83.2, 74.3, 102.6]", text)
    text = re.sub(r"rest_angles = .*", "rest_angles_deg = [-45, 90, 90, 90]", text)
    (folder / "my.toml").write_text(text)
    wrong = run("minima", "my.toml")
    assert wrong.code == 2 and "0.3 deg missing" in wrong.err and "normalize = true" in wrong.err
    (folder / "my.toml").write_text(text.replace("[vertex]", "[vertex]\nnormalize = true"))
    assert re.search(r"\n +1 +99\.675 +0\.025 +-45 *\n", asked("inspect", "my.toml"))
    found = run("minima", "my.toml", "-o", "states.json")
    assert "each by +0.075 deg" in found.err and "2 stable states" in found.out
    assert len(json.loads((folder / "states.json").read_text())["minima"]) == 2


def test_a_fold_file_with_letters_alone(folder):
    drawn = examples.crease_pattern("miura:2x2")
    kept = ("file_spec", "vertices_coords", "edges_vertices", "edges_assignment")
    (folder / "my.fold").write_text(json.dumps({key: drawn[key] for key in kept}))
    listed = asked("inspect", "my.fold", "-o", "my.png")
    assert "1 interior vertex" in listed and (folder / "my.png").stat().st_size > 10_000
    springs = ("--stiffness", 0.02, "--rest-angle", 90)
    said = asked("minima", "my.fold", *springs, "--starts", 2, "-o", "states.fold")
    assert re.search(r"[1-9]\d* stable state", said)
    assert json.loads((folder / "states.fold").read_text())["file_frames"]
    # written down once, the springs are there for every command
    asked("inspect", "my.fold", *springs, "-o", "mine.fold")
    assert "1 minima" in asked("contacts", "mine.fold", "--effort", "quick")


def test_springs_for_two_given_states(folder):
    text = (
        asked("example", "switch").split("[[barriers]]")[0] + "[springs]\nstiffness = [0.01, 1.0]\n"
    )
    text = text.replace("[27.27, 101.001, -27.353, 104.22]", "[27, 101, -27, 104]")
    (folder / "two.toml").write_text(text)
    said = asked("design", "two.toml", "-o", "my.toml")
    assert "springs hold all 2 states" in said and "moved to close [deg]" in said
    stable = asked("minima", "my.toml", "-o", "states.json")
    assert "stable states" in stable
    minima = json.loads((folder / "states.json").read_text())["minima"]
    wanted = [(27, 101, -27, 104), (99.6, 153.5, -100, 169.3)]
    for state in wanted:  # measured: the nearest state that closes is held
        off = [
            max(abs(57.29578 * a - b) for a, b in zip(m["fold_angles"], state, strict=True))
            for m in minima
        ]
        assert min(off) < 1.0
