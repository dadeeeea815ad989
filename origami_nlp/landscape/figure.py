"""The figure of one landscape: exact boundaries and minima, metastable stretches, and passes if they are known."""

from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, Stroke
from matplotlib.ticker import MaxNLocator

from origami_nlp.arguments import check_type
from origami_nlp.chart import Chart, chart_of, chart_points, coordinate_label
from origami_nlp.errors import OptionError
from origami_nlp.landscape.exact import ExactLandscape
from origami_nlp.landscape.panel import PanelStyle, draw_panel, legend_of, write_counts
from origami_nlp.show import angle_ticks, label_text

if TYPE_CHECKING:
    from origami_nlp.barriers import Barriers, Pass

STYLE = PanelStyle(star=16.0, line=1.2, text=10.5, numbers=True)
PATH: dict[str, Any] = {
    "color": "white",
    "linewidth": 1.5,
    "path_effects": [Stroke(linewidth=3.0, foreground="black"), Normal()],
    "zorder": 5,
    "clip_on": False,
}
SIDE, MARGIN, LEFT, RIGHT = 5.0, 0.15, 0.75, 0.95
"""Of a panel, and what is around it [in]."""


def draw_landscape(exact: ExactLandscape, barriers: Barriers | None = None) -> Figure:
    """Draw a landscape.

    Parameters
    ----------
    exact
        Of `find_landscape`.
    barriers
        Of `find_barriers`: also draw the lowest passes that join all minima, and the paths over them.

    Returns
    -------
    matplotlib.figure.Figure
        One panel, or one a branch of the chart.

    Raises
    ------
    OptionError
        If the scene has no landscape over two coordinates, or an argument is not what it must be.
    """
    check_type("exact", exact, ExactLandscape)
    if barriers is not None:
        from origami_nlp.barriers import Barriers  # only who has barriers has loaded them

        check_type("barriers", barriers, Barriers)
    if exact.chart.kind != "area":
        why = exact.chart.reason or "one symmetric freedom only: `origami-nlp minima --figure`"
        raise OptionError(f"scene has no two-dimensional landscape: {why}")
    count = len(exact.chart.branches)
    groups = [list(range(count))] if exact.one_plane else [[k] for k in range(count)]
    panel = LEFT + SIDE + RIGHT
    width = 2 * MARGIN + panel * len(groups)
    title = textwrap.wrap(_title(exact), int(11.5 * width))
    chosen = joining_passes(barriers) if barriers else []
    entries = legend_of([exact], STYLE)
    if chosen:
        entries.append(Line2D([], [], label="lowest path over a pass", **PATH))
        entries.append(Line2D([], [], label="pass", linestyle="none", **_PASS))
    columns = min(len(entries), max(2, int(width / 2.15)))
    notes = [
        line
        for note in _notes(exact, chosen)
        for line in textwrap.wrap(note, int(14.5 * width), break_on_hyphens=False)
    ]
    legend = 0.24 * math.ceil(len(entries) / columns) + 0.1
    top, below = 0.15 + 0.26 * len(title), 0.55
    height = top + SIDE + below + legend + 0.17 * len(notes) + 0.15
    figure = Figure(figsize=(width, height), dpi=110, facecolor="white")

    def box(x: float, w: float, y: float, h: float) -> Any:
        return figure.add_axes((x / width, 1 - (y + h) / height, w / width, h / height))

    for number, line in enumerate(title):
        y = 1 - (0.1 + 0.26 * number) / height
        figure.text(0.3 / width, y, line, fontsize=11, weight="bold", va="top")
    for number, group in enumerate(groups):
        x = MARGIN + LEFT + number * panel
        axes = box(x, SIDE, top, SIDE)
        image = draw_panel(axes, exact, group, STYLE)
        _paths(axes, exact, group, chosen)
        if number == 0:
            write_counts(axes, exact, group, STYLE)
        names = exact.chart.coordinates
        axes.set_xlabel(coordinate_label(names[0]))
        axes.set_ylabel(coordinate_label(names[1]), labelpad=0)
        angle_ticks(axes.xaxis, *axes.get_xlim())
        angle_ticks(axes.yaxis, *axes.get_ylim())
        if len(groups) > 1:
            axes.set_title(exact.chart.branches[group[0]].name.replace("-", "−"), fontsize=10)
        bar = figure.colorbar(image, cax=box(x + SIDE + 0.2, 0.15, top + 0.15, SIDE - 0.3))
        bar.set_label("energy U [J]")
        bar.ax.yaxis.set_major_locator(MaxNLocator(7))
    y = top + SIDE + below
    figure.legend(
        handles=entries,
        loc="upper left",
        bbox_to_anchor=(0.25 / width, 1 - y / height),
        ncols=columns,
        fontsize=9,
        frameon=False,
        borderaxespad=0.0,
        columnspacing=1.3,
        handletextpad=0.5,
    )
    for number, line in enumerate(notes):
        at = 1 - (y + legend + 0.17 * number) / height
        figure.text(0.3 / width, at, line, fontsize=8, va="top")
    return figure


