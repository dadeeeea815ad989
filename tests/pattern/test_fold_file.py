"""FOLD files in: degrees, angles, diagnosis, scenes; hostile files get one line."""

import json
import math

import numpy as np
import pytest

from origami_nlp import OrigamiError, Scene, Vertex
from origami_nlp.pattern import (
    REST_KEY,
    STIFFNESS_KEY,
    fold_vertices,
    parse_fold,
    read_fold,
    scene_at,
)
from origami_nlp.pattern_problem import states_to_fold
from tests.fold_files import closed_state, disc, folded, in_space, others
from tests.independent.rotations import fold


def frame(data):
    return parse_fold(json.dumps(data))[0]


def only(data):
    (vertex,) = fold_vertices(frame(data))[0]
    return vertex


def same_ring(found, expected):
    """Whether two cyclic sequences agree, wherever they start."""
    found = list(found)
    return any(np.allclose(found[k:] + found[:k], expected, atol=1e-9) for k in range(len(found)))


# ---------------------------------------------------------------- crease patterns


@pytest.mark.parametrize("turn", [0, 33, -90, 180])
def test_a_crease_pattern_in_the_plane(turn):
    v = only(disc([60, 100, 120, 80], "MVVV", turn=turn))
    assert v.degree == 4 and not v.reason
    assert same_ring(np.degrees(v.sector_angles), [60, 100, 120, 80])
    assert math.isclose(math.degrees(v.kawasaki), 0, abs_tol=1e-9) and v.maekawa == 0
    scene = scene_at(frame(disc([60, 100, 120, 80], "MVVV", turn=turn)), 0, symmetry="none")
    first = v.assignment.index("M")  # mountains and valleys alone mean folded flat
    assert scene.rest_angles[first] == -math.pi and scene.rest_angles[first - 1] == math.pi


def test_fold_angles_are_targets_and_null_is_not_zero():
    v = disc([60, 100, 120, 80], "MVVU", angles=[-30, 45, None, None])
    scene = scene_at(frame(v), 0, rest_angle=math.pi / 2)
    by_edge = dict(zip(only(v).edges, np.degrees(scene.rest_angles), strict=True))
    assert by_edge == pytest.approx({0: -30, 1: 45, 2: 90, 3: 0})


def test_stiffness_and_rest_angles_in_the_namespace():
    data = disc([60, 100, 120, 80], "MVVV", angles=[-30, 45, 50, 60])
    data[STIFFNESS_KEY] = [1, 2, None, 4, *[None] * 4]
    data[REST_KEY] = [None, 10, 20, None, *[None] * 4]
    scene = scene_at(frame(data), 0, stiffness=7.0)
    v = only(data)
    assert dict(zip(v.edges, scene.stiffness, strict=True)) == {0: 1, 1: 2, 2: 7, 3: 4}
    rest = dict(zip(v.edges, np.degrees(scene.rest_angles), strict=True))
    assert rest == pytest.approx({0: -30, 1: 10, 2: 20, 3: 60})


@pytest.mark.parametrize("seed", range(4))
def test_any_plane_and_noise(seed):
    sectors = [45, 45, 45, 45, 45, 45, 45, 45]
    letters = "MVMVMVMV"
    data = in_space(disc(sectors, letters), seed, noise=1e-5)
    one = frame(data)
    assert not one.folded
    (v,) = fold_vertices(one)[0]
    assert v.degree == 8 and np.allclose(np.degrees(v.sector_angles), 45, atol=5e-3)
    scene = scene_at(one, 0)
    assert scene.group.name == "D4" and scene.adjusted < 1e-4  # found through the noise, and said


def test_flat_and_joined_edges_join_facets():
    data = disc([60, 50, 50, 120, 40, 40], "MFVVJV")
    v = only(data)
    assert v.degree == 4 and same_ring(np.degrees(v.sector_angles), [110, 50, 160, 40])
    v = only(disc([100, 100, 100, 60], "MFVV"))  # 200 degrees without the F edge
    assert v.degree == 4 and "F edges are kept" in v.notes[0]


def test_unassigned_files_and_missing_arrays():
    data = disc([60, 100, 120, 80])
    del data["edges_assignment"]
    v = only(data)
    assert v.degree == 4 and v.assignment == "????" and v.maekawa is None and not v.reason
    n = 4
    faces = {
        "vertices_coords": data["vertices_coords"],
        "faces_vertices": [[0, i, i % n + 1] for i in range(1, n + 1)],
    }
    assert only(faces).degree == 4
    assert "edges_vertices is missing" in frame(faces).notes[0]


# ---------------------------------------------------------------- diagnosis


def test_duplicates_and_conflicts():
    data = disc([60, 100, 120, 80], "MVVV")
    data["edges_vertices"].append([1, 0])
    data["edges_assignment"].append("M")
    assert "same lines" in frame(data).notes[0] and not only(data).reason
    data["edges_assignment"][-1] = "V"
    assert "stated twice" in frame(data).notes[0]
    assert "edge 0" in only(data).reason
    with pytest.raises(OrigamiError, match="conflicting"):
        scene_at(frame(data), 0)


