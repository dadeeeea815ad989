"""Random admissible states near a state, and whether any of them is lower in energy.

Perturbations are drawn in the symmetry space of the scene, at radii from 1e-1 to 1e-6, on every
stratum of the fold limits that the state has reached (some sets exist only at phi = +-pi), and are
projected onto exact closure.

Bound on rounding, `energy_noise`: two energies computed from N squares differ by rounding at most
about 2 N eps (U + U'), a fold angle is known to eps pi, which moves U by sum |torque| eps pi, and a
closure residual rho moves a state by at most rho / sigma, sigma the smallest singular value of the
closure Jacobian of the state, and so the energy by |torque| rho / sigma.

A lower neighbour refutes a minimum only where the straight way to it, projected onto closure, stays
admissible and never climbs: another piece of the feasible set, or another basin, may pass within
1e-1.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from origami_nlp import Scene
from tests.independent.admissible import admissible
from tests.independent.exact import lower_after_all
from tests.independent.rotations import fold, project

RADII = np.logspace(-1, -6, 11)
EPS = np.finfo(float).eps


@dataclass(frozen=True)
class Problem:
    """A scene as arrays: sector angles, orbit of each crease, stiffness, rest angles, contact."""

    sectors: np.ndarray
    orbit: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray
    contact: str

    @classmethod
    def of(cls, scene: Scene) -> Problem:
        return cls(
            np.array(scene.vertex.sector_angles),
            np.unique(scene.group.orbit, return_inverse=True)[1],
            np.array(scene.stiffness),
            np.array(scene.rest_angles),
            scene.contact,
        )

    @property
    def size(self) -> int:
        return int(self.orbit.max()) + 1

    def reduce(self, phi: np.ndarray) -> np.ndarray:
        """Return the orbit angles of a symmetric state; the first crease of each orbit decides."""
        first = [int(np.flatnonzero(self.orbit == v)[0]) for v in range(self.size)]
        return np.asarray(phi, dtype=float)[..., first]

    def energy(self, x: np.ndarray) -> np.ndarray:
        return 0.5 * ((np.asarray(x)[..., self.orbit] - self.rest) ** 2 @ self.stiffness)

    def energy_change(self, x: np.ndarray, start: np.ndarray) -> np.ndarray:
        """U(x) - U(start) without cancellation."""
        d = (np.asarray(x) - start)[..., self.orbit]
        return (d * (0.5 * d + start[self.orbit] - self.rest)) @ self.stiffness

    def torques(self, x: np.ndarray) -> np.ndarray:
        return self.stiffness * (np.asarray(x)[..., self.orbit] - self.rest)


@dataclass(frozen=True)
class Around:
    """What was found around a state.

    tried, admitted: perturbations projected to closure, and those that are admissible.
    lower: connected admissible states that are lower in energy beyond rounding, [m, n]; change: by
    how much.  elsewhere: lower states that no admissible straight way downhill leads to.
    dimension: largest dimension of a stratum with admissible neighbours.
    """

    tried: int
    admitted: int
    lower: np.ndarray
    change: np.ndarray
    dimension: int
    elsewhere: int = 0


def energy_noise(p: Problem, x: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Bound on rounding in an energy change (module docstring)."""
    torque = np.abs(p.torques(x)).sum()
    tie = np.eye(p.size)[p.orbit]
    singular = np.linalg.svd(fold(p.sectors, x[p.orbit])[0][0].T @ tie, compute_uv=False)
    sigma = singular[singular > 1e-6].min(initial=1.0)
    own = project(p.sectors, p.orbit, x[None], steps=0)[1][0]
    return 4 * EPS * math.pi * torque + torque * (residual + own) / sigma


