"""Planes and directions that part facets at both ends of a step, and on the chords between: the largest gap of them."""

from __future__ import annotations

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, CURVED, NONZERO, area_vectors, cross

TILTS = 0.0, 0.1, 0.3, 1.0
"""By which planes of sectors are turned, in search of one between two sectors: tangents."""


def _least(x: np.ndarray) -> np.ndarray:
    """Return the least along the last axis, which is short: entry by entry that is several times as fast."""
    out: np.ndarray = np.minimum.reduce([x[..., i] for i in range(x.shape[-1])])
    return out


def _largest(x: np.ndarray) -> np.ndarray:
    """Return the largest along the last axis, as `_least`."""
    out: np.ndarray = np.maximum.reduce([x[..., i] for i in range(x.shape[-1])])
    return out


def planes(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Normals of polygons [K, q, 3], [K, 2, 3]."""
    return np.stack([area_vectors(a), area_vectors(b)], axis=1)


def axes_across(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Directions across which convex polygons [K, q, 3] may be apart: of sides, planes, and both, [K, A, 3]."""
    sides = [np.roll(x, -1, axis=1) - x for x in (a, b)]
    normals = [area_vectors(x)[:, None] for x in (a, b)]
    across = cross(sides[0][:, :, None], sides[1][:, None]).reshape(len(a), -1, 3)
    inside = [cross(s, n) for s, n in zip(sides, normals, strict=True)]
    corners = (b[:, None] - a[:, :, None]).reshape(len(a), -1, 3)
    return np.concatenate([*normals, across, *inside, corners], axis=1)


def shadows_apart(a: np.ndarray, b: np.ndarray, axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest gap that shadows of polygons along one of some axes have at both ends of a step.

    Parameters
    ----------
    a, b
        Corners of the one that stays [K, q, 3], and of the other at both ends [2, K, q, 3].
    axes
        Directions, [K, A, 3].

    Returns
    -------
    apart : numpy.ndarray
        Least gap of all that lies on the chords between, [K]: negative where no axis parts them.
    at_ends : numpy.ndarray
        Sum of the largest gaps at either end, [K].
    """
    size = np.linalg.norm(axes, axis=2)
    unit = axes / np.maximum(size, NONZERO)[..., None]
    of_a, of_b = unit @ a.swapaxes(1, 2), unit @ b.swapaxes(2, 3)
    ahead = _least(of_b) - _largest(of_a)
    behind = _least(of_a) - _largest(of_b)
    for gap in (ahead, behind):
        gap[:, size < CURVED * size.max(axis=1, keepdims=True)] = -1.0
    apart = np.maximum(ahead.min(axis=0), behind.min(axis=0)).max(axis=1)
    at_ends = np.maximum(np.maximum(ahead, behind).max(axis=2), 0.0).sum(axis=0)
    return apart, at_ends


def sectors_apart(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the same for sectors with a common apex, from unit rays [K, 2, 3] and [2, K, 2, 3]: sines of angles."""
    middle = 0.5 * (b[0] + b[1])
    between = (middle[:, None] - a[:, :, None]).reshape(len(a), 4, 3)
    # the plane of a, turned about a line at right angles to its middle, away from it
    of_a = cross(a[:, 0], a[:, 1])[:, None]
    of_a = of_a / np.maximum(np.linalg.norm(of_a, axis=2, keepdims=True), NONZERO)
    away = a.sum(axis=1, keepdims=True)
    of_a = np.concatenate([of_a, -of_a], axis=1)
    # until both sides of b are as far in front
    (high, fall) = (np.diff(n @ middle.swapaxes(1, 2), axis=2)[..., 0] for n in (of_a, away))
    even = high / np.where(np.abs(fall) > NONZERO, fall, np.inf)
    tilts = [np.clip(even, 0.0, 1.0), *(np.full_like(even, t) for t in TILTS)]
    of_a = np.concatenate([of_a - t[..., None] * away for t in tilts], axis=1)
    # the plane of b, turned about a line at right angles to its middle until it meets a
    of_b = cross(middle[:, 0], middle[:, 1])[:, None]
    of_b = of_b / np.maximum(np.linalg.norm(of_b, axis=2, keepdims=True), NONZERO)
    of_b = np.concatenate([of_b, -of_b], axis=1)
    inward = middle.sum(axis=1, keepdims=True)
    low = -_largest(of_b @ a.swapaxes(1, 2))
    ahead = _largest(inward @ a.swapaxes(1, 2))
    turned = (
        of_b + (np.maximum(low, 0.0) / np.maximum(ahead, np.abs(low) + NONZERO))[..., None] * inward
    )
    # at right angles to a side of a: towards each side of b
    across = middle[:, None] - np.einsum("kai,kbi->kab", a, middle)[..., None] * a[:, :, None]
    across = across.reshape(len(a), 4, 3)
    both = (middle.sum(axis=1) - a.sum(axis=1))[:, None]
    n = np.concatenate([between, of_a, turned, across, both], axis=1)
    n = n / np.maximum(np.linalg.norm(n, axis=2, keepdims=True), NONZERO)
    # rays of the one behind a plane through the apex, those of the other in front of it
    behind = _largest(n @ a.swapaxes(1, 2)) <= CLOSURE_TOL
    high = np.where(behind, _least(n @ b.swapaxes(2, 3)), -1.0)
    return high.min(axis=0).max(axis=1), np.maximum(high.max(axis=2), 0.0).sum(axis=0)
