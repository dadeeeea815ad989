"""Roots of many functions at once, and states distinguished."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from origami_nlp.numerics.tolerances import EPS


def bracketed_roots(f: Callable[[np.ndarray], np.ndarray], low: Any, high: Any) -> np.ndarray:
    """Find a root of f, one for each bracket [low, high] [K], by the Illinois form of regula falsi.

    f takes positions [K] and returns values [K] of opposite signs at the two ends; brackets shrink to rounding.
    """
    a, b = np.array(low, dtype=float), np.array(high, dtype=float)
    fa, fb = f(a), f(b)
    best = np.where(np.abs(fa) <= np.abs(fb), a, b)
    least = np.minimum(np.abs(fa), np.abs(fb))
    for k in range(60):
        change = np.where(fb != fa, fb - fa, 1.0)
        c = np.where(k % 3 == 2, 0.5 * (a + b), b - fb * (b - a) / change)
        c = np.where((c > np.minimum(a, b)) & (c < np.maximum(a, b)), c, 0.5 * (a + b))
        fc = f(c)
        better = np.abs(fc) < least
        best, least = np.where(better, c, best), np.where(better, np.abs(fc), least)
        crosses = (fc > 0) != (fb > 0)
        # Illinois: an end that stays has its value halved, so that both ends move
        a, fa = np.where(crosses, b, a), np.where(crosses, fb, 0.5 * fa)
        b, fb = c, fc
        if ((np.abs(b - a) <= 2 * EPS * (1 + np.abs(b))) | (fb == 0)).all():
            break
        if np.abs(c - best).max() <= EPS and k > 8 and least.max() <= EPS:
            break
    return best


def distinct(x: np.ndarray, apart: float) -> np.ndarray:
    """Positions of states [K, n] that differ from all earlier kept ones by more than `apart` (largest entry)."""
    kept: list[int] = []
    left = np.arange(len(x))
    while len(left):
        first = left[0]
        kept.append(int(first))
        left = left[np.abs(x[left] - x[first]).max(axis=1) > apart]
    return np.array(kept, dtype=int)
