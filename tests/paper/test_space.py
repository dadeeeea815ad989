"""The admissible space: topology, exactness of its mesh, and two computations that share no code with it."""

import math

import numpy as np
import pytest

from origami_nlp.chart import (
    fold_vertex,
    handles,
    parts,
    spots,
    surface_pieces,
)
from origami_nlp.paper import find_space
from origami_nlp.pattern import degree6, degree8
from origami_nlp.pattern_problem import check_admissible
from tests.computed_once import once
from tests.independent.kuhn import kuhn_surface
from tests.independent.search_layers import symmetrically_admissible
from tests.independent.search_manifold import Piece

SCENES = {
    "6, pi/4": degree6("pi/4"),
    "6, pi/3": degree6("pi/3"),
    "8, pi/4": degree8("pi/4"),
}


@pytest.fixture(scope="module")
def spaces():
    return once("spaces", lambda: {k: find_space(scene, rings=16) for k, scene in SCENES.items()})


@pytest.mark.parametrize("name", SCENES)
def test_mesh_is_a_complex_of_admissible_states(spaces, name):
    space = spaces[name]
    mesh, scene = space.mesh, SCENES[name]
    assert space.euler_characteristic == len(mesh.wedge) - len(mesh.edges) + len(mesh.triangles)
    _, q = fold_vertex(scene.vertex, mesh.fold_angles)
    assert np.abs(q[:, 1:]).max() < 1e-12
    assert (q[:, 0] > 0).all()
    assert np.abs(mesh.fold_angles).max() <= math.pi + 1e-12
    rng = np.random.default_rng(0)
    for v in rng.choice(len(mesh.wedge), 10, replace=False):
        phi = np.clip(mesh.fold_angles[v], -math.pi, math.pi)
        said = check_admissible(scene, phi)
        assert said.admissible, (phi, said.reason)
    # every vertex lies on some edge, every triangle's edges are listed
    assert np.isin(np.arange(len(mesh.wedge)), mesh.edges).all()


@pytest.mark.parametrize("name", SCENES)
def test_space_is_two_discs_that_touch_in_the_flat_state(spaces, name):
    space = spaces[name]
    assert (len(space.components), space.holes, space.euler_characteristic) == (1, 0, 1)
    pinch = [p for p in space.pinch_points if p.kind == "pinch point"]
    assert len(pinch) == 1
    assert np.abs(pinch[0].fold_angles).max() < 1e-12
    assert pinch[0].dimensions == (2, 2)
    assert len(np.unique(surface_pieces(space.mesh.triangles))) == 2


@pytest.mark.parametrize(("scene", "size"), [(degree8("pi/4"), 20), (degree6("pi/4"), 12)])
def test_kuhn_triangulation_finds_two_annuli_around_the_flat_state(scene, size):
    found = kuhn_surface(Piece.of(scene), size, 0.8)
    assert len(found.polygons) == 2
    assert found.euler == (0, 0)


def test_handles_are_thin_for_an_independent_formulation(spaces):
    """States on handles can be stacked symmetrically; beside them every closed state crosses itself."""
    piece = Piece.of(SCENES["6, pi/3"])
    rng = np.random.default_rng(1)
    assert len(spaces["6, pi/3"].handles) == 4
    for handle in spaces["6, pi/3"].handles:
        middle = handle.path[len(handle.path) // 2]
        x = spaces["6, pi/3"].mesh.wedge[middle]
        assert symmetrically_admissible(piece, x[None]).all()
        held = np.abs(np.abs(x) - math.pi) < 1e-9
        assert held.sum() == 2
        around = x + 1e-3 * rng.normal(size=(400, 4))
        around, residual = piece.retract(around)
        assert residual.max() < 1e-12
        assert not piece.admissible(around).any()
        # along the handle both creases stay closed
        for other in spaces["6, pi/3"].mesh.wedge[handle.path[2:-2:5]]:
            assert symmetrically_admissible(piece, other[None]).all()


def test_topology_of_known_complexes():
    tetrahedron = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])
    none = np.empty((0, 2), dtype=int)
    (sphere,) = parts(4, tetrahedron, none)
    assert (sphere.euler_characteristic, sphere.holes, sphere.closed_surfaces) == (2, 0, 1)
    i = np.arange(4)
    grid = lambda a, b: (a % 4) * 4 + b % 4  # noqa: E731
    a, b = (v.ravel() for v in np.meshgrid(i, i))
    torus = np.vstack(
        [
            np.stack([grid(a, b), grid(a + 1, b), grid(a + 1, b + 1)], axis=1),
            np.stack([grid(a, b), grid(a + 1, b + 1), grid(a, b + 1)], axis=1),
        ]
    )
    (part,) = parts(16, torus, none)
    assert (part.euler_characteristic, part.holes, part.closed_surfaces) == (0, 2, 1)
    # two triangles that touch at a vertex, joined by a handle; a whisker; a lone vertex
    bow = np.array([[0, 1, 2], [0, 3, 4]])
    extra = np.array([[1, 5], [5, 3], [2, 6]])
    found = parts(8, bow, extra)
    assert [(p.dimension, p.holes, p.euler_characteristic) for p in found] == [(2, 1, 0), (0, 0, 1)]
    kinds = {s.vertex: s.dimensions for s in spots(8, bow, extra)}
    assert kinds == {0: (2, 2), 1: (2, 1), 3: (2, 1), 2: (2, 1)}
    arcs = sorted(path.tolist() for path in handles(8, bow, extra))
    assert arcs in ([[1, 5, 3], [2, 6]], [[2, 6], [3, 5, 1]], [[1, 5, 3], [6, 2]])
    ring = np.array([[0, 1], [1, 2], [2, 0]])
    (loop,) = handles(3, np.empty((0, 3), dtype=int), ring)
    assert loop[0] == loop[-1]
    assert len(loop) == 4
