"""Folding in the digits of the moment (`mpmath.mp`), boxes to fold in, and the values of affine forms at their points.

Rotation matrices and products of quaternions; nothing is shared with the code under test.
"""

import math

import numpy as np
from mpmath import mp, mpf

from origami_nlp import Scene, Vertex
from origami_nlp.proof import ReducedVertex
from origami_nlp.proof.pieces import VertexPiece

WIDTHS = [0.0, 1e-9, 1e-4, 0.1, 1.0, 3.0]


def random_vertex(rng, n):
    sectors = np.full(n, 7.0)
    while sectors.max() > 0.9 * math.pi:
        sectors = rng.dirichlet(np.full(n, 4.0)) * 2 * math.pi
    k, rest = 10 ** rng.uniform(-1, 1, n), rng.uniform(-3, 3, n)
    vertex = Vertex(tuple(sectors.tolist()))
    return VertexPiece(ReducedVertex(Scene(vertex, tuple(k), tuple(rest), "none", "fold-limits")))


def exact_sectors(vertex):
    """The doubles, scaled to sum 2 pi exactly."""
    total = sum(map(mpf, vertex.sectors))
    return [mpf(a) * 2 * mp.pi / total for a in vertex.sectors]


def turn_x(angle):
    c, s = mp.cos(angle), mp.sin(angle)
    return mp.matrix([[1, 0, 0], [0, c, -s], [0, s, c]])


def turn_z(angle):
    c, s = mp.cos(angle), mp.sin(angle)
    return mp.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def closed_state(rng, sectors):
    """Random angles, the last three solved by Newton in 50 digits."""
    n = len(sectors)

    def gap(*last):
        frame = mp.eye(3)
        for angle, sector in zip([*first, *last], sectors, strict=True):
            frame = frame * turn_x(angle) * turn_z(sector)
        return [frame[2, 1] - frame[1, 2], frame[0, 2] - frame[2, 0], frame[1, 0] - frame[0, 1]]

    h = mpf(10) ** -25
    while True:
        first = [mpf(v) for v in rng.uniform(-0.8, 0.8, n - 3)]
        last = mp.matrix(rng.uniform(-1.5, 1.5, 3).tolist())
        for _ in range(12):
            f = mp.matrix(gap(*last))
            jacobian = mp.matrix(3, 3)
            for j in range(3):
                moved = last.copy()
                moved[j] += h
                jacobian[:, j] = (mp.matrix(gap(*moved)) - f) / h
            if abs(mp.det(jacobian)) < 1e-6 or mp.norm(last) > 100:
                break
            last -= mp.lu_solve(jacobian, f)
        angles = [*first, *last]
        frame = mp.eye(3)
        for angle, sector in zip(angles, sectors, strict=True):
            frame = frame * turn_x(angle) * turn_z(sector)
        if mp.mnorm(frame - mp.eye(3), "f") < mpf(10) ** -40 and max(map(abs, last)) < 3:
            return angles


def multiply(p, q):
    a, b, c, d = p
    e, f, g, h = q
    return [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]


def fold_quaternion(sectors, angles):
    """Product of all folds as a quaternion [w, x, y, z], and the axes."""
    q, axes, beta = [mpf(1), mpf(0), mpf(0), mpf(0)], [], mpf(0)
    for angle, sector in zip(angles, sectors, strict=True):
        b = [mpf(0), mp.cos(beta), mp.sin(beta), mpf(0)]
        axes.append(multiply(multiply(q, b), [q[0], -q[1], -q[2], -q[3]])[1:])
        c, s = mp.cos(angle / 2), mp.sin(angle / 2)
        q = multiply(q, [c, s * b[1], s * b[2], mpf(0)])
        beta += sector
    return q, axes


def dot(u, v):
    return sum(a * b for a, b in zip(u, v, strict=True))


def cross(u, v):
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def boxes(rng, n, width, count):
    """Random boxes with random pins: lower, upper, pins."""
    lower = np.maximum(rng.uniform(-math.pi, math.pi, (n, count)) - width / 2, -math.pi)
    upper = np.minimum(lower + width, math.pi)
    pins = rng.choice([0, 0, 0, 1, -1], (n, count))
    lower = np.where(pins, pins * math.pi, lower)
    return lower, np.where(pins, lower, upper), pins


def points(rng, lower, upper, pins, middle, half):
    """A random point of each box as exact angles and its xi: corners, the middle, anything."""
    n, count = lower.shape
    pick = rng.uniform(-1, 1, (n, count))
    pick = np.where(rng.random((n, count)) < 0.4, np.sign(pick), pick)
    for k in range(count):
        angles, xi = [], []
        for i in range(n):
            if pins[i, k]:
                angles.append(mp.pi * int(pins[i, k]))
                xi.append(mpf(0))
                continue
            x = lower[i, k] + (upper[i, k] - lower[i, k]) * 0.5 * (1 + pick[i, k])
            x = mpf(min(max(x, lower[i, k]), upper[i, k]))
            angles.append(x)
            xi.append((x - mpf(middle[i, k])) / mpf(half[i, k]) if half[i, k] else mpf(0))
        yield k, angles, xi


def value_of(form, index, k, xi):
    centre = mpf(form.centre[index][k])
    return centre + sum(mpf(form.slopes[index][j, k]) * v for j, v in enumerate(xi))
