"""The command line as a whole: as a module, its help, what it writes."""

import json
import os
import subprocess
import sys

import pytest
from typer.main import get_command

import origami_nlp
from origami_nlp.cli import app
from origami_nlp.cli.output import Output
from tests.command_line import run
from tests.fold_files import disc


def test_the_package_runs_as_a_module_and_ends_as_the_command_does():
    for arguments, code in ((["example", "degree6"], 0), (["minima", "nowhere.toml"], 2)):
        line = [sys.executable, "-m", "origami_nlp", *arguments]
        done = subprocess.run(line, capture_output=True, text=True, check=False)
        assert done.returncode == code
        assert done.stderr.count("\n") == (code != 0) and bool(done.stdout) == (code == 0)


def test_the_help_lists_what_a_new_user_needs_first_and_old_names_still_work():
    _, text, _ = run("--help")
    order = (
        "minima check-proof contacts modes barriers critical space landscape transitions follow load "
        "vertices model example cone sweep paper bench"
    ).split()
    lines = [line.split() for line in text.split("Commands:")[1].splitlines()]
    assert [words[0] for words in lines if words and words[0] in order] == order
    top = get_command(app)
    assert set(top.commands) == set(order)
    for name, command in top.commands["paper"].commands.items():
        assert top.get_command(None, name) is command
        assert run(name, "--help")[0] == 0
    for wrong in ("count", "nothing"):
        code, out, err = run(wrong)
        assert code == 2 and not out and f"No such command '{wrong}'" in err


def test_an_output_checks_all_files_before_any_and_says_what_it_wrote(tmp_path, capsys):
    good = tmp_path / "a.json"
    for targets, word in (
        ({"json": good, "markdown": tmp_path / "none" / "a"}, "--markdown"),
        ({"json": good, "figure": tmp_path / "a.gif"}, "--figure.*must end in .png"),
        ({"json": good, "npz": tmp_path / "a.txt"}, "--npz.*must end in .npz"),
        ({"json": good, "markdown": good}, "is the file of --json too"),
    ):
        with pytest.raises(origami_nlp.OrigamiError, match=word):
            Output(**targets)
    assert not os.listdir(tmp_path)
    out = Output(json=good, markdown=tmp_path / "a.md", html=None)
    out.write("json", lambda number: {"x": number}, 1)
    out.write("markdown", str.upper, "text")
    out.write("html", lambda: pytest.fail("nobody asked for it"))
    assert json.loads(good.read_text()) == {"x": 1} and (tmp_path / "a.md").read_text() == "TEXT"
    told = capsys.readouterr()
    assert told.out.splitlines() == [f"written: {good}", f"written: {tmp_path / 'a.md'}"]
    out = Output(json="-", markdown=tmp_path / "b.md")
    out.write("json", lambda: [1])
    out.write("markdown", lambda: "b")
    told = capsys.readouterr()
    assert json.loads(told.out) == [1] and told.err == f"written: {tmp_path / 'b.md'}\n"


def test_a_vertex_of_a_fold_file_is_a_scene_and_its_oddities_are_told(tmp_path, capsys):
    file = tmp_path / "a.fold"
    data = disc([60, 100, 120, 80], "MVVV")
    data["edges_vertices"].append(data["edges_vertices"][0])  # a line twice
    data["edges_assignment"].append("M")
    file.write_text(json.dumps(data))
    told = []
    scene = origami_nlp.read_fold_scene(file, tell=told.append, stiffness=2.0)
    assert told and scene.degree == 4 and set(scene.stiffness) == {2.0}
    assert capsys.readouterr().err == ""
    assert origami_nlp.read_fold_scene(file, stiffness=2.0) == scene
    assert capsys.readouterr().err == "".join(f"note: {note}\n" for note in told)
