"""Number and kind of minima over one or two parameters of a sweep."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from origami_nlp.display import KINDS, MISSING, label_text
from origami_nlp.errors import SweepError
from origami_nlp.sweep.load import sweep_grid


def draw_sweep(folder: str | Path) -> Figure:
    """Draw a sweep over one parameter (a line a kind) or two (a map of each kind that occurs).

    Scenes that are invalid, failed or not yet run are left out of lines, and grey on maps.

    Parameters
    ----------
    folder
        Of `run_sweep`.

    Returns
    -------
    matplotlib.figure.Figure
        The picture; angles as the sweep states them, in radians.

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
    counted = {"all minima": count}
    counted |= {kind: grid["data"][f"count_{kind.replace('-', '_')}"] for kind in KINDS}
    shown = {
        title: np.ma.masked_less(number, 0)
        for title, number in counted.items()
        if number is count or (number > 0).any()
    }
    with mpl.rc_context({"font.size": 10, "axes.titlesize": 10}):
        figure = Figure(layout="constrained", dpi=110, figsize=(6.4, 3.9))
        if count.ndim == 1:
            axes, x = figure.subplots(), grid["axes"][names[0]]
            order = np.argsort(x)
            for title, number in shown.items():
                colour = KINDS[title].colour if title in KINDS else "black"
                axes.plot(x[order], number[order], "o-", ms=3, color=colour, label=title)
            axes.set(ylabel="number of minima", ylim=(0, None), **_axis(grid, "x", names[0]))
            axes.legend(frameon=False)
            return figure
        figure.set_size_inches(1.4 + 2.9 * len(shown), 3.3)
        every = figure.subplots(1, len(shown), sharex=True, sharey=True, squeeze=False)[0]
        most = max(1, int(count.max()))
        look: dict[str, Any] = {"cmap": mpl.colormaps["viridis"].resampled(most + 1)}
        look |= {"vmin": -0.5, "vmax": most + 0.5, "shading": "nearest"}
        for axes, (title, number) in zip(every, shown.items(), strict=True):
            axes.set_facecolor(MISSING)
            image = axes.pcolormesh(*(grid["axes"][n] for n in reversed(names)), number, **look)
            axes.set(title=title, **_axis(grid, "x", names[1]), **_axis(grid, "y", names[0]))
            axes.label_outer()
        figure.colorbar(image, ax=every, ticks=range(most + 1), label="number of minima")
    return figure


def _axis(grid: dict[str, Any], side: str, name: str) -> dict[str, str]:
    """Return what an axis of a parameter says, and its scale."""
    scale = "log" if grid["log"][name] else "linear"
    return {f"{side}label": label_text(name), f"{side}scale": scale}
