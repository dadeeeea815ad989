"""A list of minima is held against a proof: what is missing comes back by name, what is wrong is an alarm."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp import MinimaResult, Scene, Vertex, examples, find_minima
from origami_nlp.errors import OptionError
from origami_nlp.pattern_states import find, judge
from origami_nlp.pattern_states.parts import Places
from origami_nlp.proof import ReducedVertex, prove, read_certificate
from tests.command_line import run, scene_file
from tests.computed_once import thinned

pi = math.pi


def generic(seed, degree, contact="fold-limits"):
    """Random sectors, stiffness over two decades, random rest angles."""
    rng = np.random.default_rng([seed, degree, 15])
    while True:
        sectors = rng.dirichlet(np.full(degree, 6.0)) * 2 * pi
        if sectors.max() < 0.9 * pi:
            break
    stiffness = 10 ** rng.uniform(-1, 1, degree)
    rest = rng.uniform(-pi, pi, degree)
    return Scene(Vertex(tuple(sectors.tolist())), stiffness, rest, "none", contact)


def forget(monkeypatch, chosen):
    """Let the search forget the minima that `chosen(minima)` names, before the proof."""
    true = find._Answer.prove
    forgotten = []

    def forgetful(search, wanted):
        gone = chosen([s for s in search.judged if s.verdict == "minimum"])
        forgotten.extend(s.phi for s in gone)
        # as if it had not been found
        search.judged = [s for s in search.judged if not any(s is g for g in gone)]
        search._places = Places(search.problem.size)
        true(search, wanted)

    monkeypatch.setattr(find._Answer, "prove", forgetful)
    return forgotten


def states(result):
    return np.array([m.fold_angles for m in result.minima])


def check_comes_back(monkeypatch, scene, k):
    whole = find_minima(scene, prove=True, escape=False)
    assert whole.completeness.proved
    with monkeypatch.context() as patch:
        gone = forget(patch, lambda minima: [minima[k % len(minima)]])
        result = find_minima(scene, prove=True, escape=False)
    assert np.abs(states(result) - states(whole)).max() <= 1e-9
    assert result.completeness.status == "proved"
    back = np.array([new.fold_angles for new in result.completeness.added])
    assert np.abs(back - gone[0]).max(axis=1).min() <= 1e-9
    assert len(back) == 1 + len(whole.completeness.added)
    assert result.flags.proof_added_minima


@pytest.mark.parametrize("degree", thinned([4, 5], 2))
def test_a_minimum_that_the_search_forgets_comes_back_by_name(monkeypatch, degree):
    check_comes_back(monkeypatch, generic(1, degree), 0)


def test_a_search_that_is_short_of_the_proof_shows_the_alarm():
    """One start finds one of four minima; the proof adds the others, and says so."""
    scene = generic(3, 5)
    searched, whole = (
        find_minima(scene, prove=prove, escape=False, max_starts=1) for prove in (False, True)
    )
    missed = [one.fold_angles for one in whole.completeness.added]
    assert missed and len(whole.minima) == len(searched.minima) + len(missed)
    assert np.abs(states(searched)[:, None] - np.array(missed)).max(axis=2).min() > 1e-3
    assert all(phi in [m.fold_angles for m in whole.minima] for phi in missed)
    assert whole.flags.proof_added_minima


def test_a_listed_state_that_is_no_minimum_is_an_alarm(monkeypatch):
    """A saddle that a broken judge calls a minimum: the proof refutes it, and says so."""
    scene = generic(3, 5)
    true, points = find.prove_list, prove(ReducedVertex(scene)).points

    def prove_wrong(provable, problem, states, wanted):
        saddle = next(p for p in points if p.index and 1 not in p.pinned_signs)
        state = judge(problem, saddle.fold_angles)
        assert state.verdict == "saddle"
        states.append(replace(state, verdict="minimum", kind="interior"))
        return true(provable, problem, states, wanted)

    with monkeypatch.context() as patch:
        patch.setattr(find, "prove_list", prove_wrong)
        result = find_minima(scene, prove=True, escape=False)
    assert result.completeness.status == "not-proved"
    assert "the proof refutes a listed minimum" in result.completeness.reason


def test_json_carries_it():
    scene = generic(1, 4)
    result = find_minima(scene, escape=False)
    data = json.loads(json.dumps(result.to_dict()))
    c = data["completeness"]
    assert c["status"] == "proved" and c["critical_points"]["0"] == len(result.minima)
    assert MinimaResult.from_dict(data).completeness == result.completeness


def test_where_it_is_not_asked_for_and_dear_it_is_not_tried():
    assert find_minima(generic(1, 4), prove=False, escape=False).completeness is None
    assert find_minima(generic(1, 6), max_starts=16, escape=False).completeness is None
    assert find_minima(generic(1, 4, "none"), max_starts=16, escape=False).completeness is None


@pytest.mark.parametrize(
    ("scene", "why"),
    [
        (generic(1, 8), "5 degrees of freedom (at most 4)"),
        (generic(1, 4, "none"), "without fold limits"),
    ],
)
def test_what_cannot_be_proved_is_refused_with_the_reason(scene, why):
    result = find_minima(scene, max_starts=16, prove=True, escape=False)
    assert result.completeness.status == "not-proved" and why in result.completeness.reason
    assert "list proved complete" not in result.report(verbose=True)


def test_when_time_is_up_nothing_is_claimed():
    result = find_minima(generic(1, 6), max_starts=16, prove=0.2, escape=False)
    c = result.completeness
    assert c.status == "not-proved" and "time was up" in c.reason and c.boxes > 0 and c.undecided
    assert "list proved complete" not in result.report(verbose=True)


def test_the_command_proves_and_writes_it(tmp_path):
    scene, out = scene_file(tmp_path, generic(1, 4)), tmp_path / "proof.json"
    code, table, _ = run("minima", scene, "--verbose", "--prove", "--certificate", out)
    assert code == 0
    assert len(read_certificate(out).minima) == 2
    code, table, _ = run("minima", "--prove", scene)
    assert code == 0 and "list proved complete" in table
    code, table, _ = run("minima", scene, "--verbose", "--no-prove")
    assert code == 0 and "list proved complete" not in table
    for wrong in (("--no-prove", "--certificate", tmp_path / "b.json"),):
        code, _, err = run("minima", scene, "--verbose", *wrong)
        assert code == 2 and "prove" in err
        assert not (tmp_path / "b.json").exists()


@pytest.mark.parametrize("value", [-1, "yes", math.nan])
def test_prove_is_a_flag_or_seconds(value):
    with pytest.raises(OptionError, match="prove = "):
        find_minima(generic(1, 4), prove=value, escape=False)


@pytest.mark.parametrize("scene", thinned(examples.panels(), 9))
def test_panels_within_fold_limits(scene):
    result = find_minima(replace(scene, contact="fold-limits"), escape=False)
    c = result.completeness
    assert c.status in ("proved", "proved-except-singular")
    assert not c.added
