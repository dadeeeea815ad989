"""The set of contact multipliers of a state: unique, a polyhedron, or empty.

At a stationary state grad U = J' lam + A' mu with mu >= 0, where J is the Jacobian of loop closure
and A holds the gradients of the closed contacts.  Projected on the kernel Z of J this is B mu = c
with B = Z' A', c = Z' grad U: closure multipliers, which are arbitrary where J loses rank, drop
out.  Where contacts are dependent the set is a polyhedron; we report its point of smallest norm and
the range of each multiplier, never a solver's raw number.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.judge.linear import minimise

LARGEST = 1e6
"""Bound on multipliers (energy divided by mean stiffness) inside the linear programmes; unbounded
directions of
the set are found separately."""


@dataclass(frozen=True)
class Multipliers:
    """Solutions mu >= 0 of B mu = c.

    residual: smallest |B mu - c| over mu >= 0; the state is stationary when it vanishes.
    unique: whether mu is unique.
    smallest: the solution of smallest norm, [r].
    lower, upper: range of each entry, [r]; inf where unbounded.
    vertices: some extreme solutions, shape [v, r], for second-order tests.
    """

    residual: float
    unique: bool
    smallest: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    vertices: np.ndarray


def find_multipliers(b: np.ndarray, c: np.ndarray, tolerance: float = 1e-11) -> Multipliers:
    """Describe {mu >= 0: B mu = c}, shapes [t, r] and [t]."""
    t, r = b.shape
    size = 1.0 + float(np.abs(c).max(initial=0.0))
    empty = np.zeros(0)
    if r == 0:
        return Multipliers(
            float(np.abs(c).max(initial=0.0)), True, empty, empty, empty, np.zeros((1, 0))
        )
    if np.linalg.matrix_rank(b, tol=1e-9) == r:
        mu = np.linalg.lstsq(b, c, rcond=None)[0]
        clipped = np.where(np.abs(mu) <= 0.1 * tolerance * size, 0.0, mu)
        residual = float(np.abs(b @ np.maximum(mu, 0.0) - c).max())
        return Multipliers(residual, True, clipped, clipped, clipped, clipped[None])
    # dependent rows: keep the part of the equations that is more than rounding
    u, singular, _ = np.linalg.svd(b)
    rank = int((singular > 1e-9).sum())
    basis = u[:, :rank]
    missed = float(np.abs(c - basis @ (basis.T @ c)).max())
    b, c = basis.T @ b, basis.T @ c
    t = rank
    found = nonnegative_least_squares(b, c)
    residual = max(missed, float(np.abs(b @ found - c).max(initial=0.0)))
    slack = max(residual * 1.01, 1e-12 * size)
    low, high = c - slack, c + slack
    lower, upper, corners = np.zeros(r), np.zeros(r), [found]
    for i in range(r):
        unit = np.zeros(r)
        unit[i] = 1.0
        corner = minimise(unit, b, low, high, 0.0, LARGEST)
        if corner is not None:
            corners.append(_refined(b, c, corner))
            lower[i] = corners[-1][i]
        ray = minimise(-unit, b, np.zeros(t), np.zeros(t), 0.0, 1.0)
        if ray is not None and ray[i] > 1e-9:  # a direction in which the set never ends
            upper[i] = np.inf
            continue
        corner = minimise(-unit, b, low, high, 0.0, LARGEST)
        if corner is not None:
            corners.append(_refined(b, c, corner))
            upper[i] = corners[-1][i]
    tiny = tolerance * size
    lower, upper = np.where(lower <= tiny, 0.0, lower), np.where(upper <= tiny, 0.0, upper)
    smallest = smallest_norm(b, found)
    vertices = np.vstack([smallest, corners])
    return Multipliers(residual, False, smallest, lower, upper, vertices)


def nonnegative_least_squares(b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Minimise |B mu - c| over mu >= 0 to rounding, by the active-set method of Lawson and Hanson (1974).

    A linear programme would only balance the springs to a solver's tolerance, which hides whether a state
    is stationary.
    """
    r = b.shape[1]
    free = np.zeros(r, dtype=bool)
    mu = np.zeros(r)
    tolerance = 1e-14 * max(1.0, float(np.abs(b).max(initial=0)) * float(np.abs(c).max(initial=0)))
    for _ in range(10 * r + 10):
        pull = b.T @ (c - b @ mu)
        pull[free] = -np.inf
        if r == 0 or free.all() or pull.max() <= tolerance:
            break
        free[int(pull.argmax())] = True
        while True:
            trial = np.zeros(r)
            trial[free] = np.linalg.lstsq(b[:, free], c, rcond=1e-12)[0]
            blocked = free & (trial <= 0)
            if not blocked.any():
                mu = trial
                break
            share = mu[blocked] / np.maximum(mu[blocked] - trial[blocked], 1e-300)
            mu = mu + float(share.min()) * (trial - mu)
            mu[blocked & (mu <= 1e-14)] = 0.0
            still = free & (mu > 0)
            if (still == free).all():
                still[np.flatnonzero(blocked)[int(share.argmin())]] = False
            free = still
    return mu


def smallest_norm(b: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Minimise |mu| over {mu >= 0: B mu = B found}, by least squares (Lawson and Hanson 1974, chapter 23: LDP).

    mu = p + N z with p of smallest norm and N the kernel of B; |z| is smallest under N z >= -p.  `found` >= 0
    is returned where rounding leaves no better point.
    """
    _, singular, vt = np.linalg.svd(b)
    rank = int((singular > 1e-9).sum())
    kernel = vt[rank:].T
    size = float(np.abs(found).max(initial=0.0))
    if size == 0.0 or kernel.shape[1] == 0:
        return found
    p = found / size - kernel @ (kernel.T @ (found / size))
    e = np.vstack([kernel.T, -p])
    f = np.zeros(len(e))
    f[-1] = 1.0
    left = e @ nonnegative_least_squares(e, f) - f
    if abs(left[-1]) <= 1e-12:
        return found
    mu = np.maximum(p - kernel @ (left[:-1] / left[-1]), 0.0) * size
    mu = _refined(b, b @ found, np.where(mu <= 1e-13 * size, 0.0, mu))
    closer = np.abs(b @ (mu - found)).max() <= 1e-12 * max(1.0, size)
    return mu if closer and np.linalg.norm(mu) <= np.linalg.norm(found) else found


def _refined(b: np.ndarray, c: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Take a solver's solution to rounding by a least-squares correction of its positive entries."""
    support = mu > 1e-8 * max(1.0, float(mu.max()))
    better = np.where(support, mu, 0.0)
    for _ in range(2):
        better[support] += np.linalg.lstsq(b[:, support], c - b @ better, rcond=1e-12)[0]
    improved = np.linalg.norm(b @ better - c) < np.linalg.norm(b @ mu - c)
    return better if improved and better.min() >= 0 else np.maximum(mu, 0.0)
