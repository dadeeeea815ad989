"""Minima marked on a landscape, and what the marks mean."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from origami_nlp.chart import HANDLE, Landscape, Place
from origami_nlp.minima.minimum import Minimum

WARNING = "#B00020"
"""Of a minimum that is not stable when the symmetry may break."""


STYLE: dict[str, tuple[str, Any]] = {
    "interior": ("#F0B000", "*"),
    "contact-pinned": ("#D55E00", (4, 1, 0)),
    "contact-touching": ("#56B4E9", (6, 1, 0)),
    "degenerate": ("#CC79A7", "X"),
}
"""Colour and marker of each kind of minimum."""


SIZE = {"*": 17.0, "X": 11.0}


@dataclass(frozen=True)
class Marks:
    """Minima with their places on the landscape; branch None marks those of every branch."""

    minima: tuple[Minimum, ...]
    places: list[Place]
    branch: int | None

    def here(self) -> list[tuple[int, Minimum, Place]]:
        """(number from 1, minimum, place) of those to mark on the branch."""
        return [
            (k, m, p)
            for k, (m, p) in enumerate(zip(self.minima, self.places, strict=True), start=1)
            if p.drawn and (self.branch is None or p.branch == self.branch)
        ]


def mark_minima(axes: Any, marks: Marks) -> None:
    """Put markers and numbers of minima; those on one point share a label."""
    here = marks.here()
    for _, minimum, place in here:
        colour, marker = STYLE[minimum.kind]
        x, y = place.point
        top = {"clip_on": False, "zorder": 6, "linestyle": "none"}
        for extra in _surrounds(minimum, place, _freedom(marks)):
            axes.plot([x], [y], **extra, **top)
        face = "white" if minimum.local_dimension == 0 else colour
        edge, width = ("black", 0.9) if face != "white" else (colour, 1.8)
        if minimum.full_space is not None and minimum.full_space.verdict == "unstable":
            edge, width = WARNING, 2.2
        axes.plot(
            [x],
            [y],
            marker=marker,
            markersize=SIZE.get(marker, 15.0) if isinstance(marker, str) else 15.0,
            markerfacecolor=face,
            markeredgecolor=edge,
            markeredgewidth=width,
            path_effects=[withStroke(linewidth=2.6, foreground="white")],
            **top,
        )
        if minimum.local_dimension == 0:
            axes.plot([x], [y], marker=".", markersize=5, color=colour, **top)
    for (x, y), text in _spread_labels(axes, [(p.point, str(k)) for k, _, p in here]):
        axes.annotate(
            text,
            (x, y),
            ha="center",
            va="center",
            fontsize=11,
            weight="bold",
            color="black",
            path_effects=[withStroke(linewidth=2.6, foreground="white")],
            zorder=8,
            annotation_clip=False,
        )


def legend_entries(
    chart: Landscape, minima: tuple[Minimum, ...], places: list[Place]
) -> list[Line2D]:
    """Legend handles for the kinds and surrounds that occur."""
    here = Marks(minima, places, None).here()
    minima, places = tuple(m for _, m, _ in here), [p for _, _, p in here]
    entries = []
    for kind, (colour, marker) in STYLE.items():
        if any(m.kind == kind for m in minima):
            entries.append(_sample(kind, marker=marker, markerfacecolor=colour, markersize=12))
    for dimension, text in ((1, "minimum on a 1-handle"), (0, "isolated point")):
        for m, p in zip(minima, places, strict=True):
            if m.local_dimension == dimension < _freedom(Marks(minima, places, None)):
                style = next(iter(_surrounds(m, Place(p.branch, p.point), 2)), {})
                if dimension == 0:
                    style = {
                        "marker": r"$\odot$",
                        "markerfacecolor": "black",
                        "markeredgewidth": 0.3,
                    }
                entries.append(_sample(text, **{**style, "markersize": 12}))
                break
    if any(p.family for p in places):
        entries.append(_sample("family on one point", **{**_RING, "markersize": 13}))
    if chart.handles:
        entries.append(Line2D([], [], label="1-handle", **HANDLE))
    return entries


def _freedom(marks: Marks) -> int:
    """Largest local dimension: that of open regions, against which handles stand out."""
    return max((m.local_dimension for m in marks.minima), default=0)


def _surrounds(minimum: Minimum, place: Place, freedom: int) -> list[dict[str, Any]]:
    halo = {"path_effects": [withStroke(linewidth=3.0, foreground="white")], "markeredgewidth": 1.3}
    extra = []
    if minimum.local_dimension == 1 < freedom:
        extra.append({**_SQUARE, **halo})
    if place.family:
        extra.append({**_RING, **halo})
    return extra


_RING = {"marker": "o", "markersize": 23, "markerfacecolor": "none", "markeredgecolor": "black"}


_SQUARE = {"marker": "s", "markersize": 19, "markerfacecolor": "none", "markeredgecolor": "black"}


def _sample(label: str, **style: Any) -> Line2D:
    style.setdefault("markeredgecolor", "black")
    return Line2D([], [], linestyle="none", label=label, **style)


def _spread_labels(
    axes: Any, points: list[tuple[tuple[float, float], str]]
) -> list[tuple[tuple[float, float], str]]:
    """Choose for each label the free side of its marker; labels of one place are joined."""
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    box = axes.get_position()
    width, height = axes.figure.get_size_inches() * (box.width, box.height)
    scale = np.array([width / (x1 - x0), height / (y1 - y0)])  # to inches
    groups: list[tuple[np.ndarray, list[str]]] = []
    for point, text in points:
        at = np.array(point) * scale
        for place, texts in groups:
            if np.hypot(*(place - at)) < 0.05:
                texts.append(text)
                break
        else:
            groups.append((at, [text]))
    taken = [place for place, _ in groups]
    low, high = np.array([x0, y0]) * scale, np.array([x1, y1]) * scale
    labels = []
    for place, texts in groups:
        text = ", ".join(texts)
        half = 0.05 * len(text)
        options: list[tuple[bool, float, int, np.ndarray]] = []
        for angle in np.radians([45, 135, -45, -135, 0, 180, 90, -90]):
            way = np.array([math.cos(angle), math.sin(angle)])
            at = place + way * (0.25 + half * abs(way[0]))
            room = min((float(np.hypot(*(at - t))) for t in taken if t is not place), default=9.0)
            inside = bool(np.all(at > low + 0.08) and np.all(at < high - 0.08))
            options.append((inside, min(room, 0.5), -len(options), at))
        best = max(options, key=lambda option: option[:3])[3]
        taken.append(best)
        labels.append(((float(best[0] / scale[0]), float(best[1] / scale[1])), text))
    return labels
