"""How many stable states can springs give a vertex of degree 4? A search for springs, not for states.

The slope of the energy along a branch, U' = sum k_i phi_i phi_i' - c_i phi_i' with c_i = k_i rest_i, is linear in k
and c.  Maxima of the energy between the ends of a branch need slopes of signs + - + - ... at places in order: a linear
program finds the springs with the largest least slope; then each place moves to the extremum of the slope between its
neighbours, and again.  Sectors climb by random steps.  Stable states within fold limits are two more than maxima.
What is found is counted once more on a fine grid: a margin below `LEAST` is that of places that fell together.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from time import process_time
from typing import Any

import numpy as np
import sympy as sp
from origami_nlp.symbolic.degree4 import half_tangent
from scipy.optimize import linprog

LEAST = 1e-7
"""Slope per unit of speed, over the sum of stiffnesses [rad], below which signs are those of rounding."""
GRID, FINE = 1201, 20_001
FREE = 4.0
"""Rest angles that preload reaches, over pi."""


@cache
def _functions() -> dict[tuple[int, int], Any]:
    """Return tan(phi/2) and its slope over t of each crease in each mode, from the verified expressions."""
    q, e, t = sp.symbols("q e t", positive=True)
    return {
        (crease, mode): sp.lambdify(
            (q, e, t), [expr := half_tangent(crease, q, e, t, mode), sp.diff(expr, t)]
        )
        for crease in (1, 2, 3, 4)
        for mode in (1, 2)
    }


def branch(sectors: np.ndarray, mode: int, t: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return folds and unit tangents [4, T] of a generic vertex for -1 < t < 1; None where it is not generic."""
    for shift in range(4):
        a = np.roll(sectors, -shift)
        s = np.sin(a)
        q, p = s[0] * s[3] / (s[1] * s[2]), s[0] * s[1] / (s[2] * s[3])
        if 0 < q < 1 and 0 < p < 1:
            break
    else:
        return None
    e = np.exp(np.arctanh(np.sqrt(s[0] * s[2] / (s[1] * s[3]))))
    side = np.sign(np.sin(a[1] + a[2]))
    signs = (1, side, 1, -side) if mode == 1 else (-1, -side, 1, -side)
    folds, slopes = [], []
    for i in range(4):
        tangent, rate = _functions()[i + 1, mode]((q, p)[i % 2], e, t)
        folds.append(signs[i] * 2 * np.arctan(tangent))
        slopes.append(signs[i] * 2 * rate / (1 + tangent**2))
    along = np.roll(np.array(slopes), shift, axis=0)
    return np.roll(np.array(folds), shift, axis=0), along / np.linalg.norm(along, axis=0)


def _rows(sectors: np.ndarray, mode: int, t: np.ndarray) -> np.ndarray | None:
    found = branch(sectors, mode, t)
    return None if found is None else np.concatenate([found[0] * found[1], -found[1]]).T


def _springs(rows: np.ndarray, signs: np.ndarray, reach: float) -> np.ndarray:
    """Return (k, c, margin) of largest margin, sum k = 1, |c_i| <= reach k_i."""
    limits = np.zeros((8, 9))
    for i in range(4):
        limits[2 * i : 2 * i + 2, i] = -reach
        limits[2 * i : 2 * i + 2, 4 + i] = 1, -1
    signed = np.c_[-signs[:, None] * rows, np.ones(len(signs))]
    return linprog(
        np.r_[np.zeros(8), -1],
        np.r_[signed, limits],
        np.zeros(len(signs) + 8),
        np.array([[1.0] * 4 + [0.0] * 5]),
        [1.0],
        bounds=[(0, None)] * 4 + [(None, None)] * 5,
    ).x


@dataclass(frozen=True)
class Found:
    """Springs with the largest margin that a climb has found.

    margin: least slope of the signs asked for [rad]; sectors [rad]; springs: stiffness (their sum is 1) and
    k_i rest_i; counted: states within fold limits on a fine grid.
    """

    margin: float
    sectors: np.ndarray
    springs: np.ndarray
    counted: int

    @property
    def holds(self) -> bool:
        """Whether the margin is more than rounding."""
        return self.margin > LEAST


