"""The figure of an admissible space in the paper's chart."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D

from origami_nlp.chart import borders, chart_limits, chart_of, coordinate_label, surface_pieces
from origami_nlp.display import (
    HANDLE,
    INKS,
    MARGIN,
    RING,
    StackedFigure,
    angle_ticks,
    label_text,
    patch,
    subscript,
)
from origami_nlp.paper.space import Space

LOBES = ("#9ecae1", "#fdd0a2", "#c7e9c0", "#dadaeb", "#d9d9d9")
"""Fill of the pieces of surface (light versions of a colour-blind-safe set)."""
STOPS = 5
"""Walls of `HalfChain.walls` that have a line each; then all stops together."""
DASHES: tuple[Any, ...] = ("-", (0, (6, 1.5)), (0, (2, 1)), (0, (6, 1.5, 1.5, 1.5)), "-", "-")
"""Of these lines, so that they differ in grey too."""
PINCH = {"marker": "p", "markersize": 11, "markerfacecolor": "white"}
END = {"marker": "o", "markersize": 6, "markerfacecolor": HANDLE["color"]}
SIDE, LEFT, WIDTH = 4.6, 0.9, 6.4
"""Height of the picture, what is left of it, and width of all [in]."""


def draw_space(space: Space) -> Any:
    """Draw X in the coordinates of the paper's chart.

    Pieces of surface are filled, contact boundaries and handles are lines, pinch points pentagons; rings are points of
    the chart over which X has several states.

    Parameters
    ----------
    space
        Of `find_space`.

    Returns
    -------
    matplotlib.figure.Figure
        The picture.
    """
    chart, mesh, xy = chart_of(space.scene), space.mesh, space.mesh.chart
    assert chart is not None
    piece = surface_pieces(mesh.triangles)
    # the largest piece first
    rank = np.argsort(np.argsort(-np.bincount(piece), kind="stable"), kind="stable")
    colour = [LOBES[min(rank[k], len(LOBES) - 1)] for k in piece]
    entries: list[Any] = [
        patch(c, f"surface {k}") for k, c in enumerate(LOBES, start=1) if c in colour
    ]
    edges, thin = borders(mesh.triangles, mesh.extra_edges)
    wall = _walls(mesh.on[edges[:, 0]] & mesh.on[edges[:, 1]], len(mesh.walls))
    lines = []
    for k, name in enumerate((*mesh.walls[:STOPS], "at a stop")):
        if drawn := _chained(xy[edges[(wall == k) & ~thin]]):
            look = {"color": INKS[k], "linewidth": 1.8, "linestyle": DASHES[k]}
            lines.append(LineCollection(drawn, **look, zorder=4, clip_on=False))
            words = re.sub(r"phi_(\d+)", lambda m: "φ" + subscript(int(m[1])), name)
            entries.append(Line2D([], [], **look, label=words.replace("+-pi", "±180°")))
    marks = [(HANDLE, "1-handle", xy[h.path], 5) for h in space.handles]
    marks += [
        (RING | {"markersize": 11}, "several states there", np.array([p]), 7)
        for p, _ in space.picture_joins
    ]
    for pinch in space.pinch_points:
        at, one = xy[[pinch.vertex]], pinch.kind == "pinch point"
        look = (PINCH if one else END) | {"markeredgecolor": "black"}
        marks.append((look, "pinch point" if one else "end of a 1-handle", at, 8))
    known: dict[str, Line2D] = {}
    for look, name, _, _ in marks:
        known.setdefault(name, Line2D([], [], **{"linestyle": ""} | look, label=name))
    stack = StackedFigure(WIDTH, SIDE + 0.45, _title(space), [*entries, *known.values()])
    axes = stack.axes(MARGIN + LEFT, 0.0, SIDE, SIDE)
    fill: dict[str, Any] = {"facecolors": colour, "edgecolors": colour, "linewidth": 0.3}
    axes.add_collection(PolyCollection(list(xy[mesh.triangles]), **fill, rasterized=True))
    for line in lines:
        axes.add_collection(line)
    for look, _, points, order in marks:
        axes.plot(*points.T, **{"linestyle": ""} | look | {"zorder": order}, clip_on=False)
    x0, x1, y0, y1 = chart_limits(chart)
    axes.set(xlim=(x0, x1), ylim=(y0, y1))
    axes.set_xlabel(coordinate_label(chart.coordinates[0]))
    axes.set_ylabel(coordinate_label(chart.coordinates[1]))
    angle_ticks(axes.xaxis, x0, x1)
    angle_ticks(axes.yaxis, y0, y1)
    return stack.figure


def _walls(on: np.ndarray, many: int) -> np.ndarray:
    """Return the contact on which each edge lies, `STOPS` for any stop, -1 for none."""
    wall = np.full(len(on), -1)
    for k in reversed(range(many)):
        wall[(on >> k) & 1 == 1] = min(k, STOPS)
    return wall


def _chained(pieces: np.ndarray) -> list[np.ndarray]:
    """Join straight pieces [k, 2, 2] end to end, so that dashes run on; without what the chart draws as a point."""
    import shapely

    long = pieces[np.abs(np.diff(pieces, axis=1)).max(axis=(1, 2)) > 0]
    merged = shapely.line_merge(shapely.MultiLineString(list(long)))
    found = [shapely.get_coordinates(line) for line in getattr(merged, "geoms", [merged])]
    return [line for line in found if len(line)]


def _title(space: Space) -> list[str]:
    name = label_text((space.scene.label or f"degree {space.scene.degree}").split(", r_k")[0])

    def many(count: int, what: str) -> str:
        return f"{count} {what}{'' if count == 1 else 's'}"

    counts = {"component": len(space.components), "hole": space.holes}
    counts["pinch point"] = sum(p.kind == "pinch point" for p in space.pinch_points)
    counts["handle"] = len(space.handles)
    facts = [many(count, what) for what, count in counts.items()]
    title = [f"{name}: {', '.join(facts)}, χ = {space.euler_characteristic}"]
    if space.picture_holes != space.holes:
        title.append(f"the picture in the chart encloses {many(space.picture_holes, 'hole')}")
    return title
