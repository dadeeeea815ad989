"""The map of the constant internal moment: its derivative, and the lift."""

import math

import mpmath as mp
import numpy as np
import pytest

from origami_nlp import Scene, Vertex
from origami_nlp.pattern_problem import pose
from origami_nlp.search.moment_map import MomentMap


def draw(n, seed=0, *, contact="fold-limits", flat=True):
    rng = np.random.default_rng([seed, n])
    sectors = rng.dirichlet(np.full(n, 3.0)) * (2 * math.pi if flat else 5.5)
    k, rest = 10 ** rng.uniform(-1, 1, n), rng.uniform(-math.pi, math.pi, n)
    vertex = Vertex(tuple(sectors.tolist()), flat=flat)
    return Scene(vertex, tuple(k.tolist()), tuple(rest.tolist()), "none", contact)


def turn(axis, angle):
    """Rotation matrix about a unit axis, in mpmath."""
    x, y, z = axis
    c, s = mp.cos(angle), mp.sin(angle)
    k = mp.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return mp.eye(3) + s * k + (1 - c) * k * k


def half_chains(model, m):
    """Fold both half chains with matrices, forwards and backwards: both ends of the middle facet, and fold angles."""
    p, n = model.parameters, model.size
    azimuth = [mp.fsum(map(mp.mpf, p.sectors[:i].tolist())) for i in range(n)]
    flat = [mp.matrix([mp.cos(a), mp.sin(a), 0]) for a in azimuth]
    over = mp.fsum(map(mp.mpf, p.sectors.tolist()))
    x, ends = [mp.mpf(0)] * n, []
    half = (n + 1) // 2
    for creases, sign, start in ((range(half), 1, 0), (range(n - 1, half - 1, -1), -1, over)):
        frame = turn((0, 0, 1), -start)
        for i in creases:
            c = frame * flat[i]
            free = mp.mpf(float(p.rest[i])) + sum(
                a * b for a, b in zip(m, c, strict=True)
            ) / mp.mpf(float(p.stiffness[i]))
            x[i] = max(-mp.pi, min(mp.pi, free)) if model.has_limits else free
            frame = frame * turn(flat[i], sign * x[i])
        ends.append(frame)
    return ends, x


def rotation_vector(r):
    """Shorter of the rotation vectors of a matrix."""
    w = mp.matrix([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]) / 2
    sine, cosine = mp.norm(w), (r[0, 0] + r[1, 1] + r[2, 2] - 1) / 2
    return w * (mp.atan2(sine, cosine) / sine)


@pytest.mark.parametrize(("n", "flat"), [(6, True), (10, False)])
def test_miss_and_newtons_step_are_those_of_50_digits(n, flat):
    model = pose(draw(n, flat=flat))
    chain, rng = MomentMap(model), np.random.default_rng(1)
    compared = 0
    for m in rng.normal(size=(16, 3)) * 3 * chain.smallest:
        shot = chain.shoot(m[None])
        with mp.workdps(50):
            exact = [mp.mpf(v) for v in m.tolist()]

            def miss(point):
                (left, right), x = half_chains(model, point)
                return rotation_vector(right * left.T), x

            value, x = miss(exact)
            h = mp.mpf(10) ** -20
            moved = [[v + h * (i == j) for i, v in enumerate(exact)] for j in range(3)]
            columns = [(miss(point)[0] - value) / h for point in moved]
            jacobian = mp.matrix(3, 3)
            for j, column in enumerate(columns):
                jacobian[:, j] = column
            step = mp.lu_solve(jacobian, -value)
            assert (
                max(abs(float(a - mp.mpf(b))) for a, b in zip(x, shot.x[0].tolist(), strict=True))
                < 1e-13
            )
        if np.linalg.norm(shot.miss) > math.pi:
            continue  # the longer way to q = +1, which matrices do not see
        compared += 1
        assert np.abs(np.array(value.tolist(), dtype=float)[:, 0] - shot.miss[0]).max() < 1e-12
        ours = -np.linalg.solve(shot.slope[0], shot.miss[0])
        wanted = np.array(step.tolist(), dtype=float)[:, 0]
        assert np.abs(ours - wanted).max() <= 1e-9 * np.abs(wanted).max()
    assert compared >= 2


def test_newtons_step_by_differences_the_long_way_too():
    model, h = pose(draw(8)), 1e-6
    chain, rng = MomentMap(model), np.random.default_rng(2)
    m = rng.normal(size=(200, 3)) * 5 * chain.smallest
    shot = chain.shoot(m)
    assert (np.linalg.norm(shot.miss, axis=1) > math.pi).sum() > 20
    columns = [
        (chain.shoot(m + h * e).miss - chain.shoot(m - h * e).miss) / (2 * h) for e in np.eye(3)
    ]
    jacobian = np.stack(columns, axis=2)
    same = np.linalg.cond(jacobian) < 1e3
    ours = np.linalg.solve(shot.slope[same], shot.miss[same, :, None])
    wanted = np.linalg.solve(jacobian[same], shot.miss[same, :, None])
    error = np.abs(ours - wanted).max(axis=(1, 2)) / np.abs(wanted).max(axis=(1, 2))
    # a limit between the two points of a difference makes it wrong
    assert (error < 1e-5).mean() > 0.98
