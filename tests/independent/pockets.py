"""Neighbours that keep facets touching: sets that exist only where a crease stays on a facet.

A crease that is caught between two layers moves in their plane only; perturbations that merely keep
fold limits never stay there.  Contacts are held to double precision here, so a lower neighbour
counts only beyond what a gap of `TOUCH` could hide: `SLACK` times its distance, in units of the
mean torque.
"""

from __future__ import annotations

import itertools

import numpy as np

from tests.independent.admissible import admissible
from tests.independent.arcs import corner_determinants
from tests.independent.neighbours import WAY, Problem, strata
from tests.independent.rotations import fold
from tests.independent.stationary import Stratum, retract

SLACK = 1e-4
MOST_STRATA = 24


def touching(p: Problem, x: np.ndarray) -> list[tuple[int, int]]:
    """Return (j, k) where crease k lies in the plane of facet j of state x [n], a few at most."""
    d = np.abs(corner_determinants(fold(p.sectors, x[p.orbit])[0])[0])
    n = len(d)
    own = [(j, k) for j in range(n) for k in range(n) if k in (j, (j + 1) % n)]
    return [(j, k) for j, k in zip(*np.nonzero(d < 1e-9), strict=True) if (j, k) not in own]


def look_along_contacts(
    p: Problem, x: np.ndarray, count: int, rng: np.random.Generator
) -> tuple[int, np.ndarray]:
    """Return how many admissible neighbours keep a contact, and those that are lower [m, n]."""
    gaps = touching(p, x)
    seen, lower = 0, []
    choices = [
        (mask, held)
        for mask in strata(p, x)
        if not mask.all()
        for size in (1, 2)
        for held in itertools.combinations(gaps, size)
    ]
    rng.shuffle(choices)
    unit = np.abs(p.torques(x)).mean()
    for mask, held in choices[:MOST_STRATA]:
        limits = tuple((int(v), int(np.sign(x[v]))) for v in np.flatnonzero(mask))
        stratum = Stratum(limits, tuple((int(j), int(k)) for j, k in held))
        radius = rng.choice([1e-2, 1e-3, 1e-4], (count, 1))
        d = rng.normal(size=(count, p.size)) * ~mask
        at_limit = (np.pi - np.abs(x) <= 1e-9) & ~mask
        d[:, at_limit] = -np.sign(x[at_limit]) * np.abs(d[:, at_limit])
        y, residual = retract(p, stratum, x + radius * d / np.linalg.norm(d, axis=1, keepdims=True))
        distance = np.linalg.norm(y - x, axis=1)
        good = (residual <= 1e-13) & (distance > 0.03 * radius[:, 0]) & (distance < 0.05)
        good[good] = admissible(p.sectors, y[good][:, p.orbit], p.contact)
        seen += int(good.sum())
        change = p.energy_change(y, x)
        for k in np.flatnonzero(good & (change < -SLACK * unit * distance)):
            z, left = retract(p, stratum, x + WAY[:, None] * (y[k] - x))
            level = (p.energy_change(z, x) <= 1e-12 * unit).all() and left.max() <= 1e-12
            if level and admissible(p.sectors, z[:, p.orbit], p.contact).all():
                lower.append(y[k])
    return seen, np.array(lower).reshape(-1, p.size)
