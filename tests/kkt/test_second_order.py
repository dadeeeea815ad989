"""Closure to second order as a certificate: where closure loses rank, which directions are left."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.optimize import nnls

from origami_nlp import Scene, State, Vertex, classify, find_minima
from origami_nlp.kkt.second_order import (
    extreme_rays,
    generators,
    has_no_level_direction,
    level_directions,
)
from origami_nlp.pattern_problem import pose
from tests.independent.rotations import fold, project


def sampled(form: np.ndarray, rows: np.ndarray, rng: np.random.Generator) -> tuple[float, float]:
    """Return the range of d' Q d over random unit directions of the cone rows d >= 0."""
    d = rng.normal(size=(40_000, rows.shape[1]))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    d = d[(d @ rows.T >= 0).all(axis=1)]
    values = np.einsum("ki,ij,kj->k", d, form, d)
    return float(values.min(initial=math.inf)), float(values.max(initial=-math.inf))


@given(st.integers(0, 10**6), st.integers(1, 4), st.integers(0, 6))
def test_what_is_shown_agrees_with_random_directions(seed: int, t: int, r: int) -> None:
    rng = np.random.default_rng(seed)
    form = rng.normal(size=(t, t))
    form = (form + form.T) / 2 + rng.uniform(-2, 2) * np.eye(t)
    rows = rng.normal(size=(r, t))
    if has_no_level_direction([form], rows):
        low, high = sampled(form, rows, rng)
        assert low > 0 or high < 0 or low == math.inf


def test_a_form_that_vanishes_on_the_cone_is_never_enough() -> None:
    rows = np.eye(2)
    assert not has_no_level_direction([np.array([[0.0, 1.0], [1.0, 0.0]])], rows)  # d = e1
    assert not has_no_level_direction([np.diag([1.0, -1.0])], rows)  # d = (1, 1)
    assert has_no_level_direction([np.diag([1.0, -1.0])], np.array([[0.0, 1.0], [1.0, -2.0]]))
    assert has_no_level_direction([np.array([[1.0, 3.0], [3.0, 1.0]])], rows)
    assert not has_no_level_direction([np.array([[1.0, -3.0], [-3.0, 1.0]])], rows)
    assert not has_no_level_direction([], rows)


@pytest.mark.parametrize("seed", range(6))
def test_the_flat_state_of_a_rigid_vertex_is_certified(seed: int) -> None:
    """Three creases cannot move: the spherical triangle of a great circle has no neighbour."""
    rng = np.random.default_rng(seed)
    sectors = 2 * math.pi * (0.1 + 0.7 * rng.dirichlet(np.ones(3) * 8))
    sectors = sectors * 2 * math.pi / sectors.sum()
    if sectors.max() >= math.pi:
        pytest.skip("a sector of pi or more")
    scene = Scene(Vertex(tuple(sectors.tolist())), rng.uniform(0.1, 9, 3), rng.uniform(-3, 3, 3))
    (flat,) = find_minima(scene, prove=False, escape=False).minima
    assert (
        flat.fold_angles == (0.0, 0.0, 0.0) and "closure leaves to second order" in flat.certificate
    )


def listed_rays(rows: np.ndarray) -> np.ndarray:
    """Extreme rays from every choice of t - 1 rows: the kernel of each, where it lies in the cone."""
    t = rows.shape[1]
    found: list[np.ndarray] = []
    for subset in itertools.combinations(range(len(rows)), t - 1):
        _, s, vt = np.linalg.svd(rows[list(subset)])
        for d in (vt[-1], -vt[-1]):
            alone = s[-1] > 1e-9 and (rows @ d >= -1e-9).all()
            if alone and all(np.abs(d - known).max() > 1e-7 for known in found):
                found.append(d)
    return np.array(found).reshape(-1, t)


@pytest.mark.parametrize("seed", range(60))
def test_rays_are_those_of_every_choice_of_rows(seed: int) -> None:
    """Whole numbers, so that many rows meet in one ray; some repeated."""
    rng = np.random.default_rng(seed)
    t = int(rng.integers(2, 5))
    rows = rng.integers(-2, 3, (int(rng.integers(t, t + 6)), t)).astype(float)
    rows = np.vstack([rows[np.abs(rows).max(axis=1) > 0], np.eye(t)])
    rays, expected = extreme_rays(rows), listed_rays(rows)
    assert rays is not None and len(rays) == len(expected)
    assert all(np.abs(expected - d).max(axis=1).min() < 1e-9 for d in rays)
    assert extreme_rays(np.eye(t)[:-1]) is None  # holds a line


