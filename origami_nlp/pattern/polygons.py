"""Polygons that share sides and corners, and closed walks over them: round interior vertices, and round holes."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.errors import FoldFileError
from origami_nlp.numerics import groups

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
        # of faces that come to a corner twice the sides may never lead back
        while here in after and here != first and len(ring) < many[first[0]]:
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


@dataclass(frozen=True, eq=False)
class Loop:
    """A closed walk over facets: round an interior vertex, or round a hole.

    Attributes
    ----------
    creases
        Those it crosses, in order, [d].
    signs
        +1 where a crease is crossed from its right to its left facet, [d].
    vertex
        The interior vertex, or -1 for a hole.
    shifts
        Of a walk to a copy of a cell that repeats: lattice vectors by which each crease is moved, [d]; else empty.
    moved
        Of a walk once round a tube: from where it begins to where it ends in the reference state; it turns by 360
        degrees where it closes.  Else empty.
    """

    creases: tuple[int, ...]
    signs: tuple[int, ...]
    vertex: int
    shifts: tuple[tuple[int, int], ...] = ()
    moved: tuple[float, ...] = ()


class Loops:
    """Walks round corners, from side to side."""

    def __init__(
        self,
        polygons: Sequence[Sequence[int]],
        left_of: dict[tuple[int, int], int],
        index: dict[tuple[int, int], int],
    ) -> None:
        self.polygons, self.left_of, self.index = polygons, left_of, index
        self.following = {
            (p[i - 1], v): (v, p[(i + 1) % len(p)]) for p in polygons for i, v in enumerate(p)
        }

    def crossing(self, v: int, w: int) -> tuple[int, int] | None:
        """Return the crease from v to w and the sense in which a walk about v, counter-clockwise, crosses it."""
        crease = self.index.get((min(v, w), max(v, w)))
        return None if crease is None else (crease, 1 if v < w else -1)

    def vertices(self) -> tuple[Loop, ...]:
        """Return a loop for each corner with polygons all around."""
        found = []
        for ring in sorted(rings(self.polygons)):
            crossed = [c for side in ring if (c := self.crossing(*side)) is not None]
            if crossed:
                found.append(Loop(*zip(*crossed, strict=True), ring[0][0]))  # type: ignore[call-arg,arg-type]
        return tuple(found)

    def holes(self, corners: np.ndarray) -> tuple[Loop, ...]:
        """Return a loop for each border but the longest: a walk over the facets along it, paper on the left."""
        borders, seen = [], set()
        for first in sorted(s for s in self.left_of if s[::-1] not in self.left_of):
            if first in seen:
                continue
            crossed, length, side = [], 0.0, first
            while side not in seen:
                seen.add(side)
                length += float(np.linalg.norm(corners[side[1]] - corners[side[0]]))
                side = self.following[side]
                while side[::-1] in self.left_of:  # clockwise about side[0], from facet to facet
                    if (c := self.crossing(*side)) is not None:
                        crossed.append((c[0], -c[1]))
                    side = self.following[side[::-1]]
            borders.append((length, crossed))
        inner = sorted(borders, key=lambda b: b[0])[:-1]
        return tuple(Loop(*zip(*crossed, strict=True), -1) for _, crossed in inner if crossed)  # type: ignore[call-arg,arg-type]


def check_topology(facet_of: np.ndarray, left: np.ndarray, right: np.ndarray, loops: int) -> None:
    """Raise an error unless the facets hang together and the loops generate every closed walk over them."""
    facets = int(facet_of.max(initial=-1)) + 1
    parts = int(groups(facets, np.column_stack([left, right])).max(initial=-1)) + 1
    if parts != 1:
        raise FoldFileError(
            f"the facets are {parts} parts that no crease joins: --part K, or a file each, or vertices in common"
            if parts
            else "there are no facets: give faces_vertices, or edges that enclose some"
        )
    if len(left) - facets + 1 > loops:
        has = f"{len(left)} creases, {facets} facets, {loops} vertices and holes"
        raise FoldFileError(f"the surface has handles ({has}): these are not modelled")
