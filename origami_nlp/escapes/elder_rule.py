"""Escape barriers of states from passes between them: the elder rule.

It is the least energy that a path to a state of no higher energy climbs; where there is none such, to one that is not
shallow itself.
"""

from __future__ import annotations

import math

import numpy as np

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
