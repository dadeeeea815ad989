"""Descents that end at a minimum known before, by the straight way down where there is one."""

from collections import Counter

import numpy as np
import pytest

from origami_nlp.numerics import SWITCH
from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import MOST_KEPT, PatternProblem, find_labels
from origami_nlp.pattern_states import contact_descent
from origami_nlp.starts import Grown


@pytest.fixture(scope="module")
def descents():
    """Starts of yoshimura:2x3 in which nothing crosses, and where descents that know of no minimum end."""
    problem = PatternProblem(as_pattern("yoshimura:2x3"))
    drawn = Grown(problem, find_labels(problem.pattern)).draw(np.random.default_rng(1), 7).x
    starts = [x for x in drawn if np.abs(x).max() > 0.1 and not problem.refuses(x)]
    ends = [contact_descent(problem, x) for x in starts]
    return problem, [(x, e) for x, e in zip(starts, ends, strict=True) if e.arrived]


def test_the_same_minima_in_fewer_steps(descents):
    problem, found = descents
    minima = np.array([end.phi for _, end in found])
    assert len(found) >= 3
    fewer = 0
    for start, end in found:
        again = contact_descent(problem, start, known=minima)
        assert again.arrived and np.abs(again.phi - end.phi).max() < 1e-6
        energies = [problem.scaled_energy(x) for x in again.path]
        assert all(np.diff(energies) < 1e-12) and not any(map(problem.refuses, again.path))
        fewer += again.steps < end.steps
    assert fewer >= len(found) / 2


def test_without_a_compiler_the_same_ends(descents, monkeypatch):
    problem, found = descents
    monkeypatch.setenv(SWITCH, "0")
    plain = PatternProblem(problem.pattern)
    for start, end in found[:2]:
        again = contact_descent(plain, start)
        assert again.arrived and np.abs(again.phi - end.phi).max() < 1e-9
    assert not plain.closure.compiled.usable


def test_no_way_leads_to_what_is_no_minimum_below(descents):
    """States near the start that are higher, or across facets, do not end a descent."""
    problem, found = descents
    for start, end in found:
        higher = problem.project(start + 0.1 * (start - end.phi))[0]
        assert problem.scaled_energy(higher) > problem.scaled_energy(start)
        again = contact_descent(problem, start, known=higher[None])
        assert np.abs(again.phi - end.phi).max() < 1e-6


def test_what_was_computed_of_the_last_states_is_kept():
    problem, asked = PatternProblem(as_pattern("miura:2x2")), Counter()
    states = [np.full(problem.size, float(k)) for k in range(MOST_KEPT + 1)]

    def ask(k):
        def make():
            asked[k] += 1
            return k

        assert problem.kept("test", states[k], make) == k

    for k in (0, 1, 0, 2, 0):
        ask(k)
    assert asked == Counter({0: 1, 1: 1, 2: 1})
    ask(MOST_KEPT)  # state 1 was asked for longest ago
    ask(0)
    assert asked[0] == 1
    ask(1)
    assert asked[1] == 2
