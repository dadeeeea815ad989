"""Minima marked on a chart, with their numbers; what the marks mean."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import Any, NamedTuple

from matplotlib.lines import Line2D

from origami_nlp.chart import Place
from origami_nlp.display import RING, label_marks, mark_minimum, minima_legend
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stability import judged
from origami_nlp.pattern import Origami

FAMILY = 1.3
"""Size of the ring around a family against a star's."""


class Drawn(NamedTuple):
    """A minimum that lies on a chart.

    Attributes
    ----------
    number
        Of the minimum, from 1.
    kind, verdict
        What its mark says.
    place
        Where it is.
    """

    number: int
    kind: str
    verdict: str | None
    place: Place


def drawn_minima(
    origami: Origami, minima: Sequence[JudgedState], places: Sequence[Place]
) -> list[Drawn]:
    """Return the minima that a chart has a place for.

    Parameters
    ----------
    origami, minima
        What is folded, and its minima.
    places
        Of each on the chart; empty where there is none.

    Returns
    -------
    list of Drawn
        Those that can be drawn.
    """
    return [
        Drawn(k, m.kind, judged(origami, m), p)
        for k, (m, p) in enumerate(zip(minima, places, strict=False), start=1)
        if p.drawn
    ]


def mark_minima(
    axes: Any,
    drawn: Iterable[Drawn],
    branches: Collection[int],
    star: float,
    font: float | None = None,
    clear: Sequence[tuple[tuple[float, float], float]] = (),
) -> None:
    """Mark minima of some branches, unstable ones on top; those that share a point share a number.

    Parameters
    ----------
    axes
        Of matplotlib.
    drawn
        Of `drawn_minima`.
    branches
        Which of the chart's, from 0.
    star
        Size of a star [points].
    font
        Of the numbers [points]; None for neither numbers nor rings around families.
    clear
        Points that the numbers leave free, each with a diameter [points].
    """
    here = [m for m in drawn if m.place.branch in branches]
    for m in sorted(here, key=lambda m: m.verdict == "unstable"):
        if m.place.family and font:
            look = RING | {"ms": FAMILY * star}
            axes.plot(*m.place.point, **look, zorder=6, clip_on=False)
        mark_minimum(axes, m.place.point, m.kind, m.verdict, star)
    if font:
        wide = [FAMILY * star if m.place.family else star for m in here]
        marks = [(m.place.point, str(m.number), w) for m, w in zip(here, wide, strict=True)]
        label_marks(axes, [*marks, *((point, "", w) for point, w in clear)], font)


def marks_legend(drawn: Sequence[Drawn], star: float, rings: bool = True) -> list[Line2D]:
    """Return legend entries for the minima that are marked.

    Parameters
    ----------
    drawn
        Of `drawn_minima`.
    star
        Size of a star in the picture [points].
    rings
        Whether families have rings.

    Returns
    -------
    list of matplotlib.lines.Line2D
        Handles with labels.
    """
    entries = minima_legend(((m.kind, m.verdict) for m in drawn), 0.85 * star)
    if rings and any(m.place.family for m in drawn):
        entries.append(Line2D([], [], **RING, ms=12, label="several states there"))
    return entries
