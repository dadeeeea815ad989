"""A folded vertex or sheet drawn: facets painted by depth, the visible parts of creases and borders as lines over them.

A vertex is a sheet of facets that are sectors of a disc.  Mountains are red and solid, valleys blue and dashed, by the
sign of the fold angle, wider the larger it is; the upper side of the paper is warm, the lower cool: all of it can be
read in grey.  All states are seen from one side: their mean normal points up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from origami_nlp.display.papers import apex_of, area_of, paper_of, pattern_view
from origami_nlp.display.style import (
    BORDER,
    FLAT,
    LIGHT,
    LOWER,
    MOUNTAIN,
    PUSHES,
    UPPER,
    VALLEY,
    patch,
)
from origami_nlp.display.touches import TINT, contact_places, mark_touches, touching_facets
from origami_nlp.kkt import ContactForce
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import Pattern, Scene, Vertex
from origami_nlp.pattern_problem import (
    MOVES,
    PatternCrossings,
    PatternProblem,
    order_layers,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PIXELS = 1_000
"""Of the longer side of the painted picture."""
DASHES = (0, (2.2, 1.3))
"""Of valleys."""
BEYOND, APART = 0.13, 0.17
"""Of the number of a crease, its distance from the end, and from other numbers [of the longest crease]."""


def draw_state(
    axes: Axes,
    origami: Scene | Vertex | Pattern,
    fold_angles: object,
    named: Sequence[int] = (),
    contacts: Sequence[ContactForce] = (),
    *,
    size: float = 9.0,
) -> None:
    """Draw a folded state into axes, made bare here; creases round a single vertex have their numbers.

    Parameters
    ----------
    axes
        Of matplotlib.
    origami
        What is folded; of a cell that repeats two by two copies are drawn.
    fold_angles
        Of a closed state, [n] [rad].
    named
        Facets whose numbers are written, from 0.
    contacts
        Of the state of a pattern: places where facets touch are marked with their numbers, and these facets are tinted.
    size
        Font size of the numbers of creases [points].

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from origami_nlp import Vertex
    >>> from origami_nlp.display import draw_state
    >>> axes = Figure().add_subplot()
    >>> draw_state(axes, Vertex(("pi/2",) * 4), [1, 0, 1, 0])
    >>> [text.get_text() for text in axes.texts]
    ['1', '2', '3', '4']
    """
    pattern, phi = paper_of(origami), np.asarray(fold_angles, float)
    if pattern.cell:  # contacts are those of the cell with copies that need not be drawn
        pattern, crease_of = pattern.cell.tiles
        phi, contacts = phi[crease_of], ()
    crossings = PatternCrossings(pattern)
    corners = crossings.poses.polygons(phi)
    view = pattern_view(corners)
    pieces, corners = crossings.placed(phi) @ view.T, [c @ view.T for c in corners]
    marks = _number_places(pattern, crossings.poses.corners(phi) @ view.T)
    flat = np.vstack(
        [pieces.reshape(-1, 3)[:, :2], *(m + BEYOND * h for m in marks for h in (1, -1))]
    )
    low, high = flat.min(axis=0), flat.max(axis=0)
    wide = 1.06 * float((high - low).max())
    low = 0.5 * (low + high) - 0.5 * wide * (high - low + 0.06 * wide) / wide
    shape = np.maximum(1, np.ceil((high - low + 0.03 * wide) / wide * PIXELS)).astype(int)
    step = wide / PIXELS
    tinted = np.isin(crossings.facet, touching_facets(contacts))
    above = _layers(pattern, phi, corners)
    picture, nearest, first = _paint(pieces, crossings.polygon, above, tinted, low, step, shape)
    right, top = low + step * shape
    axes.imshow(picture, extent=(low[0], right, low[1], top), origin="lower")
    for line, (colour, width, dashed), own in zip(*_lines(pattern, corners, phi), strict=True):
        hidden = np.logical_and.reduce(above[:, own], axis=1)[first]
        parts = _visible(line, np.where(hidden, np.inf, nearest), low, step, wide)
        look = {"colors": colour, "linewidths": width, "capstyle": "butt", "zorder": 3}
        look["linestyles"] = [DASHES if dashed else "solid"]
        axes.add_collection(LineCollection(parts, **look), autolim=False)
    around: dict[str, Any] = {"path_effects": [withStroke(linewidth=2.5, foreground="white")]}
    around |= {"ha": "center", "va": "center", "zorder": 4}
    for f in named:
        own_parts = [c for c, g in zip(corners, pattern.facet_of, strict=True) if g == f]
        x, y, _ = np.concatenate(own_parts).mean(axis=0)
        axes.text(x, y, str(f + 1), **around)
    for k, (x, y) in enumerate(marks):
        axes.text(x, y, str(k + 1), fontsize=size, color=_look(float(phi[k]))[0], **around)
    if len(contacts):
        mark_touches(axes, view, contact_places(pattern, phi, contacts), contacts)
    axes.set(xlim=(low[0], right), ylim=(low[1], top), aspect="equal", xticks=[], yticks=[])
    axes.axis("off")


def _number_places(pattern: Pattern, corners: np.ndarray) -> np.ndarray:
    """Return where the numbers of creases go [n, 2], just beyond their ends and apart; none but round one vertex."""
    if (apex := apex_of(pattern)) is None:
        return np.zeros((0, 2))
    ends = np.where(pattern.ends[:, 0] == apex, pattern.ends[:, 1], pattern.ends[:, 0])
    out = (corners[ends] - corners[apex])[:, :2]
    unit = float(pattern.lengths.max())
    length = np.linalg.norm(out, axis=1, keepdims=True)
    out = np.where(length > 0.05 * unit, out / np.maximum(length, 1e-9), [[0.0, -1.0]])
    places: np.ndarray = corners[ends, :2] + BEYOND * unit * out
    i, j = np.triu_indices(len(places), 1)
    for _ in range(60):
        gap = places[i] - places[j]
        far = np.hypot(*gap.T)[:, None]
        way = np.where(far > 1e-9, gap / np.maximum(far, 1e-9), [[1.0, 0.0]])
        push = 0.5 * np.maximum(APART * unit - far, 0.0) * way
        if not push.any():
            break
        np.add.at(places, i, push)
        np.add.at(places, j, -push)
    return places


def crease_legend() -> list[Any]:
    """Return legend entries for the creases and the sides of the paper.

    Returns
    -------
    list of matplotlib.artist.Artist
        Handles with labels.
    """
    return [
        Line2D([], [], color=MOUNTAIN, linewidth=2.2, label="mountain"),
        Line2D([], [], color=VALLEY, linewidth=2.2, linestyle=DASHES, label="valley"),
        patch(UPPER, "upper side"),
        patch(LOWER, "lower side"),
    ]


def _look(angle: float) -> tuple[str, float, bool]:
    """Return colour, width and whether it is dashed, of a crease."""
    if abs(angle) <= MOVES:
        return FLAT, 0.8, False
    return MOUNTAIN if angle < 0 else VALLEY, 1.2 + 1.4 * min(abs(angle) / math.pi, 1.0), angle > 0


def _paint(
    pieces: np.ndarray,
    polygon: np.ndarray,
    above: np.ndarray,
    tinted: np.ndarray,
    low: np.ndarray,
    step: float,
    shape: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Paint convex pieces [P, q, 3] of polygons [P], some tinted [P]: RGBA [y, x, 4], depth and polygon seen [y, x]."""
    picture = np.zeros((shape[1], shape[0], 4), np.float32)
    nearest = np.full((shape[1], shape[0]), -np.inf, np.float32)
    top = np.full((shape[1], shape[0]), -1)
    # of layers that lie on each other within this the first is shown
    near = 1e-5 * step * PIXELS
    for x, own, tint in zip(pieces, polygon, tinted, strict=True):
        normal = area_of(x)
        normal /= np.linalg.norm(normal)
        if abs(normal[2]) < 1e-3:
            continue
        first = np.clip(((x[:, :2].min(axis=0) - low) / step).astype(int), 0, shape)
        last = np.clip(((x[:, :2].max(axis=0) - low) / step).astype(int) + 2, 0, shape)
        px = low[0] + step * (np.arange(first[0], last[0]) + 0.5)[None, :]
        py = low[1] + step * (np.arange(first[1], last[1]) + 0.5)[:, None]
        inside = np.ones((py.size, px.size), bool)
        turn = math.copysign(1.0, normal[2])
        for a, b in zip(x, np.roll(x, -1, axis=0), strict=True):
            inside &= turn * ((b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0])) >= 0
        depth = x[0, 2] - (normal[0] * (px - x[0, 0]) + normal[1] * (py - x[0, 1])) / normal[2]
        part = slice(first[1], last[1]), slice(first[0], last[0])
        on = above[own, top[part]] & (depth > nearest[part] - near)
        front = inside & (on | (depth > nearest[part] + near))
        nearest[part][front], top[part][front] = depth[front], own
        towards = normal if normal[2] > 0 else -normal
        shade = 0.62 + 0.38 * max(0.0, float(towards @ LIGHT))
        paper = np.array(to_rgb(UPPER if normal[2] > 0 else LOWER))
        paper = (1 - TINT * tint) * paper + TINT * tint * np.array(to_rgb(PUSHES))
        colour = np.minimum(1.0, shade * paper)
        picture[part][front] = (*colour, 1.0)
    return picture, nearest, top


