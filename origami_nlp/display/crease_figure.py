"""A crease pattern drawn: mountains and valleys by colour and by dashes, interior vertices by their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from origami_nlp.arguments import check_type
from origami_nlp.display.style import MOUNTAIN, VALLEY
from origami_nlp.errors import OptionError
from origami_nlp.numerics import NONZERO
from origami_nlp.pattern import Frame, fold_vertices

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LOOKS: dict[str, tuple[str, str, Any, float]] = {
    "B": ("border", "#000000", "solid", 1.6),
    "M": ("mountain", MOUNTAIN, (0, (7, 1.8, 1.2, 1.8)), 1.5),
    "V": ("valley", VALLEY, (0, (3.5, 2.2)), 1.5),
    "?": ("no mountain, no valley", "#8a8a8a", (0, (1, 1.6)), 1.2),
}
"""Name, colour, dashes and width of the lines of each letter; others look like ``?``."""


def draw_creases(
    axes: Axes, xy: np.ndarray, edges: np.ndarray, assignment: Sequence[str], scale: float = 1.0
) -> list[Line2D]:
    """Draw lines of a crease pattern by their letters into bare axes; return what they mean, for a legend.

    Parameters
    ----------
    axes
        Of matplotlib.
    xy
        Places, [V, 2].
    edges
        Ends of each line, [E, 2].
    assignment
        Letter of each, as in a FOLD file.
    scale
        Of widths.
    """
    letters = np.array([a if a in LOOKS else "B" if a == "C" else "?" for a in assignment])
    handles = []
    for letter, (name, colour, dashes, width) in LOOKS.items():
        lines = xy[np.asarray(edges)[letters == letter]]
        if len(lines):
            look: dict[str, Any] = {"linestyles": [dashes], "linewidths": width * scale}
            axes.add_collection(LineCollection(list(lines), colors=colour, capstyle="butt", **look))
            handles.append(Line2D([], [], color=colour, linestyle=dashes, lw=width, label=name))
    axes.set_aspect("equal")
    axes.margins(0.04)
    axes.autoscale_view()
    axes.set_axis_off()
    return handles


def draw_pattern(frame: Frame, *, axes: Axes | None = None) -> Figure:
    """Draw a crease pattern with the numbers of its interior vertices, which `--vertex` takes.

    Parameters
    ----------
    frame
        A flat one, of `read_fold`.
    axes
        Where to draw; by default a figure of its own, with a legend.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Raises
    ------
    OptionError
        If `frame` is not of its type, or a folded form.
    """
    check_type("frame", frame, Frame)
    if frame.folded:
        raise OptionError(
            f"frame {frame.number} is a folded form: choose one that is a crease pattern (--frame)"
        )
    xy = frame.coords[:, :2]
    extent = np.ptp(xy, axis=0)
    here = axes
    if here is None:
        height = float(np.clip(6.0 * extent[1] / max(extent[0], NONZERO), 2.0, 9.0))
        here = Figure(figsize=(6.0, height + 0.5), layout="constrained").add_subplot()
    figure: Any = here.figure.figure  # of axes in part of a figure the whole one
    handles = draw_creases(here, xy, frame.edges, frame.assignment)
    numbers = [v.number for v in fold_vertices(frame)[0]]
    around = [withStroke(linewidth=2.5, foreground="white")]
    # more numbers could not be read
    for number in numbers if len(numbers) <= 150 else ():
        x, y = xy[number]
        here.text(x, y, str(number), ha="center", va="center", fontsize=7, path_effects=around)
    if axes is None:
        figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False)
    drawn: Figure = figure
    return drawn
