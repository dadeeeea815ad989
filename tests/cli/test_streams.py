"""What surrounds a command: closed streams, settings of others, editors that write a mark, Ctrl-C before it begins."""

import codecs
import os
import subprocess
import sys
from pathlib import Path

import pytest

from origami_nlp import examples, format_scene
from tests.command_line import run, scene_file

ROOT = Path(__file__).parents[2]
POSIX = pytest.mark.skipif(os.name == "nt", reason="needs a POSIX shell and signals")


def shell(line, **settings):
    """Run a line of a shell in which `nlp` is the program."""
    program = f"{sys.executable} -m origami_nlp"
    env = {**os.environ, "PYTHONPATH": str(ROOT), **settings}
    return subprocess.run(
        ["sh", "-c", line.replace("nlp", program)],
        env=env,
        capture_output=True,
        text=True,
        timeout=300,
    )


@POSIX
def test_closed_standard_output_is_named_and_no_file_gets_what_is_printed(tmp_path):
    scene, out = scene_file(tmp_path, examples.degree6("pi/3", 1)), tmp_path / "out.json"
    done = shell(f"nlp minima {scene} -o - >&-")
    assert done.returncode == 2
    assert done.stderr == "origami-nlp: -o = '-' cannot be written: standard output is closed\n"
    assert (
        shell(
            f"nlp paper cone count --degree 6 --ratio 1 --rest-elevation 0.3 -o {out} >&- 2>&-"
        ).returncode
        == 0
    )
    assert out.read_text().startswith("{")


@pytest.mark.parametrize("kind", ["toml", "fold"])
def test_a_byte_order_mark_is_no_text(tmp_path, kind):
    path = tmp_path / f"scene.{kind}"
    if kind == "toml":
        path.write_text(format_scene(examples.degree6("pi/3", 1)))
    else:
        run("example", "degree6", "-o", path)
    plain = run("inspect", path)
    path.write_bytes(codecs.BOM_UTF8 + path.read_bytes())
    assert plain.code == 0 and run("inspect", path) == plain
