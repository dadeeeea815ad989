"""Labels beside marks that cover no mark, no other label and no name of an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patheffects import withStroke

DIRECTIONS = (45, 135, -45, -135, 0, 180, 90, -90, 22, 68, 112, 158, -22, -68, -112, -158)
"""Where a label may stand, best first [degrees]."""
STEPS = (1.0, 5.0, 9.0, 14.0)
"""Distances between the mark and the label [points]."""


@dataclass
class _Mark:
    """A mark: where [pixels, data], numbers of those that lie there, diameter of the largest [points]."""

    at: np.ndarray
    place: tuple[float, float]
    texts: list[str]
    wide: float


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
    groups: list[_Mark] = []
    for place, text, wide in marks:
        at = axes.transData.transform(place)
        if not np.isfinite(at).all():
            continue
        # marks nearer than this [points] share one label
        near = [g for g in groups if text and g.texts and np.hypot(*(g.at - at)) < 3.0 * point]
        if near:
            near[0].texts.append(text)
            near[0].wide = max(near[0].wide, wide)
        else:
            groups.append(_Mark(at, place, [text] * bool(text), wide))
    taken = [_box(group.at, group.wide * point, group.wide * point) for group in groups]
    frame = axes.get_window_extent(renderer).get_points()
    for group in groups:
        if not group.texts:
            continue
        at = group.at
        text = ", ".join(sorted(group.texts, key=lambda t: (len(t), t)))
        look: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": size, "weight": "bold"}
        look |= {"path_effects": [withStroke(linewidth=2.6, foreground="white")], "zorder": 8}
        look |= {"textcoords": "offset points", "annotation_clip": False, "gid": "label"}
        label = axes.annotate(text, group.place, (0, 0), **look)
        side = np.array(label.get_window_extent(renderer).size)
        best = _best(at, group.wide * point, side, taken, frame, point)
        label.set_position((best - at) / point)
        taken.append(_box(best, *side))


def _best(
    at: np.ndarray,
    wide: float,
    side: np.ndarray,
    taken: list[np.ndarray],
    frame: np.ndarray,
    point: float,
) -> np.ndarray:
    """Choose the middle of a label: first what covers least, then inside the frame, then near."""
    turns = np.radians(DIRECTIONS)
    way = np.tile(np.stack([np.cos(turns), np.sin(turns)], axis=1), (len(STEPS), 1))
    # as far as the box needs to clear the mark in this direction
    reach = wide / 2 + np.repeat(STEPS, len(turns)) * point + np.abs(way) @ side / 2
    middle = at + way * reach[:, None]
    covered = _overlaps(middle, side, taken).sum(axis=1)
    outside = side.prod() - _overlaps(middle, side, [frame])[:, 0]
    return np.asarray(middle[np.lexsort((outside.round(3), covered.round(3)))[0]])


def _box(middle: np.ndarray, *side: float) -> np.ndarray:
    """Return the lower left and the upper right corner of a box, [2, 2]."""
    half = 0.5 * np.array(side)
    return np.array([middle - half, middle + half])


def _overlaps(middle: np.ndarray, side: np.ndarray, others: list[np.ndarray]) -> np.ndarray:
    """Areas that boxes of one size share with others, [K, T]; middles [K, 2]."""
    ends = np.array(others)
    low = np.maximum(middle[:, None] - side / 2, ends[:, 0])
    high = np.minimum(middle[:, None] + side / 2, ends[:, 1])
    return np.asarray(np.maximum(high - low, 0.0).prod(axis=2))
