"""Truth of each minimum of the 18 panels: no admissible neighbour is lower.

Neighbours come from `independent`: exact closure with rotation matrices, contact by orientation
tests and by stacking layers.  Bound on rounding: `independent.neighbours.energy_noise`.
"""

import dataclasses

import numpy as np
import pytest

from origami_nlp import examples
from tests.computed_once import panel_result, thinned
from tests.independent.admissible import admissible
from tests.independent.neighbours import RADII, Problem, draw, look_around, strata

PANELS = examples.panels()
SOME = thinned(PANELS[4:] + PANELS[:4], 9)
FULL_RADII = np.logspace(-1, -5, 9)
NORMAL, SLOW, SLOW_FULL = 200, 10_000, 20_000


def full_problem(scene):
    """The scene with all N fold angles free."""
    return dataclasses.replace(Problem.of(scene), orbit=np.arange(scene.degree))


def check_symmetric(result, count):
    p, rng = Problem.of(result.scene), np.random.default_rng(11)
    for m in result.minima:
        x = p.reduce(np.array(m.fold_angles))
        around = look_around(p, x, count, rng, radii=RADII, most_tries=60)
        assert not len(around.lower), (m, around)
        assert around.admitted >= (count if m.local_dimension else 0)


def check_full(result, count):
    p, rng = full_problem(result.scene), np.random.default_rng(12)
    for m in result.minima:
        if m.full_space.verdict != "stable":
            continue
        around = look_around(
            p, np.array(m.fold_angles), count, rng, radii=FULL_RADII, most_tries=60
        )
        assert not len(around.lower), (m, around)
        assert around.admitted >= (count if m.full_space.local_dimension else 0)


@pytest.mark.parametrize("scene", SOME, ids=lambda s: s.name)
def test_no_symmetric_neighbour_is_lower(scene):
    check_symmetric(panel_result(scene, full=True), NORMAL)


@pytest.mark.parametrize("scene", SOME, ids=lambda s: s.name)
def test_no_neighbour_of_a_stable_state_is_lower(scene):
    check_full(panel_result(scene, full=True), NORMAL)


@pytest.mark.parametrize("scene", SOME, ids=lambda s: s.name)
def test_the_same_look_refutes_unstable_and_moved_states(scene):
    """The look can fail: it finds lower neighbours of unstable states and of moved minima."""
    full, rng = full_problem(scene), np.random.default_rng(13)
    p = Problem.of(scene)
    for m in panel_result(scene, full=True).minima:
        phi = np.array(m.fold_angles)
        if m.full_space.verdict == "unstable":
            assert len(look_around(full, phi, NORMAL, rng, radii=FULL_RADII).lower)
        x = p.reduce(phi)
        moved = [draw(p, x, np.full(40, 0.02), kept, rng)[0] for kept in strata(p, x)]
        moved = np.concatenate(moved)
        moved = moved[admissible(p.sectors, moved[:, p.orbit], p.contact)]
        if m.local_dimension:
            assert len(look_around(p, moved[0], NORMAL, rng, radii=RADII[4:]).lower)


@pytest.mark.parametrize("scene", SOME, ids=lambda s: s.name)
def test_local_dimension_is_that_of_the_neighbours(scene):
    p, rng = Problem.of(scene), np.random.default_rng(14)
    for m in panel_result(scene, full=True).minima:
        x = p.reduce(np.array(m.fold_angles))
        around = look_around(p, x, 150, rng, radii=np.array([1e-3, 1e-4, 1e-5]))
        assert around.dimension == m.local_dimension
