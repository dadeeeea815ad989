"""A descent that ends where a corner lies on a corner: more than a hundred choices meet, too many to be listed."""

import math
from functools import cache

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.kkt import project
from origami_nlp.kkt.choices import Choices
from origami_nlp.pattern_problem import PatternProblem, choices, without_passing

PRESSED = [
    -2.331612372844, -2.751278626491, 2.673477596616, -1.918457257182, -1.811938470404,
    1.495417962439, -1.813620435504, -1.653634383231, 1.853341851247, -2.721261083745,
    2.043505764134, -2.105111888116, -1.416086989552, 0.821686234229, -1.685311327102,
    -2.119641567579, 2.302080274209, -2.579275077539, -1.968291234041, 1.189806297996,
    -1.642180860566, 3.141592653590, -1.463894213642, -1.997524601995, 2.939527352171,
    -2.117398726967, -1.686414972550, 1.398903212495, -1.968291234041, -2.706786186815,
    1.953141245815, -1.736418065388, 2.369222088556, -3.141592653590, -2.591621584925,
    -1.738318595773, -1.974567762085, -1.844074931590, -1.897345352155, -3.077658453831,
]  # fmt: skip
"""Fold angles [rad] of a Yoshimura pattern of random rest angles, folded until corners meet."""


@cache
def pressed():
    pattern = o.examples.pattern("yoshimura", 4, 4)
    rest = np.minimum(np.random.default_rng(3).uniform(2.2, 3.2, pattern.creases), math.pi)
    problem = PatternProblem(pattern.with_springs(1.0, list(pattern.signs * rest)))
    x = problem.fold_limits.clip(
        np.where(np.abs(PRESSED) > 3.1415926, np.sign(PRESSED) * math.pi, PRESSED)
    )
    assert problem.residual(x) < 1e-11 and o.classify(o.State(problem, x)).verdict == "minimum"
    return problem, o.State(problem, x)


def least(rates, choice):
    """The best option's slowest gap, for many directions at once."""
    return np.max([np.min([rates[c] for c in option], axis=0) for option in choice], axis=0)


def test_fewer_choices_leave_the_same_directions():
    """Choices that are left out follow from those that are kept, for random directions."""
    _, state = pressed()
    every = [c for branch in state.contacts.branches for option in branch for c in option]
    slopes = dict(zip(every, state.on(tuple(every)).slopes @ state.kernel, strict=True))
    kept = Choices(state).branches
    assert len(kept) < 40 < 100 < len(state.contacts.branches)
    normals, rng, many = np.array(list(slopes.values())), np.random.default_rng(0), []
    for k in range(600):
        d = rng.normal(size=normals.shape[1])
        some = normals[rng.choice(len(normals), 6)] * rng.choice([1.0, -1.0], (6, 1))
        # across gaps: others hardly ever open one of each choice
        many.append(d if k % 2 else some.T @ rng.uniform(0, 1, 6))
    rates = dict(zip(slopes, normals @ np.array(many).T, strict=True))
    passes, ours = (
        np.min([least(rates, choice) for choice in choices], axis=0) < 0
        for choices in (state.contacts.branches, kept)
    )
    assert (passes == ours).all() and min(passes.sum(), (~passes).sum()) > 5


def test_lower_states_beside_it_cross_by_another_library():
    pytest.importorskip("fcl", reason="python-fcl, of the extra test")
    from tests.independent.rigid import Rigid

    problem, state = pressed()
    body, z, rng, lower = Rigid(problem.pattern), state.kernel, np.random.default_rng(1), 0
    inverse, energy = body.slopes(state.x), float(problem.pattern.energy(state.x))
    down = -z.T @ problem.torque(state.x)
    down /= np.linalg.norm(down)
    for k in range(60):
        way = rng.normal(size=z.shape[1])
        way = way / np.linalg.norm(way) + (k % 3) * 0.5 * down
        phi = body.closed(state.x + 10 ** rng.uniform(-3, -1.5) * z @ way, inverse)
        if phi is None or np.abs(phi).max() > math.pi:
            continue
        if float(problem.pattern.energy(phi)) < energy:
            lower += 1
            assert body.collide(phi)
    assert lower > 7


def test_a_corner_on_the_plane_inside_a_border_passes_through():
    """What choices one by one allow, as its gap is closed for both sides; joined they refuse it, and facets cross."""
    problem, state = pressed()
    found = choices(problem.features, problem.placed(state.x))
    joined = [c for c in without_passing(problem.features, found) if len(c[0]) > 1]
    z, rng, many = state.kernel, np.random.default_rng(0), 0
    for choice in joined[:30]:
        corner = choice[0][0]
        held = problem.contact_of(corner)
        row = state.on((held,)).slopes[0] @ z
        beside = [t for option in choice for t in option[1:]]
        for _ in range(10):
            d = rng.normal(size=len(row))
            d -= (d @ row / (row @ row)) * row
            phi, residual = project(problem, state.x + 1e-4 * z @ d, (held,))
            at = problem.placed(phi)
            if residual <= 1e-12 and max(t.gap(at) for t in beside) < -1e-6:
                assert (
                    abs(corner.gap(at)) < 1e-11
                    and max(min(t.gap(at) for t in option) for option in choice) < 0
                )
                assert any(corner.facets[0] in pair for pair in problem.crossings.find(phi))
                many += 1
    assert joined and many > 5
