"""Paths of patterns made lower where they are highest: as strings, and over the saddles that Newton finds there."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from origami_nlp.barriers.passes import Descent, Pass, both_sides, critical_near
from origami_nlp.barriers.paths import PathDown
from origami_nlp.numerics import NEAR_SINGULAR_TOL
from origami_nlp.pattern_states import PatternTerrain, relaxed

MOST_STRINGS = 12
"""Highest states of paths that are made lower: first those that the most pairs of minima have to pass."""
NEAR = 0.3
"""Newton finds a saddle within this distance [rad] of the highest state of a path."""


def lower_ways(
    terrain: PatternTerrain, passes: Sequence[Pass], floors: Sequence[float], level: float
) -> Iterator[PathDown]:
    """Make paths lower that climb above what bounds them.

    Parameters
    ----------
    terrain
        Of the pattern, with the minima that the passes lie between.
    passes
        With their paths.
    floors
        What each of these climbs to at least, as far as that is known.
    level
        Energies that are no more apart are the same.

    Yields
    ------
    PathDown
        Paths that climb less high.
    """
    both = zip(passes, floors, strict=True)
    high = [p for p, floor in both if floor + level < p.energy < math.inf]
    often, first = Counter(p.energy for p in high), {p.energy: p for p in reversed(high)}
    for energy, _ in sorted(often.items(), key=lambda one: (-one[1], one[0]))[:MOST_STRINGS]:
        p, path = first[energy], relaxed(terrain, first[energy].path)
        if path is not None and terrain.problem.energies(path).max() < energy - level:
            yield PathDown(path, p.to_state - 1, p.from_state - 1)
        for way in (p.path, path):
            over = () if way is None else tuple(_over_saddle(terrain, way))
            yield from over
            if over:
                break


def _over_saddle(terrain: PatternTerrain, path: np.ndarray) -> Iterator[PathDown]:
    """Go down both sides of the saddle that Newton finds beside the highest state of a path [S, n]."""
    minima = terrain.minima

    def down(_: object, start: np.ndarray, __: object) -> Descent | None:
        way = terrain.path_down(start, lambda _: False)
        apart = np.abs(minima - way[-1]).max(axis=1)
        k = int(apart.argmin())
        return Descent(way, k) if apart[k] <= NEAR_SINGULAR_TOL and len(way) > 1 else None

    top = path[int(terrain.problem.energies(path).argmax())]
    for one in critical_near(terrain.problem, top[None], NEAR):
        for side in both_sides(terrain.problem, one, list(minima), down) or ():
            assert side.lands_on is not None
            states = np.concatenate([one.x[None], side.states[:-1], minima[side.lands_on][None]])
            yield PathDown(states, side.lands_on)
