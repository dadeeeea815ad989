"""The admissible part of a chart as polygons for pictures, whatever contact the scene asks for.

With full contact its boundary is traced (`trace_boundary`).  Otherwise, and where there are stops, states end where
closure has no solution, a fold angle passes its limit or facets meet: cells of a grid over which that changes are
halved a few times, edges of the last ones bisected to rounding, and the points joined within their cells.  Corners of
polygons then lie on the boundary, and their sides leave it by less than a cell squared.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.chart.boundary_lines import CORNER, Boundary, trace_boundary
from origami_nlp.chart.chart import Chart, chart_of
from origami_nlp.chart.grid import allowed, chart_limits, faces_of, last_allowed
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Scene

if TYPE_CHECKING:
    from shapely import MultiPolygon

SIZE, HALVINGS = 96, 2
"""Cells along each coordinate where the boundary is not traced, and how often those at the boundary are halved."""


@dataclass(frozen=True)
class Outline:
    """What bounds the states of a chart.

    Attributes
    ----------
    regions
        Admissible part of each branch, in the chart's coordinates [rad].
    boundary
        Contact boundaries, where contact is full and there are no stops.
    """

    regions: tuple[MultiPolygon, ...] = field(repr=False)
    boundary: Boundary | None = field(default=None, repr=False)


def outline_of(scene: Scene) -> Outline:
    """Return the outline of a scene's chart; scenes that differ in their springs share it.

    Parameters
    ----------
    scene
        With a chart of two coordinates.

    Returns
    -------
    Outline
        Of every branch.

    Raises
    ------
    OptionError
        If the scene has no such chart.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> from origami_nlp.chart import outline_of
    >>> [round(r.area, 3) for r in outline_of(examples.degree6("pi/4", contact="fold-limits")).regions]
    [19.739]
    """
    if chart_of(scene) is None:
        raise OptionError(f"symmetry {scene.group.name}: the scene has no chart of two coordinates")
    springs: dict[str, Any] = {
        "stiffness": (1.0,) * scene.degree,
        "rest_angles": (0.0,) * scene.degree,
        "preload": (),
        "laws": (),
    }
    return _outline(replace(scene, **springs, symmetry=scene.group.name, name=None))


@lru_cache(maxsize=32)
def _outline(scene: Scene) -> Outline:
    chart = chart_of(scene)
    assert chart is not None
    branches = range(len(chart.signs))
    if scene.contact != "full" or scene.limits:
        return Outline(tuple(_bisected_region(chart, k) for k in branches))
    boundary = trace_boundary(scene)
    return Outline(tuple(admissible_region(scene, boundary, k) for k in branches), boundary)


class _Grid:
    """A grid over a branch of a chart, evaluated where it is asked for: corners by whole row and column."""

    def __init__(self, chart: Chart, branch: int) -> None:
        self.chart, self.branch = chart, branch
        self.limits = chart_limits(chart)
        self.count = SIZE * 2**HALVINGS

    def points(self, places: np.ndarray) -> np.ndarray:
        """Chart coordinates [k, 2] of rows and columns [k, 2], halves allowed."""
        x0, x1, y0, y1 = self.limits
        share = places[:, ::-1] / self.count
        # both ends to the last bit: lines must meet the frame
        return np.array([x0, y0]) * (1 - share) + np.array([x1, y1]) * share

    def good(self, points: np.ndarray) -> np.ndarray:
        """Whether chart points [k, 2] have an admissible state."""
        return np.asarray(allowed(self.chart, self.branch, points[:, 0], points[:, 1])[0])

    def corners(self, cells: np.ndarray, step: int) -> np.ndarray:
        """Whether the corners of cells [k, 2] are good, counter-clockwise from the lower left: [k, 4]."""
        each = (cells[:, None] + step * AROUND).reshape(-1, 2)
        every, where = np.unique(each, axis=0, return_inverse=True)
        return self.good(self.points(every))[where.ravel()].reshape(-1, 4)


RESOLVED_CELLS = 8
"""Smaller pieces are beads of a cusp, between whose sides fewer and fewer corners lie."""
AROUND = np.array([(0, 0), (0, 1), (1, 1), (1, 0)])
"""Corners of a cell by row and column, counter-clockwise from the lower left."""


def _bisected_region(chart: Chart, branch: int) -> MultiPolygon:
    import shapely

    grid = _Grid(chart, branch)
    step = 2**HALVINGS
    cells = step * np.stack(np.meshgrid(*[np.arange(SIZE)] * 2), axis=-1).reshape(-1, 2)
    good = grid.corners(cells, step)
    while step > 1:
        # the neighbours too: a line may leave a cell and come back between two corners
        cells = cells[good.any(axis=1) & ~good.all(axis=1)]
        beside = np.array([(r, c) for r in (-1, 0, 1) for c in (-1, 0, 1)])
        cells = np.unique((cells[:, None] + step * beside).reshape(-1, 2), axis=0)
        cells = cells[((cells >= 0) & (cells < grid.count)).all(axis=1)]
        step //= 2
        cells = (cells[:, None] + step * AROUND).reshape(-1, 2)
        good = grid.corners(cells, step)
    while len(
        new := _beyond(grid, cells, good)
    ):  # a thin piece that goes on where nothing was halved
        cells = np.concatenate([cells, new])
        good = np.concatenate([good, grid.corners(new, 1)])
    mixed = np.asarray(good.any(axis=1) & ~good.all(axis=1))
    x0, x1, y0, y1 = grid.limits
    lines = [shapely.box(x0, y0, x1, y1).exterior]
    # faces are larger than what the cells resolve
    least = RESOLVED_CELLS * (x1 - x0) * (y1 - y0) / (SIZE * 2**HALVINGS) ** 2
    return faces_of(chart, branch, lines + _segments(grid, cells[mixed], good[mixed]), least)


def _beyond(grid: _Grid, cells: np.ndarray, good: np.ndarray) -> np.ndarray:
    """Cells [k, 2] beyond a side that the boundary crosses, which are not among the cells yet."""
    cell, side = np.nonzero(good != np.roll(good, -1, axis=1))
    new = cells[cell] + np.array([(-1, 0), (0, 1), (1, 0), (0, -1)])[side]
    new = np.unique(new[((new >= 0) & (new < grid.count)).all(axis=1)], axis=0)
    known = cells @ (grid.count, 1)
    return np.asarray(new[~np.isin(new @ (grid.count, 1), known)])


def _segments(grid: _Grid, cells: np.ndarray, good: np.ndarray) -> list[Any]:
    """Join the boundary points on the edges of cells [k, 2] with corners good or not [k, 4]."""
    import shapely

    crossed = good != np.roll(good, -1, axis=1)  # side s goes from corner s to the next
    cell, side = np.nonzero(crossed)
    a, b = (grid.points(cells[cell] + AROUND[(side + k) % 4]) for k in (0, 1))
    swap = (a > b).any(axis=1, keepdims=True)  # the same way from both cells that share the edge
    a, b = np.where(swap, b, a), np.where(swap, a, b)
    inside = np.asarray(grid.good(a))[:, None]
    a, b = np.where(inside, a, b), np.where(inside, b, a)
    a = last_allowed(grid.chart, grid.branch, a, b)
    # two opposite corners good, two not: which pair hangs together is decided by the middle of the cell
    centre = np.asarray(grid.good(grid.points(cells + 0.5)))
    pairs, first = [], np.searchsorted(cell, np.arange(len(cells)))
    for k, start in enumerate(first.tolist()):
        ends = list(range(start, start + int(crossed[k].sum())))
        if len(ends) == 4 and good[k, 0] != centre[k]:
            ends = ends[1:] + ends[:1]  # sides 3 and 0 meet at the corner to cut off, and 1 and 2
        pairs += [ends[i : i + 2] for i in range(0, len(ends), 2)]
    return list(shapely.linestrings(a[np.array(pairs, dtype=int).reshape(-1, 2)]))


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
