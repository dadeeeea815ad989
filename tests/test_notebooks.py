"""The notebooks run from top to bottom, and what is stored in them is what they print."""

import re
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

FOLDER = Path(__file__).parent.parent / "notebooks"
NAMES = (
    "03_contact.ipynb",
    "06_speed_error.ipynb",
)
# 02 is tested beside the equations
LARGEST = 1_500_000  # bytes, outputs included
VARIES = re.compile(r"\d\.?\d*e[-+]\d+|\d+\.\d\d s\b|\d+ starts.*|.*(Solve_Succeeded|hits|│).*")
"""Rounding errors, times and counts of the search: they may differ between machines."""


LONG = (
    "01_stable_states.ipynb",
    "04_landscapes.ipynb",
    "05_cones.ipynb",
    "07_from_a_fold_file.ipynb",
)
"""Run with the long studies: what they call has tests of its own."""


@pytest.fixture
def stored(request):
    assert (FOLDER / request.param).stat().st_size < LARGEST
    return nbformat.read(FOLDER / request.param, as_version=4)


def printed(cell):
    """What a cell printed, with what may vary blanked out."""
    text = "".join(out.text for out in cell.get("outputs", []) if out.output_type == "stream")
    return VARIES.sub("~", text)


@pytest.mark.parametrize("stored", [*NAMES, *LONG], indirect=True)
def test_notebook_is_stored_with_outputs(stored):
    nbformat.validate(stored)
    code = [cell for cell in stored.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    assert all(out.output_type != "error" for cell in code for out in cell.outputs)
    assert any("text/html" in out.get("data", {}) for cell in code for out in cell.outputs)


@pytest.mark.parametrize(
    "stored",
    [*NAMES, *(pytest.param(name, marks=pytest.mark.slow) for name in LONG)],
    indirect=True,
)
# the kernel says on stderr and as a warning that it talks over local TCP
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_notebook_runs_and_prints_what_is_stored(stored):
    fresh = nbformat.from_dict(stored)
    for cell in fresh.cells:
        if cell.cell_type == "code":
            cell.outputs = []
    NotebookClient(fresh, timeout=120, kernel_name="python3").execute()
    for before, after in zip(stored.cells, fresh.cells, strict=True):
        if before.cell_type == "code":
            assert printed(after) == printed(before)
