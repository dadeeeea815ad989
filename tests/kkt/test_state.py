"""A state and a stratum: derivatives against differences, and one state against many."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from origami_nlp import Model, Scene, State, Vertex, examples, find_minima
from origami_nlp.kkt import newton, project
from tests.computed_once import panel_result

SCENES = {
    "wedge": examples.degree6("pi/3", 1),
    "two mirrors": examples.degree8("pi/6", 1),
    "free": examples.degree6("pi/4", 100, symmetry="none"),
    "rotation": Scene(Vertex((math.pi / 3,) * 6), (1.0, 2.0) * 3, (0.4, -0.3) * 3, symmetry="C3"),
    "no contact": examples.degree6("pi/3", 1, contact="none"),
}


def some_state(model: Model, seed: int = 0) -> np.ndarray:
    x = np.random.default_rng(seed).uniform(-1.5, 1.5, model.size)
    y, residual = project(model, x)
    assert residual < 1e-13
    return y


@pytest.mark.parametrize("name", SCENES)
def test_derivatives_are_those_of_the_values(name: str) -> None:
    model = Model(SCENES[name]).loaded(np.linspace(-0.2, 0.3, Model(SCENES[name]).size))
    x = some_state(model)
    contacts = (*model.limits[:2], *model.every_gap[:3])
    rng = np.random.default_rng(1)
    weights = rng.normal(size=model.equation_count + len(contacts))

    def lagrangian(y: np.ndarray) -> float:
        return model.energy(y) / model.scale - float(weights @ model.constraints(y, contacts)[0])

    h = 1e-4
    _, jac = model.constraints(x, contacts)
    slope = model.local(x).gradient - jac.T @ weights
    hessian = model.lagrangian_hessian(x, weights, contacts)
    for _ in range(4):
        d = rng.normal(size=model.size)
        d /= np.linalg.norm(d)
        ahead, here, behind = (lagrangian(x + s * h * d) for s in (1, 0, -1))
        assert (ahead - behind) / (2 * h) == pytest.approx(slope @ d, abs=1e-6)
        assert (ahead - 2 * here + behind) / h**2 == pytest.approx(d @ hessian @ d, abs=1e-4)


@pytest.mark.parametrize("name", SCENES)
def test_many_states_are_as_each_of_them(name: str) -> None:
    model = Model(SCENES[name])
    x = np.random.default_rng(2).uniform(-3, 3, (5, model.size))
    contacts = (*model.limits[:3], *model.every_gap[:4])
    weights = np.random.default_rng(3).normal(size=(5, model.equation_count + len(contacts)))
    many = model.local(x)
    f, jac = model.constraints(x, contacts)
    hessians = model.lagrangian_hessian(x, weights, contacts)
    moved, left = project(model, x, contacts[:1])
    admissible = model.admissible(moved)
    for k in range(5):
        one = model.local(x[k])
        for field in ("gradient", "closure", "closure_jacobian", "gaps", "gaps_jacobian"):
            assert getattr(many, field)[k] == pytest.approx(getattr(one, field), abs=1e-14)
        g, a = model.constraints(x[k], contacts)
        assert f[k] == pytest.approx(g, abs=1e-14) and jac[k] == pytest.approx(a, abs=1e-14)
        h = model.lagrangian_hessian(x[k], weights[k], contacts)
        assert hessians[k] == pytest.approx(h, abs=1e-12)
        alone, residual = project(model, x[k], contacts[:1])
        if max(residual, left[k]) <= 1e-12:
            assert moved[k] == pytest.approx(alone, abs=1e-9)
            # layers are ordered for one state only
            assert admissible[k] or model.refuses(alone)
    none = model.local(x[:0])
    assert none.gaps_jacobian.shape == (0, len(model.every_gap), model.size)


def test_a_stratum_is_what_the_minima_say() -> None:
    for panel in examples.panels()[3:6]:
        result = panel_result(panel)
        for m in result.minima:
            state = State(result.model, result.model.reduce(np.array(m.fold_angles)))
            again = pickle.loads(pickle.dumps(state))
            assert (again.x == state.x).all() and again.residual == state.residual
            assert state.refused == "" and state.energy == pytest.approx(m.energy)
            if m.kind in ("interior", "contact-pinned"):
                at = state.on(state.pieces[0])
                assert np.abs(at.imbalance).max() < 1e-12
                moments = (
                    at.forces * result.model.scale / [result.model.weight(c) for c in at.contacts]
                )
                assert moments == pytest.approx([c.multiplier for c in m.contacts], rel=1e-9)
                stiffness = at.stiffness * result.model.scale
                assert stiffness == pytest.approx(min(m.hessian_eigenvalues), rel=1e-9)


def test_a_load_moves_the_minimum_as_its_response_says() -> None:
    result = find_minima(examples.degree6("pi/4", 1), max_starts=16, prove=False, escape=False)
    model = result.model
    x = model.reduce(np.array(result.minima[0].fold_angles))
    _, motion = State(model, x).on().response()
    load = 1e-5 * np.linspace(-1, 1, model.size)
    moved, _ = newton(model.loaded(model.root * load), x, ())
    assert moved is not None and moved.converged
    assert model.root * (moved.x - x) == pytest.approx(motion @ load, abs=1e-8)
