"""Rays out of stable states: directions, single variables, vertices that pop, other states, and over flat vertices."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence

import numpy as np

from origami_nlp.escapes.terrain import Terrain
from origami_nlp.numerics import NEAR_SINGULAR_TOL
from origami_nlp.problem import Contact
from origami_nlp.search import at_limits, descend_by_newton

POPPED = 0.02
"""Share of a state by which creases round a vertex are folded beside its flat state."""
SHRUNK = 1.0, 0.75, 0.5, 0.25, 0.0
"""Of a state, its folds times these, whose vertex is made flat: the first at which facets do not cross."""
NEARLY = 1.0, 0.97, 0.9
"""Of a state with a vertex flat, its other folds times these, beside which the vertex pops."""
HALVINGS = 12
"""Of a step into contact."""
MOST_TURNED = 12
"""Variables up to which rays turn each of them by itself."""


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
    walked = dict(
        zip(
            ends,
            terrain.walk(terrain.minima[ends], None, np.tile(flat, (len(ends), 1))),
            strict=True,
        )
    )
    return {
        k: (-float(terrain.over(flat, terrain.minima[k])), np.r_[walked[k], walked[to][-2::-1]], to)
        for k, to in aims.items()
        if not (walked[k][-1].any() or walked[to][-1].any())
    }


def rays(terrain: Terrain, which: Sequence[int]) -> list[tuple[int, np.ndarray]]:
    """Go along directions, turn variables, pop vertices, go to the flat state and on, and to other states."""
    flat, n = np.zeros(terrain.problem.size), terrain.problem.size
    unit = np.eye(n) if n <= MOST_TURNED else np.zeros((0, n))
    of, along, goals = list[int](), list[np.ndarray](), list[np.ndarray]()
    slots, free = list[tuple[Contact, ...]](), list[bool]()
    for k in which:
        ways = [*terrain.leaving.get(k, ()), *unit, *-unit]
        aims = [flat, *terrain.others(k)]
        # contacts of the state are held, and opened, in turn
        rows = terrain.contacts(terrain.minima[k])
        for held in (
            (True, False)
            if rows or at_limits(terrain.problem, terrain.minima[k]).any()
            else (True,)
        ):
            of += [k] * (len(ways) + len(aims))
            along += [*ways, *[flat] * len(aims)]
            goals += [*[np.full(n, math.nan)] * len(ways), *aims]
            slots += [rows if held else ()] * (len(ways) + len(aims))
            free += [not held] * (len(ways) + len(aims))
    if not of:
        return []
    out = list(
        zip(
            of,
            terrain.walk(
                terrain.minima[of], np.array(along), np.array(goals), slots, np.array(free)
            ),
            strict=True,
        )
    )
    for k in which:
        out += [
            (k, _popped(terrain, terrain.minima[k], np.array(v))) for v in terrain.around.get(k, ())
        ]
    return out + over_flat(out) + _over_flat_vertices(terrain, which)


def _over_flat_vertices(terrain: Terrain, which: Sequence[int]) -> list[tuple[int, np.ndarray]]:
    """Go from states of least energy with one vertex flat down to both sides: backwards, these are escape paths."""
    out, seen = list[tuple[int, np.ndarray]](), list[np.ndarray]()
    for k, creases in ((j, creases) for j in which for creases in terrain.around.get(j, ())):
        x = terrain.minima[k]
        kept = np.isin(np.arange(len(x)), creases)
        flat = lowest_flat(terrain, x, kept) if x[creases].any() else None
        if flat is None or not flat.any():
            continue
        if any(np.abs(flat - y).max() <= NEAR_SINGULAR_TOL for y in seen):
            continue
        seen.append(flat)
        sides = []
        for y in (x, -x, *terrain.others(k)):
            starts = (terrain.closed_one(np.where(kept, POPPED * y, t * flat)) for t in NEARLY)
            beside = next((z for z in starts if z is not None), None)
            if beside is None:
                continue
            down = terrain.path_down(beside)
            sides += [down] * (len(down) > 1)
        for down, other in itertools.permutations(sides, 2):
            j = terrain.listed(down[-1])
            if j >= 0 and (kept @ down[0]) * (kept @ other[0]) < 0:
                back = [terrain.minima[j], *down[-2::-1], flat, other[0]]
                terrain.landed |= {y.tobytes(): terrain.minima[j] for y in down}
                terrain.landed[other[0].tobytes()] = other[-1]
                out.append((j, np.array(back)))
    return out


def lowest_flat(terrain: Terrain, x: np.ndarray, kept: np.ndarray) -> np.ndarray | None:
    """Go down from a state with some creases made flat, which stay so, as far as facets do not cross."""
    starts = (terrain.closed_one(np.where(kept, 0.0, t * x), kept) for t in SHRUNK)
    good = next((y for y in starts if y is not None), None)
    if good is None:
        return None
    for y in descend_by_newton(terrain.problem, good, kept=kept).path[1:]:
        share = 1.0
        for _ in range(HALVINGS):
            new = terrain.closed_one(good + share * (y - good), kept)
            if new is not None:
                good = new
                break
            share /= 2
        if share < 1.0:
            break
    return good


def _popped(terrain: Terrain, x: np.ndarray, creases: np.ndarray) -> np.ndarray:
    """Go to where the creases round a vertex are flat, and on to their folds turned over."""
    flat = x.copy()
    flat[creases] = 0.0
    (path,) = terrain.walk(x[None], None, flat[None])
    if np.abs(path[-1][creases]).max() > 0:
        return path
    over = path[-1].copy()
    over[creases] = -x[creases]
    return np.concatenate([path, terrain.walk(path[-1:], None, over[None])[0][1:]])


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
