"""Phase diagrams of cones drawn: maps of numbers of branch minima, with their exact boundaries."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from origami_nlp.arguments import check_type
from origami_nlp.display import angle_ticks
from origami_nlp.paper.cone.phase import PhaseDiagram

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
        Two panels: all minima, and those at an end.

    Raises
    ------
    OptionError
        If `diagram` is not of its type.
    """
    check_type("diagram", diagram, PhaseDiagram)
    counts, cone = diagram.map, diagram.map.cone
    held = "pinned by contact" if cone.end == "contact" else "at an end (contact or cut)"
    figure = Figure(figsize=(8.4, 4.5), layout="constrained", dpi=110)
    every, pinned = figure.subplots(1, 2, sharex=True, sharey=True)
    # numbers, and the kinds of boundaries at which they change
    _draw_map(every, diagram, counts.total, ("start", "fold"))
    _draw_map(pinned, diagram, counts.at_end, ("end",))
    titles = ("branch minima", f"of these {held}")
    for axes, title in zip((every, pinned), titles, strict=True):
        axes.set_title(title, fontsize=9)
        axes.set_xlabel(r"rest elevation $\upsilon_0$", fontsize=9)
        axes.tick_params(labelsize=8, labelleft=True)
    every.set_ylabel(r"$r_k = k_\mathrm{even}/k_\mathrm{odd}$", fontsize=9)
    every.set_yscale("log")
    angle_ticks(every.xaxis, *every.get_xlim())
    who = f"cone of degree {cone.degree}, {cone.branches} branches, rest state {cone.rest}"
    figure.suptitle(who, fontsize=11, weight="bold")
    return figure


def _edges(values: np.ndarray) -> np.ndarray:
    """Ends of cells, given their evenly spaced middles."""
    half = (values[1] - values[0]) / 2
    return np.append(values - half, values[-1] + half)


def _draw_map(axes: Any, diagram: PhaseDiagram, counts: np.ndarray, kinds: tuple[str, ...]) -> None:
    """Draw numbers as a map with one colour for each that occurs, and exact borders."""
    numbers, total = sorted(set(counts.ravel().tolist())), diagram.map.cone.branches
    place = np.searchsorted(np.array(numbers, dtype=object), counts).astype(float)
    colours = ListedColormap(colormaps["viridis"](np.linspace(0.12, 1.0, len(numbers))))
    norm = BoundaryNorm(np.arange(len(numbers) + 1) - 0.5, len(numbers))
    x, y = _edges(diagram.map.elevations), np.exp(_edges(np.log(diagram.map.ratios)))
    image = axes.pcolormesh(x, y, place, cmap=colours, norm=norm, rasterized=True)
    for curve in diagram.boundaries:
        if curve.kind in kinds:
            axes.plot(curve.rest_elevation, curve.ratio, color="black", linewidth=1.2)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    ticks = range(len(numbers))[:: -(-len(numbers) // MOST_TICKS)]
    bar = axes.figure.colorbar(image, ax=axes, ticks=ticks, pad=0.02, fraction=0.06, aspect=30)
    names = [
        f"{numbers[k]}/{total}" if total < 10**6 else f"{numbers[k] / total:.4g}" for k in ticks
    ]
    bar.ax.set_yticklabels(names, fontsize=8)
