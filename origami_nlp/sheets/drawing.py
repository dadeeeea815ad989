"""A folded sheet drawn: facets painted by depth, the visible parts of creases and borders as lines over them.

Mountains are red and solid, valleys blue and dashed, by the sign of the fold angle, wider the larger it is; the upper
side of the paper is warm, the lower cool: all of it can be told in grey.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patheffects import withStroke

from origami_nlp.errors import OptionError
from origami_nlp.facets import Crossings, Sheet, order_layers
from origami_nlp.kkt import ContactForce
from origami_nlp.minima import barrier_words
from origami_nlp.numerics import CLOSES
from origami_nlp.pattern import Pattern
from origami_nlp.sheets.counts import MOVES, Overview
from origami_nlp.sheets.marks import mark_touches, touch_legend, touch_places, touching_facets
from origami_nlp.sheets.motion import Motion
from origami_nlp.show import (
    BORDER,
    FLAT,
    LIGHT,
    LOWER,
    MOUNTAIN,
    PUSHES,
    UPPER,
    VALLEY,
    crease_legend,
    label_text,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from origami_nlp.sheets.result import SheetResult

MOST_DRAWN = 12
"""States of one picture."""
PIXELS = 1_000
"""Of the longer side of the painted picture."""
AZIMUTH, ELEVATION = math.radians(-58.0), math.radians(32.0)
"""From where a sheet is seen, about its mean normal, which points up."""
CANCELS = 1e-9
"""Share of all areas below which the areas of facets, as vectors, cancel: their mean normal is rounding."""
PIECE = 0.004
"""Lines are cut into pieces of this share of the picture, each seen or hidden."""
DASH, PERIOD = 0.014, 0.022
"""Of valleys, as shares of the picture."""
LAYER = 1e-5
"""Of layers that lie on each other within this share of the picture, the first is shown."""
TINT = 0.3
"""Share of the colour of contacts in that of facets that touch."""
MOST_ORDERED = 400
"""Polygons up to which layers are ordered for a picture."""
CELL = 4 / 3
"""Width over height of the pictures of states side by side: all alike, so that their titles are in line."""
BEFORE = 4e-3
"""A line hides only behind what is nearer by more than this share of the picture."""


def draw_sheet(
    axes: Axes,
    pattern: Pattern,
    fold_angles: np.ndarray,
    named: Sequence[int] = (),
    contacts: Sequence[ContactForce] = (),
) -> None:
    """Draw a folded sheet into axes, made bare here.

    Parameters
    ----------
    axes
        Of matplotlib.
    pattern
        The sheet.
    fold_angles
        Of a closed state, [n] [rad].
    named
        Facets whose numbers are written, from 0.
    contacts
        Of the state: places where facets touch are marked with their numbers, and these facets are tinted.
    """
    touching = touching_facets(contacts)
    phi = np.asarray(fold_angles, float)
    crossings = Crossings(pattern)
    pieces = crossings.placed(phi)
    corners = crossings.poses.polygons(phi)
    view = sheet_view(corners)
    seen = pieces @ view.T
    flat = seen.reshape(-1, 3)
    low, high = flat[:, :2].min(axis=0), flat[:, :2].max(axis=0)
    size = 1.06 * float((high - low).max())
    low = 0.5 * (low + high) - 0.5 * size * (high - low + 0.06 * size) / size
    shape = np.maximum(1, np.ceil((high - low + 0.03 * size) / size * PIXELS)).astype(int)
    step = size / PIXELS
    tinted = np.isin(crossings.facet, touching)
    above = _layers(pattern, phi, [c @ view.T for c in corners])
    picture, nearest, first = _paint(seen, crossings.polygon, above, tinted, low, step, shape)
    right, top = low + step * shape
    axes.imshow(picture, extent=(low[0], right, low[1], top), origin="lower")
    lines, looks, owners = _lines(pattern, [c @ view.T for c in corners], phi)
    for line, (colour, width, dashed), own in zip(lines, looks, owners, strict=True):
        hidden = np.logical_and.reduce(above[:, own], axis=1)[first]
        parts = _visible(line, np.where(hidden, np.inf, nearest), low, step, size, dashed)
        look = {"colors": colour, "linewidths": width, "capstyle": "butt", "zorder": 3}
        axes.add_collection(LineCollection(parts, **look), autolim=False)
    for f in named:
        own_parts = [c for c, g in zip(corners, pattern.facet_of, strict=True) if g == f]
        x, y, _ = view @ np.concatenate(own_parts).mean(axis=0)
        around = [withStroke(linewidth=2.5, foreground="white")]
        axes.text(x, y, str(f + 1), ha="center", va="center", path_effects=around, zorder=4)
    mark_touches(axes, view, touch_places(pattern, phi, contacts), contacts)
    axes.set(xlim=(low[0], right), ylim=(low[1], top), aspect="equal")
    axes.axis("off")


def sheet_view(polygons: list[np.ndarray]) -> np.ndarray:
    """Return rows right, up and towards the viewer for polygons [q, 3] in space, [3, 3]."""
    areas = np.array(
        [np.cross(x - x[0], np.roll(x, -1, axis=0) - x[0]).sum(axis=0) for x in polygons]
    )
    area = areas.sum(axis=0)
    seen = np.linalg.norm(area) > CANCELS * np.linalg.norm(areas, axis=1).sum()
    points = np.concatenate(polygons)
    points = points - points.mean(axis=0)
    _, _, axes = np.linalg.svd(points, full_matrices=False)
    up = area / np.linalg.norm(area) if seen else axes[2]
    ahead = next(a for x in axes if np.linalg.norm(a := x - (x @ up) * up) > 0.3)
    ahead = ahead / np.linalg.norm(ahead)
    if ahead[int(np.abs(ahead).argmax())] < 0:
        ahead = -ahead
    frame = np.stack([ahead, np.cross(up, ahead), up])
    ca, sa, ce, se = math.cos(AZIMUTH), math.sin(AZIMUTH), math.cos(ELEVATION), math.sin(ELEVATION)
    turned = np.array([[-sa, ca, 0.0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])
    view: np.ndarray = turned @ frame
    return view


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
    near = LAYER * step * PIXELS
    for x, own, tint in zip(pieces, polygon, tinted, strict=True):
        normal = np.cross(x - x[0], np.roll(x, -1, axis=0) - x[0]).sum(axis=0)
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
    """Tell which polygons [q, 3] lie on which, as seen, [P + 1, P]; the last row is no polygon."""
    above = np.zeros((len(corners) + 1, len(corners)), bool)
    if not (math.pi - np.abs(phi) <= CLOSES).any() or len(corners) > MOST_ORDERED:
        return above
    towards = [np.cross(x - x[0], np.roll(x, -1, axis=0) - x[0]).sum(axis=0)[2] for x in corners]
    for f, g, s in order_layers(Sheet(pattern), phi).orders:
        above[(f, g) if s * towards[g] > 0 else (g, f)] = True
    return above


def _lines(
    pattern: Pattern, corners: list[np.ndarray], phi: np.ndarray
) -> tuple[list[np.ndarray], list[tuple[Any, float, bool]], list[list[int]]]:
    """Return borders and creases [2, 3], each with its colour, its width, whether it is dashed, and its polygons."""
    crease = {tuple(e): k for k, e in enumerate(pattern.ends.tolist())}
    number = dict.fromkeys(range(len(pattern.polygons)), 0)
    count: dict[tuple[int, int], int] = {}
    for p in pattern.polygons:
        for i, v in enumerate(p):
            s = (min(p[i - 1], v), max(p[i - 1], v))
            count[s] = count.get(s, 0) + 1
    lines, looks, done = [], [], set()
    scale = min(1.0, 12 / math.sqrt(max(len(number), 1)))
    owners: dict[tuple[int, int], list[int]] = {}
    for k, p in enumerate(pattern.polygons):
        for i, v in enumerate(p):
            owners.setdefault((min(p[i - 1], v), max(p[i - 1], v)), []).append(k)
    shown = []
    for p, x in zip(pattern.polygons, corners, strict=True):
        for i, v in enumerate(p):
            s = (min(p[i - 1], v), max(p[i - 1], v))
            if s in done or (s not in crease and count[s] > 1):
                continue
            done.add(s)
            lines.append(np.array([x[i - 1], x[i]]))
            shown.append(owners[s])
            if s not in crease:
                looks.append((BORDER, 1.3 * scale, False))
                continue
            angle = float(phi[crease[s]])
            if abs(angle) <= MOVES:
                looks.append((FLAT, 0.8 * scale, False))
                continue
            width = (1.2 + 1.4 * abs(angle) / math.pi) * scale
            looks.append((MOUNTAIN if angle < 0 else VALLEY, width, angle > 0))
    return lines, looks, shown


def _visible(
    line: np.ndarray, nearest: np.ndarray, low: np.ndarray, step: float, size: float, dashed: bool
) -> list[np.ndarray]:
    """Return the parts of a line that nothing hides, [2, 2] each; dashes begin and end with half a dash."""
    length = float(np.linalg.norm(line[1, :2] - line[0, :2]))
    if length == 0.0:
        return []
    count = max(2, round(length / (PIECE * size)))
    if dashed:  # a whole number of periods, at least two, begun in the middle of a dash
        periods = max(2, round(length / (PERIOD * size)))
        share = DASH / PERIOD
        starts = (np.arange(periods + 1) - 0.5 * share) / periods
        spans = np.clip(np.column_stack([starts, starts + share / periods]), 0.0, 1.0)
    else:
        grid = np.linspace(0.0, 1.0, count + 1)
        spans = np.column_stack([grid[:-1], grid[1:]])
    middle = line[0] + spans.mean(axis=1)[:, None] * (line[1] - line[0])
    at = ((middle[:, :2] - low) / step).astype(int)
    rows = np.clip(at[:, 1], 0, nearest.shape[0] - 1)
    columns = np.clip(at[:, 0], 0, nearest.shape[1] - 1)
    seen = middle[:, 2] + BEFORE * size >= nearest[rows, columns]
    parts: list[np.ndarray] = []
    start = None
    for k, (a, b) in enumerate(spans):
        if seen[k] and start is None:
            start = a
        last = k + 1 == len(spans) or dashed or not seen[k + 1]
        if start is not None and last:
            ends = np.array([start, b])[:, None]
            parts.append((line[0] + ends * (line[1] - line[0]))[:, :2])
            start = None
    return parts


def draw_overview(seen: Overview, path: Any = None) -> Figure:
    """Draw a pattern: its crease pattern, where it is flat, and beside it the sheet folded.

    Parameters
    ----------
    seen
        Of `overview`.
    path
        Where to save it, if anywhere.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.
    """
    p = seen.pattern
    parts: list[tuple[str, np.ndarray | None]] = [("crease pattern", None)] if p.is_flat else []
    if seen.folded is not None:
        parts.append((f"folded: {seen.start}", seen.folded))
    elif not parts:
        parts.append(("as in the file", p.reference))
    figure = Figure(figsize=(5.2 * len(parts), 5.2), layout="constrained")
    for k, (title, phi) in enumerate(parts):
        axes = figure.add_subplot(1, len(parts), k + 1)
        if phi is None:
            _draw_flat(axes, p)
        else:
            draw_sheet(axes, p, phi)
        axes.set_title(label_text(title), fontsize=10)
    free = "not known" if seen.freedoms is None else str(seen.freedoms)
    title = f"{p.name}: {p.facets} facets, {p.creases} creases, freedoms: {free}"
    figure.suptitle(label_text(title), fontsize=11)
    figure.legend(handles=crease_legend(), loc="outside lower center", ncols=4, frameon=False)
    if path is not None:
        from origami_nlp.files import save_figure

        save_figure(figure, path, 200)
    return figure


def _draw_flat(axes: Axes, p: Pattern) -> None:
    """Draw the flat reference state: letters as in legends, others grey."""
    scale = min(1.0, 12 / math.sqrt(max(len(p.polygons), 1)))
    crease = {tuple(e) for e in p.ends.tolist()}
    count: dict[tuple[int, int], int] = {}
    for q in p.polygons:
        for i, v in enumerate(q):
            s = (min(q[i - 1], v), max(q[i - 1], v))
            count[s] = count.get(s, 0) + 1
    xy = p.corners[:, :2]
    border = [xy[list(s)] for s, n in count.items() if n == 1 and s not in crease]
    axes.add_collection(LineCollection(border, colors=BORDER, linewidths=1.5 * scale))
    for letter, colour, dashes in (
        ("M", MOUNTAIN, "solid"),
        ("V", VALLEY, (0, (3.5, 2.0))),
        ("UF", FLAT, "solid"),
    ):
        lines = [xy[e] for e, a in zip(p.ends, p.assignment, strict=True) if a in letter]
        look: dict[str, Any] = {"colors": colour, "linestyles": [dashes], "linewidths": 1.7 * scale}
        axes.add_collection(LineCollection(lines, **look))
    axes.set_aspect("equal")
    axes.margins(0.05)
    axes.autoscale_view()
    axes.axis("off")


def draw_states(
    pattern: Pattern,
    states: Sequence[tuple[str, np.ndarray]],
    title: str,
    path: Any = None,
    named: Sequence[int] = (),
    contacts: Sequence[Sequence[ContactForce]] = (),
) -> Figure:
    """Draw states of a sheet side by side.

    Parameters
    ----------
    pattern
        The sheet.
    states
        Title and fold angles [n] [rad] of each; the first `MOST_DRAWN` are drawn.
    title
        Above all.
    path
        Where to save the picture, if anywhere.
    named
        Facets whose numbers are written into the last picture, from 0.
    contacts
        Of each state, if touches are to be marked.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.
    """
    shown = states[:MOST_DRAWN]
    columns = min(3, max(1, len(shown)))
    size = (4.4 * columns, 3.5 * (rows := max(1, -(-len(shown) // columns))) + 0.9)
    figure = Figure(figsize=size, layout=ConstrainedLayoutEngine(h_pad=0.1))
    for k, (name, phi) in enumerate(shown):
        axes = figure.add_subplot(rows, columns, k + 1)
        touches = contacts[k] if k < len(contacts) else ()
        draw_sheet(axes, pattern, phi, named if k + 1 == len(states) else (), touches)
        _widen(axes, CELL)
        axes.set_title(label_text(name), fontsize=9)
    more = f" (the first {len(shown)} of {len(states)})" if len(states) > len(shown) else ""
    figure.suptitle(label_text(title + more), fontsize=11)
    handles = crease_legend() + touch_legend(c for held in contacts[: len(shown)] for c in held)
    many = 4 if columns > 1 else 2
    figure.legend(handles=handles, loc="outside lower center", ncols=many, frameon=False)
    if path is not None:
        from origami_nlp.files import save_figure

        save_figure(figure, path, 200)
    return figure


def _widen(axes: Axes, shape: float) -> None:
    """Widen the limits of axes until width over height is as given."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    across = max(0.0, shape * (high - low) - (right - left)) / 2
    up = max(0.0, (right - left) / shape - (high - low)) / 2
    axes.set(xlim=(left - across, right + across), ylim=(low - up, high + up))


