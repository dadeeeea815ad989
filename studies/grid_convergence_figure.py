"""The figure of grid convergence: errors in energy and place against the cell, and how many grid minima are false."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullLocator
from rich.console import Console

from origami_nlp.display import Table, short_label
from studies.grid_convergence import REACH, GridCount, GridErrors

LOOK: dict[str, tuple[str, str, str]] = {
    "interior": ("#0072B2", "o", "interior"),
    "contact": ("#D55E00", "s", "at a contact"),
    "family": ("#009E73", "^", "at a chart point with a family"),
}
"""Colour, marker and name of each sort of minimum."""
GUIDES = {
    "energy": ((2.0, "$h^2$", 0.35), (1.0, "$h$", 0.6)),
    "distance": ((1.0, "$h$", 0.45), (0.5, "$h^{1/2}$", 0.9)),
}
"""Guide lines: order, name, and height at the largest cell."""


def draw_grid_convergence(
    errors: tuple[GridErrors, ...], counts: dict[str, tuple[GridCount, ...]]
) -> Figure:
    """Draw the errors of all minima that a grid can see, and the counts of several sets of scenes by name."""
    figure = Figure(figsize=(10.6, 3.75), dpi=150, facecolor="white")
    left, middle, right = figure.subplots(1, 3)
    _errors(left, errors, "energy", "largest error of the energy  [J]")
    _errors(middle, errors, "distance", "largest error of the place  [rad]")
    seen = [sort for sort in LOOK if any(e.sort == sort for e in errors)]
    samples = [
        Line2D([], [], color=LOOK[s][0], marker=LOOK[s][1], ms=4, label=LOOK[s][2]) for s in seen
    ]
    left.legend(handles=samples, fontsize=6.5, loc="lower right", framealpha=0.9)
    _counts(right, counts)
    for letter, axes in zip("abc", (left, middle, right), strict=True):
        axes.set_title(f"({letter})", loc="left", fontsize=9, weight="bold")
    figure.tight_layout(w_pad=2.0)
    return figure


def _errors(axes: Any, errors: tuple[GridErrors, ...], what: str, label: str) -> None:
    for error in errors:
        if error.sort not in LOOK:
            continue
        colour, marker, _ = LOOK[error.sort]
        worst = error.worst(what)
        worst = np.where(worst > 0, worst, np.nan)
        axes.plot(error.cell, worst, color=colour, marker=marker, ms=2.8, lw=0.9, alpha=0.75)
    axes.set(xscale="log", yscale="log", ylabel=label, xlabel="cell h  [rad]")
    cells = errors[0].cell
    low, high = axes.get_ylim()
    for order, name, height in GUIDES[what]:
        top = high * height
        line = top * (cells / cells.max()) ** order
        axes.plot(cells, line, color="black", lw=1.0, ls=(0, (4, 2)), zorder=1)
        axes.annotate(
            name,
            (cells[-1], line[-1]),
            xytext=(-3, 0),
            textcoords="offset points",
            ha="right",
            fontsize=9,
            va="center",
        )
    axes.set_ylim(low / 12 if what == "energy" else low, high if what == "energy" else 1.25 * high)
    if what == "distance":
        axes.axhline(REACH, color="#999999", lw=0.8, ls=":")
        axes.annotate(
            "not found nearer",
            (cells[len(cells) // 2], REACH),
            xytext=(0, 3),
            textcoords="offset points",
            fontsize=6.5,
            ha="center",
            va="bottom",
        )
    axes.set_xlim(cells.min() / 1.75, cells.max() * 1.12)
    axes.set_xticks(cells, [f"2π/{round(2 * np.pi / c)}" for c in cells], fontsize=6.5)
    axes.xaxis.set_minor_locator(NullLocator())
    axes.tick_params(axis="y", labelsize=7)
    axes.grid(color="#E3E3E3", lw=0.5)


def _counts(axes: Any, counts: dict[str, tuple[GridCount, ...]]) -> None:
    colours = ("#0072B2", "#D55E00", "#009E73")
    for colour, (name, rows) in zip(colours, counts.items(), strict=False):
        sizes = sorted({row.size for row in rows})
        false = [sum(row.false for row in rows if row.size == n) for n in sizes]
        claimed = [sum(row.claimed for row in rows if row.size == n) for n in sizes]
        exact = sum(row.exact for row in rows if row.size == sizes[0])
        axes.plot(sizes, false, color=colour, marker="o", ms=4, label=f"{name}: false")
        axes.plot(
            sizes,
            claimed,
            color=colour,
            marker="s",
            ms=4,
            ls=":",
            mfc="w",
            label="nearest to an exact one",
        )
        axes.axhline(exact, color=colour, lw=0.8, ls=(0, (5, 2, 1, 2)), label=f"exact: {exact}")
    axes.set(xscale="log", yscale="log", xlabel="cells along each coordinate", ylabel="grid minima")
    axes.set_xticks(sizes, [str(n) for n in sizes], fontsize=7)
    axes.xaxis.set_minor_locator(NullLocator())
    axes.tick_params(axis="y", labelsize=7)
    axes.legend(fontsize=6.5, loc="upper left", framealpha=0.9)
    axes.grid(color="#E3E3E3", lw=0.5)


def print_convergence(
    errors: Iterable[GridErrors], counts: dict[str, tuple[GridCount, ...]], console: Console
) -> None:
    """Print orders and finest errors of every minimum, and the counts of grid minima by size."""
    heads = (
        "scene",
        "#",
        "sort",
        "energy",
        "place",
        "state",
        "finest dU [J]",
        "finest place [rad]",
    )
    cells = []
    for e in errors:
        orders = [e.order(what) for what in ("energy", "distance", "state")]
        finest = [e.worst(what)[-1] for what in ("energy", "distance")]
        cells.append(
            (
                short_label(e.scene),
                str(e.number),
                e.sort,
                *("-" if np.isnan(v) else f"{v:.2f}" for v in orders),
                *("-" if np.isnan(v) or e.sort == "handle" else f"{v:.1e}" for v in finest),
            )
        )
    console.print(Table(heads, cells, "order of the largest error over shifted grids", "lrlrrrrr"))
    for name, rows in counts.items():
        for size in sorted({row.size for row in rows}):
            here = [row for row in rows if row.size == size]
            console.print(
                f"{name}, {size}^2: {sum(r.found for r in here)} grid minima, {sum(r.claimed for r in here)} nearest "
                f"to one of {sum(r.exact for r in here)} exact, {sum(r.false for r in here)} false",
                highlight=False,
                soft_wrap=True,
            )
