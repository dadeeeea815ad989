"""The picture of minima: energy landscape with the minima marked, and a drawing of every state.

Sizes are in inches and worked out from the contents, so that many minima make a larger figure, not a crowded one:
states stand beside the landscape while there is room, the others below it, then come the legend and few words.  Uses
matplotlib's object interface only: no global state, any backend.
"""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import Any

from matplotlib.figure import Figure

from origami_nlp.arguments import check_path, check_type
from origami_nlp.chart import (
    Landscape,
    Place,
    area_legend,
    colour_bar,
    draw_area,
    draw_curves,
    landscape,
    norm_of,
    outline_of,
)
from origami_nlp.display import (
    MARGIN,
    MOST_DRAWN,
    WARNING,
    StackedFigure,
    StatesDrawn,
    label_text,
)
from origami_nlp.errors import OptionError
from origami_nlp.io import save_figure
from origami_nlp.minima.marks import Drawn, drawn_minima, mark_minima, marks_legend
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.result import MinimaResult
from origami_nlp.minima.rows import energy_unit
from origami_nlp.pattern import Pattern, Scene

STAR, FONT = 16.0, 11.0
"""Size of a star, and of the letters of its number [points]."""


@dataclass(frozen=True)
class _Panels:
    """Branches in each panel of the landscape, and sizes [in]: of a panel, and of what is around it."""

    groups: tuple[tuple[int, ...], ...] = ()
    width: float = 4.4
    height: float = 4.4
    left: float = 0.7
    right: float = 0.85
    below: float = 0.55

    @property
    def total(self) -> tuple[float, float]:
        """Width and height of all of it."""
        if not self.groups:
            return 0.0, 0.0
        return len(self.groups) * (self.left + self.width) + self.right, self.height + self.below


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
    panels, shown = _panels(chart), minima[:MOST_DRAWN]
    places = (
        [chart.place(m.fold_angles, m.winding) for m in shown] if chart and panels.groups else []
    )
    rows, unit = result.rows[:MOST_DRAWN], energy_unit(origami)
    states = StatesDrawn(
        origami,
        [row.caption(unit) for row in rows],
        [m.phi for m in shown],
        [m.contacts for m in shown] if isinstance(origami, Pattern) else (),
        colours=[WARNING if row.full_space == "unstable" else "black" for row in rows],
        beside=panels.total,
    )
    drawn, handles = drawn_minima(origami, shown, places), []
    if chart is not None:
        handles = _draw_curve_names(chart) + marks_legend(drawn, STAR)
        handles += area_legend(chart, outline_of(chart.scene)) if chart.kind == "area" else []
    notes = _notes(minima, chart, places)
    body, title = (max(states.width, 6.0), states.height), [label_text(result.verdict)]
    stack = StackedFigure(*body, title, handles + states.legend(), notes)
    if chart is not None:
        _draw_panels(stack, chart, panels, drawn, [m.energy for m in shown])
    states.draw(stack)
    if path is not None:
        save_figure(stack.figure, path)
    return stack.figure


def _panels(chart: Landscape | None) -> _Panels:
    if chart is None or chart.kind == "none":
        return _Panels()
    if chart.kind == "curve":
        return _Panels(((0,),), right=0.2)
    count = len(chart.branches)
    if chart.one_plane:
        return _Panels((tuple(range(count)),))
    return _Panels(tuple((k,) for k in range(count)), width=3.0)


def _draw_curve_names(chart: Landscape) -> list[Any]:
    """Return the names of curves for the legend; they are drawn into Axes that nobody sees."""
    return draw_curves(Figure().add_subplot(), chart) if chart.kind == "curve" else []


def _draw_panels(
    stack: StackedFigure,
    chart: Landscape,
    panels: _Panels,
    drawn: list[Drawn],
    energies: list[float],
) -> None:
    norm = norm_of(chart, energies) if chart.kind == "area" else None
    image = None
    for number, group in enumerate(panels.groups):
        x = MARGIN + panels.left + number * (panels.left + panels.width)
        box = stack.axes(x, 0.0, panels.width, panels.height)
        if norm is None:
            curves = draw_curves(box, chart)
            # numbers keep off the curves
            points = [p for line in curves for p in line.get_xydata()[::2]]
            clear = [((float(x), float(y)), 2.0) for x, y in points]
            mark_minima(box, drawn, range(len(chart.branches)), STAR, FONT, clear)
            return
        image = draw_area(box, chart, group, norm, outline_of(chart.scene))
        mark_minima(box, drawn, group, STAR, FONT)
        if len(panels.groups) > 1:
            box.set_title(chart.branches[group[0]].name.replace("-", "−"), fontsize=10, pad=4)
    if image is not None:
        x = MARGIN + panels.total[0] - panels.right + 0.12
        colour_bar(image, stack.axes(x, 0.1, 0.14, panels.height - 0.2))


def _notes(
    minima: tuple[JudgedState, ...], chart: Landscape | None, places: list[Place]
) -> list[str]:
    """Describe what the picture leaves out or cannot show."""
    notes = []
    if chart is not None and chart.kind == "none":
        notes.append(f"No energy landscape: {chart.reason}.")
    reported: dict[str, list[str]] = {}
    for number, place in enumerate(places, start=1):
        if place.family and place.drawn:
            reported.setdefault(place.family, []).append(str(number))
    for family, numbers in reported.items():
        notes.append(f"At {', '.join(numbers)}: {family}.")
    beyond = [str(k) for k, p in enumerate(places, start=1) if not p.drawn]
    if beyond:
        notes.append(
            f"Not on the landscape ({', '.join(beyond)}): facets have passed through each other, |φ| > 180°, "
            "or the state winds another number of times round the axis."
        )
    more = len(minima) - MOST_DRAWN
    if more > 0:
        notes.append(f"{more} more minima of higher energy are not drawn.")
    return notes
