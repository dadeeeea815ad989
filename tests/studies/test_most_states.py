"""The search for springs of a vertex of degree 4 counts what the package finds, and finds six again."""

import numpy as np
import pytest

import origami_nlp as o
from studies.most_states import climb, count

SECTORS = np.radians((62, 100, 119, 79))


def test_states_are_counted_as_the_package_finds_them():
    k, rest = np.array((0.02, 0.0186, 0.0129, 0.0135)), np.radians((-180, -141, 180, 180))
    assert count(SECTORS, np.r_[k, k * rest]) == 6
    rng = np.random.default_rng(0)
    for _ in range(3):
        k, rest = rng.uniform(0.01, 0.1, 4), rng.uniform(-np.pi, np.pi, 4)
        scene = o.Scene(
            o.Vertex(tuple(SECTORS)), tuple(k), tuple(rest), symmetry="none", contact="fold-limits"
        )
        assert count(SECTORS, np.r_[k, k * rest]) == len(o.find_minima(scene, prove=False).minima)


def test_five_states_are_found():
    found = climb((2, 1), SECTORS, seconds=1.0)
    assert found.holds and found.counted >= 5


@pytest.mark.slow
def test_six_states_are_found_and_seven_are_not():
    found = climb((2, 2), SECTORS, seconds=30)
    assert found.holds and found.counted >= 6
    for maxima in ((3, 2), (2, 3)):
        assert not climb(maxima, SECTORS, seconds=20).holds
