"""The notebook on the equations runs from a fresh kernel and shows what is committed."""

import pickle
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).parents[2] / "notebooks" / "02_equations.ipynb"


def texts(notebook):
    """Printed text and Markdown of every code cell; a kernel may cut one text into several outputs."""
    return [
        "".join(
            out.get("text") or out["data"].get("text/markdown") or out["data"]["text/plain"]
            for out in cell["outputs"]
        )
        for cell in notebook.cells
        if cell.get("outputs")
    ]


# the claims are decided once per run: the kernel reads the verdicts
DECIDED = """
import pickle
from origami_nlp.symbolic import catalogue
verdicts = pickle.loads({content!r})
catalogue.decide_all = lambda claims: [catalogue.Result(c, verdicts[c.id]) for c in claims]
"""


@pytest.mark.slow  # the whole catalogue
def test_the_committed_notebook_runs_and_is_current(run):
    committed = nbformat.read(NOTEBOOK, as_version=4)
    fresh = nbformat.read(NOTEBOOK, as_version=4)
    content = pickle.dumps({r.claim.id: r.verdict for r in run})
    fresh.cells.insert(0, nbformat.v4.new_code_cell(DECIDED.format(content=content)))
    NotebookClient(
        fresh,
        timeout=600,
        startup_timeout=600,
        kernel_name="python3",
        resources={"metadata": {"path": NOTEBOOK.parent}},
    ).execute()
    assert texts(fresh) == texts(committed)
    assert "all decided" in texts(committed)[-1]
