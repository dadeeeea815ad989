"""Families of scenes: the same on every machine, and what their names promise."""

import itertools
import math

import numpy as np
import pytest

from benchmarks import FAMILIES, family_scene
from benchmarks.designed import FARTHEST_REST, SOFTEST, design, interior_states
from benchmarks.families import design_of
from benchmarks.problems import random_vertex
from origami_nlp.kkt import State, classify
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model
from tests.independent.rotations import fold


@pytest.mark.parametrize("family", FAMILIES)
def test_scenes_repeat_and_differ(family):
    first = [family_scene(family, k) for k in range(4)]
    assert first == [family_scene(family, k) for k in range(4)]
    assert all(a != b for a, b in itertools.pairwise(first))
    assert [s.name for s in first] == [f"{family} {k + 1}" for k in range(4)]


@pytest.mark.parametrize(
    ("family", "degrees", "contact"),
    [
        ("fold-limits", range(4, 9), "fold-limits"),
        ("large", (9, 10), "fold-limits"),
        ("full-contact", range(4, 9), "full"),
    ],
)
def test_generic_families(family, degrees, contact):
    scenes = [family_scene(family, k) for k in range(30)]
    assert {s.degree for s in scenes} == set(degrees)
    assert {s.contact for s in scenes} == {contact}
    k = np.log10(np.concatenate([s.stiffness for s in scenes]))
    assert k.min() < -0.9 and k.max() > 0.9 and np.abs(k).max() <= 1


@pytest.mark.parametrize("number", range(6))
def test_designed_springs_hold_two_states(number):
    """Balance and stability of both, by finite differences along curves of an own closure."""
    scene, states = design_of(number)
    vertex, n, rng = scene.vertex, scene.degree, np.random.default_rng(number)
    model = Model(scene)
    for x in states:
        what = classify(State(model, x))
        assert (what.verdict, what.kind) == ("minimum", "interior")
        product = fold(np.array(vertex.sector_angles), x)[1][0]
        assert np.abs(product - np.eye(3)).max() < 1e-12
        lower = 0
        for direction in rng.normal(size=(40, n)):
            step = 1e-3 * direction / np.linalg.norm(direction)
            y = _closed(vertex, x + step)
            lower += scene.energy(y) < scene.energy(x)
        assert lower == 0
    assert min(scene.stiffness) >= 0.049 * np.mean(scene.stiffness)
    assert np.abs(scene.rest_angles).max() <= 3 + 1e-9


def _closed(vertex, x):
    """Newton with a Jacobian by finite differences of the independent product of rotations."""
    sectors, n = np.array(vertex.sector_angles), len(x)

    def residual(y):
        f = fold(sectors, y)[1]
        f = f.reshape(-1, 3, 3)
        return np.stack(
            [f[:, 2, 1] - f[:, 1, 2], f[:, 0, 2] - f[:, 2, 0], f[:, 1, 0] - f[:, 0, 1]], axis=1
        )

    for _ in range(6):
        h = 1e-6
        both = np.concatenate([x + h * np.eye(n), x - h * np.eye(n), x[None]])
        r = residual(both)
        jacobian = ((r[:n] - r[n : 2 * n]) / (2 * h)).T
        x = x - np.linalg.pinv(jacobian) @ r[-1]
    return x


def test_where_no_design_is_found_random_multipliers_hold_nothing_either():
    refused = 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        vertex = random_vertex(rng, 5, "fold-limits").vertex
        unit = Scene(vertex, (1.0,) * 5, (0.0,) * 5, "none", "fold-limits")
        one, two = interior_states(unit, rng)
        if design(unit, [one, two]) is not None:
            continue
        refused += 1
        j1, j2 = (Model(unit).closure(x)[1] for x in (one, two))
        lam = rng.normal(size=(2, 20_000, 3))
        k = (lam[0] @ j1 - lam[1] @ j2) / (one - two)
        good = k.min(axis=1) >= SOFTEST * k.mean(axis=1)
        rest = one - lam[0] @ j1 / k
        good &= np.abs(rest).max(axis=1) <= FARTHEST_REST
        for stiffness, r in zip(k[good], rest[good], strict=True):
            scene = Scene(vertex, stiffness, r, "none", "fold-limits")
            kinds = [classify(State(Model(scene), x)).verdict for x in (one, two)]
            assert kinds != ["minimum", "minimum"]
    assert refused >= 2


def test_the_cross_has_six_states_in_closed_form():
    """Each of its six lines of states has one lowest state, where the two springs that fold along it balance."""
    from origami_nlp import find_minima

    scene = family_scene("one-dof", 2)
    k, r = np.array(scene.stiffness), np.array(scene.rest_angles)
    expected = []
    for a, b in ((0, 2), (2, 0), (1, 3), (3, 1)):
        c, d = (a + 1) % 4, (a + 3) % 4
        if a < b:  # folded along one line, the other flat
            x = np.zeros(4)
            x[a] = x[b] = (k[a] * r[a] + k[b] * r[b]) / (k[a] + k[b])
            expected.append(x)
        x = np.zeros(4)  # fully folded along it, to either side: the other line folds both layers
        side = math.pi if a < b else -math.pi
        x[a] = x[b] = side
        x[c] = (k[c] * r[c] - k[d] * r[d]) / (k[c] + k[d])
        x[d] = -x[c]
        expected.append(x)
    found = np.array([m.fold_angles for m in find_minima(scene, escape=False).minima])
    far = np.abs(np.array(expected)[:, None] - found).max(axis=2)
    assert len(found) == 6 and far.min(axis=1).max() < 1e-9
