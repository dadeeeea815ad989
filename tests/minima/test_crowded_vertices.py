"""Vertices that people try first, where many facets meet: what a search costs."""

import math
import time

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, find_minima
from origami_nlp.problem import Model

pytestmark = pytest.mark.slow
h = math.pi / 2
CROWDED = {
    "eight of 45 degrees": (8, (-math.pi, -h, math.pi, h) * 2, 30),
    "six of 60 degrees, alternating": (6, (math.pi, -math.pi) * 3, 10),
    "six of 60 degrees, all but one alike": (6, (math.pi,) * 5 + (-math.pi,), 10),
}
"""Degree, rest angles, processor seconds where this was measured; a test allows for one ten times slower."""


@pytest.mark.parametrize("name", CROWDED)
def test_a_search_takes_seconds_and_lists_whole_orbits(name):
    n, rest, seconds = CROWDED[name]
    scene = Scene(Vertex((2 * math.pi / n,) * n), (1.0,) * n, rest, "none", "full")
    begin = time.process_time()
    minima = find_minima(scene, escape=False).minima
    assert time.process_time() - begin < 10 * seconds and minima
    states = np.array([m.fold_angles for m in minima])
    for order, sign in Model(scene).own_symmetries:
        for m in minima:
            image = sign * np.array(m.fold_angles)[order]
            near = np.abs(states - image).max(axis=1)
            assert near.min() <= 1e-6
            assert minima[int(near.argmin())].energy == pytest.approx(m.energy, rel=1e-9)
