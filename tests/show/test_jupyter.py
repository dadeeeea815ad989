"""Results in a real Jupyter kernel: text where text is asked for, and one display."""

import json
import re
import subprocess
import sys

import nbformat
import pytest
from nbclient import NotebookClient

from tests.computed_once import shared

SETUP = """
import origami_nlp
from origami_nlp.barriers import find_barriers
from origami_nlp.critical import find_critical_points
scene = origami_nlp.examples.degree6("pi/4")
minima = origami_nlp.find_minima(scene, fewest_starts=16, max_starts=16)
points = find_critical_points(scene, samples=512)
barriers = find_barriers(scene, minima, spacing=0.5)
texts = {name: str(globals()[name]) for name in ("scene", "minima", "points", "barriers")}
"""


@shared
def executed():
    sources = [SETUP, "import json; print(json.dumps(texts))", "minima", "points"]
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(s) for s in sources])
    NotebookClient(book, timeout=300, kernel_name="python3").execute()

    return [cell.outputs for cell in book.cells]


@pytest.fixture
def outputs():
    return executed()


def without_time(text):
    """Its lines but for those that say how long the search, or the proof, took."""
    return [re.sub(r" boxes, .* s\)", "", ln) for ln in text.splitlines() if " s, seed" not in ln]


# the kernel says as a warning that it talks over local TCP
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_repr_is_the_same_text_in_a_kernel_and_outside(outputs):
    code = SETUP + "import json; print(json.dumps(texts))"
    alone = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    outside = json.loads(alone.stdout)
    inside = json.loads(outputs[1][0].text)
    assert "symmetric minima" in inside["minima"] and "Morse sum" in inside["points"]
    for name, text in inside.items():
        assert without_time(text) == without_time(outside[name])
        assert text.strip(), name


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_each_result_is_displayed_once(outputs):
    assert outputs[0] == []  # asking for repr displays nothing
    for shown in outputs[2:]:
        assert [out.output_type for out in shown] == ["execute_result"]
        assert shown[0].data["text/plain"].strip()
    assert "<table" in outputs[2][0].data["text/html"]
