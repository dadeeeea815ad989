"""A command loads what it needs and no more: which modules are there when it has ended, in a process of its own."""

import json
import subprocess
import sys

import pytest
import typer

from origami_nlp import examples, format_scene
from origami_nlp.cli import app, group
from tests.command_line import run

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


@pytest.mark.parametrize("extra", [[], pytest.param(["--prove", 0], marks=pytest.mark.slow)])
def test_a_vertex_with_its_proof_needs_no_more(extra, scene):
    said, modules = loaded("minima", scene, *extra)
    assert "proved complete" in said or extra
    assert modules == COMPUTES


@pytest.mark.slow  # a search and a figure in a new process
def test_a_figure_is_what_loads_matplotlib(scene, tmp_path):
    picture = tmp_path / "states.png"
    words = ["minima", scene, "--prove", 0]
    _, modules = loaded(*words, "-o", picture)
    assert picture.exists()
    assert modules == COMPUTES | {"matplotlib"}


@pytest.mark.parametrize(
    "text",
    ["7", "007", "+7", "-7", " 7", "7.0", "1_0", "7e0", "seven", "", "\u0663", "\u00b2", "9" * 30],
)
def test_a_number_is_read_as_typer_reads_it(text):
    """What is read without pydantic is what pydantic reads, and what it refuses is refused in the same words."""
    command = typer.main.get_command(app).commands["minima"]
    context = command.make_context("minima", ["scene.toml"])
    (seed,) = [p for p in command.get_params(context) if p.name == "seed"]

    def said(read):
        try:
            return read(context, text)
        except Exception as error:  # of Typer's own, or of ours where the number is out of range
            return type(error).__name__, str(error)

    assert said(seed.process_value) == said(lambda *given: type(seed).process_value(seed, *given))


def test_parsers_are_made_of_the_command_that_is_called_alone(monkeypatch):
    made = []
    take = group._Command.__init__

    def note(self, *args, **kwargs):
        made.append(kwargs["name"])
        take(self, *args, **kwargs)

    monkeypatch.setattr(group._Command, "__init__", note)
    assert run("minima", "--help").code == 0 and made == ["minima"]
    # a group without options of its own, as that of the benchmarks
    other = group.Group("two commands")

    def first() -> None:
        """Say one."""
        print("one")

    def second() -> None:
        """Say two."""

    other.add(first, second)
    assert run("first", commands=other).out == "one\n"
    # who asks for all of them, or for none that there is, is informed of all
    assert run("--help").code == 0 and len(made) > 14
    assert "no such command" in run("minimum").err
