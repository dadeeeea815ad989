"""Escape barriers of states from passes between them, and from escape paths: the elder rule.

It is the least energy that a path to a state of no higher energy climbs; where there is none such, to one that is not
shallow itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from origami_nlp.escapes.escape import BOUND, OPEN, Escape, EscapePath, rounded_up
from origami_nlp.escapes.terrain import FLOOR
from origami_nlp.numerics import LEVEL, SHALLOW


def barriers(
    energies: np.ndarray,
    heights: np.ndarray,
    level: float,
    scale: float,
    beyond: np.ndarray | None = None,
) -> list[tuple[float, int]]:
    """Return the escape barrier of each state, and the position of the state that it leads to, -1 for none.

    Parameters
    ----------
    energies
        Of the states, [M].
    heights
        Of the lowest pass between two of them, over zero, [M, M]; inf where there is none.
    level
        Energies that differ by no more are equal.
    scale
        Of energies, see `energy_scale`.
    beyond
        What a way from each to a lower state that is not among these climbs, [M]; inf for none.

    Returns
    -------
    list
        A pair a state; the barrier is inf where no way is known.
    """
    heights = _closed(heights)
    out: list[tuple[float, int]] = []
    for k, energy in enumerate(energies):
        others = (energies <= energy + level) & (np.arange(len(energies)) != k)
        found = _least(heights[k], others, energy)
        direct = math.inf if beyond is None else float(beyond[k])
        out.append(found if found[0] <= direct else (direct, -1))
    for k, (barrier, _) in enumerate(out):
        # the lowest state has no lower one to go to: its barrier is that to any other that is not shallow
        if math.isinf(barrier) and (energies >= energies[k] - level).all():
            deep = np.array([b >= SHALLOW * scale for b, _ in out])
            deep[k] = False
            out[k] = _least(heights[k], deep, energies[k])
    return out


def _least(heights: np.ndarray, which: np.ndarray, energy: float) -> tuple[float, int]:
    if not which.any():
        return math.inf, -1
    j = int(np.where(which, heights, math.inf).argmin())
    return (
        (float(max(heights[j] - energy, 0.0)), j) if math.isfinite(heights[j]) else (math.inf, -1)
    )


def _closed(heights: np.ndarray) -> np.ndarray:
    """Return heights [M, M] of ways over other states as well, where these are lower."""
    # least height over all ways: the recursion of Floyd and Warshall with (min, max) in place of (min, +)
    h = np.minimum(heights, heights.T)
    for k in range(len(h)):
        h = np.minimum(h, np.maximum(h[:, k : k + 1], h[k]))
    return h


def level_of(energies: np.ndarray, scale: float) -> float:
    """Return by how much energies may differ that are equal [their units]."""
    return LEVEL * (scale + float(np.abs(energies).max(initial=0.0)))


def bounds(
    energies: np.ndarray,
    ways: Mapping[int, EscapePath],
    heights: np.ndarray,
    scale: float,
    reported: Mapping[int, Escape],
    unknown: Callable[[int], str],
    among: str = "",
) -> list[Escape]:
    """Return what it takes to leave each state: as it is known already, or bounded by escape paths.

    Parameters
    ----------
    energies
        Of the states, [M].
    ways
        Escape paths from some of them.
    heights
        Of the lowest pass between two of them, over zero, as far as it is known, [M, M].
    scale
        Of energies, see `energy_scale`.
    reported
        What is known of some without bounds.
    unknown
        Why there is no escape path of one.
    among
        What ways keep, in words.

    Returns
    -------
    list of Escape
        One a state; tops of ways in the problem's variables.
    """
    heights, beyond = heights.copy(), np.full(len(energies), math.inf)
    for k, way in ways.items():
        if way.to < 0:
            beyond[k] = way.height
        else:
            # upwards, by less than any bound: of ways equally high rounding chooses none
            grid = scale * FLOOR / 100
            heights[k, way.to] = min(
                heights[k, way.to], math.ceil((energies[k] + way.height) / grid) * grid
            )
    out = []
    level = level_of(energies, scale)
    for k, (barrier, to) in enumerate(barriers(energies, heights, level, scale, beyond)):
        if k in reported:
            out.append(reported[k])
        elif math.isinf(barrier):
            # that no way was found does not make the barrier infinite: it is not determined
            out.append(Escape(math.nan, OPEN, unknown(k)))
        else:
            # to two digits: more hang on where steps of descents in batches were cut
            barrier = float(rounded_up(max(barrier, FLOOR * scale)))
            why = f"an explicit escape path climbs so high; lower ones are not excluded{among}"
            top = tuple(ways[k].top.tolist()) if k in ways and ways[k].to == to else ()
            out.append(Escape(barrier, BOUND, why, to + 1, top, barrier < SHALLOW * scale))
    return out
