"""A folded vertex drawn in three dimensions: facets as shaded sectors, creases as coloured bands.

The state is projected orthographically and painted from back to front as small patches, so hidden
parts are hidden.  Mountain creases are red, valleys blue, both by the sign of the fold angle, wider
and darker the larger |phi|/pi; borders are black.  The upper side of the paper is warm, the lower
side cool.  Every facet is a sector of the unit disc.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.patheffects import withStroke

from origami_nlp.model.embedding import fold_vertex
from origami_nlp.state.vertex import Vertex

MOUNTAIN, VALLEY, FLAT, BORDER = "#c1121f", "#1d4ed8", "#8a8a8a", "#000000"
UPPER, LOWER = "#f6ead2", "#c3d3dc"
SPREAD = 0.05
"""Offset [of the unit radius] that keeps facets that lie on each other apart in the picture."""
RINGS, ARC = 8, math.radians(7)
"""Patches of a facet: so many rings, and steps of at most this angle."""
LIGHT = np.array([-0.35, 0.55, 0.76])
"""Towards the light, in the picture's frame."""

Colour = tuple[float, float, float]
Item = tuple[float, np.ndarray, Colour]
"""Depth (towards the viewer), polygon [k, 2], colour."""


@dataclass(frozen=True)
class Pose:
    """A folded vertex turned for viewing.

    creases: c_i, shape [N, 3], in the picture's frame: x right, y up, z towards the viewer.
    normals: of the upper side of each facet, [N, 3].
    offsets: displacement of each facet, [N, 3]; zero unless facets lie on each other.
    """

    creases: np.ndarray
    normals: np.ndarray
    offsets: np.ndarray


def draw_state(axes: Any, vertex: Vertex, fold_angles: object, *, size: float = 9.0) -> bool:
    """Draw one state into a matplotlib Axes (made square and bare here).

    Parameters
    ----------
    fold_angles
        All N, shape [N] [rad]; the state should close.
    size
        Font size of the crease numbers [points].

    Returns
    -------
    spread
        Whether facets that lie on each other were drawn slightly apart.
    """
    phi = np.asarray(fold_angles, dtype=float)
    pose = pose_state(vertex, phi)
    polygons, colours = _patches(pose, vertex, phi)
    axes.add_collection(
        PolyCollection(polygons, facecolors=colours, edgecolors=colours, linewidths=0.25)
    )
    labels = _label_places(pose)
    for number, (x, y) in enumerate(labels, start=1):
        axes.text(
            x,
            y,
            str(number),
            ha="center",
            va="center",
            fontsize=size,
            color=_crease_colour(phi[number - 1])[0],
            path_effects=[withStroke(linewidth=2.2, foreground="white")],
        )
    every = np.concatenate([*polygons, labels - 0.1, labels + 0.1])
    low, high = every.min(axis=0), every.max(axis=0)
    reach = max(0.9, 0.5 * float((high - low).max()))  # folded-up states stay smaller than open ones
    (x0, y0), (x1, y1) = (low + high) / 2 - reach, (low + high) / 2 + reach
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal")
    axes.axis("off")
    return bool(np.any(pose.offsets))


# ---------------------------------------------------------------- pose


def pose_state(vertex: Vertex, fold_angles: np.ndarray) -> Pose:
    """Turn a state upright, and to where most of it is seen.

    Upright: the mean normal of the paper's upper side points up (for a symmetric state this is its
    axis, or lies in its mirror).  Where the normals cancel, as in a closed book, the mean of the
    creases does.  Then the best of a fixed set of views is taken: facets seen broadly, crease ends
    apart and not hidden.
    """
    phi = np.asarray(fold_angles, dtype=float)
    creases, _ = fold_vertex(vertex, phi)
    ends = np.roll(creases, -1, axis=0)
    normals = np.cross(creases, ends)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    offsets = _offsets(phi, normals)
    weight = np.array(vertex.sector_angles)[:, None] / (2 * math.pi)
    up = (weight * normals).sum(axis=0)
    if np.linalg.norm(up) < 0.15:
        up = creases.mean(axis=0)
    if np.linalg.norm(up) < 0.15:
        up = np.array([0.0, 0.0, 1.0])
    up = up / np.linalg.norm(up)
    ahead = next(
        a for c in (*creases, *np.eye(3)) if np.linalg.norm(a := c - (c @ up) * up) > 0.05
    )
    ahead = ahead / np.linalg.norm(ahead)
    frame = np.stack([ahead, np.cross(up, ahead), up])
    view = _best_view(creases @ frame.T, normals @ frame.T, weight[:, 0])
    turn = view @ frame
    return Pose(creases @ turn.T, normals @ turn.T, offsets @ turn.T)


