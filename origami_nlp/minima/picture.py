"""The picture of minima: energy landscape with the minima marked, and a drawing of every state.

A few states stand beside the landscape, more of them below it, then come the legend and few words.  Uses matplotlib's
object interface only: no global state, any backend.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from os import PathLike
from typing import Any

from matplotlib.figure import Figure, FigureBase
from matplotlib.lines import Line2D

from origami_nlp.arguments import check_path, check_type
from origami_nlp.chart import (
    UNIT,
    Boundary,
    Landscape,
    Place,
    area_legend,
    draw_area,
    draw_curves,
    landscape,
    norm_of,
    outline_of,
)
from origami_nlp.display import (
    METASTABLE,
    MOST_DRAWN,
    WARNING,
    WIDTH,
    add_heading,
    cell_size,
    label_text,
    lay_out_states,
    minima_legend,
)
from origami_nlp.errors import OptionError
from origami_nlp.io import save_figure
from origami_nlp.minima.marks import Drawn, drawn_minima, mark_minima
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.result import MinimaResult
from origami_nlp.pattern import Pattern, Scene

STAR, FONT = 16.0, 11.0
"""Size of a star, and of the letters of its number [points]."""
SIDE = 5.0
"""Of a panel of the landscape [in]."""
STRETCHES: tuple[dict[str, Any], ...] = (
    {"color": METASTABLE, "lw": 4, "solid_capstyle": "butt"},
    {"color": METASTABLE, "marker": "o", "ms": 1.6 * STAR, "mfc": "none", "mew": 2.6, "ls": ""},
)
"""Looks of metastable stretches, and of those that share one point of the chart."""


def draw_minima(
    result: MinimaResult, path: str | PathLike[str] | None = None, *, size: int = 257
) -> Figure:
    """Draw the minima of a search, and save the figure if a path is given.

    On the landscape, white is excluded; with full contact its border is traced, not a matter of cells.  States that
    exist only at a fold angle of +-pi exactly (1-handles) take no area.  Where a scene has two panels, they are the two
    solutions of loop closure; an elevation above 0 lowers the crease that the axis names.  A ring marks a point of the
    chart that a family of states shares.  Curves of one degree of freedom are named by the folds of their creases.

    In the drawings mountain creases are red and solid, valleys blue and dashed, both wider and darker for larger
    |phi|; the upper side of the paper is warm, the lower side cool; numbers of hidden creases are pale, and facets that
    lie on each other are drawn apart.  Where facets of a pattern touch there is a ring, filled where they push, half
    filled where how they share it is open; these facets are tinted.  A red title: a symmetric minimum that is not
    stable when the symmetry may break.  Energies are in the units of the springs, J for stiffness in N m/rad.

    Parameters
    ----------
    result
        Of `find_minima`.
    path
        Where to save (``.png``, ``.pdf``, ``.svg``, ...), or None.
    size
        Cells along each coordinate of the landscape, of a vertex.

    Returns
    -------
    matplotlib.figure.Figure
        The folded states, and their places on the landscape where the scene has one.

    Raises
    ------
    OptionError
        If the ending of `path` names no known picture format, an argument is not what it must be, or a pattern has no
        minimum.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> len(o.draw_minima(result, size=21).axes) > 1
    True
    """
    check_type("result", result, MinimaResult)
    origami, minima = result.origami, result.minima
    if not (minima or isinstance(origami, Scene)):
        raise OptionError("no stable state was found: there is nothing to draw")
    if path is not None:
        check_path("path", path)
    chart = landscape(origami, size) if isinstance(origami, Scene) else None
    shown, rows = minima[:MOST_DRAWN], result.rows[:MOST_DRAWN]
    panels = _panels(chart)
    places = [chart.place(m.fold_angles, m.winding) for m in shown] if chart and panels else []
    drawn, handles = drawn_minima(origami, shown, places), list[Any]()
    wide, tall = cell_size(origami)
    beside = bool(panels) and len(shown) <= 6
    side = SIDE * len(panels)
    across = math.ceil(len(shown) / 2) if beside else int(max(side, WIDTH) / wide)
    across = max(1, min(across, len(shown)))
    states = across * wide * bool(shown), math.ceil(len(shown) / across) * tall
    width, height = max(side, states[0]), SIDE * bool(panels) + states[1]
    if beside:
        width, height = side + states[0], max(SIDE, states[1])
    figure = Figure(figsize=(max(width, 6.0), height + 1.2), dpi=110, layout="constrained")
    parts: Any = [figure, figure]
    if panels and shown:
        shares: Any = (
            {"width_ratios": (side, states[0])} if beside else {"height_ratios": (SIDE, states[1])}
        )
        parts = figure.subfigures(1 + (not beside), 1 + beside, **shares)
    if chart is not None and panels:
        outline = outline_of(chart.scene) if chart.kind == "area" else None
        handles = paint_landscape(parts[0], chart, drawn, [m.energy for m in shown], outline)
    if shown:
        handles += lay_out_states(
            parts[1],
            origami,
            [(row.caption(), m.phi) for row, m in zip(rows, shown, strict=True)],
            across,
            [m.contacts for m in shown] if isinstance(origami, Pattern) else (),
            colours=[WARNING if row.full_space == "unstable" else "black" for row in rows],
        )
    add_heading(figure, label_text(result.verdict), handles, _notes(minima, chart, places))
    if path is not None:
        save_figure(figure, path)
    return figure


def _panels(chart: Landscape | None) -> list[list[int]]:
    """Return the branches in each panel of the landscape."""
    if chart is None or chart.kind == "none":
        return []
    every = list(range(len(chart.branches)))
    return [every] if chart.kind == "curve" or chart.one_plane else [[k] for k in every]


def paint_landscape(
    figure: FigureBase,
    chart: Landscape,
    drawn: Sequence[Drawn],
    energies: Sequence[float],
    outline: Boundary | None,
    stretches: Sequence[Any] = (),
) -> list[Any]:
    """Paint a landscape, or the curves of one degree of freedom, with the minima marked.

    Parameters
    ----------
    figure
        Where to: one panel, or one a branch of the chart.
    chart
        Of a scene.
    drawn, energies
        Minima that have a place on it, and energies that the colours must reach.
    outline
        Of `outline_of`.
    stretches
        Metastable ones: `branch`, `points` and whether they are `hidden` in one point.

    Returns
    -------
    list of matplotlib.artist.Artist
        Entries of the legend.
    """
    panels, handles = _panels(chart), list[Any]()
    handles += minima_legend(((m.kind, m.verdict) for m in drawn), 0.85 * STAR)
    every: Any = figure.subplots(1, len(panels), squeeze=False)[0]
    if chart.kind == "curve":
        curves = draw_curves(every[0], chart)
        # numbers keep off the curves
        points = [p for line in curves for p in line.get_xydata()[::2]]
        clear = [((float(x), float(y)), 2.0) for x, y in points]
        mark_minima(every[0], drawn, panels[0], STAR, FONT, clear)
        return curves + handles
    norm = norm_of(chart, energies)
    for axes, panel in zip(every, panels, strict=True):
        image, rings = draw_area(axes, chart, panel, norm, outline), []
        for part in (part for part in stretches if part.branch in panel):
            at = part.points[:1] if part.hidden else part.points
            axes.plot(*at.T, **STRETCHES[part.hidden], zorder=4, clip_on=False)
            rings += [(tuple(at[0].tolist()), 1.6 * STAR + 4)] if part.hidden else []
        mark_minima(axes, drawn, panel, STAR, FONT, rings)
        if len(panels) > 1:
            axes.set_title(chart.branches[panel[0]].name.replace("-", "−"), fontsize=10)
    figure.colorbar(image, ax=every, shrink=0.9, label=f"energy U [{UNIT}]")
    for hidden in sorted({part.hidden for part in stretches}):
        label = f"metastable{', on one point' * hidden}"
        handles.append(Line2D([], [], **STRETCHES[hidden], label=label))
    return handles + area_legend(chart, outline)


def _notes(
    minima: tuple[JudgedState, ...], chart: Landscape | None, places: list[Place]
) -> list[str]:
    """Describe what the picture leaves out or cannot show."""
    notes = []
    if chart is not None and chart.kind == "none":
        notes.append(f"No energy landscape: {chart.reason}.")
    each = list(enumerate(places, start=1))
    if beyond := ", ".join(str(k) for k, p in each if not p.drawn):
        notes.append(
            f"Not on the landscape ({beyond}): facets have passed through each other, |φ| > 180°, "
            "or the state winds another number of times round the axis."
        )
    more = len(minima) - MOST_DRAWN
    if more > 0:
        notes.append(f"{more} more minima of higher energy are not drawn.")
    return notes
