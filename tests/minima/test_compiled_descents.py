"""Descents in C: ends are KKT points by the model's own derivatives, whoever makes them; without a compiler IPOPT."""

import ctypes
import json
import math
import os
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, examples, find_minima
from origami_nlp.minima import compiled
from origami_nlp.minima.descents import Descents
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import detent, double_well, linear, one_sided, sum_of, table
from origami_nlp.problem import OPEN, Contact, Model
from origami_nlp.starts import EFFORTS, Rounds, Samples, joined
from tests.computed_once import thinned

pytestmark = pytest.mark.skipif(compiled() is None, reason="no C compiler, or it is switched off")
SAME = 1e-9
"""Fold angles [rad]: descents stop at 1e-10 of the torque, in curvatures of order 1."""


def vertex(degree, seed, contact="fold-limits", decades=2.0):
    rng = np.random.default_rng([degree, seed])
    s = rng.uniform(0.5, 1.5, degree)
    return Scene(
        Vertex(tuple(s * 2 * math.pi / s.sum())),
        tuple(10 ** rng.uniform(-decades / 2, decades / 2, degree)),
        tuple(rng.uniform(-math.pi, math.pi, degree)),
        symmetry="none",
        contact=contact,
    )


def starts_of(model, descents, most):
    """Starts of the first round, spread over its families."""
    samples = next(iter(Rounds(model, 0, EFFORTS["normal"])))
    samples = samples[np.unique(np.linspace(0, len(samples) - 1, most).astype(int))]
    good = np.isfinite(samples.x).all(axis=1)
    at = descents.closing.kinematics.fold(samples.x)
    return samples[good & (descents.crossings.of(at, samples.x, samples.at_limit)[0] == OPEN)]


def assert_same(one, other, to=SAME):
    for name in ("converged", "settled", "broken"):
        assert (getattr(one, name) == getattr(other, name)).all()
    for name in ("at_limit", "slots", "sides", "hold", "source"):
        assert (getattr(one.samples, name) == getattr(other.samples, name)).all()
    done = one.converged | one.settled
    assert np.abs(one.samples.x - other.samples.x)[done].max(initial=0.0) <= to


def test_columns_first_is_the_same_start():
    model = Model(vertex(5, 1))
    descents = Descents(model)
    some = starts_of(model, descents, 24)
    turned = replace(some, x=np.asfortranarray(some.x), at_limit=np.asfortranarray(some.at_limit))
    one, other = map(descents.run, (some, turned))
    assert_same(one, other, 0.0)


def with_laws(scene, every=2):
    """Laws of all kinds on each second crease: falling torques, table data, pieces of all lengths."""
    rng = np.random.default_rng(scene.degree)
    x = np.sort(np.concatenate([[-math.pi, math.pi], rng.uniform(-3, 3, 13)]))
    kinds = (
        double_well(1.0, 0.9, 0.1),
        sum_of([linear(0.5, 0.3), detent(0.2, 6), one_sided(30.0, 1.0)]),
        table(x, x + 0.7 * rng.normal(size=15)),
    )
    laws = [kinds[i % 3] if i % every == 0 else None for i in range(scene.degree)]
    return replace(scene, laws=tuple(laws))


CASES = {
    "a cell of degree 6, symmetric": (examples.degree6("pi/3", 1), 100),
    "degree 8, symmetric": (examples.degree8("pi/8", 0.1), 60),
    "mirrored, full contact": (examples.degree6("pi/4", 0.01), 60),
    "degree 4": (vertex(4, 2), 100),
    "degree 6": (vertex(6, 2), 150),
    "degree 9, swept": (vertex(9, 2), 100),
    "degree 30, many limits": (vertex(30, 1), 30),
    "degree 5 through itself": (vertex(5, 3, "none"), 80),
    "degree 6 with contact": (vertex(6, 2, "full"), 120),
    "degree 7 with contact": (vertex(7, 3, "full"), 120),
    "stiffness ratios of 1e8": (vertex(5, 3, decades=7.9), 120),
    "the same with contact": (vertex(6, 3, "full", decades=7.9), 120),
    "degree 4 with laws": (with_laws(vertex(4, 2), 1), 100),
    "degree 6 with laws": (with_laws(vertex(6, 2), 1), 120),
    "degree 6 with laws and contact": (with_laws(vertex(6, 2, "full")), 120),
    "a symmetric cell with laws": (
        replace(examples.degree6("pi/3", 1), laws=(double_well(1.0, 1.0),) * 6),
        100,
    ),
    "degree 9 with laws, swept": (with_laws(vertex(9, 2)), 100),
    "degree 20 with laws, swept": (with_laws(vertex(20, 3)), 40),
}


