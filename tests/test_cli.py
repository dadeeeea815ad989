"""The command line does what the README and the contract say."""

import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest
from computed_once import panel_result
from fold_files import disc
from typer.main import get_command

import origami_nlp
from origami_nlp.cli import app, main
from origami_nlp.cli.output import Output
from origami_nlp.minima import result_from_dict, result_to_dict


def run(monkeypatch, capsys, *arguments):
    monkeypatch.setattr(sys, "argv", ["origami-nlp", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    captured = capsys.readouterr()
    return stop.value.code, captured.out, captured.err


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "scene.toml"
    scene = origami_nlp.examples.degree6("pi/3", 1)
    path.write_text(origami_nlp.format_scene(scene))
    return path


def test_minima_writes_the_contract(scene_file, tmp_path, monkeypatch, capsys):
    out = tmp_path / "out.json"
    code, table, _ = run(monkeypatch, capsys, "minima", scene_file, "--json", out)
    assert code == 0 and "4 symmetric minima," in table and "IPOPT" in table
    assert "stable state" not in table and "full space: not asked" in table
    data = json.loads(out.read_text())
    assert data["schema"] == "origami-nlp/minima/1"
    assert set(data) == {"schema", "scene", "model", "search", "minima"}
    assert set(data["model"]) == {
        "variables",
        "equalities",
        "inequalities",
        "contact_pairs",
        "geometry",
        "left_out",
    }
    assert data["model"]["contact_pairs"] == [[1, 3]]
    assert {"starts", "solves", "statuses", "expected_undiscovered", "seconds", "seed"} <= set(
        data["search"]
    )
    assert sum(data["search"]["statuses"].values()) == data["search"]["solves"]
    for m in data["minima"]:
        assert len(m["fold_angles"]) == 6
        assert m["kind"] in ("interior", "contact-pinned", "contact-touching", "degenerate")
        assert m["local_dimension"] in (0, 1, 2)
        assert m["closure_residual"] <= 1e-14 and m["kkt_residual"] <= 1e-12
        for c in m["contacts"]:
            assert c["type"] in ("fold-limit", "facet-pair", "mirror", "axis")
            assert ("creases" in c) != ("facets" in c)
            low, high = c["multiplier_range"]
            assert low <= c["multiplier"] + 1e-12 and (
                high is None or c["multiplier"] <= high + 1e-12
            )
    result = result_from_dict(data)
    assert result_to_dict(result) == data
    assert "phi = -pi at creases 2, 6" in repr(result)


def test_json_to_stdout_is_only_json(scene_file, monkeypatch, capsys):
    few = ("--max-starts", 16)
    code, out, err = run(monkeypatch, capsys, "minima", scene_file, "--json", "-", *few)
    assert code == 0 and json.loads(out)["schema"] == "origami-nlp/minima/1"
    assert "symmetric minima" in err


def test_the_same_seed_gives_the_same_answer(scene_file, tmp_path, monkeypatch, capsys):
    answers = []
    for name in ("a", "b"):
        out = tmp_path / name
        run(monkeypatch, capsys, "minima", scene_file, "--json", out, "--seed", 3)
        data = json.loads(out.read_text())
        data["search"].pop("seconds")
        answers.append(data)
    assert answers[0] == answers[1]


def test_example_prints_a_scene_that_reads_back(monkeypatch, capsys):
    code, out, _ = run(
        monkeypatch, capsys, "example", "degree8", "--alpha", "pi/6", "--ratio", "100"
    )
    assert code == 0
    assert origami_nlp.parse_scene(out) == origami_nlp.examples.degree8("pi/6", 100.0)


def test_model_prints_what_is_in_and_out(scene_file, monkeypatch, capsys):
    code, out, _ = run(monkeypatch, capsys, "model", scene_file)
    assert code == 0 and "variables     4" in out and "left out" in out


def test_scaling_the_stiffness_scales_the_answer_exactly():
    scene = origami_nlp.examples.degree6("pi/3", 1.0)
    one = panel_result(scene)
    for power in (-40, 40):  # about 1e-12 and 1e12
        factor = 2.0**power
        scaled = origami_nlp.Scene(
            scene.vertex, np.array(scene.stiffness) * factor, scene.rest_angles, "D1"
        )
        other = origami_nlp.find_minima(scaled)
        # a power of two changes no digit of the scaled programme
        assert [m.fold_angles for m in other.minima] == [m.fold_angles for m in one.minima]
        assert [m.energy for m in other.minima] == [m.energy * factor for m in one.minima]
        assert [c.multiplier for m in other.minima for c in m.contacts] == [
            c.multiplier * factor for m in one.minima for c in m.contacts
        ]


def test_a_search_stopped_by_its_cap_says_so():
    result = origami_nlp.find_minima(origami_nlp.examples.degree6("pi/3", 1), max_starts=5)
    assert result.search.stopped_by == "cap" and result.search.starts == 5
    assert (
        math.isinf(result.search.expected_undiscovered) or result.search.expected_undiscovered > 0
    )
    assert "cap" in repr(result)


def test_the_package_runs_as_a_module_and_ends_as_the_command_does():
    for arguments, code in ((["example", "degree6"], 0), (["minima", "nowhere.toml"], 2)):
        line = [sys.executable, "-m", "origami_nlp", *arguments]
        done = subprocess.run(line, capture_output=True, text=True, check=False)
        assert done.returncode == code
        assert done.stderr.count("\n") == (code != 0) and bool(done.stdout) == (code == 0)


def test_the_help_lists_what_a_new_user_needs_first_and_old_names_still_work(monkeypatch, capsys):
    _, text, _ = run(monkeypatch, capsys, "--help")
    order = (
        "minima contacts barriers critical space landscape transitions vertices model example "
        "cone sweep paper bench"
    ).split()
    lines = [line.split() for line in text.split("Commands:")[1].splitlines()]
    assert [words[0] for words in lines if words and words[0] in order] == order
    top = get_command(app)
    assert set(top.commands) == set(order)
    for name, command in top.commands["paper"].commands.items():
        assert top.get_command(None, name) is command
        assert run(monkeypatch, capsys, name, "--help")[0] == 0
    for wrong in ("count", "nothing"):
        code, out, err = run(monkeypatch, capsys, wrong)
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
