"""Special relations between the sector angles of a vertex, decided once: exact, made exact, or different.

Where the creases between creases i and j lie at 0 or +-pi, their facets form one flat plate, and the
angle from crease i to crease j is a signed sum of sector angles, the sign turning at every fully folded crease.
The space of folded states is singular where such a sum is a multiple of pi: the two creases then lie on
one line and turn as one hinge, or, for the whole vertex, it folds flat.  In double precision a sum that
misses such a value by much less than the accuracy of contacts (1e-8 rad) can neither be distinguished from it nor
be treated as equal to it: a state next to the singular set closes to the square of its distance.

So each scene decides: a sum within rounding of a multiple of pi is *exact*; one within `RESOLVED` of it is
*made exact*, by moving the sector angles as little as possible; every other sum is *different* from it.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.numerics import INDEPENDENT, RESOLVED, SUMMED

MOST_ROUNDS = 20
"""Of moving sector angles: each makes one more independent relation exact, and there are fewer than N."""
LONGEST_RUN, MOST_SUMS = 12, 2**17
"""Signed sums of more sector angles are not looked at: their number doubles with each; nor, for large N, more sums."""


@dataclass(frozen=True, repr=False)
class Relations(ShortRepr):
    """Special relations of the sector angles of a vertex.

    Attributes
    ----------
    sector_angles
        Those in which every relation that holds to 1e-7 rad holds exactly [rad].
    exact
        How many held as stated.
    made_exact
        How many hold since sectors were moved.
    moved
        Largest change of a sector angle [rad].
    """

    sector_angles: tuple[float, ...]
    exact: int
    made_exact: int
    moved: float


@lru_cache(maxsize=4096)
def find_relations(sector_angles: tuple[float, ...]) -> Relations:
    """Decide the signed sums of consecutive sector angles of a vertex, up to `LONGEST_RUN` sectors long.

    Parameters
    ----------
    sector_angles
        Shape [N] [rad].

    Returns
    -------
    Relations
        With the sector angles moved so that near relations hold; their sum is kept.
    """
    alpha = np.array(sector_angles)
    n = len(alpha)
    longest = min(n, LONGEST_RUN, int(math.log2(MOST_SUMS / n)))
    moved = alpha
    # sector angles that were moved may come near further relations: until none is left between, so that angles
    # which were decided once, and are read or relabelled, stay as they are
    for _ in range(MOST_ROUNDS):
        rows, multiples, left = _near_relations(moved, longest)
        if not (np.abs(left) > SUMMED).any():
            break
        # all that hold or nearly do, and the sum of the angles: consistent, since their coefficients
        # are whole numbers and what they miss by is far below pi
        system = np.vstack([rows, np.ones(n)])
        target = np.append(multiples * math.pi, math.fsum(sector_angles))
        for _ in range(2):
            moved = moved + np.linalg.lstsq(system, target - system @ moved, rcond=INDEPENDENT)[0]
    loose = int((np.abs(rows @ alpha - multiples * math.pi) > SUMMED).sum())
    return Relations(
        tuple(moved.tolist()) if loose else tuple(sector_angles),
        len(rows) - loose,
        loose,
        float(np.abs(moved - alpha).max()),
    )


def _near_relations(alpha: np.ndarray, longest: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return coefficients [r, N], multiples of pi [r] and misses [r] of relations within `NEAR`."""
    n = len(alpha)
    rows, multiples, misses = [np.zeros((0, n))], [np.zeros(0)], [np.zeros(0)]
    for length in range(2, longest + 1):
        signs = _signs(length)
        whole = length == n
        for first in range(1 if whole else n):
            run = (first + np.arange(length)) % n
            total = signs @ alpha[run]
            # the whole vertex: a fold by pi would leave it turned over, so only even multiples count
            step = 2 if whole else 1
            multiple = step * np.round(total / (step * math.pi))
            miss = total - multiple * math.pi
            good = np.abs(miss) <= RESOLVED
            if whole:
                good &= ~(signs > 0).all(
                    axis=1
                )  # the sum of all is no relation: it is kept as it is
            if good.any():
                row = np.zeros((int(good.sum()), n))
                row[:, run] = signs[good]
                rows.append(row)
                multiples.append(multiple[good])
                misses.append(miss[good])
    return np.vstack(rows), np.concatenate(multiples), np.concatenate(misses)


@lru_cache(maxsize=16)
def _signs(length: int) -> np.ndarray:
    """Return all signs of a run, the first +1, shape [2^(length-1), length]."""
    return np.array([(1, *rest) for rest in itertools.product((1, -1), repeat=length - 1)])
