"""What it takes to leave stable states of a vertex or a sheet: as it is known exactly, or bounded by descents."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from origami_nlp.errors import OutOfTime
from origami_nlp.escapes.escape import OPEN, Escape, EscapePath, barriers, level_of, rounded_up
from origami_nlp.escapes.paths import escape_paths
from origami_nlp.escapes.terrain import FLOOR, Terrain, energy_scale
from origami_nlp.numerics import NEAR_SINGULAR_TOL, OUTSIDE, SETTLED, coarse
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem

MOST_CREASES = 60
"""Creases up to which escape paths are sought."""
Move: TypeAlias = Callable[[np.ndarray], np.ndarray]
"""A symmetry: states [..., n] to states."""


class _Image(NamedTuple):
    """A state that a symmetry makes of state `of`; to: what it makes of each, -1 where not listed."""

    of: int
    move: Move | None
    to: Sequence[int]

    def way(self, way: EscapePath) -> EscapePath:
        """Return the image of a way."""
        if self.move is None:
            return way
        return EscapePath(way.height, self.move(way.top), self.to[way.to] if way.to >= 0 else -1)


def find_escapes(
    problem: PatternProblem,
    at: np.ndarray,
    known: Mapping[int, Escape],
    *,
    labels: CanonicalLabelling,
    moves: Sequence[Move] = (),
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
    labels
        Of the problem's variables, so that what is found does not depend on how they are numbered.
    moves
        Symmetries of the problem.
    heights
        Passes that are known between two of them, [M, M]; inf where there is none.
    most
        Counted work that descents may take.

    Returns
    -------
    list of Escape
        One a state; tops of ways in the problem's variables.
    """
    energies, scale, why = problem.energies(at), energy_scale(problem.pattern.stiffness), ""
    level, count = level_of(energies, scale), len(at)
    if problem.pattern.creases > MOST_CREASES:
        why = f"more than {MOST_CREASES} creases: escape paths are not sought"
    images = _images(at, moves)
    loose = [k for k in range(count) if k not in known]
    first = [k for k in loose if images[k].of == k]
    # out of those of lowest energy, images under symmetries not counted
    last = energies[first[:8]].max(initial=-math.inf) + level
    sought = [] if why else [k for k in loose if energies[k] <= last]
    ways: dict[int, EscapePath] = {}
    if sought and count > 1:
        out_of = [k for k in sought if k in first]
        aside = labels.drawn(np.random.default_rng(0).normal(size=problem.size))
        leaving = {k: softest_modes(problem, at[k]) for k in out_of}
        terrain = Terrain(problem, at, aside, leaving, most)
        if not terrain.usable:
            why = "no C compiler was found: escape paths, which many descents show, are not sought"
        else:
            try:
                found = escape_paths(terrain, out_of)
                on = [k for k in loose if images[k].of in found]
                ways = {k: images[k].way(found[images[k].of]) for k in on}
            except OutOfTime:
                why = "interrupted by the time limit"
    heights, beyond = heights.copy(), np.full(count, math.inf)
    for k, way in ways.items():
        if way.to < 0:
            beyond[k] = way.height
        else:
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


def _images(at: np.ndarray, moves: Sequence[Move]) -> list[_Image]:
    """Return for each state [M, n] the first one of which it is an image: escape paths are sought of that alone."""
    found, listed = dict[int, _Image](), list[tuple[Move, list[int]]]()
    for move in moves:
        apart = np.array([np.abs(x - at).max(axis=1) for x in move(at)])
        to = np.where(apart.min(axis=1) <= NEAR_SINGULAR_TOL, apart.argmin(axis=1), -1)
        listed.append((move, to.tolist()))
    for k in range(len(at)):
        if k not in found:
            found[k] = _Image(k, None, ())
            for move, where in listed:
                if where[k] >= 0:
                    found.setdefault(where[k], _Image(k, move, where))
    return [found[k] for k in range(len(at))]


def softest_modes(problem: PatternProblem, x: np.ndarray) -> list[np.ndarray]:
    """Return the softest motions of a state that closure allows, fully folded creases held, where they are single."""
    at_limit = np.flatnonzero(problem.fold_limits.room(x) <= OUTSIDE)
    z = problem.kernel(x, at_limit)
    lam, _, _ = problem.multipliers(x, at_limit)
    values, vectors = np.linalg.eigh(z.T @ (problem.hessian(x, lam) @ z))
    if not len(values) or (len(values) > 1 and values[1] - values[0] <= SETTLED):
        return []
    mode = coarse(z @ vectors[:, 0])
    return [mode, -mode]
