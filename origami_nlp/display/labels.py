"""Labels beside marks that cover no mark, no other label and no name of an axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Bbox

SHARED = 3.0
"""Marks nearer than this [points] share one label."""
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
    canvas = FigureCanvasAgg(axes.figure)
    renderer = canvas.get_renderer()
    point = axes.figure.dpi / 72
    groups: list[_Mark] = []
    for place, text, wide in marks:
        at = axes.transData.transform(place)
        if not np.isfinite(at).all():
            continue
        near = [g for g in groups if text and g.texts and np.hypot(*(g.at - at)) < SHARED * point]
        if near:
            near[0].texts.append(text)
            near[0].wide = max(near[0].wide, wide)
        else:
            groups.append(_Mark(at, place, [text] * bool(text), wide))
    taken = [_box(group.at, group.wide * point, group.wide * point) for group in groups]
    frame = axes.get_window_extent(renderer)
    for group in groups:
        if not group.texts:
            continue
        at = group.at
        label = axes.annotate(
            ", ".join(sorted(group.texts, key=lambda t: (len(t), t))),
            group.place,
            (0, 0),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=size,
            weight="bold",
            zorder=8,
            annotation_clip=False,
            gid="label",
            path_effects=[withStroke(linewidth=2.6, foreground="white")],
        )
        extent = label.get_window_extent(renderer)
        best = _best(at, group.wide * point, extent, taken, frame, point)
        label.set_position(((best[0] - at[0]) / point, (best[1] - at[1]) / point))
        taken.append(_box(best, extent.width, extent.height))


def _best(
    at: np.ndarray, wide: float, extent: Bbox, taken: list[Bbox], frame: Bbox, point: float
) -> np.ndarray:
    """Choose the middle of a label: first what covers least, then inside the frame, then near."""
    options: list[tuple[float, float, int, np.ndarray]] = []
    for step in STEPS:
        for angle in DIRECTIONS:
            way = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
            # as far as the box needs to clear the mark in this direction
            reach = abs(way[0]) * extent.width / 2 + abs(way[1]) * extent.height / 2
            middle = at + way * (wide / 2 + step * point + reach)
            box = _box(middle, extent.width, extent.height)
            covered = sum(_overlap(box, other) for other in taken)
            outside = extent.width * extent.height - _overlap(box, frame)
            options.append((round(covered, 3), round(outside, 3), len(options), middle))
    return min(options, key=lambda option: option[:3])[3]


def _box(middle: np.ndarray, width: float, height: float) -> Bbox:
    x, y = middle
    return Bbox.from_extents(x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def _overlap(one: Bbox, other: Bbox) -> float:
    dx = min(one.x1, other.x1) - max(one.x0, other.x0)
    dy = min(one.y1, other.y1) - max(one.y0, other.y0)
    return float(max(dx, 0.0) * max(dy, 0.0))
