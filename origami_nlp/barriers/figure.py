"""The disconnectivity graph (merge tree) of minima: leaves at their energies, joined at the passes between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.barriers.result import Barriers, Join

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STAR = 13.0
"""Size of a star [points]."""


def draw_barriers(barriers: Barriers) -> Figure:
    """Draw the disconnectivity graph (merge tree) of minima and passes.

    Parameters
    ----------
    barriers
        Of `find_barriers`.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Raises
    ------
    OptionError
        If `barriers` are none of `find_barriers`.
    """
    from matplotlib.figure import Figure

    from origami_nlp.display import label_text, minima_legend, passes_legend
    from origami_nlp.minima import judged

    check_type("barriers", barriers, Barriers)
    result = barriers.result
    width = max(5.2, min(0.13 * len(result.minima) + 2, 24.0))
    figure = Figure(figsize=(width, 3.7), dpi=110, layout="constrained")
    ax = figure.add_subplot()
    ax.set_title(label_text(barriers.label), fontsize=9.5)
    found = [(m.kind, judged(result.origami, m)) for m in result.minima]
    if not found:
        ax.axis("off")
        ax.text(0.5, 0.5, "no minimum is known", transform=ax.transAxes, ha="center", fontsize=9)
        return figure
    _draw_tree(ax, barriers, found)
    handles = minima_legend(found, STAR, result.origami.is_symmetric)
    handles += passes_legend((j.pass_kind for j in barriers.merges), STAR)
    look: dict[str, Any] = {"loc": "outside lower center", "fontsize": 9, "frameon": False}
    figure.legend(handles=handles, ncols=min(len(handles), 2), **look)
    return figure


def _draw_tree(ax: Axes, barriers: Barriers, looks: Sequence[tuple[str, str | None]]) -> None:
    """Draw the merge tree of minima of some kinds and verdicts."""
    from origami_nlp.display import INK, mark_minimum, pass_look

    minima = barriers.result.minima
    # with more minima marks are smaller, and only numbers are written
    few = len(minima) <= 12
    star = STAR if few else 0.6 * STAR

    def label(text: str, at: Any, off: Any, ha: str, va: str, size: float) -> None:
        look: dict[str, Any] = {"ha": ha, "va": va, "fontsize": size, "gid": "label"}
        ax.annotate(text, at, off, textcoords="offset points", **look)

    order = leaf_order(len(minima), barriers.merges)
    place = {k: float(i) for i, k in enumerate(order)}
    # where the branch of each leaf ends so far, and the height at which it was labelled
    ends = {k: (place[k], m.energy) for k, m in enumerate(minima, start=1)}
    written: dict[int, str] = {}
    for join in barriers.merges:
        (x, low), (y, high) = ends[join.first[0]], ends[join.second[0]]
        ax.plot([x, x, y, y], [low, join.energy, join.energy, high], color=INK, lw=1.2, zorder=1)
        # above the middle of its leaves: passes of one height do not come to lie on a leaf
        leaves = (*join.first, *join.second)
        middle, text = float(np.mean([place[leaf] for leaf in leaves])), f"{join.energy:.4g}"
        look = pass_look(join.pass_kind, star)
        ax.plot(middle, join.energy, **look, zorder=3, gid="mark")
        if few and text not in {written.get(leaf) for leaf in leaves}:
            whole = len(leaves) == len(minima)  # else beside the branch that goes on upwards
            off, side = ((0, 7), "center") if whole else ((-6, 4), "right")
            label(text, (middle, join.energy), off, side, "bottom", 8.5)
        written |= dict.fromkeys(leaves, text)
        ends |= dict.fromkeys(leaves, (middle, join.energy))
    for k, (m, how) in enumerate(zip(minima, looks, strict=True), start=1):
        mark_minimum(ax, (place[k], m.energy), *how, star)
        text, size = (f"#{k}\n{m.energy:.4g}", 8.5) if few else (f"{k}", 6.5)
        label(text, (place[k], m.energy), (0, -8 if few else -5), "center", "top", size)
    reach = [*(m.energy for m in minima), *(j.energy for j in barriers.merges)]
    low, high = min(reach), max(reach)
    span = high - low or 1.0
    ax.set(xlim=(-0.6, len(minima) - 0.4), xticks=[])
    ax.set_ylim(low - (0.28 if few else 0.08) * span, high + 0.18 * span)
    ax.set_yticks([y for y in ax.get_yticks() if 0 <= y <= high + 0.1 * span])
    ax.spines[["top", "right", "bottom"]].set_visible(False)
    ax.tick_params(labelsize=8)
    ax.set_ylabel("energy [J]")


def leaf_order(count: int, merges: tuple[Join, ...]) -> list[int]:
    """Order leaves 1..count so that no branches cross; components that never merge stand side by side."""
    groups = {k: [k] for k in range(1, count + 1)}
    for join in merges:
        whole = groups[join.first[0]] + groups[join.second[0]]
        groups |= dict.fromkeys(whole, whole)
    return list(dict.fromkeys(leaf for k in range(1, count + 1) for leaf in groups[k]))
