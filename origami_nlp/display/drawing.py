"""A folded vertex drawn in three dimensions: facets as shaded sectors, creases as coloured bands.

The state is projected orthographically and painted pixel by pixel with the depth of each facet, so
hidden parts are hidden.  Mountain creases are red and solid, valleys blue and dashed, both by the sign of the
fold angle, wider and darker the larger |phi|/pi; borders are black.  The upper side of the paper is warm, the
lower side cool.  Every facet is a sector of the unit disc.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from origami_nlp.display.pose import Pose, pose_state
from origami_nlp.display.style import patch
from origami_nlp.pattern import Vertex

MOUNTAIN, VALLEY, FLAT, BORDER = "#c1121f", "#1d4ed8", "#8a8a8a", "#000000"
UPPER, LOWER = "#f6ead2", "#c3d3dc"
PIXELS = 560
"""Side of the painted picture."""
RIM = 0.02
"""Around the points on the border of a facet: more than its arcs leave their chords."""
DASH, GAP = 0.085, 0.055
"""Of valley creases [of the unit radius]."""
COARSE = 120
"""Pixels along a side of a picture that is only asked for what it shows."""
PALE = 0.5
"""Strength of the number of a crease whose end is hidden."""
LIGHT = np.array([-0.35, 0.55, 0.76])
"""Towards the light, in the picture's frame."""

Colour = tuple[float, float, float]


def draw_state(
    axes: Any, vertex: Vertex, fold_angles: object, *, size: float = 9.0, crop: bool = False
) -> bool:
    """Draw one state into a matplotlib Axes (made bare here).

    Parameters
    ----------
    axes
        Of matplotlib.
    vertex
        The vertex.
    fold_angles
        Of the state, shape [N] [rad], valley positive; the state should close.
    size
        Font size of the crease numbers [points].
    crop
        Leave away what is empty below: the Axes then fit if their height is `drawn_height` times their width;
        otherwise they are square.

    Returns
    -------
    bool
        Whether facets that lie on each other were drawn slightly apart.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from origami_nlp import Vertex
    >>> from origami_nlp.display import draw_state
    >>> draw_state(Figure().add_subplot(), Vertex(("pi/2",) * 4), [1, 0, 1, 0])
    False
    """
    phi = np.asarray(fold_angles, dtype=float)
    pose, labels, corner, side, below = _placed(vertex, tuple(phi.tolist()))
    draw_pose(axes, pose, labels, phi, corner, side, size)
    if crop:
        axes.set_ylim(bottom=below)
    return bool(np.any(pose.offsets))


def draw_pose(
    axes: Any,
    pose: Pose,
    labels: np.ndarray,
    phi: np.ndarray,
    corner: np.ndarray,
    side: float,
    size: float,
) -> None:
    """Draw a turned state into a matplotlib Axes: the square of length `side` from its lower left `corner`.

    labels: places of the crease numbers [N, 2], of `label_places`.  phi: fold angles [N].
    size: font size of the crease numbers [points].
    """
    right, top = corner + side
    axes.imshow(
        _paint(pose, phi, corner, side), extent=(corner[0], right, corner[1], top), origin="lower"
    )
    hidden = _hidden_ends(pose)
    for number, (x, y) in enumerate(labels, start=1):
        colour = np.array(_crease_colour(phi[number - 1])[0])
        axes.text(
            x,
            y,
            str(number),
            ha="center",
            va="center",
            fontsize=size,
            # pale, not transparent: what lies below would show through
            color=1 - PALE * (1 - colour) if hidden[number - 1] else colour,
            path_effects=[withStroke(linewidth=2.2, foreground="white")],
        )
    axes.set(xlim=(corner[0], right), ylim=(corner[1], top), aspect="equal")
    axes.axis("off")


def drawn_height(vertex: Vertex, fold_angles: object) -> float:
    """Return the height of the picture of a state over its width, 1 at most.

    Parameters
    ----------
    vertex
        The vertex.
    fold_angles
        Of the state, shape [N] [rad].

    Returns
    -------
    float
        For ``draw_state(..., crop=True)``.

    Examples
    --------
    >>> from origami_nlp import Vertex
    >>> from origami_nlp.display import drawn_height
    >>> 0.5 < drawn_height(Vertex(("pi/2",) * 4), [3.14, 0, 3.14, 0]) < drawn_height(Vertex(("pi/2",) * 4), [0] * 4)
    True
    """
    phi = np.asarray(fold_angles, dtype=float)
    _, _, corner, side, below = _placed(vertex, tuple(phi.tolist()))
    return float(corner[1] + side - below) / side


