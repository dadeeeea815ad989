"""Facets that cross, against the Flexible Collision Library: the same pairs, but for what is shallower than 1e-9."""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern_problem import PatternProblem

pytest.importorskip("fcl", reason="python-fcl, of the extra test")
from tests.independent.rigid import collide, depth

PATTERNS = {
    "miura": (3, 4),
    "metasheet": (4, 4),
    "waterbomb": (2, 2),
    "yoshimura": (3, 3),
    "resch": (1, 2),
    "squaretwist": (),
}
SHALLOW = 1e-9


def states(pattern, count, rng):
    """Fold angles that close where a projection finds some, else any: facets are placed along a tree of creases."""
    problem = PatternProblem(pattern)
    for _ in range(count):
        phi = rng.uniform(-1, 1, pattern.creases) * rng.choice([0.5, 1.5, 3.0])
        closed, residual = problem.project(phi)
        yield closed if residual < 1e-12 and np.abs(closed).max() > 0.1 else phi


def compare(pattern, phi):
    """Return the number of crossing pairs of both, and pairs on which they disagree."""
    problem = PatternProblem(pattern)
    ours = set(problem.crossings.find(phi))
    x = problem.crossings.poses.polygons(phi)
    neighbours = {tuple(sorted(p)) for p in zip(pattern.left, pattern.right, strict=True)}
    pairs = {(j, i) for i in range(len(x)) for j in range(i)} - neighbours
    theirs, wrong = {(j, i) for j, i in pairs if collide(x[i], x[j])}, []
    for i, j in ours ^ theirs:
        deep = depth(x[i], x[j])
        if deep > SHALLOW * problem.crossings.size:
            wrong.append((i, j, deep, (i, j) in ours))
    return len(ours), wrong


@pytest.mark.parametrize(
    "count", [pytest.param(8, id="48"), pytest.param(167, id="1002", marks=pytest.mark.slow)]
)
def test_the_same_facets_cross(count):
    rng = np.random.default_rng(count)
    crossed = 0
    for name, size in PATTERNS.items():
        p = o.examples.pattern(name, *size)
        for phi in states(p, count, rng):
            many, wrong = compare(p, phi)
            assert not wrong, (name, wrong)
            crossed += many
    assert crossed > 10 * count