# ---------------------------------------------------------------- folded forms


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("sectors", "flat"),
    [((60, 100, 120, 80), True), ((60, 70, 80, 70, 80), True), ((70, 80, 75, 65), False)],
)
def test_fold_angles_are_measured(sectors, flat, turned):
    phi = closed_state(sectors, flat, 3)
    data = folded(sectors, phi, flat)
    if turned:  # faces the other way round: the assignments say which side is up
        data["faces_vertices"] = [f[::-1] for f in data["faces_vertices"]]
    data["faces_vertices"][1] = data["faces_vertices"][1][::-1]
    v = only(data)
    by_edge = dict(zip(v.edges, v.fold_angles, strict=True))
    np.testing.assert_allclose([by_edge[k] for k in range(len(phi))], phi, atol=1e-12)
    residual = np.abs(fold(np.array(v.sector_angles), np.array(v.fold_angles))[1] - np.eye(3)).max()
    assert residual < 1e-12
    scene = scene_at(frame(data), 0, symmetry="none")
    assert scene.vertex.flat == flat
    assert np.allclose(scene.rest_angles, v.fold_angles)


def test_shut_creases_take_their_side_from_the_file():
    phi = np.array([0.0, math.pi, 0.0, math.pi])  # book fold
    data = folded((90, 90, 90, 90), phi, letters="UVUV")
    by_edge = dict(zip(only(data).edges, only(data).fold_angles, strict=True))
    assert by_edge[1] == math.pi == by_edge[3] and abs(by_edge[0]) < 1e-12
    data["edges_assignment"][1] = data["edges_assignment"][3] = "M"
    by_edge = dict(zip(only(data).edges, only(data).fold_angles, strict=True))
    assert by_edge[1] == -math.pi


def test_frames_inherit_and_old_names_are_refused():
    base = disc([60, 100, 120, 80], "MVVV")
    state = folded((60, 100, 120, 80), closed_state((60, 100, 120, 80), True, 1))
    base["file_frames"] = [
        {
            "frame_parent": 0,
            "frame_inherit": True,
            "frame_classes": ["foldedForm"],
            "vertices_coords": state["vertices_coords"],
            "faces_vertices": state["faces_vertices"],
        },
        {"frame_title": "no geometry"},
    ]
    frames = parse_fold(json.dumps(base))
    assert [f.number for f in frames] == [0, 1] and frames[1].folded
    assert len(fold_vertices(frames[1])[0]) == 1
    with pytest.raises(OrigamiError, match=r"edges_foldAngles is of FOLD 1\.0: name it"):
        parse_fold(json.dumps(base | {"edges_foldAngles": [-10, 10, 10, 10, 0, 0, 0, 0]}))


# ---------------------------------------------------------------- the command line


@pytest.mark.parametrize(
    "name", ["squaretwist", "box", "miura", "deg4.fold", "deg6", "deg8.fold", "noB", "not_fold"]
)
def test_published_files(name):
    for path in (p for p in others(f"*{name}*") if p.suffix == ".fold"):
        for one in read_fold(path):
            found, notes = fold_vertices(one)
            stated = path.stem.split("_")
            degrees = {int(s.split("deg")[1][:1]) for s in stated if "deg" in s}
            degrees |= {int(s) for s in stated if s.isdigit() and len(s) == 1}
            assert found and {v.degree for v in found} <= degrees, (path.name, degrees)
            assert not any(v.reason for v in found)
            if "noB" in path.name:
                assert any("border" in note for note in notes)
            for v in found:
                total = math.fsum(v.sector_angles)
                assert abs(total - 2 * math.pi) < 1e-4
                if one.folded:  # what is measured closes up, to the noise of the file
                    product = fold(np.array(v.sector_angles), np.array(v.fold_angles))[1]
                    assert np.abs(product - np.eye(3)).max() < 1e-4, (path.name, v.number)


# ---------------------------------------------------------------- hostile files


def test_forces_come_back_from_a_file():
    stated = Scene(
        Vertex.from_degrees((96, 95, 92, 77)), (1,) * 4, (2.486, 2.4042, 0.9277, 0.7523), fixed_facet=1,
        loads=[{"crease": 3, "distance": 1, "force": [-1.0, -0.2, -0.15]}],
    )  # fmt: skip
    data = states_to_fold(stated, [])
    read = scene_at(frame(data), 0)
    assert read.loads == stated.loads and read.fixed_facet == stated.fixed_facet
    phi = np.array([0.3, -0.2, 0.1, 0.4])
    assert math.isclose(read.energy(phi), stated.energy(phi), rel_tol=1e-12)
    with pytest.raises(OrigamiError):
        scene_at(frame(data | {"origaminlp:loads": [3]}), 0)
    with pytest.raises(OrigamiError):
        frame(data | {"origaminlp:loads": 3})
    with pytest.raises(OrigamiError):
        scene_at(frame(data | {"origaminlp:fixedFacet": 9}), 0)