@lru_cache(maxsize=64)
def _placed(
    vertex: Vertex, fold_angles: tuple[float, ...]
) -> tuple[Pose, np.ndarray, np.ndarray, float, float]:
    """Pose and labels of a state; lower left corner and side of the square around it, and where it ends below."""
    pose = pose_state(vertex, np.array(fold_angles))
    labels = label_places(pose)
    low, high = _extent(pose, labels)
    side = max(1.8, float((high - low).max()))  # folded-up states stay smaller than open ones
    corner = np.array([(low[0] + high[0] - side) / 2, high[1] - side])  # top: below the title
    return pose, labels, corner, side, float(low[1])


def crease_legend(states: Iterable[tuple[Vertex, np.ndarray]] | None = None) -> list[Any]:
    """Return legend entries for the creases and the sides of the paper.

    Parameters
    ----------
    states
        Vertices with fold angles, shape [N] [rad], that are drawn: entries for what is seen of them; None: all.

    Returns
    -------
    list of matplotlib.artist.Artist
        Handles with labels.
    """
    dashes = (0, (2.2, 1.3))
    entries = [
        Line2D([], [], color=MOUNTAIN, linewidth=2.2, label="mountain"),
        Line2D([], [], color=VALLEY, linewidth=2.2, linestyle=dashes, label="valley"),
        patch(UPPER, "upper side"),
        patch(LOWER, "lower side"),
    ]
    if states is None:
        return entries
    seen = np.any([_seen(vertex, np.asarray(phi)) for vertex, phi in states], axis=0)
    return [entry for entry, there in zip(entries, seen, strict=True) if there]


def _seen(vertex: Vertex, phi: np.ndarray) -> tuple[bool, bool, bool, bool]:
    """Whether a picture shows mountains, valleys, the upper side and the lower side."""
    pose, _, corner, side, _ = _placed(vertex, tuple(phi.tolist()))
    x, y = (corner[k] + side * np.linspace(0, 1, COARSE, dtype=np.float32) for k in (0, 1))
    depths = np.array([_facet_depth(pose, f, x, y) for f in range(len(phi))])
    front = depths.argmax(axis=0)[np.isfinite(depths).any(axis=0)]
    upper = pose.normals[front, 2] >= 0
    return bool((phi < 0).any()), bool((phi > 0).any()), bool(upper.any()), not upper.all()


def _hidden_ends(pose: Pose) -> list[bool]:
    """For each crease, whether a facet that it does not bound hides its end."""
    n = len(pose.creases)
    answer = []
    for i, c in enumerate(pose.creases):
        x, y, z = 0.97 * c + (pose.offsets[i] + pose.offsets[i - 1]) / 2
        others = [f for f in range(n) if f not in (i, (i - 1) % n)]
        at = (np.array([x], dtype=np.float32), np.array([y], dtype=np.float32))
        answer.append(any(_facet_depth(pose, f, *at)[0, 0] > z + 1e-3 for f in others))
    return answer


