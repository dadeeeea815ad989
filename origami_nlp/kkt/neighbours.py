"""Admissible states near a given one: does a direction exist in reality, and is any neighbour lower?"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import null_space
from origami_nlp.programme import Model, Row, is_admissible, row_values

RADII = (1e-3, 3e-3, 1e-2)
"""Radii [rad] at which small spheres are searched: a lower state far away would prove nothing."""
SAMPLES = 60
"""Directions tried at each radius."""
MOST_STRATA = 120
"""Sets of contacts that are held closed in turn."""


def project(
    model: Model, x: np.ndarray, rows: tuple[Row, ...], steps: int = 30
) -> tuple[np.ndarray, float]:
    """Project x onto closure with `rows` held closed, by Gauss-Newton; returns state and residual."""
    residual = math.inf
    for _ in range(steps):
        local = model.local(x)
        values, gradients = row_values(model, x, rows, local.gaps, local.gaps_jacobian)
        f = np.concatenate([local.closure, values])
        residual = float(np.abs(f).max())
        if residual <= 1e-14:
            break
        jac = np.vstack([local.closure_jacobian, gradients])
        x = x - np.linalg.lstsq(jac, f, rcond=1e-8)[0]
    for row in rows:
        if row.kind == "limit" and abs(x[row.index] - row.side * math.pi) <= 1e-9:
            x[row.index] = row.side * math.pi
    return x, residual


CLOSES = 1e-13
"""A neighbour closes at least this well: at a singular state any point at distance d nearly closes, to d^2."""
STEPS = (1e-3, 1e-4, 1e-5, 1e-6)
"""Lengths [rad] at which a direction is tried: other contacts may close soon after the state."""


def leads_somewhere(
    model: Model, x: np.ndarray, tangent: np.ndarray, held: tuple[Row, ...]
) -> bool:
    """Tell whether the direction `tangent`, or its mirror image, is followed by admissible states."""
    for step in STEPS:
        for sign in (1.0, -1.0):
            y, residual = project(model, x + sign * step * tangent, held)
            moved = np.linalg.norm(y - x)
            if residual <= CLOSES and 0.1 * step < moved < 10 * step and is_admissible(model, y):
                return True
    return False


@dataclass(frozen=True)
class Search:
    """Outcome of a search on small spheres.

    lowest: lowest energy change found, in the scene's units.  state: where, or None where no
    admissible neighbour was found.  admissible: how many neighbours were admissible.  radius:
    smallest radius with any.
    dimension: largest dimension of the strata on which they lie.
    """

    lowest: float
    state: np.ndarray | None
    admissible: int
    radius: float
    dimension: int


def search_spheres(
    model: Model,
    x: np.ndarray,
    rows: tuple[Row, ...],
    seed: int = 0,
    radii: tuple[float, ...] = RADII,
) -> Search:
    """Look for admissible states at small distances from x, on every stratum of its closed
    contacts.

    Used only where first and second order do not decide.  Stops at the first lower neighbour.
    """
    energy = model.energy(x)
    noise = 1e-12 * max(energy, model.scale)
    lowest, state, count, smallest, dimension = math.inf, None, 0, math.inf, 0
    seen: set[tuple[Row, ...]] = set()
    for y, held, radius in _neighbours(model, x, rows, np.random.default_rng(seed), radii):
        count += 1
        smallest = min(smallest, radius)
        change = model.energy_change(x, y)
        if change < lowest:
            lowest, state = change, y
        if held not in seen:
            seen.add(held)
            dimension = max(dimension, _dimension_at(model, y, held))
        if lowest < -noise:  # one lower neighbour settles it
            break
    return Search(lowest, state, count, smallest, dimension)


def dimension_nearby(model: Model, x: np.ndarray, rows: tuple[Row, ...], seed: int = 0) -> int:
    """Return the dimension of the feasible set around x, read off its first admissible neighbour.

    Needed where closure loses rank at x, so that its kernel there is larger than the set; strata
    are tried from the largest down.  0 if no neighbour is found.
    """
    for y, held, _ in _neighbours(model, x, rows, np.random.default_rng(seed)):
        return _dimension_at(model, y, held)
    return 0


def _dimension_at(model: Model, y: np.ndarray, held: tuple[Row, ...]) -> int:
    local = model.local(y)
    _, gradients = row_values(model, y, held, local.gaps, local.gaps_jacobian)
    return null_space(np.vstack([local.closure_jacobian, gradients])).shape[1]


def _neighbours(
    model: Model,
    x: np.ndarray,
    rows: tuple[Row, ...],
    rng: np.random.Generator,
    radii: tuple[float, ...] = RADII,
) -> Iterator[tuple[np.ndarray, tuple[Row, ...], float]]:
    """Yield admissible states near x with the contacts held closed and the radius tried."""
    limits = [row for row in rows if row.kind == "limit"]
    # a gap is held at zero whatever its side; two creases that lie on each other may turn as one hinge
    gaps = list({row.index: row for row in rows if row.kind == "gap"}.values())
    strata: list[tuple[Row, ...]] = [(), *((row,) for row in limits)]
    strata += list(itertools.combinations(limits, 2))
    if len(limits) > 2:
        strata.append(tuple(limits))
    strata += [(row,) for row in gaps]
    strata += _hinges(model, x, gaps)
    strata = list(dict.fromkeys(strata))[:MOST_STRATA]
    # two creases on one line can turn together as one hinge, all others still
    for (v, w), signs, radius in itertools.product(
        itertools.combinations(range(model.size), 2),
        itertools.product((1.0, -1.0), repeat=2),
        radii,
    ):
        y = x.copy()
        y[[v, w]] += radius * np.array(signs)
        closes = np.abs(model.closure(y)[0]).max() <= CLOSES
        if closes and is_admissible(model, y):
            still = tuple(row for row in limits if row.index not in (v, w))
            yield y, still, radius
    for held, radius in itertools.product(strata, radii):
        for _ in range(SAMPLES if len(strata) < 30 else SAMPLES // 3):
            d = rng.normal(size=model.size)
            for row in limits:  # step into the fold limits, not out of them
                d[row.index] = 0.0 if row in held else -row.side * abs(d[row.index])
            if not d.any():
                continue
            y, residual = project(model, x + radius * d / np.linalg.norm(d), held)
            distance = float(np.linalg.norm(y - x))
            if residual > CLOSES or not 0.05 * radius < distance < 3 * radius:
                continue
            if is_admissible(model, y):
                yield y, held, radius


def _hinges(model: Model, x: np.ndarray, gaps: list[Row]) -> list[tuple[Row, ...]]:
    """Return, for each two creases that lie on each other, the gaps that keep them so."""
    rays = model.rays(x)
    n = len(rays)
    together: dict[tuple[int, int], list[Row]] = {}
    for row in gaps:
        gap = model.structure.gaps[row.index]
        if gap.type != "facet-pair":
            continue
        k, j = gap.rays
        for end in (j, (j + 1) % n):
            if np.linalg.norm(rays[k] - rays[end]) <= 1e-7:
                together.setdefault((min(k, end), max(k, end)), []).append(row)
    return [tuple(rows) for rows in together.values() if len(rows) > 1]
