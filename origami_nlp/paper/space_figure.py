"""The figure of an admissible space in the paper's chart, by the painter of its landscape."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.chart import area_axes, surface_pieces, trace_boundary
from origami_nlp.display import HANDLE, INK, RING, label_text, patch
from origami_nlp.paper.space import Space

LOBES = ("#9ecae1", "#fdd0a2", "#c7e9c0", "#dadaeb", "#d9d9d9")
"""Fill of the pieces of surface (light versions of a colour-blind-safe set)."""
LOOKS: dict[str, dict[str, Any]] = {
    "several states there": RING | {"markersize": 11, "zorder": 7},
    "pinch point": {"marker": "p", "markersize": 11, "mfc": "white", "mec": INK, "zorder": 8},
    "end of a 1-handle": {"marker": "o", "mfc": HANDLE["color"], "mec": INK, "zorder": 8},
}


def draw_space(space: Space) -> Figure:
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
    figure = Figure(figsize=(5.6, 6.2), dpi=110, layout="constrained")
    axes, entries = figure.subplots(), dict[str, Any]()
    colour = [LOBES[min(k, len(LOBES) - 1)] for k in surface_pieces(mesh.triangles)]
    fill: dict[str, Any] = {"facecolors": colour, "edgecolors": colour, "linewidth": 0.3}
    axes.add_collection(PolyCollection(list(mesh.points[mesh.triangles]), **fill, rasterized=True))
    for k, lobe in enumerate(LOBES, 1):
        if lobe in colour:
            entries[f"surface {k}"] = patch(lobe, f"surface {k}")
    for line in trace_boundary(space.scene).lines:
        look = HANDLE if line.thin else {"color": INK, "linewidth": 1.2}
        name = "1-handle" if line.thin else "contact"
        look = look | {"label": name, "zorder": 5, "clip_on": False}
        entries[name] = axes.plot(*line.points.T, **look)[0]
    marks = [("several states there", point) for point, _ in space.picture_joins]
    for pinch in space.pinch_points:
        name = "pinch point" if pinch.kind == "pinch point" else "end of a 1-handle"
        marks.append((name, tuple(mesh.points[pinch.vertex].tolist())))
    for name, at in marks:
        axes.plot(*np.array(at), linestyle="", **LOOKS[name], clip_on=False)
        entries[name] = Line2D([], [], linestyle="", **LOOKS[name], label=name)
    area_axes(axes, mesh.chart)
    axes.set_box_aspect(1)
    place: Any = {"loc": "outside lower center", "ncols": 3, "fontsize": 9, "frameon": False}
    figure.legend(handles=[*entries.values()], **place)
    name = (space.scene.label or f"degree {space.scene.degree}").split(", r_k")[0]
    counts = (
        f"components {len(space.components)}, holes {space.holes}, χ = {space.euler_characteristic}"
    )
    more = f"holes that the picture encloses: {space.picture_holes}"
    figure.suptitle(label_text(f"{name}\n{counts}\n{more}"), fontsize=11, weight="bold")
    return figure
