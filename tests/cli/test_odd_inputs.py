"""Inputs that are not what they say, readers that go, and what libraries say: one line, or none."""

import json
import os
import subprocess
import sys
import warnings

import pytest

from origami_nlp import examples
from origami_nlp.errors import OrigamiError, SceneError
from origami_nlp.pattern import format_scene, parse_scene
from origami_nlp.results import read_result
from tests.command_line import run, scene_file


@pytest.mark.skipif(os.name == "nt", reason="pipes of Unix")
def test_a_reader_that_goes_after_a_line_loses_no_file(tmp_path):
    out = tmp_path / "out.json"
    words = [sys.executable, "-m", "origami_nlp", "inspect", "miura:20x20", "-o", out]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.readline()
        process.stdout.close()
        said = process.stderr.read()
    assert process.returncode == 141 and not said
    assert len(json.loads(out.read_text())["frames"][0]["vertices"]) == 19 * 19


@pytest.mark.parametrize("name", ["/etc/passwd", "../hinge.csv", "a/../../hinge.csv"])
def test_a_scene_reads_no_file_elsewhere(name):
    text = format_scene(examples.miura()).replace("[creases]", '[creases]\nlaw = "a"')
    with pytest.raises(SceneError, match="beside the scene"):
        parse_scene(f'{text}\n[laws.a]\ndata = "{name}"\n')


def test_what_libraries_warn_of_is_not_said(tmp_path, monkeypatch):
    def warn(*_, **__):
        with warnings.catch_warnings():
            warnings.simplefilter("always")
            warnings.warn("of a library", RuntimeWarning, stacklevel=1)
        raise OrigamiError("wrong")

    monkeypatch.setattr("origami_nlp.pattern.decode_scene", warn)
    with monkeypatch.context() as here:
        here.setattr(warnings, "showwarning", warnings.showwarning)
        done = run("inspect", scene_file(tmp_path, examples.miura()))
    assert done == (2, "", "origami-nlp: wrong\n")


@pytest.mark.parametrize("keys", [("motion", "energy"), ("motion", "arc")])
def test_lists_of_a_result_that_do_not_fit_together_are_an_error_of_the_file(tmp_path, keys):
    out = tmp_path / "out.json"
    assert run("inspect", "miura:2x2", "--path", "-o", out).code == 0
    read_result(out)
    data = json.loads(out.read_text())
    data[keys[0]][keys[1]] = []
    out.write_text(json.dumps(data))
    with pytest.raises(OrigamiError, match=r"out\.json"):
        read_result(out)
