"""A pattern as a body that can be turned."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from origami_nlp.display.bodies import Body, Crease, FoldedBody
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import PatternCrossings

AZIMUTH, ELEVATION = math.radians(-58.0), math.radians(32.0)
"""From where a sheet is seen, about its mean normal, which points up."""
CANCELS = 1e-9
"""Share of all areas below which the areas of facets, as vectors, cancel: their mean normal is rounding."""
LONG = 0.8
"""Mean length of a crease on a page, whose lines are as wide as for a vertex with creases of length 1."""


def pattern_poser(
    pattern: Pattern,
) -> tuple[Body, Callable[[np.ndarray, float], FoldedBody], Callable[[np.ndarray], np.ndarray]]:
    """Return a sheet as a body, and what puts its states into space and says from where they are seen.

    Parameters
    ----------
    pattern
        The sheet; of a cell that repeats two by two copies.

    Returns
    -------
    tuple
        The body; functions of fold angles [n] [rad], the first of energies as well.
    """
    crease_of = np.arange(pattern.creases)
    if pattern.cell:
        pattern, crease_of = pattern.cell.tiles
    crossings = PatternCrossings(pattern)
    parts = [tuple(dict.fromkeys(piece)) for piece in crossings.pieces.tolist()]
    left = {(q[i - 1], v): k for k, q in enumerate(parts) for i, v in enumerate(q)}
    creases = tuple(Crease(a, b, left[b, a], left[a, b]) for a, b in pattern.ends.tolist())
    scale = LONG / float(pattern.lengths.mean() if pattern.creases else crossings.size)

    def folded(phi: np.ndarray, energy: float) -> FoldedBody:
        phi = phi[crease_of]
        x = np.nan_to_num(crossings.poses.corners(phi))
        middle = x[crossings.pieces.ravel()].mean(axis=0)
        shifts = np.zeros((len(parts), 3))
        return FoldedBody((x - middle) * scale, phi, energy, shifts)

    def view(phi: np.ndarray) -> np.ndarray:
        return pattern_view(crossings.poses.polygons(phi[crease_of]))

    return Body(tuple(parts), creases), folded, view


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
