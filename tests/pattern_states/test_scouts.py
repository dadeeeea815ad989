"""Scouts end beside the states that descents end at: closed, without crossings, on other code; nothing without C."""

import os
import subprocess
import sys

import numpy as np
import pytest

from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem, Scouts, find_labels
from origami_nlp.pattern_states.closed import close
from origami_nlp.pattern_states.contact_descents import contact_descent
from origami_nlp.starts import families_in_turn

BIAS = 0.005
"""Barriers keep ends off minima in contact by less [rad]."""


def starts(name, many, seed=0):
    pattern = as_pattern(name)
    labels = find_labels(pattern)
    problem = PatternProblem(labels.arranged(pattern))
    rng, families = np.random.default_rng(seed), families_in_turn(problem, labels)
    drawn = (families[k % 3].draw(rng, 1).x[0] for k in range(1_000))
    closed = (phi for start in drawn if (phi := close(problem, start)) is not None)
    good = (phi for phi in closed if np.abs(phi).max() > 0.1)
    return problem, [next(good) for _ in range(many)]


@pytest.mark.parametrize("name", ["yoshimura:3x3", "waterbomb:2x2", "waterbomb:1x2"])
def test_scouts_end_beside_states_that_descents_end_at(name):
    problem, found = starts(name, 150)
    scouts, beside = Scouts(problem), []
    if not scouts.usable:
        pytest.skip("no compiler")
    for start in found:
        free = scouts.descend(start, False)
        if free is None or not free[2] or problem.crossings.find(free[1]):
            continue
        held = scouts.descend(free[1], True)
        if held is None or problem.refuses(held[0]):
            continue
        end = held[0]
        assert problem.crossings.poses.apart(end) < 1e-10  # of facets in space
        assert problem.fold_limits.inside(end).all() and not problem.crossings.find(end)
        assert problem.scaled_energy(end) < problem.scaled_energy(free[1]) + 0.01
        exact = contact_descent(problem, end, True)
        beside.append(exact.arrived and np.abs(exact.phi - end).max() < BIAS)
        if len(beside) == 4:
            break
    assert len(beside) == 4 and np.mean(beside) >= 0.75


def test_ends_of_one_minimum_agree():
    problem, found = starts("yoshimura:2x3", 60)
    scouts = Scouts(problem)
    if not scouts.usable:
        pytest.skip("no compiler")
    free = [scouts.descend(start, False) for start in found]
    ends = np.array([x[0] for x in free if x is not None])
    far = np.abs(ends[:, None] - ends).max(axis=2)
    assert len(ends) > 40 and (far < 1e-5).sum() > 3 * len(ends)
    assert not ((far > 1e-4) & (far < 3e-3)).any()


def test_without_a_compiler_nothing_is_foreseen(monkeypatch):
    monkeypatch.setenv("ORIGAMI_NLP_COMPILED", "0")
    problem = PatternProblem(as_pattern("yoshimura:2x2"))
    assert not Scouts(problem).usable


@pytest.mark.slow
@pytest.mark.parametrize("name", ["yoshimura:3x3", "waterbomb:2x2"])
def test_two_kernels_of_linear_algebra_list_the_same(name):
    ask = (
        "import sys; from origami_nlp.pattern_states import find_states; "
        "print(*(f'{m.energy:.9f}' for m in find_states(sys.argv[1], escape=False).minima))"
    )
    listed = [
        subprocess.run(
            [sys.executable, "-c", ask, name],
            env=os.environ | {"OPENBLAS_CORETYPE": kernel, "OPENBLAS_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()
        for kernel in ("Prescott", "Haswell")
    ]
    assert listed[0] == listed[1] and len(listed[0]) > 50
