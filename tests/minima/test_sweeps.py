"""Newton's directions by sweeps against dense matrices."""

import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex
from origami_nlp.minima import descents as descents_module
from origami_nlp.minima.descents import Descents
from origami_nlp.minima.recursive_newton import sweep
from origami_nlp.problem import Model, random_strata
from origami_nlp.starts import Samples


def draw(n, seed=0, contact="fold-limits"):
    rng = np.random.default_rng([seed, n])
    sectors = rng.dirichlet(np.full(n, 3.0)) * 2 * math.pi
    k, rest = 10 ** rng.uniform(-1, 1, n), rng.uniform(-math.pi, math.pi, n)
    return Scene(
        Vertex(tuple(sectors.tolist())), tuple(k.tolist()), tuple(rest.tolist()), "none", contact
    )


def on_strata(model, count, seed=0):
    x = random_strata(model, np.random.default_rng(seed), count)
    return Samples.on(x, np.where(np.abs(x) == math.pi, np.sign(x), 0))


@pytest.mark.parametrize("n", [5, 8, 20])
def test_directions_and_curvatures_are_those_of_dense_matrices(n):
    model = Model(draw(n))
    descents, s = Descents(model), on_strata(model, 300)
    p = descents.closing.point(s)
    h = descents._on_stratum(s, p)
    down = np.where(s.at_limit == 0, p.left, 0.0)
    lowest = np.linalg.eigvalsh(h)[:, 0]
    got = sweep(s, p, descents.closing.root(s), descents.closing.soft(s))
    assert (got.direction[s.at_limit != 0] == 0).all()
    assert (got.bent[s.at_limit != 0] == 0).all()
    closes = np.abs(p.free_rows @ got.direction[..., None]).max(axis=(1, 2))
    assert (closes <= 1e-7 * (1 + np.abs(got.direction).max(axis=1))).all()
    firm = lowest > 0.1
    assert firm.sum() > 20
    wanted = -np.linalg.solve(h[firm], down[firm, :, None])[..., 0]
    off = np.abs(wanted - got.direction[firm]).max(axis=1)
    assert (off <= 1e-9 * (1 + np.abs(wanted).max(axis=1))).all()
    slope = np.einsum("ki,ki->k", got.direction, down)
    pulled = np.abs(down).max(axis=1) > 1e-12  # else fold limits and closure leave nothing free
    assert (slope[pulled] < 0).all() and pulled.sum() > 20
    # saddles, and only these, are reported, with a direction of the curvature that is said
    assert (got.curvature[lowest > 1e-6] > 0).all()
    saddle = lowest < -1e-3
    assert saddle.sum() > 20
    assert (got.curvature[saddle] < 0).mean() > 0.98
    reported = got.curvature < 0
    along = np.einsum("ki,kij,kj->k", got.bent, h, got.bent)
    assert np.allclose(along[reported], got.curvature[reported], atol=1e-10)


def test_swept_descents_reach_the_minima_that_dense_ones_reach(monkeypatch):
    model = Model(draw(10))
    starts = on_strata(model, 600)
    ends = []
    for least in (99, 4):
        monkeypatch.setattr(descents_module, "LONG_CHAIN", least)
        e = Descents(model).run(starts)
        assert e.converged.mean() > 0.9
        ends.append(e.samples.x[e.converged])
    for these, those in (ends, ends[::-1]):
        far = np.array([np.abs(those - x).max(axis=1).min() for x in these])
        assert (far < 1e-5).mean() > 0.95
