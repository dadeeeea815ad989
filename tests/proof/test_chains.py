"""Closure, triple products and minors over boxes, against folds by rotation matrices in 50 digits."""

import math

import numpy as np
import pytest
from mpmath import mp, mpf

from origami_nlp.proof.affine import variables
from origami_nlp.proof.chains import Vertex
from tests.computed_once import thinned

WIDTHS = [0.0, 1e-9, 1e-4, 0.1, 1.0, 3.0]


def turn_x(angle):
    c, s = mp.cos(angle), mp.sin(angle)
    return mp.matrix([[1, 0, 0], [0, c, -s], [0, s, c]])


def turn_z(angle):
    c, s = mp.cos(angle), mp.sin(angle)
    return mp.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def random_vertex(rng, n):
    sectors = np.full(n, 7.0)
    while sectors.max() > 0.9 * math.pi:
        sectors = rng.dirichlet(np.full(n, 4.0)) * 2 * math.pi
    return Vertex(sectors, 10 ** rng.uniform(-1, 1, n), rng.uniform(-3, 3, n))


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


def exact_sectors(vertex):
    """The doubles, scaled to sum 2 pi exactly."""
    total = sum(map(mpf, vertex.sectors))
    return [mpf(a) * 2 * mp.pi / total for a in vertex.sectors]


def quaternion(axis, angle):
    c, s = mp.cos(angle / 2), mp.sin(angle / 2)
    return [c, s * axis[0], s * axis[1], mpf(0)]


def multiply(p, q):
    a, b, c, d = p
    e, f, g, h = q
    return [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]


@pytest.fixture(autouse=True)
def fifty_digits():
    with mp.workdps(50):
        yield


@pytest.mark.parametrize("n", thinned([5, 4, 6, 7], 2))
@pytest.mark.parametrize("width", WIDTHS)
def test_triple_products_hold_their_values(n, width):
    """In the frame of the first of the three along the arcs that the form takes."""
    rng = np.random.default_rng([n, int(width * 1e9)])
    vertex = random_vertex(rng, n)
    lower, upper, pins = boxes(rng, n, width, 6)
    middle, half = variables(lower, upper)
    form = vertex.triple_products(middle, half, pins)
    sectors = exact_sectors(vertex)
    for k, angles, xi in points(rng, lower, upper, pins, middle, half):
        for (back, on), members in vertex.kinds.items():
            for number, j in members:
                axes, frame = [], mp.eye(3)
                for i in range(j - back, j + on + 1):
                    axes.append(frame[:, 0])
                    frame = frame * turn_x(angles[i % n]) * turn_z(sectors[i % n])
                three = mp.matrix(3, 3)
                for column, axis in enumerate((axes[0], axes[back], axes[back + on])):
                    three[:, column] = axis
                miss = abs(mp.det(three) - value_of(form, number, k, xi))
                assert miss <= mpf(form.error[number, k])


@pytest.mark.parametrize("n", thinned([5, 4, 6], 3))
@pytest.mark.parametrize("width", WIDTHS)
def test_closure_holds_its_values(n, width):
    """conj(q_m) (q_left - q_right), where q_m is the double that the form is multiplied by."""
    rng = np.random.default_rng([n, int(width * 1e9)])
    vertex = random_vertex(rng, n)
    lower, upper, pins = boxes(rng, n, width, 6)
    middle, half = variables(lower, upper)
    form = vertex.closure(middle, half, pins)
    factor = vertex.sides_of(middle, half, pins)[0].centre
    sectors = exact_sectors(vertex)
    azimuth = [sum(sectors[:i], mpf(0)) for i in range(n)]
    for k, angles, xi in points(rng, lower, upper, pins, middle, half):
        ends = []
        for creases, sign in ((range(vertex.half), 1), (range(n - 1, vertex.half - 1, -1), -1)):
            q = [mpf(1), mpf(0), mpf(0), mpf(0)]
            for i in creases:
                axis = mp.cos(azimuth[i]), mp.sin(azimuth[i])
                q = multiply(q, quaternion(axis, sign * angles[i]))
            ends.append(q)
        gap = [a - b for a, b in zip(*ends, strict=True)]
        m = [mpf(v) for v in factor[:, k]]
        exact = multiply([m[0], -m[1], -m[2], -m[3]], gap)
        for row in range(4):
            assert abs(exact[row] - value_of(form, row, k, xi)) <= mpf(form.error[row, k])


@pytest.mark.parametrize("n", thinned([5, 4, 6], 3))
@pytest.mark.parametrize("width", WIDTHS)
def test_minors_hold_their_values_on_closed_states(n, width):
    """det [G_S | C_S] by one determinant, axes of the whole loop in one frame; boxes around states that close."""
    rng = np.random.default_rng([n, int(width * 1e9), 1])
    vertex = random_vertex(rng, n)
    sectors = exact_sectors(vertex)
    k_max = max(map(mpf, vertex.stiffness))
    for _ in range(3):
        angles = closed_state(rng, sectors)
        low = np.array([float(a) - width * rng.random() for a in angles])[:, None]
        lower, upper = np.nextafter(low, -9), np.nextafter(low + width, 9)
        lower = np.minimum(lower, [[float(a)] for a in angles])
        upper = np.maximum(upper, [[float(a)] for a in angles])
        lower, upper = np.nextafter(lower, -9), np.nextafter(upper, 9)
        pins = np.zeros((n, 1), dtype=int)
        middle, half = variables(lower, upper)
        form = vertex.minors(middle, half, pins)
        xi = [(a - mpf(m[0])) / mpf(h[0]) for a, m, h in zip(angles, middle, half, strict=True)]
        assert max(map(abs, xi)) <= 1
        frame, axes = mp.eye(3), []
        for i in range(n):
            axes.append(frame[:, 0])
            frame = frame * turn_x(angles[i]) * turn_z(sectors[i])
        for number, four in enumerate(vertex.fours):
            matrix = mp.matrix(4, 4)
            for row, i in enumerate(four):
                torque = mpf(vertex.stiffness[i]) / k_max * (angles[i] - mpf(vertex.rest[i]))
                matrix[row, 0] = torque
                matrix[row, 1], matrix[row, 2], matrix[row, 3] = axes[i]
            miss = abs(mp.det(matrix) - value_of(form, number, 0, xi))
            assert miss <= mpf(form.error[number, 0])


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


def test_sums_of_sectors_are_held():
    """Azimuths of creases on both sides of the loop, to within what the form allows for."""
    rng = np.random.default_rng(0)
    for n in (4, 5, 6, 9):
        vertex = random_vertex(rng, n)
        sectors = exact_sectors(vertex)
        for creases, products, sign in vertex.sides:
            for i, right in zip(creases, products, strict=True):
                beta = sum(sectors[:i], mpf(0)) if sign > 0 else -sum(sectors[i:], mpf(0))
                assert abs(mp.cos(beta) - mpf(right[1, 0])) <= vertex.doubt_crease
                assert abs(mp.sin(beta) - mpf(right[2, 0])) <= vertex.doubt_crease
