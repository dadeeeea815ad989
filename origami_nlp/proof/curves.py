"""Curves of closed states cut into boxes of theta (`quad_states`) in which the energy is known.

The slope U' of the energy has no zero in a box, by its value in the middle and U'' over the box; or U'' has none, and
then U' has one at most, which signs of U' at the ends decide.
"""

from __future__ import annotations

import math
import time

import numpy as np

from origami_nlp.proof.curve_contact import TOUCHING, UNKNOWN, CurveContact, FacetTouch
from origami_nlp.proof.curve_ends import CurveEnds
from origami_nlp.proof.curve_energy import (
    LIMIT,
    NONE,
    OPEN,
    TOGETHER,
    StopTouch,
    ThetaEnergy,
    ThetaStretch,
    kinds_of_boxes,
)

NARROWEST = 2.0**-44
"""Width of theta below which a box is left open [rad]."""
BEYOND = math.nextafter(0.5 * math.pi, math.inf)
"""Not below pi/2, which is between two doubles."""
FIRST = np.array([-BEYOND, -1.0, -0.1, 0.13, 1.0, BEYOND])
"""Where the first boxes end [rad]: the flat state, theta = 0, is within one, at any depth."""


def along_curve(
    energy: ThetaEnergy, facets: CurveContact | None, most: int, until: float
) -> tuple[CurveEnds, int]:
    """Cut a curve into boxes of theta in which the energy is known.

    Returns
    -------
    ends : CurveEnds
        Where it is least.
    boxes : int
        How many were examined: so many at most, until then (`time.monotonic`).
    """
    touches: dict[tuple[float, float], tuple[FacetTouch | StopTouch, ...]] = {}
    lower, upper = FIRST[:-1], FIRST[1:]
    cover: list[np.ndarray] = []
    examined = 0
    with np.errstate(all="ignore"):
        while len(lower):
            stop = examined + len(lower) > most or time.monotonic() > until
            examined += len(lower)
            found = kinds_of_boxes(energy, lower, upper, facets, touches)
            # at a limit facets may be flat on others: asked of the state at last (`_limit_contact`)
            at_end = (upper >= BEYOND) | (lower <= -BEYOND)
            at_limit = (found[0] == LIMIT) | ((found[0] == NONE) & at_end)
            found[-1][at_limit & (found[-1] == UNKNOWN) & (upper - lower <= TOGETHER)] = TOUCHING
            # which crease is first at +-pi where the curve ends, smaller boxes may say
            open_ = (found[0] == OPEN) | (found[-1] == UNKNOWN) | ((found[0] == LIMIT) & at_end)
            split = open_ & (upper - lower > NARROWEST) & (not stop)
            cover.append(np.array([lower, upper, *found])[:, ~split])
            middle = 0.5 * (lower + upper)[split]
            lower, upper = np.r_[lower[split], middle], np.r_[middle, upper[split]]
        boxes = np.concatenate(cover, axis=1)
        ends = CurveEnds(energy, facets, touches)
        ends.along([ThetaStretch(*b) for b in boxes[:, np.argsort(boxes[0])].T.tolist()])
    return ends, examined
