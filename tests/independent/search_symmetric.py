"""Symmetric scenes drawn at random, and their minima by many descents on the whole vertex.

Fold angles of an orbit are tied, the product q of all N folds is to be +1: three equations, of lower rank on symmetric
states, solved by pseudo-inverses.  No wedge, no period, no statement of how a piece closes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

STILL, CLOSED = 1e-8, 1e-12
"""Largest step of a descent [rad] that is at its end, and closure of what it ends at."""


@dataclass(frozen=True)
class Drawn:
    """A vertex with a group by construction: sectors [N], the orbit of each crease [N], springs of each orbit."""

    group: str
    sectors: np.ndarray
    orbit: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray


def draw(kind: str, order: int, rng: np.random.Generator, most: int = 16) -> Drawn:
    """Draw a vertex of the group with at most so many creases, springs of stiffness 0.3 to 3, any rest angles."""
    whole = 2 * math.pi / order
    while True:
        if kind == "C":
            inner = rng.integers(1, max(2, most // order + 1))
            piece = np.sort(rng.uniform(0.0, whole, inner))
            places, names = piece, np.arange(inner)
        else:
            inner = int(rng.integers(0, 4))
            some = np.sort(rng.uniform(0.08, 0.92, inner)) * whole / 2
            on = rng.random(2) < 0.7
            first, last = np.zeros(int(on[0])), np.full(int(on[1]), whole / 2)
            half = np.concatenate([first, some, last])
            name = np.arange(len(half))
            places = np.concatenate([half, -some])
            names = np.concatenate([name, name[int(on[0]) : int(on[0]) + inner]])
        azimuth = np.concatenate([places + m * whole for m in range(order)]) % (2 * math.pi)
        if not 4 <= len(azimuth) <= most:
            continue
        by = np.argsort(azimuth)
        azimuth, orbit = azimuth[by], np.tile(names, order)[by]
        sectors = np.diff(np.append(azimuth, azimuth[0] + 2 * math.pi))
        if sectors.min() < 0.05 or sectors.max() > 3.0:
            continue
        n = orbit.max() + 1
        k, rest = np.exp(rng.uniform(-1.2, 1.2, n)), rng.uniform(-3.0, 3.0, n)
        return Drawn(f"{kind}{order}", sectors, orbit, k, rest)


def minima(
    drawn: Drawn, limits: bool, rng: np.random.Generator, starts: int = 300, steps: int = 400
) -> np.ndarray:
    """Return the distinct minima [M, n] of the springs among symmetric states that descents from random angles end at.

    limits: fold angles stay within +-pi; else within +-2 pi, and what ends there is none.
    """
    n = len(drawn.rest)
    weight = drawn.stiffness * np.bincount(drawn.orbit)
    bound = math.pi if limits else 2 * math.pi
    x = rng.uniform(-math.pi, math.pi, (starts, n))
    if limits:
        at_limit = rng.random((starts, n)) < 0.15
        x = np.where(at_limit, np.copysign(math.pi, x), x)
    x, good = _closed(drawn, x, weight, bound)
    x = x[good]
    step = np.ones(len(x))
    energy = _energy(weight, drawn.rest, x)
    moved = np.full(len(x), math.inf)
    for _ in range(steps):
        go = (moved > STILL) & (step > 1e-9)
        if not go.any():
            break
        d = _downhill(drawn, x[go], weight, bound)
        length = np.abs(d).max(axis=1)
        scaled = np.minimum(step[go], 0.3 / np.maximum(length, 1e-300))
        y, closed = _closed(drawn, x[go] + scaled[:, None] * d, weight, bound)
        new = _energy(weight, drawn.rest, y)
        lower = closed & (new < energy[go] - 0.05 * scaled * (weight * d**2).sum(axis=1))
        still = length <= STILL
        where = np.flatnonzero(go)
        moved[where[still]] = 0.0
        take = lower & ~still
        x[where[take]], energy[where[take]] = y[take], new[take]
        step[where] = np.where(lower, np.minimum(1.0, 2 * step[where]), 0.4 * step[where])
    if not limits:
        moved[np.abs(x).max(axis=1) >= bound] = math.inf
    found: list[np.ndarray] = []
    for k in np.flatnonzero(moved == 0.0)[np.argsort(energy[moved == 0.0])]:
        if all(np.abs(x[k] - other).max() > 1e-4 for other in found) and _stands(
            drawn, x[k], weight, bound, rng
        ):
            found.append(x[k])
    return np.array(found).reshape(-1, n)


def _energy(weight: np.ndarray, rest: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.asarray(0.5 * (weight * (x - rest) ** 2).sum(axis=1))


def _times(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Multiply quaternions [..., 4]."""
    (a, b, c, d), (e, f, g, h) = np.moveaxis(p, -1, 0), np.moveaxis(q, -1, 0)
    real, i = a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g
    return np.stack(
        [real, i, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e], axis=-1
    )


