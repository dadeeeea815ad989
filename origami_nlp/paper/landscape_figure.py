"""The figure of one landscape: exact boundaries and minima, metastable stretches, and passes if they are known.

Marks and colours are those of `display.style`; red lines: metastable stretches; dashed: 1-handles, on which states
exist only at phi = +-pi exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.arguments import check_type
from origami_nlp.chart import (
    area_legend,
    colour_bar,
    draw_area,
    norm_of,
)
from origami_nlp.display import (
    MARGIN,
    METASTABLE,
    RING,
    StackedFigure,
    label_text,
)
from origami_nlp.errors import OptionError
from origami_nlp.minima import drawn_minima, mark_minima, marks_legend
from origami_nlp.paper.landscape import ExactLandscape

STAR, LINE, TEXT = 16.0, 1.2, 10.5
"""Sizes of markers, boundaries and letters [points]."""
SIDE, LEFT, RIGHT, BELOW = 4.6, 0.7, 0.85, 0.45
"""Of a panel, and what is around it [in]."""


def draw_landscape(exact: ExactLandscape) -> Figure:
    """Draw a landscape.

    Parameters
    ----------
    exact
        Of `find_landscape`.

    Returns
    -------
    matplotlib.figure.Figure
        One panel, or one a branch of the chart.

    Raises
    ------
    OptionError
        If the scene has no landscape over two coordinates, or `exact` is not of its type.
    """
    check_type("exact", exact, ExactLandscape)
    chart = exact.chart
    if chart.kind != "area":
        why = (
            chart.reason or "one symmetric degree of freedom only: `origami-nlp minima -o FILE.png`"
        )
        raise OptionError(f"scene has no two-dimensional landscape: {why}")
    count = len(chart.branches)
    groups = [list(range(count))] if chart.one_plane else [[k] for k in range(count)]
    drawn = drawn_minima(exact.result.scene, exact.result.minima, exact.places)
    entries: list[Any] = [*marks_legend(drawn, STAR, True), *_metastable_legend(exact)]
    entries += area_legend(chart, exact.boundary, LINE)
    top, panel = 0.2 * (len(groups) > 1), LEFT + SIDE + RIGHT
    width, body = 2 * MARGIN + panel * len(groups), top + SIDE + BELOW
    stack = StackedFigure(width, body, [_title(exact)], entries, _notes(exact))
    norm = norm_of(chart, (m.energy for m in exact.result.minima))
    for number, group in enumerate(groups):
        x = MARGIN + LEFT + number * panel
        axes = stack.axes(x, top, SIDE, SIDE)
        image = draw_area(axes, chart, group, norm, exact.boundary, LINE)
        clear = _draw_metastable(axes, exact, group)
        mark_minima(axes, drawn, group, STAR, 1.05 * TEXT, clear)
        if len(groups) > 1:
            axes.set_title(chart.branches[group[0]].name.replace("-", "−"), fontsize=10)
        colour_bar(image, stack.axes(x + SIDE + 0.15, top + 0.1, 0.14, SIDE - 0.2))
    return stack.figure


def _draw_metastable(
    axes: Any, exact: ExactLandscape, group: Sequence[int]
) -> list[tuple[tuple[float, float], float]]:
    """Draw metastable stretches, those on one point as rings; return where these are, and their size [points]."""
    rings = []
    top: dict[str, Any] = {"zorder": 4, "clip_on": False, "color": METASTABLE}
    for part in exact.metastable:
        if part.branch in group and not part.hidden:
            axes.plot(*part.points.T, linewidth=3.4 * LINE, solid_capstyle="butt", **top)
        elif part.branch in group:
            ring = {"marker": "o", "markersize": 1.6 * STAR, "markerfacecolor": "none"}
            axes.plot(*part.points[:1].T, **ring, markeredgewidth=2.2 * LINE, **top)
            x, y = part.points[0].tolist()
            rings.append(((x, y), 1.6 * STAR + 4))
    return rings


def _metastable_legend(exact: ExactLandscape) -> list[Any]:
    entries = []
    if any(not s.hidden for s in exact.metastable):
        look: dict[str, Any] = {"color": METASTABLE, "linewidth": 3.0 * LINE}
        entries.append(Line2D([], [], **look, label="metastable stretch"))
    if any(s.hidden for s in exact.metastable):
        red = RING | {"markersize": 1.02 * STAR, "markeredgecolor": METASTABLE}
        red |= {"linestyle": "none", "markeredgewidth": 1.6}
        entries.append(Line2D([], [], **red, label="metastable, on one point"))
    return entries


def _title(exact: ExactLandscape) -> str:
    scene = exact.result.scene
    count = len(exact.result.minima)
    who = scene.label or f"degree {scene.degree}"
    words = f"{who}: {count} symmetric minim{'um' if count == 1 else 'a'}"
    if exact.counts[2] is not None:
        words += f", {exact.counts[2]} of them stable"
    return label_text(words)


def _notes(exact: ExactLandscape) -> list[str]:
    """Describe what the picture does not show; what it shows is in its legend, lengths and passes in the report."""
    beyond = [str(k) for k, p in enumerate(exact.places, start=1) if not p.drawn]
    why = "facets have passed through each other, or another winding"
    return [label_text(f"Not drawn ({', '.join(beyond)}): {why}.")] if beyond else []
