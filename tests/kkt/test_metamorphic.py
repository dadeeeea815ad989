"""One verdict, however a vertex is written down: as a scene, as a sheet otherwise numbered, turned, mirrored or scaled.

States of the oracle, 60 of them, at least 20 flat-folded, degenerate, or such that closure loses rank.
"""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from origami_nlp.kkt import State, classify
from origami_nlp.pattern import pattern_from_dict, pattern_to_dict, scene_from_dict
from origami_nlp.pattern_problem import PatternProblem, orbits_of, pose
from tests.oracle.engine import resolved, stated_by_name
from tests.relabelled import relabelled

DATA = Path(__file__).parents[1] / "oracle" / "data" / "cff19e43"
MANY, SINGULAR = 60, 20
LOWER = ("saddle", "not stationary")


@cache
def states():
    """Problems of vertices with a state of each and its verdict: (scene, problem, variables, verdict, singular)."""
    table, found = stated_by_name(DATA), {True: [], False: []}
    records = [
        r for g in ("states", "refused") for r in json.loads((DATA / f"{g}.json").read_text())
    ]
    for r in np.random.default_rng(0).permutation(np.array(records, dtype=object)):
        stated = resolved(r["q"], table)["stated"]
        if len(found[True]) >= SINGULAR and len(found[False]) >= MANY - SINGULAR:
            break
        if "scene" not in stated:
            continue
        scene = scene_from_dict(stated["scene"])
        if scene.degree > 12 or scene.loads or scene.laws:
            continue
        problem = pose(scene)
        state = State(problem, problem.reduce(np.array(r["q"]["angles"])))
        if state.residual > 1e-12:
            continue
        what = classify(state)
        flat = np.isin(np.abs(state.fold_angles), (0.0, np.pi)).all()
        singular = bool(flat or not state.regular or what.kind == "degenerate")
        found[singular].append((scene, problem, state.x, what))
    singular = found[True][: MANY // 2]
    return [*found[False][: MANY - len(singular)], *singular], len(singular)


def rewritten(scene, problem, seed):
    """The same problem of a sheet otherwise put down, and how its fold angles follow from those of the first."""
    paper = problem.pattern
    mirror, size = bool(seed % 2), (1.0, 1e3, 1e-3)[seed % 3]
    copy, creases, _ = relabelled(paper, seed, mirror)
    copy = replace(copy, corners=size * copy.corners)
    orbits = None
    if problem.orbits is not None:
        # corners are numbered by the random numbers that `relabelled` begins with
        to = np.random.default_rng(seed).permutation(len(paper.corners))
        each = [(np.arange(len(to)), 1), *((i.corners, i.sign) for i in problem.orbits.images)]
        moved = [(to[np.asarray(c)][np.argsort(to)], s) for c, s in each]
        orbits = orbits_of(copy, moved)
    return PatternProblem(copy, scene.contact == "full", orbits, problem.has_limits), creases


def agree(one, other):
    return one == other or {one, other} <= set(LOWER)


def test_there_are_enough_of_them():
    found, singular = states()
    assert len(found) == MANY and singular >= SINGULAR


@pytest.mark.parametrize("seed", range(4))
def test_verdicts_do_not_hang_on_how_it_is_written_down(seed):
    for scene, problem, x, what in states()[0][seed::4]:
        other, creases = rewritten(scene, problem, seed)
        again = classify(State(other, other.reduce(problem.expand(x)[creases])))
        assert agree(again.verdict, what.verdict), (scene, x, what, again)
        if what.verdict == "minimum":
            assert again.eigenvalues == pytest.approx(what.eigenvalues, rel=1e-7, abs=1e-9)


def test_a_sheet_that_is_read_back_is_the_same():
    for scene, problem, x, what in states()[0][::4]:
        if problem.orbits is not None:
            continue
        read = pattern_from_dict(pattern_to_dict(problem.pattern))
        other = PatternProblem(read, scene.contact == "full", None, problem.has_limits)
        assert agree(classify(State(other, x)).verdict, what.verdict)


def test_a_minimum_without_the_symmetry_is_one_with_it():
    """What is lower with the symmetry is lower without; a symmetric minimum may fall where the symmetry breaks."""
    fell = 0
    for scene, problem, x, what in states()[0]:
        if problem.orbits is None:
            continue
        whole = pose(replace(scene, symmetry="none", mirror=None, winding=None))
        free = classify(State(whole, problem.expand(x)))
        assert free.verdict != "minimum" or what.verdict in ("minimum", "undecided")
        assert (free.verdict == "not admissible") == (what.verdict == "not admissible")
        fell += what.verdict == "minimum" and free.verdict in LOWER
    assert fell > 0