def count(sectors: np.ndarray, springs: np.ndarray) -> int:
    """Count states within fold limits from the signs of the slope on a fine grid."""
    t, total = _grid(FINE), 2
    for mode in (1, 2):
        slope = _rows(sectors, mode, t) @ springs
        total += int(np.count_nonzero((slope[:-1] > 0) & (slope[1:] <= 0)))
    return total


def _grid(size: int) -> np.ndarray:
    return np.sin(np.linspace(-np.pi / 2, np.pi / 2, size + 2)[1:-1])


def climb(
    maxima: tuple[int, int],
    start: np.ndarray,
    *,
    preload: bool = True,
    seconds: float = 10.0,
    seed: int = 0,
) -> Found | None:
    """Look from these sectors [rad] for springs with so many maxima on each branch; seconds of processor time."""
    rng, began, grid = np.random.default_rng(seed), process_time(), _grid(GRID)
    reach = np.pi * (FREE if preload else 1.0)
    signs = [np.array([1.0, -1.0] * m) for m in maxima]
    best: Found | None = None
    step, places = 0.05, None
    while process_time() - began < seconds:
        if best is None or not best.holds:
            sectors = start
        else:
            sectors = best.sectors + rng.normal(0, step, 4)
            sectors *= 2 * np.pi / sectors.sum()
        if sectors.min() < 0.2 or sectors.max() > 2.9:
            continue
        one, two = (_rows(sectors, mode, grid) for mode in (1, 2))
        if one is None or two is None:
            continue
        rows = [one, two]
        if places is None or best is None or not best.holds:
            at = [np.sort((rng.beta(0.5, 0.5, len(s)) * GRID).astype(int)) for s in signs]
            if any(len(set(a)) < len(a) for a in at):
                continue
        else:
            at = [p.copy() for p in places]
        margin, springs = _exchange(rows, at, signs, reach)
        if springs is not None and (best is None or margin > best.margin):
            best = Found(margin, sectors, springs, count(sectors, springs))
            places, step = at, min(1.5 * step, 0.3)
        else:
            step = max(0.93 * step, 2e-3)
    return best


def _exchange(
    rows: list[np.ndarray], at: list[np.ndarray], signs: list[np.ndarray], reach: float
) -> tuple[float, np.ndarray | None]:
    """Springs for these places, places for these springs, and so on; `at` is changed in place."""
    margin, springs = -np.inf, None
    everywhere = np.concatenate(signs)
    for _ in range(20):
        chosen = np.concatenate([r[a] for r, a in zip(rows, at, strict=True)])
        found = _springs(chosen, everywhere, reach)
        if found is None or found[8] <= margin * (1 + 1e-6) + 1e-12:
            break
        margin, springs = float(found[8]), found[:8]
        for r, a, s in zip(rows, at, signs, strict=True):
            slope = r @ springs
            for j in range(len(a)):
                low = a[j - 1] + 1 if j else 0
                high = a[j + 1] if j + 1 < len(a) else GRID
                a[j] = low + int(np.argmax(s[j] * slope[low:high]))
    return margin, springs


def twice_on_a_half(
    sectors: np.ndarray, mode: int, *, starts: int = 8, seed: int = 0
) -> tuple[float, np.ndarray | None]:
    """Look for springs at rest within 180 degrees with two maxima between the flat state and the limit of a branch.

    Returns the largest margin found, and the springs as in `Found`.
    """
    rng, grid = np.random.default_rng(seed), _grid(GRID)
    grid = grid[grid > 0]
    rows, signs = _rows(sectors, mode, grid), np.array([1.0, -1.0, 1.0, -1.0])
    best: tuple[float, np.ndarray | None] = (-np.inf, None)
    assert rows is not None
    for _ in range(starts):
        at = np.sort(rng.choice(len(grid), 4, replace=False))
        best = max(best, _exchange([rows], [at], [signs], np.pi), key=lambda found: found[0])
    return best
