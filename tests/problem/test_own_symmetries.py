"""Symmetries that a scene has without imposing them: their images of states are states, of equal energy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex
from origami_nlp.kkt import project
from origami_nlp.problem import Model

h = math.pi / 2
SCENES = {
    "eight, alternating": (8, (1.0,) * 8, (-math.pi, -h, math.pi, h) * 2, 4),
    "six, mountains and valleys": (6, (1.0, 2.0) * 3, (1.0, -0.5) * 3, 6),
    "six, all alike": (6, (1.0,) * 6, (0.5,) * 6, 12),
    "six, flat at rest": (6, (1.0,) * 6, (0.0,) * 6, 24),
    "six, none": (6, (1.0, 2.0, 3.0, 4.0, 5.0, 6.0), (0.5,) * 6, 1),
}


@pytest.mark.parametrize("name", SCENES)
def test_images_close_have_equal_energy_and_are_as_admissible(name: str) -> None:
    n, stiffness, rest, count = SCENES[name]
    model = Model(Scene(Vertex((2 * math.pi / n,) * n), stiffness, rest, "none", "full"))
    assert len(model.own_symmetries) == count
    x, residual = project(model, np.random.default_rng(0).uniform(-2, 2, (40, n)))
    x = x[(residual < 1e-13) & (np.abs(x) < math.pi).all(axis=1)]
    assert len(x) > 10
    for order, sign in model.own_symmetries:
        y = sign * x[:, order]
        assert np.abs(model.closure(y)[0]).max() < 1e-12
        assert np.abs(model.energies(y) - model.energies(x)).max() < 1e-11
        assert [not model.refuses(a) for a in y] == [not model.refuses(a) for a in x]
    assert not model.loaded(np.arange(n) + 0.5).own_symmetries[1:]
