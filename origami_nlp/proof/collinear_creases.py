"""Creases that lie on one line all along a stratum, and what a minimum then needs.

Where all creases between two free ones, a and b, are closed (+-pi), their facets lie in one plane, and crease b is at
the angle of the alternating sum of the sectors between from crease a.  If that is a multiple of pi, c_a = s c_b
throughout, s = +-1: closure loses rank there, and all minors may vanish on a whole curve.  But d phi_a = -s d phi_b
keeps closure, so a minimum needs G_a = s G_b.

With a symmetry the images of that motion are motions too: arcs without another crease of a or b inside are disjoint,
or lie on one line, so that all of them go on at once, and the symmetric sum says G_a = s G_b of the variables.  Where a
and b are one variable it is no motion for s = 1, and says G_a = 0 for s = -1 (a crease across a mirror).

Relations of sectors that hold to within what sectors may be off (`rows.SECTORS`) are taken as exact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class CollinearPair:
    """Creases on one line while others are closed.

    Attributes
    ----------
    creases
        Variables: two, or one that lies across a mirror.
    sign
        s with G_a = s G_b.
    closed
        Variables between, which are to be closed.
    """

    creases: tuple[int, ...]
    sign: int
    closed: tuple[int, ...]


def collinear_creases(
    sectors: Sequence[float], variable: Sequence[int], doubt: float
) -> tuple[CollinearPair, ...]:
    """List the pairs of a vertex.

    Parameters
    ----------
    sectors
        Of the whole vertex, shape [N] [rad].
    variable
        Of each crease, shape [N].
    doubt
        By which a sector may be off [rad].

    Returns
    -------
    tuple of CollinearPair
        Each pair once for each set of closed ones between that fits.
    """
    n = len(sectors)
    found: dict[CollinearPair, None] = {}
    for a in range(n):
        # each closed crease folds the walk back: sectors count forth and back in turn
        steps = [(-1.0) ** i * sectors[(a + i) % n] for i in range(n - 1)]
        for count in range(1, n):
            total = math.fsum(steps[:count])
            multiple = round(total / math.pi)
            if abs(total - multiple * math.pi) > (count + 1) * doubt:
                continue
            sign = 1 - 2 * (multiple % 2)
            ends = {int(variable[a]), int(variable[(a + count) % n])}
            closed = {int(variable[(a + i) % n]) for i in range(1, count)}
            if not ends & closed and (len(ends) == 2 or sign < 0):
                found[CollinearPair(tuple(sorted(ends)), sign, tuple(sorted(closed)))] = None
    return tuple(found)


def twins_asked(twins: tuple[CollinearPair, ...], pins: np.ndarray, flat: np.ndarray) -> np.ndarray:
    """Return on which strata creases lie on one line, [T, K]; pins, and those at +-pi, [n, K]."""
    out = np.zeros((len(twins), pins.shape[1]), dtype=bool)
    for t, twin in enumerate(twins):
        free = (pins[list(twin.creases)] == 0).all(axis=0)
        out[t] = free & (flat[list(twin.closed)] != 0).all(axis=0)
    return out
