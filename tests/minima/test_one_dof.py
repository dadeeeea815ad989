"""Scenes with one degree of freedom: what few starts find, others, or published lists know is not missed."""

import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, find_minima
from origami_nlp.pattern_problem import pose
from tests.computed_once import thinned
from tests.independent.scenes import SHAPES, build

PI = math.pi
ONE = [s for s in SHAPES if pose(build(np.random.default_rng(0), s)).dof == 1]
SPECIAL = {
    "90 degrees": (PI / 2,) * 4,
    "90 degrees, nearly": (PI / 2 + 1e-4, PI / 2 - 2e-4, PI / 2, PI / 2 + 1e-4),
    "Miura": (1.0, PI - 1.0, PI - 1.0, 1.0),
    "flat-foldable": (0.7, 1.9, PI - 0.7, PI - 1.9),
    "flat-foldable, nearly": (0.7, 1.9, PI - 0.7 + 1e-5, PI - 1.9 - 1e-5),
    "collinear": (0.7, PI - 0.7, 1.2, PI - 1.2),
    "kite": (1.0, 1.0, PI - 1.0, PI - 1.0),
}


def listed(scene, **options):
    """Fold angles of the minima, [M, N]."""
    found = find_minima(scene, prove=False, escape=False, **options)
    return np.array([m.fold_angles for m in found.minima]).reshape(-1, scene.degree)


def nearest(x, states):
    return np.abs(states - x).max(axis=1).min(initial=np.inf)


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 2))])
@pytest.mark.parametrize("shape", thinned([(s,) for s in ONE], 3), ids=str)
def test_lists_do_not_hang_on_the_seed(shape, seed):
    scene = build(np.random.default_rng(seed), shape, "fold-limits", decades=1.0)
    one, other = listed(scene), listed(scene, seed=7)
    assert len(one) == len(other) > 0 and all(nearest(x, other) <= 1e-7 for x in one)


RESTS = [(PI / 2, 0, PI / 2, 0), (-1.0, 2.0, -3.0, 1.0), (1.0,) * 4]


@pytest.mark.parametrize(
    "rest", [RESTS[1], *(pytest.param(r, marks=pytest.mark.slow) for r in RESTS[::2])], ids=str
)
@pytest.mark.parametrize("name", thinned([*SPECIAL], 4))
def test_nothing_is_missing_where_curves_cross(name, rest):
    scene = Scene(Vertex(SPECIAL[name]), (1.0, 1.3, 0.7, 1.1), rest, "none")
    minima = listed(scene)
    assert all(nearest(x, minima) <= 1e-7 for x in listed(scene, seed=7))
