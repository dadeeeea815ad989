"""Barriers: merge trees against brute force, exact passes against critical points."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from origami_nlp import find_minima
from origami_nlp.barriers import Known, find_barriers
from origami_nlp.barriers.find import side_of_flat
from origami_nlp.numerics import merge_tree
from origami_nlp.paper import find_critical_points
from origami_nlp.pattern import Scene, Vertex, examples
from origami_nlp.pattern_problem import pose
from tests.computed_once import once, panel_result, thinned
from tests.independent.search_manifold import Piece


def is_ultrametric(barrier: np.ndarray) -> bool:
    """Return whether a matrix of barriers obeys b(i, k) <= max(b(i, j), b(j, k)) for all i, j, k."""
    return all(
        barrier[i, k] <= max(barrier[i, j], barrier[j, k])
        for i, j, k in itertools.permutations(range(len(barrier)), 3)
    )


@pytest.fixture(scope="module")
def saddle_scene():
    """The panel with an interior saddle between two minima below the flat state."""
    return examples.degree6("5*pi/12", 100)


@pytest.fixture(scope="module")
def saddle_barriers(saddle_scene):
    return once("barriers-saddle", lambda: find_barriers(saddle_scene, panel_result(saddle_scene)))


@pytest.fixture(scope="module")
def contact_barriers():
    """The first of seven random springs in 69 on two other D1 vertices with a pass on a contact."""
    a = (0.9, 1.1, math.pi - 2.0, math.pi - 2.0, 1.1, 0.9)
    stiffness, rest = (0.0032, 0.0097, 0.0226, 0.6611), (2.34, -0.12, -0.27, 1.0)
    wedge = (0, 1, 2, 3, 2, 1)
    springs = (tuple(v[k] for k in wedge) for v in (stiffness, rest))
    scene = Scene(Vertex(a), *springs, "D1", "full")
    return once(
        "barriers-contact",
        lambda: find_barriers(scene, find_minima(scene, max_starts=24, escape=False)),
    )


@settings(max_examples=60)
@given(st.integers(0, 10_000))
def test_merge_tree_is_the_min_max_of_all_paths(seed):
    rng = np.random.default_rng(seed)
    n = 9
    energy = rng.uniform(size=n)
    pairs = [p for p in itertools.combinations(range(n), 2) if rng.uniform() < 0.3]
    if not pairs:
        return
    edges = np.array(pairs)
    height = energy[edges].max(axis=1) + rng.uniform(0, 0.5, len(edges))
    best = np.full((n, n), np.inf)
    np.fill_diagonal(best, energy)
    for (a, b), h in zip(pairs, height, strict=True):
        best[a, b] = best[b, a] = h
    for k, i, j in itertools.product(range(n), repeat=3):
        best[i, j] = min(best[i, j], max(best[i, k], best[k, j]))
    tree = merge_tree(energy, edges, height, 4)
    found = np.full((4, 4), np.inf)
    for i, j in itertools.permutations(range(4), 2):
        merge = tree.barrier(i, j)
        found[i, j] = np.inf if merge is None else merge.height
        assert found[i, j] == best[i, j]
    assert is_ultrametric(found)


def test_the_flat_state_is_the_least_barrier_between_its_sides(saddle_barriers):
    minima = saddle_barriers.result.minima
    flat = saddle_barriers.result.scene.energy(np.zeros(6))
    sides = side_of_flat(np.array([m.fold_angles for m in minima]))
    across = [
        p for p in saddle_barriers.passes if sides[p.from_state - 1] * sides[p.to_state - 1] < 0
    ]
    assert len(across) == 2
    for p in across:
        assert p.known is Known.EXACT and p.energy == pytest.approx(flat, rel=1e-14) == p.least


@pytest.mark.slow
def test_contact_saddle_is_a_maximum_along_its_wall(contact_barriers):
    (p, other) = [p for p in contact_barriers.passes if p.pass_kind == "contact saddle"]
    assert p.fold_angles == other.fold_angles and p.contacts == ("phi = +pi at crease 1",)
    assert p.residual < 1e-12 and p.fold_angles[0] == math.pi
    piece = Piece.of(
        contact_barriers.result.scene
    )  # closure and energy that share no code with the package

    def energy_at(phi_1, phi_3):
        x = np.array(p.fold_angles[:4])
        x[[0, 2]] = phi_1, phi_3
        for _ in range(60):
            g, jac = piece.closure(x[None])
            x[[1, 3]] -= np.linalg.lstsq(jac[0][:, [1, 3]], g[0], rcond=1e-9)[0]
        assert np.abs(piece.closure(x[None])[0]).max() < 1e-13
        return piece.energy(x)

    phi_3 = p.fold_angles[2]
    wall = [energy_at(math.pi, phi_3 + d) for d in np.linspace(-0.02, 0.02, 21)]
    assert int(np.argmax(wall)) == 10 and wall[10] == pytest.approx(p.energy, rel=1e-9)
    # off the wall the energy is higher: the contact pushes
    assert energy_at(math.pi - 1e-3, phi_3) > p.energy


@pytest.mark.parametrize("which", thinned(["saddle_barriers", "contact_barriers"], 2))
def test_paths_can_be_replayed(which, request):
    found = request.getfixturevalue(which)
    model = pose(found.result.scene)
    for p in found.passes:
        ends = [found.result.minima[k - 1].fold_angles for k in (p.from_state, p.to_state)]
        assert np.allclose(p.path[[0, -1]], ends, atol=1e-6)
        assert np.abs(np.diff(p.path, axis=0)).max() < 0.5
        assert p.path_energy.max() <= p.energy * (1 + 1e-12)
        x = model.reduce(p.path)
        assert max(float(np.abs(model.closure(y)[0]).max()) for y in x) < 1e-10
        assert all(not model.refuses(y) for y in x[:: max(1, len(x) // 40)])
    assert is_ultrametric(found.matrix())
    assert len(found.merges) == len(found.result.minima) - 1


@pytest.mark.slow  # critical points of two scenes, ten seconds each
@pytest.mark.parametrize("which", ["saddle_barriers", "contact_barriers"])
def test_merges_are_the_saddles_among_the_critical_points(which, request):
    """A disc has a saddle for each minimum but one: two sides meet at each of them, and nowhere else."""
    found = request.getfixturevalue(which)
    points = find_critical_points(found.result.scene)
    assert points.morse_sum == 1  # doubts, if any, are about points that contribute nothing
    saddles = [p.energy for p in points.points if p.contribution < 0]
    assert sorted(saddles) == pytest.approx(sorted(m.energy for m in found.merges), rel=1e-12)
