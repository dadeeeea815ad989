"""Newton on the stationarity conditions of a piece with some contacts held at given openings.

Contacts of a piece are fold limits and creases that meet on a mirror.  Half a vertex lies on one
side of its mirror plane; c_1 and c_4 are in that plane, so a facet of the half meets them only at
its own end there: c_4 on c_1 ("tips").  c_2 on the great circle of facet 3, or c_3 on that of facet
1, means that the crease between is folded by 0 or pi, a limit.  A quarter has limits and c_1 or c_3
on the axis in which its mirrors meet.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tests.independent.search_manifold import E2, Piece

Contact = tuple[str, int, int]
"""("limit", variable, side), ("tips", 0, side) or ("axis", variable, 1); or, the same touch as "tips" in
another measure, ("plane", 0, side): the angle of c_4 off the plane of facet 1."""


def gap(piece: Piece, contact: Contact, x: np.ndarray) -> tuple[float, np.ndarray]:
    """Opening angle of a contact at x [n], and its gradient."""
    kind, v, side = contact
    slope = np.zeros(piece.size)
    if kind == "limit":
        slope[v] = -side
        return math.pi - side * float(x[v]), slope
    creases, image = piece.fold(x)
    c, w = creases[0], image[0]
    weight = np.ones(piece.size)
    weight[[0, -1]] = 0.5
    if kind == "tips":  # angle from c_1 = e1 to c_4 in the plane of e1 and e3
        turn = np.cross(c, c[-1])
        across = np.array([-c[-1, 2], 0.0, c[-1, 0]])
        return side * math.atan2(c[-1, 2], c[-1, 0]), side * weight * (turn @ across)
    if kind == "plane":
        normal = np.cross(c[0], c[1]) / math.sin(piece.chain[0])
        value = float(normal @ c[-1])
        slope = np.cross(c, c[-1]) @ normal
        slope[0] = 0.0  # the first fold turns the plane as well
        return side * math.asin(value), side * weight * slope / math.sqrt(1 - value**2)
    if v == 0:  # the axis is where c_1 is perpendicular to the other mirror's normal K e2
        value, slope = -w[0], -np.cross(c, w)[:, 0]
    else:
        value, slope = c[-1] @ E2, np.cross(c, c[-1]) @ E2
    return math.asin(value), weight * slope / math.sqrt(1 - value**2)


FAR = 0.5
"""Newton that has gone this far [rad] from its start is of no interest."""


@dataclass(frozen=True)
class Stationary:
    """State x, closure multipliers, contact multipliers (energy per opening), and the residual."""

    x: np.ndarray
    closure: np.ndarray
    forces: np.ndarray
    residual: float


def solve(
    piece: Piece,
    x: np.ndarray,
    held: tuple[Contact, ...],
    openings: tuple[float, ...] | None = None,
) -> Stationary:
    """Find the stationary state near x [n] with the contacts `held` at `openings` (0 unless given).

    Energy gradient = closure' lambda + gaps' mu.  Newton in the multipliers and the state; the
    derivative of the left side is that of analytic gradients by central differences.
    """
    start = x = np.array(x, dtype=float)
    n, unit = piece.size, float(piece.stiffness.mean())
    wanted = np.zeros(len(held)) if openings is None else np.array(openings)

    def constraints(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        g, jac = piece.closure(x)
        rows = [gap(piece, c, x) for c in held]
        values = np.array([v for v, _ in rows]) - wanted
        slopes = np.array([s for _, s in rows]).reshape(-1, n)
        return np.concatenate([g[0], values]), np.vstack([jac[0], slopes])

    c, a = constraints(x)
    pull = piece.stiffness * (x - piece.rest) / unit
    lam = np.linalg.lstsq(a.T, pull, rcond=None)[0]
    best = math.inf
    for _ in range(30):
        c, a = constraints(x)
        pull = piece.stiffness * (x - piece.rest) / unit
        residual = np.concatenate([pull - a.T @ lam, c])
        size = float(np.abs(residual).max())
        if size < 3e-16 or (size < 1e-12 and size >= 0.5 * best):
            break
        best = min(best, size)
        h = np.diag(piece.stiffness / unit)
        for v in range(n):
            e = np.zeros(n)
            e[v] = 1e-5
            h[:, v] -= (constraints(x + e)[1] - constraints(x - e)[1]).T @ lam / 2e-5
        m = len(c)
        matrix = np.block([[h, -a.T], [a, np.zeros((m, m))]])
        move = -np.linalg.lstsq(matrix, residual, rcond=1e-13)[0]
        length = np.abs(move[:n]).max()
        move *= min(1.0, 0.2 / max(length, 1e-300))
        x, lam = x + move[:n], lam + move[n:]
        if np.abs(x - start).max() > FAR:
            break
    size = float(np.abs(np.concatenate([pull - a.T @ lam, c])).max())
    split = len(c) - len(held)
    return Stationary(x, unit * lam[:split], unit * lam[split:], size)
