"""The picture of minima: energy landscape with the minima marked, and a drawing of every state.

Sizes are in inches and worked out from the contents, so that many minima make a larger figure, not
a crowded one.  Uses matplotlib's object interface only: no global state, any backend.
"""

from __future__ import annotations

import math
import textwrap
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

from origami_nlp.chart import (
    UNIT,
    Landscape,
    colour_bar,
    draw_area,
    draw_curves,
    norm_of,
)
from origami_nlp.minima.marks import WARNING, Marks, legend_entries, mark_minima
from origami_nlp.minima.minimum import Minimum
from origami_nlp.minima.stability import count_words, verdict
from origami_nlp.pattern import Scene
from origami_nlp.show import draw_state, label_text

CELL, CELL_TITLE = 2.35, 0.52
"""Side of a state's drawing, and the height of its title [in]."""
MARGIN, GAP = 0.25, 0.35
MOST_DRAWN = 24
"""States drawn; the figure says how many more there are."""
LINE, SMALL = 0.165, 8.0
"""Height of a line of small text [in], and its font size [points]."""


@dataclass(frozen=True)
class _Panels:
    """Sizes [in] of the landscape: each panel's width and height, gap between them, what is around."""

    count: int
    width: float
    height: float
    gap: float = 0.75
    left: float = 0.75
    right: float = 1.15
    below: float = 0.6

    @property
    def total(self) -> float:
        return self.left + self.count * self.width + (self.count - 1) * self.gap + self.right


