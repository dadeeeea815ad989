"""Every search with full contact finds what ten of them find together (a long study)."""

import numpy as np
import pytest

from benchmarks.families import family_scene
from origami_nlp import find_minima

SCENES = range(1, 41)
"""Of the family "full-contact": eight each of degree 4 to 8."""
SEEDS = range(10)
APART = 1e-4


@pytest.mark.slow
def test_each_of_three_seeds_finds_the_union_of_ten():
    asked = 0
    for number in SCENES:
        scene = family_scene("full-contact", number)
        union, found = [], []
        for seed in SEEDS:
            result = find_minima(scene, seed=seed, prove=False, escape=False)
            found.append(set())
            for minimum in result.minima:
                x = np.array(minimum.fold_angles)
                apart = [float(np.abs(x - other).max()) for other in union]
                if min(apart, default=np.inf) > APART:
                    apart.append(0.0)
                    union.append(x)
                found[-1].add(int(np.argmin(apart)))
        asked += len(union)
        for seed in (0, 1, 2):
            assert len(found[seed]) == len(union), (number, seed)
    assert asked > 100
