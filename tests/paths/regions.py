"""Regions of a plane of two parameters between curves of events, each with its states counted by a search."""

from __future__ import annotations

import itertools
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp import find_minima
from origami_nlp.arguments import check_type, check_whole
from origami_nlp.paths import BifurcationSet
from origami_nlp.paths.family import Plane

CELLS = 400
"""Along each range: what is narrower than some cells is no region of its own."""
FEWEST = 3
"""Cells of a region that a line crosses between two events, where it says what is in it."""
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
        Number of states, by kind.
    seen
        Number and kinds found elsewhere in it.
    """

    t: tuple[float, float]
    share: float
    minima: int
    kinds: dict[str, int]
    seen: tuple[dict[str, int], ...]

    @property
    def agrees(self) -> bool:
        """Whether the same was found everywhere."""
        return all(kinds == self.kinds for kinds in self.seen)


def find_regions(
    boundaries: BifurcationSet, *, checks: int = 1, effort: str = "normal", seed: int = 0
) -> tuple[Region, ...]:
    """Count the states between curves of events: on the lines that cross a region, elsewhere by searches.

    Regions are what is left of a grid when the cells that curves pass are taken out; two that meet only through a gap
    narrower than a cell stay apart.

    Parameters
    ----------
    boundaries
        Of `find_bifurcation_set`.
    checks
        Places beside one at which each region is looked at: all lines that cross it count, but for those along an
        edge of the plane, and searches far from each other make up for lines that do not.
    effort, seed
        Of the searches.

    Returns
    -------
    tuple of Region
        The largest first.
    """
    from scipy.ndimage import distance_transform_edt

    check_type("boundaries", boundaries, BifurcationSet)
    check_whole("checks", checks, 0, 100)
    plane = Plane(boundaries.scene, boundaries.parameters)
    numbers = region_cells(boundaries)
    out = []
    for number in range(1, int(numbers.max()) + 1):
        inside = numbers == number
        if inside.mean() < LEAST:
            continue
        # the pad makes edges of the plane count as borders
        depth = distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1]
        deepest = np.unravel_index(int(depth.argmax()), depth.shape)
        found = _on_lines(boundaries, plane, inside)
        for _ in range(1 + checks - len(found)):
            at = np.unravel_index(int(depth.argmax()), depth.shape)
            t, u = _middle(plane, at)
            quick: dict[str, Any] = {"full": False, "prove": False, "escape": False}
            result = find_minima(plane.family(u).scene_of(t), effort=effort, seed=seed, **quick)
            found.append(dict(Counter(str(m.kind) for m in result.minima)))
            cells = np.indices(depth.shape)
            far = np.hypot(*(c - a for c, a in zip(cells, at, strict=True)))
            # the next check goes where it is far from borders and from the checks before
            depth = np.minimum(depth, far)
        kinds, *seen = (dict(sorted(k.items())) for k in found)
        where = _middle(plane, deepest)
        share = float(inside.mean())
        out.append(Region(where, share, sum(kinds.values()), kinds, tuple(seen)))
    return tuple(sorted(out, key=lambda r: -r.share))


def _on_lines(boundaries: BifurcationSet, plane: Plane, inside: np.ndarray) -> list[dict[str, int]]:
    """Return number and kinds of states on the parts of followed lines that lie in a region, longest first."""
    out: list[tuple[int, dict[str, int]]] = []
    for line in boundaries.lines:
        axis = [parameter.name for parameter in plane.parameters].index(line.parameter)
        if line.t in (plane.parameters[1 - axis].low, plane.parameters[1 - axis].high):
            continue  # ranges end where something is special: there may be states that neighbours have not
        place = _cell(plane, 1 - axis, line.t)
        cells = inside[:, place] if axis == 0 else inside[place]
        for interval in line.intervals:
            low, high = (_cell(plane, axis, t) for t in interval.t)
            count = int(cells[low : high + 1].sum())
            if count >= FEWEST:
                out.append((count, interval.kinds))
    return [kinds for _, kinds in sorted(out, key=lambda found: -found[0])]


def _cell(plane: Plane, axis: int, t: float) -> int:
    share = plane.share(plane.parameters[axis].s_of(t), axis)
    return int(np.clip(share * CELLS, 0, CELLS - 1))


def _middle(plane: Plane, cell: Any) -> tuple[float, float]:
    """Return both parameters in the middle of a cell."""
    t, u = (plane.value((cell[k] + 0.5) / CELLS, k) for k in (0, 1))
    return t, u


def region_cells(boundaries: BifurcationSet) -> np.ndarray:
    """Return the number of the region of each cell, 0 where a curve passes, [CELLS, CELLS]; see `find_regions`.

    The first parameter goes along the rows, both as they are followed.
    """
    from scipy.ndimage import label

    return np.asarray(label(~_walls(boundaries, Plane(boundaries.scene, boundaries.parameters)))[0])


def _walls(boundaries: BifurcationSet, plane: Plane) -> np.ndarray:
    """Return the cells that curves pass, [CELLS, CELLS]: first parameter along the rows."""
    walls = np.zeros((CELLS, CELLS), dtype=bool)
    for curve in boundaries.curves:
        cells = CELLS * np.array(
            [
                [plane.share(plane.parameters[k].s_of(p.t[k]), k) for k in (0, 1)]
                for p in curve.points
            ]
        )
        for a, b in itertools.pairwise(cells):
            many = int(np.ceil(4 * np.abs(b - a).max())) + 2
            at = np.floor(a + np.linspace(0, 1, many)[:, None] * (b - a)).astype(int)
            at = at.clip(0, CELLS - 1)
            walls[at[:, 0], at[:, 1]] = True
            walls[at[:, 0].clip(0, CELLS - 2) + 1, at[:, 1]] = True  # no way through a corner
    return walls