@pytest.mark.parametrize("seed", range(20))
def test_level_directions_lie_in_the_cone_and_the_form_vanishes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    t = int(rng.integers(2, 6))
    form = rng.normal(size=(t, t))
    form = form + form.T
    d = level_directions(form, np.eye(t))
    assert (d >= 0).all()
    assert np.abs(np.einsum("ki,ij,kj->k", d, form, d)).max(initial=0.0) < 1e-12
    mixed = [
        k for k in itertools.combinations(range(t), 2) if form[k[0], k[0]] * form[k[1], k[1]] < 0
    ]
    assert len(d) >= len(mixed)  # where the form changes sign between two rays, it vanishes there


@pytest.mark.parametrize("seed", range(20))
def test_generators_of_a_cone_with_lines(seed: int) -> None:
    """All lie in it, and every direction of it is a sum of them with positive factors."""
    rng = np.random.default_rng(seed)
    t = int(rng.integers(2, 6))
    rows = rng.normal(size=(int(rng.integers(1, t)), t))
    found = generators(rows)
    assert found is not None and (found @ rows.T > -1e-9).all()
    for d in rng.normal(size=(200, t)):
        if (rows @ d >= 0).all():
            factors, left = nnls(found.T, d)
            assert left < 1e-9 and (factors >= 0).all()


@pytest.mark.parametrize("off", [0.0, 1.3e-13, -1.3e-13, 1e-12])
def test_a_fold_limit_that_moves_to_second_order_alone_holds_nothing(off):
    """Six equal sectors folded in half about creases 3 and 6, which are -pi: crease 3 can open, crease 6 then opens to
    second order.  A torque of 0.3 N m opens crease 3; beside the state the slope of crease 6 is 1e-13, not 0."""
    x = np.array([1.0, off, -math.pi, -off, -1.0, -math.pi])
    torque = np.array([-0.3, -0.07, -0.3, -0.07, -0.3, -1.1])
    scene = Scene(Vertex(("pi/3",) * 6), (1,) * 6, tuple(x - torque), "none", "fold-limits")
    found = classify(State(pose(scene), x))
    assert found.verdict == "not stationary"
    # states beside it by closure alone: the energy falls in proportion to the distance
    rng, sectors = np.random.default_rng(0), np.full(6, math.pi / 3)
    for radius in (1e-3, 1e-4):
        y = np.clip(x + radius * rng.normal(size=(2_000, 6)) / 2.5, -math.pi, math.pi)
        y, residual = project(sectors, np.arange(6), y, np.zeros(6, bool))
        inside = (residual < 1e-13) & (np.abs(y) <= math.pi).all(axis=1)
        inside &= np.abs(y - x).max(axis=1) < 4 * radius
        change = ((y - x) * (0.5 * (y - x) + torque)).sum(axis=1)
        assert change[inside].min() < -0.03 * radius


@pytest.mark.parametrize("turns", [(0, 0, 0, 0), (2, 2, -2, 2), (2, -2, -2, 2), (2, 2, 2, 2)])
def test_what_is_folded_by_whole_turns_is_judged_as_what_is_flat(turns: tuple[int, ...]) -> None:
    vertex = Vertex(tuple(map(math.radians, (60, 100, 152, 48))))
    scene = Scene(vertex, (3.6, 0.2, 0.2, 3.2), (-2.0, 1.6, 0.5, 2.8), "none", "none")
    problem = pose(scene)
    state = State(problem, math.pi * np.array(turns, float))
    found = classify(state)
    assert state.residual < 1e-14 and found.verdict == "not stationary"
    # the witness closes and is lower, by rotations alone and by the springs
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    energies = [k @ (x - rest) ** 2 / 2 for x in (state.x, found.lower)]
    assert energies[1] < energies[0] and np.abs(found.lower - state.x).max() < 0.1
    product = fold(vertex.sector_angles, found.lower)[1][0]
    assert np.abs(product - np.eye(3)).max() < 1e-9
