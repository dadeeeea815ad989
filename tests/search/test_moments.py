"""The search from moments: what it finds is certified, is what other searches find, and does not depend on labels."""

import math
import time

import numpy as np
import pytest

from origami_nlp import Scene, State, Vertex, find_minima
from origami_nlp.kkt import Solve, classify, polish, project
from origami_nlp.pattern_problem import find_labels, pose
from origami_nlp.search.moment_map import MomentMap
from origami_nlp.search.moments import Moments, find_zeros


def draw(n, seed=0, equal=False):
    rng = np.random.default_rng([seed, n])
    sectors = np.full(n, 2 * math.pi / n) if equal else rng.dirichlet(np.full(n, 3.0)) * 2 * math.pi
    k = np.ones(n) if equal else 10 ** rng.uniform(-1, 1, n)
    rest = rng.uniform(-math.pi, math.pi, n)
    vertex = Vertex(tuple(sectors.tolist()))
    return Scene(vertex, tuple(k.tolist()), tuple(rest.tolist()), "none", "fold-limits")


@pytest.mark.parametrize("n", [4, 6, pytest.param(8, marks=pytest.mark.slow)])
def test_every_minimum_is_a_zero_of_the_map(n):
    compared = 0
    for seed in range(3):
        found = find_minima(draw(n, seed), effort="quick", prove=False, escape=False)
        chain = MomentMap(found.model)
        for minimum in found.minima:
            shot = chain.shoot(np.array([minimum.moment]) / found.model.scale)
            assert np.abs(shot.miss).max() <= 1e-13 * (1 + shot.growth.max() * chain.largest)
            assert np.abs(shot.x[0] - minimum.fold_angles).max() <= 1e-7
            compared += 1
    assert compared >= 6


def zeros_that_are_minima(scene, count, seed):
    """Minima among the zeros that Newton finds from random moments, judged one by one."""
    model = pose(scene)
    starts = Moments(model, find_labels(model.pattern))
    order, sign = starts.map.order, starts.map.sign
    m, miss = find_zeros(starts.map, starts.moments(np.random.default_rng(seed), count))
    x = sign * starts.map.shoot(m[miss < 1e-9]).x[:, np.argsort(order)]
    x = x[np.unique(np.round(x / 1e-6), axis=0, return_index=True)[1]]
    minima = []
    for state in x:
        rows = model.fold_limits.contacts(state, np.abs(state) == math.pi)
        end = polish(model, Solve(state, "", 0, math.nan, np.abs(state) / math.pi), rows)
        if end.converged and classify(State(model, end.x)).verdict == "minimum":
            minima.append(end.x)
    return x, np.array(minima)


@pytest.mark.slow
def test_zeros_and_descents_know_the_same_minima():
    """Newton in three unknowns alone finds most of what the whole search lists at N = 10, and hardly more."""
    scene = draw(10, 2)
    zeros, minima = zeros_that_are_minima(scene, 12_000, 7)
    listed = np.array([m.fold_angles for m in find_minima(scene, prove=False, escape=False).minima])
    assert len(zeros) > len(minima) > 20
    beside = [x for x in minima if np.abs(listed - x).max(axis=1).min() > 1e-6]
    assert len(beside) <= 3  # a search that stops by its rule may have missed some
    share = np.mean([np.abs(minima - x).max(axis=1).min() < 1e-6 for x in listed])
    assert 0.4 < share <= 1


def test_numbering_from_another_crease_changes_nothing():
    scene, start = draw(30), 11
    k = np.roll(np.arange(30), -start)
    springs = (tuple(np.array(s)[k].tolist()) for s in (scene.stiffness, scene.rest_angles))
    vertex = Vertex(tuple(np.array(scene.vertex.sector_angles)[k].tolist()))
    other = Scene(vertex, *springs, "none", "fold-limits")
    one, two = (
        find_minima(s, effort="quick", max_starts=100, prove=False, escape=False)
        for s in (scene, other)
    )
    x, y = (np.array([m.fold_angles for m in r.minima]) for r in (one, two))
    apart = np.abs(x[:, k][:, None] - y).max(axis=2)
    # the same starts, but for rounding, which sends a few on the border of two basins elsewhere
    assert (apart.min(axis=0) < 1e-8).mean() > 0.8
    assert (apart.min(axis=1) < 1e-8).mean() > 0.8
    assert len(one.minima) > 5
    for state in x[:, k][apart.min(axis=1) >= 1e-8]:  # and these are minima there as well
        assert classify(State(two.model, state)).verdict == "minimum"


def test_same_seed_same_answer():
    a, b = (
        find_minima(draw(28), effort="quick", max_starts=60, seed=3, prove=False, escape=False)
        for _ in range(2)
    )
    assert [m.fold_angles for m in a.minima] == [m.fold_angles for m in b.minima]
    assert a.search.by_source == b.search.by_source
    assert a.search.by_source["moments"] > 0


def verify(result):
    """Each minimum closes, balances, and no closed neighbour that is drawn is lower."""
    scene, model, rng = result.scene, result.model, np.random.default_rng(0)
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    verified = 0
    for minimum in result.minima:
        x = np.array(minimum.fold_angles)
        value, jacobian = model.constraints(x)
        assert model.lifts_to_one(x)
        assert np.abs(value).max() < 1e-12
        assert (np.abs(x) <= math.pi).all()
        free = np.abs(x) < math.pi - 1e-3
        if minimum.moment is None:  # too few creases are free to say which moment passes round
            assert np.linalg.matrix_rank(jacobian[:, free], tol=1e-7) < 3
            assert minimum.kind == "degenerate" and len(minimum.certificate) > 20
            continue  # neighbours cannot be drawn by a projection: closure loses rank
        verified += 1
        left = k * (x - rest) - 2 * jacobian.T @ np.array(minimum.moment)
        assert np.abs(left[free]).max() <= 1e-9 * (1 + np.abs(minimum.moment).max())
        assert (np.sign(x[~free]) * left[~free] <= 1e-9).all()
        move = 1e-3 * rng.normal(size=(12, len(x))) / math.sqrt(len(x))
        opens = rng.random(move.shape) < min(0.5, 5 / len(x))
        inward = -np.sign(x) * (np.abs(move) + 3e-4) * opens
        y = x + np.where(free, move, inward)
        y, residual = project(model, y, frozen=np.abs(y) == math.pi, steps=6)
        good = (residual < 1e-12) & (np.abs(y) <= math.pi).all(axis=1)
        assert good.any()
        assert all(model.energy_change(x, state) > 0 for state in y[good])
    assert verified >= 0.7 * len(result.minima)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("n", "equal"), [(30, True), pytest.param(100, False, marks=pytest.mark.slow), (300, True)]
)
def test_long_vertices_are_searched_in_bounded_time(n, equal):
    begin = time.process_time()
    result = find_minima(
        draw(n, equal=equal), effort="quick", max_starts=40, prove=False, escape=False
    )
    assert time.process_time() - begin < 60
    assert len(result.minima) >= 5
    assert not result.search.undecided
    assert all((m.solver is None) == (n > 40) for m in result.minima)
    verify(result)


@pytest.mark.slow
@pytest.mark.parametrize("equal", [False, True])
def test_a_thousand_creases(equal):
    begin = time.process_time()
    result = find_minima(
        draw(1000, equal=equal), effort="quick", max_starts=20, prove=False, escape=False
    )
    assert time.process_time() - begin < 240
    assert len(result.minima) >= 3
    verify(result)
