"""Creases that lie on one line all along a stratum, and what a minimum then needs.

Where all creases between two free ones, a and b, are closed (+-pi), their facets lie in one plane, and crease b is at
the angle of the alternating sum of the sectors between from crease a.  If that is a multiple of pi, c_a = s c_b
throughout, s = +-1: closure loses rank there, and all minors may vanish on a whole curve.  But d phi_a = -s d phi_b
keeps closure, so a minimum needs G_a = s G_b.  On a wedge between mirrors a crease may likewise lie across the mirror,
at +-pi/2 from it with all between closed: it turns freely with its image, and needs G_a = 0.

Relations of sectors that hold to within what sectors may be off (`chains.SECTORS`) are taken as exact.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class CollinearPair:
    """Creases of the piece (0-based) on one line while others are closed.

    Attributes
    ----------
    creases
        Two, or one that lies across a mirror.
    sign
        s with G_a = s G_b.
    closed
        Those between, which are to be closed.
    """

    creases: tuple[int, ...]
    sign: int
    closed: tuple[int, ...]


def _sums(sectors: list[float], doubt: float, quarter: float) -> Iterator[tuple[int, float]]:
    """Alternating sums of the first 1, 2, ... sectors that are odd multiples of pi/2, or multiples of pi."""
    for count in range(1, len(sectors) + 1):
        # each closed crease folds the walk back: sectors count forth and back in turn
        total = math.fsum((-1.0) ** i * a for i, a in enumerate(sectors[:count]))
        multiple = round((total - quarter) / math.pi)
        if abs(total - quarter - multiple * math.pi) <= (count + 1) * doubt:
            yield count, total


def collinear_creases_of_loop(sectors: np.ndarray, doubt: float) -> tuple[CollinearPair, ...]:
    """List twins of a vertex without symmetry.

    Parameters
    ----------
    sectors
        Shape [N] [rad].
    doubt
        By which a sector may be off [rad].

    Returns
    -------
    tuple of Twin
        Each pair once for each of the two arcs between that fits.
    """
    n = len(sectors)
    found = []
    for a in range(n):
        run = [float(sectors[(a + i) % n]) for i in range(n - 1)]
        for count, total in _sums(run, doubt, 0.0):
            closed = tuple(sorted((a + i) % n for i in range(1, count)))
            found.append(CollinearPair((a, (a + count) % n), round(math.cos(total)), closed))
    return tuple(found)


def collinear_creases_of_wedge(
    sectors: np.ndarray, crease: list[int | None], doubt: float
) -> tuple[CollinearPair, ...]:
    """List twins of a wedge between two mirrors.

    Parameters
    ----------
    sectors
        Between successive rays, [R - 1] [rad].
    crease
        Number of the crease on each ray, None for a mirror through a facet, [R].
    doubt
        By which a sector may be off [rad].

    Returns
    -------
    tuple of Twin
        Pairs inside the wedge, and single creases across a mirror.
    """
    rays = len(crease)
    found = []
    for r in range(rays):
        a = crease[r]
        if a is None:
            continue
        for count, total in _sums([float(s) for s in sectors[r:]], doubt, 0.0):
            b = crease[r + count]
            between = [crease[r + i] for i in range(1, count)]
            if b is not None:
                closed = tuple(c for c in between if c is not None)
                found.append(CollinearPair((a, b), round(math.cos(total)), closed))
    for way in (1, -1):  # from the first mirror on, from the last one back
        order = list(range(rays))[::way]
        run = [float(s) for s in sectors][::way]
        if crease[order[0]] is not None:
            continue  # fully folded, it lays its facets into the mirror, not across it
        for count, _ in _sums(run, doubt, math.pi / 2):
            a = crease[order[count]]
            if a is not None and count < rays - 1:
                between = [crease[order[i]] for i in range(count)]
                closed = tuple(sorted(c for c in between if c is not None))
                found.append(CollinearPair((a,), 1, closed))
    return tuple(found)


def collinear_rows(
    twins: tuple[CollinearPair, ...], torque: np.ndarray, lean: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return G_a - s G_b of twins: centres [T, K] and slopes [T, n, K].

    Parameters
    ----------
    twins
        T of them.
    torque, lean
        Of every crease at the middle of boxes, and its slope, [n, K].
    """
    n, boxes = torque.shape
    centre, slopes = np.zeros((len(twins), boxes)), np.zeros((len(twins), n, boxes))
    for t, twin in enumerate(twins):
        for crease, factor in zip(twin.creases, (1.0, -float(twin.sign)), strict=False):
            centre[t] += factor * torque[crease]
            slopes[t, crease] += factor * lean[crease]
    return centre, slopes


def twins_asked(twins: tuple[CollinearPair, ...], pins: np.ndarray, flat: np.ndarray) -> np.ndarray:
    """Return on which strata twins lie on one line, [T, K]; pins, and those at +-pi, [n, K]."""
    out = np.zeros((len(twins), pins.shape[1]), dtype=bool)
    for t, twin in enumerate(twins):
        free = (pins[list(twin.creases)] == 0).all(axis=0)
        out[t] = free & (flat[list(twin.closed)] != 0).all(axis=0)
    return out
