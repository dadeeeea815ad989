"""FOLD out: frames of the states, layer orders, round trips; meshes; mutated files never hang or crash."""

import json
import math

import numpy as np
import pytest

from origami_nlp import (
    OrigamiError,
    Scene,
    Vertex,
    examples,
    find_minima,
    write_fold,
    write_mesh,
)
from origami_nlp.pattern import fold_vertices, parse_fold, scene_at
from origami_nlp.pattern_problem import state_frame
from tests.computed_once import shared, thinned

SCENES = {
    "degree 6": examples.degree6("pi/3", 1),
    "degree 4": Scene(
        Vertex.from_degrees([60, 100, 120, 80]), (1, 2, 3, 4), (-1, 1, 1, 2.5), "none"
    ),
    "fully folded": Scene(
        Vertex.from_degrees([90] * 4), (1, 1, 1, 1), (0, math.pi, 0, math.pi), "none"
    ),
    "degree 5, not flat": Scene(
        Vertex.from_degrees([60, 70, 80, 70, 60], False),
        (1,) * 5,
        (0.5, 0.4, -0.3, 0.6, 0.9),
        "none",
    ),
}


@shared
def searched(name):
    return find_minima(SCENES[name], full=False, max_starts=60, prove=False, escape=False)


@pytest.fixture(scope="module", params=thinned([*SCENES][1:], 2), ids=str)
def result(request):
    return searched(request.param)


@pytest.mark.parametrize("sheet", [False, True])
def test_corners_and_facets_are_those_of_the_file(sheet):
    found = find_minima("miura:2x2", starts=1, escape=False) if sheet else searched("degree 4")
    data = found.to_fold()
    for number, frame in enumerate(data["file_frames"][: len(found.minima)], 1):
        corners, faces = found.to_mesh(number)
        assert (corners == found.coordinates(number)).all()
        assert corners == pytest.approx(np.array(frame["vertices_coords"]))
        assert [*map(list, faces)] == data["faces_vertices"]
    with pytest.raises(OrigamiError, match="number = 99"):
        found.coordinates(99)


def test_states_survive_the_round_trip(result, tmp_path):
    file = tmp_path / "states.fold"
    write_fold(result, file)
    frames = parse_fold(file.read_bytes())
    scene = scene_at(frames[0], 0, symmetry=result.scene.symmetry)
    v, w = fold_vertices(frames[0])[0][0], result.scene
    assert v.edges == tuple(range(w.degree)) or sorted(v.edges) == list(range(w.degree))
    shift = v.edges.index(0)
    assert np.allclose(np.roll(scene.stiffness, -shift), w.stiffness, rtol=1e-12)
    assert np.allclose(np.roll(scene.rest_angles, -shift), w.rest_angles, atol=1e-12)
    again = find_minima(scene, max_starts=60, prove=False, escape=False)
    assert len(again.minima) == len(result.minima)
    for m, other in zip(result.minima, again.minima, strict=True):
        assert math.isclose(m.energy, other.energy, rel_tol=1e-9, abs_tol=1e-12)
    one = [np.array(m.fold_angles) for m in result.minima]
    two = [np.roll(m.fold_angles, -shift) for m in again.minima]
    for phi in one:  # states of equal energy may change places
        assert min(np.abs(phi - psi).max() for psi in two) < 1e-9


def test_frames_hold_the_states(result):
    data = result.to_fold()
    json.dumps(data, allow_nan=False)
    frames = parse_fold(json.dumps(data))
    folded_frames = [f for f in frames if f.folded]
    states = folded_frames[
        not result.scene.vertex.flat :
    ]  # the reference state first, of what does not lie flat
    assert len(states) == len(result.minima)
    n = result.scene.degree
    for frame, m in zip(states, result.minima, strict=True):
        (v,) = fold_vertices(frame)[0]
        by_edge = dict(zip(v.edges, v.fold_angles, strict=True))
        measured = np.array([by_edge[k] for k in range(n)])
        away = np.abs(
            2 * np.sin((measured - m.fold_angles) / 2)
        )  # unassigned fully folded creases: +-pi
        assert away.max() < 1e-7
        assert f"{m.energy:.6g} J" in frame.title
    for raw in [data, *data["file_frames"]]:
        if "foldedForm" in raw["frame_classes"]:
            assert raw is data or (raw["origaminlp:kind"] and "origaminlp:multipliers" in raw)
            assert all(abs(a) <= 180 for a in raw["edges_foldAngle"])
            signs = {"M": -1, "V": 1, "F": 0, "B": 0}
            for letter, a in zip(raw["edges_assignment"], raw["edges_foldAngle"], strict=True):
                assert signs[letter] == np.sign(a)  # FOLD: the sign matches the assignment
    # what Origami Simulator's importer asks of the file's own frame
    keys = {
        "vertices_coords",
        "edges_vertices",
        "edges_assignment",
        "faces_vertices",
        "edges_foldAngle",
    }
    assert keys <= set(data)


def test_face_orders_of_shut_creases():
    """A valley fully folded onto facet i - 1 lies on its normal's side, a mountain on the other."""
    for name in ("fully folded", "degree 6"):
        scene = SCENES[name]
        for m in searched(name).minima:
            phi = np.array(m.fold_angles)
            from origami_nlp.chart import fold_vertex

            creases, _ = fold_vertex(scene.vertex, phi)
            orders = state_frame(scene, phi, "")["faceOrders"]
            above = {(f, g): s for f, g, s in orders}
            normals = np.cross(creases, np.roll(creases, -1, axis=0))
            for (f, g), s in list(above.items()):
                alike = np.sign(normals[f] @ normals[g])
                above[g, f] = int(-s * alike)  # seen from the other face
            n = len(phi)
            at_limit = np.flatnonzero(np.abs(np.abs(phi) - math.pi) < 1e-9)
            assert len(at_limit) == 0 or orders
            for i in at_limit:
                assert above[int(i), int(i - 1) % n] == np.sign(phi[i])


@pytest.mark.parametrize("suffix", [".obj", ".stl", ".glb"])
def test_meshes(tmp_path, suffix):
    trimesh = pytest.importorskip(
        "trimesh", reason='trimesh is not installed: pip install "origami_nlp[mesh]"'
    )
    result = searched("degree 4")
    target = tmp_path / f"states{suffix}"
    write_mesh(result, target)
    mesh = trimesh.load(target, force="mesh")
    assert len(mesh.faces) == 4 * len(result.minima)
    sectors = np.sort(np.tile(result.scene.vertex.sector_angles, len(result.minima)))
    assert np.allclose(np.sort(mesh.area_faces), np.sort(np.sin(sectors) / 2), atol=1e-6)


# ---------------------------------------------------------------- mutated files
