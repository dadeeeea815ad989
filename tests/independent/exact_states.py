"""States of a sheet in extended precision and with 80 digits: closed, and asked for crossings and layers."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np

from tests.independent.arcs import crossing_margin, nearest_touch
from tests.independent.closing import LONG, PI, close, fold_long
from tests.independent.exact import embedded, fold_exactly
from tests.independent.layering import combinatorics, stackable, stackable_with
from tests.independent.relations import DIGITS
from tests.independent.rotations import spin_sign
from tests.independent.sheet import PatternProblem, to_long

SHUT = 1e-9
"""A reported fold angle this close [rad] to +-pi, or to 0, is there."""
CROSSING = 1e-16
"""Depth of crossings that extended precision tells from touching."""
ROUNDING = 1e-13
"""Features of a reported state this close [rad] touch."""


def base(problem: PatternProblem, phi: np.ndarray) -> np.ndarray | None:
    """Return the variables of the nearest state that closes, if one is near.

    Creases reported at +-pi or 0 are there exactly, if a state with them there is near.
    """
    x = phi[problem.first].astype(LONG)
    at_limit = np.abs(math.pi - np.abs(phi[problem.first])) <= SHUT
    at_limit &= problem.contact != "none"
    x = np.where(at_limit, np.sign(x) * PI, x)
    flat = np.abs(x) <= SHUT
    masks = [at_limit | flat, at_limit, np.zeros_like(at_limit)]
    start = np.array([np.where(m & flat, LONG(0), x) for m in masks])
    radius = np.full(3, 0.1)
    y, closed, _ = close(problem.long, problem.orbit, start, np.array(masks), x, radius)
    distance = np.where(closed, np.abs(y - x).max(axis=1).astype(float), np.inf)
    if not closed.any():
        return None
    near = np.flatnonzero(distance <= 2 * SHUT)
    best = near[0] if len(near) else int(np.argmin(distance))
    with mp.workdps(DIGITS):
        exact, _ = close_exactly(problem, y[best])
        if exact is None:
            return y[best]
        return np.array([to_long(v) for v in exact])


def admissible_to_rounding(problem: PatternProblem, x: np.ndarray) -> bool:
    """Return whether a state known to rounding is admissible: features within 1e-13 touch."""
    if exactly_admissible(problem, x):
        return True
    phi = x[problem.orbit].astype(float)
    if not _possible_to_rounding(problem, x):
        return False
    creases = fold_long(problem.long, x[None, problem.orbit])[0][0].astype(float)
    key = combinatorics(creases, phi, ROUNDING)
    if not problem.maps:
        return stackable(*key)
    close = np.linalg.norm(creases[:, None] - creases[None], axis=2) <= ROUNDING
    return stackable_with(*key, tuple(int(row.argmax()) for row in close), problem.maps)


def _possible_to_rounding(problem: PatternProblem, x: np.ndarray) -> bool:
    if problem.contact != "none":
        over = np.abs(x) > PI
        x = np.where(over & (np.abs(x) <= PI + ROUNDING), np.sign(x) * PI, x)
    return bool(possible(problem, x[None], np.array([ROUNDING / 8]))[0])


def possible(problem: PatternProblem, y: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Return which states, known to `error` [B], keep the fold limits and do not cross for certain."""
    if not len(y):
        return np.zeros(0, dtype=bool)
    phi = y[:, problem.orbit]
    ok = spin_sign(problem.sectors, phi.astype(float)) > 0
    if problem.contact == "none":
        return ok
    ok &= (np.abs(phi) <= PI).all(axis=1)
    if problem.contact == "full":
        creases, _ = fold_long(problem.long, phi)
        ok &= crossing_margin(creases) <= CROSSING + 8 * error
    return ok


def stacked_out(
    problem: PatternProblem, y: np.ndarray, rng: np.random.Generator, sample: int = 20
) -> int:
    """Estimate how many of the states have touching layers that cannot be stacked, from a sample."""
    if problem.contact != "full" or not len(y):
        return 0
    chosen = rng.permutation(len(y))[:sample]
    bad = 0
    for k in chosen:
        phi = y[k][problem.orbit]
        creases = fold_long(problem.long, phi[None])[0][0].astype(float)
        if nearest_touch(creases[None])[0] <= 1e-14:
            bad += not stackable(*combinatorics(creases, phi.astype(float), 1e-14))
    return len(y) * bad // len(chosen)


def exactly_admissible(problem: PatternProblem, y: np.ndarray) -> bool:
    """Close y [n] with 80 digits and ask for fold limits, crossings and layers."""
    with mp.workdps(DIGITS):
        x, creases = close_exactly(problem, y)
        if x is None:
            return False
        if problem.contact == "none":
            return True
        if any(abs(v) > mp.pi + mp.mpf(10) ** -28 for v in x):
            return False
        if problem.contact == "fold-limits":
            return True
        return embedded(creases, [float(x[v]) for v in problem.orbit], problem.maps)


def close_exactly(problem: PatternProblem, y: np.ndarray):
    """Newton with 80 digits from a state closed to 1e-18; returns variables and creases, or None.

    Creases at +-pi and 0 stay there if the state closes so, or else those at +-pi.  At double roots a
    step halves the distance, and the residual is the distance squared.
    """
    at_limit = np.asarray(np.abs(y) == PI) & (problem.contact != "none")
    flat = np.asarray(y == 0)
    start = []
    for v, s in zip(y, at_limit, strict=True):
        high = float(v)
        start.append(mp.sign(high) * mp.pi if s else mp.mpf(high) + mp.mpf(float(v - LONG(high))))
    for held in (at_limit | flat, at_limit) if flat.any() else (at_limit,):
        x, creases = _newton_exactly(problem, start, held)
        if x is not None and max(abs(a - b) for a, b in zip(x, start, strict=True)) <= 1e-7:
            return x, creases
    return None, None


def _newton_exactly(problem: PatternProblem, x: list, held: np.ndarray):
    least = mp.mpf(10) ** -60
    tie = np.eye(problem.size)[problem.orbit] * (1.0 - held)
    before = mp.mpf(0)
    for _ in range(200):
        creases, (a, b, c) = fold_exactly(problem.exact, [x[v] for v in problem.orbit])
        r = [(b[2] - c[1]) / 2, (c[0] - a[2]) / 2, (a[1] - b[0]) / 2]
        size = max(abs(v) for v in r)
        if size < least:
            return x, creases
        jac = np.array([[float(c[k]) for c in creases] for k in range(3)]) @ tie
        u, s, vt = np.linalg.svd(jac, full_matrices=False)
        good = s > 1e-14
        if not good.any():
            break
        part = u.T @ np.array([float(v / size) for v in r])
        move = -((part * good / np.where(good, s, 1)) @ vt)
        length = size * float(np.abs(move).max())
        if not 0 < length <= 1e-6:
            break
        if 0.45 < length / max(before, length) < 0.55:  # a double root
            move, length = 2 * move, mp.mpf(0)
        before = length
        x = [v + size * mp.mpf(float(m)) for v, m in zip(x, move, strict=True)]
    return None, None