def draw(
    p: Problem, x: np.ndarray, radius: np.ndarray, held: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Draw closed states at about `radius` [B] from x, with the limits `held` [n] kept."""
    limit = (math.pi - np.abs(x) <= 1e-9) & (p.contact != "none")
    d = rng.normal(size=(len(radius), p.size)) * ~held
    inward = limit & ~held
    d[:, inward] = -np.sign(x[inward]) * np.abs(d[:, inward])
    length = np.linalg.norm(d, axis=1, keepdims=True)
    start = x + d / np.maximum(length, 1e-300) * radius[:, None]
    y, residual = project(p.sectors, p.orbit, start, held)
    distance = np.linalg.norm(y - x, axis=1)
    good = (residual <= 2e-14) & (distance >= 0.03 * radius) & (distance <= 5 * radius)
    return y[good], residual[good]


WAY = np.concatenate([np.logspace(-4, -1, 13)[:-1], np.linspace(0, 1, 11)[1:-1]])
"""Where the straight way to a lower neighbour is checked: closely at its start, where basins can be
narrow (beside the flat state), and along the rest."""


def connected(p: Problem, x: np.ndarray, y: np.ndarray, held: np.ndarray) -> bool:
    """Return whether the straight way from x to y, projected onto closure, is admissible and level."""
    way = x + WAY[:, None] * (y - x)
    z, residual = project(p.sectors, p.orbit, way, held)
    near = np.linalg.norm(z - way, axis=1).max() <= 0.5 * np.linalg.norm(y - x)
    closed = residual.max() <= 1e-13
    climbs = (p.energy_change(z, x) > energy_noise(p, x, residual)).any()
    if not (near and closed) or climbs:
        return False
    return bool(admissible(p.sectors, z[:, p.orbit], p.contact).all())


def strata(p: Problem, x: np.ndarray) -> list[np.ndarray]:
    """Return every set of reached fold limits that can be kept, as masks."""
    limit = np.flatnonzero((math.pi - np.abs(x) <= 1e-9) & (p.contact != "none"))
    out = []
    for size in range(len(limit) + 1):
        for chosen in itertools.combinations(limit, size):
            mask = np.zeros(p.size, dtype=bool)
            mask[list(chosen)] = True
            out.append(mask)
    return out


def look_around(
    p: Problem,
    state: np.ndarray,
    count: int,
    rng: np.random.Generator,
    *,
    most_tries: int = 30,
    radii: np.ndarray = RADII,
    slope: float = 0.0,
) -> Around:
    """Look at `count` admissible states around x (fewer if `most_tries` batches give fewer).

    slope: a neighbour counts as lower only if it is by more than slope times its distance (for
    candidates that are not polished).
    """
    x = np.asarray(state, dtype=float).copy()
    near = np.abs(math.pi - np.abs(x)) <= 1e-9 * (p.contact != "none")
    x[near] = np.sign(x[near]) * math.pi
    tried = admitted = dimension = elsewhere = 0
    lower, change = [], []
    kinds = strata(p, x)
    alive = np.ones(len(kinds), dtype=bool)
    for attempt in range(most_tries):
        per = max(64, count // max(1, int(alive.sum())))
        for s in np.flatnonzero(alive):
            y, residual = draw(p, x, rng.choice(radii, per), kinds[s], rng)
            tried += len(y)
            ok = np.zeros(0, dtype=bool)
            if len(y):
                ok = admissible(p.sectors, y[:, p.orbit], p.contact)
            admitted += int(ok.sum())
            if not ok.any():
                if attempt == 2:
                    alive[s] = False
                continue
            jac = _closure_jacobian(p, y[ok][0], kinds[s])
            dimension = max(dimension, p.size - int(np.linalg.matrix_rank(jac, tol=1e-9)))
            difference = p.energy_change(y[ok], x)
            distance = np.linalg.norm(y[ok] - x, axis=1)
            bad = difference < -energy_noise(p, x, residual[ok]) - slope * distance
            for k in np.flatnonzero(bad):
                if not connected(p, x, y[ok][k], kinds[s]):
                    elsewhere += 1
                elif slope or lower_after_all(p, x, y[ok][k], kinds[s]):
                    lower.append(y[ok][k])
                    change.append(difference[k])
                if len(lower) >= 5:
                    break
        if admitted >= count or not alive.any() or len(lower) >= 5:
            break
    lower_states = np.array(lower).reshape(-1, p.size)
    return Around(tried, admitted, lower_states, np.array(change), dimension, elsewhere)


def _closure_jacobian(p: Problem, x: np.ndarray, held: np.ndarray) -> np.ndarray:
    tie = np.eye(p.size)[p.orbit]
    return np.vstack([fold(p.sectors, x[p.orbit])[0][0].T @ tie, np.eye(p.size)[held]])
