"""Load margins against independent solves."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.contact.margin import distance_to_boundary, load_margin
from origami_nlp.kkt import (
    State,
    find_multipliers,
)
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.problem import Contact
from tests.computed_once import panel_result, thinned


def pinned(result: MinimaResult) -> list[np.ndarray]:
    return [
        result.model.reduce(np.array(m.fold_angles))
        for m in result.minima
        if m.kind == "contact-pinned"
    ]


def held(model: PatternProblem, x: np.ndarray) -> tuple[Contact, ...]:
    choices = State(model, x).pieces
    assert choices
    return choices[0]


def random_scene(n: int, symmetry: str, seed: int) -> o.Scene:
    """A random vertex with random springs, without symmetry or with a mirror (degree 6)."""
    rng = np.random.default_rng(seed)
    mirror = [0, 1, 2, 3, 2, 1] if symmetry == "D1" else list(range(n))
    half = rng.dirichlet(np.full(3, 4.0)) * math.pi
    sectors = rng.dirichlet(np.full(n, 4.0)) * 2 * math.pi
    if symmetry == "D1":
        sectors = np.r_[half, half[::-1]]
    rest = rng.uniform(-3.1, 3.1, n)[mirror]
    stiffness = np.exp(rng.normal(size=n))[mirror]
    return o.Scene(o.Vertex(tuple(sectors)), tuple(stiffness), tuple(rest), symmetry)


RANDOM = thinned([(4, "none", 6), (5, "none", 3), (6, "D1", 7), (6, "none", 1)], 4)
"""Degree, symmetry and seed of random scenes that have a pinned state."""


# ---------------------------------------------------------------- margins


@pytest.mark.parametrize(("n", "symmetry", "seed"), RANDOM)
def test_random_pinned_scenes_are_confirmed(n: int, symmetry: str, seed: int) -> None:
    result = o.find_minima(
        random_scene(n, symmetry, seed), max_starts=96, prove=False, escape=False
    )
    states = pinned(result)
    assert states
    margin = load_margin(State(result.model, states[0]))
    assert (margin.status, margin.ends, margin.symmetry) == ("exact", "opens", symmetry)
    # another search finds the state still in contact below, and no more above
    held = next(len(m.contacts) for m in result.minima if m.kind == "contact-pinned")
    for share in (0.99, 1.01):
        loaded = replace(result.scene, preload=tuple(share * m for m in margin.moments))
        found = o.find_minima(loaded, max_starts=96, prove=False, escape=False)
        near = [
            sum(c.multiplier > 0 for c in m.contacts) >= held
            for m in found.minima
            if np.abs(result.model.reduce(np.array(m.fold_angles)) - states[0]).max() < 0.5
        ]
        assert any(near) == (share < 1)


def test_a_touching_state_bears_nothing_and_a_handle_everything() -> None:
    result, kinds = panel_result(o.examples.degree6("pi/3", 1.0)), []
    for m in result.minima:
        x = result.model.reduce(np.array(m.fold_angles))
        kinds.append((m.kind, load_margin(State(result.model, x)).status))
    assert ("contact-touching", "zero") in kinds
    assert kinds.count(("degenerate", "unbounded")) == 2


# ---------------------------------------------------------------- cones of contact forces


def test_distance_in_a_cone_agrees_with_the_set_of_multipliers() -> None:
    rng = np.random.default_rng(7)
    for _ in range(10):
        b = np.abs(rng.normal(size=(3, 5)))
        c = b @ rng.uniform(0.2, 1.0, 5)
        found = distance_to_boundary(b, c)
        assert found is not None
        distance, normal = found
        assert find_multipliers(b, c - 0.999 * distance * normal).residual < 1e-9
        assert find_multipliers(b, c - 1.001 * distance * normal).residual > 1e-9
        for d in rng.normal(size=(20, 3)):  # no other direction leaves the cone earlier
            assert find_multipliers(b, c + 0.99 * distance * d / np.linalg.norm(d)).residual < 1e-9
    # generators that span everything positively: nothing opens
    star = np.array([[1.0, -0.5, -0.5], [0.0, 1.0, -1.0]])
    assert distance_to_boundary(star, np.array([0.1, 0.1])) is None