_PASS: dict[str, Any] = {
    "marker": "D",
    "markersize": 7.0,
    "markerfacecolor": "white",
    "markeredgecolor": "black",
    "markeredgewidth": 1.2,
}


def joining_passes(barriers: Barriers) -> list[Pass]:
    """Return the passes at which the sublevel sets of the minima join: one less than the minima that are joined."""
    joined = list(range(len(barriers.result.minima) + 1))
    chosen = []
    for step in sorted(barriers.passes, key=lambda p: (p.energy, len(p.path))):
        a, b = joined[step.from_state], joined[step.to_state]
        if a != b and math.isfinite(step.energy):
            joined = [a if group == b else group for group in joined]
            chosen.append(step)
    return chosen


def _paths(axes: Any, exact: ExactLandscape, group: list[int], passes: list[Pass]) -> None:
    """Draw the paths over the passes; a path that changes branch is drawn on both."""
    chart = chart_of(exact.result.scene)
    assert chart is not None
    for step in passes:
        points = chart_points(chart, np.asarray(step.path))
        if len(exact.chart.branches) > 1 and not exact.one_plane:
            points = np.where(_on(chart, step.path, group)[:, None], points, np.nan)
        axes.plot(*points.T, **PATH)
        at = chart_points(chart, np.array([step.fold_angles]))
        axes.plot(*at.T, linestyle="none", zorder=6, clip_on=False, **_PASS)


def _on(chart: Chart, path: np.ndarray, group: list[int]) -> np.ndarray:
    """Tell which states of a path lie on the branches of a panel."""
    return np.array([chart.locate(phi)[0][0] in group for phi in path])


def _title(exact: ExactLandscape) -> str:
    scene = exact.result.scene
    count = len(exact.result.minima)
    who = scene.label or f"degree {scene.degree}"
    return label_text(
        f"{who}: energy landscape, {count} symmetric minim{'um' if count == 1 else 'a'}"
    )


def _notes(exact: ExactLandscape, passes: list[Pass]) -> list[str]:
    """Footnotes: what white is, what the corner says, families, passes."""
    notes = []
    if exact.boundary is None:
        notes.append(
            "Edges are those of the grid: the boundary is traced with contact = 'full' only."
        )
    else:
        notes.append("White: excluded (crossing facets or |φ| > π).")
        missed = sum(map(len, exact.boundary.missed))
        if missed:
            notes.append(
                f"{missed} boundary points of the grid lie on no line: some are not drawn."
            )
    if exact.counts[1] is not None:
        notes.append(
            "Corner: symmetric minima → not ruled out in the full space → stable in the full space."
        )
    told: dict[str, list[int]] = {}
    for number, place in enumerate(exact.places, start=1):
        if place.family and place.drawn:
            told.setdefault(place.family, []).append(number)
    for family, numbers in told.items():
        notes.append(f"The point of {', '.join(map(str, numbers))} carries a family: {family}.")
    hidden = [part for part in exact.metastable if part.hidden]
    for part in hidden:
        x, y = part.points[0]
        notes.append(
            f"Red ring at ({x:.3g}, {y:.3g}): {part.length:.3g} rad of metastable states share it "
            f"({'; '.join(part.contacts)})."
        )
    drawn = [part for part in exact.metastable if not part.hidden]
    if drawn:
        notes.append(
            f"Metastable: {sum(part.length for part in drawn):.3g} rad of arclength drawn."
        )
    for step in passes:
        notes.append(
            f"Pass {step.from_state} to {step.to_state}: {step.pass_kind}, U = {step.energy:.6g} J."
        )
    return [label_text(note) for note in notes]
