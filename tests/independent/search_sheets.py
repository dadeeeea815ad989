"""Minima of sheets with any energy of the fold angles: random starts, closed and led downhill; no code of the package.

Only corners and creases of a pattern are read.  Round each inner corner the product of the rotations about the creases,
by their fold angles, is the identity: the axis of that rotation is what is left open, and a fold turns it about the
crease where the folds before have put that.  Steps are taken along the null space of these rows, and closed again by
Gauss and Newton, with singular values that are small left out.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

SMALL = 1e-6
"""Singular values of closure below this count as zero."""


CLOSED = 1e-9
"""Largest rotation that is left of what counts as closed."""


class Sheet:
    """Closure of a pattern: corners [P, 2 or 3], creases as pairs of corners [n, 2], inner corners."""

    def __init__(self, corners: np.ndarray, ends: np.ndarray, inner: list[int]) -> None:
        self.n = len(ends)
        self.rings: list[tuple[list[int], np.ndarray]] = []
        for v in inner:
            creases = [i for i, e in enumerate(ends.tolist()) if v in e]
            away = [corners[ends[i].sum() - v][:2] - corners[v][:2] for i in creases]
            azimuth = np.array([np.arctan2(y, x) for x, y in away])
            order = np.argsort(azimuth)
            axes = np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], axis=1)[order]
            self.rings.append(([creases[i] for i in order], axes))

    def closure(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rotation vectors that are left, [K, 3 V], and their derivatives where they vanish, [K, 3 V, n]."""
        rows, slopes = [], []
        for creases, axes in self.rings:
            turn = np.broadcast_to(np.eye(3), (len(x), 3, 3))
            slope = np.zeros((len(x), 3, self.n))
            for crease, axis in zip(creases, axes, strict=True):
                slope[:, :, crease] = turn @ axis
                fold = Rotation.from_rotvec(x[:, [crease]] * axis).as_matrix()
                turn = turn @ fold
            rows.append(Rotation.from_matrix(turn).as_rotvec())
            slopes.append(slope)
        return np.concatenate(rows, axis=1), np.concatenate(slopes, axis=1)

    def paper(self, x: np.ndarray) -> np.ndarray:
        """Whether round every inner corner half of all folds multiplies to 1, not -1, [K]."""
        out = np.ones(len(x), bool)
        for creases, axes in self.rings:
            w, v = np.ones(len(x)), np.zeros((len(x), 3))
            for crease, axis in zip(creases, axes, strict=True):
                c, s = np.cos(0.5 * x[:, crease]), np.sin(0.5 * x[:, [crease]]) * axis
                w, v = (
                    w * c - (v * s).sum(axis=1),
                    w[:, None] * s + c[:, None] * v + np.cross(v, s),
                )
            out &= w > 0
        return out

    def closed(
        self, x: np.ndarray, rounds: int, within: float = CLOSED
    ) -> tuple[np.ndarray, np.ndarray]:
        """States led to closure, and which are closed."""
        x = x.copy()
        for k in range(rounds + 1):
            gap, slope = self.closure(x)
            away = np.flatnonzero(np.abs(gap).max(axis=1) >= within)
            if not len(away) or k == rounds:
                break
            step = np.einsum("kij,kj->ki", np.linalg.pinv(slope[away], rcond=SMALL), gap[away])
            size = np.abs(step).max(axis=1, keepdims=True)
            x[away] -= step * np.minimum(1.0, 0.5 / np.maximum(size, 1e-300))
        return x, (np.abs(gap).max(axis=1) < within) & self.paper(x)

    def down(self, x: np.ndarray, torque: np.ndarray) -> np.ndarray:
        """Torque along the closed states, [K, n]."""
        _, slope = self.closure(x)
        _, size, right = np.linalg.svd(slope)
        kept = np.zeros((len(x), self.n, 1))
        kept[:, : size.shape[1], 0] = size[:, : self.n] > SMALL
        along = np.einsum("kij,kj->ki", right, torque)
        return np.einsum("kji,kj->ki", right, along * (1 - kept[..., 0]))


def sheet_of(pattern) -> Sheet:
    """Return the closure of a pattern whose border has no corner with four creases."""
    count = np.bincount(pattern.ends.ravel(), minlength=len(pattern.corners))
    return Sheet(pattern.corners, pattern.ends, np.flatnonzero(count >= 4).tolist())


def minima(sheet: Sheet, energy, torque, limits: np.ndarray, starts: int, rng) -> np.ndarray:
    """Return states [K, n] within limits [2, n] at which descents from random starts end, each once.

    `energy` and `torque` take states [K, n].
    """
    x, good = sheet.closed(rng.uniform(limits[0], limits[1], (starts, sheet.n)), 40)
    good &= ((x > limits[0]) & (x < limits[1])).all(axis=1)
    x = x[good]
    length, rest = np.full(len(x), 0.1), np.full(len(x), np.inf)
    for _ in range(1_500):
        way = sheet.down(x, torque(x))
        rest = np.linalg.norm(way, axis=1)
        if (moving := rest > 1e-7).sum() == 0:
            break
        step = way * (length / np.maximum(rest, length))[:, None]
        step = np.where(moving[:, None], step, 0.0)
        y, good = sheet.closed(x - step, 4)
        good &= ((y >= limits[0]) & (y <= limits[1])).all(axis=1)
        good &= energy(y) < energy(x)
        good &= np.abs(y - x).max(axis=1) < 2 * np.abs(step).max(axis=1) + 1e-12
        x = np.where(good[:, None], y, x)
        length = np.where(good, 1.4 * length, 0.4 * length)
        length = np.clip(length, 1e-12, 0.3)
    found: list[np.ndarray] = []
    for one in x[rest <= 1e-5]:
        if all(np.abs(one - other).max() > 1e-3 for other in found):
            found.append(one)
    return np.array(found).reshape(-1, sheet.n)
