"""What an analysis needs beside the core is an extra, and its lack is said in one line that names it."""

import re
import sys
import tomllib
from pathlib import Path

import pytest

from tests.command_line import run

ROOT = Path(__file__).parent.parent.parent
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
SOURCES = "\n".join(path.read_text() for path in (ROOT / "origami_nlp").rglob("*.py"))


def test_what_is_required_is_in_the_extra_that_is_named():
    calls = re.findall(r'\brequire\("(\w+)", "[^"]+", "(\w+)"', SOURCES)
    assert {module for module, _ in calls} >= {
        "trimesh",
        "clarabel",
        "pandas",
        "distributed",
        "ezdxf",
    }
    for module, extra in calls:
        assert any(line.startswith(module) for line in EXTRAS[extra])


@pytest.mark.parametrize(
    ("module", "extra", "words"),
    [
        ("clarabel", "design", ["design", "three-equal"]),
        ("trimesh", "mesh", ["minima", "miura:2x2", "-o", "a.glb"]),
        ("ezdxf", "dxf", ["inspect", str(Path(__file__).parents[1] / "drawings" / "square.dxf")]),
    ],
)
def test_a_command_without_its_extra_names_it(monkeypatch, tmp_path, module, extra, words):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, module, None)  # as if it were not installed
    done = run(*words)
    assert done.code == 2
    assert f"needs {module}" in done.err and f'"origami_nlp[{extra}]"' in done.err.replace(
        "\n", " "
    )