def _extent(pose: Pose, labels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corners of all that is drawn."""
    starts = (pose.offsets + np.roll(pose.offsets, 1, axis=0))[:, :2] / 2  # of the creases' bands
    parts = [labels - 0.1, labels + 0.1, starts - 0.05, starts + 0.05]
    for f in range(len(pose.creases)):
        arc = pose.arc(f)
        parts += [arc[:, :2] - 0.03, arc[:, :2] + 0.03]
    every = np.concatenate(parts)
    return every.min(axis=0), every.max(axis=0)


# ---------------------------------------------------------------- painting


def _paint(pose: Pose, phi: np.ndarray, low: np.ndarray, size: float) -> np.ndarray:
    """Paint the square of side `size` from its corner `low`: RGBA, shape [PIXELS, PIXELS, 4].

    Each pixel shows what is nearest to the viewer; an edge is never hidden by the facets it bounds.
    """
    step = size / PIXELS
    x, y = (low[k] + step * (np.arange(PIXELS, dtype=np.float32) + 0.5) for k in (0, 1))
    picture = np.zeros((PIXELS, PIXELS, 4), dtype=np.float32)
    nearest = np.full((PIXELS, PIXELS), -np.inf, dtype=np.float32)
    n = len(phi)
    depths = []
    for f in range(n):
        depth = _facet_depth(pose, f, x, y)
        depths.append(depth)
        front = depth > nearest
        nearest[front] = depth[front]
        picture[front] = (*_facet_colour(pose.normals[f]), 1.0)

    def band(
        p: np.ndarray,
        q: np.ndarray,
        width: float,
        colour: Colour,
        facets: Any,
        dashed: bool = False,
    ) -> None:
        """Paint the straight line from p to q, before its own facets."""
        box = []
        for k in (0, 1):
            ends = sorted((p[k], q[k]))
            first = int((ends[0] - width - low[k]) / step)
            last = int((ends[1] + width - low[k]) / step) + 2
            box.append(slice(max(first, 0), max(min(last, PIXELS), 0)))
        part = (box[1], box[0])
        dx, dy = x[box[0]][None, :] - p[0], y[box[1]][:, None] - p[1]
        along = q - p
        length2 = max(float(along[0] ** 2 + along[1] ** 2), 1e-12)
        t = np.clip((dx * along[0] + dy * along[1]) / length2, 0.0, 1.0)
        near = (dx - t * along[0]) ** 2 + (dy - t * along[1]) ** 2 <= (width / 2) ** 2
        if dashed:  # along a crease, of unit length
            near &= t % (DASH + GAP) < DASH
        depth = p[2] + t * along[2]
        for f in facets:
            depth = np.maximum(depth, depths[f][part])
        front = near & (depth + 1e-4 >= nearest[part])
        nearest[part][front] = depth[front] + 1e-4
        picture[part][front] = (*colour, 1.0)

    for f in range(n):
        for p, q in itertools.pairwise(pose.arc(f)):
            band(p, q, 0.015, to_rgb(BORDER), (f,))
    for i in range(n):
        colour, share = _crease_colour(phi[i])
        start = (pose.offsets[i] + pose.offsets[i - 1]) / 2
        band(start, start + pose.creases[i], 0.016 + 0.034 * share, colour, (i - 1, i), phi[i] > 0)
    return picture


def _facet_depth(pose: Pose, f: int, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Depth of facet f at the pixels, shape [y, x]; -inf beside it, or where it is seen edge-on."""
    a, b = pose.creases[f], pose.creases[(f + 1) % len(pose.creases)]
    normal, at = pose.normals[f], pose.offsets[f]
    depth = np.full((len(y), len(x)), -np.inf, dtype=np.float32)
    if abs(normal[2]) < 1e-3:
        return depth
    # only where the facet can be: around its border and its tip
    rim = np.vstack([pose.arc(f)[:, :2], at[:2]])
    (left, right), (bottom, top) = (
        np.searchsorted(v, (rim[:, k].min() - RIM, rim[:, k].max() + RIM))
        for k, v in ((0, x), (1, y))
    )
    dx = (x[left:right] - np.float32(at[0]))[None, :]
    dy = (y[bottom:top] - np.float32(at[1]))[:, None]
    dz = -(normal[0] * dx + normal[1] * dy) / normal[2]
    # seen flat: the sector is where a turns to d and d turns to b the way the facet does
    side = math.copysign(1.0, normal[2])
    inside = (side * (a[0] * dy - a[1] * dx) >= 0) & (side * (dx * b[1] - dy * b[0]) >= 0)
    inside &= dx * dx + dy * dy + dz * dz <= 1.0
    depth[bottom:top, left:right][inside] = dz[inside] + at[2]
    return depth


def _facet_colour(normal: np.ndarray) -> Colour:
    """Warm from above, cool from below, darker the more the facet turns from the light."""
    towards = normal if normal[2] >= 0 else -normal
    shade = 0.72 + 0.30 * max(0.0, float(towards @ LIGHT))
    r, g, b = to_rgb(UPPER if normal[2] >= 0 else LOWER)
    return min(1.0, r * shade), min(1.0, g * shade), min(1.0, b * shade)


def _crease_colour(phi: float) -> tuple[Colour, float]:
    """Colour by sign, faded towards grey for small |phi|, and |phi|/pi."""
    share = min(1.0, abs(float(phi)) / math.pi)
    if share < 1e-6:
        return to_rgb(FLAT), share
    strength = 0.35 + 0.65 * share
    full, grey = np.array(to_rgb(MOUNTAIN if phi < 0 else VALLEY)), np.full(3, 0.72)
    r, g, b = (strength * full + (1 - strength) * grey).tolist()
    return (r, g, b), share


def label_places(pose: Pose) -> np.ndarray:
    """Where the crease numbers go, [N, 2]: just beyond the ends, pushed apart where they meet."""
    n = len(pose.creases)
    shift = (pose.offsets + np.roll(pose.offsets, 1, axis=0)) / 2
    ends = (pose.creases + shift)[:, :2]
    length = np.maximum(np.linalg.norm(ends, axis=1, keepdims=True), 1e-9)
    out = np.where(length > 0.05, ends / length, [[0.0, -1.0]])
    places = ends + 0.15 * out
    for _ in range(60):
        moved = False
        for i in range(n):
            for j in range(i):
                gap = places[i] - places[j]
                distance = float(np.hypot(*gap))
                if distance >= 0.19:
                    continue
                moved = True
                way = gap / distance if distance > 1e-9 else np.array([1.0, 0.0])
                places[i] += 0.5 * (0.195 - distance) * way
                places[j] -= 0.5 * (0.195 - distance) * way
        if not moved:
            break
    return places
