"""The flat state: rows of the flat lemma against 50 digits, planted criticality, escape paths from it."""

import itertools
import math

import numpy as np
import pytest
from flint import arb, ctx

from origami_nlp.proof.check_domains import VertexChain
from origami_nlp.proof.check_flat import falls, isolated, rows
from origami_nlp.proof.check_forms import parts
from tests.independent.rotations import project
from tests.proof.balls import at, exactly, scene, sheet_of
from tests.proof.chains_mp import axes, mp, mpf, quaternion

pytestmark = pytest.mark.usefixtures("bits_64")


@pytest.mark.parametrize("degree", [4, 5, 6])
@pytest.mark.parametrize("r0", [1e-6, 1e-3, 0.3])
def test_rows_hold_closure_and_minors_over_powers_of_r(degree, r0):
    s, rng = scene(degree, degree), np.random.default_rng(degree)
    sectors, sheet = s.vertex.sector_angles, sheet_of(s)
    for _ in range(4):
        face = int(rng.integers(degree))
        low = rng.uniform(-1, 1, degree)
        high = np.minimum(1, low + 10 ** rng.uniform(-4, 0, degree))
        low[face] = high[face] = 1.0
        box = tuple(zip(low.tolist(), high.tolist(), strict=True))
        found = rows(sheet, box, arb(r0))
        for share in (-1.0, 1e-3, rng.uniform(-1, 1)):
            r = mpf(r0) * mpf(share)
            u = [mpf(a) + (mpf(b) - mpf(a)) * mpf(rng.random()) for a, b in box]
            xi = {}
            for j, (a, b) in enumerate(box):
                m, size = parts(a, b)
                with ctx.workprec(200):
                    xi[j] = (exactly(u[j]) - m) / size if size > 0 else arb(0)
            x = [r * v for v in u]
            c = axes(sectors, x)
            _, v = quaternion(sectors, x)
            torque = [
                mpf(k) * (a - mpf(b)) for k, a, b in zip(s.stiffness, x, s.rest_angles, strict=True)
            ]
            wanted = [v[0] / r, v[1] / r, v[2] / r**2]
            for four in itertools.combinations(range(degree), 4):
                lines = [[torque[i], c[i][0], c[i][1], c[i][2] / r] for i in four]
                wanted.append(mp.det(mp.matrix(lines)))
            for form, value in zip(found, wanted, strict=True):
                with ctx.workprec(200):  # 1/r^2 takes digits
                    assert abs(at(form, xi) - exactly(value)).lower() < 1e-30


def direction(sectors, rng):
    """An escape path of the flat state: sum u b = 0 and Q(u) = 0, and the derivatives of Q."""
    azimuth = np.concatenate([[0.0], np.cumsum(sectors)[:-1]])
    b = np.array([np.cos(azimuth), np.sin(azimuth)])
    turned = np.triu(np.sin(azimuth[None, :] - azimuth[:, None]), 1)
    kernel = np.linalg.svd(b)[2][2:]
    values, vectors = np.linalg.eigh(kernel @ (turned + turned.T) @ kernel.T)
    ups, downs = vectors[:, values > 0], vectors[:, values < 0]
    p, q = ups @ rng.normal(size=ups.shape[1]), downs @ rng.normal(size=downs.shape[1])
    size = [
        abs(v @ (values_ * v)) for v, values_ in ((vectors.T @ p, values), (vectors.T @ q, values))
    ]
    u = (p / math.sqrt(size[0]) + q / math.sqrt(size[1])) @ kernel
    assert abs(u @ turned @ u) < 1e-12 and abs(b @ u).max() < 1e-12
    return u / abs(u).max(), b, turned.T @ u  # h_i = sum_{j<i} u_j sin(azimuth_i - azimuth_j)


@pytest.mark.slow
@pytest.mark.parametrize("degree", [4, 5])
def test_planted_criticality_is_never_excluded(degree):
    for seed in range(3):
        s, rng = scene(degree, seed), np.random.default_rng(seed)
        _, b, h = direction(np.array(s.vertex.sector_angles), rng)
        torque = rng.normal(size=3) @ np.array([*b, h])
        rest = -torque / np.array(s.stiffness)
        rest *= 2 / abs(rest).max()
        for wrong, done in ((0.0, False), (0.3, True)):
            moved = rest + wrong * rng.normal(size=degree)
            sheet = VertexChain(s.vertex.sector_angles, s.stiffness, moved.tolist())
            assert (isolated(sheet, 1e-6, 400) is not None) == done


def test_a_flat_state_at_rest_is_not_said_to_be_isolated_or_to_fall():
    s = scene(4, 0)
    sheet = VertexChain(s.vertex.sector_angles, s.stiffness, (0.0,) * 4)
    assert isolated(sheet, 1e-6, 200) is None
    assert not falls(sheet)


def test_a_radius_too_large_is_refused():
    sheet = sheet_of(scene(4, 1))
    assert isolated(sheet, 1e-3) is not None
    assert isolated(sheet, 0.5, 300) is None
    assert isolated(sheet, 0.0) is None and isolated(sheet, 7.0) is None


@pytest.mark.parametrize("degree", [4, 5, 6])
def test_energy_falls_from_the_flat_state_where_it_is_said(degree):
    s, rng = scene(degree, degree), np.random.default_rng(0)
    assert falls(sheet_of(s))
    sectors = np.array(s.vertex.sector_angles)
    starts = [r * direction(sectors, rng)[0] for r in (1e-2, -1e-2) for _ in range(5)]
    states, off = project(sectors, np.arange(degree), np.array(starts))
    moved = np.abs(states).max(axis=1) > 1e-3
    change = s.energy(states) - s.energy(np.zeros(degree))
    assert (off[moved] < 1e-13).all() and change[moved].min() < -1e-4
