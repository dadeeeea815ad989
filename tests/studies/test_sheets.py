"""The sheets of the paper: drawn from what was found, by command and by call."""

from __future__ import annotations

import resource
from concurrent.futures import ThreadPoolExecutor
from unittest.mock import create_autospec

import numpy as np
import pytest

import origami_nlp as o
from studies import draw_panels, find_panels, sheet_table, sheets as sheet
from studies.__main__ import app
from studies.sheets import PanelGrid
from tests.command_line import run


@pytest.fixture
def one_panel(monkeypatch):
    small = PanelGrid(o.examples.degree8, ("pi/4",), (1.0,))
    monkeypatch.setitem(sheet.SHEETS, "figure4", small)


@pytest.mark.slow
def test_reproduce_writes_png_and_pdf(one_panel, tmp_path):
    code, out, _ = run("reproduce", "figure4", "--folder", tmp_path / "new", commands=app)
    assert code == 0 and "written" in out
    assert (tmp_path / "new/figure4.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "new/figure4.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.slow
def test_sheet_draws_what_was_found(one_panel):
    (panel,) = find_panels("figure4", size=41, workers=1)
    assert panel.counts == (2, 2, 2)
    figure = draw_panels("figure4", [panel])
    axes = figure.axes[0]
    stars = [ln for ln in axes.lines if ln.get_marker() not in (None, "None", "")]
    places = {tuple(np.round([*ln.get_xdata(), *ln.get_ydata()], 9)) for ln in stars}
    assert places == {tuple(np.round(p.point, 9)) for p in panel.places}
    assert "2 minima, 2 stable" in [text.get_text() for text in axes.texts]
    assert len(sheet_table([panel]).rows) == 1


@pytest.mark.parametrize("workers", [1, 2])
def test_each_panel_is_searched_and_mapped(monkeypatch, workers):
    """In one process and in several (here threads), with arguments that the verbs take."""
    grid = PanelGrid(o.examples.degree6, ("pi/3",), (0.5, 1.0))
    monkeypatch.setitem(sheet.SHEETS, "figure3", grid)
    monkeypatch.setattr(sheet, "worker_pool", ThreadPoolExecutor)
    for verb in ("trace_boundary", "find_minima", "find_landscape"):
        monkeypatch.setattr(sheet, verb, create_autospec(getattr(sheet, verb)))
    panels = find_panels("figure3", size=21, workers=workers)
    assert panels == [sheet.find_landscape.return_value] * 2
    assert [call.args for call in sheet.find_minima.call_args_list] == [(s,) for s in grid.scenes]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["figure99"], "FIGURE = 'figure99' must be one of figure3, figure4"),
        (["figure3", "-o", "a.txt"], "must end in"),
        (["figure3", "-o", "nowhere/a.png"], "does not exist"),
        (["figure3", "--seed", "-1"], "seed"),
    ],
)
def test_reproduce_complains(arguments, complaint, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, _, err = run("reproduce", *arguments, commands=app)
    assert code == 2 and complaint in err and len(err.strip().splitlines()) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("name", ["figure3", "figure4"])
def test_whole_sheet(name):
    """All nine panels from two processes: complete boundaries, and less than two minutes of CPU in all."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    panels = find_panels(name, workers=2)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    assert seconds < 120, "two cores would need more than 60 s"
    assert [p.result.scene.name for p in panels] == [s.name for s in sheet.SHEETS[name].scenes]
    for panel in panels:
        assert panel.boundary is not None and panel.boundary.complete
        n_sym, n_open, n_full = panel.counts
        assert n_full is not None and n_open is not None
        assert n_sym == len(panel.result.minima) >= n_open >= n_full
    assert len(draw_panels(name, panels).axes) == 18
