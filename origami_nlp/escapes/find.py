"""What it takes to leave stable states of a vertex or a sheet: as it is known exactly, or bounded by descents."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

import numpy as np

from origami_nlp.errors import OutOfTime
from origami_nlp.escapes.escape import OPEN, Escape, EscapePath, barriers, level_of, rounded_up
from origami_nlp.escapes.paths import escape_paths
from origami_nlp.escapes.terrain import FLOOR, Terrain, energy_scale, number_of
from origami_nlp.pattern_problem import PatternProblem

MOST_CREASES = 60
"""Creases up to which escape paths are sought."""
Move: TypeAlias = Callable[[np.ndarray], np.ndarray]
"""A symmetry: states [..., n] to states."""


def find_escapes(
    problem: PatternProblem,
    at: np.ndarray,
    known: Mapping[int, Escape],
    heights: np.ndarray,
    most: float = math.inf,
) -> list[Escape]:
    """Return what it takes to leave each of some stable states: what is known already, else bounds by escape paths.

    Parameters
    ----------
    problem
        Of a vertex or a sheet.
    at
        The states, [M, n]; ways lead to states among them.
    known
        What is known exactly, by number.
    heights
        Passes that are known between two of them, [M, M]; inf where there is none.
    most
        Counted work that descents may take.

    Returns
    -------
    list of Escape
        One a state; tops of ways in the problem's variables.
    """
    energies, scale, count = problem.energies(at), energy_scale(problem.pattern.stiffness), len(at)
    level, moves, why = level_of(energies, scale), problem.moves, ""
    loose = [k for k in range(count) if k not in known]
    images = images_of(at, moves)
    first = [k for k in loose if is_first(k, images)]
    # out of those of lowest energy, images under symmetries not counted
    last = energies[first[:8]].max(initial=-math.inf) + level
    sought = [k for k in loose if energies[k] <= last]
    ways = dict[int, EscapePath]()
    if problem.pattern.creases > MOST_CREASES:
        why = f"more than {MOST_CREASES} creases: escape paths are not sought"
    elif sought and count > 1:
        # what is found does not depend on how variables are numbered
        aside = problem.labels.drawn(np.random.default_rng(0).normal(size=problem.size))
        terrain = Terrain(problem, at, aside, most)
        try:
            if terrain.usable:
                out_of = [k for k in sought if k in first]
                ways = with_images(escape_paths(terrain, out_of), at, moves)
            else:
                why = "no C compiler was found: escape paths, which many descents show, are not sought"
        except OutOfTime:
            why = "interrupted by the time limit"
    heights, beyond = heights.copy(), np.full(count, math.inf)
    for k, way in ways.items():
        if k not in known and way.to < 0:
            beyond[k] = way.height
        elif k not in known:
            # upwards, by less than any bound: of ways equally high rounding chooses none
            grid = scale * FLOOR / 100
            height = math.ceil((energies[k] + way.height) / grid) * grid
            heights[k, way.to] = min(heights[k, way.to], height)
    out = []
    for k, (barrier, to) in enumerate(barriers(energies, heights, level, scale, beyond)):
        if k in known:
            out.append(known[k])
        elif math.isinf(barrier):
            # that no way was found does not make the barrier infinite: it is not determined
            reason = "no way that was tried led to a state of lower energy"
            if count == 1:
                reason = "no other state is known that it could be left for"
            elif k not in sought:
                reason = f"sought for the {len(sought)} states of lowest energy"
            out.append(Escape(math.nan, OPEN, why or reason))
        else:
            # to two digits: more hang on where steps of descents in batches were cut
            barrier = float(rounded_up(max(barrier, FLOOR * scale)))
            top = tuple(ways[k].top.tolist()) if k in ways and ways[k].to == to else ()
            out.append(Escape.bound(barrier, to, scale, top))
    return out


def images_of(at: np.ndarray, moves: Sequence[Move]) -> np.ndarray:
    """Return which state symmetries make of each state [M, n], -1 where that is not listed, [moves, M]."""
    to = [number_of(x, at) for move in moves for x in move(at)]
    return np.array(to, dtype=int).reshape(len(moves), len(at))


def is_first(k: int, images: np.ndarray) -> bool:
    """Return whether a state is no image, of those of `images_of`, of one before it."""
    return bool(((images[:, k] < 0) | (images[:, k] >= k)).all())


def with_images(
    found: Mapping[int, EscapePath], at: np.ndarray, moves: Sequence[Move]
) -> dict[int, EscapePath]:
    """Return ways out of some states and, of those that have none, out of their images under symmetries."""
    ways = dict(found)
    for move, to in zip(moves, images_of(at, moves).tolist(), strict=True):
        for k, way in found.items():
            end = to[way.to] if way.to >= 0 else -1
            ways.setdefault(to[k], EscapePath(way.height, move(way.top), end))
    return ways
