"""The paper of an origami as it is shown, and from where."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from origami_nlp.pattern import Pattern, Scene, Vertex

AZIMUTH, ELEVATION = math.radians(-58.0), math.radians(32.0)
"""From where a sheet is seen, about its mean normal, which points up."""


def paper_of(origami: Scene | Vertex | Pattern) -> Pattern:
    """Return the sheet of an origami as it is shown: of a vertex a disc about corner 0, whose creases are 1 long."""
    if isinstance(origami, Pattern):
        return origami
    if isinstance(origami, Vertex):
        n = origami.degree
        origami = Scene(origami, (1.0,) * n, (0.0,) * n, "none", "fold-limits")
    paper = origami.paper
    corners, polygons = [*paper.corners], []
    for apex, i, j in paper.polygons:
        a, b = paper.corners[i], paper.corners[j]
        sector = math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
        # the border in pieces of 5 degrees
        t = np.linspace(0.0, sector, max(2, math.ceil(sector / math.radians(5))) + 1)[1:-1, None]
        first = len(corners)
        corners += [*((np.sin(sector - t) * a + np.sin(t) * b) / math.sin(sector))]
        polygons.append((apex, i, *range(first, len(corners)), j))
    return replace(paper, corners=np.array(corners), polygons=tuple(polygons))


def apex_of(pattern: Pattern) -> int | None:
    """Return the corner that all creases of a vertex meet at; None of any other sheet."""
    one = pattern.vertices[0] if len(pattern.vertices) == 1 else None
    return one.vertex if one and len(one.creases) == pattern.creases else None


def area_of(polygon: np.ndarray) -> np.ndarray:
    """Return twice the area of a plane polygon [q, 3], as a vector along its normal."""
    at = polygon - polygon[0]
    return np.asarray(np.cross(at, np.roll(at, -1, axis=0)).sum(axis=0))


def pattern_view(polygons: list[np.ndarray]) -> np.ndarray:
    """Return from where a sheet is seen.

    Parameters
    ----------
    polygons
        In space, [q, 3] each.

    Returns
    -------
    numpy.ndarray
        Rows right, up and towards the viewer, [3, 3].
    """
    areas = np.array([area_of(x) for x in polygons])
    area = areas.sum(axis=0)
    # where areas of facets, as vectors, cancel their mean normal is rounding
    seen = np.linalg.norm(area) > 1e-9 * np.linalg.norm(areas, axis=1).sum()
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
