"""The figure of one landscape: exact boundaries and minima, metastable stretches, and passes if they are known."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, Stroke

from origami_nlp.arguments import check_type
from origami_nlp.chart import Chart, chart_of, chart_points, colour_bar
from origami_nlp.display import MARGIN, StackedFigure, label_text, pass_look, passes_legend
from origami_nlp.errors import OptionError
from origami_nlp.landscape.exact import ExactLandscape
from origami_nlp.landscape.panel import STAR, draw_panel, legend_of

if TYPE_CHECKING:
    from origami_nlp.barriers import Barriers, Pass

PATH: dict[str, Any] = {
    "color": "white",
    "linewidth": 1.5,
    "path_effects": [Stroke(linewidth=3.0, foreground="black"), Normal()],
    "zorder": 5,
    "clip_on": False,
}
SIDE, LEFT, RIGHT, BELOW = 4.6, 0.7, 0.85, 0.45
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
        why = (
            exact.chart.reason
            or "one symmetric degree of freedom only: `origami-nlp minima -o FILE.png`"
        )
        raise OptionError(f"scene has no two-dimensional landscape: {why}")
    count = len(exact.chart.branches)
    groups = [list(range(count))] if exact.one_plane else [[k] for k in range(count)]
    panel = LEFT + SIDE + RIGHT
    chosen = joining_passes(barriers) if barriers else []
    entries = legend_of(exact)
    if chosen:
        entries.append(Line2D([], [], label="lowest path over a pass", **PATH))
        entries += passes_legend((p.pass_kind for p in chosen), STAR)
    top = 0.2 * (len(groups) > 1)
    body = top + SIDE + BELOW
    stack = StackedFigure(
        2 * MARGIN + panel * len(groups), body, [_title(exact)], entries, _notes(exact)
    )
    for number, group in enumerate(groups):
        x = MARGIN + LEFT + number * panel
        axes = stack.axes(x, top, SIDE, SIDE)
        image = draw_panel(axes, exact, group)
        _paths(axes, exact, group, chosen)
        if len(groups) > 1:
            axes.set_title(exact.chart.branches[group[0]].name.replace("-", "−"), fontsize=10)
        colour_bar(image, stack.axes(x + SIDE + 0.15, top + 0.1, 0.14, SIDE - 0.2))
    return stack.figure


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
        axes.plot(*at.T, **pass_look(step.pass_kind, STAR), zorder=7.5, clip_on=False)


def _on(chart: Chart, path: np.ndarray, group: list[int]) -> np.ndarray:
    """Return which states of a path lie on the branches of a panel."""
    return np.array([chart.locate(phi)[0][0] in group for phi in path])


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
    missed = sum(map(len, exact.boundary.missed)) if exact.boundary else 0
    notes = []
    if missed:
        notes.append(f"{missed} boundary points of the grid lie on no line: some are not drawn.")
    beyond = [str(k) for k, p in enumerate(exact.places, start=1) if not p.drawn]
    if beyond:
        notes.append(
            f"Not drawn ({', '.join(beyond)}): facets have passed through each other, or another winding."
        )
    return [label_text(note) for note in notes]
