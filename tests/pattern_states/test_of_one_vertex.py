"""A pattern of one vertex is searched as one: with the springs that it has."""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern_problem import Torque
from origami_nlp.pattern_states.closed import scene_of


def test_springs_that_a_torque_winds_beyond_pi_are_searched_as_preload():
    loaded = Torque(o.examples.pattern("waterbomb", 1, 1), (1,)).loaded(-0.14)
    assert np.abs(loaded.rest).max() > np.pi
    scene, creases = scene_of(loaded, True)
    for phi in np.random.default_rng(0).uniform(-3, 3, (3, loaded.creases)):
        energy = 0.5 * loaded.stiffness @ (phi - loaded.rest) ** 2
        assert scene.energy(phi[creases]) == pytest.approx(energy, rel=1e-14)
