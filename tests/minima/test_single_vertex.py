"""A vertex is a pattern with one interior vertex: the search for vertices and the one for patterns, side by side."""

import json
import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, find_minima
from origami_nlp.pattern import frame_pattern, parse_fold
from origami_nlp.pattern_problem import PatternProblem, states_to_fold
from origami_nlp.pattern_states import find_states, judge
from tests.computed_once import thinned
from tests.patterns import scene_pattern

DECIDED = 1e-9
"""Fold angles [rad], and energies over the mean stiffness, of one state found both ways."""


def drawn(seed, degree, contact):
    rng = np.random.default_rng(seed)
    while True:
        sectors = 0.15 + rng.dirichlet(np.full(degree, 2.0)) * (2 * math.pi - 0.15 * degree)
        if sectors.max() < 3.0:
            break
    k, rest = 10 ** rng.uniform(-0.7, 0.7, degree), rng.uniform(-math.pi, math.pi, degree)
    return Scene(Vertex(tuple(sectors)), k, rest, "none", contact)


def compare(scene):
    """Judge the minima of a vertex as states of a pattern: what both searches list; verdicts of what was found."""
    one = find_minima(scene, prove=False, escape=False)
    pattern, full = scene_pattern(scene), scene.contact == "full"
    problem, verdicts = PatternProblem(pattern), []
    for m in one.minima:
        state = judge(problem, np.array(m.fold_angles), full)
        assert abs(state.energy - m.energy) <= DECIDED * (1 + abs(m.energy))
        assert state.verdict in ("minimum", "undecided"), (m.kind, state.certificate)
        if m.kind != "degenerate":  # for one vertex that says which set it is on, not what holds it
            assert state.kind in (m.kind, None), state.certificate
        verdicts.append(state.verdict)
    known = [np.array(m.fold_angles) for m in one.minima]
    found = find_states(pattern, contact=full, escape=False).minima
    if len(found) > verdicts.count(
        "minimum"
    ):  # a default search misses some: they are there for a thorough one
        more = find_minima(scene, prove=False, effort="thorough", escape=False).minima
        known += [np.array(m.fold_angles) for m in more]
    for state in found:
        assert min(np.abs(state.phi - phi).max() for phi in known) < DECIDED
    assert len(found) >= verdicts.count("minimum")
    return verdicts


def test_a_scene_its_file_and_its_pattern_are_the_same():
    scene = drawn(0, 5, "full")
    pattern = scene_pattern(scene)
    (frame,) = parse_fold(json.dumps(states_to_fold(scene, [])))
    again = frame_pattern(frame)
    phi = np.random.default_rng(0).uniform(-1, 1, (3, 5))
    for one in (pattern, again):
        assert one.facets == one.creases == 5 and len(one.vertices) == 1
        assert np.abs(one.energy(phi) - [scene.energy(p) for p in phi]).max() < 1e-12
    assert np.abs(pattern.corners - again.corners).max() < 1e-15


@pytest.mark.parametrize("contact", thinned(["full", "fold-limits"], 2))
def test_vertices_with_one_dof_have_the_same_minima_both_ways(contact):
    assert "undecided" not in compare(drawn(0, 4, contact))


@pytest.mark.parametrize(("seed", "contact"), thinned([(1, "full"), (3, "fold-limits")], 2))
def test_vertices_with_more_dof_have_the_same_minima_both_ways(seed, contact):
    assert "minimum" in compare(drawn(seed, 5, contact))


@pytest.mark.slow
@pytest.mark.parametrize("contact", ["fold-limits", "full"])
@pytest.mark.parametrize("degree", [4, 5, 6])
def test_20_vertices_are_judged_alike(degree, contact):
    verdicts = [compare(drawn(seed, degree, contact)) for seed in range(100, 120)]
    reported = [v for one in verdicts for v in one]
    assert reported.count("undecided") <= 0.05 * len(reported)
