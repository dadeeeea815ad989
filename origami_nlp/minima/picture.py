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
from origami_nlp.minima.marks import Drawn, drawn_minima, mark_minima, marks_legend
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stability import barrier_words, count_words, verdict
from origami_nlp.pattern import Scene
from origami_nlp.show import (
    MARGIN,
    WARNING,
    StackedFigure,
    crease_legend,
    draw_state,
    drawn_height,
    label_text,
    subscript,
)

CELL, HEAD = 2.0, 0.66
"""Width of a state's drawing, and the height of its title [in]."""
MOST_DRAWN = 24
"""States drawn; the figure says how many more there are."""
STAR, FONT = 16.0, 11.0
"""Size of a star, and of the letters of its number [points]."""
MOST_BESIDE = 3
"""Columns of drawings beside the landscape."""
ALONE = 5
"""Drawings in a row where there is no landscape."""


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


@dataclass(frozen=True)
class _Row:
    """States of one row: their numbers from 0, left and upper end of the row, height of its drawings [in]."""

    states: range
    left: float
    top: float
    height: float


def compose(chart: Landscape, minima: tuple[JudgedState, ...], freedom: int) -> Figure:
    """Draw minima on the landscape of their scene, and each of them folded.

    freedom: degrees of freedom of the symmetric states.
    """
    scene = chart.scene
    shown = minima[:MOST_DRAWN]
    panels = _panels(chart)
    places = [chart.place(m.fold_angles, m.winding) for m in shown] if panels.groups else []
    rows, width, end = _rows(scene, shown, panels)
    width = max(width, 6.0)
    drawn = drawn_minima(scene, shown, places)
    handles = _draw_curve_names(chart) + marks_legend(drawn, STAR)
    if chart.kind == "area":
        handles += area_legend(chart, outline_of(scene))
    handles += crease_legend() if shown else []
    stack = StackedFigure(width, end, _title(scene, minima), handles, _notes(minima, chart, places))
    _draw_panels(stack, chart, panels, drawn, [m.energy for m in shown])
    for row in rows:
        for k in row.states:
            x = row.left + (k - row.states.start) * CELL
            share = drawn_height(scene.vertex, shown[k].fold_angles)
            box = stack.axes(x + 0.04, row.top + HEAD, CELL - 0.08, share * (CELL - 0.08))
            draw_state(box, scene.vertex, shown[k].fold_angles, crop=True)
            stack.text(
                x + CELL / 2,
                row.top + 0.04,
                _state_title(k + 1, shown[k], freedom),
                fontsize=9.5,
                color=WARNING if verdict(scene, shown[k]) == "unstable" else "black",
                ha="center",
                va="top",
                linespacing=1.25,
            )
    return stack.figure


def _panels(chart: Landscape) -> _Panels:
    if chart.kind == "none":
        return _Panels()
    if chart.kind == "curve":
        return _Panels(((0,),), right=0.2)
    count = len(chart.branches)
    if chart.one_plane:
        return _Panels((tuple(range(count)),))
    return _Panels(tuple((k,) for k in range(count)), width=3.0)


def _rows(
    scene: Scene, shown: tuple[JudgedState, ...], panels: _Panels
) -> tuple[list[_Row], float, float]:
    """Arrange the drawings: rows of them, and the width and height of all that is below the title."""
    shares = [CELL * drawn_height(scene.vertex, m.fold_angles) for m in shown]
    if not panels.groups:
        across = max(1, min(ALONE, len(shown)))
        return _arranged(shares, panels, 0, 2 * MARGIN + across * CELL)
    # as many columns beside the landscape as leave least empty
    options = [
        _arranged(shares, panels, beside, 2 * MARGIN + panels.total[0] + beside * CELL)
        for beside in range(min(len(shown), 1), min(len(shown), MOST_BESIDE) + 1)
    ]
    return min(options, key=lambda option: option[1] * option[2])


def _arranged(
    shares: list[float], panels: _Panels, beside: int, whole: float
) -> tuple[list[_Row], float, float]:
    """Arrange drawings of heights `shares` [in]: so many columns beside the landscape, the others below."""
    width, height = panels.total
    rows: list[_Row] = []
    k, y = 0, 0.0
    while beside and k < len(shares):
        states = range(k, min(k + beside, len(shares)))
        high = max(shares[i] for i in states)
        if y + HEAD + high > height + 0.35:
            break
        rows.append(_Row(states, MARGIN + width, y, high))
        k, y = states.stop, y + HEAD + high + 0.12
    if rows and k == len(shares) and (spare := height - y) > 0:
        # little to show: spread over the height of the landscape
        gap = spare / (len(rows) + 1)
        rows = [_Row(r.states, r.left, r.top + gap * (i + 1), r.height) for i, r in enumerate(rows)]
    y = max(height, y)
    across = int((whole - 2 * MARGIN) / CELL + 1e-9)
    while k < len(shares):
        states = range(k, min(k + across, len(shares)))
        high = max(shares[i] for i in states)
        rows.append(_Row(states, MARGIN, y, high))
        k, y = states.stop, y + HEAD + high + 0.12
    return rows, whole, y


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


def _title(scene: Scene, minima: tuple[JudgedState, ...]) -> list[str]:
    who = scene.label or f"degree {scene.degree}"
    group = f"{scene.group.kind}{subscript(scene.group.order)}"
    symmetry = "" if scene.group.is_trivial else f"symmetry {group}, "
    contact = {"full": "full contact", "fold-limits": "fold limits only", "none": "no contact"}
    found = label_text(f"{who}: {count_words(scene, minima, 'no')}")
    return [found, f"{symmetry}{contact[scene.contact]}"]


def _state_title(number: int, minimum: JudgedState, freedom: int) -> str:
    kind: str = minimum.kind
    if minimum.local_dimension < freedom:
        kind += {0: ", isolated point", 1: ", on a 1-handle"}.get(
            minimum.local_dimension, f", local dimension {minimum.local_dimension}"
        )
    known = "" if minimum.full_space is None else f", {minimum.full_space.verdict}"
    if minimum.shallow:
        kind = f"{minimum.kind}, shallow"
    return f"{number}:  U = {minimum.energy:.4g} {UNIT}{known}\n{kind}\n{barrier_words(minimum.escape, UNIT)}"


def _notes(minima: tuple[JudgedState, ...], chart: Landscape, places: list[Place]) -> list[str]:
    """Say what the picture leaves out or cannot show."""
    notes = []
    if chart.kind == "none":
        notes.append(f"No energy landscape: {chart.reason}.")
    told: dict[str, list[str]] = {}
    for number, place in enumerate(places, start=1):
        if place.family and place.drawn:
            told.setdefault(place.family, []).append(str(number))
    for family, numbers in told.items():
        notes.append(f"At {', '.join(numbers)}: {family}.")
    beyond = [str(k) for k, p in enumerate(places, start=1) if not p.drawn]
    if beyond:
        notes.append(
            f"Not on the landscape ({', '.join(beyond)}): facets have passed through each other, |φ| > π, "
            "or the state winds another number of times round the axis."
        )
    more = len(minima) - MOST_DRAWN
    if more > 0:
        notes.append(f"{more} more minima of higher energy are not drawn.")
    return notes
