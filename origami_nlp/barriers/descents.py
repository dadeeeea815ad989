"""Barriers of a vertex with two or more degrees of freedom: paths that descents show, and the flat state.

Escape paths from each minimum (`kkt.escape_paths_of_each`), and descents from the flat state: with contact it parts
minima whose fold angles sum to more and to less than 0 (docs/validation/landscapes.md), so that a path over it
that climbs no higher is the barrier exactly.  All else bounds it from above: a saddle, exact by its KKT system, or what
a path climbs to, whose middle states were looked at until they lie below that.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.barriers.passes import (
    NEVER,
    PROVED,
    STOPPED,
    Pass,
    both_sides,
    critical_near,
)
from origami_nlp.barriers.paths import PathDown, passes_over_paths
from origami_nlp.barriers.result import Barriers
from origami_nlp.kkt import (
    down_to,
    energy_scale,
    escape_paths_of_each,
    highest,
    level_of,
    rounded_up,
)
from origami_nlp.minima import MinimaResult, canonical_states, with_merge_tree
from origami_nlp.numerics import BESIDE_SINGULAR, DUPLICATE_TOL, INPUT_TOL, coarse
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model
from origami_nlp.search import DescentTerrain, softest_modes

SHOWN = "the lowest path that descents show: lower ones are not excluded"
NONE = "no admissible path is known"
FIRST = 0.02, 0.1, 0.3
"""Of the way from the flat state towards a minimum: where a descent begins [rad]."""
TARGETS = 6
"""Minima towards which descents begin at such a state: the nearest ones on either side."""
RAYS, LATER = 5, 8
"""Rays from a minimum, and states on each, from which careful descents begin."""
HALVINGS = 5
"""Of the step of a ray in which careful descents part."""
NEAR = 0.2
"""Newton finds a saddle within this distance [rad] of the highest state of a way."""
PLACES = 6
"""Decimals of distances that are compared: more are rounding."""


def descent_barriers(model: Model, result: MinimaResult) -> Barriers:
    """Return the barriers of a vertex with two or more degrees of freedom.

    Parameters
    ----------
    model
        Of its scene.
    result
        Its minima, of one winding.

    Returns
    -------
    Barriers
        With the lowest pass that is known between every two minima, and what bounds it from below.
    """
    scene, many = model.scene, len(result.minima)
    minima = np.array([model.reduce(np.array(m.fold_angles)) for m in result.minima])
    minima = minima.reshape(-1, model.size)
    if not many:
        return Barriers(result, (), ())
    posed = canonical_states(result.model, scene, minima)
    of = range(many)
    leaving = {k: softest_modes(posed.problem, posed.minima[k]) for k in of}
    terrain = DescentTerrain(posed.problem, posed.minima, leaving=leaving)
    loose = [k for k, m in enumerate(result.minima) if m.local_dimension != 0]
    ways, beyond = list[PathDown](), np.full(many, math.inf)
    for k, found in escape_paths_of_each(terrain, loose):
        for way in found:
            if way.to < 0:
                beyond[k] = min(beyond[k], way.height)
            elif (known := _way_between(terrain, k, way.states)) is not None:
                ways.append(known)
    left = {way.start for way in ways}
    for k in loose:
        if k not in left and result.minima[k].local_dimension == model.dof:
            ways += _along_rays(terrain, k)
    flat = np.zeros(terrain.problem.size)
    ways += _over_saddles(terrain, ways)
    if scene.vertex.flat and not terrain.problem.refuses(flat):
        ways += _ways_down(terrain, flat)
    ways = [w._replace(states=posed.back(w.states), energy=posed.unit * w.energy) for w in ways]
    whole = passes_over_paths(model, result, minima, ways, None, SHOWN, "bound")
    level = level_of(model.energies(minima), energy_scale(np.array(scene.stiffness)))
    bound = _flat_bound(scene)
    passes = tuple(_bounded(_rounded(p, result), result, *bound, level) for p in whole.passes)
    heights = np.full((many, many), math.inf)
    for p in passes:
        heights[p.from_state - 1, p.to_state - 1] = p.energy
    listed = with_merge_tree(model, result.minima, heights, SHOWN, posed.unit * beyond)
    return replace(whole, result=replace(result, minima=tuple(listed)), passes=passes)


def _way_between(terrain: DescentTerrain, start: int, states: np.ndarray) -> PathDown | None:
    """Go an escape path [S, n] from a minimum on to where it ends, and look at all of it."""
    down = down_to(terrain, states[-1])
    if down is None or down[1] == start:
        return None
    whole = np.concatenate([terrain.minima[start][None], states, down[0][1:]])
    return _checked(terrain, whole, down[1], start)


def _along_rays(terrain: DescentTerrain, k: int) -> Iterator[PathDown]:
    """Go along rays from a minimum until careful descents end at another, where descents in batches jumped early."""
    parting = []
    for _, ray in terrain.rays([k]):
        ends = terrain.land(ray)
        away = np.isfinite(ends).all(axis=1) & (np.abs(ends - terrain.minima[k]).max(axis=1) > NEAR)
        if away.any():
            first = int(np.flatnonzero(away)[0])
            parting.append((float(coarse(terrain.rise(k, ray[: first + 1])).max()), first, ray))
    for _, first, ray in sorted(parting, key=lambda one: one[0])[:RAYS]:
        for j in range(max(first, 1), min(first + LATER, len(ray))):
            down = down_to(terrain, ray[j])
            if down is None or down[1] != k:
                break
        if down is None or down[1] == k:
            continue
        low, high = ray[j - 1], ray[j]
        for _ in range(HALVINGS):
            half = terrain.between(low, high, np.array([0.5]))
            there = None if half is None else down_to(terrain, half[0])
            if half is None or there is None:
                break
            if there[1] == k:
                low = half[0]
            else:
                high, down = half[0], there
        way = np.concatenate([ray[:j], low[None], down[0]])
        if (known := _checked(terrain, way, down[1], k)) is not None:
            yield known


def _checked(
    terrain: DescentTerrain, states: np.ndarray, to: int, start: int = -1
) -> PathDown | None:
    """Cut steps of a way finely, and bound what it climbs; None where it does not close or touch as it should."""
    apart = [True, *(np.abs(a - b).max() > 0 for a, b in itertools.pairwise(states))]
    found = highest(terrain, to, states[apart])
    if found is None:
        return None
    rise, top, dense = found
    begins = start < 0 and np.array_equal(top, dense[0])
    energy = math.nan if begins else terrain.problem.energy(terrain.minima[to]) + rise
    return PathDown(dense, to, start, energy)


def _over_saddles(terrain: DescentTerrain, ways: Sequence[PathDown]) -> list[PathDown]:
    """Go down both sides of the saddles that Newton finds beside the highest states of ways."""
    model, found, out = terrain.problem, list[np.ndarray](), list[PathDown]()
    for way in ways:
        top = way.states[int(model.energies(way.states).argmax())]
        for one in critical_near(model, top[None], NEAR):
            if any(np.abs(one.x - x).max() <= DUPLICATE_TOL for x in found):
                continue
            found.append(one.x)
            for side in both_sides(model, one, list(terrain.minima)) or ():
                if side.lands_on is not None:
                    end = terrain.minima[side.lands_on]
                    states = np.concatenate([one.x[None], side.states, end[None]])
                    out += filter(None, [_checked(terrain, states, side.lands_on)])
    return out


def _ways_down(terrain: DescentTerrain, top: np.ndarray) -> Iterator[PathDown]:
    """Go down from the flat state, beginning towards minima on either side."""
    sides = np.sign([terrain.problem.expand(x).sum() for x in terrain.minima])
    far = np.round(np.linalg.norm(terrain.problem.root * (terrain.minima - top), axis=1), PLACES)
    order = np.argsort(far, kind="stable")
    near = [order[sides[order] == side][:TARGETS] for side in (1.0, -1.0, 0.0)]
    for k in np.concatenate(near).tolist():
        apart = float(np.abs(terrain.minima[k] - top).max())
        for size in FIRST:
            beside = terrain.between(top, terrain.minima[k], np.array([min(1, size / apart)]))
            down = None if beside is None else down_to(terrain, beside[0])
            if down is None:
                continue
            way = _checked(terrain, np.concatenate([top[None], down[0]]), down[1])
            if way is not None:
                yield way
                break


def side_of_flat(fold_angles: np.ndarray) -> np.ndarray:
    """Return on which side of the flat state admissible states [..., N] lie: the sign of the sum of all fold angles.

    Up (+1) and down (-1) are joined by admissible states only through the flat state (0), symmetric or not: round
    every other one |sum phi| >= 2 pi - area(K) > 0, with K the convex hull of the spherical polygon of the vertex,
    facets that touch included (proved in docs/validation/landscapes.md).
    """
    phi = np.asarray(fold_angles, dtype=float)
    total = phi.sum(axis=-1)
    unclear = np.abs(total) <= phi.shape[-1] * DUPLICATE_TOL
    flat = np.abs(phi).max(axis=-1) <= BESIDE_SINGULAR
    return np.where(flat | unclear, 0, np.sign(total)).astype(int)


def _flat_bound(scene: Scene) -> tuple[float, str]:
    """Return what paths between the sides of the flat state climb to at least, and why; nan: nothing parts them."""
    paper = sum(scene.vertex.sector_angles) - 2 * math.pi
    if scene.contact != "full" or paper > INPUT_TOL:
        return math.nan, SHOWN
    if paper < -INPUT_TOL:
        return math.inf, NEVER
    low, high = scene.limit_angles
    if (low > 0).any() or (high < 0).any():
        return math.inf, STOPPED
    return float(scene.energy(np.zeros(scene.degree))), PROVED


def _rounded(p: Pass, result: MinimaResult) -> Pass:
    """Round what an unrefined way climbs up to two digits: more hang on where its steps were cut."""
    if p.pass_kind != "bound":
        return p
    high = max(result.minima[k - 1].energy for k in (p.from_state, p.to_state))
    return replace(p, energy=high + float(rounded_up(p.energy - high)))


def _bounded(p: Pass, result: MinimaResult, flat: float, parted: str, level: float) -> Pass:
    """Add what bounds a pass from below: the flat state, where that parts the two minima."""
    one, two = (result.minima[k - 1].fold_angles for k in (p.from_state, p.to_state))
    why = p.why if len(p.path) else NONE
    if math.isnan(flat) or side_of_flat(np.array(one)) * side_of_flat(np.array(two)) >= 0:
        return replace(p, why=why)
    return replace(p, least=flat, why=parted if p.energy <= flat + level else why)
