"""The figure of an admissible space: in the paper's chart, and as a surface in the space of wedge fold angles."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from origami_nlp.chart import crease_number
from origami_nlp.display import HANDLE, INKS, RING, angle_ticks, label_text, subscript
from origami_nlp.space.result import Space, SpaceMesh
from origami_nlp.space.topology import edges_of, surface_pieces

LOBES = ("#9ecae1", "#fdd0a2", "#c7e9c0", "#dadaeb", "#d9d9d9")
"""Fill of the pieces of surface (light versions of a colour-blind-safe set)."""
WALLS = (*INKS[:4], INKS[6], INKS[7])
"""Lines of the contacts that bound X: those of `HalfChain.walls` by themselves, then all stops."""
STOPS = 5
DASHES: tuple[Any, ...] = ("-", (0, (6, 1.5)), (0, (2, 1)), (0, (6, 1.5, 1.5, 1.5)), "-", "-")
"""Of these lines, so that they differ in grey too."""


def draw_space(space: Space) -> Figure:
    """Draw X: left in the coordinates of the paper's chart, right over three of the wedge's fold angles.

    Pieces of surface are filled, contact boundaries and handles are lines, pinch points pentagons; rings are points of
    the chart over which X has several states.

    Parameters
    ----------
    space
        Of `find_space`.

    Returns
    -------
    matplotlib.figure.Figure
        Two views.
    """
    figure = Figure(figsize=(9.4, 5.0), dpi=140, facecolor="white")
    mesh = space.mesh
    colour = _lobe_colours(mesh)
    flat = figure.add_axes((0.085, 0.215, 0.38, 0.645))
    solid = figure.add_axes((0.47, 0.13, 0.52, 0.8), projection="3d")
    used = _draw_chart(flat, space, colour)
    used |= _draw_solid(solid, space, colour)
    title = _title(space)
    figure.suptitle(title, fontsize=11, y=0.995 if "\n" in title else 0.965)
    _legend(figure, space, colour, used)
    return figure


def _lobe_colours(mesh: SpaceMesh) -> list[str]:
    """Fill of each triangle, by the piece of surface it belongs to (largest first)."""
    if not len(mesh.triangles):
        return []
    piece = surface_pieces(mesh.triangles)
    rank = np.argsort(np.argsort(-np.bincount(piece), kind="stable"), kind="stable")
    return [LOBES[min(rank[k], len(LOBES) - 1)] for k in piece]


def _border(mesh: SpaceMesh) -> tuple[np.ndarray, np.ndarray]:
    """Edges that border one triangle [B, 2], and the contact each lies on [B], `STOPS` for any stop."""
    edges, of_triangle = edges_of(mesh.triangles)
    uses = np.bincount(of_triangle.ravel(), minlength=len(edges))
    edges = edges[uses == 1]
    common = mesh.on[edges[:, 0]] & mesh.on[edges[:, 1]]
    wall = np.full(len(edges), -1)
    for k in reversed(range(len(mesh.walls))):
        wall[(common >> k) & 1 == 1] = min(k, STOPS)
    return edges, wall


def _chained(pieces: np.ndarray) -> list[np.ndarray]:
    """Join straight pieces [k, 2, d] end to end, so that dashes run on."""
    import shapely

    long = pieces[np.abs(np.diff(pieces, axis=1)).max(axis=(1, 2)) > 0] if len(pieces) else pieces
    merged = shapely.line_merge(shapely.MultiLineString(list(long)))
    lines = getattr(merged, "geoms", [merged])
    return [shapely.get_coordinates(line, include_z=pieces.shape[2] == 3) for line in lines]


def _draw_chart(axis: Axes, space: Space, colour: list[str]) -> set[int]:
    mesh = space.mesh
    xy = mesh.chart
    axis.add_collection(
        PolyCollection(
            xy[mesh.triangles], facecolors=colour, edgecolors=colour, lw=0.3, rasterized=True
        )
    )
    edges, wall = _border(mesh)
    for k in range(len(WALLS)):
        lines = _chained(xy[edges[wall == k]])
        # families over one point, and border pieces that the chart draws as a point, have no length
        axis.add_collection(
            LineCollection(lines, colors=WALLS[k], lw=1.8, ls=DASHES[k], zorder=4, clip_on=False)
        )
    for handle in space.handles:
        axis.plot(*xy[handle.path].T, **HANDLE | {"zorder": 5}, clip_on=False)
    for (x, y), _ in space.picture_joins:
        axis.plot(x, y, **RING, ms=11, ls="", zorder=7, clip_on=False)
    for pinch in space.pinch_points:
        x, y = xy[pinch.vertex]
        _pinch_mark(axis, pinch.kind, x, y)
    group = space.scene.group
    name = f"φ{subscript(crease_number(space.scene, 1))}"
    other = (
        f"φ{subscript(crease_number(space.scene, 2))}"
        if (group.kind, group.order, len(group.rays)) == ("D", 1, 4)
        else f"elevation υ of crease {crease_number(space.scene, 0)}"
    )
    axis.set_xlabel(f"fold angle {name}")
    axis.set_ylabel(f"fold angle {other}" if "φ" in other else other)
    axis.set_xlim(-math.pi, math.pi)
    high = math.pi if "φ" in other else math.pi / 2
    axis.set_ylim(-high, high)
    angle_ticks(axis.xaxis, -math.pi, math.pi)
    angle_ticks(axis.yaxis, -high, high)
    if high == math.pi:
        axis.set_aspect("equal")
    axis.set_title("in the paper's chart", fontsize=10)
    return set(wall.tolist())


def _pinch_mark(axis, kind: str, *at: float) -> None:  # type: ignore[no-untyped-def]
    style = (
        {"marker": "p", "ms": 11, "mfc": "white"}
        if kind == "pinch point"
        else {"marker": "o", "ms": 6, "mfc": HANDLE["color"]}
    )
    axis.plot(*([v] for v in at), ls="", mec="black", mew=0.8, zorder=8, clip_on=False, **style)


def _draw_solid(axis, space: Space, colour: list[str]) -> set[int]:  # type: ignore[no-untyped-def]
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    mesh = space.mesh
    columns = (1, 2, 0) if mesh.wedge.shape[1] == 4 else (0, 1, 2)
    xyz = mesh.wedge[:, columns]
    if colour:
        shade = Poly3DCollection(
            xyz[mesh.triangles], facecolors=colour, edgecolors="none", alpha=0.75, rasterized=True
        )
        axis.add_collection3d(shade)
    edges, wall = _border(mesh)
    for k in range(len(WALLS)):
        lines = _chained(xyz[edges[wall == k]])
        if lines:
            look = {"colors": WALLS[k], "lw": 1.2, "ls": DASHES[k]}
            axis.add_collection3d(Line3DCollection(lines, **look))
    for handle in space.handles:
        axis.plot(*xyz[handle.path].T, **HANDLE | {"zorder": 9})
    for pinch in space.pinch_points:
        _pinch_mark(axis, pinch.kind, *xyz[pinch.vertex])
    names = [f"φ{subscript(crease_number(space.scene, r))}" for r in columns]
    for which, name in zip("xyz", names, strict=True):
        getattr(axis, f"set_{which}label")(name, labelpad=2)
        getattr(axis, f"set_{which}lim")(-math.pi, math.pi)
        ends = (
            (0.0, math.pi) if which == "y" else (-math.pi, 0.0, math.pi)
        )  # x and y share a corner
        getattr(axis, f"set_{which}ticks")(
            ends, [f"{math.degrees(a):.0f}°".replace("-", "−") for a in ends]
        )
    axis.view_init(elev=22, azim=-62)
    axis.tick_params(pad=0, labelsize=8)
    extra = "" if mesh.wedge.shape[1] == 3 else f" (of {mesh.wedge.shape[1]})"
    axis.set_title(f"over fold angles {', '.join(names)}{extra}", fontsize=10, y=0.985)
    return set(wall.tolist())


def _title(space: Space) -> str:
    name = space.scene.label or f"degree {space.scene.degree}"
    name = label_text(name.split(", r_k")[0])

    def many(count: int, what: str) -> str:
        return f"{count} {what}{'' if count == 1 else 's'}"

    pinch = sum(p.kind == "pinch point" for p in space.pinch_points)
    facts = [
        many(len(space.components), "component"),
        many(space.holes, "hole"),
        many(pinch, "pinch point"),
        many(len(space.handles), "handle"),
        f"χ = {space.euler_characteristic}",
    ]
    text = f"{name}: {', '.join(facts)}"
    if space.picture_holes != space.holes:
        text += f"\nthe picture in the chart encloses {many(space.picture_holes, 'hole')}"
    return text


def _legend(figure: Figure, space: Space, colour: list[str], used: set[int]) -> None:
    entries: list[Line2D | Patch] = [
        Patch(fc=c, label=f"surface {k}") for k, c in enumerate(LOBES, start=1) if c in colour
    ]
    for k, name in enumerate((*space.mesh.walls[:STOPS], "at a stop")):
        if k in used:
            text = re.sub(r"phi_(\d+)", lambda m: "φ" + subscript(int(m[1])), name)
            entries.append(
                Line2D(
                    [], [], color=WALLS[k], lw=2, ls=DASHES[k], label=text.replace("+-pi", "±180°")
                )
            )
    kinds = {p.kind for p in space.pinch_points}
    if "pinch point" in kinds:
        entries.append(
            Line2D([], [], ls="", marker="p", ms=10, mfc="white", mec="k", label="pinch point")
        )
    if space.handles:
        entries.append(Line2D([], [], **HANDLE, label="1-handle"))
        entries.append(
            Line2D(
                [],
                [],
                ls="",
                marker="o",
                ms=6,
                mfc=HANDLE["color"],
                mec="k",
                label="end of a 1-handle",
            )
        )
    if space.picture_joins:
        entries.append(Line2D([], [], **RING, ls="", ms=10, label="several states there"))
    figure.legend(
        handles=entries, loc="lower center", ncols=min(5, len(entries)), fontsize=9, frameon=False
    )
