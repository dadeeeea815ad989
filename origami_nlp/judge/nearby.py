"""Admissible states near a given one: does a direction exist in reality, and is any neighbour lower?"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.judge.branch import null_space
from origami_nlp.model.embedding import examine
from origami_nlp.model.nlp import Model
from origami_nlp.solve.active import Row, row_values
from origami_nlp.solve.starts import broken_gap

RADII = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3)
"""Radii [rad] at which small spheres are searched."""
SAMPLES = 60
"""Directions tried at each radius."""


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


def is_admissible(model: Model, x: np.ndarray) -> bool:
    """Tell whether a closed state satisfies the contact that the scene asks for."""
    if (np.abs(x) > model.bound + 1e-11).any() or not model.on_sheet(x):
        return False
    if model.scene.contact != "full":
        return True
    if model.structure.gaps and broken_gap(model, model.local(x).gaps) is not None:
        return False
    return examine(model.scene.vertex, model.expand(x)).admissible


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
            if residual <= 1e-11 and 0.1 * step < moved < 10 * step and is_admissible(model, y):
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


def search_spheres(model: Model, x: np.ndarray, rows: tuple[Row, ...], seed: int = 0) -> Search:
    """Look for admissible states at small distances from x, on every stratum of its closed
    contacts.

    Used only where first and second order do not decide.  Stops at the first lower neighbour.
    """
    rng = np.random.default_rng(seed)
    energy = model.energy(x)
    noise = 1e-12 * max(energy, model.scale)
    strata: list[tuple[Row, ...]] = [()]
    limits = [row for row in rows if row.kind == "limit"]
    strata += [(row,) for row in limits]
    strata += [(a, b) for k, a in enumerate(limits) for b in limits[k + 1 :]]
    if len(limits) > 2:
        strata.append(tuple(limits))
    lowest, state, count, smallest, dimension = math.inf, None, 0, math.inf, 0
    for held in strata:
        found = 0
        for radius in RADII:
            for _ in range(SAMPLES):
                d = rng.normal(size=model.size)
                for row in held:
                    d[row.index] = 0.0
                if not d.any():
                    continue
                for row in limits:  # step into the fold limits, not out of them
                    if row not in held:
                        d[row.index] = -row.side * abs(d[row.index])
                y, residual = project(model, x + radius * d / np.linalg.norm(d), held)
                distance = float(np.linalg.norm(y - x))
                if residual > 1e-11 or not 0.05 * radius < distance < 5 * radius:
                    continue
                if not is_admissible(model, y):
                    continue
                count, found = count + 1, found + 1
                smallest = min(smallest, radius)
                change = model.energy_change(x, y)
                if change < lowest:
                    lowest, state = change, y
                if found == 1:
                    local = model.local(y)
                    _, gradients = row_values(model, y, held, local.gaps, local.gaps_jacobian)
                    tangent = null_space(np.vstack([local.closure_jacobian, gradients]))
                    dimension = max(dimension, tangent.shape[1])
                if lowest < -noise:  # one lower neighbour settles it
                    return Search(lowest, state, count, smallest, dimension)
    return Search(lowest, state, count, smallest, dimension)
