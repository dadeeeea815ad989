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

import itertools
import math
from dataclasses import dataclass

import numpy as np

from tests.independent.admissible import admissible
from tests.independent.arcs import corner_determinants
from tests.independent.neighbours import Problem
from tests.independent.rotations import fold, project, rotation_vector

STEP = 1e-6


def determinant_classes(p: Problem, rng: np.random.Generator) -> list[tuple[int, int]]:
    """Return (j, k), one for each class of det(c_j, c_{j+1}, c_k) that is equal by symmetry."""
    n = len(p.sectors)
    x, residual = project(p.sectors, p.orbit, rng.uniform(-1.5, 1.5, (8, p.size)))
    d = corner_determinants(fold(p.sectors, x[residual < 1e-12][:, p.orbit])[0])
    kept: list[tuple[int, int]] = []
    for j, k in itertools.product(range(n), repeat=2):
        if k in (j, (j + 1) % n):
            continue
        if not any(np.allclose(np.abs(d[:, j, k]), np.abs(d[:, a, b]), atol=1e-9) for a, b in kept):
            kept.append((j, k))
    return kept


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


def descend(p: Problem, s: Stratum, x: np.ndarray, steps: int = 150) -> np.ndarray:
    """Minimise the energy on a stratum from each x [B, n]; returns those that became stationary."""
    tie = np.eye(p.size)[p.orbit]
    k = tie.T @ (p.stiffness[:, None] * tie)
    unit = np.abs(k).max()
    free = np.ones(p.size)
    for v, _ in s.limits:
        free[v] = 0
    x, residual = retract(p, s, x)
    x = x[residual < 1e-11]
    trust = np.full(len(x), 0.3)
    stationary = np.full(len(x), np.inf)
    energy = p.energy(x)
    for _ in range(steps):
        if not len(x):
            break
        _, jac = equations(p, s, x)
        g = p.torques(x) @ tie / unit * free
        inverse = np.linalg.pinv(jac, rcond=1e-8)
        tangent = np.diag(free) - inverse @ jac
        slope = np.einsum("bnm,bm->bn", tangent, g)
        stationary = np.abs(slope).max(axis=1)
        if s.gaps:
            h = _curvature(p, s, x, tangent, slope) / unit
        else:
            lam = np.einsum("bnk,bn->bk", inverse[:, :, :3], g)
            creases, _ = fold(p.sectors, x[:, p.orbit])
            second = 0.5 * np.einsum(
                "bk,bijk->bij", lam, np.cross(creases[:, :, None], creases[:, None])
            )
            upper = np.triu(second, 1)
            h = k / unit - np.einsum("iv,bij,jw->bvw", tie, upper + upper.transpose(0, 2, 1), tie)
        h = tangent @ h @ tangent
        values, vectors = np.linalg.eigh(h)
        size = np.maximum(np.abs(values), 1e-6 * np.abs(values).max(axis=1, keepdims=True) + 1e-300)
        move = -np.einsum("bij,bj,bkj,bk->bi", vectors, 1 / size, vectors, slope)
        move = np.einsum("bnm,bm->bn", tangent, move)
        length = np.linalg.norm(move, axis=1)
        move *= np.minimum(1.0, trust / np.maximum(length, 1e-300))[:, None]
        y, residual = retract(p, s, x + move, 12)
        new = p.energy(y)
        better = (residual < 1e-11) & (new <= energy + 1e-13 * (unit + energy))
        x[better], energy[better] = y[better], new[better]
        trust = np.where(better, np.minimum(0.5, 1.7 * trust), 0.35 * trust)
        if ((stationary < 1e-11) | (trust < 1e-9)).all():
            break
    limit = 1e-6 if s.gaps else 1e-8
    return x[stationary < limit]


def _curvature(
    p: Problem, s: Stratum, x: np.ndarray, tangent: np.ndarray, slope: np.ndarray
) -> np.ndarray:
    """Second derivative of the energy along a curve, as a matrix, by central differences."""
    h = 1e-4
    t = np.linalg.svd(tangent)[0][:, :, 0]  # the curve's direction
    up, down = retract(p, s, x + h * t, 8)[0], retract(p, s, x - h * t, 8)[0]
    second = (p.energy(up) - 2 * p.energy(x) + p.energy(down)) / h**2
    return second[:, None, None] * np.einsum("bi,bj->bij", t, t)


def candidates(p: Problem, starts: int, rng: np.random.Generator) -> np.ndarray:
    """Return admissible candidates for local minima [m, n] from about `starts` random starts."""
    n = p.size
    contacts: list[Stratum] = []
    if p.contact != "none":
        contacts += [Stratum(limits=((v, s),)) for v in range(n) for s in (-1, 1)]
    if p.contact == "full":
        contacts += [Stratum(gaps=(jk,)) for jk in determinant_classes(p, rng)]
    found = [np.array(list(itertools.product((-math.pi, 0.0, math.pi), repeat=n)))]

    def random(count: int) -> np.ndarray:
        return rng.uniform(-math.pi, math.pi, (count, n))

    found.append(descend(p, Stratum(), random(starts // 2)))
    for s in contacts:
        found.append(descend(p, s, random(max(4, starts // (4 * len(contacts))))))
    pairs = list(itertools.combinations(contacts, 2))
    for a, b in pairs:
        if a.limits and b.limits and a.limits[0][0] == b.limits[0][0]:
            continue
        both = Stratum(a.limits + b.limits, a.gaps + b.gaps)
        x, residual = retract(p, both, random(max(4, starts // (4 * len(pairs)))))
        found.append(x[residual < 1e-12])
    x = np.concatenate(found)
    x = np.where(np.abs(math.pi - np.abs(x)) < 1e-9, np.sign(x) * math.pi, x)
    x = _distinct(x)
    closed = project(p.sectors, p.orbit, x, steps=0)[1] < 1e-10
    x = x[closed & (np.abs(x) <= math.pi if p.contact != "none" else np.abs(x) < 9).all(axis=1)]
    return x[admissible(p.sectors, x[:, p.orbit], p.contact, touch=1e-7)]


def _distinct(x: np.ndarray, tolerance: float = 1e-5) -> np.ndarray:
    _, first = np.unique(np.round(x / tolerance), axis=0, return_index=True)
    x = x[np.sort(first)]
    kept: list[np.ndarray] = []
    for row in x:
        if not kept or np.abs(np.array(kept) - row).max(axis=1).min() > tolerance:
            kept.append(row)
    return np.array(kept).reshape(-1, x.shape[1])