def draw_found(found: SheetResult, path: Any = None) -> Figure:
    """Draw the stable states that a search has found, with what touches in them.

    Parameters
    ----------
    found
        Of `find_minima`.
    path
        Where to save the picture, if anywhere.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Raises
    ------
    OptionError
        If there is no stable state.
    """
    if not found.minima:
        raise OptionError("no stable state was found: there is nothing to draw")
    words = [f"{s.title(k)}\n{barrier_words(s.escape, 'J')}" for k, s in enumerate(found.minima, 1)]
    states = [(w.rstrip(), s.phi) for w, s in zip(words, found.minima, strict=True)]
    contacts = [s.contacts for s in found.minima]
    return draw_states(found.pattern, states, found.pattern.name, path, contacts=contacts)


def draw_motion(motion: Motion, path: Any = None) -> Figure:
    """Draw six states along a folding motion.

    Parameters
    ----------
    motion
        Of `find_motion`.
    path
        Where to save the picture, if anywhere.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.
    """
    states = []
    # where nothing moves beginning and end are one state
    for k in motion.shown(6) if motion.arc[-1] > 0 else [0]:
        phi = motion.fold_angles[k]
        largest = math.degrees(float(np.abs(phi).max()))
        states.append((f"{motion.arc[k]:.2f} rad along, largest fold {largest:.0f} deg", phi))
    title = f"{motion.pattern.name}: {fill(motion.end, 90)}"
    return draw_states(motion.pattern, states, title, path, motion.touching or ())
