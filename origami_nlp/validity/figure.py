"""The frames of a check drawn with their faults marked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from origami_nlp.display import WARNING, draw_pattern, draw_pattern_state, pattern_view
from origami_nlp.errors import OptionError, OrigamiError
from origami_nlp.pattern import Frame, frame_pattern
from origami_nlp.validity.faults import Fault, Findings
from origami_nlp.validity.geometry import is_same_sheet
from origami_nlp.validity.result import Validity

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_PANELS = 4
"""Frames that are drawn: those with faults first."""
MOST_LINES = 14
"""Faults that are written below."""
LETTERS = 84
"""Of a fault below a panel."""
WIDTH = 5.2
"""Of a panel [inches]."""


def draw_validity(result: Validity) -> Figure:
    """Draw the frames of a file with numbers at its faults, and what each number says.

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
    faulty = {one.frame for one in result.faults}
    order = sorted(result.frames, key=lambda one: (one.number not in faulty, one.number))
    shown = sorted(order[:MOST_PANELS], key=lambda one: one.number)
    numbers = {id(one): k for k, one in enumerate(result.faults, start=1)}
    lines = [f"{numbers[id(one)]}  {one.text}" for one in result.faults[:MOST_LINES]]
    if len(result.faults) > MOST_LINES:
        lines.append(f"... and {len(result.faults) - MOST_LINES} more")
    columns = min(len(shown), 2)
    rows = -(-len(shown) // columns)
    below = 0.19 * max(len(lines), 1) + 0.2
    figure = Figure(figsize=(WIDTH * columns, WIDTH * rows + below))
    height = WIDTH * rows + below
    top = 1 - 0.65 / height
    grid = figure.add_gridspec(rows, columns, left=0.02, right=0.98, top=top, bottom=below / height)
    for k, frame in enumerate(shown):
        axes = figure.add_subplot(grid[k // columns, k % columns])
        here = [(numbers[id(one)], one) for one in result.faults if one.frame == frame.number]
        if not frame.folded:  # what is wrong with a folded form, where it is on the paper
            here += [
                (numbers[id(one)], there)
                for other in shown
                if other.folded and is_same_sheet(other, frame)
                for one in result.faults
                if one.frame == other.number
                for there in _on(frame, one)
            ]
        kind = "folded form" if frame.folded else "crease pattern"
        if len(result.frames) > 1:
            axes.set_title(f"frame {frame.number}: {kind}", fontsize=9, parse_math=False)
        _draw(axes, frame, here)
    figure.suptitle(
        result.sentence,
        fontsize=11,
        x=0.02,
        y=1 - 0.1 / height,
        ha="left",
        va="top",
        parse_math=False,
    )
    for k, line in enumerate(lines):
        y = (below - 0.19 * (k + 1)) / height
        short = line if len(line) <= LETTERS * columns else line[: LETTERS * columns - 3] + "..."
        figure.text(0.02, y, short, fontsize=8, va="bottom", parse_math=False)
    return figure


def _on(frame: Frame, one: Fault) -> Iterator[Fault]:
    """Go through the places of a fault of another frame of the same sheet in this one: each of its faces, or one."""
    middle = Findings(frame).middle
    apart = len(one.faces) > 1 and not (one.vertices or one.edges)
    for faces in [(k,) for k in one.faces] if apart else [one.faces]:
        yield replace(one, place=tuple(middle(one.vertices, one.edges, faces).tolist()))


def _draw(axes: Axes, frame: Frame, faults: Sequence[tuple[int, Fault]]) -> None:
    """Draw a frame into axes, with the numbers of faults."""
    view = np.eye(3)
    if frame.folded:
        try:
            pattern = frame_pattern(frame)
            corners = [pattern.corners[list(p)] for p in pattern.polygons]
            view = pattern_view(corners)
            draw_pattern_state(axes, pattern, pattern.reference)
        except OrigamiError:  # no sheet: its edges alone
            view = pattern_view([frame.coords[list(face)] for face in frame.faces])
            lines = (frame.coords @ view.T)[frame.edges][:, :, :2]
            axes.add_collection(LineCollection(list(lines), colors="#555555", linewidths=0.8))
            axes.autoscale_view()
    else:
        draw_pattern(frame, axes=axes)
    axes.set_aspect("equal")
    axes.axis("off")
    number = {int(n): k for k, n in enumerate(frame.numbers)}
    edges = [number[e] for _, one in faults for e in one.edges if e in number]
    if edges:
        lines = (frame.coords @ view.T)[frame.edges[edges]][:, :, :2]
        axes.add_collection(
            LineCollection(list(lines), colors=WARNING, linewidths=4.0, alpha=0.45, zorder=5)
        )
    places: dict[tuple[float, ...], list[int]] = {}
    for k, one in faults:
        if one.place:
            x = view @ np.array([*one.place, 0.0][:3])
            places.setdefault(tuple(np.round(x[:2], 9)), []).append(k)
    for (x, y), which in places.items():
        text = ", ".join(map(str, which[:3])) + (", ..." if len(which) > 3 else "")
        axes.plot(x, y, "o", ms=11, mfc="none", mec=WARNING, mew=1.8, zorder=6)
        axes.annotate(
            text,
            (x, y),
            (7, 7),
            textcoords="offset points",
            fontsize=9,
            fontweight="bold",
            color=WARNING,
            zorder=7,
            path_effects=[withStroke(linewidth=2.5, foreground="white")],
        )
