"""The picture of minima: energy landscape with the minima marked, and a drawing of every state.

Sizes are in inches and worked out from the contents, so that many minima make a larger figure, not a crowded one:
states stand beside the landscape while there is room, the others below it, then come the legend and few words.  Uses
matplotlib's object interface only: no global state, any backend.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

from origami_nlp.chart import (
    UNIT,
    Landscape,
    Place,
    area_legend,
    colour_bar,
    draw_area,
    draw_curves,
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
    subscript,
)
from origami_nlp.minima.marks import Drawn, drawn_minima, mark_minima, marks_legend
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stability import barrier_words, count_words, verdict
from origami_nlp.minima.summary import energy_unit, energy_words
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


def compose(
    origami: Scene | Pattern,
    minima: tuple[JudgedState, ...],
    chart: Landscape | None,
) -> Figure:
    """Draw minima folded, and on the landscape of their scene.

    chart: None where there is no landscape to draw, as of a
    pattern.
    """
    shown = minima[:MOST_DRAWN]
    panels = _panels(chart)
    places = (
        [chart.place(m.fold_angles, m.winding) for m in shown] if chart and panels.groups else []
    )
    unit = energy_unit(origami)
    states = StatesDrawn(
        origami,
        [_state_title(k, m, unit) for k, m in enumerate(shown, start=1)],
        [m.phi for m in shown],
        [m.contacts for m in shown] if isinstance(origami, Pattern) else (),
        colours=[WARNING if verdict(origami, m) == "unstable" else "black" for m in shown],
        beside=panels.total,
    )
    drawn, handles = drawn_minima(origami, shown, places), []
    if chart is not None:
        handles = _draw_curve_names(chart) + marks_legend(drawn, STAR)
        handles += area_legend(chart, outline_of(chart.scene)) if chart.kind == "area" else []
    notes = _notes(minima, chart, places)
    body = max(states.width, 6.0), states.height
    stack = StackedFigure(*body, _title(origami, minima), handles + states.legend(), notes)
    if chart is not None:
        _draw_panels(stack, chart, panels, drawn, [m.energy for m in shown])
    states.draw(stack)
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


def _title(origami: Scene | Pattern, minima: tuple[JudgedState, ...]) -> list[str]:
    count = count_words(origami, minima, "no")
    if isinstance(origami, Pattern):
        return [label_text(": ".join(filter(None, (origami.name, count))))]
    who = origami.label or f"degree {origami.degree}"
    group = f"{origami.group.kind}{subscript(origami.group.order)}"
    symmetry = "" if origami.group.is_trivial else f"symmetry {group}, "
    contact = {"full": "full contact", "fold-limits": "fold limits only", "none": "no contact"}
    return [label_text(f"{who}: {count}"), f"{symmetry}{contact[origami.contact]}"]


def _state_title(number: int, minimum: JudgedState, unit: float) -> str:
    kind: str = minimum.kind
    if minimum.local_dimension < minimum.dof:
        kind += {0: ", isolated point", 1: ", on a 1-handle"}.get(
            minimum.local_dimension, f", local dimension {minimum.local_dimension}"
        )
    known = "" if minimum.full_space is None else f", {minimum.full_space.verdict}"
    if minimum.shallow:
        kind = f"{minimum.kind}, shallow"
    energy = energy_words(minimum.energy, unit, 4)
    head = f"{number}:  U = {energy} {UNIT}{known}\n{kind}"
    return f"{head}\n{barrier_words(minimum.escape, UNIT)}".rstrip()


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
