"""Words that a shell completes: asked for as the shell does, through the functions that it is given."""

import os
import subprocess
import sys

import pytest


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    """A folder with the program, and the environment in which a shell finds it."""
    folder = tmp_path_factory.mktemp("bin")
    file = folder / "origami-nlp"
    file.write_text(f"#!{sys.executable}\nfrom origami_nlp.cli import main\nmain()\n")
    file.chmod(0o755)
    root = os.path.dirname(os.path.dirname(os.path.dirname(__file__)))
    path = os.pathsep.join([str(folder), os.environ["PATH"]])
    return {**os.environ, "PATH": path, "PYTHONPATH": root}


EACH = """
import contextlib, os, sys
from origami_nlp.cli import main
lines, sys.argv = sys.argv[1:], ["origami-nlp"]
for line in lines:
    os.environ["_TYPER_COMPLETE_ARGS"] = f"origami-nlp {line}"
    with contextlib.suppress(SystemExit):
        main()
    print("next")
"""
"""Starting the program takes longer than completing a line."""


def test_zsh_is_told_words_with_what_they_mean_or_files(program):
    asked = {
        "paper cone ph": '"phase":"Map the number',
        "paper transitions ": '"degree6"',
        "minima ": "_files",
    }
    done = subprocess.run(
        [sys.executable, "-c", EACH, *asked],
        env={**program, "_ORIGAMI_NLP_COMPLETE": "complete_zsh"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0 and not done.stderr
    *reported, rest = done.stdout.split("next\n")
    assert not rest
    for shown, out in zip(asked.values(), reported, strict=True):
        assert shown in out and (shown == "_files") == ("_arguments" not in out)
