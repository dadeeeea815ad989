"""Phase diagrams of cones drawn: maps of numbers of branch minima, and the boundaries of every class beside them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.arguments import check_type
from origami_nlp.display import INKS, angle_ticks
from origami_nlp.paper.cone.phase import PhaseDiagram
from origami_nlp.paper.cone.phase_curves import PhaseBoundary

STYLES: dict[str, tuple[Any, str]] = {
    "start": ("-", "slope at the flat state"),
    "end": ("--", "slope at the end (minimum inside / at the end)"),
    "fold": (":", "fold: minimum meets maximum"),
}
"""Of boundaries, by kind: the line, and what it means."""
MOST_TICKS = 12
"""Numbers named beside a map; more are thinned out."""


def draw_phase(diagram: PhaseDiagram) -> Figure:
    """Draw a phase diagram: numbers of branch minima, how many are at an end, and the boundaries.

    Parameters
    ----------
    diagram
        Of `phase_diagram`.

    Returns
    -------
    matplotlib.figure.Figure
        Three panels.

    Raises
    ------
    OptionError
        If `diagram` is not of its type.
    """
    check_type("diagram", diagram, PhaseDiagram)
    counts = diagram.map
    held = "pinned by contact" if counts.cone.end == "contact" else "at an end (contact or cut)"
    # numbers, and the kinds of boundaries at which they change
    maps = [
        ("branch minima", counts.total, ("start", "fold")),
        (f"of these {held}", counts.at_end, ("end",)),
    ]
    figure = Figure(figsize=(12.3, 4.5), layout="constrained", dpi=110)
    *grid, last = figure.subplots(1, 3)
    for axes, (title, numbers, kinds) in zip(grid, maps, strict=True):
        own = [b for b in diagram.boundaries if b.kind in kinds]
        _draw_map(axes, diagram, numbers, own)
        axes.set_title(title, fontsize=9)
    _draw_boundaries(last, diagram.boundaries)
    for axes in (*grid, last):
        axes.set(yscale="log", xlim=grid[0].get_xlim(), ylim=grid[0].get_ylim())
        angle_ticks(axes.xaxis, *axes.get_xlim())
        axes.set_xlabel(r"rest elevation $\upsilon_0$", fontsize=9)
        axes.set_ylabel(r"$r_k = k_\mathrm{even}/k_\mathrm{odd}$", fontsize=9)
        axes.tick_params(labelsize=8)
    of = counts.cone
    who = f"cone of degree {of.degree}, {of.branches} branches, rest state {of.rest}"
    figure.suptitle(who, fontsize=11, weight="bold")
    return figure


def _edges(values: np.ndarray) -> np.ndarray:
    """Ends of cells, given their evenly spaced middles."""
    half = (values[1] - values[0]) / 2
    return np.append(values - half, values[-1] + half)


def _draw_map(
    axes: Any, diagram: PhaseDiagram, counts: np.ndarray, boundaries: Sequence[PhaseBoundary]
) -> None:
    """Draw numbers as a map with one colour for each that occurs, and exact borders."""
    numbers = sorted({int(x) for x in np.unique(counts)})
    shown = np.searchsorted(np.array(numbers, dtype=object), counts).astype(float)
    colours = ListedColormap(colormaps["viridis"](np.linspace(0.12, 1.0, len(numbers))))
    norm = BoundaryNorm(np.arange(len(numbers) + 1) - 0.5, len(numbers))
    x, y = _edges(diagram.map.elevations), np.exp(_edges(np.log(diagram.map.ratios)))
    image = axes.pcolormesh(x, y, shown, cmap=colours, norm=norm, rasterized=True)
    for curve in boundaries:
        axes.plot(curve.rest_elevation, curve.ratio, color="black", linewidth=1.2)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    ticks = range(len(numbers))[:: -(-len(numbers) // MOST_TICKS)]
    bar = axes.figure.colorbar(image, ax=axes, ticks=ticks, pad=0.02, fraction=0.06, aspect=30)
    total = diagram.map.cone.branches
    short = len(str(total)) <= 6
    names = [f"{numbers[k]}/{total}" if short else f"{numbers[k] / total:.4g}" for k in ticks]
    bar.ax.set_yticklabels(names, fontsize=8)


def _draw_boundaries(axes: Any, boundaries: Sequence[PhaseBoundary]) -> None:
    """Draw boundaries: the line says the kind, the colour how many flaps are mountains."""
    used: dict[int, str] = {}
    for curve in boundaries:
        mountains = int(curve.branches.mountains[0])
        used[mountains] = INKS[mountains % len(INKS)]
        look = {"color": used[mountains], "linestyle": STYLES[curve.kind][0]}
        axes.plot(curve.rest_elevation, curve.ratio, **look, linewidth=1.4)
    kinds = {curve.kind for curve in boundaries}
    entries = [
        Line2D([], [], color="#444444", linestyle=line, label=words)
        for kind, (line, words) in STYLES.items()
        if kind in kinds
    ]
    entries += [Line2D([], [], color=used[m], label=f"mountain flaps: {m}") for m in sorted(used)]
    place = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.13), "ncols": 2}
    axes.legend(handles=entries, fontsize=7, frameon=False, **place)
    axes.set_title("boundaries of every class of branches", fontsize=9)
