"""Results in a real Jupyter kernel: text where text is asked for, and one display."""

import json
import pickle
import subprocess
import sys

import nbformat
import pytest
from nbclient import NotebookClient

from tests import computed_once
from tests.computed_once import shared
from tests.display.test_results import results

SETUP = """
import pathlib, pickle
found = pickle.loads(pathlib.Path({file!r}).read_bytes())
minima, points, barriers = (found[n] for n in ("MinimaResult", "CriticalPoints", "Barriers"))
scene = minima.scene
texts = {{name: str(globals()[name]) for name in ("scene", "minima", "points", "barriers")}}
"""


@shared
def setup():
    """Code that reads results found before."""
    file = computed_once.folder / "results_for_jupyter"
    file.write_bytes(pickle.dumps(results()))
    return SETUP.format(file=str(file))


@shared
def executed():
    sources = [setup(), "import json; print(json.dumps(texts))", "minima", "points"]
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(s) for s in sources])
    NotebookClient(book, timeout=600, startup_timeout=600, kernel_name="python3").execute()

    return [cell.outputs for cell in book.cells]


@pytest.fixture
def outputs():
    return executed()


# the kernel says as a warning that it talks over local TCP
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_repr_is_the_same_text_in_a_kernel_and_outside(outputs):
    code = setup() + "import json; print(json.dumps(texts))"
    alone = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    outside = json.loads(alone.stdout)
    inside = json.loads(outputs[1][0].text)
    assert "symmetric minima" in inside["minima"] and "Morse sum" in inside["points"]
    for name, text in inside.items():
        assert text == outside[name] and text.strip(), name


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_each_result_is_displayed_once(outputs):
    assert outputs[0] == []  # asking for repr displays nothing
    for shown in outputs[2:]:
        assert [out.output_type for out in shown] == ["execute_result"]
        assert shown[0].data["text/plain"].strip()
    assert "<table" in outputs[2][0].data["text/html"]
