"""Closed forms for many states at once, against CasADi's derivatives of symbols and against finite differences."""

import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex
from origami_nlp.problem import Kinematics, Model

ROUNDING = 2e-13  # third derivatives of products of up to 16 turns, over sines of sectors


def scenes():
    rng = np.random.default_rng(0)
    for n in (4, 5, 8):
        s = rng.uniform(0.5, 1.5, n)
        yield Scene(Vertex(tuple(s * 2 * math.pi / s.sum())), (1,) * n, (0,) * n, symmetry="none")
    cone = tuple(rng.uniform(0.3, 1.0, 6))
    yield Scene(Vertex(cone, flat=False), (1,) * 6, (0,) * 6, symmetry="none")


@pytest.mark.parametrize("scene", list(scenes()), ids=lambda s: f"{s.group.name}-{s.degree}")
def test_values_and_derivatives_are_those_of_the_symbols(scene):
    model, rng = Model(scene), np.random.default_rng(1)
    kinematics, many = Kinematics(model), len(model.structure.gaps)
    x = rng.uniform(-3, 3, (20, model.size))
    at, local = kinematics.fold(x), model.local(x)
    value, jacobian = kinematics.closure(at)
    assert np.abs(value - local.closure).max() <= ROUNDING
    assert np.abs(jacobian - local.closure_jacobian).max() <= ROUNDING
    lam, none = rng.normal(size=local.closure.shape), np.zeros((20, many))
    hessian = kinematics.closure_hessian(at, lam)
    assert np.abs(hessian - model.hessian(x, lam, none, 0.0)).max() <= ROUNDING
