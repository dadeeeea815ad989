"""Rigid facets by rotation matrices alone: a second way to place, close and part them, without the package.

Only the data of a pattern is read: corners, polygons, creases with the facets beside them.
"""

import fcl
import numpy as np
from scipy.spatial.transform import Rotation

CUT = 1e-7
"""Corners that two facets share are cut off by this share of their sides: what crosses, crosses beyond."""
SHALLOW = 1e-11
"""Facets that reach no further into each other touch, over the size of the sheet."""


class Rigid:
    """A pattern of plain facets (one polygon each), placed from facet to facet breadth first."""

    def __init__(self, pattern):
        assert len(pattern.polygons) == pattern.facets
        self.p = pattern
        beside = {}
        for c, (a, b) in enumerate(zip(pattern.left.tolist(), pattern.right.tolist(), strict=True)):
            beside.setdefault(a, []).append((b, c, -1.0))
            beside.setdefault(b, []).append((a, c, 1.0))
        self.order, seen, k = [(0, -1, -1, 0.0)], {0}, 0
        while k < len(self.order):
            here = self.order[k][0]
            for there, c, sense in beside[here]:
                if there not in seen:
                    seen.add(there)
                    self.order.append((there, here, c, sense))
            k += 1

    def steps(self, phi, creases, senses):
        """4 x 4 matrices of the motions across creases: from left to right where the sense is -1."""
        p = self.p
        start = p.corners[p.ends[creases, 0]]
        axes = p.corners[p.ends[creases, 1]] - start
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        angles = senses * (phi[creases] - p.reference[creases])
        steps = np.tile(np.eye(4), (len(axes), 1, 1))
        steps[:, :3, :3] = Rotation.from_rotvec(angles[:, None] * axes).as_matrix()
        steps[:, :3, 3] = start - np.einsum("kij,kj->ki", steps[:, :3, :3], start)
        return steps

    def place(self, phi):
        """4 x 4 matrices of the facets."""
        facets, before, creases, senses = map(np.array, zip(*self.order[1:], strict=True))
        out = {0: np.eye(4)}
        steps = self.steps(phi, creases, senses)
        for f, there, step in zip(facets.tolist(), before.tolist(), steps, strict=True):
            out[f] = out[there] @ step
        return [out[f] for f in range(self.p.facets)]

    def polygons(self, phi):
        """Corners of the facets in space."""
        motions = self.place(phi)
        return [
            self.p.corners[list(q)] @ motions[f][:3, :3].T + motions[f][:3, 3]
            for q, f in zip(self.p.polygons, self.p.facet_of, strict=True)
        ]

    def open(self, phi):
        """How far the facets beside each crease are from being turned about it by its fold angle, [12 n]."""
        p, motions = self.p, np.array(self.place(phi))
        across = self.steps(phi, np.arange(p.creases), -np.ones(p.creases))
        return (motions[p.left] @ across - motions[p.right])[:, :3].ravel()

    def differences(self, phi, h=1e-6):
        """Differences of `open` over fold angles, [12 n, n]."""
        rows = [
            (self.open(phi + h * e) - self.open(phi - h * e)) / (2 * h) for e in np.eye(len(phi))
        ]
        return np.array(rows).T

    def slopes(self, phi):
        """Those, pseudo-inverted: singular values below 1e-6 are none."""
        return np.linalg.pinv(self.differences(phi), rcond=1e-6)

    def closed(self, phi, inverse, steps=30, within=1e-11):
        """Close fold angles near a state by Newton's chords from there; None where that fails."""
        for _ in range(steps):
            miss = self.open(phi)
            if np.abs(miss).max() < within:
                return phi
            phi = phi - inverse @ miss
        return None

    def collide(self, phi):
        """Pairs of facets without a common crease that the Flexible Collision Library finds in each other."""
        x = self.polygons(phi)
        beside = {tuple(sorted(q)) for q in zip(self.p.left, self.p.right, strict=True)}
        low, high = np.array([q.min(axis=0) for q in x]), np.array([q.max(axis=0) for q in x])
        overlap = np.tril(
            (low[:, None] <= high).all(axis=2) & (low <= high[:, None]).all(axis=2), -1
        )
        pairs = [(j, i) for i, j in np.argwhere(overlap).tolist()]
        return [(j, i) for j, i in pairs if (j, i) not in beside and collide(x[i], x[j])]

    def deep(self, phi):
        """Pairs of facets that pass through each other by more than they may touch."""
        x, size = self.polygons(phi), np.ptp(self.p.corners, axis=0).max()
        return [(i, j) for i, j in self.collide(phi) if depth(x[i], x[j]) > SHALLOW * size]


def collide(a, b):
    """Return whether the library finds one polygon in another, but for corners that they share."""
    a, b = _without(a, b), _without(b, a)
    return fcl.collide(_mesh(a), _mesh(b), fcl.CollisionRequest(), fcl.CollisionResult()) > 0


def _mesh(corners):
    model = fcl.BVHModel()
    triangles = np.array([(0, i, i + 1) for i in range(1, len(corners) - 1)])
    model.beginModel(len(corners), len(triangles))
    model.addSubModel(np.ascontiguousarray(corners), triangles)
    model.endModel()
    return fcl.CollisionObject(model)


def _without(corners, other):
    """A convex polygon with each corner cut off that is a corner of the other polygon too."""
    shared = (np.linalg.norm(corners[:, None] - other[None], axis=2) < 1e-9).any(axis=1)
    out = []
    for i, x in enumerate(corners):
        before, after = corners[i - 1], corners[(i + 1) % len(corners)]
        out += [x + CUT * (before - x), x + CUT * (after - x)] if shared[i] else [x]
    return np.array(out)


def depth(a, b):
    """Shortest translation along an axis (normals, normals of sides, products of sides) that parts two polygons."""
    sides = [np.roll(x, -1, axis=0) - x for x in (a, b)]
    normals = [np.cross(e[0], e[1]) for e in sides]
    axes = [*normals, *np.cross(sides[0][:, None], sides[1][None]).reshape(-1, 3)]
    axes += [np.cross(n, e) for n, es in zip(normals, sides, strict=True) for e in es]
    axes = np.array([x / np.linalg.norm(x) for x in axes if np.linalg.norm(x) > 1e-9])
    of_a, of_b = a @ axes.T, b @ axes.T
    overlap = np.minimum(of_a.max(0) - of_b.min(0), of_b.max(0) - of_a.min(0))
    return overlap.min()
