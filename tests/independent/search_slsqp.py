"""Minima within fold limits by SciPy's SLSQP from many starts: closure by quaternions, nothing of the package."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize

SAME, LOWER, BESIDE = 2e-3, 1e-6, 0.03
"""Distance [rad] of states that are one; by how much energy is lower; and how far beside an end others are begun."""


def closure(sectors: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Quaternion of all folds, [4]: 1 where the vertex closes as a sheet of paper."""
    q, azimuth = np.array([1.0, 0.0, 0.0, 0.0]), 0.0
    for sector, angle in zip(sectors, phi, strict=True):
        c, s = np.cos(angle / 2), np.sin(angle / 2)
        x, y = s * np.cos(azimuth), s * np.sin(azimuth)
        w, a, b, d = q
        q = np.array(
            [
                w * c - a * x - b * y,
                w * x + a * c - d * y,
                w * y + b * c + d * x,
                d * c + a * y - b * x,
            ]
        )
        azimuth += sector
    return q


def minima(energy, sectors, limits, tie, starts, rng):
    """Return minima [K, N] of an energy of all fold angles.

    limits [2, N]; tie [N]: variable of each crease, so that symmetric states alone are looked at.
    """
    tie = np.asarray(tie)
    n = tie.max() + 1
    first = np.array([int(np.argmax(tie == v)) for v in range(n)])
    low, high = limits[0][first], limits[1][first]

    def solved(x):
        done = minimize(
            lambda x: float(energy(x[tie])),
            x,
            method="SLSQP",
            bounds=list(zip(low, high, strict=True)),
            constraints={"type": "eq", "fun": lambda x: closure(sectors, x[tie])[1:]},
            options={"ftol": 1e-12, "maxiter": 200},
        )
        q = closure(sectors, done.x[tie])
        good = q[0] > 0.5 and np.abs(q[1:]).max() < 1e-7
        return (done.x, float(done.fun)) if good else None

    found: list[tuple[np.ndarray, float]] = []
    for _ in range(starts):
        end = solved(rng.uniform(low, high))
        if end is not None and not any(np.abs(end[0] - x).max() < SAME for x, _ in found):
            found.append(end)
    kept = []
    for x, u in found:
        # from beside a saddle a descent goes elsewhere
        beside = [solved(np.clip(x + BESIDE * rng.normal(size=n), low, high)) for _ in range(4 * n)]
        if not any(e is not None and e[1] < u - LOWER * (1 + abs(u)) for e in beside):
            kept.append(x[tie])
    return np.array(kept).reshape(-1, len(tie))
