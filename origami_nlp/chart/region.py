"""The admissible set over a chart as exact polygons, put together from its boundary lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.chart.boundary_lines import CORNER, Boundary
from origami_nlp.chart.chart import chart_of
from origami_nlp.chart.grid import faces_of
from origami_nlp.pattern import Scene

if TYPE_CHECKING:
    from shapely import MultiPolygon

SLIVER = 1e-10
"""Faces with less area [rad^2] are rounding between two lines that touch."""


def admissible_region(scene: Scene, boundary: Boundary, branch: int) -> MultiPolygon:
    """Return the admissible part of one branch of the chart as polygons in its coordinates [rad].

    The boundary lines cut the chart into faces; a face belongs to the region if a point inside it is admissible.
    Thin sets (1-handles) bound no face.  Between the points of a line, which lie on the boundary to rounding, the
    polygon is straight.
    """
    import shapely

    chart = chart_of(scene)
    assert chart is not None
    corners: list[np.ndarray] = []

    def corner(p: np.ndarray) -> np.ndarray:
        for known in corners:
            if np.abs(known - p).max() <= CORNER:
                return known
        corners.append(p)
        return p

    pieces: list[Any] = []
    for line in boundary.lines:
        if line.branch != branch or line.thin or line.hidden:
            continue
        points = line.points.copy()
        # ends of lines are known to `CORNER` only: those of one corner are made one point, or faces would not close
        points[0], points[-1] = corner(points[0]), corner(points[-1])
        pieces.append(shapely.LineString(points))
    return faces_of(chart, branch, pieces, SLIVER)
