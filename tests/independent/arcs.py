"""Do the arcs of closed spherical polygons cross?  Orientation tests, in batches.

(a x b) x (c x d) = det(a, b, d) c - det(a, b, c) d = det(a, c, d) b - det(b, c, d) a, so this vector
lies inside both arcs a..b and c..d exactly when det(a, b, d), -det(a, b, c), det(a, c, d) and
-det(b, c, d) are all positive; its negative does when all are negative.
"""

from __future__ import annotations

import numpy as np


def facet_pairs(n: int) -> np.ndarray:
    """Return the pairs of non-adjacent facets of a vertex of degree n, shape [P, 2]."""
    return np.array([(i, j) for i in range(n) for j in range(i + 2, n) if (i, j) != (0, n - 1)])


def corner_determinants(creases: np.ndarray) -> np.ndarray:
    """Return D[b, j, k] = det(c_j, c_{j+1}, c_k) / sin(facet angle) of creases [B, N, 3]."""
    following = np.roll(creases, -1, axis=1)
    normal = np.cross(creases, following)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.einsum("bjx,bkx->bjk", normal, creases)


def crossing_margin(creases: np.ndarray) -> np.ndarray:
    """Return for each polygon the largest depth of a proper crossing, <= 0 where there is none."""
    n = creases.shape[1]
    d = corner_determinants(creases)
    i, j = facet_pairs(n).T
    i1, j1 = (i + 1) % n, (j + 1) % n
    signs = np.stack([d[:, i, j1], -d[:, i, j], d[:, j, i], -d[:, j, i1]], axis=-1)
    return np.maximum(signs.min(axis=-1), (-signs).min(axis=-1)).max(axis=1)


def nearest_touch(creases: np.ndarray) -> np.ndarray:
    """Return for each polygon the smallest distance of a crease from a facet that is not its own."""
    n = creases.shape[1]
    d = np.abs(corner_determinants(creases))
    a, b = creases, np.roll(creases, -1, axis=1)
    cosine = np.einsum("bjx,bjx->bj", a, b)[:, :, None]
    to_a = np.einsum("bjx,bkx->bjk", a, creases)
    to_b = np.einsum("bjx,bkx->bjk", b, creases)
    # the foot of c_k on the plane of facet j lies on the arc where c_k is not beyond either end
    inside = (to_a - cosine * to_b >= 0) & (to_b - cosine * to_a >= 0)
    ends = np.minimum(
        np.linalg.norm(a[:, :, None] - creases[:, None], axis=-1),
        np.linalg.norm(b[:, :, None] - creases[:, None], axis=-1),
    )
    distance = np.where(inside, d, ends)
    j = np.arange(n)
    distance[:, j, j] = distance[:, j, (j + 1) % n] = np.inf
    return distance.min(axis=(1, 2))
