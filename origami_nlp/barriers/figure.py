"""The merge tree of a scene's minima as a figure: leaves at their energies, joined at the passes between them."""

from __future__ import annotations

import math
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.barriers.result import Barriers, Join
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STABLE, UNSTABLE, UNJUDGED, INK = "#c8960c", "#b2182b", "#7a7a7a", "#222222"
"""Leaves: stable and unstable in the full space, not judged there; and lines."""
PASS_MARK = {
    "saddle": "X",
    "contact saddle": "P",
    "corner": "v",
    "flat state": "s",
    "singular": "D",
    "mesh": "o",
}
PASS_COLOUR = "#2166ac"


def draw_barriers(
    *several: Barriers, path: str | PathLike[str] | None = None, columns: int = 3
) -> Figure:
    """Draw the merge tree of each scene, row by row; the figure is saved if a path is given.

    Raises
    ------
    OptionError
        If there is nothing to draw, or the file cannot be written.
    """
    if not several:
        raise OptionError("several = () must be at least one result of find_barriers")

    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from origami_nlp.files import save_figure

    columns = min(columns, len(several))
    rows = math.ceil(len(several) / columns)
    figure = Figure(figsize=(3.3 * columns + 0.3, 2.7 * rows + 0.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, squeeze=False)
    kinds: set[str] = set()
    leaves: set[str] = set()
    for k, ax in enumerate(axes.flat):
        if k >= len(several):
            ax.axis("off")
            continue
        leaves |= merge_tree_axes(ax, several[k])
        kinds |= {j.pass_kind for j in several[k].merges}
        if k % columns == 0:
            ax.set_ylabel("energy [J]")
    words = {STABLE: "stable", UNSTABLE: "unstable in the full space", UNJUDGED: "minimum"}
    handles = [
        Line2D([], [], marker="o", ls="", color=c, markeredgecolor=INK, label=words[c])
        for c in (STABLE, UNSTABLE, UNJUDGED)
        if c in leaves
    ]
    handles += [
        Line2D([], [], marker=mark, ls="", color=PASS_COLOUR, markeredgecolor=INK, label=kind)
        for kind, mark in PASS_MARK.items()
        if kind in kinds
    ]
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=min(len(handles), 2 * columns),
        fontsize=8,
    )
    if path is not None:
        save_figure(figure, path, 200)
    return figure


def merge_tree_axes(ax: Axes, barriers: Barriers) -> set[str]:
    """Draw the merge tree of one scene; return the colours of its leaves.

    Raises
    ------
    OptionError
        If `ax` are no axes of matplotlib, or `barriers` none of `find_barriers`.
    """
    from matplotlib.axes import Axes

    check_type("ax", ax, Axes)
    check_type("barriers", barriers, Barriers)
    minima = barriers.result.minima
    place = {k: float(i) for i, k in enumerate(leaf_order(len(minima), barriers.merges))}
    colours = set()
    top = {k + 1: m.energy for k, m in enumerate(minima)}
    branch: dict[int, tuple[int, ...]] = {k + 1: (k + 1,) for k in range(len(minima))}
    at = dict(place)
    reach = [m.energy for m in minima] + [j.energy for j in barriers.merges]
    span = max(reach) - min(reach) or 1.0
    for join in barriers.merges:
        one, two = join.first[0], join.second[0]
        x, y = at[one], at[two]
        for leaf, where in ((one, x), (two, y)):
            ax.plot([where, where], [top[leaf], join.energy], color=INK, lw=1.2)
        ax.plot([x, y], [join.energy] * 2, color=INK, lw=1.2)
        # above the middle of its leaves: passes of one height do not come to lie on a leaf
        middle = float(np.mean([place[leaf] for leaf in (*branch[one], *branch[two])]))
        mark = PASS_MARK.get(join.pass_kind, "o")
        ax.plot(middle, join.energy, mark, color=PASS_COLOUR, mec=INK, mew=0.6, ms=6, zorder=3)
        last = len(join.first) + len(join.second) == len(minima)
        ax.annotate(
            f"{join.energy:.4g}",
            (middle, join.energy),
            (0, 6) if last else (-5, 4),  # beside the branch that goes on upwards
            textcoords="offset points",
            ha="center" if last else "right",
            va="bottom",
            fontsize=7.5,
        )
        for leaf in (*branch[one], *branch[two]):
            at[leaf], top[leaf] = middle, join.energy
            branch[leaf] = (*branch[one], *branch[two])
    for k, m in enumerate(minima, start=1):
        verdict = m.full_space.verdict if m.full_space else None
        colour = {"stable": STABLE, "unstable": UNSTABLE}.get(str(verdict), UNJUDGED)
        colours.add(colour)
        ax.plot(place[k], m.energy, "o", color=colour, mec=INK, mew=0.6, ms=6, zorder=3)
        ax.annotate(
            f"#{k}\n{m.energy:.4g}",
            (place[k], m.energy),
            (0, -6),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=7.5,
        )
    ax.set_xlim(-0.6, len(minima) - 0.4)
    ax.set_ylim(min(reach) - 0.24 * span, max(reach) + 0.16 * span)
    ax.set_xticks([])
    ax.set_yticks([y for y in ax.get_yticks() if 0 <= y <= max(reach) + 0.1 * span])
    ax.spines[["top", "right", "bottom"]].set_visible(False)
    ax.tick_params(labelsize=8)
    title = barriers.scene.label.replace("alpha_1", r"$\alpha_1$").replace("r_k", "$r_k$")
    ax.set_title(title.replace("pi", r"$\pi$").replace("*", ""), fontsize=8.5)
    return colours


def leaf_order(count: int, merges: tuple[Join, ...]) -> list[int]:
    """Order leaves 1..count so that no branches cross; components that never merge stand side by side."""
    groups = {k: [k] for k in range(1, count + 1)}
    for join in merges:
        one, two = groups[join.first[0]], groups[join.second[0]]
        whole = one + two
        for leaf in whole:
            groups[leaf] = whole
    out: list[int] = []
    for k in range(1, count + 1):
        out += [leaf for leaf in groups[k] if leaf not in out]
    return out
