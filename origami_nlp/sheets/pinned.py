"""From where descents into contact set out: free states of a curve beside crossing ones, starts that do not cross."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from origami_nlp.facets import MOST_DENSE, Sheet
from origami_nlp.numerics import CLOSES
from origami_nlp.sheets.clearance import Stretches
from origami_nlp.sheets.descent import Descended
from origami_nlp.sheets.pressing import press

SMALLER = 0.8, 0.6, 0.45, 0.3, 0.2, 0.1, 0.05
"""Shares of a start's fold angles, from the reference state on, at which it is asked whether facets cross."""


def press_along(sheet: Sheet, stretches: Stretches) -> Iterator[Descended]:
    """Go down from every state of a curve whose neighbour crosses and is lower.

    Parameters
    ----------
    sheet
        The programme.
    stretches
        Of `Clearance.along`.

    Yields
    ------
    Descended
        In the order of the curve.
    """
    states, crosses = stretches.states, stretches.crosses
    for i in np.flatnonzero(crosses[:-1] != crosses[1:]):
        free, crossed = (i + 1, i) if crosses[i] else (i, i + 1)
        way = sheet.along(states[free], states[crossed] - states[free])
        if sheet.torque(states[free]) @ way < 0:
            yield press(sheet, states[free])


def press_off(sheet: Sheet, path: Sequence[np.ndarray]) -> Descended | None:
    """Go down where a descent that let facets cross would have had to stop.

    Parameters
    ----------
    sheet
        The programme.
    path
        Closed states of the descent, [n] [rad] each.

    Returns
    -------
    Descended
        From the last state before facets cross; where they cross at the start from one that is folded less.  None
        where they cross at none of the states.
    """
    if (
        sheet.size > MOST_DENSE
    ):  # to be refused: it is enough to know whether there was something to do
        return press(sheet, path[-1]) if sheet.crossings.find(path[-1]) else None
    crossed = next((k for k, phi in enumerate(path) if sheet.crossings.find(phi)), None)
    if crossed is None:
        return None
    if crossed:
        return press(sheet, path[crossed - 1])
    reference = sheet.pattern.reference
    for share in SMALLER:
        start, residual = sheet.project(reference + share * (path[0] - reference))
        if residual > CLOSES or not sheet.closure.on_sheet(start) or np.abs(start).max() > math.pi:
            continue
        if not sheet.crossings.find(start):
            return press(sheet, start)
    return Descended(path[0], False, 0, "no start was found at which facets do not cross")
