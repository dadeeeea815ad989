"""Paths of states that wind several times round their axis: followed by themselves, told beside the others."""

import math
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, find_minima, follow, load_path

STAR = Scene(
    Vertex(("pi/4",) * 8), (1, 2) * 4, (math.radians(131.0604),) * 8, contact="fold-limits"
)


@pytest.mark.slow  # seconds of curves or searches
@pytest.mark.parametrize("winding", [1, 3])
def test_an_atlas_holds_the_states_of_one_winding_and_names_the_others(winding):
    stated = replace(STAR, symmetry="D4", winding=None if winding == 1 else winding)
    atlas = follow(stated, "stiffness[1]=1:1.5", checks=1, full=False)
    assert ["wind 3 times" in line for line in atlas.alarms] == [True] * (winding == 1)
    for t in (1.0, 1.2, 1.5):
        k = tuple(t if c % 2 == 0 else 2 for c in range(8))
        one = replace(STAR, stiffness=k, symmetry="D4", winding=winding)
        found = [s for s in atlas.at(t) if s.verdict == "minimum"]
        searched = find_minima(one, prove=False, escape=False).minima
        assert len(found) == len(searched) > 0
        for state, m in zip(found, searched, strict=True):
            assert np.abs(np.subtract(state.fold_angles, m.fold_angles)).max() < 1e-7


def test_a_load_path_keeps_the_winding_of_its_first_state():
    path = load_path(STAR, 1, to=0.05, state=1, full=False)
    assert path.driver.scene.winding == 3
    x = np.array([p.fold_angles for leg in path.legs for p in leg.points])
    assert len(x) > 1 and np.abs(np.degrees(x) - 131.06).max() < 10
