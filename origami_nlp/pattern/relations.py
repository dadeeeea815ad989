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

NEAR = 1e-3
"""Relations [rad] that miss by less, but are different, are shown with the model."""
MOST_ROUNDS = 20
"""Of moving sector angles: each makes one more independent relation exact, and there are fewer than N."""
LONGEST_RUN, MOST_SUMS = 12, 2**17
"""Signed sums of more sector angles are not looked at: their number doubles with each; nor, for large N, more sums."""


@dataclass(frozen=True, repr=False)
class Relation(ShortRepr):
    """Signed sum of consecutive sector angles that is, or nearly is, a multiple of pi.

    Attributes
    ----------
    first
        Crease (1-based) where the run of sectors starts.
    signs
        +1 or -1 for each sector of the run; a run of all N sectors is the whole vertex.
    degree
        Number of creases N.
    multiple
        The multiple of pi.
    miss
        Sum - multiple * pi of the angles as stated [rad].
    """

    first: int
    signs: tuple[int, ...]
    degree: int
    multiple: int
    miss: float

    ALSO = ("text",)

    @property
    def text(self) -> str:
        """The relation in words."""
        n, m = self.degree, len(self.signs)
        at_limit = [
            (self.first - 1 + k) % n + 1 for k in range(1, m) if self.signs[k] != self.signs[k - 1]
        ]
        if m == n and self.signs[0] != self.signs[-1]:
            at_limit.append(self.first)
        named = ", ".join(map(str, sorted(at_limit)))
        if m == n:
            return f"folds flat with creases {named} fully folded"
        last = (self.first - 1 + m) % n + 1
        how = "coincide" if self.multiple % 2 == 0 else "lie on one line"
        when = f" while {named} {'is' if len(at_limit) == 1 else 'are'} fully folded" * bool(
            at_limit
        )
        return f"creases {self.first} and {last} {how}{when}"


@dataclass(frozen=True, repr=False)
class Relations(ShortRepr):
    """What a scene decided on the special relations of its sector angles.

    Attributes
    ----------
    sector_angles
        [N], with the relations in `made_exact` made to hold.
    exact
        How many relations hold to rounding.
    made_exact
        Those that missed by at most `RESOLVED` and hold now.
    different
        Those that miss by more, but by at most `NEAR`.
    moved
        Largest change of a sector angle [rad].
    longest
        Sectors in the longest run looked at.
    """

    sector_angles: tuple[float, ...]
    exact: int
    made_exact: tuple[Relation, ...]
    different: tuple[Relation, ...]
    moved: float
    longest: int

    @property
    def lines(self) -> list[str]:
        """What was decided, a line each, as the model prints it."""
        out = []
        if self.exact:
            out.append(f"{self.exact} hold exactly")
        if self.made_exact:
            out.append(
                f"{len(self.made_exact)} made exact, sectors moved by up to {self.moved:.1e} rad:"
            )
            out += _shown(self.made_exact)
        if self.different:
            out.append(
                f"{len(self.different)} nearly hold (to {NEAR:g} rad) and are kept different:"
            )
            out += _shown(self.different)
        return out or ["none holds"]


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
        small = np.abs(left) <= RESOLVED
        if not (small & (np.abs(left) > SUMMED)).any():
            break
        # all that hold or nearly do, and the sum of the angles: consistent, since their coefficients
        # are whole numbers and what they miss by is far below pi
        system = np.vstack([rows[small], np.ones(n)])
        target = np.append(multiples[small] * math.pi, math.fsum(sector_angles))
        for _ in range(2):
            moved = moved + np.linalg.lstsq(system, target - system @ moved, rcond=INDEPENDENT)[0]
    miss = rows @ alpha - multiples * math.pi
    loose = small & (np.abs(miss) > SUMMED)
    return Relations(
        tuple(moved.tolist()) if loose.any() else tuple(sector_angles),
        int((small & ~loose).sum()),
        _named(rows, multiples, miss, loose),
        _named(rows, multiples, miss, ~small),
        float(np.abs(moved - alpha).max()),
        longest,
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
            good = np.abs(miss) <= NEAR
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


def _named(
    rows: np.ndarray, multiples: np.ndarray, misses: np.ndarray, which: np.ndarray
) -> tuple[Relation, ...]:
    """Make relations of coefficient rows, nearest first."""
    found = []
    n = rows.shape[1]
    for row, multiple, miss in zip(rows[which], multiples[which], misses[which], strict=True):
        used = np.flatnonzero(row)
        # a run starts where the crease before it is not used, or at crease 1 for the whole vertex
        first = 0 if len(used) == n else next(int(i) for i in used if row[i - 1] == 0)
        signs = tuple(int(row[(first + k) % n]) for k in range(len(used)))
        found.append(Relation(first + 1, signs, n, int(multiple), float(miss)))
    return tuple(sorted(found, key=lambda r: (abs(r.miss), len(r.signs), r.first)))


def _shown(relations: tuple[Relation, ...], most: int = 4) -> list[str]:
    lines = [f"  {r.text} (missed by {r.miss:+.1e} rad)" for r in relations[:most]]
    return lines + [f"  and {len(relations) - most} more"] * (len(relations) > most)
