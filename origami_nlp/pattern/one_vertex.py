"""A vertex as a sheet with one vertex: facets are triangles with two sides of length 1."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, cross, quaternion, rotations
from origami_nlp.pattern.sheet import Pattern, make_pattern
from origami_nlp.pattern.vertex import Vertex

SHARES = np.linspace(0.0, 0.95, 39)
"""Of half a turn, by which creases of a vertex that does not lie flat are tried to be folded in its reference state."""


def one_vertex(
    vertex: Vertex, stiffness: Sequence[float], rest: Sequence[float], name: str = ""
) -> Pattern:
    """Return the paper of a vertex, its crease i between corners 0 and i (1-based), with springs."""
    n = vertex.degree
    corners, angles = shape_of(vertex.flat, np.array(vertex.sector_angles))
    creases = [(0, i + 1) for i in range(n)]
    polygons = [(0, i + 1, (i + 1) % n + 1) for i in range(n)]
    return make_pattern(
        corners,
        polygons,
        fold_angles=dict(zip(creases, angles.tolist(), strict=True)),
        stiffness=dict(zip(creases, stiffness, strict=True)),
        rest=dict(zip(creases, rest, strict=True)),
        name=name,
    )


def shape_of(flat: bool, sectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertex and unit vectors along the creases of a closed state [N + 1, 3], and its fold angles [N]."""
    if not flat:
        rim, angles = _closed(sectors)
        return np.vstack([np.zeros(3), rim]), angles
    at = np.cumsum(sectors) - sectors
    rim = np.column_stack([np.cos(at), np.sin(at), np.zeros(len(at))])
    return np.vstack([np.zeros(3), rim]), np.zeros(len(at))


def _closed(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    n = len(a)
    # all creases but the last two are folded alike, or to and fro; the last facets close a spherical triangle
    most, best = -CLOSURE_TOL, np.zeros((n, 3))
    to_and_fro = (-1.0) ** np.arange(n)
    for share, way in itertools.product(SHARES, (np.ones(n), -np.ones(n), to_and_fro)):
        folds = math.pi * share * way
        rays, frame = [np.array([1.0, 0.0, 0.0])], np.eye(3)
        for i in range(n - 2):
            c, s = math.cos(a[i]), math.sin(a[i])
            turn = rotations(np.array([[1.0, 0.0, 0.0]]), folds[i : i + 1])[0] if i else np.eye(3)
            frame = frame @ turn @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            rays.append(frame[:, 0])
        first, last = rays[0], rays[-1]
        # x = u first + v last + w (first x last) of length 1, at the angle a_N to one and a_(N-1) to the other
        between = float(first @ last)
        u, v = np.linalg.lstsq(
            np.array([[1.0, between], [between, 1.0]]), np.cos([a[-1], a[-2]]), rcond=None
        )[0]
        flat, up = u * first + v * last, cross(first, last)
        room, size = 1.0 - float(flat @ flat), float(np.linalg.norm(up))
        if room > most and size > CLOSURE_TOL:
            most, best = room, np.array([*rays, flat + math.sqrt(max(room, 0.0)) * up / size])
    angles = _fold_angles(best)
    q: tuple[float, ...] = quaternion.IDENTITY
    for fold, sector in zip((angles / 2).tolist(), (a / 2).tolist(), strict=True):
        q = quaternion.multiply(q, (math.cos(fold), math.sin(fold), 0.0, 0.0))
        q = quaternion.multiply(q, (math.cos(sector), 0.0, 0.0, math.sin(sector)))
    # once round a sheet is a whole turn, q = -1; a whole turn of one crease more is another lift of the same shape
    angles[0] -= 2 * math.pi * (q[0] > 0)
    return best, angles


def _fold_angles(rim: np.ndarray) -> np.ndarray:
    """Return the fold angles of a closed vertex, of unit vectors along its creases, [N]."""
    after = cross(rim, np.roll(rim, -1, axis=0))
    before = np.roll(after, 1, axis=0)
    up = np.einsum("ki,ki->k", rim, cross(before, after))
    return np.arctan2(up, np.einsum("ki,ki->k", before, after))
