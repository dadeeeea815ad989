"""One landscape with exact boundaries in matplotlib Axes, in the manner of the paper.

Marks and colours are those of `show.style`; red lines: metastable stretches; dashed: 1-handles, on which states exist
only at phi = +-pi exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.lines import Line2D

from origami_nlp.chart import area_legend, draw_area, norm_of
from origami_nlp.landscape.exact import ExactLandscape
from origami_nlp.minima import JudgedState
from origami_nlp.show import METASTABLE, RING, label_marks, mark_minimum, minima_legend


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


FAMILY = 1.3
"""Size of the ring around a family against a star's."""


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
    _mark(axes, exact, branches, style)
    return image


def verdict_of(minimum: JudgedState) -> str | None:
    """Return the verdict in the full space, None if it was not asked for."""
    return minimum.full_space.verdict if minimum.full_space else None


def _mark(axes: Any, exact: ExactLandscape, branches: Sequence[int], style: PanelStyle) -> None:
    """Put the minima on top, unstable ones last; those that share a point share a number."""
    here = [
        (number, minimum, place)
        for number, (minimum, place) in enumerate(
            zip(exact.result.minima, exact.places, strict=True), start=1
        )
        if place.branch in branches and place.drawn
    ]
    for _, minimum, place in sorted(here, key=lambda one: verdict_of(one[1]) == "unstable"):
        if place.family and style.numbers:
            look = RING | {"markersize": FAMILY * style.star, "linestyle": "none"}
            axes.plot(*place.point, **look, zorder=6, clip_on=False)
        mark_minimum(axes, place.point, minimum.kind, verdict_of(minimum), style.star)
    if style.numbers:
        wide = [(FAMILY if place.family else 1.0) * style.star for _, _, place in here]
        marks = [(p.point, str(n), w) for (n, _, p), w in zip(here, wide, strict=True)]
        rings = [s.points[0] for s in exact.metastable if s.hidden and s.branch in branches]
        marks += [((float(x), float(y)), "", 1.6 * style.star + 4) for x, y in rings]
        label_marks(axes, marks, 1.05 * style.text)


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
    drawn = [
        (m, p)
        for panel in panels
        for m, p in zip(panel.result.minima, panel.places, strict=True)
        if p.drawn
    ]
    size = 0.85 * style.star
    entries: list[Any] = minima_legend(((m.kind, verdict_of(m)) for m, _ in drawn), size)
    if style.numbers and any(p.family for _, p in drawn):
        ring = RING | {"markersize": 12, "linestyle": "none"}
        entries.append(Line2D([], [], **ring, label="several states there"))
    stretches = [s for panel in panels for s in panel.metastable]
    if any(not s.hidden for s in stretches):
        look: dict[str, Any] = {"color": METASTABLE, "linewidth": 3.0 * style.line}
        entries.append(Line2D([], [], **look, label="metastable stretch"))
    if any(s.hidden for s in stretches):
        red = RING | {"markersize": 1.2 * size, "markeredgecolor": METASTABLE, "linestyle": "none"}
        entries.append(
            Line2D([], [], **red | {"markeredgewidth": 1.6}, label="metastable, on one point")
        )
    lines: dict[str, Any] = {}
    for panel in panels:
        for handle in area_legend(panel.chart, panel.outline, style.line):
            lines.setdefault(handle.get_label(), handle)
    return entries + list(lines.values())
