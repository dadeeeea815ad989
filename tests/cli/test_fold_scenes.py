"""FOLD files wherever a scene goes in: one vertex, all of them, a scene file; paths as frames; what is refused."""

import io
import json
import sys

import pytest

import origami_nlp as o
from origami_nlp import pattern
from origami_nlp.pattern import examples, fold_vertices, parse_fold, scene_at
from tests.command_line import run, scene_file


@pytest.fixture
def sheet(tmp_path):
    """A Miura sheet with springs, 2 kinds of vertices."""
    path = tmp_path / "sheet.fold"
    path.write_text(json.dumps(examples.crease_pattern("miura", 3, 3)))
    return path


@pytest.fixture
def pocket(tmp_path):
    """The paper's degree-6 vertex as a FOLD file, and the very same scene as a scene file."""
    path = tmp_path / "pocket.fold"
    path.write_text(json.dumps(examples.crease_pattern("degree6", ratio=0.01)))
    scene = o.read_fold_scene(path, symmetry="D1", on_note=lambda note: None)
    return path, scene_file(tmp_path, scene), ("--vertex", 0, "--symmetry", "D1")


COMMANDS = "inspect minima contacts load barriers landscape follow boundary".split()
OVER = ("--parameter", "ratio=0.01:1")
NEEDED = {"follow": OVER, "boundary": (*OVER, "--event", "creases.stiffness[1]=1")}


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_reads_a_vertex_of_a_fold_file_as_its_scene_file(
    command, pocket, monkeypatch
):
    fold, toml, options = pocket
    read = []

    def noted(reader):
        def stop(*arguments, **more):
            read.append(reader(*arguments, **more))
            raise o.OrigamiError("read")

        return stop

    for name in ("scene_at", "decode_scene"):
        monkeypatch.setattr(pattern, name, noted(getattr(pattern, name)))
    needed = NEEDED.get(command, ())
    for words in ((fold, *options), (toml,)):
        assert run(*command.split("-"), *words, *needed).err == "origami-nlp: read\n"
    assert read[0] == read[1] and read[0].group.name == "D1"
    code, _, err = run(*command.split("-"), toml, "--vertex", 0, *needed)
    assert code == 2 and "--vertex is for FOLD files" in err and err.count("\n") == 1


def scenes(path, **options):
    """Every vertex of a file that can be analysed, by its number."""
    (frame,) = parse_fold(path.read_bytes())
    found, _ = fold_vertices(frame)
    return {v.number: scene_at(frame, v, **options) for v in found if not v.reason}


@pytest.mark.parametrize("toml", [False, True])
def test_standard_input_may_be_either(toml, pocket, monkeypatch):
    fold, scene, options = pocket
    raw = (scene if toml else fold).read_bytes()
    for mark in (b"", b"\xef\xbb\xbf", b" \n\t"):
        if toml and mark == b"\xef\xbb\xbf":
            continue  # TOML has no byte order mark
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(mark + raw)))
        done = run("inspect", "-", *(() if toml else options))
        assert done.code == 0 and "degree 6" in done.out, done.err


def test_a_vertex_becomes_a_scene_file_of_the_same_doubles(sheet, tmp_path):
    out = tmp_path / "out.toml"
    for options, keywords in (
        ((), {}),
        (("--symmetry", "none", "--contact", "none"), {"symmetry": "none", "contact": "none"}),
    ):
        for number, scene in scenes(sheet, **keywords).items():
            done = run("inspect", sheet, "--vertex", number, "-o", out, *options)
            assert done.code == 0 and done.out.endswith(f"written: {out}\n")
            again = o.read_scene(out)
            assert again == scene and again.group == scene.group
            assert again.relations.exact == scene.relations.exact
    done = run("inspect", sheet, "--vertex", 5, "-o", "-.toml")
    assert o.parse_scene(done.out) == o.read_fold_scene(sheet, 5, on_note=lambda note: None)
    assert "degree" in done.err  # the table, beside what goes to standard output


def test_examples_are_written_as_asked(tmp_path):
    fold, toml = tmp_path / "a.fold", tmp_path / "a.toml"
    done = run("example", "miura:2x3", "-o", fold, "-o", toml, "--alpha", "pi/4")
    assert done.code == 0 and done.out == f"written: {fold}\nwritten: {toml}\n"
    assert o.read_scene(toml) == examples.miura("pi/4")
    assert len(scenes(fold)) == 2
    for name in examples.BY_NAME:
        done = run("example", name)
        assert done.code == 0 and done.out.startswith("# ") and not done.err
        assert o.parse_scene(done.out) == examples.by_name(name)
