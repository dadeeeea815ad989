"""A command loads what it needs and no more: which modules are there when it has ended, in a process of its own."""

import json
import subprocess
import sys

import pytest

from origami_nlp import examples, format_scene

HEAVY = (
    "numpy scipy scipy.sparse scipy.linalg scipy.spatial scipy.special "
    "matplotlib casadi sympy pydantic shapely cattrs rich.console"
).split()
COMPUTES = {"numpy", "casadi", "rich.console", "scipy", "scipy.sparse", "scipy.linalg", "shapely"}
"""Of a search: facets are posed by sparse matrices, and shapely draws where layers overlap."""


def loaded(*words):
    """Which of `HEAVY` are loaded when a command has ended."""
    code = (
        "import sys, json, atexit\n"
        "from origami_nlp.cli import main\n"
        f"sys.argv = {['origami-nlp', *map(str, words)]}\n"
        f"here = lambda: print(json.dumps([m for m in {HEAVY} if m in sys.modules]), file=sys.stderr)\n"
        "atexit.register(here)\n"
        "main()\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout, set(json.loads(done.stderr.splitlines()[-1]))


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(format_scene(examples.by_name("miura")))
    return path


@pytest.mark.parametrize(
    "words", [["--version"], ["--help"], ["minima", "--help"], ["paper", "--help"]]
)
def test_what_says_something_of_the_program_loads_nothing(words):
    said, modules = loaded(*words)
    assert said and not modules


def test_a_vertex_with_its_proof_needs_no_more(scene):
    said, modules = loaded("minima", scene)
    assert "proved complete" in said
    assert modules == COMPUTES