def _layers(pattern: Pattern, phi: np.ndarray, corners: list[np.ndarray]) -> np.ndarray:
    """Return which polygons [q, 3] lie on which, as seen, [P + 1, P]; the last row is no polygon."""
    above = np.zeros((len(corners) + 1, len(corners)), bool)
    # of more polygons layers are not ordered for a picture
    if not (math.pi - np.abs(phi) <= CLOSURE_TOL).any() or len(corners) > 400:
        return above
    towards = [area_of(x)[2] for x in corners]
    for f, g, s in order_layers(PatternProblem(pattern), phi).orders:
        above[(f, g) if s * towards[g] > 0 else (g, f)] = True
    return above


def _lines(
    pattern: Pattern, corners: list[np.ndarray], phi: np.ndarray
) -> tuple[list[np.ndarray], list[tuple[Any, float, bool]], list[list[int]]]:
    """Return borders and creases [2, 3], each with its colour, its width, whether it is dashed, and its polygons."""
    crease = {tuple(e): k for k, e in enumerate(pattern.ends.tolist())}
    owners: dict[tuple[int, int], list[int]] = {}
    ends: dict[tuple[int, int], np.ndarray] = {}
    for k, (p, x) in enumerate(zip(pattern.polygons, corners, strict=True)):
        for i, v in enumerate(p):
            side = (min(p[i - 1], v), max(p[i - 1], v))
            owners.setdefault(side, []).append(k)
            ends.setdefault(side, np.array([x[i - 1], x[i]]))
    lines, looks, shown = [], [], []
    scale = line_scale(pattern)
    for s, own in owners.items():
        if s not in crease and len(own) > 1:
            continue
        lines.append(ends[s])
        shown.append(own)
        colour, width, dashed = (
            _look(float(phi[crease[s]])) if s in crease else (BORDER, 1.3, False)
        )
        looks.append((colour, width * scale, dashed))
    return lines, looks, shown


