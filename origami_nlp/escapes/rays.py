"""Rays out of stable states: along directions, single variables, to the flat state and on, and to other states."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from origami_nlp.escapes.terrain import Terrain
from origami_nlp.problem import Contact
from origami_nlp.search import at_limits


def paths_over_flat(
    terrain: Terrain, which: Sequence[int]
) -> dict[int, tuple[float, np.ndarray, int]]:
    """Paths over the flat state, where all states of no more energy are on its other side.

    Where facets of a flat vertex of all creases must not cross no admissible path leads round it
    (docs/validation/landscapes.md).
    """
    p, flat = terrain.problem, np.zeros(terrain.problem.size)
    every = terrain.pops.around and len(set(terrain.pops.around[0])) == p.pattern.creases
    if not (every and p.contact and p.pattern.lies_flat) or p.refuses(flat):
        return {}
    energies = p.energies(terrain.minima)
    side = np.sign(terrain.pops.sums(np.array([p.expand(x) for x in terrain.minima]))[:, 0])
    aims = dict[int, int]()
    for k in which:
        others = np.arange(len(side)) != k
        lower = others & (energies <= energies[k] + terrain.noise[k])
        aim = np.flatnonzero(lower if lower.any() else others)
        if len(aim) and (side[k] * side[aim] < 0).all():
            aims[k] = int(aim[0])
    ends = sorted({*aims, *aims.values()})
    paths = terrain.walk(terrain.minima[ends], None, np.tile(flat, (len(ends), 1)))
    walked = dict(zip(ends, paths, strict=True))
    return {
        k: (-float(terrain.over(flat, terrain.minima[k])), np.r_[walked[k], walked[to][-2::-1]], to)
        for k, to in aims.items()
        if not (walked[k][-1].any() or walked[to][-1].any())
    }


def rays(terrain: Terrain, which: Sequence[int]) -> list[tuple[int, np.ndarray]]:
    """Go along directions, turn variables, go to the flat state and on, and to other states."""
    flat, n = np.zeros(terrain.problem.size), terrain.problem.size
    unit = np.eye(n) if n <= 12 else np.zeros((0, n))
    of, along, goals = list[int](), list[np.ndarray](), list[np.ndarray]()
    slots, free = list[tuple[Contact, ...]](), list[bool]()
    for k in which:
        ways = [*terrain.leaving.get(k, ()), *unit, *-unit]
        aims = [flat, *terrain.others(k)]
        # contacts of the state are held, and opened, in turn
        rows = terrain.contacts(terrain.minima[k])
        closed = rows or at_limits(terrain.problem, terrain.minima[k]).any()
        for held in (True, False) if closed else (True,):
            of += [k] * (len(ways) + len(aims))
            along += [*ways, *[flat] * len(aims)]
            goals += [*[np.full(n, math.nan)] * len(ways), *aims]
            slots += [rows if held else ()] * (len(ways) + len(aims))
            free += [not held] * (len(ways) + len(aims))
    if not of:
        return []
    given = np.array(along), np.array(goals), slots, np.array(free)
    out = list(zip(of, terrain.walk(terrain.minima[of], *given), strict=True))
    return out + over_flat(out)


def over_flat(paths: Iterable[tuple[int, np.ndarray]]) -> list[tuple[int, np.ndarray]]:
    """Join ways from states to the flat state, the shortest of each, to ways from each to every other one.

    Parameters
    ----------
    paths
        States [S, n] with the number of the first.

    Returns
    -------
    list of tuple
        The same of the ways over the flat state.
    """
    to_flat: dict[int, np.ndarray] = {}
    for k, path in paths:
        if not np.abs(path[-1]).max() and (k not in to_flat or len(path) < len(to_flat[k])):
            to_flat[k] = path
    # down to the flat state, and up a path on which another state came to it
    return [
        (k, np.concatenate([path, back[-2::-1]]))
        for k, path in to_flat.items()
        for j, back in to_flat.items()
        if j != k
    ]
