"""Regions of a plane of two parameters between curves of events, each with its states counted by a search."""

from __future__ import annotations

import itertools
from collections import Counter
from dataclasses import dataclass

import numpy as np

from origami_nlp.arguments import check_type, check_whole
from origami_nlp.atlas.boundary import Boundaries
from origami_nlp.atlas.plane import Plane
from origami_nlp.minima import find_minima

CELLS = 400
"""Along each range: what is narrower than some cells is no region of its own."""
LEAST = 0.002
"""Share of the plane below which a region is left out."""


@dataclass(frozen=True)
class Region:
    """A region that no curve of events crosses.

    Attributes
    ----------
    t
        Both parameters at its middle, the point that is farthest from curves and edges.
    share
        Of the plane, by area in what is followed (logarithms of ratios).
    minima, kinds
        Found by a search at its middle, by kind.
    seen
        Number and kinds found at further points of it.
    """

    t: tuple[float, float]
    share: float
    minima: int
    kinds: dict[str, int]
    seen: tuple[dict[str, int], ...]

    @property
    def agrees(self) -> bool:
        """Whether all searches found the same."""
        return all(kinds == self.kinds for kinds in self.seen)


def find_regions(
    boundaries: Boundaries, *, checks: int = 1, effort: str = "normal", seed: int = 0
) -> tuple[Region, ...]:
    """Count the states between curves of events by searches.

    Regions are what is left of a grid when the cells that curves pass are taken out; two that meet only through a gap
    narrower than a cell stay apart.

    Parameters
    ----------
    boundaries
        Of `find_boundaries`.
    checks
        Further searches in each region, far from each other.
    effort, seed
        Of the searches.

    Returns
    -------
    tuple of Region
        The largest first.
    """
    from scipy.ndimage import distance_transform_edt

    check_type("boundaries", boundaries, Boundaries)
    check_whole("checks", checks, 0, 100)
    plane = Plane(boundaries.scene, boundaries.overs)
    numbers = region_cells(boundaries)
    out = []
    for number in range(1, int(numbers.max()) + 1):
        inside = numbers == number
        if inside.mean() < LEAST:
            continue
        depth = distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1]
        found = []
        for _ in range(1 + checks):
            at = np.unravel_index(int(depth.argmax()), depth.shape)
            point = plane.corner + (np.array(at) + 0.5) / CELLS * plane.size
            t, u = plane.values(point)
            result = find_minima(plane.family(u).scene(t), prove=False, effort=effort, seed=seed)
            found.append(((t, u), Counter(str(m.kind) for m in result.minima)))
            cells = np.indices(depth.shape)
            far = np.hypot(*(c - a for c, a in zip(cells, at, strict=True)))
            depth = np.minimum(depth, far)
        (where, kinds), *others = found
        seen = tuple(dict(sorted(k.items())) for _, k in others)
        share = float(inside.mean())
        out.append(Region(where, share, sum(kinds.values()), dict(sorted(kinds.items())), seen))
    return tuple(sorted(out, key=lambda r: -r.share))


def region_cells(boundaries: Boundaries) -> np.ndarray:
    """Return the number of the region of each cell, 0 where a curve passes, [CELLS, CELLS]; see `find_regions`.

    The first parameter goes along the rows, both as they are followed.
    """
    from scipy.ndimage import label

    return np.asarray(label(~_walls(boundaries, Plane(boundaries.scene, boundaries.overs)))[0])


def _walls(boundaries: Boundaries, plane: Plane) -> np.ndarray:
    """Return the cells that curves pass, [CELLS, CELLS]: first parameter along the rows."""
    walls = np.zeros((CELLS, CELLS), dtype=bool)
    for curve in boundaries.curves:
        s = np.array(
            [[o.s_of(v) for o, v in zip(plane.overs, p.t, strict=True)] for p in curve.points]
        )
        cells = (s - plane.corner) / plane.size * CELLS
        for a, b in itertools.pairwise(cells):
            many = int(np.ceil(4 * np.abs(b - a).max())) + 2
            at = np.floor(a + np.linspace(0, 1, many)[:, None] * (b - a)).astype(int)
            at = at.clip(0, CELLS - 1)
            walls[at[:, 0], at[:, 1]] = True
            walls[at[:, 0].clip(0, CELLS - 2) + 1, at[:, 1]] = True  # no way through a corner
    return walls
