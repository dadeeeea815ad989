"""Branch and prune excludes nothing that closes, and no critical point."""

import math

import numpy as np
import pytest

from benchmarks import family_scene
from origami_nlp import find_minima
from origami_nlp.pattern import examples
from origami_nlp.proof import ReducedVertex, prove
from origami_nlp.proof.boxes import prune, strata
from origami_nlp.proof.proving import pose
from origami_nlp.proof.rows import joined
from tests.closed_states import closed_states
from tests.computed_once import thinned

OUTSIDE = 1e-9
"""A state in doubles closes to 1e-14; by how much [rad] it may lie outside a box that holds the exact one."""


class ClosureOnly:
    """Rows of a scene without those of critical points."""

    def __init__(self, posed):
        self.posed = posed

    def rows(self, lower, upper, pins):
        rows, asked = self.posed.rows(lower, upper, pins)
        asked[len(asked) - len(self.posed.subsets) - len(self.posed.twins) :] = False
        return rows, asked


def assert_held(boxes, x, pins):
    """A state is in one of the boxes of its stratum."""
    inside = (boxes.lower <= x[:, None] + OUTSIDE) & (x[:, None] <= boxes.upper + OUTSIDE)
    assert (inside & (boxes.pins == pins[:, None])).all(axis=0).any()


SCENES = {
    "degree 4": family_scene("fold-limits", 0),
    "degree 5": family_scene("fold-limits", 1),
    "D1": examples.degree6("pi/3", 1.0, contact="fold-limits"),
    "D2": examples.degree8("pi/6", 1.0, contact="fold-limits"),
}


@pytest.mark.parametrize("name", thinned([*SCENES], 2))
def test_no_closed_state_is_excluded_by_closure(name):
    model = ReducedVertex(SCENES[name])
    states = closed_states(model.problem, np.random.default_rng(0), 400)
    pins = np.where(np.abs(states) == math.pi, np.sign(states), 0).astype(int)
    assert len({tuple(p) for p in pins}) >= 5
    left = prune(ClosureOnly(pose(model)[0]), strata(model.size), small=0.2, most=200_000)
    boxes = joined([left.candidates, left.open], -1)
    # how much was excluded: else nothing is shown
    whole = strata(model.size).widths[:, 0].prod()
    assert boxes.widths[:, (boxes.pins == 0).all(axis=0)].prod(axis=0).sum() < 0.1 * whole
    for x, s in zip(states, pins, strict=True):
        assert_held(boxes, x, s)


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_critical_points_are_in_what_is_left(name):
    model, proof = ReducedVertex(SCENES[name]), prove(ReducedVertex(SCENES[name]))
    left = prune(pose(model)[0], strata(model.size))
    assert not len(left.open)
    for point in proof.points:
        x = model.problem.reduce(point.fold_angles)
        assert_held(left.candidates, x, np.array(point.stratum))
    for minimum in find_minima(model.scene, prove=False, escape=False).minima:
        x = model.problem.reduce(np.array(minimum.fold_angles))
        assert_held(
            left.candidates, x, np.where(np.abs(np.abs(x) - math.pi) < 1e-12, np.sign(x), 0)
        )
