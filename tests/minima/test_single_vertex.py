"""A vertex is a pattern with one interior vertex: the search for vertices and the one for patterns, side by side."""

import json
import math

import numpy as np

from origami_nlp import Scene, Vertex
from origami_nlp.pattern import frame_pattern, parse_fold
from origami_nlp.pattern_problem import states_to_fold
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