def compose(chart: Landscape, minima: tuple[Minimum, ...], freedom: int) -> Figure:
    """Draw minima on the landscape of their scene, and each of them folded.

    freedom: degrees of freedom of the symmetric states.
    """
    scene = chart.scene
    shown = minima[:MOST_DRAWN]
    panels = _panels(chart)
    columns, rows = _grid(len(shown), alone=panels is None)
    places = [chart.place(m.fold_angles) for m in shown] if panels else []
    notes = _notes(minima, chart, places)
    left = panels.total if panels else 0.0
    grid_width = max(columns, 1) * CELL
    width = MARGIN + left + (GAP if panels else 0.0) + grid_width + MARGIN
    width = max(width, 6.0)
    title = textwrap.wrap(_title(scene, minima), max(40, int(width * 9.5)))
    top = 0.2 + 0.26 * len(title)
    text_width = panels.total - 0.3 if panels else width - 2 * MARGIN
    lines = [
        line
        for note in notes
        for line in textwrap.wrap(
            note, max(30, int(text_width * 15)), subsequent_indent="   ", break_on_hyphens=False
        )
    ]
    text = LINE * len(lines)
    entries = legend_entries(chart, shown, places) if panels else []
    legend_columns = max(1, min(len(entries), int(left / 2.1))) if panels else 1
    legend = 0.27 * math.ceil(len(entries) / legend_columns) + 0.1 if entries else 0.0
    grid_height = rows * (CELL + CELL_TITLE)
    if panels:
        height = top + max(0.15 + panels.height + panels.below + legend + text, grid_height) + 0.2
    else:
        height = top + text + 0.1 + max(grid_height, 0.3) + 0.15
    figure = Figure(figsize=(width, height), dpi=110, facecolor="white")

    def place_axes(x: float, y_top: float, w: float, h: float) -> Any:
        return figure.add_axes((x / width, (height - y_top - h) / height, w / width, h / height))

    for k, line in enumerate(title):
        y = 1 - (0.14 + 0.26 * k) / height
        figure.text(MARGIN / width, y, line, fontsize=12, va="top", weight="bold")
    y = top
    if panels:
        y += 0.15
        boxes = [
            place_axes(
                MARGIN + panels.left + k * (panels.width + panels.gap),
                y,
                panels.width,
                panels.height,
            )
            for k in range(panels.count)
        ]
        bar = place_axes(MARGIN + panels.total - panels.right + 0.15, y, 0.16, panels.height)
        _fill_panels(boxes, bar, chart, shown, places)
        y += panels.height + panels.below
        if entries:
            figure.legend(
                handles=entries,
                loc="upper left",
                bbox_to_anchor=((MARGIN + 0.2) / width, 1 - y / height),
                ncols=legend_columns,
                fontsize=SMALL + 0.5,
                frameon=False,
                borderaxespad=0.0,
                columnspacing=1.4,
                handletextpad=0.5,
            )
            y += legend
    for k, line in enumerate(lines):
        x = MARGIN + (0.25 if panels else 0.0)
        figure.text(x / width, 1 - (y + LINE * k) / height, line, fontsize=SMALL, va="top")
    x0 = MARGIN + left + (GAP if panels else 0.0)
    y0 = top if panels else top + text + 0.1
    spread = False
    for k, minimum in enumerate(shown):
        x, y = x0 + (k % columns) * CELL, y0 + (k // columns) * (CELL + CELL_TITLE)
        box = place_axes(x, y + CELL_TITLE, CELL, CELL)
        spread |= draw_state(box, scene.vertex, minimum.fold_angles)
        figure.text(
            (x + CELL / 2) / width,
            1 - (y + 0.05) / height,
            _state_title(k + 1, minimum, freedom),
            fontsize=9.5,
            color=WARNING if verdict(scene, minimum) == "unstable" else "black",
            ha="center",
            va="top",
            linespacing=1.25,
        )
    return figure


def _panels(chart: Landscape) -> _Panels | None:
    if chart.kind == "none":
        return None
    if chart.kind == "curve":
        return _Panels(1, 5.4, 4.4, right=0.3)
    if len(chart.branches) == 1:
        return _Panels(1, 4.9, 4.9)
    return _Panels(len(chart.branches), 3.9, 4.3, right=1.25)


def _grid(count: int, *, alone: bool) -> tuple[int, int]:
    """Columns and rows for the drawings: beside a landscape at most three rows while they fit."""
    if count == 0:
        return 0, 0
    if alone:
        columns = min(count, 4 if count <= 12 else 6)
        return columns, math.ceil(count / columns)
    rows = min(count, 2 if count <= 4 else 3 if count <= 12 else 4)
    columns = math.ceil(count / rows)
    return columns, math.ceil(count / columns)


def _fill_panels(
    boxes: list[Any], bar: Any, chart: Landscape, shown: tuple[Minimum, ...], places: list[Any]
) -> None:
    if chart.kind == "curve":
        bar.remove()
        draw_curves(boxes[0], chart)
        mark_minima(boxes[0], Marks(shown, places, None))
        return
    norm = norm_of(chart)
    image = None
    for k, box in enumerate(boxes):
        avoid = [p.point for p in places if p.branch == k and p.drawn]
        image = draw_area(box, chart, k, norm, avoid)
        mark_minima(box, Marks(shown, places, k))
    colour_bar(image, bar)


def _title(scene: Scene, minima: tuple[Minimum, ...]) -> str:
    who = scene.label or f"degree {scene.degree}"
    subscript = str(scene.group.order).translate(str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉"))
    group = f"{scene.group.kind}{subscript}"
    symmetry = "" if scene.group.is_trivial else f"symmetry {group}, "
    contact = {"full": "full contact", "fold-limits": "fold limits only", "none": "no contact"}
    return label_text(
        f"{who}: {count_words(scene, minima, 'no')}; {symmetry}{contact[scene.contact]}"
    )


def _state_title(number: int, minimum: Minimum, freedom: int) -> str:
    kind: str = minimum.kind
    if minimum.local_dimension < freedom:
        kind += {0: ", isolated point", 1: ", on a 1-handle"}.get(
            minimum.local_dimension, f", local dimension {minimum.local_dimension}"
        )
    known = "" if minimum.full_space is None else f", {minimum.full_space.verdict}"
    return f"{number}:  U = {minimum.energy:.4g} {UNIT}{known}\n{kind}"


def _notes(minima: tuple[Minimum, ...], chart: Landscape, places: list[Any]) -> list[str]:
    """Footnotes: what the picture leaves out or shows differently."""
    notes = []
    scene = chart.scene
    if chart.kind == "none":
        notes.append(f"No energy landscape: {chart.reason}.")
    elif chart.kind == "area":
        white = {
            "full": "crossing facets or |φ| > π",
            "fold-limits": "|φ| > π",
            "none": "no closed state with all |φ| ≤ π",
        }[scene.contact]
        handles = " States that exist only at φ = ±π exactly take no area."
        rest = handles if scene.contact != "none" else ""
        notes.append(f"White: excluded ({white}).{rest}")
        if len(chart.branches) > 1:
            crease = chart.coordinates[1].rsplit(" ", 1)[-1].rstrip(")")
            notes.append(
                f"The branches are the two solutions of loop closure; υ > 0 lowers crease {crease}."
            )
    elif scene.contact != "none":
        notes.append("Lines end where contact excludes the rest.")
    told: dict[str, list[str]] = {}
    for number, place in enumerate(places, start=1):
        if place.family and place.drawn:
            told.setdefault(place.family, []).append(str(number))
    for family, numbers in told.items():
        point = places[int(numbers[0]) - 1].point
        here = "(0, 0)" if max(map(abs, point)) < 1e-6 else f"({point[0]:.3g}, {point[1]:.3g})"
        notes.append(
            f"Ring ({', '.join(numbers)}): {here} is not one state but a family: {family}."
        )
    verdicts = {verdict(scene, m) for m in minima}
    if "not asked" in verdicts:
        notes.append(
            "Minima among symmetric states; whether they are stable when the symmetry breaks was not asked."
        )
    if "unstable" in verdicts:
        notes.append(
            "Red title and outline: a symmetric minimum, but not stable when the symmetry may break."
        )
    if minima:
        notes.append(
            "Drawings: mountain red, valley blue, wider and darker for larger |φ|; "
            "upper side of the paper warm, lower side cool; numbers of hidden creases pale. "
            "Facets that lie on each other are drawn apart."
        )
    beyond = [str(k) for k, p in enumerate(places, start=1) if not p.drawn]
    if beyond:
        notes.append(
            f"Not on the landscape ({', '.join(beyond)}): facets have passed through each other, |φ| > π."
        )
    more = len(minima) - MOST_DRAWN
    if more > 0:
        notes.append(f"{more} more minima of higher energy are not drawn.")
    notes.append(f"Energies in the scene's units: {UNIT} for stiffness in N m/rad.")
    return notes
