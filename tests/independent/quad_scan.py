"""Meshes of vertices of degree four, scanned along one fold: directions placed on a sphere, no closed form of folds.

Round a vertex with one known fold three directions of creases have a place; the fourth is where two circles on the
sphere meet, twice.  Folds are measured between normals of facets.  Only corners and creases are read.
"""

import itertools

import numpy as np


def turned(u, axis, angle):
    """Vectors [K, 3] turned about axes by angles [K]."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return u * c + np.cross(axis, u) * s + axis * np.sum(axis * u, axis=1)[:, None] * (1 - c)


def measured(before, at, after):
    """Folds at directions [K, 3] between two facets, each given by the direction of its other crease."""
    n, m = np.cross(before, at), np.cross(at, after)
    return np.arctan2(np.sum(at * np.cross(n, m), axis=1), np.sum(n * m, axis=1))


def of_vertex(u, first, side):
    """Folds of a vertex with flat directions u [4, 3] where the first is known [K]: [4, K], nan where none close."""
    u1, u2 = (np.broadcast_to(x, (len(first), 3)) for x in u[:2])
    u4 = turned(np.broadcast_to(u[3], (len(first), 3)), u1, -first)
    # u3 has the products that it has in the sheet with u2 and u4
    p, q = u[2] @ u[1], u[2] @ u[3]
    d = np.sum(u2 * u4, axis=1)
    det = 1 - d * d
    a, b = (p - q * d) / det, (q - p * d) / det
    out = 1 - a * a - b * b - 2 * a * b * d
    normal = np.cross(u2, u4)
    with np.errstate(invalid="ignore"):
        height = side * np.sqrt(out / det)
    u3 = a[:, None] * u2 + b[:, None] * u4 + height[:, None] * normal
    return np.array(
        [measured(u4, u1, u2), measured(u1, u2, u3), measured(u2, u3, u4), measured(u3, u4, u1)]
    )


def scan(pattern, theta):
    """Yield, for each way to fold all vertices, all folds [creases, K] and by how much a loop does not close [K]."""
    place = pattern.corners
    rounds = []
    for v in pattern.vertices:
        away = np.array([place[int(pattern.ends[c].sum()) - v.vertex] for c in v.creases])
        away = away - place[v.vertex]
        away /= np.linalg.norm(away, axis=1)[:, None]
        rounds.append((v.creases, away))
    order = rounds[:1]
    for one in order:
        order += [r for r in rounds if not any(r is o for o in order) and {*r[0]} & {*one[0]}]
    drive = order[0][0][0]
    for sides in itertools.product((1, -1), repeat=len(order)):
        folds = {drive: 2 * theta}
        off = np.zeros(len(theta))
        for (creases, u), side in zip(order, sides, strict=True):
            at = next(i for i, c in enumerate(creases) if c in folds)
            found = of_vertex(np.roll(u, -at, axis=0), folds[creases[at]], side)
            for c, phi in zip(np.roll(creases, -at).tolist(), found, strict=True):
                if c in folds:
                    away = phi - folds[c]
                    off = np.where(np.abs(away) > np.abs(off), away, off)
                else:
                    folds[c] = phi
        # a turn about a vertex too much: an even number of folds is negative
        closed = np.ones(len(theta), bool)
        for creases, _ in order:
            closed &= np.prod([np.sign(folds[c]) for c in creases], axis=0) < 0
        yield np.array([folds[c] for c in range(pattern.creases)]), np.where(closed, off, np.nan)
