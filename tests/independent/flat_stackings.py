"""Which mountain-valley assignments fold a vertex flat?  Every stacking of its facets is tried.

The creases of the folded vertex lie on a line, and facet i on the interval between two of them; facets alternate
between face up and face down.  A stacking puts each facet on a layer of its own.  It is possible when

- no facet passes through a crease: where one reaches across the place of a crease, it lies above or below both
  facets of that crease, not between them (taco and tortilla);
- creases in one place that open to one side do not interleave: with the facets of one at layers a < b and of the
  other at c < d, not a < c < b < d nor c < a < d < b (taco and taco).

A crease is a valley when the next facet lies above a facet that is face up, or below one that is face down.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from fractions import Fraction

import numpy as np


def assignments(sectors: Sequence[Fraction | int]) -> set[tuple[int, ...]]:
    """Return the assignments (+1 valley, -1 mountain, crease i before sector i) of all possible stackings.

    sectors: in any unit, exact; their alternating sum must vanish (Kawasaki).
    """
    n = len(sectors)
    place = [Fraction(0)]
    for i, a in enumerate(sectors):
        place.append(place[-1] + (a if i % 2 == 0 else -a))
    if place.pop() != 0:
        return set()
    layer = np.array(list(itertools.permutations(range(n))), dtype=np.int8)
    good = np.ones(len(layer), dtype=bool)
    low = [np.minimum(layer[:, i - 1], layer[:, i]) for i in range(n)]
    high = [np.maximum(layer[:, i - 1], layer[:, i]) for i in range(n)]
    for crease, facet in itertools.product(range(n), repeat=2):
        ends = sorted((place[facet], place[(facet + 1) % n]))
        if ends[0] < place[crease] < ends[1]:
            good &= (layer[:, facet] < low[crease]) | (layer[:, facet] > high[crease])
    for c, d in itertools.combinations(range(n), 2):
        # even creases begin facets that run up the line: they open upwards
        if place[c] == place[d] and (c - d) % 2 == 0:
            first = (low[c] < low[d]) & (low[d] < high[c]) & (high[c] < high[d])
            second = (low[d] < low[c]) & (low[c] < high[d]) & (high[d] < high[c])
            good &= ~first & ~second
    above = layer > np.roll(layer, 1, axis=1)  # facet i above facet i - 1, at crease i
    before_is_up = np.arange(n) % 2 == 1  # facet 0 is face up: facet i - 1 is where i is odd
    signs = np.where(above == before_is_up, 1, -1)[good]
    return set(map(tuple, signs.tolist()))
