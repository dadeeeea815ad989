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

from origami_nlp.numerics import (
    INDEPENDENT,
    ROUNDED,
    STATIONARY,
    extremes,
    has_ray,
    nearest,
    nonnegative_least_squares,
    refined,
)


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


UNBALANCED = 1e-3
"""A residual above this (relative) is no rounding of any solver: nothing balances, and no range is looked for."""


def find_multipliers(b: np.ndarray, c: np.ndarray, tolerance: float = STATIONARY) -> Multipliers:
    """Describe {mu >= 0: B mu = c}, shapes [t, r] and [t]."""
    r = b.shape[1]
    size = 1.0 + float(np.abs(c).max(initial=0.0))
    empty = np.zeros(0)
    if r == 0:
        return Multipliers(
            float(np.abs(c).max(initial=0.0)), True, empty, empty, empty, np.zeros((1, 0))
        )
    if np.linalg.matrix_rank(b, tol=INDEPENDENT) == r:
        mu = np.linalg.lstsq(b, c, rcond=None)[0]
        clipped = np.where(np.abs(mu) <= 0.1 * tolerance * size, 0.0, mu)
        residual = float(np.abs(b @ np.maximum(mu, 0.0) - c).max())
        return Multipliers(residual, True, clipped, clipped, clipped, clipped[None])
    # dependent rows: keep the part of the equations that is more than rounding
    u, singular, vt = np.linalg.svd(b)
    rank = int((singular > INDEPENDENT).sum())
    basis, rows = u[:, :rank], vt[:rank]
    missed = float(np.abs(c - basis @ (basis.T @ c)).max())
    b, c = basis.T @ b, basis.T @ c
    found = nonnegative_least_squares(b, c)
    residual = max(missed, float(np.abs(b @ found - c).max(initial=0.0)))
    if residual > UNBALANCED * size:
        return Multipliers(residual, False, found, np.zeros(r), np.full(r, np.inf), found[None])
    bounded = np.array([not has_ray(rows, i) for i in range(r)])
    corners = np.array(extremes(rows, found, bounded))
    lower, upper = corners.min(axis=0), np.where(bounded, corners.max(axis=0), np.inf)
    tiny = tolerance * size
    lower, upper = np.where(lower <= tiny, 0.0, lower), np.where(upper <= tiny, 0.0, upper)
    smallest = smallest_norm(b, found)
    return Multipliers(residual, False, smallest, lower, upper, np.vstack([smallest, corners]))


def smallest_norm(b: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Minimise |mu| over {mu >= 0: B mu = B found}, to rounding relative to the size of `found`.

    mu = p + N z with p of smallest norm and N the kernel of B; |z| is smallest under N z >= -p.  `found` >= 0
    is returned where rounding leaves no better point.
    """
    _, singular, vt = np.linalg.svd(b)
    rank = int((singular > INDEPENDENT).sum())
    kernel = vt[rank:].T
    size = float(np.abs(found).max(initial=0.0))
    if size == 0.0 or kernel.shape[1] == 0:
        return found
    unit = found / size
    p = unit - kernel @ (kernel.T @ unit)
    z = nearest(np.zeros(kernel.shape[1]), kernel, -p)
    if z is None:
        return found
    mu = p + kernel @ z
    mu = refined(b, b @ unit, np.where(mu <= 10 * ROUNDED, 0.0, mu))
    closer = np.abs(b @ (mu - unit)).max() <= 100 * ROUNDED
    return mu * size if closer and np.linalg.norm(mu) <= np.linalg.norm(unit) else found
