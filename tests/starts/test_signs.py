"""Starts by the signs of vertices: beside the flat state, closed, nothing crosses; minima of every combination."""

import itertools

import numpy as np
import pytest

from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem, PopSigns, find_labels
from origami_nlp.pattern_states import find_states
from origami_nlp.starts import Signed
from tests.relabelled import relabelled


def starts(pattern, minima=None):
    """Those of a pattern."""
    minima = np.zeros((0, pattern.creases)) if minima is None else minima
    return list(Signed(PatternProblem(pattern), find_labels(pattern), minima).states())


@pytest.mark.parametrize(("name", "many"), [("yoshimura:3x3", 16), ("resch:1x2", 8)])
def test_each_combination_once(name, many):
    pattern = as_pattern(name)
    problem, signs, found = PatternProblem(pattern), PopSigns(pattern), starts(pattern)
    assert len(found) == many
    assert {signs.of(x) for x in found} == set(
        map("".join, itertools.product("+-", repeat=len(signs.vertices)))
    )
    for x in found:
        assert problem.residual(x) < 1e-12 and not problem.crossings.find(x)
        assert problem.closure.lifts_to_one(x) and np.abs(x).max() < 0.5
    assert len(starts(pattern, np.array(found[1:]))) == 1
    assert not starts(pattern, np.array(found))


def test_minima_of_every_combination():
    """Without a random start; they are what a search with them leaves out, and what labels do not change."""
    pattern = as_pattern("yoshimura:2x3")
    found = find_states(pattern, starts=0, escape=False)
    assert set(found.signs) == {"++", "+-", "-+", "--"}
    assert found.search.by_source[Signed.name] and found.search.reached[Signed.name]
    assert any(Signed.name in w for w in found.search.words())
    other, *_ = relabelled(pattern, 3)
    again = find_states(other, starts=0, escape=False)
    assert [m.energy for m in again.minima] == pytest.approx([m.energy for m in found.minima])


def test_what_was_enumerated_is_not_started_from():
    search = find_states("squaretwist", starts=2, escape=False).search
    assert Signed.name not in search.by_source and len(search.sign_vectors) == 16


@pytest.mark.slow
def test_a_state_that_only_pops_had_found_is_in_the_default_list():
    """By its energy; random starts of six seeds had missed it before vertices were popped."""
    found = find_states("yoshimura:3x3", escape=False, seconds=1800)
    assert min(abs(m.energy - 0.441604) for m in found.minima) < 1e-5
