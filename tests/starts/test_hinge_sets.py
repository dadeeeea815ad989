"""Sets of states on hinges, what was made exact, and what is undecided: found, and told in the result."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp
from origami_nlp import MinimaResult
from origami_nlp.kkt import State, classify
from origami_nlp.minima import JudgedState
from origami_nlp.problem import Model
from origami_nlp.starts.hinge_sets import HingeSets
from tests.independent.rotations import about


def sectors_of(parts: list[int]) -> tuple[float, ...]:
    return tuple(2 * math.pi * p / sum(parts) for p in parts)


def test_a_report_says_what_was_made_exact() -> None:
    d, h = 1e-9, math.pi / 2
    vertex = origami_nlp.Vertex((h + d, h - d, h + d, h - d))
    scene = origami_nlp.Scene(vertex, (1.0,) * 4, (1.0, 0.3, 0.4, -0.2), symmetry="none")
    result = origami_nlp.find_minima(scene, max_starts=4, prove=False, escape=False)
    assert "sector angles moved by up to 1.0e-09 rad" in str(result)
    data = result.to_dict()
    assert data["relations"]["made_exact"] and data["search"]["undecided"] == []
    assert MinimaResult.from_dict(data).to_dict() == data


@pytest.mark.parametrize(
    "parts", [(1, 1, 1, 1, 1, 1), (1, 1, 1, 1), (1, 2, 1, 1, 2, 1), (2, 1, 1, 2, 2)]
)
def test_hinge_sets_hold_the_lowest_states_along_them(parts: tuple[int, ...]) -> None:
    """Each state closes by rotation matrices, and moves that keep it on its line of hinges lead up."""
    rng = np.random.default_rng(len(parts))
    n = len(parts)
    vertex = origami_nlp.Vertex(sectors_of(list(parts)))
    scene = origami_nlp.Scene(
        vertex,
        rng.uniform(0.1, 2, n).tolist(),
        rng.uniform(-2.5, 2.5, n).tolist(),
        symmetry="none",
    )
    model = Model(scene)
    states = HingeSets(model).states()
    assert states

    def misses(phi: np.ndarray) -> float:
        product = np.eye(3)
        for b, angle in zip(vertex.creases, phi, strict=True):
            product = product @ about(b, angle)
        return float(np.abs(product - np.eye(3)).max())

    moved = 0
    for x in states:
        assert misses(x) < 1e-12 and model.lifts_to_one(x)
        hinges = np.flatnonzero((np.abs(x) < math.pi) & (np.abs(x) > 1e-9))
        for i, j in itertools.combinations(hinges, 2):
            for si, sj in itertools.product((1e-2, -1e-2), repeat=2):
                y = x.copy()
                y[[i, j]] += si, sj
                if misses(y) < 1e-12 and np.abs(y).max() <= math.pi:
                    moved += 1
                    assert scene.energy(y) > scene.energy(x)
    assert moved


@pytest.mark.parametrize("ulps", [(0, 0, 0, 0), (3, -2, -2, 3), (1, 0, -1, 0), (-4, 4, 3, -3)])
def test_rounding_of_the_sectors_makes_no_states(ulps: tuple[int, ...]) -> None:
    """Where two sets of states of the cross almost meet, doubles see a state in the gap between them."""
    sectors = tuple(math.pi / 2 + u * 2.0**-52 for u in ulps)
    rest = (math.pi, -math.pi, -math.pi, -math.pi)
    scene = origami_nlp.Scene(origami_nlp.Vertex(sectors), (1.0,) * 4, rest)
    result = origami_nlp.find_minima(scene, prove=False, escape=False)
    flat = math.pi * np.round(np.array([m.fold_angles for m in result.minima]) / math.pi)
    assert np.array([m.fold_angles for m in result.minima]) == pytest.approx(flat, abs=1e-12)
    assert [m.energy for m in result.minima] == pytest.approx([0.0, 4 * math.pi**2], abs=1e-12)


def test_what_is_not_polished_is_undecided_and_told_by_name() -> None:
    scene = origami_nlp.examples.degree6("pi/4", 1.0)
    result = origami_nlp.find_minima(scene, max_starts=8, prove=False, escape=False)
    state = result.minima[0]
    what = classify(State(result.model, result.model.reduce(state.fold_angles)), polished=False)
    assert what.verdict == "undecided" and what.kind is None and "not polished" in what.reason
    named = JudgedState(state.energy, state.fold_angles, what.verdict, what.reason, hits=1)
    reported = replace(result, search=replace(result.search, undecided=(named,)))
    assert what.reason in reported.report(verbose=True)
    assert MinimaResult.from_dict(reported.to_dict()).search.undecided == (named,)
