"""Linear algebra that breaks down at one item of a search: the item is counted and named, and the search goes on."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from origami_nlp.minima.windings import join_reports

from origami_nlp import Scene, Vertex, examples, find_minima
from origami_nlp.minima import find, job, record
from origami_nlp.pattern_problem import pose
from origami_nlp.problem import Model
from tests.computed_once import thinned

FAILURES = [np.linalg.LinAlgError("Singular matrix"), ZeroDivisionError("division by zero")]
ONE_DOF = Scene(
    Vertex.from_degrees((60, 80, 120, 100)), (1, 2, 3, 4), (0.3, -1, 2, 0.5), "none", "fold-limits"
)
TWO_DOF = examples.degree6("pi/3")


def broken(error):
    def call(*_, **__):
        raise error

    return call


def angles(result):
    return [m.fold_angles for m in result.minima]


@cache
def whole(scene):
    return find_minima(scene, max_starts=64, prove=False, escape=False)


@pytest.mark.parametrize(
    ("room", "name", "reported", "scene"),
    thinned(
        [
            (job.HingeSets, "states", "hinge sets", TWO_DOF),
            (job, "trace", "curves of one degree of freedom", ONE_DOF),
            (find, "confirm", "a confirmation by IPOPT", TWO_DOF),
        ],
        3,
    ),
)
def test_one_part_that_fails_ends_no_search(monkeypatch, room, name, reported, scene):
    """Where what it gives is found by other parts as well, the list is the same."""
    known = angles(whole(scene))
    error = FAILURES[len(reported) % 2]
    monkeypatch.setattr(room, name, broken(error))
    found = find_minima(scene, max_starts=64, prove=False, escape=False)
    assert found.search.failed[
        f"{reported}: {error}"
    ] > 0 and f"{reported}: {error}" in found.report(verbose=True)
    assert (
        not found.search.complete
    )  # what traced curves hold is not said where they were not traced, or judged
    assert len(angles(found)) == len(known)
    np.testing.assert_allclose(angles(found), known, atol=1e-7)


@pytest.mark.parametrize("error", FAILURES, ids=["LinAlgError", "ZeroDivisionError"])
def test_an_image_that_cannot_be_told_of_stays_undecided(monkeypatch, error):
    model, found = Model(ONE_DOF), record.Record(pose(ONE_DOF))
    answer = record.listed(found, model, model.reduce(np.array(angles(whole(ONE_DOF))[0])))
    assert answer.is_minimum
    undecided = record.Classification("undecided", None, "left to its image", 0)
    symmetries = [(None, 1), (np.arange(model.size)[::-1], -1)]
    monkeypatch.setitem(vars(model), "own_symmetries", symmetries)
    monkeypatch.setattr(record, "judge", lambda _, image: setattr(image, "what", undecided))
    monkeypatch.setattr(record, "of_image", broken(error))
    record.close_orbit(model, found, answer)
    assert [a.what for a in found.answers] == [undecided] and answer.is_minimum
    assert found.failed == {f"an image under a symmetry of the scene: {error}": 1}


def test_a_state_that_breaks_the_judge_of_the_full_space_is_undecided_by_name(monkeypatch):
    monkeypatch.setattr(find, "judge_in_full_space", broken(FAILURES[0]))
    found = find_minima(TWO_DOF, max_starts=64, prove=False, full=True, escape=False)
    assert {m.full_space.verdict for m in found.minima} == {"undecided"}
    assert "linear algebra failed" in found.minima[0].full_space.certificate


def test_what_was_left_out_is_told_of_every_winding():
    report = whole(ONE_DOF).search
    reports = [replace(report, failed={"does not close": n}) for n in (1, 2)]
    assert join_reports((1, 3), reports).failed == {"does not close": 3}
