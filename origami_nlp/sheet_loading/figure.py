"""The figure of a sheet's load path: load over what it works on, energy, and the sheet where something happens."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.arguments import check_type
from origami_nlp.facets import Sheet
from origami_nlp.files import save_figure
from origami_nlp.loading import PICTURE_WIDTH, load_height, place_load
from origami_nlp.sheet_loading.loaded import LoadedSheet
from origami_nlp.sheet_loading.packing import carried_at
from origami_nlp.sheet_loading.result import SheetLoadPath
from origami_nlp.sheets import draw_sheet
from origami_nlp.show import label_text

MOST_DRAWN = 4
"""Sheets beside each other."""
TALL = 2.9
"""Of the row of sheets [inches]."""


def draw_sheet_load(path: SheetLoadPath, target: str | os.PathLike[str] | None = None) -> Figure:
    """Draw load against angle, the energy of the states that are passed, and the sheet at the start and round snaps.

    Parameters
    ----------
    path
        Of `find_load_path`.
    target
        Where to save (``.png``, ``.pdf``, ``.svg``, ...), or None.

    Returns
    -------
    matplotlib.figure.Figure
        Above as `loading.draw_load` has it; below the first sheets of the path, with rings where facets touch, full
        where they push.

    Raises
    ------
    OptionError
        If `path` is none, or the file cannot be written.
    """
    check_type("path", path, SheetLoadPath)
    height = load_height(path)
    figure = Figure(figsize=(PICTURE_WIDTH, height + TALL), dpi=110, facecolor="white")
    parts: Any = figure.subfigures(2, 1, height_ratios=(height, TALL))
    upper, lower = parts
    place_load(upper, path)
    shown = _shown(path)
    sheet = Sheet(path.pattern)
    for k, (title, phi, t) in enumerate(shown):
        axes = lower.add_axes(((k + 0.02) / len(shown), 0.02, 0.96 / len(shown), 0.82))
        state = np.array(phi)
        contacts = carried_at(LoadedSheet(sheet, path.driver, t), state)
        draw_sheet(axes, path.pattern, state, contacts=contacts)
        axes.set_title(label_text(title), fontsize=9)
    if target is not None:
        save_figure(figure, target)
    return figure


def _shown(path: SheetLoadPath) -> list[tuple[str, tuple[float, ...], float]]:
    """Return titles, fold angles and loads of the start, both sides of snaps, and the ends of legs that do not snap."""
    unit = path.driver.unit
    states = [
        (f"at {p.t:.4g} {unit}", p.fold_angles, p.t)
        for leg in path.legs[:1]
        for p in leg.points[:1]
    ]
    for number, leg in enumerate(path.legs, start=1):
        if leg.snap is None:
            last = leg.points[-1]
            states.append((f"end of leg {number}, {last.t:.4g} {unit}", last.fold_angles, last.t))
            continue
        snap = path.snaps[leg.snap - 1]
        states.append((f"before snap {leg.snap}, {snap.t:.4g} {unit}", snap.before, snap.t))
        states.append((f"after snap {leg.snap}", snap.after, snap.t))
    return states[:MOST_DRAWN]
