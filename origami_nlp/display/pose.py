"""A folded vertex turned for viewing: upright, and to where most of it is seen."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.folding import fold_vertex
from origami_nlp.pattern import Vertex

CLOSED = 0.1
"""Creases whose |phi| is this near to pi [rad] have their facets drawn apart."""
SPREAD = 0.05
"""Offset [of the unit radius] that keeps facets that lie on each other apart in the picture."""
ARC = math.radians(7)
"""Borders are drawn as straight pieces of at most this angle."""


@dataclass(frozen=True)
class Pose:
    """A folded vertex turned for viewing.

    Attributes
    ----------
    creases
        c_i, shape [N, 3], in the picture's frame: x right, y up, z towards the viewer.
    normals
        Of the upper side of each facet, [N, 3].
    offsets
        Displacement of each facet, [N, 3]; zero unless facets lie on each other.
    """

    creases: np.ndarray
    normals: np.ndarray
    offsets: np.ndarray

    def arc(self, facet: int) -> np.ndarray:
        """Return points on the outer border of a facet.

        Parameters
        ----------
        facet
            Which, from 0.

        Returns
        -------
        ndarray
            From its first crease to its second, a constant small angle apart, [m, 3].
        """
        a, b = self.creases[facet], self.creases[(facet + 1) % len(self.creases)]
        sector = math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
        t = np.linspace(0.0, 1.0, max(2, math.ceil(sector / ARC)) + 1)[:, None]
        turned = (np.sin((1 - t) * sector) * a + np.sin(t * sector) * b) / math.sin(sector)
        return turned + self.offsets[facet]


def pose_state(vertex: Vertex, fold_angles: np.ndarray) -> Pose:
    """Turn a state upright, and to where most of it is seen.

    Upright: the mean normal of the paper's upper side points up (for a symmetric state this is its
    axis, or lies in its mirror).  Where the normals cancel, as in a closed book, the mean of the
    creases does.  Then the best of a fixed set of views is taken: facets seen broadly, crease ends
    apart and not hidden.

    Parameters
    ----------
    vertex
        The vertex.
    fold_angles
        Of the state, shape [N] [rad].

    Returns
    -------
    Pose
        Creases and normals in the picture's frame.
    """
    phi = np.asarray(fold_angles, dtype=float)
    creases, _ = fold_vertex(vertex, phi)
    ends = np.roll(creases, -1, axis=0)
    normals = np.cross(creases, ends)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    offsets = layer_offsets(phi, normals)
    weight = np.array(vertex.sector_angles)[:, None] / (2 * math.pi)
    up = (weight * normals).sum(axis=0)
    if np.linalg.norm(up) < 0.15:
        up = creases.mean(axis=0)
    if np.linalg.norm(up) < 0.15:
        up = np.array([0.0, 0.0, 1.0])
    up = up / np.linalg.norm(up)
    ahead = next(a for c in (*creases, *np.eye(3)) if np.linalg.norm(a := c - (c @ up) * up) > 0.05)
    ahead = ahead / np.linalg.norm(ahead)
    frame = np.stack([ahead, np.cross(up, ahead), up])
    view = _best_view(creases @ frame.T, normals @ frame.T, weight[:, 0])
    turn = view @ frame
    return Pose(creases @ turn.T, normals @ turn.T, offsets @ turn.T)


def layer_offsets(phi: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Displace the facets next to closed creases: a valley (+pi) lays the next facet on top."""
    n = len(phi)
    closed = np.abs(np.abs(phi) % (2 * math.pi) - math.pi) < CLOSED
    offsets = np.zeros((n, 3))
    if not closed.any():
        return offsets
    first = int(np.argmin(np.abs(phi)))  # start behind the most open crease
    for step in range(1, n + 1):
        i = (first + step) % n  # crease i lies between facets i - 1 and i
        move = math.copysign(SPREAD, phi[i]) * normals[i - 1] if closed[i] else np.zeros(3)
        if step < n:
            offsets[i] = offsets[i - 1] + move
    if closed.all():  # the last step back to the first facet: share out what does not fit
        misfit = offsets[first - 1] + move - offsets[first]
        for step in range(n):
            offsets[(first + step) % n] -= misfit * step / n
    return offsets - offsets.mean(axis=0)


def _best_view(creases: np.ndarray, normals: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Choose rows (right, up, towards the viewer) among azimuths and elevations."""
    i, j = np.triu_indices(len(creases), 1)
    azimuth, elevation = np.meshgrid(
        np.radians(np.arange(-60.0, 300.0, 7.5)),
        np.radians([20.0, 35.0, 50.0, 65.0, -20.0, -35.0, -50.0, -65.0]),
    )
    azimuth, elevation = azimuth.ravel(), elevation.ravel()
    s, c, se, ce = np.sin(azimuth), np.cos(azimuth), np.sin(elevation), np.cos(elevation)
    rows = np.array([[-s, c, 0.0 * s], [-se * c, -se * s, ce], [ce * c, ce * s, se]])
    rows = rows.transpose(2, 0, 1)
    flat = creases @ rows[:, :2].transpose(0, 2, 1)
    apart = np.linalg.norm(flat[:, i] - flat[:, j], axis=2)
    shown = np.minimum(np.abs(rows[:, 2] @ normals.T), 0.85)
    creases_hidden, facets_hidden = _hidden(creases, rows[:, 2])
    scores = (
        1.6 * ((shown * (1 - facets_hidden)) @ weight)
        + 1.5 * np.minimum(shown, 0.25).min(axis=1)
        + 1.2 * np.minimum(apart, 0.3).mean(axis=1)
        + 1.0 * np.minimum(apart, 0.2).min(axis=1)
        - 0.9 * creases_hidden
        - 0.15 * abs(abs(elevation) - math.radians(35))
        - 0.1 * (elevation < 0)
    )
    best = 0
    for k, score in enumerate(scores):
        if score > scores[best] + 1e-9:  # the first of equal views, whatever the rounding
            best = k
    return np.asarray(rows[best])


def _hidden(creases: np.ndarray, views: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shares that a facet hides from V viewers at infinity: of creases' middles and ends [V], and of facets [V, N]."""
    n = len(creases)
    a, b = creases, np.roll(creases, -1, axis=0)
    inner = [t * a + (1 - t) * b for t in (0.2, 0.5, 0.8)]
    points = np.concatenate([0.5 * creases, 0.95 * creases, *inner])
    owner, own_facets = np.tile(np.arange(n), 5), np.repeat([False, True], [2 * n, 3 * n])
    hidden = np.zeros((len(views), len(points)), dtype=bool)
    for f in range(n):
        # point + t view = x a + y b with t > 0, x, y >= 0, |x a + y b| <= 1
        sides = np.broadcast_to(np.stack([a[f], b[f]], axis=1), (len(views), 3, 2))
        basis = np.concatenate([sides, -views[:, :, None]], axis=2)
        basis[edge_on := np.abs(np.linalg.det(basis)) < 1e-6] = np.eye(3)
        x, y, t = np.linalg.solve(basis, points.T[None]).transpose(1, 0, 2)
        length = np.linalg.norm(x[..., None] * a[f] + y[..., None] * b[f], axis=2)
        own = (owner == f) | ((owner == (f + 1) % n) & ~own_facets)
        within = (t > 1e-6) & (x > 0) & (y > 0) & (length < 1) & ~own
        hidden |= within & ~edge_on[:, None]
    facets = hidden[:, 2 * n :].reshape(len(views), 3, n).mean(axis=1)
    return hidden[:, : 2 * n].mean(axis=1), facets
