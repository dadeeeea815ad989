"""One landscape with exact boundaries in matplotlib Axes, in the manner of the paper.

Marks and colours are those of `display.style`; red lines: metastable stretches; dashed: 1-handles, on which states
exist only at phi = +-pi exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.lines import Line2D

from origami_nlp.chart import area_legend, draw_area, norm_of
from origami_nlp.display import METASTABLE, RING
from origami_nlp.landscape.exact import ExactLandscape
from origami_nlp.minima import Drawn, drawn_minima, mark_minima, marks_legend

STAR, LINE, TEXT = 16.0, 1.2, 10.5
"""Sizes of markers, boundaries and letters [points]."""


def draw_panel(axes: Any, exact: ExactLandscape, branches: Sequence[int]) -> Any:
    """Draw branches of a landscape into one Axes.

    Parameters
    ----------
    axes
        Of matplotlib.
    exact
        Of `find_landscape`.
    branches
        Which of the chart's, from 0.

    Returns
    -------
    matplotlib.image.AxesImage
        The energies, for a colour bar.
    """
    norm = norm_of(exact.chart, (m.energy for m in exact.result.minima))
    image = draw_area(axes, exact.chart, branches, norm, exact.outline, LINE)
    for part in exact.metastable:
        if part.branch not in branches:
            continue
        top = {"zorder": 4, "clip_on": False, "color": METASTABLE}
        if part.hidden:
            ring = {"marker": "o", "markersize": 1.6 * STAR, "markerfacecolor": "none"}
            axes.plot(*part.points[:1].T, **ring, markeredgewidth=2.2 * LINE, **top)
        else:
            axes.plot(*part.points.T, linewidth=3.4 * LINE, solid_capstyle="butt", **top)
    rings = [s.points[0] for s in exact.metastable if s.hidden and s.branch in branches]
    clear = [((float(x), float(y)), 1.6 * STAR + 4) for x, y in rings]
    mark_minima(axes, _drawn(exact), branches, STAR, 1.05 * TEXT, clear)
    return image


def _drawn(exact: ExactLandscape) -> list[Drawn]:
    return drawn_minima(exact.result.scene, exact.result.minima, exact.places)


def legend_of(exact: ExactLandscape) -> list[Any]:
    """Return legend entries for what occurs on a landscape.

    Parameters
    ----------
    exact
        Of `find_landscape`.

    Returns
    -------
    list of matplotlib.artist.Artist
        Handles with labels.
    """
    entries: list[Any] = list(marks_legend(_drawn(exact), STAR, True))
    if any(not s.hidden for s in exact.metastable):
        look: dict[str, Any] = {"color": METASTABLE, "linewidth": 3.0 * LINE}
        entries.append(Line2D([], [], **look, label="metastable stretch"))
    if any(s.hidden for s in exact.metastable):
        red = RING | {"markersize": 1.02 * STAR, "markeredgecolor": METASTABLE}
        red |= {"linestyle": "none", "markeredgewidth": 1.6}
        entries.append(Line2D([], [], **red, label="metastable, on one point"))
    lines: dict[str, Any] = {}
    for handle in area_legend(exact.chart, exact.outline, LINE):
        lines.setdefault(handle.get_label(), handle)
    return entries + list(lines.values())
