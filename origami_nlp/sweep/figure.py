"""Number and kind of minima over one or two parameters of a sweep."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from origami_nlp.arguments import check_path
from origami_nlp.errors import SweepError
from origami_nlp.files import save_figure
from origami_nlp.sweep.load import KINDS, sweep_grid

COLOURS = {
    "interior": "#0072b2",
    "contact-pinned": "#d55e00",
    "contact-touching": "#e69f00",
    "degenerate": "#7a7a7a",
}
MISSING = "#d9d9d9"


def draw_sweep(folder: str | Path, path: str | os.PathLike[str] | None = None) -> Figure:
    """Draw a sweep over one parameter (stacked kinds) or two (a map of each kind that occurs).

    Scenes that are invalid, failed or not yet run are grey.

    Parameters
    ----------
    folder
        Of `run_sweep`.
    path
        Where to save, or None.

    Returns
    -------
    matplotlib.figure.Figure
        The picture.

    Raises
    ------
    SweepError
        If the sweep has more than two dimensions, or the folder holds none.
    OptionError
        If the file cannot be written.
    """
    if path is not None:
        check_path("path", path)
    grid = sweep_grid(folder)
    names = list(grid["axes"])
    shape = grid["count"].shape
    if len(shape) > 2:
        raise SweepError(
            f"a figure needs one or two dimensions, not {len(shape)}: load the sweep and take a slice"
        )
    with mpl.rc_context({"font.size": 9, "axes.titlesize": 9}):
        figure = _curve(grid, names[0]) if len(shape) == 1 else _maps(grid, names)
    if path is not None:
        save_figure(figure, path, 200)
    return figure


def _by_kind(grid: dict[str, Any]) -> dict[str, np.ndarray]:
    found = {kind: grid[f"count_{kind.replace('-', '_')}"] for kind in KINDS}
    return {kind: v for kind, v in found.items() if (v > 0).any()}


def _curve(grid: dict[str, Any], name: str) -> Figure:
    figure = Figure(figsize=(5.2, 3.0), layout="constrained")
    axes = figure.subplots()
    x = grid["axes"][name]
    order = np.argsort(x)
    below = np.zeros(len(x))
    for kind, count in _by_kind(grid).items():
        top = below + np.maximum(count, 0)
        axes.fill_between(
            x[order], below[order], top[order], step="mid", color=COLOURS[kind], label=kind, lw=0
        )
        below = top
    for value in x[grid["count"] < 0]:
        axes.axvline(value, color=MISSING, lw=1)
    _scale(axes.set_xscale, x)
    axes.set(
        xlabel=name,
        ylabel="minima",
        ylim=(0, max(1, below.max()) + 0.3),
        xlim=(x.min(), x.max()),
    )
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    if axes.get_legend_handles_labels()[0]:
        figure.legend(loc="outside upper center", ncols=4, frameon=False)
    return figure


def _maps(grid: dict[str, Any], names: list[str]) -> Figure:
    y, x = (grid["axes"][n] for n in names)
    panels = {"all minima": grid["count"], **_by_kind(grid)}
    figure = Figure(figsize=(1.0 + 2.75 * len(panels), 3.1), layout="constrained")
    rows = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    most = max(1, int(grid["count"].max()))
    colours = mpl.colormaps["viridis"].resampled(most + 1)
    image: Any = None
    for axes, (title, count) in zip(rows, panels.items(), strict=True):
        shown = np.ma.masked_less(count, 0)
        axes.set_facecolor(MISSING)
        image = axes.pcolormesh(
            _edges(x), _edges(y), shown, cmap=colours, vmin=-0.5, vmax=most + 0.5
        )
        _scale(axes.set_xscale, x)
        _scale(axes.set_yscale, y)
        axes.set(title=title, xlabel=names[1])
    rows[0].set_ylabel(names[0])
    bar = figure.colorbar(image, ax=rows, ticks=range(most + 1), label="number", shrink=0.9)
    bar.ax.minorticks_off()
    return figure


def _is_log(v: np.ndarray) -> bool:
    """Whether values are spaced by ratios rather than by differences."""
    if len(v) < 3 or v.min() <= 0:
        return False
    steps, ratios = np.diff(v), np.diff(np.log(v))
    return bool(
        np.ptp(ratios) < np.ptp(steps) / max(abs(np.mean(steps)), 1e-300) * abs(np.mean(ratios))
    )


def _edges(v: np.ndarray) -> np.ndarray:
    """Edges of the cells around the values."""
    if len(v) == 1:
        return np.array([v[0] - 0.5, v[0] + 0.5])
    w = np.log(v) if _is_log(v) else v
    edges = np.concatenate(
        [[1.5 * w[0] - 0.5 * w[1]], (w[1:] + w[:-1]) / 2, [1.5 * w[-1] - 0.5 * w[-2]]]
    )
    return np.exp(edges) if _is_log(v) else edges


def _scale(set_scale: Any, v: np.ndarray) -> None:
    if _is_log(v):
        set_scale("log")
