"""The command line as a whole: as a module, its help, what it writes."""

import json

import pytest

import origami_nlp
from tests.command_line import run
from tests.fold_files import disc


def test_springs_that_a_command_does_not_take_are_in_the_file_that_inspect_writes(tmp_path):
    """All that a FOLD file leaves open can be written down once; the states are the same."""
    file = tmp_path / "a.fold"
    data = disc([60, 100, 120, 80], "MVVV")
    file.write_text(json.dumps(data))
    springs = ("--stiffness", 0.3, "--rest-angle", 40)
    quick = ("--prove", 0, "--effort", "quick", "--max-starts", 8)
    for more, name in ((("--per-length",), "c.fold"), (("--vertex", 0), "d.toml")):
        made = tmp_path / name
        done = run("inspect", file, *springs, *more, "-o", made)
        assert done.code == 0, done.err
        found = [
            json.loads(run("minima", *given, *quick, "-o", "-").out)["minima"]
            for given in ((file, *springs, *more), (made,))
        ]
        energies = [[m["energy"] for m in one] for one in found]
        assert energies[0] and energies[0] == pytest.approx(energies[1], rel=1e-12), name


def test_a_vertex_of_a_fold_file_is_a_scene_and_its_oddities_are_told(tmp_path, capsys):
    file = tmp_path / "a.fold"
    data = disc([60, 100, 120, 80], "MVVV")
    data["edges_vertices"].append(data["edges_vertices"][0])  # a line twice
    data["edges_assignment"].append("M")
    file.write_text(json.dumps(data))
    reported = []
    scene = origami_nlp.read_fold_scene(file, on_note=reported.append, stiffness=2.0)
    assert reported and scene.degree == 4 and set(scene.stiffness) == {2.0}
    assert capsys.readouterr().err == ""
    assert origami_nlp.read_fold_scene(file, stiffness=2.0) == scene
    assert capsys.readouterr().err == "".join(f"note: {note}\n" for note in reported)


def test_a_pattern_is_taken_by_name_as_it_is_from_a_file(tmp_path):
    file = tmp_path / "miura.fold"
    assert run("example", "miura:3x3", "-o", str(file)).code == 0
    one, two = run("inspect", "miura:3x3", "-o", "-"), run("inspect", str(file), "-o", "-")
    assert one.code == two.code == 0
    assert one.out.replace('"source": "miura:3x3"', f'"source": "{file}"') == two.out
    wrong = run("inspect", "kresling")
    assert wrong.code == 2 and "no example: those are miura" in wrong.err
