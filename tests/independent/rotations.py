"""Folding with rotation matrices, in batches.

With creases at azimuths theta_i the fold about b_i is Rz(theta_i) Rx(phi_i) Rz(-theta_i), so the
product of all folds is M = prod_i Rx(phi_i) Rz(alpha_i), because the sector angles sum to 2 pi, and
the deformed creases are the first columns of its partial products.
"""

from __future__ import annotations

import numpy as np


def fold(sectors: np.ndarray, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return deformed creases [B, N, 3] and the product of all folds M [B, 3, 3] of phi [B, N]."""
    phi = np.atleast_2d(np.asarray(phi, dtype=float))
    count, n = phi.shape
    cos, sin = np.cos(phi), np.sin(phi)
    # columns of the running product; Rx mixes columns 2 and 3, Rz mixes columns 1 and 2
    x = np.tile([1.0, 0.0, 0.0], (count, 1))
    y = np.tile([0.0, 1.0, 0.0], (count, 1))
    z = np.tile([0.0, 0.0, 1.0], (count, 1))
    creases = np.empty((count, n, 3))
    for i, a in enumerate(sectors):
        creases[:, i] = x
        c, s = cos[:, i, None], sin[:, i, None]
        y, z = c * y + s * z, c * z - s * y
        ca, sa = np.cos(a), np.sin(a)
        x, y = ca * x + sa * y, ca * y - sa * x
    return creases, np.stack([x, y, z], axis=-1)


def about(axis: np.ndarray, angle: float) -> np.ndarray:
    """Return the rotation by an angle about a unit vector, [3, 3]."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def rotation_vector(m: np.ndarray) -> np.ndarray:
    """Return axis times angle of rotations [B, 3, 3] (angles below pi)."""
    axial = 0.5 * np.stack(
        [m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1]], axis=-1
    )
    sine = np.linalg.norm(axial, axis=1)
    angle = np.arctan2(sine, 0.5 * (np.trace(m, axis1=1, axis2=2) - 1))
    return axial * np.where(sine > 1e-12, angle / np.maximum(sine, 1e-300), 1.0)[:, None]


def spin_sign(sectors: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Return +1 where the product of folds, lifted to SU(2), is that of the flat sheet, else -1."""
    phi = np.atleast_2d(phi)
    a, b = np.ones(len(phi), complex), np.zeros(len(phi), complex)  # first row of the SU(2) product
    for i, alpha in enumerate(sectors):
        c, s = np.cos(phi[:, i] / 2), np.sin(phi[:, i] / 2)
        a, b = a * c - 1j * b * s, b * c - 1j * a * s
        a, b = a * np.exp(-0.5j * alpha), b * np.exp(0.5j * alpha)
    return np.where(a.real < 0, 1, -1)  # prod Rz(alpha_i) = Rz(2 pi) lifts to -1


def project(
    sectors: np.ndarray,
    orbit: np.ndarray,
    x: np.ndarray,
    held: np.ndarray | None = None,
    steps: int = 40,
) -> tuple[np.ndarray, np.ndarray]:
    """Project orbit angles x [B, n] onto closure of the whole vertex by Gauss-Newton.

    orbit: for each crease the variable that is its fold angle.  held: mask [B, n] or [n] of
    variables that do not move.  Returns states and |rotation vector of M|.
    """
    x = np.array(np.atleast_2d(x), dtype=float)
    n = x.shape[1]
    tie = np.eye(n)[np.asarray(orbit)]  # [N, n]
    free = np.ones_like(x) if held is None else 1.0 - np.broadcast_to(held, x.shape)
    residual = np.full(len(x), np.inf)
    todo = np.arange(len(x))
    for step in range(steps + 1):
        creases, m = fold(sectors, x[todo][:, orbit])
        r = rotation_vector(m)
        residual[todo] = np.linalg.norm(r, axis=1)
        open_ = residual[todo] > (1e-15 if step > 3 else 0)
        if step == steps or not open_.any():
            break
        todo, r, creases = todo[open_], r[open_], creases[open_]
        jac = np.einsum("bik,in->bkn", creases, tie) * free[todo][:, None, :]
        move = -np.einsum("bnk,bk->bn", np.linalg.pinv(jac, rcond=1e-9), r)
        length = np.linalg.norm(move, axis=1, keepdims=True)
        x[todo] += move * np.minimum(1.0, 0.7 / np.maximum(length, 1e-300))
        if step > 8 and residual[todo].max() < 3e-15:
            break
    return x, residual
