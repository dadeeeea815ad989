"""Strings: a path made lower where it is highest, its states sliding down and spread evenly again by turns.

The string method of E, Ren and Vanden-Eijnden (2002), along closed states in which no facets cross.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from origami_nlp.numerics import NONZERO
from origami_nlp.pattern_states.terrain import PatternTerrain

REACH = 4.0
"""Length of the path on either side of its highest state that moves [rad], up to states with a vertex flat."""
SPACING = 0.2
"""Of states on a string [rad]."""
ROUNDS = 40
"""Of sliding and spreading."""
LONGEST = 0.05
"""Step down of a state [rad]."""
SHORTER = 1.0, 0.3, 0.1
"""Shares of a step that are tried where it leads into contact."""


def relaxed(terrain: PatternTerrain, path: np.ndarray) -> np.ndarray | None:
    """Let a path slide down where it is highest.

    Parameters
    ----------
    terrain
        Of the pattern.
    path
        Closed admissible states, close to each other, [S, n] [rad].

    Returns
    -------
    numpy.ndarray
        A path between the same ends, [R, n]; None where one with short steps is not found, or it is highest where a
        vertex is flat.
    """
    if terrain.has_flat(path[int(terrain.problem.energies(path).argmax())]):
        return None  # it stays
    low, high, at = _window(terrain, path)
    many = max(int((at[high] - at[low]) / SPACING), 2) + 1
    even = np.linspace(at[low], at[high], many)
    states = list(path[low + np.abs(at[low : high + 1, None] - even).argmin(axis=0)])
    for _ in range(ROUNDS):
        states = _spread(
            terrain, [_down(terrain, x, k % (many - 1) == 0) for k, x in enumerate(states)]
        )
    moved = terrain.cut(states)
    moved = None if moved is None else terrain.through_flat(moved)
    if moved is None:
        return None
    return terrain.with_tops(np.concatenate([path[:low], moved, path[high + 1 :]]))


def _window(terrain: PatternTerrain, path: np.ndarray) -> tuple[int, int, np.ndarray]:
    """Return first and last state of what moves round the highest one, and how far along the path states are [S]."""
    at = np.r_[0.0, np.cumsum([terrain.distance(a, b) for a, b in pairwise(path)])]
    top = int(terrain.problem.energies(path).argmax())
    flat = np.array([terrain.has_flat(x) for x in path])
    flat[[0, -1]] = True
    before, after = (np.flatnonzero(flat & side) for side in (at < at[top], at > at[top]))
    low = max(int(before[-1]) if len(before) else top, int((at < at[top] - REACH).sum()))
    high = min(int(after[0]) if len(after) else top, int((at <= at[top] + REACH).sum()) - 1)
    return low, high, at


def _down(terrain: PatternTerrain, x: np.ndarray, stays: bool) -> np.ndarray:
    """Slide a state [n] down a little, if it does not stay."""
    problem = terrain.pattern_problem
    pull = -problem.along(x, problem.torque(x)) / problem.stiffness.max()
    pull *= min(1.0, LONGEST / max(float(np.abs(pull).max()), NONZERO))
    moved = (terrain.step(x, x + share * pull) for share in SHORTER * (not stays))
    return next((y for y in moved if y is not None), x)


def _spread(terrain: PatternTerrain, states: list[np.ndarray]) -> list[np.ndarray]:
    """Move states along their polygon to equal distances, where that leads to admissible states."""
    at = np.r_[0.0, np.cumsum([terrain.distance(a, b) for a, b in pairwise(states)])]
    whole, out = np.array(states), list(states)
    for k, place in enumerate(np.linspace(0.0, at[-1], len(states))[1:-1], start=1):
        want = np.array([np.interp(place, at, column) for column in whole.T])
        moved = terrain.step(states[k], want)
        out[k] = states[k] if moved is None else moved
    return out
