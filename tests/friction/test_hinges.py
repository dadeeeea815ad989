"""Regions that dry friction holds: by sliding along a closed form until it sticks, and by minima of tilted energies."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.errors import OptionError
from tests.computed_once import thinned
from tests.independent import scan_four
from tests.independent.search_slsqp import closure

SECTORS = (70.0, 80.0, 120.0, 90.0)


def drawn(seed):
    rng = np.random.default_rng(seed)
    k, rest = np.exp(rng.normal(size=4)), rng.uniform(-2, 2, 4)
    return Scene(Vertex.from_degrees(SECTORS), tuple(k), tuple(rest), "none")


def stuck(scene, most, phi, ahead):
    """Slide towards a minimum from far on one side until friction holds: fold angles [4]; steps of 3e-5 rad."""
    angle = np.linspace(-np.pi + 1e-6, np.pi - 1e-6, 200_001)
    both = np.split(scan_four._with_first_given(np.radians(SECTORS), angle), 2)
    x = min(both, key=lambda b: np.abs(b - phi).max(axis=1).min())
    j = int(np.abs(x - phi).max(axis=1).argmin())
    energy = (0.5 * np.array(scene.stiffness) * (x - scene.rest_angles) ** 2).sum(axis=1)
    fall, taken = np.diff(energy), np.abs(np.diff(x, axis=0)) @ most
    moves = np.abs(fall) > taken  # a step that releases more than friction takes
    while not moves[j if ahead else j - 1]:
        j += 1 if ahead else -1
    return x[j]


@pytest.mark.parametrize("seed", thinned([2, 3, 5, 9], 2))
def test_one_freedom_is_held_where_sliding_sticks(seed):
    scene = drawn(seed)
    most = 0.05 * np.array([1.0, 0.5, 2.0, 1.0])
    found = o.find_friction(o.find_minima(scene, prove=False, escape=False), most.tolist(), state=1)
    (region,) = found.regions
    assert [why for _, why in region.exact] == ["friction is overcome"] * 2
    phi = np.array(region.minimum.fold_angles)
    ours = sorted(p for p, _ in region.exact)
    theirs = sorted(stuck(scene, most, phi, ahead).tolist() for ahead in (True, False))
    assert np.abs(np.subtract(ours, theirs)).max() < 2e-4
    # to first order: the error falls as the square of the torque
    small = o.find_friction(found.result, (most / 20).tolist(), state=1).regions[0]
    ends = np.array([p for p, _ in small.exact])
    width = np.ptp(ends, axis=0).max()
    assert np.abs(ends.min(axis=0) - small.low).max() < 0.5 * width**2 + 1e-9
    assert np.abs(ends.max(axis=0) - small.high).max() < 0.5 * width**2 + 1e-9


SECTORS_5 = (55.0, 70.0, 65.0, 80.0, 90.0)


def five(**more):
    rng = np.random.default_rng(7)
    k, rest = np.exp(0.5 * rng.normal(size=5)), rng.uniform(-1.2, 1.2, 5)
    vertex = Vertex.from_degrees(SECTORS_5)
    return Scene(vertex, tuple(k), tuple(rest), "none", contact="fold-limits", **more)


def reached(scene, phi, most, count=12):
    """Least and largest fold angles at minima of U + f . phi, of corners f of the box: SLSQP, closure of the tests'."""
    k, rest, a = np.array(scene.stiffness), np.array(scene.rest_angles), np.radians(SECTORS_5)
    limits = np.array(scene.limits or ((-np.pi, np.pi),) * 5)
    ends = []
    for f in most * np.random.default_rng(1).choice([-1.0, 1.0], (count, 5)):
        found = minimize(
            lambda x, f=f: 0.5 * k @ (x - rest) ** 2 + f @ (x - phi), phi, method="SLSQP",
            jac=lambda x, f=f: k * (x - rest) + f, bounds=limits,
            constraints={"type": "eq", "fun": lambda x: closure(a, x)[1:]},
            options={"ftol": 1e-15, "maxiter": 300},
        )  # fmt: skip
        if found.success and np.abs(found.x - phi).max() < 0.1:
            ends.append(found.x)
    assert len(ends) > 0.7 * count  # SLSQP alone stops early now and then
    return np.array(ends)


def test_several_freedoms_reach_what_tilted_energies_reach():
    scene, most = five(), 2e-3
    found = o.find_friction(o.find_minima(scene, prove=False, escape=False), most, state=1)
    (region,) = found.regions
    assert len(region.modes) == 2 and region.exact is None
    phi = np.array(region.minimum.fold_angles)
    ends = reached(scene, phi, most, 32)
    width = np.ptp(ends, axis=0).max()
    assert width > 1e-4
    assert (ends > np.array(region.low) - width**2 - 2e-6).all()
    assert (ends < np.array(region.high) + width**2 + 2e-6).all()
    # 32 draws of 32 corners: half of the reach at least is met
    assert (np.ptp(ends, axis=0) > 0.5 * np.subtract(region.high, region.low)).all()


def test_a_stop_that_pushes_is_kept_and_one_that_hardly_does_is_not_left():
    free = o.find_minima(five(), prove=False, escape=False).minima[0].fold_angles
    i = int(np.argmax(np.abs(free)))
    limits = [[-np.pi, np.pi]] * 5
    side = 1 if free[i] > 0 else 0
    # how far the stop is within the free minimum: what it must push goes with it
    for inside in (0.2, 1e-3):
        limits[i] = [-np.pi, np.pi]
        limits[i][side] = free[i] - np.sign(free[i]) * inside
        scene = five(limits=tuple(map(tuple, limits)))
        result = o.find_minima(scene, prove=False, escape=False)
        near = min(result.minima, key=lambda m: np.abs(np.subtract(m.fold_angles, free)).max())
        number = result.minima.index(near) + 1
        most = 5e-3
        (region,) = o.find_friction(result, most, state=number).regions
        assert region.held and len(region.modes) == 1
        assert region.low[i] == region.high[i] == pytest.approx(limits[i][side], abs=1e-9)
        ends = reached(scene, np.array(near.fold_angles), most)
        on = np.abs(ends[:, i] - limits[i][side]) < 1e-7
        assert on.all() if inside == 0.2 else on.any() and not on.all()
        width = np.subtract(region.high, region.low).max()
        assert (ends[on] > np.array(region.low) - width**2 - 3e-6).all()
        assert (ends[on] < np.array(region.high) + width**2 + 3e-6).all()


def test_friction_of_no_torque_leaves_points_and_more_torque_more():
    result = o.find_minima(drawn(3), prove=False, escape=False)
    width = [
        np.subtract(r.high, r.low).max()
        for r in (o.find_friction(result, t, state=1).regions[0] for t in (1e-9, 0.01, 0.02))
    ]
    assert width[0] < 1e-8 and width[2] == pytest.approx(2 * width[1])
    only = o.find_friction(result, {2: 0.01}, state=1).regions[0]
    assert np.subtract(only.high, only.low).max() < width[1]


def test_what_is_refused():
    result = o.find_minima(drawn(3), prove=False, escape=False)
    with pytest.raises(OptionError, match="torque of crease 2"):
        o.find_friction(result, {2: -1.0})
    with pytest.raises(OptionError, match="state"):
        o.find_friction(result, 0.1, state=99)
