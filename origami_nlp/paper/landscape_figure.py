"""The figure of one landscape: exact boundaries and minima, and metastable stretches.

Marks and colours are those of `display.style`; red lines: metastable stretches; dashed: 1-handles, on which states
exist only at phi = +-pi exactly.
"""

from __future__ import annotations

from matplotlib.figure import Figure

from origami_nlp.arguments import check_type
from origami_nlp.display import add_heading, label_text
from origami_nlp.errors import OptionError
from origami_nlp.minima import drawn_minima, paint_landscape
from origami_nlp.paper.landscape import ExactLandscape

SIDE = 6.0
"""Of a panel [in]."""


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
        one = "one symmetric degree of freedom only: `origami-nlp minima -o FILE.png`"
        why = chart.reason or one
        raise OptionError(f"scene has no two-dimensional landscape: {why}")
    wide = SIDE * (1 if chart.one_plane else len(chart.branches))
    figure = Figure(figsize=(wide, SIDE + 0.6), dpi=110, layout="constrained")
    drawn, energies = drawn_minima(scene, minima, exact.places), [m.energy for m in minima]
    boundary, parts = exact.boundary, exact.metastable
    handles = paint_landscape(figure, chart, drawn, energies, boundary, parts)
    title = f"{scene.label or f'degree {scene.degree}'}: {len(minima)} symmetric minima"
    if exact.counts[2] is not None:
        title += f", {exact.counts[2]} of them stable"
    beyond = ", ".join(str(k) for k, p in enumerate(exact.places, start=1) if not p.drawn)
    add_heading(figure, label_text(title), handles, [f"Not drawn: {beyond}."] if beyond else [])
    return figure
