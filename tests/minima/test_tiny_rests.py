"""Rest angles so small that closure, whose errors are their squares, cannot tell states from the flat one."""

import re

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.minima.summary import _least_beside_flat
from tests.computed_once import thinned


@pytest.mark.parametrize("sectors", thinned([((70, 80, 120, 90),), ((60, 120, 60, 120),)], 2))
def test_states_of_least_energy_are_within_a_bound_and_their_number_is_not_claimed(sectors):
    rng = np.random.default_rng(1)
    rest, k = rng.uniform(-1, 1, 4), np.exp(rng.normal(size=4))

    def scene(size):
        return Scene(Vertex.from_degrees(sectors), tuple(k), tuple(size * rest), "none")

    # large enough to be told apart: at least two, on the branches through the flat state
    seen = o.find_minima(scene(1e-3), escape=False, prove=False).minima
    lowest = min(seen, key=lambda m: m.energy)
    assert len(seen) == 2
    for size in (1e-10, 1e-8):
        verdict = o.find_minima(scene(size), escape=False, prove=False).verdict
        found = re.search(r"not decided how many .* within (\S+) rad of 0", verdict)
        # to second order of closure states grow as their rest angles
        assert found and float(found[1]) > size / 1e-3 * np.abs(lowest.fold_angles).max()
        assert float(found[1]) < 10 * size
    assert _least_beside_flat(scene(1e-3)) == 0.0
