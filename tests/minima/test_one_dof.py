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
PLANTED = Scene(
    Vertex((0.7784849122786709, 2.291547160916454, 1.0231515757129965, 2.1900016582714645)),
    (0.022816280794769387, 0.03205546964080397, 0.04387824855836886, 0.0012500010060577914),
    (-0.2369412983168271, 1.0889080776221243, 3.141592485901434, 3.1415921923256085),
    "none",
)
WAITUKAITIS = Scene(
    Vertex((1.34035, 1.72886, 1.73407, 2 * PI - 1.34035 - 1.72886 - 1.73407)),
    (0.91922, 0.024246, 0.028457, 2.42197),
    (-2.32067, 1.93939, 2.09308, 1.60176),
    "none",
)
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


def test_a_state_that_one_start_in_hundreds_finds():
    for contact in ("full", "fold-limits"):
        scene = Scene(PLANTED.vertex, PLANTED.stiffness, PLANTED.rest_angles, "none", contact)
        assert nearest(np.radians([-39.56, 169.34, 37.27, 120.3]), listed(scene)) < 1e-4


def test_five_states_of_a_degree_4_vertex():
    energies = [WAITUKAITIS.energy(x) for x in listed(WAITUKAITIS)]
    assert energies == pytest.approx([1.75371, 1.88391, 1.89567, 3.85321, 13.7429], rel=2e-5)


def test_the_same_turned_over_and_renumbered():
    rng = np.random.default_rng(3)
    for _ in range(2):
        sectors = 0.3 + rng.dirichlet(np.full(4, 4.0)) * (2 * PI - 1.2)
        if sectors.max() > 3:
            continue
        k, rest = 10.0 ** rng.uniform(-1, 1, 4), rng.uniform(-PI, PI, 4)
        first = None
        for shift, sign in ((0, 1), (1, 1), (2, -1), (3, 1)):
            a, s, r = (np.roll(v, shift) for v in (sectors, k, sign * rest))
            scene = Scene(Vertex(tuple(a.tolist())), s, r, "none", "full")
            x = sign * np.roll(listed(scene), -shift, axis=1)
            first = x if first is None else first
            assert len(x) == len(first) and all(nearest(y, first) < 1e-8 for y in x)
