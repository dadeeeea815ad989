"""Minima beside a sheet folded in half: predicted to second order, found whatever the seed, and in many digits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from mpmath import matrix, mp, mpf

import origami_nlp as o
from origami_nlp.pattern_problem import pose
from origami_nlp.pattern_states import list_flat_folded
from origami_nlp.pattern_states.near_folded import beside_folded
from tests.proof.fifty_digits import turn_x, turn_z


@pytest.fixture(scope="module")
def pair():
    """What a search lists beside foldings, with a seed whose random starts reach none of it."""
    scene = replace(o.examples.degree6(math.radians(63.22), 1.2445), symmetry="none", mirror=None)
    found = o.find_minima(scene, prove=False, seed=2, max_starts=24, escape=False).minima
    half = [m for m in found if beside(m.fold_angles) < 0.1]
    return scene, [np.array(m.fold_angles) for m in half], half


def beside_foldings(scene):
    """Starts beside the foldings of a scene that are not flat."""
    problem = pose(scene)
    states = [x for x in list_flat_folded(problem).states if x.any()]
    return list(beside_folded(problem, states, ()))


def beside(angles):
    """Largest distance of a fold angle from 0 and +-pi."""
    return max(abs(v - math.pi * round(v / math.pi)) for v in angles)


def test_a_search_lists_the_pair_whatever_its_seed(pair):
    _, states, minima = pair
    one, two = states
    assert one == pytest.approx(two[[0, 5, 4, 3, 2, 1]], abs=1e-9)  # about crease 1
    assert all(m.kind == "contact-pinned" and len(m.contacts) == 1 for m in minima)


def test_second_order_is_close_to_it(pair):
    scene, states, _ = pair
    starts = np.array(beside_foldings(scene))
    apart = min(np.abs(starts - state).max(axis=1).min() for state in states)
    assert apart < 2 * beside(states[0]) ** 2


def test_nothing_beside_foldings_of_a_generic_vertex():
    scene = o.Scene(o.Vertex.from_degrees((50, 70, 75, 85, 80)), (1,) * 5, (1, 1, -1, 1, 1))
    assert not beside_foldings(scene)


def test_it_is_a_state_in_many_digits(pair):
    """Closure by products of rotations, the touch by a determinant, torques by their own Newton."""
    scene, states, minima = pair
    k, contact = next(
        (k, m.contacts[0].text) for k, m in enumerate(minima) if "on facet 1" in m.contacts[0].text
    )
    assert "crease 4" in contact
    with mp.workdps(65):  # differences of 1e-20 leave 40 digits
        sectors = [mpf(a) for a in scene.vertex.sector_angles]
        total = sum(sectors)
        sectors = [a * 2 * mp.pi / total for a in sectors]
        stiffness, rest = map(list, (map(mpf, scene.stiffness), map(mpf, scene.rest_angles)))

        def rows(angles):
            frame, rays = mp.eye(3), []
            for angle, sector in zip(angles, sectors, strict=True):
                rays.append(frame[:, 0])
                frame = frame * turn_x(angle) * turn_z(sector)
            a, b, c = rays[0], rays[1], rays[3]
            touch = mp.det(matrix([[v[i] for v in (a, b, c)] for i in range(3)]))
            return [frame[2, 1] - frame[1, 2], frame[0, 2] - frame[2, 0], frame[1, 0] - frame[0, 1], touch]  # fmt: skip

        def slopes(angles):
            h = mpf(10) ** -20
            out = []
            for i in range(6):
                up, down = ([v + s * h * (j == i) for j, v in enumerate(angles)] for s in (1, -1))
                out.append([(p - q) / (2 * h) for p, q in zip(rows(up), rows(down), strict=True)])
            return out  # [6][4]

        def balance(*z):
            angles, multipliers = z[:6], z[6:]
            d = slopes(angles)
            torque = [stiffness[i] * (angles[i] - rest[i]) for i in range(6)]
            left = [torque[i] - sum(d[i][r] * multipliers[r] for r in range(4)) for i in range(6)]
            return [*left, *rows(angles)]

        first = np.array([[float(v) for v in row] for row in slopes([mpf(v) for v in states[k]])])
        torque = np.array(scene.stiffness) * (states[k] - np.array(scene.rest_angles))
        guess = np.linalg.lstsq(first, torque, rcond=None)[0]
        z = [*map(mpf, states[k]), *map(mpf, guess)]
        value, h = balance(*z), mpf(10) ** -20
        columns = []
        for i in range(10):  # Newton with the slopes of the first point: six digits a step
            moved = balance(*(v + h * (j == i) for j, v in enumerate(z)))
            columns.append([(p - q) / h for p, q in zip(moved, value, strict=True)])
        inverse = matrix(columns).T ** -1
        for _ in range(8):
            step = inverse * matrix(value)
            z = [v - d for v, d in zip(z, step, strict=True)]
            value = balance(*z)
        assert max(map(abs, value)) < mpf(10) ** -35
        # closure of the state misses by 1e-16, which half a degree from its singular folding is 1e-14 and more
        assert max(abs(z[i] - mpf(states[k][i])) for i in range(6)) < 1e-10
        assert abs(z[9]) > 1e-4
