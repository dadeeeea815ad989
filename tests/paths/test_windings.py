"""Paths of states that wind several times round their axis: followed by themselves, told beside the others."""

import math
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp import (
    Atlas,
    Scene,
    Vertex,
    find_minima,
    follow,
    load_path,
)

STAR = Scene(
    Vertex(("pi/4",) * 8), (1, 2) * 4, (math.radians(131.0604),) * 8, contact="fold-limits"
)


@pytest.mark.slow  # seconds of curves or searches
def test_an_atlas_holds_the_states_of_every_winding(tmp_path):
    atlas = follow(replace(STAR, symmetry="D4"), "stiffness[1]=1:1.5", checks=1, full=False)
    (other,) = atlas.others
    assert not atlas.alarms and not other.alarms and other.scene.winding == 3
    for t in (1.0, 1.2, 1.5):
        k = tuple(t if c % 2 == 0 else 2 for c in range(8))
        searched = find_minima(replace(STAR, stiffness=k), prove=False, escape=False)
        verify_minimum = [s for s in atlas.at(t) if s.verdict == "minimum"]
        assert len(verify_minimum) == len(searched.minima) == 4
        for state, m in zip(verify_minimum, searched.minima, strict=True):
            assert np.abs(np.subtract(state.fold_angles, m.fold_angles)).max() < 1e-7
    assert "states that wind 3 times round the axis of D4" in str(atlas)
    atlas.save(tmp_path / "atlas.json")
    again = Atlas.load(tmp_path / "atlas.json")
    assert [len(b.points) for b in again.others[0].branches] == [
        len(b.points) for b in other.branches
    ]


def test_a_load_path_keeps_the_winding_of_its_first_state():
    path = load_path(STAR, 1, to=0.05, state=1, confirm=False, full=False)
    assert path.driver.scene.winding == 3
    x = np.array([p.fold_angles for leg in path.legs for p in leg.points])
    assert len(x) > 1 and np.abs(np.degrees(x) - 131.06).max() < 10
