"""How much paper there is round each interior vertex."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.numerics import unit_normals
from origami_nlp.pattern import Pattern


def angle_sums(pattern: Pattern) -> dict[int, float]:
    """Return the sum of the angles of paper round each interior vertex [rad], by the vertex.

    Parameters
    ----------
    pattern
        The pattern.

    Returns
    -------
    dict
        A sum a vertex.
    """
    inside = {loop.vertex: 0.0 for loop in pattern.vertices}
    for polygon in pattern.polygons:
        x = pattern.corners[list(polygon)]
        normal = unit_normals(x)
        for i, v in enumerate(polygon):
            if v in inside:
                a, b = x[(i + 1) % len(x)] - x[i], x[i - 1] - x[i]
                angle = math.atan2(float(normal @ np.cross(a, b)), float(a @ b))
                inside[v] += angle % (2 * math.pi)
    return inside
