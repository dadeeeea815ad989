"""How fast the minima of a grid converge to the exact ones, and how many false ones stay.

With cells of size h, the lowest grid point near an exact minimum is off by

- interior: O(h) in place, O(h^2) in energy: a lattice point is within a cell, and the well is a parabola;
- pinned at a smooth boundary with moment mu > 0: O(h) in energy, O(sqrt(h)) in place: a grid point at distance
  d <= O(h) from the boundary costs mu d, one at distance t along it k t^2 / 2, so that the jags let
  t = O(sqrt(mu h / k)) win; where the boundary is a line of the grid, d is the same everywhere and the place is O(h);
- on a 1-handle: no cell has a state there, nothing converges;
- on a chart point that carries a family the chart is singular: slower than all of these, in the fold angles above all.

Grid points lie at the centres of the cells of `chart.landscape`, and shifted by random parts of a cell: one grid can
be lucky, so orders are those of the largest error over shifts.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from origami_nlp.arguments import check_type, check_whole, shown
from origami_nlp.chart import (
    LARGEST_SIZE,
    Landscape,
    allowed,
    chart_limits,
    chart_of,
    family_of,
    landscape,
)
from origami_nlp.errors import OptionError
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern import Scene
from studies.grid_minima import grid_points

SIZES = (65, 129, 257, 513, 1025)
REACH, STATE_REACH = 0.35, 1.0
"""Grid points within this chart distance [rad], and this change of every fold angle, are compared with a minimum."""
SHIFTS = 24
"""Shifts of the grid by parts of a cell; the first is none."""


@dataclass(frozen=True)
class GridErrors:
    """Errors of the lowest grid point near one exact minimum, for every size and shift of the grid, [sizes, shifts].

    scene: name.  number: of the minimum (1-based).  family: whether a family shares its chart point.
    energy: of the grid point less the exact one.  distance: in the chart (Euclidean) [rad].
    state: largest difference of a fold angle [rad].  cell: largest side of a cell [rad], [sizes].
    NaN where no admissible grid point is near.
    """

    scene: str
    number: int
    kind: str
    local_dimension: int
    family: bool
    cell: np.ndarray
    energy: np.ndarray = field(repr=False)
    distance: np.ndarray = field(repr=False)
    state: np.ndarray = field(repr=False)

    def order(self, what: str) -> float:
        """Slope of the logarithm of the largest error over shifts against that of h; NaN with fewer than 3 sizes."""
        worst = self.worst(what)
        good = np.isfinite(worst) & (worst > 0)
        if good.sum() < 3 or self.sort == "handle":
            return float("nan")
        return float(np.polyfit(np.log(self.cell[good]), np.log(worst[good]), 1)[0])

    def worst(self, what: str) -> np.ndarray:
        """Largest error over shifts, [sizes]; NaN where some shift has no grid point near."""
        return np.asarray(getattr(self, what).max(axis=1))

    @property
    def sort(self) -> str:
        """``handle``, ``family``, ``interior`` or ``contact``: what decides the order."""
        if self.local_dimension < 2:
            return "handle"
        return "family" if self.family else "interior" if self.kind == "interior" else "contact"


def grid_errors(
    result: MinimaResult, sizes: tuple[int, ...] = SIZES, *, shifts: int = SHIFTS, seed: int = 0
) -> tuple[GridErrors, ...]:
    """Compare every minimum with the lowest grid point near it.

    Parameters
    ----------
    sizes
        Cells along each coordinate.
    shifts, seed
        How many shifts of each grid, and the seed of all but the first.

    Raises
    ------
    OptionError
        If the scene has no chart of two coordinates.
    """
    scene = result.scene
    chart = chart_of(scene)
    if chart is None:
        raise OptionError("the scene has no closed-form chart of two coordinates")
    x0, x1, y0, y1 = chart_limits(chart)
    cells = np.array([[(x1 - x0) / n, (y1 - y0) / n] for n in sizes])
    shift = np.random.default_rng(seed).uniform(-0.5, 0.5, (shifts, 2))
    shift[0] = 0.0
    out = []
    for number, minimum in enumerate(result.minima, start=1):
        exact = np.array(minimum.fold_angles)
        branches, place = chart.locate(exact)
        errors = np.full((3, len(sizes), shifts), np.nan)
        for i, (dx, dy) in enumerate(cells):
            for k, (sx, sy) in enumerate(shift):
                x = _lines(x0, x1, place[0], dx, sx)
                y = _lines(y0, y1, place[1], dy, sy)
                x, y = np.meshgrid(x, y)
                good, phi = allowed(chart, branches[0], x, y)
                away = np.hypot(x - place[0], y - place[1])
                good &= away <= REACH
                good &= (
                    np.abs(phi - exact).max(axis=-1, initial=0.0, where=good[..., None])
                    <= STATE_REACH
                )
                if not good.any():
                    continue
                energy = np.where(good, np.asarray(scene.energy(phi)), np.inf)
                j = np.unravel_index(int(energy.argmin()), energy.shape)
                state = float(np.abs(phi[j] - exact).max())
                errors[:, i, k] = energy[j] - minimum.energy, away[j], state
        family = bool(family_of(scene, exact))
        name, dimension = scene.label, minimum.local_dimension
        out.append(
            GridErrors(name, number, minimum.kind, dimension, family, cells.max(axis=1), *errors)
        )
    return tuple(out)


def _lines(low: float, high: float, place: float, cell: float, shift: float) -> np.ndarray:
    """Coordinates of grid lines within REACH of a place and inside the chart."""
    first = int(np.floor((place - REACH - low) / cell)) - 1
    last = int(np.ceil((place + REACH - low) / cell)) + 1
    lines = low + (np.arange(first, last + 1) + 0.5 + shift) * cell
    return np.asarray(lines[(lines >= low) & (lines <= high)])


@dataclass(frozen=True)
class GridCount:
    """Grid minima of one scene on one grid.

    found: lower than all admissible neighbours.  claimed: exact minima that one of them is nearest to (those on
    1-handles, where no cell is, claim none).  false: found and claimed by none.
    """

    scene: str
    size: int
    found: int
    exact: int
    claimed: int

    @property
    def false(self) -> int:
        """Grid minima that belong to no exact minimum."""
        return self.found - self.claimed


def count_grid_minima(
    results: Iterable[MinimaResult], sizes: tuple[int, ...] = SIZES
) -> tuple[GridCount, ...]:
    """Count grid minima of scenes; those with the same geometry share one grid of states.

    Raises
    ------
    OptionError
        If `results` is no list of results, or `sizes` no list of numbers of cells.
    """
    if isinstance(results, str) or not isinstance(results, Iterable):
        raise OptionError(f"results = {shown(results)} must be a list of results of find_minima")
    results = list(results)
    for k, result in enumerate(results, start=1):
        check_type(f"results[{k}]", result, MinimaResult)
    if not isinstance(sizes, tuple | list):
        raise OptionError(f"sizes = {shown(sizes)} must be a list of whole numbers")
    for size in sizes:
        check_whole("sizes", size, 8, LARGEST_SIZE)
    states: dict[tuple[object, int], Landscape] = {}
    out = []
    for result in results:
        scene = result.scene
        for size in sizes:
            key = (_geometry(scene), size)
            if key not in states:
                states = {k: v for k, v in states.items() if k[0] == key[0]}
                states[key] = landscape(scene, size)
            chart = _with_energy_of(states[key], scene)
            places = [chart.place(m.fold_angles) for m in result.minima if m.local_dimension > 1]
            at = [
                (b, chart.branches[b].axes[0][c], chart.branches[b].axes[1][r])
                for b, r, c, _ in grid_points(chart)
            ]
            nearest = set()
            for place in places:
                away = [
                    np.hypot(x - place.point[0], y - place.point[1])
                    if b == place.branch
                    else np.inf
                    for b, x, y in at
                ]
                if away and min(away) <= REACH:
                    nearest.add(int(np.argmin(away)))
            out.append(GridCount(scene.label, size, len(at), len(result.minima), len(nearest)))
    return tuple(out)


def _geometry(scene: Scene) -> tuple[object, ...]:
    return scene.vertex, scene.group.name, scene.contact


def _with_energy_of(chart: Landscape, scene: Scene) -> Landscape:
    """The same states with the energy of another scene of the same geometry."""
    branches = tuple(
        replace(b, energy=np.asarray(scene.energy(b.fold_angles))) for b in chart.branches
    )
    return replace(chart, scene=scene, branches=branches)
