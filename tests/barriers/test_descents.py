"""Barriers of vertices with two and more degrees of freedom: paths and bounds, by closure and floods of their own."""

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.barriers import Known
from origami_nlp.barriers.bounds import NEVER, PROVED
from origami_nlp.problem import Model
from tests.independent import flood_three
from tests.independent.links import corners, crosses
from tests.kernels.answers import generic


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
        o.examples.waterbomb(symmetry="none"),
        drawn(6, 3, contact="full"),
        pytest.param(drawn(7, 2, contact="full"), marks=pytest.mark.slow),
    ],
    ids=["waterbomb", "degree 6", "degree 7"],
)
def test_between_the_sides_of_the_flat_state_barriers_are_exact(scene):
    found = o.find_barriers(scene, o.find_minima(scene, prove=False, escape=False))
    assert Model(scene).dof in (3, 4)
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


@pytest.mark.slow
def test_paths_are_as_low_as_a_flood_of_a_lattice_finds():
    """Three fold angles on a lattice, the others by spherical trigonometry: 39,100 states, within fold limits."""
    scene = drawn(6, 0, contact="fold-limits")
    result = o.find_minima(scene, prove=False, escape=False)
    found = o.find_barriers(scene, result)
    assert checked(found) >= 3 and not any(p.known is Known.EXACT for p in found.passes)
    minima = np.array([m.fold_angles for m in result.minima])
    sectors, k, rest = (
        np.array(x) for x in (scene.vertex.sector_angles, scene.stiffness, scene.rest_angles)
    )
    flooded, lattice = flood_three.heights(sectors, k, rest, minima, 31, 0.6)
    for phi in lattice[::500]:
        assert np.abs(corners(sectors, phi)[1] - np.eye(3)).max() < 1e-9
    heights = found.matrix()
    both = [(1, 3), (5, 6), (7, 8)]
    saddles = {(p.from_state, p.to_state): p.pass_kind for p in found.passes}
    assert [saddles[pair] for pair in both] == ["saddle", "saddle", "contact saddle"]
    for i, j in both:
        assert heights[i - 1, j - 1] <= flooded[i - 1, j - 1] < heights[i - 1, j - 1] * 1.05


def test_with_less_paper_no_path_leads_to_the_other_side():
    vertex = o.Vertex(tuple(np.full(6, math.radians(50))), flat=False)
    scene = o.Scene(vertex, (1.0,) * 6, (0.4, 0.5, 0.6, 0.4, 0.5, 0.6), symmetry="none")
    result = o.find_minima(scene, prove=False, escape=False)
    found = o.find_barriers(scene, result)
    sums = [sum(m.fold_angles) for m in result.minima]
    across = [p for p in found.passes if sums[p.from_state - 1] * sums[p.to_state - 1] < 0]
    assert across and all(p.why == NEVER and math.isinf(p.energy) for p in across)
    assert "less than 360 degrees" in str(found)


@pytest.mark.parametrize(
    "scene",
    [generic(7, 8, "full"), pytest.param(generic(6, 2, "none"), marks=pytest.mark.slow)],
    ids=["degree 7", "degree 6"],
)
def test_barriers_of_pairs_do_not_hang_on_labels(scene):
    """Counted from the second crease, the other way round, paper turned over: they were up to 12 J apart."""
    order, facets = (np.arange(1, 1 - scene.degree, -1), np.arange(0, -scene.degree, -1))
    other = replace(
        scene,
        vertex=o.Vertex(tuple(np.array(scene.vertex.sector_angles)[facets])),
        stiffness=tuple(np.array(scene.stiffness)[order]),
        rest_angles=tuple(-np.array(scene.rest_angles)[order]),
    )
    found = []
    for one in (scene, other):
        result = o.find_minima(one, effort="quick", prove=False, escape=False)
        found.append(o.find_barriers(one, result).matrix())
    assert np.isfinite(found[0]).sum() > len(found[0])
    assert found[0] == pytest.approx(found[1], rel=1e-11)
