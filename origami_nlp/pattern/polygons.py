"""Sides and corners of polygons that share them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np

Side = tuple[int, int]
"""Two corners: of a side as such in increasing order, of a polygon's own in the sense in which it runs."""


def side(a: int, b: int) -> Side:
    """Return the side between two corners."""
    return (a, b) if a < b else (b, a)


def sides_of(polygons: Sequence[Sequence[int]]) -> dict[Side, list[int]]:
    """Return the polygons that have each side."""
    found: dict[Side, list[int]] = {}
    for k, polygon in enumerate(polygons):
        for i, v in enumerate(polygon):
            found.setdefault(side(polygon[i - 1], v), []).append(k)
    return found


def rings(polygons: Sequence[Sequence[int]]) -> list[list[Side]]:
    """Return, for each corner with polygons all around, the sides that leave it, counter-clockwise as these run."""
    # after the side (v, w) of a polygon comes, counter-clockwise about v, its side (u, v) turned round
    after = {(v, p[(i + 1) % len(p)]): (v, p[i - 1]) for p in polygons for i, v in enumerate(p)}
    many = Counter(v for v, _ in after)
    found, seen = [], set()
    for first in after:
        if first[0] in seen:
            continue
        seen.add(first[0])
        ring, here = [first], after[first]
        while here in after and here != first:
            ring.append(here)
            here = after[here]
        if here == first and len(ring) == many[first[0]]:
            found.append(ring)
    return found


def area(xy: np.ndarray) -> float:
    """Return the area of a polygon in the plane [n, 2], negative where it runs clockwise."""
    x = xy - xy[0]
    y = np.roll(x, -1, axis=0)
    return 0.5 * float((x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]).sum())


def fold_between(axis: np.ndarray, before: np.ndarray, after: np.ndarray) -> float:
    """Return the fold angle [rad] between facets by their unit normals, about an axis, valley positive."""
    along = float(axis @ np.cross(before, after)) / float(np.linalg.norm(axis))
    return math.atan2(along, float(before @ after))
