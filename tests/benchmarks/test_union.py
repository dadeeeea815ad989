"""Foreign searches, unions and what is said about coverage: small numbers that are counted a second way."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from benchmarks import (
    FAMILIES,
    Judge,
    coverage_markdown,
    draw_coverage,
    family_scene,
    foreign_methods,
    judging,
    measure_coverage,
    read_union,
    run_foreign,
    scenes_for,
    union,
)
from benchmarks.__main__ import app
from benchmarks.checkout import HERE, Checkout
from benchmarks.coverage import BEFORE, NOW, SCENES, Covered, Searched, judge
from benchmarks.coverage_table import (
    faster,
    per_correct,
    scenes_of,
    share_at,
    shares,
    sooner,
)
from benchmarks.foreign import Ends, vertex_starts
from benchmarks.union import FOUND, Member, Union, build_union, from_foreign, ours, verified
from origami_nlp import OrigamiError, find_minima
from origami_nlp.errors import OptionError
from origami_nlp.problem import Model
from tests.independent.rotations import fold

SCENE = family_scene("fold-limits", 0)
MODEL = Model(SCENE)
METHODS = {m.name: m for m in foreign_methods()}


@pytest.fixture(scope="module")
def known():
    minima, _ = ours(SCENE, 0)
    out = Union(SCENE)
    out.add("main job", minima, 1.0)
    return out


UNHURRIED = "trust-constr", "basin hopping"
"""Need seconds for a first claim; SLSQP and IPOPT go through the same protocol."""


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.slow] if n in UNHURRIED else []) for n in METHODS],
)
def test_foreign_searches_end_in_time_and_claim_closed_states(name, known):
    chains = name == "basin hopping"  # whose chains can stay on the wrong sheet
    for given in (0.3, 2.0, 8.0):  # seconds: a slow machine needs more for the first claim
        ends = run_foreign(METHODS[name], MODEL, 0, given)
        assert (np.diff(ends.seconds) > 0).all()
        assert (ends.seconds[:-1] < given).all() and given <= ends.seconds[-1]
        assert len(ends.seconds) == len(ends.claims) == len(ends.x)
        near = known.nearest(ends.x[ends.claims])[1] if ends.claims.any() else np.zeros(0)
        if (near <= FOUND).any():
            break
    assert chains or (near <= FOUND).any(), "no attempt came to a minimum"
    if not ends.claims.any():
        return
    product = fold(np.array(SCENE.vertex.sector_angles), ends.x[ends.claims])[1]
    assert np.abs(product - np.eye(3)).max() < 1e-4
    assert np.abs(ends.x[ends.claims]).max() <= math.pi


def test_the_same_seed_starts_alike_and_others_do_not():
    a, b, c = (run_foreign(METHODS["SLSQP"], MODEL, seed, 0.05).x[:5] for seed in (3, 3, 4))
    count = min(len(a), len(b))
    assert np.array_equal(a[:count], b[:count], equal_nan=True)
    assert not np.array_equal(a[: len(c)], c[: len(a)], equal_nan=True)


def test_vertices_are_closed_with_all_but_three_creases_shut():
    model = Model(family_scene("fold-limits", 1))
    x = vertex_starts(model, 200)
    product = fold(np.array(model.scene.vertex.sector_angles), x)[1]
    assert len(x) >= 15 and np.abs(product - np.eye(3)).max() < 1e-10
    assert ((np.abs(x) == math.pi).sum(axis=1) >= model.size - 3).all()
    assert np.abs(x[:, None] - x).max(axis=2)[~np.eye(len(x), dtype=bool)].min() > 1e-7


def test_only_minima_are_verified(known):
    for m in known.members:
        near = np.array(m.fold_angles) + 1e-6
        state, kind, _ = verified(MODEL, np.clip(near, -math.pi, math.pi))
        assert kind == m.kind and np.abs(state.x - m.fold_angles).max() < 1e-9
    flat = np.zeros(4)
    assert verified(MODEL, flat)[1] == ""


def test_a_union_goes_on_where_it_stopped(tmp_path):
    runs = []

    def task(name, minima):
        def run():
            runs.append(name)
            if minima is None:
                raise KeyboardInterrupt
            return minima, 0.5

        return name, run

    one = Member((0.1, 0.2, 0.3, 0.4), 2.0, "interior", [])
    same = replace(one, fold_angles=(0.1, 0.2, 0.3, 0.4 + 1e-6))
    two = replace(one, fold_angles=(0.1, 0.2, 0.3, 0.41), energy=1.0)
    with pytest.raises(KeyboardInterrupt):
        build_union(SCENE, tmp_path, [task("a", [one]), task("b", None), task("c", [two])])
    build_union(SCENE, tmp_path, [task("a", [one]), task("b", [same]), task("c", [two, one])])
    assert runs == ["a", "b", "b", "c"]
    (path,) = tmp_path.glob("*.json")
    read = read_union(path)
    assert read.scene == SCENE
    assert [(m.energy, m.found_by) for m in read.members] == [(1.0, ["c"]), (2.0, ["a", "b", "c"])]
    assert [(t.name, t.found, t.new) for t in read.tasks] == [("a", 1, 1), ("b", 1, 0), ("c", 2, 1)]
    other = replace(SCENE, stiffness=(1.0, 2.0, 3.0, 4.0))
    assert not union.read_or_begin(other, tmp_path).members, "another scene of the same name"
    path.write_text('{"schema": "something"}')
    with pytest.raises(OptionError, match="is not a union"):
        read_union(path)


def test_foreign_and_own_searches_find_the_same_minima(known):
    found, _ = from_foreign(MODEL, METHODS["SLSQP"], 0, 0.4)
    listed = find_minima(SCENE, escape=False).minima
    assert len(found) == len(listed) == len(known.members)
    for m in found:
        assert min(np.abs(np.subtract(m.fold_angles, k.fold_angles)).max() for k in listed) < 1e-8


def test_answers_are_counted_for_what_they_are(known):
    """One right to 1e-10, one right to 1e-4, one that is no minimum, one that does not converge, one elsewhere."""
    truth = np.array(known.members[0].fold_angles)
    moved = truth + np.where(np.abs(truth) < 3, 1e-4, 0)
    x = np.array([moved, np.zeros(4), truth, np.full(4, np.nan), np.zeros(4)])
    claims = np.array([True, True, True, False, True])
    ends = Ends("SLSQP", SCENE.name, 1, 0.0, np.arange(1.0, 6.0), claims, x)
    other = Ends("IPOPT", SCENE.name, 1, 0.0, np.arange(1.0, 2.0), np.array([False]), x[:1])
    runs = judge("fold-limits", SCENE, Union(SCENE, list(known.members)), {}, [ends, other]).runs
    (r,) = runs["SLSQP"]
    assert (r.attempts, r.rejected, r.false, r.exact, r.exact_seconds) == (5, 1, 1, 1, 3.0)
    assert r.found == (0,) and r.curve == ((1.0, 1),) and r.seconds == 5.0
    (r,) = runs["IPOPT"]
    assert (r.found, r.curve, r.rejected, r.exact_seconds) == ((), (), 1, math.inf)


def test_the_reference_of_the_benchmark_holds_the_union(known, monkeypatch):
    """A main job that lists only its first minimum: the judge knows the others from the union, once each."""
    job = find_minima(SCENE, escape=False)
    short = replace(job, minima=job.minima[:1])
    monkeypatch.setattr(judging, "find_minima", lambda scene, **options: short)
    assert len(job.minima) > 1 and len(Judge.of(SCENE, 0).known) == 1
    all_known = Judge.of(SCENE, 0, known).known
    assert len(all_known) == len(job.minima)
    assert [k.source for k in all_known[1:]] == ["main job"] * (len(job.minima) - 1)  # the union's
    for m in job.minima:
        assert min(np.abs(k.x - m.fold_angles).max() for k in all_known) < 1e-10


def run(seconds, found, curve=None, **more):
    curve = curve or ((seconds, len(found)),)
    return Searched(0, seconds, found, curve, **more)


def test_numbers_of_the_tables():
    one = Covered("f", "f 1", 4, 4)
    one.runs[NOW] = [run(1.0, (0, 1), ((0.2, 1), (0.8, 2))), run(1.0, (0, 1, 2))]
    one.runs[BEFORE] = [run(4.0, (0,)), run(2.0, (0,))]
    one.runs["SLSQP"] = [run(5.0, (0, 1), ((1.0, 1), (3.0, 2)), exact=1, exact_seconds=3.0)]
    two = Covered("f", "f 2", 5, 6)
    two.runs[NOW] = [run(2.0, (0, 1, 2, 3)), run(2.0, (0, 1, 2, 3, 4))]
    two.runs[BEFORE] = [run(2.0, (5,)), run(2.0, (5,))]
    two.runs["SLSQP"] = [run(5.0, tuple(range(6)), tuple((1.0 + k, k + 1) for k in range(6)))]
    scenes = [one, two]
    assert shares(scenes, NOW) == (0.6, 0.7, 0.8)  # of 10: 6 and 8; together 3 + 5
    assert shares(scenes, BEFORE) == (0.2, 0.2, 0.2)
    assert (faster(scenes).low, faster(scenes).high) == (1.0, 3.0)
    assert share_at(scenes, NOW, 0.5) == pytest.approx(0.5 / 10)
    assert share_at(scenes, NOW, 2.0) == pytest.approx((2.5 + 4.5) / 10)
    assert sooner([one]).low == pytest.approx(3.0 / 1.0)
    assert sooner([one]).high == pytest.approx(3.0 / 0.8)
    assert sooner([two]).median == 0, "never as many"
    assert per_correct([one]).median == pytest.approx(3.0 / (2.0 / 5))
    assert per_correct([two]).median == math.inf


@pytest.mark.slow
def test_a_measurement_as_a_whole(tmp_path, monkeypatch):
    monkeypatch.setattr(union, "UNION_SEEDS", 1)
    monkeypatch.setattr(union, "SECONDS", {4: 0.1})
    said = []
    scenes = {"fold-limits": [0]}
    data = measure_coverage(
        scenes, tmp_path, before=HERE, seeds=1, budget=0.2, progress=said.append
    )
    assert len(list(tmp_path.glob("*.json"))) == 1 and said
    (covered,) = scenes_of(json.loads(json.dumps(data, allow_nan=False)))["fold-limits"]
    assert {NOW, BEFORE, "SLSQP", "SLSQP, given starts", "IPOPT"} <= set(covered.runs)
    now, before = covered.runs[NOW][0], covered.runs[BEFORE][0]
    assert now.found == before.found, "the same checkout twice"
    assert now.curve[-1] == (now.seconds, len(now.found)) and now.other_kind == 0
    text = coverage_markdown(data)
    assert "| fold-limits | SLSQP, given starts |" in text and "0 (certified)" in text
    draw_coverage(data, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_a_checkout_must_be_one_and_its_end_is_told(tmp_path):
    with pytest.raises(OptionError, match="no checkout"):
        Checkout(tmp_path)
    with Checkout() as worker:
        worker._process.kill()
        worker._process.wait()
        with pytest.raises(RuntimeError, match="ended with code"):
            worker.search(SCENE, 0)


def test_the_command_and_its_refusals(tmp_path, monkeypatch):
    assert set(SCENES) == set(FAMILIES)
    assert scenes_for([], quick=True) == dict.fromkeys(SCENES, range(2))
    with pytest.raises(OptionError, match="family"):
        scenes_for(["nothing"])
    done = CliRunner().invoke(app, ["search", "--family", "nothing"])
    assert isinstance(done.exception, OrigamiError)
