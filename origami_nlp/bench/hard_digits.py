"""50-digit solutions of the KKT system of a scene's model, in a formulation of their own.

Rotation matrices instead of quaternions: with R the product of the folds of the piece and c_j the deformed
creases, d(R v)/d phi_j = c_j x (R v).  Closure is posed as

- D_1: e1 . R e2 = e3 . R e2 = 0;  D_n: n_1 . R n_k = -cos(pi/n);
- C_n: trace(R Q(e3, 2 pi/n)) = 1 + 2 cos(2 pi/n);  no symmetry: the axial vector of R vanishes.

The unknowns are fold angles, closure multipliers and contact multipliers; Newton's matrix is a central
difference at more than twice the digits.  The numbers given to the programme (sector angles, stiffness, rest
angles as doubles) are taken as exact; pi, and the mirrors of a wedge, are exact too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mpmath as mp
import numpy as np

from origami_nlp.model.nlp import Model
from origami_nlp.solve.active import Row, row_values

DIGITS = 50
WORKING = 110
"""Digits of the arithmetic: differences with steps of 1e-35 keep 70 of them."""
MOST_STEPS = 12


@dataclass(frozen=True)
class Exact:
    """A solution of the KKT system: fold angles [n], energy [scene's units], multipliers of the rows [r]
    (scaled energy), and the largest entry of its residual."""

    x: tuple[Any, ...]
    energy: Any
    multipliers: tuple[Any, ...]
    residual: float

    def angle_error(self, x: np.ndarray) -> float:
        """Largest difference of fold angles [rad] from the doubles x [n]."""
        with mp.workdps(DIGITS):
            return float(max(abs(mp.mpf(float(a)) - b) for a, b in zip(x, self.x, strict=True)))

    def energy_error(self, energy: float) -> float:
        """Difference of energies, relative to the exact one."""
        with mp.workdps(DIGITS):
            return float(abs(mp.mpf(energy) - self.energy) / self.energy) if self.energy else energy


def _cross(a: list[Any], b: list[Any]) -> list[Any]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _dot(a: list[Any], b: list[Any]) -> Any:
    return sum(p * q for p, q in zip(a, b, strict=True))


class _Piece:
    """The folded piece of a model in extended precision."""

    def __init__(self, model: Model) -> None:
        s = model.structure
        self.kind, self.order, self.has_crease, self.gaps = s.kind, s.order, s.has_crease, s.gaps
        self.size = n = model.size
        numbers = [mp.mpf(float(v)) for v in model.parameters]
        self.sectors, self.stiffness, self.rest = (
            numbers[: -2 * n],
            numbers[-2 * n : -n],
            numbers[-n:],
        )
        self.scale = mp.mpf(model.scale)

    def fold(self, x: list[Any]) -> tuple[list[list[Any]], list[list[Any]], list[Any]]:
        """Return the deformed rays, the columns of R, and the weight of each fold angle in R."""
        columns = [[mp.mpf(int(i == j)) for i in range(3)] for j in range(3)]
        azimuth, rays, weights, used = mp.mpf(0), [], [], 0
        last = len(self.has_crease) - 1
        for r, crease in enumerate(self.has_crease):
            at_mirror = self.kind == "D" and r in (0, last)
            if r:
                azimuth = azimuth + self.sectors[r - 1] if r <= len(self.sectors) else azimuth
            if self.kind == "D" and r == last:
                azimuth = mp.pi / self.order
            co, si = mp.cos(azimuth), mp.sin(azimuth)
            ray = [co * p + si * q for p, q in zip(columns[0], columns[1], strict=True)]
            rays.append(ray)
            if not crease:
                continue
            half = at_mirror
            weights.append(mp.mpf(1) / 2 if half else mp.mpf(1))
            angle = x[used] * weights[-1]
            used += 1
            cs, sn = mp.cos(angle), mp.sin(angle)
            # R becomes (rotation about the deformed crease) R: Rodrigues on each column
            columns = [
                [cs * v[i] + sn * w[i] + (1 - cs) * d * ray[i] for i in range(3)]
                for v in columns
                for w, d in ((_cross(ray, v), _dot(ray, v)),)
            ]
        return rays, columns, weights

    def _end_normal(self, columns: list[list[Any]]) -> list[Any]:
        co, si = mp.cos(mp.pi / self.order), mp.sin(mp.pi / self.order)
        return [si * p - co * q for p, q in zip(columns[0], columns[1], strict=True)]

    def closure(self, x: list[Any]) -> tuple[list[Any], list[list[Any]]]:
        """Return the closure equations and their gradients [m][n]."""
        rays, columns, weights = self.fold(x)
        creases = [ray for ray, has in zip(rays, self.has_crease, strict=True) if has]
        if self.kind == "D" and self.order == 1:
            slopes = [_cross(c, columns[1]) for c in creases]
            values = [columns[1][0], columns[1][2]]
            rows = [[w * s[k] for w, s in zip(weights, slopes, strict=True)] for k in (0, 2)]
            return values, rows
        if self.kind == "D":
            normal = self._end_normal(columns)
            slopes = [_cross(c, normal) for c in creases]
            row = [w * s[1] for w, s in zip(weights, slopes, strict=True)]
            return [normal[1] + mp.cos(mp.pi / self.order)], [row]
        if self.order > 1:  # columns of R Q(e3, turn)
            turn = 2 * mp.pi / self.order
            co, si = mp.cos(turn), mp.sin(turn)
            a, b = columns[0], columns[1]
            columns = [
                [co * p + si * q for p, q in zip(a, b, strict=True)],
                [co * q - si * p for p, q in zip(a, b, strict=True)],
                columns[2],
            ]
            trace = sum(columns[i][i] for i in range(3)) - 1 - 2 * co
            slopes = [[_cross(c, v) for v in columns] for c in creases]
            return [trace], [[sum(s[i][i] for i in range(3)) for s in slopes]]
        slopes = [[_cross(c, v) for v in columns] for c in creases]
        axial = [(1, 2), (2, 0), (0, 1)]
        return (
            [columns[i][j] - columns[j][i] for i, j in axial],
            [[s[i][j] - s[j][i] for s in slopes] for i, j in axial],
        )

    def opening(self, x: list[Any], row: Row) -> Any:
        """Return the opening of a contact, >= 0 when open."""
        if row.kind == "limit":
            return mp.pi - row.side * x[row.index]
        gap = self.gaps[row.index]
        rays, columns, _ = self.fold(x)
        if gap.type == "facet-pair":
            k, j = gap.rays
            sine = mp.sin(self.sectors[j % len(self.sectors)])
            facet = _cross(rays[j], rays[(j + 1) % len(rays)])
            return row.side * _dot(facet, rays[k]) / sine
        r, side = gap.rays
        return rays[r][1] if side == 0 else _dot(rays[r], self._end_normal(columns))


def solve_to_50_digits(model: Model, start: np.ndarray, rows: tuple[Row, ...] = ()) -> Exact | None:
    """Solve stationarity, closure and `rows` closed by Newton from `start` [n]; None if it fails.

    Fails where closure loses rank or rows are dependent: there only closed forms are exact.
    """
    with mp.workdps(WORKING):
        return _solve(model, start, rows)


def _solve(model: Model, start: np.ndarray, rows: tuple[Row, ...]) -> Exact | None:
    piece = _Piece(model)
    n, r = piece.size, len(rows)
    step = mp.mpf(10) ** -35
    x0 = [mp.mpf(float(v)) for v in start]
    m = len(piece.closure(x0)[0])

    def opening_slopes(x: list[Any]) -> list[list[Any]]:
        out = []
        for row in rows:
            slope = []
            for v in range(n):
                ahead, behind = list(x), list(x)
                ahead[v], behind[v] = x[v] + step, x[v] - step
                slope.append((piece.opening(ahead, row) - piece.opening(behind, row)) / (2 * step))
            out.append(slope)
        return out

    def system(u: list[Any]) -> list[Any]:
        x, lam, mu = u[:n], u[n : n + m], u[n + m :]
        values, slopes = piece.closure(x)
        pushes = opening_slopes(x)
        force = [piece.stiffness[v] * (x[v] - piece.rest[v]) for v in range(n)]
        for weight, slope in (*zip(lam, slopes, strict=True), *zip(mu, pushes, strict=True)):
            force = [f - weight * s for f, s in zip(force, slope, strict=True)]
        return [*force, *values, *(piece.opening(x, row) for row in rows)]

    # multipliers that balance the springs best, from doubles
    slopes = np.array([[float(v) for v in s] for s in (*piece.closure(x0)[1], *opening_slopes(x0))])
    force = np.array([float(piece.stiffness[v] * (x0[v] - piece.rest[v])) for v in range(n)])
    guess = np.linalg.lstsq(slopes.T, force, rcond=1e-10)[0] if len(slopes) else np.zeros(0)
    u = [*x0, *(mp.mpf(float(v)) for v in guess)]
    small = mp.mpf(10) ** -60
    for _ in range(MOST_STEPS):
        f = system(u)
        size = max(abs(v) for v in f)
        if size <= small:
            break
        jac = mp.matrix(n + m + r, n + m + r)
        for k in range(n + m + r):
            ahead, behind = list(u), list(u)
            ahead[k], behind[k] = u[k] + step, u[k] - step
            difference = zip(system(ahead), system(behind), strict=True)
            for i, (a, b) in enumerate(difference):
                jac[i, k] = (a - b) / (2 * step)
        try:
            move = mp.lu_solve(jac, mp.matrix([-v for v in f]))
        except ZeroDivisionError:
            return None
        if max(abs(v) for v in move[:n]) > 1:
            return None
        u = [a + b for a, b in zip(u, move, strict=True)]
    residual = max(abs(v) for v in system(u))
    if residual > mp.mpf(10) ** -DIGITS:
        return None
    stretch = zip(piece.stiffness, u[:n], piece.rest, strict=True)
    energy = piece.scale * sum(k * (a - b) ** 2 for k, a, b in stretch) / 2
    return Exact(tuple(u[:n]), energy, tuple(u[n + m :]), float(residual))


def rows_closed(model: Model, x: np.ndarray) -> tuple[Row, ...]:
    """Return the contacts closed at a polished state, on its first smooth piece."""
    from origami_nlp.solve.active import closed_contacts

    contacts = closed_contacts(model, x, model.local(x).gaps)
    return (contacts.combinations() or [contacts.base])[0]


def double_multipliers(model: Model, x: np.ndarray, rows: tuple[Row, ...]) -> np.ndarray:
    """Return the package's multipliers of independent `rows` at x, as the polish computes them, [r]."""
    local = model.local(x)
    _, slopes = row_values(model, x, rows, local.gaps, local.gaps_jacobian)
    jac = np.vstack([local.closure_jacobian, slopes])
    return np.linalg.lstsq(jac.T, local.gradient, rcond=1e-10)[0][len(local.closure) :]
