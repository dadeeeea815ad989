"""Critical points, long studies: all panels, random energies on every geometry, density of the samples."""

import math

import numpy as np
import pytest

from origami_nlp.critical import compare_minima, find_critical_points
from origami_nlp.numerics import STATIONARY
from origami_nlp.space import find_space
from tests.computed_once import panel_result
from tests.critical.test_critical_points import (
    PANELS,
    SHAPES,
    critical_points,
    kkt_points,
    random_energy,
)


@pytest.mark.slow
@pytest.mark.parametrize("scene", PANELS, ids=lambda s: s.name)
def test_every_panel_closes_with_the_same_minima(scene):
    found = compare_minima(find_critical_points(scene, all_links=True), panel_result(scene))
    euler = find_space(scene).euler_characteristic
    assert found.doubts == () and found.verdict(euler).closes
    assert found.comparison.agree


@pytest.mark.slow
@pytest.mark.parametrize("scene", SHAPES, ids=lambda s: s.name)
def test_random_energies_have_one_sum(scene):
    rng = np.random.default_rng(11)
    euler = find_space(scene).euler_characteristic
    for _ in range(12):
        found = find_critical_points(random_energy(scene, rng), all_links=True)
        assert found.morse_sum == euler, found.to_dict()
        assert found.doubts == ()


@pytest.mark.slow
@pytest.mark.parametrize("scene", PANELS, ids=lambda s: s.name)
def test_sparser_and_denser_samples_find_the_same_points(scene):
    usual = np.array([p.fold_angles for p in critical_points(scene).points])
    for samples, seed in ((1024, 1), (32768, 2)):
        other = find_critical_points(scene, samples=samples, seed=seed)
        states = np.array([p.fold_angles for p in other.points])
        assert len(states) == len(usual)
        apart = np.abs(states[:, None] - usual).max(axis=2)
        assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("scene", PANELS, ids=lambda s: s.name)
def test_every_kkt_point_of_a_long_multistart_is_listed(scene):
    listed = np.array([p.fold_angles for p in critical_points(scene).points])
    ends = kkt_points(scene, np.random.default_rng(23), 100)
    away = np.abs(ends[:, None] - listed).max(axis=2).min(axis=1)
    # at a flat folding a gap opens to second order: met to STATIONARY, Newton stops at a distance of its root
    assert away.max() < math.sqrt(STATIONARY), ends[away.argmax()]
