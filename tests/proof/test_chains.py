"""Closure, triple products and minors over boxes, against folds by rotation matrices in 50 digits."""

import numpy as np
import pytest
from mpmath import mp, mpf

from origami_nlp.proof.affine import variables
from origami_nlp.proof.angles import Angles
from tests.computed_once import thinned
from tests.proof.fifty_digits import (
    WIDTHS,
    boxes,
    closed_state,
    exact_sectors,
    multiply,
    points,
    random_vertex,
    turn_x,
    turn_z,
    value_of,
)


def quaternion(axis, angle):
    c, s = mp.cos(angle / 2), mp.sin(angle / 2)
    return [c, s * axis[0], s * axis[1], mpf(0)]


pytestmark = pytest.mark.usefixtures("fifty_digits")


@pytest.mark.parametrize("n", thinned([5, 4, 6, 7], 2))
@pytest.mark.parametrize("width", WIDTHS)
def test_triple_products_hold_their_values(n, width):
    """In the frame of the first of the three along the arcs that the form takes."""
    rng = np.random.default_rng([n, int(width * 1e9)])
    vertex = random_vertex(rng, n)
    lower, upper, pins = boxes(rng, n, width, 6)
    middle, half = variables(lower, upper)
    form = vertex.triple_products(Angles.over(lower, upper, pins))
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
    """(L - R) R_0^-1, where R_0 is R at the middle of the box."""
    rng = np.random.default_rng([n, int(width * 1e9)])
    vertex = random_vertex(rng, n)
    lower, upper, pins = boxes(rng, n, width, 6)
    middle, half = variables(lower, upper)
    form = vertex.closure(Angles.over(lower, upper, pins))
    sectors = exact_sectors(vertex)
    azimuth = [sum(sectors[:i], mpf(0)) for i in range(n)]

    def product(creases, sign, angles):
        q = [mpf(1), mpf(0), mpf(0), mpf(0)]
        for i in creases:
            axis = mp.cos(azimuth[i]), mp.sin(azimuth[i])
            q = multiply(q, quaternion(axis, sign * angles[i]))
        return q

    left, right = range(vertex.half), range(n - 1, vertex.half - 1, -1)
    for k, angles, xi in points(rng, lower, upper, pins, middle, half):
        at = [
            p * mp.pi if p else mpf(m)
            for p, m in zip(pins[:, k].tolist(), middle[:, k], strict=True)
        ]
        w, x, y, z = product(right, -1, at)
        ends = product(left, 1, angles), product(right, -1, angles)
        exact = multiply([a - b for a, b in zip(*ends, strict=True)], [w, -x, -y, -z])
        for row in range(4):
            assert abs(exact[row] - value_of(form, row, k, xi)) <= mpf(form.error[row, k])


@pytest.mark.slow
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
        form = vertex.minors(Angles.over(lower, upper, pins))
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


def test_sums_of_sectors_are_held():
    """Azimuths of creases on both sides of the loop, to within what the form allows for."""
    rng = np.random.default_rng(0)
    for n in (4, 5, 6, 9):
        vertex = random_vertex(rng, n)
        sectors = exact_sectors(vertex)
        for creases, units, sign in vertex.sides:
            for i, (x, y) in zip(creases, units, strict=True):
                beta = sum(sectors[:i], mpf(0)) if sign > 0 else -sum(sectors[i:], mpf(0))
                assert abs(mp.cos(beta) - mpf(x)) <= vertex.doubt_crease
                assert abs(mp.sin(beta) - mpf(y)) <= vertex.doubt_crease
