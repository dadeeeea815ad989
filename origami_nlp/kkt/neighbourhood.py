"""Admissible states near a given one: do any follow a tangent direction, and is any of them lower?"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt.projection import project
from origami_nlp.kkt.state import State
from origami_nlp.numerics import FOLLOWED, LEVEL, RANK
from origami_nlp.problem import Contact

RADII = (1e-3, 3e-3, 1e-2)
"""Radii [rad] at which small spheres are searched: a lower state far away would prove nothing."""
SAMPLES, TOGETHER = 60, 20
"""Directions tried at each radius, and those of them that are projected at once, with those of the other radii."""
MOST_STRATA = 120
"""Sets of contacts that are held closed in turn."""


GOES = 0.05, 3.0
"""A step drawn back onto closure ends between these distances, over its length: else it led elsewhere."""
STEPS = (1e-3, 1e-4, 1e-5, 1e-6)
"""Lengths [rad] at which a direction is tried: other contacts may close soon after the state."""


def tangent_is_feasible(state: State, tangent: np.ndarray, held: tuple[Contact, ...]) -> bool:
    """Return whether the direction `tangent`, or its mirror image, is followed by admissible states."""
    for step in STEPS:
        for sign in (1.0, -1.0):
            y, residual = project(state.problem, state.x + sign * step * tangent, held)
            moved = np.linalg.norm(y - state.x)
            closes = residual <= FOLLOWED and 0.1 * step < moved < 10 * step
            if closes and not state.problem.refuses(y):
                return True
    return False


@dataclass(frozen=True)
class NeighbourhoodSample:
    """Outcome of a search on small spheres.

    lowest: lowest energy change found at an admissible neighbour, in the scene's units.  state: where, or None where no
    admissible neighbour was found.  tried: closed neighbours at which no facets cross; whether layers have an
    order was asked of those that are lower, and of those on each stratum until one is admissible.
    dimension: largest dimension of the strata on which these lie.
    """

    lowest: float
    state: np.ndarray | None
    tried: int
    dimension: int


def sample_neighbourhood(
    at: State, rows: tuple[Contact, ...], seed: int = 0, radii: tuple[float, ...] = RADII
) -> NeighbourhoodSample:
    """Look for admissible states at small distances from x, on every stratum of its closed
    contacts.

    Used only where first and second order do not decide.  Stops at the first lower neighbour.
    """
    model, x = at.problem, at.x
    energy = model.energy(x)
    noise = LEVEL * max(abs(energy), model.scale)
    lowest, state, tried, dimension = math.inf, None, 0, 0
    seen: set[tuple[Contact, ...]] = set()
    for y, held in _neighbours(at, rows, np.random.default_rng(seed), radii):
        tried += 1
        change = model.energy_change(x, y)
        if (held in seen and change >= -noise) or model.refuses(y):
            continue
        if change < lowest:
            lowest, state = change, y
        if held not in seen:
            seen.add(held)
            dimension = max(dimension, at.at(y).on(held).dimension)
        if lowest < -noise:  # one lower neighbour settles it
            break
    return NeighbourhoodSample(lowest, state, tried, dimension)


def dimension_nearby(state: State, rows: tuple[Contact, ...], seed: int = 0) -> int:
    """Return the dimension of the feasible set around a state, read off its first admissible neighbour.

    Needed where closure loses rank at x, so that its kernel there is larger than the set; strata
    are tried from the largest down.  0 if no neighbour is found.
    """
    for y, held in _neighbours(state, rows, np.random.default_rng(seed)):
        if not state.problem.refuses(y):
            return state.at(y).on(held).dimension
    return 0


def _neighbours(
    state: State,
    rows: tuple[Contact, ...],
    rng: np.random.Generator,
    radii: tuple[float, ...] = RADII,
) -> Iterator[tuple[np.ndarray, tuple[Contact, ...]]]:
    """Yield closed states near x at which no facets cross, with the contacts held closed; their layers may not do."""
    model, x = state.problem, state.x
    limits = [row for row in rows if row.is_limit]
    # a gap is held at zero whatever its side; two creases that lie on each other may turn as one hinge
    gaps = list({row.index: row for row in rows if not row.is_limit}.values())
    # inside; on one limit, on two, on all; on one gap; on all gaps
    strata: list[tuple[Contact, ...]] = [(), *((row,) for row in limits)]
    strata += list(itertools.combinations(limits, 2))
    if len(limits) > 2:
        strata.append(tuple(limits))
    strata += [(row,) for row in gaps]
    strata += [tuple(gaps)] * (len(gaps) > 1)
    strata = list(dict.fromkeys(strata))[:MOST_STRATA]
    # two creases on one line can turn together as one hinge, all others still
    for (v, w), signs, radius in itertools.product(
        _on_one_line(state.local.closure_jacobian), itertools.product((1.0, -1.0), repeat=2), radii
    ):
        y = x.copy()
        y[[v, w]] += radius * np.array(signs)
        closes = np.abs(model.closure(y)[0]).max(initial=0.0) <= FOLLOWED
        if closes and not model.refuses(y):
            yield y, tuple(row for row in limits if row.index not in (v, w))
    samples = SAMPLES if len(strata) < 30 else SAMPLES // 3
    for held in strata:
        for _ in range(0, samples, TOGETHER):
            yield from ((y, held) for y in _sphere(state, limits, held, radii, rng))


def _on_one_line(jacobian: np.ndarray) -> list[tuple[int, int]]:
    """Return the pairs of variables whose turns, in one sense or the other, leave closure still to first order."""
    found = []
    for v in range(jacobian.shape[1] - 1):
        own, others = jacobian[:, v : v + 1], jacobian[:, v + 1 :]
        apart = (np.abs(own + sign * others).max(axis=0, initial=0.0) for sign in (1.0, -1.0))
        least = np.minimum(*apart)
        found += [(v, v + 1 + int(w)) for w in np.flatnonzero(least <= RANK)]
    return found


def _sphere(
    state: State,
    limits: list[Contact],
    contacts: tuple[Contact, ...],
    radii: tuple[float, ...],
    rng: np.random.Generator,
) -> np.ndarray:
    """Return states about each radius from x on one stratum, of `TOGETHER` random directions each."""
    model, x = state.problem, state.x
    # normal deviates, scaled to one length: uniform on the sphere
    d = rng.normal(size=(TOGETHER * len(radii), model.size))
    radius = np.repeat(radii, TOGETHER)
    for row in limits:  # step into the fold limits, not out of them
        d[:, row.index] = 0.0 if row in contacts else -row.side * np.abs(d[:, row.index])
    some = d.any(axis=1)
    d, radius = d[some], radius[some]
    y, residual = project(
        model, x + radius[:, None] * d / np.linalg.norm(d, axis=1, keepdims=True), contacts
    )
    distance = np.linalg.norm(y - x, axis=1)
    good = (residual <= FOLLOWED) & (distance > GOES[0] * radius) & (distance < GOES[1] * radius)
    good[good] = model.admissible(y[good])
    return y[good]
