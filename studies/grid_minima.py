"""What a grid reports as minima, and where each of them really goes.

The published code compares each point of a grid with its eight neighbours and ignores excluded ones, so that every
jag of a boundary, and every edge of a chart, can look like a minimum.  Here each such point is followed downhill
through admissible states (`kkt.follow`) to the exact minimum that it belongs to.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.chart import Landscape, landscape
from origami_nlp.kkt import follow
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import ENDPOINT_TOL


@dataclass(frozen=True)
class GridMinimum:
    """A grid point that is lower than its admissible neighbours.

    branch: name of the branch of the chart.  point: chart coordinates [rad].  energy: there.
    excluded_neighbours: how many of its eight neighbours are excluded or outside the chart.
    minimum: number (1-based) of the exact minimum that it flows to, or None.
    distance: largest change of a fold angle on the way [rad].  drop: energy lost on the way.
    end: where it went, in words, if not to a listed minimum.
    """

    branch: str
    point: tuple[float, float]
    energy: float
    excluded_neighbours: int
    minimum: int | None
    distance: float
    drop: float
    end: str


def grid_points(chart: Landscape) -> list[tuple[int, int, int, int]]:
    """Return (branch, row, column, excluded neighbours) of every grid-local minimum of a chart."""
    found = []
    for b, branch in enumerate(chart.branches):
        padded = np.pad(branch.energy, 1, constant_values=np.nan)
        rows, columns = branch.energy.shape
        around = np.stack(
            [
                padded[1 + dr : 1 + dr + rows, 1 + dc : 1 + dc + columns]
                for dr in (-1, 0, 1)
                for dc in (-1, 0, 1)
                if dr or dc
            ]
        )
        lower = ~(around <= branch.energy)  # comparisons with NaN are false: excluded are ignored
        excluded = np.isnan(around).sum(axis=0)
        candidate = lower.all(axis=0) & ~np.isnan(branch.energy) & (excluded < 8)
        found += [
            (b, int(r), int(c), int(excluded[r, c]))
            for r, c in zip(*np.nonzero(candidate), strict=True)
        ]
    return found


def follow_grid_minima(result: MinimaResult, size: int = 65) -> list[GridMinimum]:
    """Find the grid minima of a scene's landscape and follow each downhill.

    Parameters
    ----------
    result
        The exact minima of the scene.
    size
        Grid points along each coordinate.

    Raises
    ------
    OptionError
        If `size` is no number of grid points.
    """
    chart = landscape(result.scene, size)
    if chart.kind != "area":
        return []
    model = result.model
    exact = [model.reduce(np.array(m.fold_angles)) for m in result.minima]
    out = []
    for b, r, c, excluded in grid_points(chart):
        branch = chart.branches[b]
        start = model.reduce(branch.fold_angles[r, c])
        path = follow(model, start)
        near = [float(np.abs(x - path.end).max()) for x in exact]
        hit = int(np.argmin(near)) if near and min(near) <= ENDPOINT_TOL else None
        out.append(
            GridMinimum(
                branch.name,
                (float(branch.axes[0][c]), float(branch.axes[1][r])),
                float(branch.energy[r, c]),
                excluded,
                None if hit is None else hit + 1,
                float(np.abs(path.end - start).max()),
                -model.energy_change(start, path.end),
                "" if hit is not None else f"{path.what.verdict}: {path.what.reason}",
            )
        )
    return sorted(out, key=lambda g: (g.minimum or 0, g.energy))
