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
    # smallest residual in the maximum norm: min s, |B mu - c| <= s
    rows = np.block([[b, -np.ones((t, 1))], [b, np.ones((t, 1))]])
    found = minimise(
        np.r_[np.zeros(r), 1.0],
        rows,
        np.r_[np.full(t, -np.inf), c],
        np.r_[c, np.full(t, np.inf)],
        np.zeros(r + 1),
        np.r_[np.full(r, LARGEST), np.inf],
    )
    if found is None:
        return Multipliers(np.inf, False, np.zeros(r), np.zeros(r), np.zeros(r), np.zeros((0, r)))
    residual = float(np.abs(b @ found[:r] - c).max())
    slack = max(residual * 1.01, 1e-12 * size)
    low, high = c - slack, c + slack
    lower, upper, corners = np.zeros(r), np.zeros(r), [found[:r]]
    for i in range(r):
        unit = np.zeros(r)
        unit[i] = 1.0
        corner = minimise(unit, b, low, high, 0.0, LARGEST)
        if corner is not None:
            corners.append(corner)
            lower[i] = corner[i]
        ray = minimise(-unit, b, np.zeros(t), np.zeros(t), 0.0, 1.0)
        if ray is not None and ray[i] > 1e-9:  # a direction in which the set never ends
            upper[i] = np.inf
            continue
        corner = minimise(-unit, b, low, high, 0.0, LARGEST)
        if corner is not None:
            corners.append(corner)
            upper[i] = corner[i]
    tiny = tolerance * size
    lower, upper = np.where(lower <= tiny, 0.0, lower), np.where(upper <= tiny, 0.0, upper)
    smallest = minimise(np.zeros(r), b, low, high, 0.0, LARGEST, squares=True)
    if smallest is None:
        smallest = np.mean(corners, axis=0)
    vertices = np.vstack([smallest, corners])
    return Multipliers(residual, False, smallest, lower, upper, vertices)
