"""Vertices of degree four scanned: all closed states by spherical triangles, minima among samples.

The creases are corners of a spherical quadrilateral whose sides are the sectors.  With the angle at one corner given
its diagonal follows, and the corner beyond it is one of two; fold angles are then read off the corners.  Every crease
takes its turn as the one that is given, so that no branch is sampled thinly where another turns back.  A sample is a
minimum where no other within `NEAR` is lower.  Nothing of the package is used.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from tests.independent.admissible import admissible

NEAR = 4e-3
"""Distance [rad] within which a sample must be the lowest; samples are some 3e-4 apart."""
SAMPLES = 20_001


def closed_states(sectors: np.ndarray, samples: int = SAMPLES) -> np.ndarray:
    """Return closed states [K, 4], every crease given in turn at equal steps."""
    parts = []
    for first in range(4):
        a = np.roll(sectors, -first)
        parts.append(np.roll(_with_first_given(a, np.linspace(-np.pi, np.pi, samples)), first, 1))
    return np.concatenate(parts)


def _with_first_given(a: np.ndarray, phi: np.ndarray) -> np.ndarray:
    zero = np.zeros_like(phi)
    one = np.array([1.0, 0.0, 0.0]) + zero[:, None]
    # facet 1 lies in the plane z = 0, from crease 1 along x counter-clockwise to crease 2
    two = np.array([np.cos(a[0]), np.sin(a[0]), 0.0]) + zero[:, None]
    # facet 4 was at azimuth -a_4; folded by phi it turns about crease 1
    four = np.stack(
        [np.cos(a[3]) + zero, -np.sin(a[3]) * np.cos(phi), -np.sin(a[3]) * np.sin(-phi)], 1
    )
    inner = np.einsum("ki,ki->k", two, four)
    normal = np.cross(two, four)
    square = np.einsum("ki,ki->k", normal, normal)
    good = square > 1e-20
    inner, normal, square, two, four, one = (
        v[good] for v in (inner, normal, square, two, four, one)
    )
    # c3 = u two + v four + w normal with c3 . two = cos a_2, c3 . four = cos a_3
    u = (np.cos(a[1]) - inner * np.cos(a[2])) / square
    v = (np.cos(a[2]) - inner * np.cos(a[1])) / square
    rest = (1 - (u * np.cos(a[1]) + v * np.cos(a[2]))) / square
    exists = rest >= -1e-12
    w = np.sqrt(np.maximum(rest, 0.0))
    out = []
    for side in (1, -1):
        three = u[:, None] * two + v[:, None] * four + (side * w)[:, None] * normal
        creases = np.stack([one, two, three, four], axis=1)[exists]
        out.append(_fold_angles(creases))
    return np.concatenate(out)


def _fold_angles(creases: np.ndarray) -> np.ndarray:
    """Signed turn from each facet to the next, valley positive, [K, 4]."""
    normal = np.cross(creases, np.roll(creases, -1, axis=1))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    before = np.roll(normal, 1, axis=1)
    sine = np.einsum("kni,kni->kn", np.cross(before, normal), creases)
    return np.arctan2(sine, np.einsum("kni,kni->kn", before, normal))


def minima(energy, sectors: np.ndarray, limits: np.ndarray, contact: str, samples: int = SAMPLES):
    """Return energies and states of the samples that are lowest near by; limits [2, 4] [rad]."""
    x = closed_states(sectors, samples)
    x = x[((x >= limits[0]) & (x <= limits[1])).all(axis=1)]
    x = x[admissible(sectors, x, contact)]
    value = energy(x)
    tree = cKDTree(x)
    low = np.argsort(value, kind="stable")
    taken, found = np.zeros(len(x), bool), []
    near = tree.query_ball_point(x, NEAR) if len(x) < 400_000 else None
    for k in low:
        if not taken[k] and value[near[k]].min() >= value[k]:
            found.append(k)
        taken[near[k]] = True
    return value[found], x[found]
