"""Barriers of vertices with two and more degrees of freedom: paths and bounds, by closure and floods of their own."""

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.barriers.find import PROVED
from origami_nlp.pattern_problem import pose
from tests.independent.links import corners, crosses


def drawn(degree, seed, **more):
    """A vertex with random sectors and springs, and these as arrays."""
    rng = np.random.default_rng(seed)
    sectors = rng.dirichlet(np.full(degree, 6.0)) * 2 * math.pi
    stiffness, rest = rng.uniform(0.2, 2, degree), rng.uniform(-3, 3, degree)
    vertex = o.Vertex(tuple(sectors))
    return o.Scene(vertex, tuple(stiffness), tuple(rest), symmetry="none", **more)


def checked(found, crossing=True):
    """Each path closes, stays within limits, goes in short steps from end to end, and no higher than is said.

    Without `crossing` no facets cross on it, nor touch, between minima in which none touch.
    """
    scene, seen = found.result.scene, 0
    sectors, k = np.array(scene.vertex.sector_angles), np.array(scene.stiffness)
    for p in found.passes:
        assert math.isinf(p.energy) == (not len(p.path))
        if math.isinf(p.energy):
            continue
        seen += 1
        ends = [found.result.minima[n - 1] for n in (p.from_state, p.to_state)]
        apart = crossing or any(m.kind != "interior" for m in ends)
        assert np.abs(p.path[[0, -1]] - [m.fold_angles for m in ends]).max() < 1e-6
        assert np.abs(np.diff(p.path, axis=0)).max() < 0.25
        assert np.abs(p.path).max() <= math.pi + 1e-12
        energy = 0.5 * (p.path - np.array(scene.rest_angles)) ** 2 @ k
        assert energy.max() <= p.energy * (1 + 1e-12)
        assert energy.max() >= p.energy * (1 - 1e-9) or p.pass_kind == "bound"
        for phi in p.path:
            points, turn = corners(sectors, phi)
            assert np.abs(turn - np.eye(3)).max() < 1e-10
            assert apart or np.abs(phi).max() <= 1e-3 or not crosses(points)
    return seen


def by_hand(scene):
    """Energy of the flat state."""
    return 0.5 * float(np.array(scene.stiffness) @ np.array(scene.rest_angles) ** 2)


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(o.examples.waterbomb(symmetry="none"), marks=pytest.mark.slow),
        drawn(6, 3, contact="full"),
        pytest.param(drawn(7, 2, contact="full"), marks=pytest.mark.slow),
    ],
    ids=["waterbomb", "degree 6", "degree 7"],
)
def test_between_the_sides_of_the_flat_state_barriers_are_exact(scene):
    found = o.find_barriers(scene, o.find_minima(scene, prove=False, escape=False))
    assert pose(scene).dof in (3, 4)
    sums = [sum(m.fold_angles) for m in found.result.minima]
    assert checked(found, crossing=False)
    exact = [p for p in found.passes if sums[p.from_state - 1] * sums[p.to_state - 1] < 0]
    assert exact
    for p in exact:
        assert p.least == pytest.approx(by_hand(scene), rel=1e-12)
        assert p.energy >= p.least * (1 - 1e-12)
        totals = p.path.sum(axis=1)
        assert not [k for k in np.flatnonzero(totals[:-1] * totals[1:] < 0)]
        assert not np.abs(p.path[np.abs(totals) < 1e-9]).any()
    assert any(p.why == PROVED and p.pass_kind == "flat state" for p in exact)
    for m in found.result.minima:  # a state of no higher energy need not be listed
        assert not m.escape or m.escape.method == "upper bound (descents)"
