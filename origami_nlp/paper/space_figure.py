"""The figure of an admissible space in the paper's chart, by the painter of its landscape."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D

from origami_nlp.chart import area_axes, surface_pieces, trace_boundary
from origami_nlp.display import HANDLE, INK, MARGIN, RING, StackedFigure, label_text, patch
from origami_nlp.paper.space import Space

LOBES = ("#9ecae1", "#fdd0a2", "#c7e9c0", "#dadaeb", "#d9d9d9")
"""Fill of the pieces of surface (light versions of a colour-blind-safe set)."""
LOOKS: dict[str, dict[str, Any]] = {
    "several states there": RING | {"markersize": 11, "zorder": 7},
    "pinch point": {"marker": "p", "markersize": 11, "mfc": "white", "mec": INK, "zorder": 8},
    "end of a 1-handle": {"marker": "o", "mfc": HANDLE["color"], "mec": INK, "zorder": 8},
}
SIDE, LEFT = 4.6, 0.9
"""Height of the picture, and what is left of it [in]."""


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
    mesh = space.mesh
    piece = surface_pieces(mesh.triangles)
    colour = [LOBES[min(k, len(LOBES) - 1)] for k in piece]
    marks = [("several states there", point) for point, _ in space.picture_joins]
    for pinch in space.pinch_points:
        name = "pinch point" if pinch.kind == "pinch point" else "end of a 1-handle"
        marks.append((name, mesh.points[pinch.vertex]))
    entries: list[Any] = [patch(c, f"surface {k}") for k, c in enumerate(LOBES, 1) if c in colour]
    entries.append(Line2D([], [], color=INK, label="contact"))
    entries += [Line2D([], [], **HANDLE, label="1-handle")] * bool(space.handles)
    for name, look in LOOKS.items():
        if name in dict(marks):
            entries.append(Line2D([], [], linestyle="", **look, label=name))
    stack = StackedFigure(2 * MARGIN + LEFT + SIDE, SIDE + 0.45, _title(space), entries)
    axes = stack.axes(MARGIN + LEFT, 0.0, SIDE, SIDE)
    fill: dict[str, Any] = {"facecolors": colour, "edgecolors": colour, "linewidth": 0.3}
    axes.add_collection(PolyCollection(list(mesh.points[mesh.triangles]), **fill, rasterized=True))
    for line in trace_boundary(space.scene).lines:
        look = HANDLE if line.thin else {"color": INK, "linewidth": 1.2}
        axes.plot(*line.points.T, **look | {"zorder": 5}, clip_on=False)
    for name, at in marks:
        axes.plot(*np.array(at), linestyle="", **LOOKS[name], clip_on=False)
    area_axes(axes, mesh.chart)
    return stack.figure


def _title(space: Space) -> list[str]:
    name = label_text((space.scene.label or f"degree {space.scene.degree}").split(", r_k")[0])
    pinch = sum(p.kind == "pinch point" for p in space.pinch_points)
    counts = f"components {len(space.components)}, holes {space.holes}, pinch points {pinch}"
    title = [f"{name}: {counts}, handles {len(space.handles)}, χ = {space.euler_characteristic}"]
    if space.picture_holes != space.holes:
        title.append(f"holes that the picture encloses: {space.picture_holes}")
    return title