def line_scale(pattern: Pattern) -> float:
    """Return by how much lines of a sheet of many facets are thinner."""
    return min(1.0, 12 / math.sqrt(max(len(pattern.polygons), 1)))


def _visible(
    line: np.ndarray, nearest: np.ndarray, low: np.ndarray, step: float, size: float
) -> list[np.ndarray]:
    """Return the parts of a line that nothing hides, [2, 2] each."""
    length = float(np.linalg.norm(line[1, :2] - line[0, :2]))
    if length == 0.0:
        return []
    # pieces of this share of the picture, each seen or hidden
    grid = np.linspace(0.0, 1.0, max(2, round(length / (0.004 * size))) + 1)
    spans = np.column_stack([grid[:-1], grid[1:]])
    middle = line[0] + spans.mean(axis=1)[:, None] * (line[1] - line[0])
    at = ((middle[:, :2] - low) / step).astype(int)
    rows = np.clip(at[:, 1], 0, nearest.shape[0] - 1)
    columns = np.clip(at[:, 0], 0, nearest.shape[1] - 1)
    # a line hides only behind what is nearer by more than this share of the picture
    seen = middle[:, 2] + 4e-3 * size >= nearest[rows, columns]
    # pieces in a row are one line
    ends = np.flatnonzero(np.diff([False, *seen, False])).reshape(-1, 2)
    shown = np.column_stack([spans[ends[:, 0], 0], spans[ends[:, 1] - 1, 1]])
    return [(line[0] + s[:, None] * (line[1] - line[0]))[:, :2] for s in shown]
