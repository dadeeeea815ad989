"""Minima marked on a chart, with their numbers; what the marks mean."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import Any, NamedTuple

from origami_nlp.chart import Place
from origami_nlp.display import label_marks, mark_minimum
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stability import judged
from origami_nlp.pattern import Origami


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
        Of the numbers [points]; None for no numbers.
    clear
        Points that the numbers leave free, each with a diameter [points].
    """
    here = [m for m in drawn if m.place.branch in branches]
    for m in sorted(here, key=lambda m: m.verdict == "unstable"):
        mark_minimum(axes, m.place.point, m.kind, m.verdict, star)
    if font:
        marks = [(m.place.point, str(m.number), star) for m in here]
        label_marks(axes, [*marks, *((point, "", w) for point, w in clear)], font)
