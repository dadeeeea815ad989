"""All candidates for local minima of a scene with two degrees of freedom, stratum by stratum.

The admissible set is a surface with boundary: a local minimum is a local minimum of the surface, of
a curve on which one contact is closed, or a point where two are.  On each of these strata, contact
elsewhere ignored, minimisations (surface, curves) and root searches (points) start from random
states; states with all fold angles 0 or +-pi, where closure is singular, are listed.  Row of any
two facets closes some det(c_j, c_{j+1}, c_k), so these and the fold limits are all the curves.

Fold angles of one orbit are tied; closure is that of the full vertex: the rotation vector of the
product of all folds, whose Jacobian is the matrix of deformed creases and whose second derivative
is d2/dphi_i dphi_j = (c_i x c_j)/2, i < j (product of exponentials).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tests.independent.arcs import corner_determinants
from tests.independent.neighbours import Problem
from tests.independent.rotations import fold, rotation_vector

STEP = 1e-6


@dataclass(frozen=True)
class Stratum:
    """Closed contacts: fold limits (variable, side) and determinants (facet, crease)."""

    limits: tuple[tuple[int, int], ...] = ()
    gaps: tuple[tuple[int, int], ...] = ()


def equations(p: Problem, s: Stratum, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return closure and gaps at x [B, n], and their Jacobian; the held limits have no columns."""
    tie = np.eye(p.size)[p.orbit]
    creases, m = fold(p.sectors, x[:, p.orbit])
    values = [rotation_vector(m)]
    rows = [np.einsum("bik,in->bkn", creases, tie)]
    if s.gaps:
        j, k = np.array(s.gaps).T
        values.append(corner_determinants(creases)[:, j, k])
        slopes = np.zeros((len(x), len(s.gaps), p.size))
        for v in range(p.size):
            e = np.zeros(p.size)
            e[v] = STEP
            up = corner_determinants(fold(p.sectors, (x + e)[:, p.orbit])[0])[:, j, k]
            down = corner_determinants(fold(p.sectors, (x - e)[:, p.orbit])[0])[:, j, k]
            slopes[:, :, v] = (up - down) / (2 * STEP)
        rows.append(slopes)
    jac = np.concatenate(rows, axis=1)
    for v, _ in s.limits:
        jac[:, :, v] = 0
    return np.concatenate(values, axis=1), jac


def retract(
    p: Problem, s: Stratum, x: np.ndarray, steps: int = 25
) -> tuple[np.ndarray, np.ndarray]:
    """Project x [B, n] onto the stratum; returns states and residuals."""
    x = x.copy()
    for v, side in s.limits:
        x[:, v] = side * math.pi
    for _ in range(steps):
        f, jac = equations(p, s, x)
        residual = np.abs(f).max(axis=1)
        if residual.max() < 1e-14:
            break
        move = -np.einsum("bnk,bk->bn", np.linalg.pinv(jac, rcond=1e-9), f)
        x += move * np.minimum(1.0, 0.7 / np.maximum(np.linalg.norm(move, axis=1), 1e-300))[:, None]
    return x, np.abs(equations(p, s, x)[0]).max(axis=1)
