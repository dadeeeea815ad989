"""Barriers: merge trees against brute force, exact passes against closed forms and a flood fill."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from origami_nlp import find_minima
from origami_nlp.barriers import Known, find_barriers
from origami_nlp.barriers.bounds import side_of_flat
from origami_nlp.closed_forms import degree6
from origami_nlp.kkt import State, project
from origami_nlp.numerics import CLOSURE_TOL, merge_tree
from origami_nlp.pattern import Scene, Vertex, examples
from origami_nlp.problem import Model
from tests.computed_once import once, panel_result, thinned
from tests.independent.flood import ChartGrid
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


def test_apart_components_have_no_barrier():
    tree = merge_tree(np.zeros(4), np.array([[0, 1], [2, 3]]), np.ones(2), [0, 2])
    assert tree.barrier(0, 1) is None and tree.path(0, 2) is None


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
    leaves = [int(v) for v in rng.permutation(n)[:4]]
    tree = merge_tree(energy, edges, height, leaves)
    found = np.full((4, 4), np.inf)
    for i, j in itertools.permutations(range(4), 2):
        merge = tree.barrier(i, j)
        found[i, j] = np.inf if merge is None else merge.height
        assert found[i, j] == best[leaves[i], leaves[j]]
    assert is_ultrametric(found)


def test_the_flat_state_is_the_least_barrier_between_its_sides(saddle_barriers):
    minima = saddle_barriers.result.minima
    flat = saddle_barriers.scene.energy(np.zeros(6))
    sides = side_of_flat(np.array([m.fold_angles for m in minima]))
    across = [
        p for p in saddle_barriers.passes if sides[p.from_state - 1] * sides[p.to_state - 1] < 0
    ]
    assert len(across) == 2
    for p in across:
        assert p.known is Known.EXACT and p.energy == pytest.approx(flat, rel=1e-14) == p.least


GRAPH_OF_0_12_RAD_JUMPED_HERE = Scene(
    Vertex(
        (
            2.3266372182936585,
            0.6799783926528845,
            0.3924039376164107,
            0.7541025058222274,
            2.1300632527944057,
        )
    ),
    (
        4.061022174512342,
        1.3692638455543704,
        4.734121901151,
        2.273261588262063,
        0.28469017959097975,
    ),
    (
        0.042875779783830836,
        1.224443624524688,
        0.8108068498644316,
        0.6613361595155554,
        2.790884422835271,
    ),
    "none",
    "fold-limits",
)
"""Two degrees of freedom, whose two halves of closed states meet in the flat state."""


def halved(model, path):
    """Midpoints of a path, closed; none goes aside by more than its step."""
    x = model.reduce(path)
    middle, residual = project(model, 0.5 * (x[:-1] + x[1:]))
    assert residual.max() <= CLOSURE_TOL
    longest = np.abs(np.diff(x, axis=0)).max(axis=1)
    assert (np.abs(middle - 0.5 * (x[:-1] + x[1:])).max(axis=1) <= longest + 1e-12).all()
    out = np.empty((2 * len(x) - 1, x.shape[1]))
    out[::2], out[1::2] = x, middle
    return model.expand(out)


@pytest.mark.slow  # a second look at what other tests of the room say
def test_no_bound_is_below_its_own_path():
    scene = GRAPH_OF_0_12_RAD_JUMPED_HERE
    result = find_minima(scene, prove=False, escape=False)
    found, model = find_barriers(scene, result), Model(scene)
    joined = [p for p in found.passes if len(p.path)]
    assert len(joined) >= 5
    for p in joined:
        path = p.path
        for _ in range(4):
            path = halved(model, path)
        top = scene.energy(path).max()
        # a millionth more at most: steps beside the highest states are halved until that is so
        assert top <= p.energy + 1e-6 * (p.energy - p.path_energy[[0, -1]].min())
        assert p.energy > scene.energy(p.path[[0, -1]]).max()
    # 4.19153 J: over the flat state, from minima at 4.17354 and 3.2979 J; the graph said 4.17354
    low = [m.energy for m in result.minima]
    (one,) = [p for p in joined if low[p.to_state - 1] == pytest.approx(4.17354, abs=1e-5)][:1]
    assert one.energy == pytest.approx(scene.energy(np.zeros(5)), rel=1e-12)


@pytest.mark.slow
def test_saddle_is_stationary_by_the_closed_forms(saddle_scene, saddle_barriers):
    passes = {(p.from_state, p.to_state): p for p in saddle_barriers.passes}
    p = passes[2, 3]
    assert p.pass_kind == "saddle" and p.residual < 1e-12 and not p.contacts
    a = saddle_scene.vertex.sector_angles
    point = degree6(a[0], a[1], p.fold_angles[1], p.fold_angles[2])
    assert np.allclose(point.value, [p.fold_angles[0], p.fold_angles[3]], atol=1e-10)
    k = np.array(saddle_scene.stiffness)[:4] * [1, 2, 2, 1]
    pull = k * (np.array(p.fold_angles)[:4] - np.array(saddle_scene.rest_angles)[:4])
    jac = np.vstack([point.first[0], np.eye(2), point.first[1]])
    assert np.abs(jac.T @ pull).max() < 1e-9 * np.abs(pull).max() * np.abs(jac).max()
    hessian = jac.T @ np.diag(k) @ jac + pull[0] * point.second[0] + pull[3] * point.second[1]
    assert (np.linalg.eigvalsh(hessian) < 0).sum() == 1


@pytest.mark.slow
def test_contact_saddle_is_a_maximum_along_its_wall(contact_barriers):
    (p, other) = [p for p in contact_barriers.passes if p.pass_kind == "contact saddle"]
    assert p.fold_angles == other.fold_angles and p.contacts == ("phi = +pi at crease 1",)
    assert p.residual < 1e-12 and p.fold_angles[0] == math.pi
    piece = Piece.of(
        contact_barriers.scene
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
    model = Model(found.scene)
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


@pytest.mark.slow
def test_contact_saddle_agrees_with_the_flood_fill(contact_barriers):
    flooded(contact_barriers, (129, 257, 513), 0.35)


@pytest.mark.slow
def test_flood_fill_agrees_from_above(saddle_barriers):
    flooded(saddle_barriers, (65, 129, 257), 0.6)


def flooded(found, sizes, share, grids=None):
    """Compare each merge with flood fills: never lower, and at the last size within `share` of the first excess."""
    over = np.array([excesses(found, g) for g in grids or grids_of(found.scene, sizes)])
    tiny = 1e-10 * max(p.energy for p in found.passes)
    assert over.min() >= -tiny
    assert (over[-1] <= share * over[0] + tiny).all()
    return over[-1]


def grids_of(scene, sizes):
    """Grids of a scene's chart; scenes that differ in springs only share them."""
    return [ChartGrid(scene, size) for size in sizes]


