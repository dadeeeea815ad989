"""Symmetry on the wedge against the whole vertex, for groups made by construction."""

import math

import numpy as np
from hypothesis import given, settings, strategies as st

from origami_nlp import Scene
from origami_nlp.pattern_problem import pose
from tests.independent.neighbours import Problem
from tests.independent.rotations import fold, project
from tests.independent.scenes import SHAPES, build

derandomized = settings(derandomize=True, max_examples=25, database=None)
cases = st.tuples(st.sampled_from(SHAPES), st.integers(0, 2**32 - 1))


def scene_of(case):
    shape, seed = case
    rng = np.random.default_rng(seed)
    return shape, build(rng, shape), rng


def auto(scene: Scene) -> Scene:
    return Scene(scene.vertex, scene.stiffness, scene.rest_angles, "auto", scene.contact)


def is_symmetric(scene: Scene, shift: int, mirror: bool) -> bool:
    """Whether crease i -> i + shift (or shift - i) keeps directions, springs and rest angles."""
    n, a = scene.degree, scene.vertex.azimuths
    image = (shift - np.arange(n)) % n if mirror else (np.arange(n) + shift) % n
    turn = np.exp(1j * (a[image] + a if mirror else a[image] - a))  # one angle for all creases
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    return bool(
        np.abs(turn - turn[0]).max() < 1e-8
        and np.allclose(k[image], k, rtol=1e-8)
        and np.allclose(rest[image], rest, atol=1e-8)
    )


@derandomized
@given(cases)
def test_auto_finds_at_least_the_group_of_construction(case):
    shape, scene, _ = scene_of(case)
    found, n = auto(scene).group, scene.degree
    assert found.order % shape[1] == 0
    assert found.kind == "D" or shape[0] == "C"
    # and exactly the group that a look at all rotations and reflections of the sheet finds
    turns = sum(is_symmetric(scene, s, False) for s in range(n))
    mirrors = sum(is_symmetric(scene, s, True) for s in range(n))
    assert found.order == turns and mirrors == (turns if found.kind == "D" else 0)


@derandomized
@given(cases)
def test_orbits_are_those_of_the_group(case):
    shape, scene, _ = scene_of(case)
    orbit, n = np.array(scene.group.orbit), scene.degree
    step = n // shape[1]
    assert (orbit == np.roll(orbit, -step)).all()
    if shape[0] == "D":
        maps = [s for s in range(n) if is_symmetric(scene, s, True)]
        assert any((orbit[(s - np.arange(n)) % n] == orbit).all() for s in maps)
        inner, ends = shape[2], sum(shape[3])
        assert len(set(orbit.tolist())) == inner + ends
        counts = sorted(np.bincount(orbit)[np.unique(orbit)].tolist())
        assert counts == [shape[1]] * ends + [2 * shape[1]] * inner
    else:
        assert len(set(orbit.tolist())) == step


@derandomized
@given(cases)
def test_reduced_energy_is_the_energy_of_the_whole_state(case):
    _, scene, rng = scene_of(case)
    model = pose(scene)
    x, y = rng.uniform(-math.pi, math.pi, (2, model.size))
    phi = model.expand(x)
    assert np.allclose(model.reduce(phi), x, rtol=0, atol=1e-15)
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    whole = float(0.5 * np.sum(k * (phi - rest) ** 2))
    assert math.isclose(model.energy(x), whole, rel_tol=1e-13)
    assert math.isclose(scene.energy(phi), whole, rel_tol=1e-13)
    change = scene.energy(model.expand(y)) - whole
    assert math.isclose(model.energy_change(x, y), change, abs_tol=1e-12 * whole + 1e-12)


@derandomized
@given(cases)
def test_symmetric_states_fold_symmetrically(case):
    """The deformed creases of a symmetric closed state have the group, as a set of directions."""
    shape, scene, rng = scene_of(case)
    p = Problem.of(scene)
    x, residual = project(p.sectors, p.orbit, rng.uniform(-2, 2, (6, p.size)))
    creases, _ = fold(p.sectors, x[residual <= 1e-13][:, p.orbit])
    gram = creases @ creases.transpose(0, 2, 1)
    step = scene.degree // shape[1]
    assert np.allclose(np.roll(gram, (step, step), axis=(1, 2)), gram, atol=1e-11)
