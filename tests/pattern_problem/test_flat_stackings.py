"""Flat foldings of one vertex: which are admissible, by the package and by trying every stacking."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest

from origami_nlp import Scene, Vertex
from origami_nlp.pattern_problem import PatternProblem, pose
from tests.independent.flat_stackings import assignments

VERTICES = {
    "Miura": (Fraction(1, 3), Fraction(1, 3), Fraction(2, 3), Fraction(2, 3)),
    "six equal": (Fraction(1, 3),) * 6,
    "six, alpha_1 = pi/4": tuple(Fraction(k, 4) for k in (1, 2, 1, 1, 2, 1)),
    "eight equal": (Fraction(1, 4),) * 8,
}
COUNTS = {"Miura": 6, "six equal": 30, "six, alpha_1 = pi/4": 18, "eight equal": 112}


def scene(sectors, seed: int) -> Scene:
    rng = np.random.default_rng(seed)
    n = len(sectors)
    vertex = Vertex(tuple(float(a) * math.pi for a in sectors))
    return Scene(vertex, 10 ** rng.uniform(-0.5, 0.5, n), rng.uniform(-3, 3, n), "none", "full")


def flat_states(model: PatternProblem) -> list[np.ndarray]:
    return [math.pi * np.array(s) for s in itertools.product((1.0, -1.0), repeat=model.size)]


def admissible(model: PatternProblem) -> set[tuple[int, ...]]:
    good = (x for x in flat_states(model) if not model.refuses(x))
    return {tuple(np.sign(x).astype(int).tolist()) for x in good}


@pytest.mark.parametrize("name", VERTICES)
def test_admissible_flat_foldings_are_those_that_some_stacking_has(name: str) -> None:
    expected = assignments(VERTICES[name])
    assert len(expected) == COUNTS[name]
    assert admissible(pose(scene(VERTICES[name], 0))) == expected


@pytest.mark.parametrize("seed", range(12))
def test_so_they_are_for_random_vertices_that_fold_flat(seed: int) -> None:
    """Few different sectors, so that creases meet in one place and facets reach across each other."""
    rng = np.random.default_rng(seed)
    half = int(rng.integers(2, 4))
    whole = 6

    def parts() -> list[int]:
        cuts = np.sort(rng.choice(np.arange(1, whole), half - 1, replace=False))
        return np.diff([0, *cuts, whole]).tolist()

    sectors = [Fraction(a, whole) for pair in zip(parts(), parts(), strict=True) for a in pair]
    assert admissible(pose(scene(sectors, seed))) == assignments(sectors)
