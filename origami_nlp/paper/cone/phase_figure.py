"""Phase diagrams of cones drawn: a map of numbers of branch minima, and labelled boundaries beside it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator

from origami_nlp.arguments import check_type
from origami_nlp.display import INKS, pi_label
from origami_nlp.paper.cone.classes import EnergyClass
from origami_nlp.paper.cone.energy import class_energy
from origami_nlp.paper.cone.phase import PhaseDiagram
from origami_nlp.paper.cone.phase_curves import PhaseBoundary

STYLES = {"start": "-", "end": "--", "fold": ":", "depth": "-", "depth-at-end": "-."}
WORDS = {
    "start": "slope at the flat state",
    "end": "slope at the end (minimum inside / at the end)",
    "fold": "fold: minimum meets maximum",
    "depth": "depth threshold",
    "depth-at-end": "depth threshold, at the end",
}
NEAREST_LABELS = 0.045
"""Labels are at least this far apart (share of the axes' height)."""
WIDE = 0.42
"""How much of a distance along the width counts for that of labels, which are wider than high."""
RIGHT_EDGE = 0.93
"""Labels of curves beyond this share of the width stand on their left."""
MOST_TICKS = 12
"""Numbers named beside a map; more are thinned out."""


def angle_axis(axis: Any, low: float, high: float) -> None:
    """Ticks at multiples of pi."""
    span = (high - low) / math.pi
    step = next(
        s for s in (1 / 4, 1 / 6, 1 / 12, 1 / 24, 1 / 48, 1 / 96) if span / s >= 3 or s == 1 / 96
    )
    axis.set_major_locator(MultipleLocator(step * math.pi))
    axis.set_major_formatter(FuncFormatter(_multiple_of_pi))


def _multiple_of_pi(x: float, _: int) -> str:
    return pi_label(*Fraction(x / math.pi).limit_denominator(96).as_integer_ratio())


def draw_map(
    axes: Any,
    nu: np.ndarray,
    ratios: np.ndarray,
    counts: np.ndarray,
    branches: int,
    *,
    title: str = "",
    boundaries: Sequence[PhaseBoundary] = (),
) -> None:
    """Draw numbers of branch minima as a map with one colour for each number that occurs, and exact borders.

    Parameters
    ----------
    axes
        Of matplotlib.
    nu, ratios
        Cell centres, evenly [rad] and geometrically spaced.
    counts
        Shape [ratios, nu].
    branches
        Number of all branches.
    title
        Of the map.
    boundaries
        Of `phase_boundaries`: those where the number changes, drawn over the cells.
    """
    numbers = sorted({int(x) for x in np.unique(counts)})
    shown = np.searchsorted(np.array(numbers, dtype=object), counts).astype(float)
    from matplotlib import colormaps

    shades = colormaps["viridis"](np.linspace(0.12, 1.0, len(numbers)))
    colours = ListedColormap(shades if len(numbers) > 1 else ["#9fb8c8"])
    norm = BoundaryNorm(np.arange(len(numbers) + 1) - 0.5, len(numbers))
    step = (ratios[1] / ratios[0]) ** 0.5
    x = np.concatenate([nu - (nu[1] - nu[0]) / 2, [nu[-1] + (nu[1] - nu[0]) / 2]])
    y = np.concatenate([ratios / step, [ratios[-1] * step]])
    image = axes.pcolormesh(x, y, shown, cmap=colours, norm=norm, rasterized=True)
    for curve in boundaries:
        axes.plot(curve.rest_elevation, curve.ratio, color="black", linewidth=1.2)
    frame(axes, (x[0], x[-1]), (y[0], y[-1]))
    if title:
        axes.set_title(title, fontsize=9)
    _bar(axes, image, numbers, branches)


def _bar(axes: Any, image: Any, numbers: Sequence[int], branches: int) -> None:
    skip = -(-len(numbers) // MOST_TICKS)
    ticks = list(range(len(numbers) - 1, -1, -skip))[::-1]
    bar = axes.figure.colorbar(image, ax=axes, ticks=ticks, pad=0.02, fraction=0.06, aspect=30)
    short = len(str(branches)) <= 6
    names = [f"{numbers[k]}/{branches}" if short else f"{numbers[k] / branches:.4g}" for k in ticks]
    bar.ax.set_yticklabels(names, fontsize=8)
    bar.ax.tick_params(length=0)
    bar.outline.set_linewidth(0.5)


def frame(axes: Any, nu: tuple[float, float], ratio: tuple[float, float]) -> None:
    """Limits, log axis and names of the axes of a phase diagram."""
    axes.set_yscale("log")
    axes.set_xlim(*nu)
    axes.set_ylim(*ratio)
    angle_axis(axes.xaxis, *nu)
    axes.set_xlabel(r"rest elevation $\upsilon_0$ [rad]", fontsize=9)
    axes.set_ylabel(r"$r_k = k_\mathrm{even}/k_\mathrm{odd}$", fontsize=9)
    axes.tick_params(labelsize=8)


def ink(branches: EnergyClass) -> str:
    """Colour of a class: by its number of valley flaps."""
    return INKS[branches.mountains % len(INKS)]


def draw_boundaries(
    axes: Any,
    boundaries: Sequence[PhaseBoundary],
    nu: tuple[float, float],
    ratio: tuple[float, float],
) -> None:
    """Draw boundaries with labels on the side where the branch has a minimum.

    At a curve of kind "end" the label stands where the minimum is inside the branch.

    Parameters
    ----------
    axes
        Of matplotlib.
    boundaries
        Of `phase_boundaries`.
    nu, ratio
        Ends of the axes: rest elevation [rad] and stiffness ratio.
    """
    drawn: set[tuple[object, ...]] = set()
    seen: set[tuple[object, ...]] = set()  # where two curves are one, both colours show
    texts: list[tuple[PhaseBoundary, np.ndarray, np.ndarray]] = []
    for curve in boundaries:
        key = _same_curve(curve)
        if key in drawn:
            continue
        drawn.add(key)
        x, y = curve.rest_elevation, curve.ratio
        look = {"color": ink(curve.branches), "lw": 1.5, "label": WORDS[curve.kind]}
        axes.plot(x, y, **look, ls=(0, (5, 5)) if key[3:] in seen else STYLES[curve.kind])
        seen.add(key[3:])
        texts.append((curve, x, y))
    frame(axes, nu, ratio)
    _place_labels(axes, texts, nu, ratio)


def _same_curve(curve: PhaseBoundary) -> tuple[object, ...]:
    """Start curves do not depend on the number of changes: one line stands for all of them."""
    b = curve.branches
    changes = None if curve.kind == "start" else b.changes
    middle = len(curve.ratio) // 2
    where = (round(float(curve.rest_elevation[middle]), 6), float(f"{curve.ratio[middle]:.5g}"))
    return (b.valleys, changes, b.direction, curve.kind, where)


def start_label(branches: EnergyClass) -> str:
    """Label of a start curve, which all arrangements of the same numbers of flaps share."""
    return replace(branches, changes=min(branches.changes, 2)).label


def _place_labels(
    axes: Any,
    curves: Sequence[tuple[PhaseBoundary, np.ndarray, np.ndarray]],
    nu: tuple[float, float],
    ratio: tuple[float, float],
) -> None:
    """Put each label on the side of its curve with the minimum, as far from other labels as the curve allows."""
    placed: list[np.ndarray] = []

    def unit(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        u = (x - nu[0]) / (nu[1] - nu[0])
        v = np.log(y / ratio[0]) / math.log(ratio[1] / ratio[0])
        return np.stack([u, v], axis=-1)

    every = [unit(x, y) for _, x, y in curves]
    for own, (curve, _, _) in enumerate(curves):
        points = every[own]
        good = ((points > [0.08, 0.04]) & (points < [0.96, 0.97])).all(axis=1)
        if good.sum() < 5:
            continue
        at = np.flatnonzero(good)
        at = at[:: max(1, len(at) // 60)]
        side = _side_of_minimum(curve)
        # at an end curve the branch has a minimum on both sides: its label stands on the line
        offset = points[at] + np.array([0.0, 0.034 * side * (curve.kind != "end")])
        room = np.full(len(at), 1.0)
        for other in placed:
            apart = np.hypot(*((offset - other) * np.array([WIDE, 1.0])).T)
            room = np.where(apart < NEAREST_LABELS, 0.0, np.minimum(room, apart))
        for k, line in enumerate(every):
            if k != own and len(line):
                gap = np.abs(offset[:, None, :] - line[None, :: max(1, len(line) // 80), :])
                room = np.minimum(room, 1.5 * np.hypot(gap[..., 0] * 0.6, gap[..., 1]).min(axis=1))
        best = int(room.argmax())
        if room[best] < 0.008:
            continue
        placed.append(offset[best])
        text = start_label(curve.branches) if curve.kind == "start" else curve.label
        axes.text(
            nu[0] + offset[best][0] * (nu[1] - nu[0]),
            ratio[0] * (ratio[1] / ratio[0]) ** offset[best][1],
            text,
            fontsize=7.5,
            color=ink(curve.branches),
            ha="right" if offset[best][0] > RIGHT_EDGE else "center",  # the frame stays free
            va="center",
            bbox={"fc": "white", "ec": "none", "pad": 0.6} if curve.kind == "end" else None,
            zorder=3 if curve.kind == "end" else 4,
        )


def _side_of_minimum(curve: PhaseBoundary) -> float:
    """+1 where the branch has a minimum (at its end: inside) above the curve, else -1."""
    middle = len(curve.ratio) // 2
    nu, t = curve.rest_elevation[middle], curve.elevation[middle]
    energy = class_energy(curve.branches, t, nu)
    if curve.kind in ("start", "end"):
        falls = float(energy.slopes[1]) < 0  # with larger r the energy falls more steeply
        return 1.0 if falls == (curve.kind == "start") else -1.0
    slope_of_well = float(energy.wells[1])
    return 1.0 if slope_of_well > 0 else -1.0


def legend(axes: Any) -> None:
    """Write one entry for each kind of curve, below the axes, where no curve is hidden.

    Parameters
    ----------
    axes
        With curves of `draw_boundaries`.
    """
    from matplotlib.lines import Line2D

    names = dict.fromkeys(line.get_label() for line in axes.get_lines())
    kinds = [k for k in STYLES if WORDS[k] in names]
    handles = [Line2D([], [], color="#444444", ls=STYLES[k], lw=1.2) for k in kinds]
    if handles:
        words = [WORDS[k] for k in kinds]
        place = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.13), "ncols": 1}
        axes.legend(handles, words, fontsize=8, frameon=False, **place)


def draw_phase(diagram: PhaseDiagram) -> Figure:
    """Draw a phase diagram: numbers of branch minima, how many are at an end, and the boundaries.

    Parameters
    ----------
    diagram
        Of `phase_diagram`.

    Returns
    -------
    matplotlib.figure.Figure
        Two or three panels.

    Raises
    ------
    OptionError
        If `diagram` is not of its type.
    """
    check_type("diagram", diagram, PhaseDiagram)
    counts = diagram.map
    words = "branch minima" if diagram.contact else "minima inside their branch"
    if counts.depth > 0:
        words += f", deeper than {counts.depth:g}"
    one = len(diagram.numbers) == 1  # nothing to draw: the title says it
    panels = 1 + diagram.contact + (not one)
    figure = Figure(figsize=(max(6.0, 4.1 * panels), 4.5), layout="constrained", dpi=110)
    grid = list(figure.subplots(1, panels, squeeze=False)[0])
    x, y = counts.elevations, counts.ratios
    if not one:
        of = diagram.bounding("all" if diagram.contact else "interior")
        draw_map(grid[0], x, y, diagram.minima, counts.branches, title=words, boundaries=of)
    if diagram.contact:
        title = end_words(counts.cone.end)
        of = diagram.bounding("at end")
        draw_map(grid[-2], x, y, counts.at_end, counts.branches, title=title, boundaries=of)
    window = ((float(x[0]), float(x[-1])), (float(y[0]), float(y[-1])))
    if panels > 1:
        window = (grid[0].get_xlim(), grid[0].get_ylim())
    draw_boundaries(grid[-1], diagram.boundaries, *window)
    grid[-1].set_title("boundaries, labels on the side of the minimum", fontsize=9)
    legend(grid[-1])
    only = f": {diagram.numbers[0]} {words} everywhere" if one else ""
    who = f"cone of degree {diagram.degree}, {counts.branches} branches, rest state {counts.cone.rest}"
    figure.suptitle(who + only, fontsize=11, weight="bold")
    return figure


def end_words(rule: str) -> str:
    """Describe what holds minima at the end of a branch."""
    return (
        "of these pinned by contact" if rule == "contact" else "of these at an end (contact or cut)"
    )
