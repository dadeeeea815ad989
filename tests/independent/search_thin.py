"""Admissible sets at phi = +-pi exactly: curves with creases held there, and flat foldings.

Such a set need not have neighbours with the creases open, so no descent through the surface would
find a minimum on it.  With one crease held the closed states of a piece are curves; each is swept by
every other fold angle, all places of the creases from spherical trigonometry.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from tests.independent.neighbours import Problem, look_around
from tests.independent.search_charts import closed, sheets
from tests.independent.search_descent import descend
from tests.independent.search_layers import symmetrically_admissible
from tests.independent.search_manifold import Piece

SNAP = 1e-7
"""A fold angle this close to +-pi is exactly there (double roots are known to half the digits)."""


def _exact(x: np.ndarray) -> np.ndarray:
    return np.where(math.pi - np.abs(x) < SNAP, np.copysign(math.pi, x), x)


def _sheets(piece: Piece, v: int, side: int, w: int, t: np.ndarray) -> list[np.ndarray]:
    """States with variable v held at side * pi and w at t [m], one array [m, n] for each root.

    At exactly +-pi the sign of a fold angle is not to be seen in the positions: both are listed.
    """
    low, high = sorted((v, w))
    held = np.full_like(t, side * math.pi)
    s, u = (held, t) if low == v else (t, held)
    out = []
    for x in sheets(piece, s, u, f"{low + 1}{high + 1}"):
        at_limit = math.pi - np.abs(x) < SNAP
        x = _exact(x)
        x[at_limit[:, v], v] = side * math.pi
        x[~at_limit[:, v]] = np.nan
        others = [i for i in range(piece.size) if i != v and at_limit[:, i].any()]
        for signs in itertools.product((-1, 1), repeat=len(others)):
            y = x.copy()
            for i, sign in zip(others, signs, strict=True):
                y[at_limit[:, i], i] = sign * math.pi
            out.append(y)
    return out


def lowest_on_curves(piece: Piece, size: int) -> np.ndarray:
    """Candidates for minima on curves with a crease at +-pi, refined by golden section, [m, n]."""
    t = (
        np.arange(size) + 0.37
    ) / size * 2 * np.pi - np.pi  # creases at rest or flat are off the grid
    found = []
    for v, side, w in itertools.product(range(piece.size), (-1, 1), range(piece.size)):
        if v == w:
            continue
        for x in _sheets(piece, v, side, w, t):
            ok = closed(piece, x, 1e-7)
            ok[ok] = symmetrically_admissible(piece, x[ok])
            u = np.pad(np.where(ok, piece.energy(x), np.inf), 1, constant_values=np.inf)
            lowest = ok & (u[1:-1] <= u[:-2]) & (u[1:-1] <= u[2:])
            for k in np.flatnonzero(lowest):
                found.append(_refine(piece, (v, side, w), t[k], t[1] - t[0], x[k]))
    return _distinct(np.array(found).reshape(-1, piece.size), 1e-5)


def _refine(
    piece: Piece, where: tuple[int, int, int], t: float, width: float, x: np.ndarray
) -> np.ndarray:
    """Lowest admissible state of a curve between t - width and t + width, by repeated thirds."""
    v, side, w = where
    low, high = t - width, t + width
    best = x
    for _ in range(13):
        grid = np.append(np.linspace(low, high, 9), t)
        # fewer roots can reach +-pi on a short stretch: pair up by continuity with the best state
        states = np.concatenate(_sheets(piece, v, side, w, np.clip(grid, -math.pi, math.pi)))
        ok = closed(piece, states, 1e-7)
        ok &= np.nan_to_num(np.abs(states - best), nan=9.0).max(axis=1) < 6 * (high - low) + 1e-6
        ok[ok] = symmetrically_admissible(piece, states[ok])
        if not ok.any():
            return best
        states = states[ok]
        lowest = states[piece.energy(states).argmin()]
        if piece.energy(lowest) <= piece.energy(best):
            best, t = lowest, float(lowest[w])
        low, high = t - (high - low) / 5, t + (high - low) / 5
    return best


def flat_foldings(piece: Piece) -> np.ndarray:
    """Every state with symmetric layers whose fold angles are all 0 or +-pi, [m, n]."""
    x = np.array(list(itertools.product((-math.pi, 0.0, math.pi), repeat=piece.size)))
    x = x[closed(piece, x, 1e-12)]
    return x[symmetrically_admissible(piece, x)]


def _distinct(x: np.ndarray, tolerance: float) -> np.ndarray:
    kept: list[np.ndarray] = []
    for row in x:
        if all(np.abs(row - other).max() > tolerance for other in kept):
            kept.append(row)
    return np.array(kept).reshape(-1, x.shape[1])


def truly_minimal(piece: Piece, problem: Problem, states: np.ndarray, seed: int) -> np.ndarray:
    """Keep the states [m, n] around which no admissible neighbour is lower, whatever it holds closed.

    Refined states are known to about 1e-7, so a neighbour must be lower by more than 1e-5 times its
    distance, in units of the mean stiffness.
    """
    rng = np.random.default_rng(seed)
    slope = 1e-5 * float(problem.stiffness.mean())
    radii = np.logspace(-2, -4, 5)
    kept = []
    for x in states:
        if _lower_beside(piece, x, slope, rng):
            continue
        around = look_around(problem, x, 500, rng, most_tries=8, radii=radii, slope=slope)
        if not len(around.lower):
            kept.append(x)
    return np.array(kept).reshape(-1, piece.size)


def _lower_beside(piece: Piece, x: np.ndarray, slope: float, rng: np.random.Generator) -> bool:
    """Look for a lower admissible state beside x with all creases free to open.

    Where such states are a sliver along a contact, random ones miss it: descents from neighbours
    1e-4 away also tell, if they leave for somewhere lower.
    """
    for radius in (1e-4, 1e-3, 1e-2):
        y, residual = piece.retract(x + radius * rng.normal(size=(200, piece.size)))
        distance = np.linalg.norm(y - x, axis=1)
        near = (residual < 1e-12) & (distance < 5 * radius)
        y, distance = y[near], distance[near]
        ok = piece.admissible(y) if len(y) else np.zeros(0, dtype=bool)
        if (ok & (piece.energy(y) < piece.energy(x) - slope * distance)).any():
            return True
        if radius == 1e-4 and ok.any():
            ends, _ = descend(piece, y[ok][:8], rounds=100)
            gone = np.abs(ends - x).max(axis=1) > 0.02
            if (gone & (piece.energy(ends) < piece.energy(x) - slope * 0.02)).any():
                return True
    return False
