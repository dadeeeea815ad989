"""Closed states near given ones, in extended precision and in batches.

Near a singular state a point at distance d from the closed states closes to d^2, so at a radius of
1e-6 a residual of 1e-12 proves nothing.  Gauss-Newton steps in double precision bring the states
near; further ones compute the residual with 64 bits of mantissa.  A state counts as closed when its
residual is of rounding size (1e-18) and the last step was a small part of the radius.
"""

from __future__ import annotations

import numpy as np

from tests.independent.rotations import fold, rotation_vector

LONG = np.longdouble
PI = LONG(4) * np.arctan(LONG(1))
EXTENDED = np.finfo(LONG).eps < 1e-18
"""Whether the machine has extended precision (x86); elsewhere there is nothing to judge with."""
SMALL = LONG(4e-18)
"""Residual [rad] of a product of folds that closes, in extended precision."""


def fold_long(sectors: np.ndarray, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return deformed creases [B, N, 3] and residual [B, 3] of closure in extended precision."""
    count, n = phi.shape
    cos, sin = np.cos(phi), np.sin(phi)
    # fold angles of exactly +-pi are exact
    at_limit = np.abs(phi) == PI
    sin[at_limit] = 0
    cos[at_limit] = -1
    zero, one = np.zeros(count, LONG), np.ones(count, LONG)
    x, y, z = ([one, zero, zero], [zero, one, zero], [zero, zero, one])
    creases = np.empty((count, n, 3), LONG)
    for i in range(n):
        for k in range(3):
            creases[:, i, k] = x[k]
        c, s = cos[:, i], sin[:, i]
        y, z = (
            [c * p + s * q for p, q in zip(y, z, strict=True)],
            [c * q - s * p for p, q in zip(y, z, strict=True)],
        )
        ca, sa = np.cos(sectors[i]), np.sin(sectors[i])
        x, y = (
            [ca * p + sa * q for p, q in zip(x, y, strict=True)],
            [ca * q - sa * p for p, q in zip(x, y, strict=True)],
        )
    residual = np.stack([y[2] - z[1], z[0] - x[2], x[1] - y[0]], axis=1) / 2
    return creases, residual


def _step(creases: np.ndarray, tie: np.ndarray, free: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Shortest step of the free variables that closes to first order, [B, n]."""
    jac = np.einsum("bik,in->bkn", creases, tie) * free[:, None, :]
    u, s, vt = np.linalg.svd(jac, full_matrices=False)
    good = s > 1e-14
    part = np.einsum("bkj,bk->bj", u, r) * good / np.where(good, s, 1.0)
    return -np.einsum("bjn,bj->bn", vt, part)


def close(
    sectors: np.ndarray,
    orbit: np.ndarray,
    start: np.ndarray,
    held: np.ndarray,
    around: np.ndarray,
    radius: np.ndarray,
    steps: int = 30,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Close the states start [B, n] (extended precision) near `around` [n].

    sectors: exact ones in extended precision.  held: mask [B, n] of variables that do not move.
    radius [B]: states that wander further than 5 of these are given up.
    Returns states, whether they close, and how far they may be from the exact state (last step).
    """
    x = start.astype(LONG)
    n = x.shape[1]
    tie = np.eye(n)[orbit]
    free = 1.0 - held
    double = sectors.astype(float)
    done = np.zeros(len(x), dtype=bool)
    todo = np.arange(len(x))
    for _ in range(steps):  # in double precision, as long as that helps
        creases, m = fold(double, x[todo][:, orbit].astype(float))
        r = rotation_vector(m)
        size = np.linalg.norm(r, axis=1)
        near = np.linalg.norm((x[todo] - around).astype(float), axis=1) <= 5 * radius[todo]
        done[todo[near & (size <= 1e-12)]] = True
        going = near & (size > 1e-12)
        todo, creases, r = todo[going], creases[going], r[going]
        if not len(todo):
            break
        move = _step(creases, tie, free[todo], r)
        most = 0.5 * np.minimum(radius[todo], 1.0)
        length = np.linalg.norm(move, axis=1)
        x[todo] += move * np.minimum(1.0, most / np.maximum(length, 1e-300))[:, None]
    closed = np.zeros(len(x), dtype=bool)
    error = np.full(len(x), np.inf)
    todo = np.flatnonzero(done)
    for _ in range(steps):
        creases, r = fold_long(sectors, x[todo][:, orbit])
        size = np.abs(r).max(axis=1)
        # the residual is scaled to survive the change to double precision
        unit = np.maximum(size, LONG(1e-300))
        move = _step(creases.astype(float), tie, free[todo], (r / unit[:, None]).astype(float))
        length = np.linalg.norm(move, axis=1) * unit.astype(float)
        fine = (size <= SMALL) & (length <= 1e-3 * radius[todo])
        closed[todo[fine]] = True
        error[todo] = length
        near = np.linalg.norm((x[todo] - around).astype(float), axis=1) <= 5 * radius[todo]
        going = near & ~fine
        todo, move, unit, length = todo[going], move[going], unit[going], length[going]
        if not len(todo):
            break
        most = np.minimum(1.0, 0.5 * radius[todo] / np.maximum(length, 1e-300))
        x[todo] += move * (unit * most)[:, None]
    distance = np.linalg.norm((x - around).astype(float), axis=1)
    return x, closed & (distance <= 5 * radius), error
