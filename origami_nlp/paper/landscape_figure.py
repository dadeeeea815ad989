"""The figure of one landscape: exact boundaries and minima, and metastable stretches.

Marks and colours are those of `display.style`; red lines: metastable stretches; dashed: 1-handles, on which states
exist only at phi = +-pi exactly.
"""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.arguments import check_type
from origami_nlp.chart import UNIT, area_legend, draw_area, norm_of
from origami_nlp.display import METASTABLE, label_text
from origami_nlp.errors import OptionError
from origami_nlp.minima import drawn_minima, mark_minima, marks_legend
from origami_nlp.paper.landscape import ExactLandscape

STAR, TEXT = 16.0, 11.0
"""Sizes of markers and letters [points]."""
SIDE = 6.0
"""Of a panel [in]."""
STRETCH: dict[str, Any] = {"color": METASTABLE, "linewidth": 4, "solid_capstyle": "butt"}
POINT: dict[str, Any] = {
    "marker": "o",
    "markersize": 1.6 * STAR,
    "color": METASTABLE,
    "mfc": "none",
    "mew": 2.6,
    "ls": "",
}
"""Of metastable stretches, and of those that share one point of the chart."""


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
    chart, scene, minima = exact.chart, exact.result.scene, exact.result.minima
    if chart.kind != "area":
        why = (
            chart.reason or "one symmetric degree of freedom only: `origami-nlp minima -o FILE.png`"
        )
        raise OptionError(f"scene has no two-dimensional landscape: {why}")
    every = range(len(chart.branches))
    panels = [list(every)] if chart.one_plane else [[k] for k in every]
    figure = Figure(figsize=(SIDE * len(panels), SIDE), dpi=110, layout="constrained")
    drawn, norm = (
        drawn_minima(scene, minima, exact.places),
        norm_of(chart, [m.energy for m in minima]),
    )
    for axes, panel in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        image = draw_area(axes, chart, panel, norm, exact.boundary)
        rings = []
        for part in (part for part in exact.metastable if part.branch in panel):
            at = part.points[:1] if part.hidden else part.points
            axes.plot(*at.T, **POINT if part.hidden else STRETCH, zorder=4, clip_on=False)
            rings += [(tuple(at[0].tolist()), 1.6 * STAR + 4)] if part.hidden else []
        mark_minima(axes, drawn, panel, STAR, TEXT, rings)
        if len(panels) > 1:
            axes.set_title(label_text(chart.branches[panel[0]].name), fontsize=10)
        figure.colorbar(image, ax=axes, shrink=0.9, label=f"energy U [{UNIT}]")
    entries: list[Any] = [*marks_legend(drawn, STAR), *area_legend(chart, exact.boundary)]
    for hidden in sorted({part.hidden for part in exact.metastable}):
        look, where = (POINT | {"markersize": STAR}, ", on one point") if hidden else (STRETCH, "")
        entries.append(Line2D([], [], **look, label=f"metastable{where}"))
    place: Any = {"loc": "outside lower center", "ncols": 3 * len(panels) - 1, "fontsize": 9}
    figure.legend(handles=entries, **place, frameon=False)
    title = f"{scene.label or f'degree {scene.degree}'}: {len(minima)} symmetric minima"
    if exact.counts[2] is not None:
        title += f", {exact.counts[2]} of them stable"
    if beyond := [str(k) for k, p in enumerate(exact.places, start=1) if not p.drawn]:
        title += f" (not drawn: {', '.join(beyond)})"
    figure.suptitle(label_text(title), fontsize=11, weight="bold", wrap=True)
    return figure
