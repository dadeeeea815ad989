"""Ends of descents at which facets crowd."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import find_states
from origami_nlp.pattern_states.judgement import judge, judge_end


def test_a_state_beside_a_flat_folding_whose_contacts_are_not_known_is_not_decided():
    """Three creases all but fully folded: contacts are incomplete there, and none has a row to choose by."""
    phi = np.zeros(13)
    phi[[0, 9]] = -0.5 * math.pi
    phi[[2, 5, 7]] = math.pi
    # what a descent ended at: 1e-7 beside, not to be rounded
    off = [0, 155271, -321250, 367372, -161516, -495536, -184712, -197834, -255895]
    phi += 1e-12 * np.array([*off, 0, 333395, -266748, 12832], float)
    problem = PatternProblem(as_pattern("yoshimura:2x3"))
    state = judge(problem, problem.project(phi)[0])
    assert state.verdict in ("undecided", "not admissible") and state.certificate


def test_where_the_time_was_over_before_a_state_was_found_it_is_said():
    """Nothing says that there is no stable state."""
    found = find_states("waterbomb:8x8", seconds=0.0, escape=False)
    assert not found.minima and found.search.left_out and not found.search.stopped


def test_an_end_beside_a_flat_folded_minimum_gives_way_to_it():
    """Within rounding of closure, creases that all but lie flat or on each other: a descent ends there or not."""
    problem = PatternProblem(as_pattern("yoshimura:2x2"))
    exact = np.array([-0.5, 0, 1, 0, 1, 0, -0.5, 0]) * np.pi
    off = exact + 2.3e-10 * np.array([0, 1, -1.41421, 1, -1.41421, -1, 0, -1])
    assert judge(problem, exact).verdict == "minimum"
    assert judge(problem, off).verdict == "undecided"
    end = judge_end(problem, off)
    assert end.verdict == "minimum" and np.abs(end.phi - exact).max() <= CLOSURE_TOL
