"""How much paper there is round each interior vertex, and which way each has popped.

The latter is the sign of the sum of its fold angles, which motions of paper keep.  Round a vertex with an angle sum of
360 degrees, or less, whose facets do not cross the fold angles sum to 0 in the flat state only (proved in
docs/validation/barriers.md).  So admissible motions change the sign only through states in which the vertex is exactly
flat: vertices divide the states of a sheet into cells, and a descent that steps from one into another has jumped over
what parts them.
"""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.numerics import INPUT_TOL, unit_normals
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


JUMPS = 1e-3
"""Steps longer than this [rad] do not take a vertex from one side of its flat state to the other: shorter ones may."""


def pop_rows(pattern: Pattern) -> np.ndarray:
    """Return rows that sum the fold angles round each vertex that can pop through its flat state only.

    Parameters
    ----------
    pattern
        The pattern.

    Returns
    -------
    numpy.ndarray
        Of 0 and 1, [v, n]; vertices with an angle sum beyond 360 degrees have none.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern_states import pop_rows
    >>> pop_rows(o.examples.pattern("miura", 2, 2)).tolist()
    [[1.0, 1.0, 1.0, 1.0]]
    """
    sums = angle_sums(pattern)
    loops = [loop for loop in pattern.vertices if sums[loop.vertex] <= 2 * math.pi + INPUT_TOL]
    rows = np.zeros((len(loops), pattern.creases))
    for row, loop in zip(rows, loops, strict=True):
        row[list(loop.creases)] = 1.0
    return rows


def is_jump(rows: np.ndarray, before: np.ndarray, after: np.ndarray) -> bool:
    """Return whether a step from one state to another [n] takes a vertex past its flat state, by more than `JUMPS`."""
    passed = (rows @ before) * (rows @ after) < 0
    far = (rows * np.abs(after - before)).max(axis=1, initial=0.0) > JUMPS
    return bool((passed & far).any())
