"""The states of a search side by side, each with one line below: a picture for the top of a page."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from origami_nlp.minima.stability import asked, verdict
from origami_nlp.show import draw_state, label_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from origami_nlp.minima.result import MinimaResult

SIDE, LINE = 2.5, 0.3
"""Of one picture, and height of the line below it [in]."""
ROOM = 0.1
"""Share of a picture's height that a number below a crease takes."""


def draw_states(result: MinimaResult, *, columns: int = 4) -> Figure:
    """Draw the states of a search side by side.

    Parameters
    ----------
    result
        Of `find_minima`.
    columns
        States in a row.

    Returns
    -------
    matplotlib.figure.Figure
        Each state as `show.draw_state` has it; below it number, energy, kind, and the verdict where it was asked for.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.minima import draw_states
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> [axes.get_title() for axes in draw_states(result).axes]
    ['1: 0.00909 J, interior', '2: 1.23 J, contact-touching']
    """
    from matplotlib.figure import Figure

    scene, minima = result.scene, result.minima
    across = max(1, min(columns, len(minima)))
    down = max(1, -(-len(minima) // across))
    figure = Figure(dpi=100, facecolor="white")
    grid = figure.subplots(down, across, squeeze=False).flat
    for k, axes in enumerate(grid):
        axes.axis("off")
        if k < len(minima):
            m = minima[k]
            draw_state(axes, scene.vertex, m.fold_angles)
            known = f", {verdict(scene, m)}" if asked(minima) else ""
            said = label_text(f"{k + 1}: {m.energy:.3g} J, {m.kind}{known}")
            axes.set_title(said, y=0.0, pad=-4, va="top", fontsize=8.5)
    empty = min((_empty(axes) for axes in grid[: len(minima)]), default=0.0)
    for axes in grid[: len(minima)]:  # what is empty below all of them goes
        low, high = axes.get_ylim()
        axes.set_ylim(low + empty * (high - low), high)
    tall = SIDE * (1 - empty)
    figure.set_size_inches(SIDE * across, (tall + LINE) * down)
    bottom = LINE / (down * (tall + LINE))
    figure.subplots_adjust(0.01, bottom, 0.99, 0.99, wspace=0.05, hspace=LINE / tall)
    return figure


def _empty(axes: Axes) -> float:
    """Return the share of a drawn state's height below which nothing is painted, with room for a number."""
    painted = np.asarray(axes.images[0].get_array())[..., 3].max(axis=1) > 0
    return max(0.0, float(np.argmax(painted)) / painted.size - ROOM)
