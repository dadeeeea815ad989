"""Number and kind of minima over one or two parameters of a sweep."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from origami_nlp.display import KINDS, MISSING, label_text, patch
from origami_nlp.errors import SweepError
from origami_nlp.sweep.load import sweep_grid

WORDS = {
    "ratio": ("stiffness ratio rₖ", ""),
    "alpha": ("sector angle α₁", "deg"),
    "stiffness": ("stiffness", "N m/rad"),
    "rest_angles": ("rest angle", "deg"),
    "sector_angles": ("sector angle", "deg"),
}
"""What a parameter is, and its unit in a picture, by the last word of its place in the scene."""


def draw_sweep(folder: str | Path) -> Figure:
    """Draw a sweep over one parameter (stacked kinds) or two (a map of each kind that occurs).

    Scenes that are invalid, failed or not yet run are grey.

    Parameters
    ----------
    folder
        Of `run_sweep`.

    Returns
    -------
    matplotlib.figure.Figure
        The picture.

    Raises
    ------
    SweepError
        If the sweep has more than two dimensions, or the folder holds none.
    """
    grid = sweep_grid(folder)
    names, count = list(grid["axes"]), grid["data"]["count"]
    if count.ndim > 2:
        raise SweepError(
            f"a figure needs one or two dimensions, not {count.ndim}: load the sweep and take a slice"
        )
    of_kinds = {kind: grid["data"][f"count_{kind.replace('-', '_')}"] for kind in KINDS}
    of_kinds = {kind: v for kind, v in of_kinds.items() if (v > 0).any()}
    missing = [patch(MISSING, NOT_KNOWN)] if (count < 0).any() else []
    with mpl.rc_context({"font.size": 10, "axes.titlesize": 10}):
        figure = Figure(layout="constrained", dpi=110)
        if count.ndim == 1:
            missing = _curve(figure, grid, names[0], of_kinds) + missing
        else:
            _maps(figure, grid, names, of_kinds)
        if missing:
            figure.legend(handles=missing, loc="outside upper center", ncols=4, frameon=False)
    return figure


def _curve(figure: Figure, grid: dict[str, Any], name: str, of_kinds: dict[str, Any]) -> list[Any]:
    """Draw stacked numbers of each kind, and return what the legend says."""
    figure.set_size_inches(6.4, 3.9)
    axes = figure.subplots()
    x = _values(grid, name)
    order, below = np.argsort(x), np.zeros(len(x))
    look: dict[str, Any] = {"step": "mid", "lw": 0, "edgecolor": "white"}
    for kind, count in of_kinds.items():
        top = below + np.maximum(count, 0)
        look |= {"facecolor": KINDS[kind].colour, "hatch": KINDS[kind].hatch}
        axes.fill_between(x[order], below[order], top[order], **look, label=kind)
        below = top
    for value in x[grid["data"]["count"] < 0]:
        axes.axvline(value, color=MISSING, lw=1)
    axes.set(xscale=_scale(grid, name), xlabel=axis_label(grid, name), ylabel=COUNTED)
    axes.set(ylim=(0, max(1, below.max()) + 0.3), xlim=(x.min(), x.max()))
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    return list(axes.get_legend_handles_labels()[0])


def _maps(figure: Figure, grid: dict[str, Any], names: list[str], of_kinds: dict[str, Any]) -> None:
    """Draw a map of the number of minima of each kind."""
    count, stable = (grid["data"][key] for key in ("count", "count_stable"))
    y, x = (_edges(_values(grid, n), grid["log"][n]) for n in names)
    panels = {"all minima": count, **of_kinds}
    if np.isfinite(stable[count >= 0]).all():  # else what a broken symmetry does was not asked
        panels = {"stable states": np.nan_to_num(stable, nan=-1), **panels}
    columns = 2 if len(panels) == 4 else min(3, len(panels))
    rows = -(-len(panels) // columns)
    figure.set_size_inches(1.4 + 2.9 * columns, 0.4 + 2.9 * rows)
    grids = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    most = max(1, int(count.max()))
    look: dict[str, Any] = {
        "cmap": mpl.colormaps["viridis"].resampled(most + 1),
        "vmin": -0.5,
        "vmax": most + 0.5,
    }
    image: Any = None
    for axes in grids.flat[len(panels) :]:
        axes.axis("off")
    for axes, (title, number) in zip(grids.flat, panels.items(), strict=False):
        axes.set_facecolor(MISSING)
        image = axes.pcolormesh(x, y, np.ma.masked_less(number, 0), **look)
        axes.set(xscale=_scale(grid, names[1]), yscale=_scale(grid, names[0]), title=title)
    for axes in grids.flat[max(len(panels) - columns, 0) : len(panels)]:
        axes.set_xlabel(axis_label(grid, names[1]))
        axes.tick_params(labelbottom=True)
    for axes in grids[:, 0]:
        axes.set_ylabel(axis_label(grid, names[0]))
    bar = figure.colorbar(image, ax=grids, ticks=range(most + 1), label=COUNTED, shrink=0.9)
    bar.ax.minorticks_off()


COUNTED = "number of minima"
NOT_KNOWN = "no scene, failed or not run"


def axis_label(grid: dict[str, Any], name: str) -> str:
    """Name a parameter in words, with its unit.

    Parameters
    ----------
    grid
        Of `sweep_grid`.
    name
        Of the parameter.

    Returns
    -------
    str
        What it is and of which creases; the name that the sweep gives it, where it gives one.
    """
    places = grid["places"][name]
    word = places[0].rsplit(".", 1)[-1].split("[")[0].removesuffix("_deg")
    words, unit = WORDS.get(word, (name, ""))
    numbers = re.findall(r"\[(\d+)\]", " ".join(places))
    if name not in places:  # the sweep names it
        words = name
    elif word == "sector_angles":
        words += " " + ", ".join(numbers)
    elif word in WORDS and numbers:
        words += f" of crease{'s' * (len(numbers) > 1)} {', '.join(numbers)}"
    return label_text(words) + f" [{unit}]" * bool(unit)


def _scale(grid: dict[str, Any], name: str) -> str:
    return "log" if grid["log"][name] else "linear"


def _values(grid: dict[str, Any], name: str) -> np.ndarray:
    """The values of a parameter, angles in degrees."""
    v: np.ndarray = grid["axes"][name]
    typed = "_deg" in grid["places"][name][0]
    return np.degrees(v) if axis_label(grid, name).endswith("[deg]") and not typed else v


def _edges(v: np.ndarray, log: bool) -> np.ndarray:
    """Edges of the cells around the values."""
    if len(v) == 1:
        return np.array([v[0] - 0.5, v[0] + 0.5])
    w = np.log(v) if log else v
    edges = np.concatenate(
        [[1.5 * w[0] - 0.5 * w[1]], (w[1:] + w[:-1]) / 2, [1.5 * w[-1] - 0.5 * w[-2]]]
    )
    return np.exp(edges) if log else edges
