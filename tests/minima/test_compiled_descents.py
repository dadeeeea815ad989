"""Descents in C end where those in NumPy end, start by start; without a compiler a search answers the same."""

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
from origami_nlp.kkt import project
from origami_nlp.minima import compiled
from origami_nlp.minima.compiled_projection import project_many
from origami_nlp.minima.descents import Descents
from origami_nlp.numerics import CLOSURE_TOL, ROUNDED, SWITCH
from origami_nlp.pattern import detent, double_well, linear, one_sided, sum_of, table
from origami_nlp.problem import OPEN, Contact, Model
from origami_nlp.starts import EFFORTS, Rounds, Samples, joined

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
    for name in ("at_limit", "slots", "sides", "hold", "source", "springs"):
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


@pytest.mark.parametrize("scene, most", CASES.values(), ids=CASES)
def test_every_start_ends_as_in_numpy(scene, most):
    model = Model(scene)
    descents = Descents(model)
    starts = starts_of(model, descents, most)
    assert len(starts) > 20
    assert_same(descents.run(starts), descents.run_in_numpy(starts))


@pytest.mark.parametrize(
    "name", ["mirrored, full contact", "degree 6 with contact", "degree 6 with laws"]
)
def test_short_steps_go_the_same_way_as_in_numpy(name):
    scene, most = CASES[name]
    model = Model(scene)
    descents = Descents(model, steps=120, longest=0.1)
    starts = starts_of(model, descents, most // 2)
    in_c, in_numpy = list[np.ndarray](), list[np.ndarray]()
    ends = descents.run(starts, in_c)
    assert_same(ends, descents.run_in_numpy(starts, in_numpy))
    moved = [np.abs(np.diff(path, axis=0)).max(initial=0.0) for path in in_c]
    assert sum(len(path) > 10 for path in in_c) > 10 and 0.05 < max(moved) < 0.2
    for one, other, done in zip(in_c, in_numpy, ends.converged, strict=True):
        if done:
            assert one.shape == other.shape and np.abs(one - other).max(initial=0.0) < SAME
    assert np.abs(model.closure(np.concatenate(in_c))[0]).max() < CLOSURE_TOL


@pytest.mark.parametrize("scene", [CASES["mirrored, full contact"][0], vertex(7, 3, "full")])
def test_projections_and_what_is_admissible_are_those_of_numpy(scene):
    model = Model(scene)
    descents, rng = Descents(model), np.random.default_rng(2)
    held = (model.fold_limits.contact(1, 3.0), *[Contact("gap", 0, 1)] * bool(model.structure.gaps))
    of = np.arange(60) % 2  # states of one batch hold different contacts
    for choices, frozen in ((((), held), None), (((), ()), 0)):
        x = rng.uniform(-1.5, 1.5, (60, model.size))
        x[:3] = 0.0  # closure has no rank there
        x[1:3] += 1e-9 * rng.normal(size=(2, model.size))
        still = None if frozen is None else np.arange(model.size) == np.full((60, 1), frozen)
        y, good = project_many(descents, x, choices, of, still)
        for k, contacts in enumerate(choices):
            own = None if still is None else still[of == k]
            z, expected = project(model, x[of == k], contacts, frozen=own)
            done, z = expected <= ROUNDED, model.fold_limits.clip(z)
            closes = np.abs(model.closure(z)[0]).max(axis=1) <= CLOSURE_TOL
            assert done.sum() > 10 and good.any() and (scene.degree < 7 or not good.all())
            assert (good[of == k] == closes & model.admissible(z))[done].all()
            assert np.abs(y[of == k] - z)[done].max() < SAME


def test_several_scenes_of_one_vertex_and_threads():
    scenes = [vertex(5, 4), vertex(5, 4, decades=6.0)]
    both = [Model(s) for s in scenes]
    descents = Descents(both[0], [m.parameters for m in both], threads=2)
    samples = starts_of(both[0], descents, 400)
    samples.springs[::2] = 1
    ends = descents.run(samples)
    assert_same(ends, descents.run_in_numpy(samples))
    for number, model in enumerate(both):
        own = samples[samples.springs == number]
        own.springs[:] = 0
        alone = Descents(model).run(own)
        assert (alone.samples.x == ends.samples.x[samples.springs == number]).all()


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


SCENES = vertex(5, 5), vertex(5, 2, "full")
ASK = """
import json
from origami_nlp.minima import compiled
from tests.minima.test_compiled_descents import answers
print(json.dumps([compiled() is None, answers()]))
"""


def answers():
    found = [find_minima(s, prove=False, effort="quick", escape=False) for s in SCENES]
    return [result.to_dict() for result in found]


def test_without_a_compiler_a_search_answers_the_same():
    asked = subprocess.run(
        [sys.executable, "-c", ASK],
        env=os.environ | {SWITCH: "0"},
        capture_output=True,
        text=True,
    )
    assert not asked.returncode, asked.stderr
    none, others = json.loads(asked.stdout)
    assert none
    for here, there in zip(json.loads(json.dumps(answers())), others, strict=True):
        assert_near(here, there)


@pytest.mark.parametrize(
    "name, value",
    [("CC", "/bin/false"), ("CC", "/no/such/cc"), ("CC", "'"), ("XDG_CACHE_HOME", "/dev/null")],
)
def test_where_nothing_can_be_compiled_numpy_descends(name, value, monkeypatch):
    monkeypatch.setenv(name, value)
    model = Model(vertex(5, 4))
    descents = Descents(model)
    assert descents.compiled is None
    assert descents.run(Samples.on(np.zeros((1, 5)))).converged.all()


def assert_near(one, other, at=""):
    if isinstance(one, float) and isinstance(other, float):
        assert math.isclose(one, other, rel_tol=1e-10, abs_tol=1e-12), (at, one, other)
    elif isinstance(one, dict):
        assert one.keys() == other.keys()
        for key in one.keys() - {"seconds", "cost"}:
            assert_near(one[key], other[key], f"{at}.{key}")
    elif isinstance(one, list):
        assert len(one) == len(other), at
        for k, (a, b) in enumerate(zip(one, other, strict=True)):
            assert_near(a, b, f"{at}[{k}]")
    else:
        assert one == other, (at, one, other)


def test_it_is_compiled_once_and_told(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    lines = []
    descend = compiled(lines.append)
    assert isinstance(descend, ctypes._CFuncPtr) and len(lines) == 1
    assert compiled(lines.append) is descend and len(lines) == 1
    # the library and its checksum
    assert len(list((tmp_path / "origami_nlp").iterdir())) == 2
