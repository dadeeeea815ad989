"""A frame of a check drawn with its faults marked."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import shorten
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from origami_nlp.display import WARNING, draw_pattern, pattern_view
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Frame
from origami_nlp.validity.faults import Fault
from origami_nlp.validity.result import Validity

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_LINES = 14
"""Faults that are written below."""
LETTERS = 84
"""Of a fault below a panel."""
WIDTH = 5.2
"""Of a panel [inches]."""


def draw_validity(result: Validity) -> Figure:
    """Draw the first frame that has faults, with numbers at these, and what each number says.

    Parameters
    ----------
    result
        Of `check`.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Raises
    ------
    OptionError
        If the result was read from a file, which holds no frames.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.validity import draw_validity
    >>> len(draw_validity(o.check("miura:2x2")).axes)
    1
    """
    if not result.frames:
        raise OptionError("result was read from a file without its frames: check the origami anew")
    first = result.faults[0].frame if result.faults else result.frames[0].number
    frame = next(one for one in result.frames if one.number == first)
    faults = [(k, one) for k, one in enumerate(result.faults, start=1) if one.frame == first]
    lines = [shorten(f"{k}  {one.text}", LETTERS) for k, one in faults[:MOST_LINES]]
    lines += [f"... {len(result.faults) - len(lines)} more"] * (len(result.faults) > len(lines))
    figure = Figure((WIDTH, WIDTH + 0.19 * len(lines)), layout="constrained")
    text: dict[str, Any] = {"parse_math": False, "x": 0.02, "ha": "left"}
    figure.suptitle(f"{result.sentence}; frame {first}", fontsize=11, **text)
    figure.supxlabel("\n".join(lines), fontsize=8, **text)
    _draw(figure.add_subplot(), frame, faults)
    return figure


def _draw(axes: Axes, frame: Frame, faults: Sequence[tuple[int, Fault]]) -> None:
    """Draw a frame and what is wrong with it: edges thick, places as circles with the numbers of faults."""
    view, x = np.eye(3), frame.coords
    if frame.folded:
        view = pattern_view([x[list(face)] for face in frame.faces])
    else:
        draw_pattern(frame, axes=axes)
    x = x @ view.T
    axes.set_aspect("equal")
    axes.axis("off")
    wrong = frame.edges[np.isin(frame.numbers, [e for _, one in faults for e in one.edges])]
    for edges, colour, wide in ((frame.edges, "#555555", 0.8), (wrong, WARNING, 4.0)):
        lines = [*x[edges][:, :, :2]]
        if frame.folded or edges is wrong:
            axes.add_collection(LineCollection(lines, colors=colour, linewidths=wide, alpha=0.5))
    places: dict[tuple[float, float], list[str]] = {}
    for k, one in (each for each in faults if each[1].place):
        px, py, _ = np.round(view @ np.array([*one.place, 0.0][:3]), 9).tolist()
        places.setdefault((px, py), []).append(str(k))
    for at, which in places.items():
        text = ", ".join(which[:3]) + ", ..." * (len(which) > 3)
        axes.plot(*at, "o", ms=11, mfc="none", mec=WARNING, mew=1.8, zorder=6)
        axes.annotate(text, at, (7, 7), textcoords="offset points", color=WARNING, zorder=7)
    axes.autoscale_view()
