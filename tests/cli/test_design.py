"""`origami-nlp design`: files and exit codes."""

import json

import pytest

from origami_nlp import read_scene
from origami_nlp.inverse_design import EXAMPLES
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
    assert run("example", "waitukaitis-five", "-o", targets).code == 0
    code, out, err = run("design", "waitukaitis-five", "-o", scene, "-o", data)
    assert code == 0, err
    assert "springs hold all 5 states" in out and "no other minima" in out
    assert targets.read_text() == EXAMPLES["waitukaitis-five"]
    found = json.loads(data.read_text())
    assert set(found) >= {"feasible", "margin", "scene", "states", "extra_minima", "reason"}
    assert len(found["states"]) == 5 and not found["extra_minima"]
    assert read_scene(scene).degree == 4 and found["scene"]


VERTEX = "[vertex]\nsector_angles_deg = [99.4, 83.5, 74.1, 103.0]\n"
A = '[[states]]\nname = "a"\nfold_angles_deg = [27.27, 101.001, -27.353, 104.22]\n'
B = '[[states]]\nname = "b"\nfold_angles_deg = [99.626, 153.537, -100.033, 169.255]\n'
GOOD = VERTEX + A + B
LIKE = VERTEX + '[[states]]\nname = "c"\nlike = "{}"\n'

BAD = [
    ("", "is empty"),
    ("\0", "TOML"),
    (VERTEX, "states is empty"),
    (GOOD + "[spring]\n", "[spring]"),
    (GOOD + "[springs]\nstifness = [1, 2]\n", "'stifness'"),
    (VERTEX + A + "energy = 1\n", "energy_above"),
    ('[vertex]\nfold = "a.fold"\n' + A, "sector_angles"),
    (VERTEX + A + A, "two states are called 'a'"),
    (GOOD + A.replace('"a"', '"c"'), "'a' and 'c' are one"),
    (VERTEX + A.replace('"a"', "3"), "name = 3"),
    (VERTEX + A.replace("27.27", '"x"'), "fold_angles_deg[1]"),
    (VERTEX + A.replace("27.27, ", ""), "3 fold angles"),
    (VERTEX + A.replace("_deg", ""), "fold_angles_deg"),
    (VERTEX + A.replace("104.22", "204.22"), "beyond its limit"),
    (VERTEX + A.replace("-27.353", "60"), "'a' does not close"),
    (GOOD.replace("sector_angles_deg", "sector_angles"), "sector_angles[1]"),
    (LIKE.format("no.json#1"), "No such file"),
    (LIKE.format("states.json#9"), "schema"),
    (LIKE.format("states.json"), "FILE#NUMBER"),
    (LIKE.format("states.json#" + "9" * 5000), "FILE#NUMBER"),
    (LIKE.format("nan.json#1"), "not valid JSON"),
    (GOOD + "[springs]\nstiffness = [0.5, 0.1]\n", "[0.5, 0.1]"),
    (GOOD + "[springs]\nrest_angles = [1, -1]\n", "rest_angles = [1, -1]"),
    (GOOD + "[springs]\nrest_angles = [-180, 180]\n", "preload"),
    (GOOD + "[springs]\nrest_angles = [-1, 1]\nrest_angles_deg = [-1, 1]\n", "rest_angles_deg"),
    (VERTEX + A + 'energy_above = "x"\n', "states are a"),
    (VERTEX + A + 'energy_above = "a"\n', "itself"),
    (GOOD + 'energy_above = "a"\nenergy_difference = ["x", 1]\n', "'x'"),
    (GOOD + '[[barriers]]\nfrom = "a"\nto = "z"\n', "a, b"),
    (GOOD + "[ask]\nrounds = 5\n", "rounds"),
    (GOOD + '[springs]\npreload = "yes"\n', "preload = 'yes'"),
]
"""Targets, and what the one line that refuses each must contain."""


@pytest.mark.parametrize(("text", "word"), BAD)
def test_bad_targets_get_one_line_and_nothing_is_written(text, word, tmp_path):
    (tmp_path / "t.toml").write_text(text, encoding="utf-8")
    (tmp_path / "states.json").write_text('{"minima": []}')
    (tmp_path / "nan.json").write_text('{"minima": [{"fold_angles": [0, 0, 0, NaN]}]}')
    before = sorted(tmp_path.iterdir())
    files = ("-o", tmp_path / "s.toml", "-o", tmp_path / "d.json")
    code, out, err = run("design", tmp_path / "t.toml", *files, "-o", tmp_path / "f.png")
    assert (code, out) == (2, "") and len(err.strip().splitlines()) == 1, err
    assert word in err, err
    assert sorted(tmp_path.iterdir()) == before
