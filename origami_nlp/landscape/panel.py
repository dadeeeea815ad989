"""One landscape with exact boundaries in matplotlib Axes, in the manner of the paper.

Marks and colours are those of `display.style`; red lines: metastable stretches; dashed: 1-handles, on which states
exist only at phi = +-pi exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.lines import Line2D

from origami_nlp.chart import area_legend, draw_area, norm_of
from origami_nlp.display import METASTABLE, RING
from origami_nlp.landscape.exact import ExactLandscape
from origami_nlp.minima import Drawn, drawn_minima, mark_minima, marks_legend


@dataclass(frozen=True)
class PanelStyle:
    """Sizes in points.

    Attributes
    ----------
    star
        Of a marker.
    line
        Width of a boundary.
    text
        Font size.
    numbers
        Whether minima are numbered, and those marked that share their point of the chart with others.
    """

    star: float = 15.0
    line: float = 1.1
    text: float = 10.0
    numbers: bool = True


def draw_panel(axes: Any, exact: ExactLandscape, branches: Sequence[int], style: PanelStyle) -> Any:
    """Draw branches of a landscape into one Axes.

    Parameters
    ----------
    axes
        Of matplotlib.
    exact
        Of `find_landscape`.
    branches
        Which of the chart's, from 0.
    style
        Sizes of marks and letters.

    Returns
    -------
    matplotlib.image.AxesImage
        The energies, for a colour bar.
    """
    norm = norm_of(exact.chart, (m.energy for m in exact.result.minima))
    image = draw_area(axes, exact.chart, branches, norm, exact.outline, style.line)
    for part in exact.metastable:
        if part.branch not in branches:
            continue
        top = {"zorder": 4, "clip_on": False, "color": METASTABLE}
        if part.hidden:
            ring = {"marker": "o", "markersize": 1.6 * style.star, "markerfacecolor": "none"}
            axes.plot(*part.points[:1].T, **ring, markeredgewidth=2.2 * style.line, **top)
        else:
            axes.plot(*part.points.T, linewidth=3.4 * style.line, solid_capstyle="butt", **top)
    rings = [s.points[0] for s in exact.metastable if s.hidden and s.branch in branches]
    clear = [((float(x), float(y)), 1.6 * style.star + 4) for x, y in rings]
    font = 1.05 * style.text if style.numbers else None
    mark_minima(axes, _drawn(exact), branches, style.star, font, clear)
    return image


def _drawn(exact: ExactLandscape) -> list[Drawn]:
    return drawn_minima(exact.result.scene, exact.result.minima, exact.places)


def legend_of(panels: list[ExactLandscape], style: PanelStyle) -> list[Any]:
    """Return legend entries for what occurs on any of the panels.

    Parameters
    ----------
    panels
        Of `find_landscape`.
    style
        Sizes of marks and letters.

    Returns
    -------
    list of matplotlib.artist.Artist
        Handles with labels.
    """
    drawn = [m for panel in panels for m in _drawn(panel)]
    entries: list[Any] = list(marks_legend(drawn, style.star, style.numbers))
    stretches = [s for panel in panels for s in panel.metastable]
    if any(not s.hidden for s in stretches):
        look: dict[str, Any] = {"color": METASTABLE, "linewidth": 3.0 * style.line}
        entries.append(Line2D([], [], **look, label="metastable stretch"))
    if any(s.hidden for s in stretches):
        red = RING | {
            "markersize": 1.02 * style.star,
            "markeredgecolor": METASTABLE,
            "linestyle": "none",
        }
        entries.append(
            Line2D([], [], **red | {"markeredgewidth": 1.6}, label="metastable, on one point")
        )
    lines: dict[str, Any] = {}
    for panel in panels:
        for handle in area_legend(panel.chart, panel.outline, style.line):
            lines.setdefault(handle.get_label(), handle)
    return entries + list(lines.values())
