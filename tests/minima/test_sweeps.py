"""Newton's directions by sweeps against dense matrices, and descents and judgements of long vertices."""

import math

import numpy as np
import pytest

from origami_nlp import Model, Scene, State, Vertex
from origami_nlp.kkt import Solve, classify, polish, polishing
from origami_nlp.kkt.certificates import cone
from origami_nlp.minima import descents as descents_module
from origami_nlp.minima.descents import Descents
from origami_nlp.minima.moment_starts import MomentStarts
from origami_nlp.minima.samples import Samples
from origami_nlp.minima.sweeps import sweep
from origami_nlp.programme import fold_limit, random_strata


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
    down = np.where(s.shut == 0, p.left, 0.0)
    lowest = np.linalg.eigvalsh(h)[:, 0]
    got = sweep(s, p, descents.closing.root)
    assert (got.direction[s.shut != 0] == 0).all()
    assert (got.bent[s.shut != 0] == 0).all()
    closes = np.abs(p.free_rows @ got.direction[..., None]).max(axis=(1, 2))
    assert (closes <= 1e-7 * (1 + np.abs(got.direction).max(axis=1))).all()
    firm = lowest > 0.1
    assert firm.sum() > 20
    wanted = -np.linalg.solve(h[firm], down[firm, :, None])[..., 0]
    off = np.abs(wanted - got.direction[firm]).max(axis=1)
    assert (off <= 1e-9 * (1 + np.abs(wanted).max(axis=1))).all()
    slope = np.einsum("ki,ki->k", got.direction, down)
    assert (slope < 0).all()
    # saddles, and only these, are told, with a direction of the curvature that is said
    assert (got.curvature[lowest > 1e-6] > 0).all()
    saddle = lowest < -1e-3
    assert saddle.sum() > 20
    assert (got.curvature[saddle] < 0).mean() > 0.98
    told = got.curvature < 0
    along = np.einsum("ki,kij,kj->k", got.bent, h, got.bent)
    assert np.allclose(along[told], got.curvature[told], atol=1e-10)


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


@pytest.mark.parametrize("n", [30, 60])
def test_long_vertices_are_polished_and_judged_as_short_ones_are(n, monkeypatch):
    model = Model(draw(n, seed=1))
    starts = MomentStarts(model, np.random.default_rng(0)).samples(60, 0)
    ends = Descents(model).run(starts)
    shut_many = False
    for k in np.flatnonzero(ends.converged)[:6]:
        x, shut = ends.samples.x[k], ends.samples.shut[k]
        rows = tuple(fold_limit(int(v), shut[v]) for v in np.flatnonzero(shut))
        end = Solve(x + 1e-6, "", 0, math.nan, np.abs(shut + 0.0), None)
        found = []
        for many in (polishing.MANY, 1000):
            monkeypatch.setattr(polishing, "MANY", many)
            found.append(polish(model, end, rows))
        monkeypatch.undo()
        short, dense = found
        assert short.converged
        assert dense.converged
        assert np.abs(short.x - dense.x).max() < 1e-11
        assert short.rows == dense.rows
        assert classify(State(model, short.x)).verdict == "minimum"
        shut_many |= len(rows) > 12
    assert shut_many


def test_independent_contacts_all_open_at_once(monkeypatch):
    from origami_nlp.kkt import certificates

    rng = np.random.default_rng(0)
    for r, t in ((14, 20), (20, 20)):
        rows = rng.normal(size=(r, t))
        names = tuple(fold_limit(v, 1.0) for v in range(r))
        fast = cone(rows, names)
        monkeypatch.setattr(certificates, "MANY_ROWS", 99)
        slow = cone(rows, names)
        monkeypatch.undo()
        assert fast[0] == slow[0] == t
        assert fast[2] == slow[2] == ()
        assert (rows @ fast[1] > 0).all()
    rows[-1] = -rows[0]  # these two cannot open
    assert cone(rows, names)[2] == (names[0], names[-1])
