"""Paths of states that wind several times round their axis: followed by themselves, told beside the others."""

import math

import numpy as np

from origami_nlp import Scene, Vertex, load_path

STAR = Scene(
    Vertex(("pi/4",) * 8), (1, 2) * 4, (math.radians(131.0604),) * 8, contact="fold-limits"
)


def test_a_load_path_keeps_the_winding_of_its_first_state():
    path = load_path(STAR, 1, to=0.05, state=1, full=False)
    assert path.driver.scene.winding == 3
    x = np.array([p.fold_angles for leg in path.legs for p in leg.points])
    assert len(x) > 1 and np.abs(np.degrees(x) - 131.06).max() < 10
