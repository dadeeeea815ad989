"""Linear algebra that breaks down at one item of a search: the item is counted and named, and the search goes on."""

import importlib

import numpy as np

from origami_nlp import examples, find_minima
from origami_nlp.pattern_states import search as driver

SINGULAR = np.linalg.LinAlgError("Singular matrix")
TWO_DOF = examples.degree6("pi/3")


def broken(error):
    def call(*_, **__):
        raise error

    return call


def search(**options):
    return find_minima(TWO_DOF, max_starts=64, prove=False, escape=False, **options)


def test_one_part_that_fails_ends_no_search(monkeypatch):
    """Where what it gives is found by other parts as well, the list is the same."""
    known = [m.fold_angles for m in search().minima]
    monkeypatch.setattr(driver, "list_flat_folded", broken(SINGULAR))
    found = search()
    why = "LinAlgError: Singular matrix"
    assert found.search.failed[why] > 0 and why in found.report(verbose=True)
    np.testing.assert_allclose([m.fold_angles for m in found.minima], known, atol=1e-7)


def test_a_state_that_breaks_the_judge_of_the_full_space_is_undecided_by_name(monkeypatch):
    monkeypatch.setattr(
        importlib.import_module("origami_nlp.minima.full_space"),
        "judge_in_full_space",
        broken(SINGULAR),
    )
    found = search(full=True)
    assert {m.full_space.verdict for m in found.minima} == {"undecided"}
    assert "linear algebra failed" in found.minima[0].full_space.certificate
