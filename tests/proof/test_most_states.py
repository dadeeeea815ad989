"""The most stable states of four creases: false bounds claimed for a vertex are refuted, true ones are not."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

import origami_nlp as o
from tests.independent.scan_four import minima

pytest.importorskip("flint")
from tests.independent.most_states import least_minima, lemma_holds

SIX = (62, 100, 119, 79), (0.02, 0.0186, 0.0129, 0.0135), (-180, -141, 180, 180)
FIVE = (
    (93.6652, 79.8415, 78.1514, 108.3419),
    (0.07525998, 0.32292183, 0.04775481, 0.55406338),
    (156.133744, 50.921188, -180, 159.358254),
)
FOUR = (88, 82, 92, 98), (0.02,) * 4, (110, 110, -170, -170)
MIURA = (84, 96, 96, 84), (0.02,) * 4, (170, 60, -140, 40)
CROSS = (90, 90, 90, 90), (0.02, 0.01, 0.02, 0.01), (100, -70, -40, -50)


def scene_of(sectors, stiffness, rest, contact="full"):
    vertex = o.Vertex(tuple(np.radians(sectors)))
    return o.Scene(vertex, stiffness, tuple(np.radians(rest)), symmetry="none", contact=contact)


@pytest.mark.parametrize(
    ("case", "count"), [(SIX, 6), (FIVE, 5), (FOUR, 4), (MIURA, 5), (CROSS, 6)]
)
def test_the_records_are_proved_complete(case, count):
    result = o.find_minima(scene_of(*case), prove=True)
    assert result.completeness.status in ("proved", "proved-except-singular")
    assert len(result.minima) == count
    if case is FIVE:
        assert {m.kind for m in result.minima} == {"interior"}


def places(result, branch):
    """Folds of crease 1 [deg] at the minima of a branch, and at the highest of 200 states between two of them."""
    one = [m.fold_angles for m in result.minima if m.fold_angles[0] * m.fold_angles[2] * branch > 0]
    at = np.sort(np.degrees([phi[0] for phi in one]))
    return at


def with_maxima(case, at, branch):
    from tests.independent.most_states import energy

    found = list(at)
    for a, b in pairwise(at):
        between = [x for x in np.round(np.linspace(a, b, 200)[1:-1], 3).tolist() if x != 0]
        found.append(max(between, key=lambda fold: float(energy(*case, branch, fold).mid())))
    return [round(float(x), 3) for x in found]


def test_a_false_bound_of_five_is_refuted_by_energies_alone_and_six_is_not():
    result = o.find_minima(scene_of(*SIX), prove=False)
    along = [with_maxima(SIX, places(result, sign), sign) for sign in (1, -1)]
    assert least_minima(*SIX, along) == 6
    fewer = [branch[:1] for branch in along]
    assert least_minima(*SIX, fewer) == 2


def test_a_false_bound_of_three_is_refuted_for_a_flat_foldable_vertex():
    result = o.find_minima(scene_of(*FOUR), prove=False)
    along = [with_maxima(FOUR, places(result, sign), sign) for sign in (1, -1)]
    assert least_minima(*FOUR, along) == 4


def test_the_lemma_holds_over_boxes_of_balls_and_a_stronger_one_does_not():
    assert lemma_holds((Fraction(1, 2), Fraction(19, 20)), 4, depth=16)
    assert not lemma_holds((Fraction(1, 2), Fraction(19, 20)), 4, slope=-1, depth=6)


@pytest.mark.slow
def test_the_lemma_holds_over_more_boxes():
    ends = [Fraction(1, n) for n in (20, 10, 4, 2)]  # small mu need smaller boxes
    assert all(lemma_holds(part, 4, depth=16) for part in pairwise(ends))


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_random_flat_foldable_vertices_have_four_at_most(seed):
    """Also by a scan of all closed states by spherical triangles, with springs drawn where four are common."""
    rng = np.random.default_rng(seed)
    counts = []
    for _ in range(2 if seed == 0 else 40):
        a, b = (
            90 + rng.choice([-1, 1]) * rng.uniform(1, 12),
            90 + rng.choice([-1, 1]) * rng.uniform(13, 25),
        )
        case = (
            (a, b, 180 - a, 180 - b),
            tuple(0.02 * 10 ** rng.uniform(-0.3, 0.3, 4)),
            tuple(rng.choice([-1, 1], 4) * rng.uniform(100, 180, 4)),
        )
        scene = scene_of(*case)
        result = o.find_minima(scene, prove=True)
        k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
        energies, _ = minima(
            lambda x, k=k, rest=rest: ((x - rest) ** 2 @ k) / 2,
            np.array(scene.vertex.sector_angles),
            np.array([[-np.pi] * 4, [np.pi] * 4]),
            "full",
            4001,
        )
        assert result.completeness.status in ("proved", "proved-except-singular")
        assert len(energies) == len(result.minima) <= 4
        counts.append(len(energies))
    assert seed == 0 or max(counts) >= 3