def _offsets(phi: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Displace the facets next to closed creases: a valley (+pi) lays the next facet on top."""
    n = len(phi)
    closed = math.pi - np.abs(phi) < 0.03
    offsets = np.zeros((n, 3))
    if not closed.any():
        return offsets
    first = int(np.argmin(np.abs(phi)))  # start behind the most open crease
    for step in range(1, n):
        i = (first + step) % n  # crease i lies between facets i - 1 and i
        move = math.copysign(SPREAD, phi[i]) * normals[i - 1] if closed[i] else 0.0
        offsets[i] = offsets[i - 1] + move
    return offsets - offsets.mean(axis=0)


def _best_view(creases: np.ndarray, normals: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Choose rows (right, up, towards the viewer) among azimuths and elevations."""
    best, best_score = np.eye(3), -math.inf
    n = len(creases)
    i, j = np.triu_indices(n, 1)
    for elevation in np.radians([25.0, 35.0, 45.0, 60.0]):
        for azimuth in np.radians(np.arange(-180.0, 180.0, 7.5) - 58.0):
            s, c = math.sin(azimuth), math.cos(azimuth)
            se, ce = math.sin(elevation), math.cos(elevation)
            rows = np.array([[-s, c, 0.0], [-se * c, -se * s, ce], [ce * c, ce * s, se]])
            flat = creases @ rows[:2].T
            apart = np.hypot(*(flat[i] - flat[j]).T)
            seen = float(np.minimum(np.abs(normals @ rows[2]), 0.85) @ weight)
            edge_on = float(np.minimum(np.abs(normals @ rows[2]), 0.25).min())
            hidden = _hidden(creases, rows[2])
            score = (
                seen
                + 1.5 * edge_on
                + 1.2 * float(np.minimum(apart, 0.3).mean())
                + 1.0 * float(np.minimum(apart, 0.2).min())
                - 0.9 * hidden
                - 0.15 * abs(elevation - math.radians(35))
            )
            if score > best_score + 1e-9:  # the first of equal views, whatever the rounding
                best, best_score = rows, score
    return best


def _hidden(creases: np.ndarray, view: np.ndarray) -> float:
    """Share of the crease midpoints and ends that a facet hides from a viewer at infinity."""
    n = len(creases)
    a, b = creases, np.roll(creases, -1, axis=0)
    points = np.concatenate([0.5 * creases, 0.95 * creases])
    owner = np.tile(np.arange(n), 2)
    count = 0
    for f in range(n):
        # point + t view = x a + y b with t > 0, x, y >= 0, |x a + y b| <= 1
        basis = np.stack([a[f], b[f], -view], axis=1)
        if abs(np.linalg.det(basis)) < 1e-6:
            continue
        x, y, t = np.linalg.solve(basis, points.T)
        length = np.linalg.norm(np.outer(x, a[f]) + np.outer(y, b[f]), axis=1)
        own = (owner == f) | (owner == (f + 1) % n)
        count += int(((t > 1e-6) & (x > 0) & (y > 0) & (length < 1) & ~own).sum())
    return count / (2 * n)


# ---------------------------------------------------------------- patches


def _patches(
    pose: Pose, vertex: Vertex, phi: np.ndarray
) -> tuple[list[np.ndarray], list[Colour]]:
    """Polygons [k, 2] and colours, in the order in which to paint them."""
    items: list[Item] = []
    n = len(phi)
    radii = np.linspace(0.0, 1.0, RINGS + 1)
    beside = np.full((n, RINGS), -math.inf)  # depth of the nearest patch beside crease i, ring r
    for f, sector in enumerate(vertex.sector_angles):
        colour = _facet_colour(pose.normals[f])
        steps = max(2, math.ceil(sector / ARC))
        arc = _arc(pose.creases[f], pose.creases[(f + 1) % n], sector, steps)
        for k in range(steps):
            for r in range(RINGS):
                ring = radii[[r, r + 1, r + 1, r], None]
                quad = ring * arc[[k, k, k + 1, k + 1]] + pose.offsets[f]
                depth = float(quad[:, 2].mean())
                items.append((depth, quad[:, :2], colour))
                for crease, at in ((f, 0), ((f + 1) % n, steps - 1)):
                    if k == at:
                        beside[crease, r] = max(beside[crease, r], depth)
            rim = arc[[k, k + 1]] + pose.offsets[f]
            _band(items, rim[0], rim[1], 0.013, to_rgb(BORDER), depth + 1e-3)
    for i in range(n):
        crease_colour, share = _crease_colour(phi[i])
        shift = (pose.offsets[i] + pose.offsets[i - 1]) / 2
        for r in range(RINGS):
            # in front of the facets it joins, and of nothing else
            p, q = radii[[r, r + 1], None] * pose.creases[i] + shift
            depth = max(beside[i, r], float(p[2] + q[2]) / 2) + 2e-3
            _band(items, p, q, 0.014 + 0.034 * share, crease_colour, depth)
    items.sort(key=lambda item: item[0])
    return [polygon for _, polygon, _ in items], [colour for _, _, colour in items]


def _facet_colour(normal: np.ndarray) -> Colour:
    """Warm from above, cool from below, darker the more the facet turns from the light."""
    towards = normal if normal[2] >= 0 else -normal
    shade = 0.80 + 0.20 * max(0.0, float(towards @ LIGHT))
    r, g, b = to_rgb(UPPER if normal[2] >= 0 else LOWER)
    return min(1.0, r * shade), min(1.0, g * shade), min(1.0, b * shade)


def _arc(a: np.ndarray, b: np.ndarray, sector: float, steps: int) -> np.ndarray:
    """Points from a to b on the unit sphere, a constant angle apart, shape [steps + 1, 3]."""
    t = np.linspace(0.0, 1.0, steps + 1)[:, None]
    return (np.sin((1 - t) * sector) * a + np.sin(t * sector) * b) / math.sin(sector)


def _band(
    items: list[Item], p: np.ndarray, q: np.ndarray, width: float, colour: Colour, depth: float
) -> None:
    """Add a short straight line as a polygon of a width as seen."""
    along = q[:2] - p[:2]
    length = float(np.hypot(*along))
    along = along / length if length > 1e-12 else np.array([1.0, 0.0])
    side = width / 2 * np.array([-along[1], along[0]])
    tip = 0.3 * width * along  # overlap, or the joints would gape
    back, front = p[:2] - tip, q[:2] + tip
    items.append((depth, np.array([back - side, front - side, front + side, back + side]), colour))


def _crease_colour(phi: float) -> tuple[Colour, float]:
    """Colour by sign, faded towards grey for small |phi|, and |phi|/pi."""
    share = min(1.0, abs(float(phi)) / math.pi)
    if share < 1e-6:
        return to_rgb(FLAT), share
    strength = 0.35 + 0.65 * share
    full, grey = np.array(to_rgb(MOUNTAIN if phi < 0 else VALLEY)), np.full(3, 0.72)
    r, g, b = (strength * full + (1 - strength) * grey).tolist()
    return (r, g, b), share


def _label_places(pose: Pose) -> np.ndarray:
    """Where the crease numbers go, [N, 2]: just beyond the ends, pushed apart where they meet."""
    n = len(pose.creases)
    shift = (pose.offsets + np.roll(pose.offsets, 1, axis=0)) / 2
    ends = (pose.creases + shift)[:, :2]
    length = np.maximum(np.linalg.norm(ends, axis=1, keepdims=True), 1e-9)
    out = np.where(length > 0.2, ends / length, [[0.0, -1.0]])
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
