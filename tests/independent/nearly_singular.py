"""Scenes whose sectors nearly have a special relation: to within d, from 1e-12 to 1e-2, or exactly.

Kinds: two creases on one line (a sum of consecutive sectors is pi); two creases that coincide when
those between them are fully folded (an alternating sum of consecutive sectors is 0); equal sectors; a vertex
that folds flat (Kawasaki's sum is pi).  Springs are random, or at rest at +-pi and 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

KINDS = ("collinear", "coincident", "equal", "flat-foldable")
NARROW, WIDE = 0.15, 2.9


@dataclass(frozen=True)
class NearlySingular:
    """A scene as numbers: sectors [N], stiffness, rest angles; kind, and d [rad]."""

    kind: str
    d: float
    sectors: tuple[float, ...]
    stiffness: tuple[float, ...]
    rest_angles: tuple[float, ...]

    def __str__(self) -> str:
        return (
            f"{self.kind}, d = {self.d!r}\nsectors = {list(self.sectors)}\n"
            f"stiffness = {list(self.stiffness)}\nrest_angles = {list(self.rest_angles)}"
        )


def nearly_singular(seed: int) -> NearlySingular:
    """Make the scene of a seed."""
    rng = np.random.default_rng([12, seed])
    kind = KINDS[seed % len(KINDS)]
    n = int(rng.choice([4, 5, 6, 7, 8], p=[0.35, 0.25, 0.2, 0.1, 0.1]))
    d = 0.0 if rng.random() < 0.1 else float(10 ** rng.uniform(-12, -2))
    lattice = rng.random() < 0.5  # many relations at once, all of them off by about d
    sectors = None
    while sectors is None or sectors.min() < NARROW or sectors.max() > WIDE:
        row, value = _relation(kind, n, rng)
        sectors = _lattice(row, value, n, rng) if lattice else _generic(n, rng)
        if sectors is not None:
            shift = rng.uniform(-1, 1, n) * d * lattice
            sectors = _meet(sectors + shift, row, value + d)
    stiffness = 10 ** rng.uniform(-0.5, 0.5, n)
    rest = rng.uniform(-math.pi, math.pi, n)
    if seed // len(KINDS) % 2:  # springs at rest fully folded, some flat
        rest = rng.choice([-math.pi, math.pi, -math.pi, math.pi, 0.0], n)
        stiffness = np.ones(n) if rng.random() < 0.5 else stiffness
    return NearlySingular(
        kind, d, tuple(sectors.tolist()), tuple(stiffness.tolist()), tuple(rest.tolist())
    )


def _generic(n: int, rng: np.random.Generator) -> np.ndarray:
    return 0.25 + rng.dirichlet(np.full(n, 2.0)) * (2 * math.pi - 0.25 * n)


def _lattice(row: np.ndarray, value: float, n: int, rng: np.random.Generator) -> np.ndarray | None:
    """Sectors that are small multiples of one angle and have the relation; None if not found."""
    for _ in range(200):
        m = rng.integers(1, 5, n)
        unit = 2 * math.pi / m.sum()
        if 2 * m.max() < m.sum() and abs(row @ m * unit - value) < 1e-9:
            return unit * m
    return None


def _relation(kind: str, n: int, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """Coefficients of the relation on the sectors, from a random crease on, and its value."""
    row = np.zeros(n)
    if kind == "collinear":
        row[: int(rng.integers(2, n - 1))] = 1
        value = math.pi
    elif kind == "coincident":
        m = int(rng.integers(1, (n - 1) // 2 + 1)) * 2
        row[:m] = [(-1) ** i for i in range(m)]
        value = 0.0
    elif kind == "equal":
        row[[0, int(rng.integers(1, n))]] = 1, -1
        value = 0.0
    else:
        row[::2] = 1
        value = math.pi
        if (
            n % 2
        ):  # an odd vertex folds flat with one crease open: the last two sectors count as one
            row[-1] = 0
    return np.roll(row, int(rng.integers(n))), value


def _meet(sectors: np.ndarray, row: np.ndarray, value: float) -> np.ndarray:
    """Move sectors least so that row @ sectors = value, and their sum is 2 pi."""
    both = np.stack([row, np.ones(len(row))])
    gap = np.array([value, 2 * math.pi]) - both @ sectors
    return sectors + np.linalg.pinv(both) @ gap