def excesses(found, grid):
    """How much higher than each merge a flood fill finds the way between its two sides."""
    out = []
    for join in found.merges:
        ends = [
            np.array(found.result.minima[side[0] - 1].fold_angles)
            for side in (join.first, join.second)
        ]
        flood = grid.flood(found.scene, *ends)
        assert flood is not None and flood.height >= flood.level
        out.append(flood.height - join.energy)
    return out


def test_a_coarse_mesh_orders_no_layers_that_stand_apart():
    """States near a pass are looked at with contacts up to the mesh spacing: only layers that touch have an order."""
    model = Model(examples.degree6("5*pi/12", ratio=100))
    rng = np.random.default_rng(0)
    x, residual = project(model, rng.uniform(-np.pi, np.pi, (400, model.size)))
    x = x[(residual <= 1e-12) & (np.abs(x) <= np.pi).all(axis=1)]
    assert len(x) > 20
    assert all(State(model, state, 0.6).pieces for state in x)


@pytest.mark.slow  # paths of contacts
def test_paths_to_fold_along_are_those_over_the_passes(contact_barriers):
    """Each goes from its state over its pass to its state, and lies where the chart has its states."""
    content = contact_barriers.view_content()
    joined = [p for p in contact_barriers.passes if len(p.path)]
    tracks = content.tracks[-len(joined) :]
    assert len(joined) == len(contact_barriers.passes) > 0
    for track, p in zip(tracks, sorted(joined, key=lambda p: p.energy), strict=True):
        assert (track.start, track.end) == (p.from_state - 1, p.to_state - 1)
        angles = np.array([state.fold_angles for state in track.states])
        assert np.array_equal(angles, p.path) and p.pass_kind in track.title
        ends = [content.stations[k].folded.fold_angles for k in (p.from_state - 1, p.to_state - 1)]
        assert np.abs(angles[[0, -1]] - ends).max() <= 1e-9
        assert max(s.energy for s in track.states) == pytest.approx(p.energy)
        (points,) = [at for k, at in content.panels[0].tracks if content.tracks[k] is track]
        assert np.abs(points - angles[:, 1:3]).max() <= 1e-9
    said = " ".join(piece for piece in content.pieces if isinstance(piece, str))
    assert contact_barriers.passes[0].why in said