def whole_vertex(drawn: Drawn, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return q [B, 4] of all N folds, and its slopes by the angles of the orbits, [B, 4, n]."""
    azimuth = np.concatenate([[0.0], np.cumsum(drawn.sectors)[:-1]])
    count, n = len(azimuth), x.shape[1]
    q = np.zeros((len(x), 4))
    q[:, 0] = 1.0
    before = []
    for b, v in zip(azimuth, drawn.orbit, strict=True):
        before.append(q)
        half = 0.5 * x[:, v]
        c, s = np.cos(half), np.sin(half)
        q = _times(q, np.stack([c, s * math.cos(b), s * math.sin(b), 0 * s], axis=1))
    slopes = np.zeros((len(x), 4, n))
    for i in range(count):
        b = azimuth[i]
        axis = np.broadcast_to([0.0, math.cos(b), math.sin(b), 0.0], (len(x), 4))
        p = before[i]
        turned = _times(_times(p, axis), p * np.array([1.0, -1.0, -1.0, -1.0]))
        slopes[:, :, drawn.orbit[i]] += 0.5 * _times(turned, q)
    return q, slopes


def _closed(
    drawn: Drawn, x: np.ndarray, weight: np.ndarray, bound: float
) -> tuple[np.ndarray, np.ndarray]:
    """Close states by Gauss-Newton, and tell which are closed with q = +1."""
    x = np.clip(x, -bound, bound)
    for _ in range(12):
        q, a = whole_vertex(drawn, x)
        free = np.abs(x) < bound
        step = _least(a[:, 1:], q[:, 1:], weight, free)
        size = np.abs(step).max(axis=1, keepdims=True)
        x = np.clip(x - step * np.minimum(1.0, 0.7 / np.maximum(size, 1e-300)), -bound, bound)
        if np.abs(q[:, 1:]).max(initial=0.0) < 0.01 * CLOSED:
            break
    q, _ = whole_vertex(drawn, x)
    return x, (np.abs(q[:, 1:]).max(axis=1) <= CLOSED) & (q[:, 0] > 0)


def _least(a: np.ndarray, g: np.ndarray, weight: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return the shortest step of free angles that a [B, 3, n] takes to g [B, 3]."""
    root = free / np.sqrt(weight)
    inverse = np.linalg.pinv(a * root[:, None], rcond=1e-6)
    return root * (inverse @ g[..., None])[..., 0]


def _downhill(drawn: Drawn, x: np.ndarray, weight: np.ndarray, bound: float) -> np.ndarray:
    """Return the step to the lowest state to first order, angles at a limit that it would leave held."""
    _, a = whole_vertex(drawn, x)
    a = a[:, 1:]
    wanted = drawn.rest - x
    at = np.abs(x) >= bound
    free = ~at
    d = np.zeros_like(x)
    for _ in range(x.shape[1] + 1):
        d = wanted * free
        d = d - _least(a, (a @ d[..., None])[..., 0], weight, free)
        # a held angle is let go where the moments that hold the others would turn it inwards
        root = free / np.sqrt(weight)
        left = weight * wanted
        lam = np.linalg.pinv((a * root[:, None]).swapaxes(1, 2), rcond=1e-6)
        lam = (lam @ (root * left)[..., None])[..., 0]
        force = left - (lam[:, None] @ a)[:, 0]
        release = at & ~free & (force * np.sign(x) < -1e-9)
        if not release.any():
            break
        most = np.argmax(np.where(release, np.abs(force), -1.0), axis=1)
        rows = np.flatnonzero(release.any(axis=1))
        free[rows, most[rows]] = True
    return np.where(at & (d * x > 0), 0.0, d)


def _stands(
    drawn: Drawn, x: np.ndarray, weight: np.ndarray, bound: float, rng: np.random.Generator
) -> bool:
    """Return whether no closed state near x is lower."""
    for radius in (1e-3, 1e-2):
        y = x + rng.uniform(-radius, radius, (200, len(x)))
        y, good = _closed(drawn, y, weight, bound)
        y = y[good & (np.abs(y - x).max(axis=1) < 3 * radius)]
        apart = np.abs(y - x).max(axis=1)
        energy = _energy(weight, drawn.rest, np.concatenate([x[None], y]))
        # at an end that is stationary to STILL, only what falls to second order is lower
        if (energy[1:] < energy[0] - 1e-7 * weight.sum() * apart - 1e-13).any():
            return False
    return True
