"""Labels beside marks that cover no mark, no other label and no name of an axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Bbox

DIRECTIONS = (45, 135, -45, -135, 0, 180, 90, -90, 22, 68, 112, 158, -22, -68, -112, -158)
"""Where a label may stand, best first [degrees]."""
STEPS = (1.0, 5.0, 9.0, 14.0)
"""Distances between the mark and the label [points]."""


def label_marks(
    axes: Any, marks: Sequence[tuple[tuple[float, float], str, float]], size: float
) -> None:
    """Write a label beside each mark, where it covers nothing that is marked; call it when limits are final.

    Parameters
    ----------
    axes
        Of matplotlib.
    marks
        Point, text, and diameter of the mark [points], for each; marks without text are kept free.
    size
        Font size [points].
    """
    if not marks:
        return
    figure: Any = axes.figure.figure  # of axes in part of a figure the whole one
    renderer = FigureCanvasAgg(figure).get_renderer()
    point = figure.dpi / 72
    groups: list[tuple[np.ndarray, tuple[float, float], list[str], float]] = []
    for place, text, wide in marks:
        at = axes.transData.transform(place)
        if not np.isfinite(at).all():
            continue
        # marks nearer than this [points] share one label
        near = [g[2] for g in groups if text and g[2] and np.hypot(*(g[0] - at)) < 3.0 * point]
        if near:
            near[0].append(text)
        else:
            groups.append((at, place, [text] * bool(text), wide * point))
    taken = [_box(at, wide, wide) for at, _, _, wide in groups]
    frame = axes.get_window_extent(renderer)
    turns = np.radians(DIRECTIONS)
    way = np.tile(np.stack([np.cos(turns), np.sin(turns)], axis=1), (len(STEPS), 1))
    for at, place, texts, wide in groups:
        if not texts:
            continue
        text = ", ".join(sorted(texts, key=lambda t: (len(t), t)))
        look: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": size, "weight": "bold"}
        look |= {"path_effects": [withStroke(linewidth=2.6, foreground="white")], "zorder": 8}
        look |= {"textcoords": "offset points", "annotation_clip": False, "gid": "label"}
        label = axes.annotate(text, place, (0, 0), **look)
        side = np.array(label.get_window_extent(renderer).size)
        # as far as the box needs to clear the mark in this direction
        reach = wide / 2 + np.repeat(STEPS, len(turns)) * point + np.abs(way) @ side / 2
        boxes = [_box(middle, *side) for middle in at + way * reach[:, None]]
        # first what covers least, then inside the frame, then near
        cost = [
            (round(sum(_shared(box, t) for t in taken), 3), round(-_shared(box, frame), 3))
            for box in boxes
        ]
        taken.append(boxes[min(range(len(boxes)), key=cost.__getitem__)])
        middle = np.mean(taken[-1].get_points(), axis=0)
        label.set_position((middle - at) / point)


def _box(middle: np.ndarray, width: float, height: float) -> Bbox:
    x, y = middle
    return Bbox.from_bounds(x - width / 2, y - height / 2, width, height)


def _shared(one: Bbox, two: Bbox) -> float:
    """Return the area that two boxes share."""
    both = Bbox.intersection(one, two)
    return both.width * both.height if both else 0.0
