"""Where a proof leaves the word to the package: layers of facets, and limits that nothing presses."""

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import examples
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.proof import ReducedVertex, prove
from tests.independent import scan_four
from tests.independent.admissible import admissible
from tests.independent.rotations import fold
from tests.pattern_states.test_completeness import generic

STACKED = [
    pytest.param(i, marks=[] if i in (1, 9) else pytest.mark.slow)
    for i in range(18)
    if i not in (11, 14, 17)
]


@pytest.mark.parametrize("number", STACKED)
def test_points_that_are_dropped_for_their_layers_have_no_order(monkeypatch, number):
    """Stackings of the polygon on the sphere, strand by strand, for all that the test of layers was asked."""
    scene, asked = examples.panels()[number], []
    true = PatternProblem.refuses

    def refuses(problem, x, *more):
        asked.append((problem.expand(x), bool(true(problem, x, *more))))
        return true(problem, x, *more)

    monkeypatch.setattr(PatternProblem, "refuses", refuses)
    assert prove(ReducedVertex(scene)).finished
    assert asked or scene.degree == 6
    sectors = np.array(scene.vertex.sector_angles)
    for phi, refused in asked:
        assert refused != admissible(sectors, phi)[0]


@pytest.mark.parametrize("seed", range(8))
def test_a_limit_that_nothing_presses_is_left_to_the_judge(seed):
    """Of a critical point at a limit the rest angle is changed until the crease is as at a free one."""
    scene = generic(seed, 4)
    pinned = [p for p in prove(ReducedVertex(scene)).points if any(p.stratum)]
    for p in pinned[:2]:
        (i,) = np.flatnonzero(p.stratum).tolist()
        creases, _ = fold(np.array(scene.vertex.sector_angles), p.fold_angles)
        torque = float(np.dot(p.moment, creases[0, i]))
        rest = [*scene.rest_angles]
        rest[i] = p.fold_angles[i] - torque / scene.stiffness[i]
        if abs(rest[i]) > math.pi:
            continue
        other = replace(scene, rest_angles=tuple(rest))
        same = min(
            prove(ReducedVertex(other)).points,
            key=lambda q, x=p.fold_angles: (np.abs(q.fold_angles - x).max(), -abs(q.stratum[i])),
        )
        assert np.abs(same.fold_angles - p.fold_angles).max() < 1e-9
        assert same.is_minimum is None or same.index  # a saddle along the limit is none in any case
        k, r = np.array(other.stiffness), np.array(rest)
        limits = np.array([[-math.pi] * 4, [math.pi] * 4])
        energy = lambda x, k=k, r=r: (x - r) ** 2 @ k / 2  # noqa: E731
        known = scan_four.minima(energy, np.array(other.vertex.sector_angles), limits, "", 4001)[1]
        listed = [np.array(m.fold_angles) for m in o.find_minima(other, prove=True).minima]
        assert all(min(np.abs(x - y).max() for y in known) < 0.03 for x in listed)
        assert all(min(np.abs(x - y).max() for y in listed) < 0.03 for x in known)
