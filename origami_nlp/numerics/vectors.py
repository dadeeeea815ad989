"""The cross product of 3-vectors, without the overhead of `numpy.cross` (18 microseconds a call); normals by it."""

from __future__ import annotations

from typing import Any

import numpy as np


def cross(a: Any, b: Any) -> np.ndarray:
    """Return a x b for 3-vectors in the last axis, shapes that broadcast; the same bits as `numpy.cross`."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    if a.ndim == 1 and b.ndim == 1:
        (p, q, r), (u, v, w) = a.tolist(), b.tolist()
        return np.array([q * w - r * v, r * u - p * w, p * v - q * u])
    p, q, r = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    x = q * w - r * v
    out = np.empty((*x.shape, 3))
    out[..., 0], out[..., 1], out[..., 2] = x, r * u - p * w, p * v - q * u
    return out


def area_vectors(x: np.ndarray) -> np.ndarray:
    """Return normals of plane polygons [..., q, 3], as long as twice their areas, [..., 3].

    About a corner, so that far from the origin nothing cancels.
    """
    about = x[..., 1:, :] - x[..., :1, :]
    return np.asarray(cross(about[..., :-1, :], about[..., 1:, :]).sum(axis=-2))


def unit_normals(x: np.ndarray) -> np.ndarray:
    """Return unit normals of plane polygons [..., q, 3], counter-clockwise seen from where they point, [..., 3]."""
    normal = area_vectors(x)
    return np.asarray(normal / np.linalg.norm(normal, axis=-1, keepdims=True))


def rotations(axes: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Return rotation matrices [K, 3, 3] about unit axes [K, 3] by angles [K] [rad] (Rodrigues)."""
    # R = 1 + sin a K + (1 - cos a) K^2, 1 - cos a as 2 sin^2(a / 2): no cancellation next to the reference state
    k = np.zeros((len(axes), 3, 3))
    k[:, 0, 1], k[:, 0, 2], k[:, 1, 2] = -axes[:, 2], axes[:, 1], -axes[:, 0]
    k -= k.swapaxes(1, 2)
    s, c = np.sin(angles)[:, None, None], 2 * np.sin(angles / 2)[:, None, None] ** 2
    return np.eye(3) + s * k + c * (k @ k)
