"""Inputs that are not what they say, readers that go, and what libraries say: one line, or none."""

import json
import os
import subprocess
import sys

import pytest

from origami_nlp import examples
from origami_nlp.errors import SceneError
from origami_nlp.pattern import format_scene, parse_scene


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
