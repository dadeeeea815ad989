"""Admissibility on a grid of chart points, and the boundary points between its cells, bisected."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.chart.chart import Chart, admissible
from origami_nlp.numerics import NONZERO

if TYPE_CHECKING:
    from shapely import MultiPolygon

BISECTIONS = 50
"""Halvings of the step between two cells: to rounding."""
ROUGH = 12
"""Halvings after which a point is next to a line or not: to some 1e-5 rad."""
TOGETHER, AHEAD = 16, 5
"""Of at most so many steps so many halvings are evaluated at once: one call costs as much as some dozens of points."""


def chart_limits(chart: Chart) -> tuple[float, float, float, float]:
    """Return the chart's extent (x low, x high, y low, y high) [rad]."""
    reach = math.pi / 2 if chart.kind == "wedge" and chart.scene.contact == "full" else math.pi
    return -math.pi, math.pi, -reach, reach


def crossings_of(chart: Chart, branch: int, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return admissible points next to excluded ones, [k, 2] each, between cell centres that differ or up to the edge.

    They are bisected to `ROUGH`; on the edge both are one.
    """
    x0, x1, y0, y1 = chart_limits(chart)
    x = x0 + (x1 - x0) * (np.arange(size) + 0.5) / size
    y = y0 + (y1 - y0) * (np.arange(size) + 0.5) / size
    good = allowed(chart, branch, *np.meshgrid(x, y))[0]
    pairs: list[tuple[np.ndarray, np.ndarray]] = []
    padded = np.pad(good, 1)
    px, py = np.r_[x0, x, x1], np.r_[y0, y, y1]
    rows, columns = np.nonzero(good)
    for dr, dc in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        outside = ~padded[rows + 1 + dr, columns + 1 + dc]
        r, c = rows[outside] + 1, columns[outside] + 1
        pairs.append(
            (np.stack([px[c], py[r]], axis=-1), np.stack([px[c + dc], py[r + dr]], axis=-1))
        )
    inside = np.concatenate([a for a, _ in pairs])
    beyond = np.concatenate([b for _, b in pairs])
    at_edge = allowed(chart, branch, beyond[:, 0], beyond[:, 1])[0]
    # admissible up to the edge of the chart: the edge itself is the boundary there
    inside = np.where(at_edge[:, None], beyond, inside)
    return _bisected(chart, branch, inside, beyond, ROUGH)


def last_allowed(chart: Chart, branch: int, inside: np.ndarray, beyond: np.ndarray) -> np.ndarray:
    """Bisect between chart points with an admissible state and others [k, 2]: the last ones with one, to rounding."""
    return _bisected(chart, branch, inside, beyond, BISECTIONS)[0]


def _bisected(
    chart: Chart, branch: int, inside: np.ndarray, beyond: np.ndarray, halvings: int
) -> tuple[np.ndarray, np.ndarray]:
    ahead = AHEAD if len(inside) <= TOGETHER else 1
    each = np.arange(len(inside))
    while halvings > 0:
        ahead = min(ahead, halvings)
        # all midpoints that so many halvings can come to, in order along each step: [2^ahead + 1, k, 2]
        points = np.stack([inside, beyond])
        for _ in range(ahead):
            points = np.insert(points, np.arange(1, len(points)), (points[1:] + points[:-1]) / 2, 0)
        x, y = np.moveaxis(points[1:-1], -1, 0)
        ok = allowed(chart, branch, x, y)[0]
        low, high = 0 * each, 0 * each + len(points) - 1
        for _ in range(ahead):
            middle = (low + high) // 2
            good = ok[middle - 1, each]
            low, high = np.where(good, middle, low), np.where(good, high, middle)
        inside, beyond, halvings = points[low, each], points[high, each], halvings - ahead
    return inside, beyond


def faces_of(chart: Chart, branch: int, lines: list[Any], least: float) -> MultiPolygon:
    """Return the faces between lines that hold an admissible state and have at least that area [rad^2]."""
    import shapely

    faces = shapely.polygonize([shapely.unary_union(lines)]).geoms if lines else []
    inside = []
    for face in faces:
        at = face.representative_point()
        if face.area >= least and allowed(chart, branch, np.array([at.x]), np.array([at.y]))[0][0]:
            inside.append(face)
    union = shapely.unary_union(inside) if inside else shapely.MultiPolygon()
    return union if isinstance(union, shapely.MultiPolygon) else shapely.MultiPolygon([union])


def allowed(
    chart: Chart, branch: int, x: np.ndarray, y: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return which chart points have an admissible state, and return the states, shape S + (N,)."""
    phi = chart.fold_angles(branch, x, y)
    closed = np.isfinite(phi).all(axis=-1)
    good = np.zeros(closed.shape, dtype=bool)
    good[closed] = admissible(chart.scene, phi[closed])
    return good, phi


def distance_from(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distance of each point [k, d] from a polyline [m, d], shape [k]."""
    a, d = line[:-1], np.diff(line, axis=0)
    size = np.maximum((d * d).sum(axis=1), NONZERO)
    # coordinate by coordinate: sums over a last axis of two take most of the time
    each = [(p[:, None], start, step) for p, start, step in zip(points.T, a.T, d.T, strict=True)]
    t = np.clip(sum((p - start) * step for p, start, step in each) / size, 0.0, 1.0)
    square = sum((p - (start + t * step)) ** 2 for p, start, step in each)
    return np.asarray(np.sqrt(np.min(square, axis=1)))
