"""The notebooks run from top to bottom, and what is stored in them is what they print."""

import ast
import re
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

import origami_nlp

FOLDER = Path(__file__).parent.parent / "notebooks"
LARGEST = 1_500_000  # bytes, outputs included
VARIES = re.compile(r"\d\.?\d*e[-+]\d+|\d+\.\d\d s\b|\d+ starts.*|.*(Solve_Succeeded|hits|│).*")
"""Rounding errors, times and counts of the search: they may differ between machines."""


LONG = ("00_primer.ipynb", "01_stable_states.ipynb", "07_from_a_fold_file.ipynb")
"""Run with the long studies: what they call has tests of its own, and 02 is run beside the equations."""


@pytest.fixture
def stored(request):
    assert (FOLDER / request.param).stat().st_size < LARGEST
    return nbformat.read(FOLDER / request.param, as_version=4)


def printed(cell):
    """What a cell printed, with what may vary blanked out."""
    text = "".join(out.text for out in cell.get("outputs", []) if out.output_type == "stream")
    return VARIES.sub("~", text)


ALL = sorted(path.name for path in FOLDER.glob("*.ipynb"))


def source(book):
    """Its code, without commands of the notebook."""
    cells = (cell.source for cell in book.cells if cell.cell_type == "code")
    return re.sub(r"^[%!].*$", "", "\n".join(cells), flags=re.MULTILINE)


def not_public(code):
    """Names with an underscore in front, and names of the package that it does not offer."""
    tree = ast.parse(code)
    package = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for alias in node.names
        if alias.name == "origami_nlp"
    }
    offered = {*origami_nlp.__all__, "__version__"}
    later = [
        v for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for v in node.values[1:]
    ]
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            if node.attr.startswith("_") and node.attr not in offered:
                yield node.attr
            if isinstance(node.value, ast.Name) and node.value.id in package:
                yield from {node.attr} - offered
        if isinstance(node, ast.ImportFrom):
            yield from (a.name for a in node.names if a.name.startswith("_"))
            if node.module == "origami_nlp":
                yield from {a.name for a in node.names} - offered
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in later:
            yield from re.findall(r"^_[a-z]\w*$", node.value)  # for getattr


@pytest.mark.parametrize("stored", ALL, indirect=True)
def test_cells_use_public_names_only(stored):
    assert not list(not_public(source(stored)))


def test_the_check_of_names_sees_private_ones():
    code = (
        "import origami_nlp as o\nfrom origami_nlp.kkt import _x\no.find_minima\no.nothing\na._b\n"
    )
    assert set(not_public(code + "getattr(a, '_c')")) == {"_x", "nothing", "_b", "_c"}


@pytest.mark.parametrize("stored", LONG, indirect=True)
def test_notebook_is_stored_with_outputs(stored):
    nbformat.validate(stored)
    code = [cell for cell in stored.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    assert all(out.output_type != "error" for cell in code for out in cell.outputs)
    assert any("text/html" in out.get("data", {}) for cell in code for out in cell.outputs)


@pytest.mark.parametrize(
    "stored",
    [pytest.param(name, marks=pytest.mark.slow) for name in LONG],
    indirect=True,
)
# the kernel says on stderr and as a warning that it talks over local TCP
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_notebook_runs_and_prints_what_is_stored(stored):
    fresh = nbformat.from_dict(stored)
    for cell in fresh.cells:
        if cell.cell_type == "code":
            cell.outputs = []
    NotebookClient(fresh, timeout=600, startup_timeout=600, kernel_name="python3").execute()
    for before, after in zip(stored.cells, fresh.cells, strict=True):
        if before.cell_type == "code":
            assert printed(after) == printed(before)
