"""The data flows one way, and importing the package stays light."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import origami_nlp

ROOT = Path(origami_nlp.__file__).parent
LAYERS = [
    "errors",
    "workers",
    "state",
    "closed_forms",
    "model",
    "solve",
    "judge",
    "tell",
    "bench",
    "sweep",
    "cli",
]


def imports(path: Path) -> list[tuple[str, bool]]:
    """Modules of ours that a file imports, and whether at its top level."""
    tree = ast.parse(path.read_text())
    top = set(ast.iter_child_nodes(tree))
    found = []
    for node in ast.walk(tree):
        names = []
        if isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names = [node.module]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        found += [(name, node in top) for name in names if name.startswith("origami_nlp.")]
    return found


@pytest.mark.parametrize("layer", LAYERS[1:])
def test_modules_import_only_from_the_layers_before_them(layer):
    allowed = set(LAYERS[: LAYERS.index(layer) + 1])
    for path in sorted((ROOT / layer).rglob("*.py")):
        for name, top in imports(path):
            # inside functions a later layer may be called where a user asks for it (scene.model(), reprs)
            if top:
                assert name.split(".")[1] in allowed, f"{path.name} imports {name}"


def test_files_read_in_one_sitting():
    for path in ROOT.rglob("*.py"):
        assert len(path.read_text().splitlines()) <= 450, path


def test_import_is_fast_and_light():
    code = (
        "import time, sys; t = time.perf_counter(); import origami_nlp; "
        "s = time.perf_counter() - t; "
        "heavy = {'casadi', 'matplotlib', 'sympy', 'rich', 'typer', 'scipy'} & set(sys.modules); "
        "print(s, sorted(heavy))"
    )
    times = []
    for _ in range(3):  # the best of three: the machine may be busy
        out = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout
        seconds, heavy = out.split(maxsplit=1)
        assert heavy.strip() == "[]"
        times.append(float(seconds))
    assert min(times) < 0.5


def test_public_names_exist():
    for name in origami_nlp.__all__:
        if name != "draw_minima":
            assert getattr(origami_nlp, name) is not None
    with pytest.raises(AttributeError):
        _ = origami_nlp.nothing
