"""The search from moments: what it finds is certified, is what other searches find, and does not depend on labels."""

import numpy as np
import pytest

from origami_nlp import find_minima
from origami_nlp.search.moment_map import MomentMap
from tests.search.test_moment_map import draw


@pytest.mark.parametrize("n", [4, 6])
def test_every_minimum_is_a_zero_of_the_map(n):
    compared = 0
    for seed in range(3):
        found = find_minima(draw(n, seed), effort="quick", prove=False, escape=False)
        chain = MomentMap(found.model)
        for minimum in found.minima:
            shot = chain.shoot(np.array([minimum.moment]) / found.model.scale)
            assert np.abs(shot.miss).max() <= 1e-13 * (1 + shot.growth.max() * chain.largest)
            assert np.abs(shot.x[0] - minimum.fold_angles).max() <= 1e-7
            compared += 1
    assert compared >= 6


def test_same_seed_same_answer():
    a, b = (
        find_minima(draw(28), effort="quick", max_starts=60, seed=3, prove=False, escape=False)
        for _ in range(2)
    )
    assert [m.fold_angles for m in a.minima] == [m.fold_angles for m in b.minima]
    assert a.search.by_source == b.search.by_source
    assert a.search.by_source["moments"] > 0