@pytest.mark.parametrize("scene, most", thinned([*CASES.values()], 3), ids=CASES)
def test_ends_are_stationary_with_their_contacts_and_lower(scene, most):
    model = Model(scene)
    descents = Descents(model)
    starts = starts_of(model, descents, most)
    ends = descents.run(starts)
    done = np.flatnonzero(ends.converged)
    assert len(starts) > 20 and len(done) >= 0.5 * len(starts)
    for k in done:
        s, local = ends.samples, model.local(ends.samples.x[k])
        at_limit = np.flatnonzero(s.at_limit[k])
        contacts = [Contact("limit", int(v), int(s.at_limit[k, v])) for v in at_limit]
        slots = zip(s.slots[k].tolist(), s.sides[k].tolist(), strict=True)
        contacts += [Contact("gap", gap, side) for gap, side in slots if gap != OPEN]
        _, slopes = local.openings(contacts)
        rows = np.vstack([local.closure_jacobian, slopes])
        forces, *_ = np.linalg.lstsq(rows.T, local.gradient, rcond=1e-9)
        size = 1 + np.abs(local.gradient).max() + np.abs(forces).max()
        assert np.abs(local.closure).max() <= CLOSURE_TOL
        assert np.abs(local.gradient - rows.T @ forces).max() <= 1e-7 * size
    energy = model.parameters.energy
    assert (energy(ends.samples.x) <= energy(starts.x) + 1e-7).all()


def test_threads_change_nothing():
    model = Model(vertex(5, 4))
    samples = starts_of(model, Descents(model), 400)
    one, two = (Descents(model, threads=k).run(samples) for k in (1, 2))
    assert_same(one, two, 0.0)


def test_where_linear_algebra_breaks_down_a_descent_ends_where_it_began():
    descents = Descents(Model(vertex(5, 5)))
    x = np.full((3, 5), 0.1)
    x[1] = math.nan
    ends = descents.run(Samples.on(x))
    assert not ends.converged[1] and np.isnan(ends.samples.x[1]).all()
    assert np.isfinite(ends.samples.x[[0, 2]]).all()


def test_a_large_vertex_keeps_its_limit_of_time():
    model = Model(vertex(300, 1))
    some = next(iter(Rounds(model, 0, EFFORTS["quick"])))
    late = Descents(model, until=time.monotonic() + 0.1)
    begin = time.process_time()
    ends = late.run(joined(*[some] * 40))
    assert time.process_time() - begin < 5 and not ends.converged.all()


ASK = """
import json
from origami_nlp import find_minima
from tests.minima.test_compiled_descents import vertex
r = find_minima(vertex(5, 5), prove=False, effort="quick")
print(json.dumps([r.search.solves, [m.fold_angles for m in r.minima], r.minima[0].escape.why]))
"""


@pytest.mark.slow  # a second look at what other tests of the room say
def test_without_a_compiler_ipopt_searches(tmp_path):
    changed = {"CC": "/bin/false", "XDG_CACHE_HOME": str(tmp_path)}
    asked = subprocess.run(
        [sys.executable, "-c", ASK], env=os.environ | changed, capture_output=True, text=True
    )
    assert not asked.returncode, asked.stderr
    solves, minima, why = json.loads(asked.stdout)
    here = find_minima(vertex(5, 5), prove=False, effort="quick", escape=False).minima
    # whatever one solve each finds of them is among those that batches find
    assert solves > 10 and minima and "compiler" in why
    listed = np.array([m.fold_angles for m in here])
    assert max(np.abs(listed - x).max(axis=1).min() for x in np.array(minima)) < 1e-6


def test_it_is_compiled_once_and_told(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    lines = []
    descend = compiled(lines.append)
    assert isinstance(descend, ctypes._CFuncPtr) and len(lines) == 1
    assert compiled(lines.append) is descend and len(lines) == 1
    # the library and its checksum
    assert len(list((tmp_path / "origami_nlp").iterdir())) == 2
