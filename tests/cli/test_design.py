"""`origami-nlp design`: files and exit codes."""

import json

import pytest

from origami_nlp import read_scene
from origami_nlp.springs import EXAMPLES
from tests.command_line import run

pytest.importorskip("clarabel")
TWO = """
[vertex]
sector_angles_deg = [99.4, 83.5, 74.1, 103.0]
[[states]]
name = "a"
fold_angles_deg = [27.270, 101.001, -27.353, 104.220]
[[states]]
name = "b"
fold_angles_deg = [-27.270, -101.001, 27.353, -104.220]
[springs]
stiffness = [0.1, 0.2]
rest_angles_deg = [0, 90]
"""


def test_a_design_is_written_and_read_again(tmp_path):
    scene, data, targets = (tmp_path / n for n in ("s.toml", "d.json", "t.toml"))
    code, out, err = run(
        *("design", "--example", "waitukaitis-five", "--scene", scene, "--json", data),
        *("--targets", targets),
    )
    assert code == 0, err
    assert "verified" in out and "no other minimum" in out
    assert targets.read_text() == EXAMPLES["waitukaitis-five"]
    found = json.loads(data.read_text())
    assert set(found) >= {"feasible", "margin", "scene", "states", "extra_minima", "reason"}
    assert len(found["states"]) == 5 and not found["extra_minima"]
    assert read_scene(scene).degree == 4 and found["scene"]


def test_exit_codes(tmp_path):
    file = tmp_path / "t.toml"
    file.write_text(TWO)
    code, out, _ = run("design", file)
    assert code == 1 and "No design" in out and "what would help" in out
    file.write_text(TWO.replace('name = "b"', 'name = "a"'))
    code, _, err = run("design", file)
    assert code == 2 and "two states are called" in err
    assert run("design")[0] == 2 and run("design", "--example", "nothing")[0] == 2
    file.write_text(EXAMPLES["waitukaitis-five"] + "[ask]\ntolerance_percent = 5\n")
    code, out, _ = run("design", file)
    assert code == 3 and "not verified: state 'b' is lost" in out
