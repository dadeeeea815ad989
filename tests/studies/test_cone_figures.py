"""The cone figures of the paper: drawn to files, and their colours read back are the counts."""

import math

import numpy as np
import pytest

from origami_nlp.paper.cone import count
from studies import cone_figures
from studies.__main__ import app
from tests.command_line import run
from tests.computed_once import thinned


@pytest.mark.slow
@pytest.mark.parametrize("name", thinned(["cone-3", "cone-4-firing"], 2))
def test_paper_figures_are_drawn_as_png_and_pdf(name, tmp_path, monkeypatch):
    monkeypatch.setattr(cone_figures, "SIZE", 4)
    cone_figures._diagram.cache_clear()
    done = run("reproduce", name, "--folder", tmp_path, commands=app)
    cone_figures._diagram.cache_clear()
    assert done.code == 0, done.err
    assert (tmp_path / f"{name}.png").read_bytes()[:4] == b"\x89PNG"
    assert (tmp_path / f"{name}.pdf").read_bytes()[:5] == b"%PDF-"


@pytest.mark.slow
def test_figure_axis_is_the_papers(monkeypatch):
    """Colours of the drawn map, read back, are the counts at minus nu_0."""
    monkeypatch.setattr(cone_figures, "SIZE", 6)
    cone_figures._diagram.cache_clear()
    drawn = cone_figures.draw_cone_figure("cone-4")
    cone_figures._diagram.cache_clear()
    axes = drawn.axes[0]
    mesh = axes.collections[0]
    shown = mesh.get_array().reshape(6, 6)
    low, high = axes.get_xlim()
    assert (low, high) == pytest.approx((-math.pi / 2, math.pi / 4))
    nu = low + (high - low) * (np.arange(6) + 0.5) / 6
    ratios = 10 ** (-2 + 4 * (np.arange(6) + 0.5) / 6)
    wanted = np.array([[count(8, r, -v, depth=1e-3).stable_interior for v in nu] for r in ratios])
    numbers = np.unique(wanted)
    assert (numbers[shown.astype(int)] == wanted).all()
