"""Flat foldings that springs pull open are refuted by first-order tests, before anything dear is asked."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from origami_nlp import Scene, State, Vertex, classify
from origami_nlp.kkt import classification
from origami_nlp.pattern_problem import PatternProblem, pose
from tests.computed_once import thinned

SECTORS = {
    "Miura": ("pi/3", "pi/3", "2*pi/3", "2*pi/3"),
    "six equal": ("pi/3",) * 6,
    "six, alpha_1 = pi/4": ("pi/4", "pi/2", "pi/4") * 2,
    "eight equal": ("pi/4",) * 8,
}
COUNTS = {"Miura": 6, "six equal": 30, "six, alpha_1 = pi/4": 18, "eight equal": 112}
"""Admissible assignments, as every stacking of the facets counts them (`tests/folding/test_flat_stackings.py`)."""


def scene(name: str) -> Scene:
    rng = np.random.default_rng(5)
    n = len(SECTORS[name])
    springs = 10 ** rng.uniform(-0.5, 0.5, n), rng.uniform(-3, 3, n)
    return Scene(Vertex(SECTORS[name]), *springs, "none", "full")


def flat_states(problem: PatternProblem) -> list[np.ndarray]:
    return [math.pi * np.array(s) for s in itertools.product((1.0, -1.0), repeat=problem.size)]


@pytest.mark.parametrize("name", thinned(list(COUNTS), 4))
def test_flat_foldings_that_springs_pull_open_are_refuted_before_anything_dear(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Next to no piece is judged and no linear program solved."""
    claim = scene(name)
    problem = pose(claim)
    pieces = 0
    old = classification.judge_branch

    def counted(*arguments):
        nonlocal pieces
        pieces += 1
        return old(*arguments)

    monkeypatch.setattr(classification, "judge_branch", counted)
    monkeypatch.setattr("origami_nlp.numerics.linear._programme", None)
    whats = {tuple(x): classify(State(problem, x)) for x in flat_states(problem)}
    verdicts = [w.verdict for w in whats.values()]
    assert verdicts.count("not stationary") == COUNTS[name]
    assert verdicts.count("not admissible") == len(verdicts) - COUNTS[name]
    assert pieces <= COUNTS[name] // 10
