"""Folded forms whose file states targets: both kinds of angles are kept, and the user chooses."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from origami_nlp import OrigamiError
from origami_nlp.cli import app
from origami_nlp.pattern import (
    REST_KEY,
    STIFFNESS_KEY,
    fold_vertices,
    frame_pattern,
    parse_fold,
    scene_at,
    vertex_scene,
)
from tests.fold_files import closed_state, disc, folded

FILES = Path(__file__).parents[2] / "docs" / "files"
RUN = CliRunner()
SECTORS = (60, 100, 120, 80)
TARGETS = [-90, 70, 80, 60]


def frame(data):
    return parse_fold(json.dumps(data))[0]


def simulator_export(targets=TARGETS, phi=None, letters="MVVV"):
    """What Origami Simulator saves: a foldedForm (flat where nothing was folded yet), angles that are targets."""
    if phi is None:
        data = disc(SECTORS, letters)
        data["vertices_coords"] = [[x, 0.0, -y] for x, y in data["vertices_coords"]]
        data["faces_vertices"] = [[0, i, i % 4 + 1] for i in range(1, 5)]
        data |= {"frame_classes": ["foldedForm"], "frame_attributes": ["3D"]}
    else:
        data = folded(SECTORS, phi, letters=list(letters))
    if targets is not None:
        data["edges_foldAngle"] = [*targets, *[None] * 4]
    return data


def by_edge(one, angles):
    (v,) = fold_vertices(one)[0]
    return [math.degrees(dict(zip(v.edges, angles, strict=True))[e]) for e in range(4)]


def test_targets_of_a_form_saved_unfolded_are_its_rest_angles():
    one = frame(simulator_export())
    (v,) = fold_vertices(one)[0]
    assert one.folded and not v.reason
    assert by_edge(one, v.fold_angles) == pytest.approx([0] * 4)  # both are kept
    assert by_edge(one, v.file_angles) == pytest.approx(TARGETS)
    (note,) = v.notes
    assert "up to 90 degrees (edge 0: 0 measured, -90 in the file)" in note
    assert "--rest-from measured" in note
    for choice in (None, "file"):
        rest = scene_at(one, 0, symmetry="none", rest_from=choice).rest_angles
        assert by_edge(one, rest) == pytest.approx(TARGETS)
    rest = scene_at(one, 0, symmetry="none", rest_from="measured").rest_angles
    assert by_edge(one, rest) == pytest.approx([0] * 4)


def test_a_partly_folded_form_keeps_both():
    phi = closed_state(SECTORS, True, 3)
    letters = ["V" if p > 0 else "M" for p in phi]
    targets = [None, *np.degrees(1.2 * phi[1:])]
    one = frame(simulator_export(targets, phi, letters))
    (v,) = fold_vertices(one)[0]
    expected = [math.degrees(phi[0]), *targets[1:]]  # null: measured
    assert by_edge(one, scene_at(one, 0, symmetry="none").rest_angles) == pytest.approx(expected)
    assert by_edge(one, v.fold_angles) == pytest.approx(np.degrees(phi))
    flat = scene_at(one, 0, symmetry="none", rest_from="file", rest_angle=0.5).rest_angles
    assert by_edge(one, flat)[0] == pytest.approx(math.degrees(math.copysign(0.5, phi[0])))


@pytest.mark.parametrize(("off", "said"), [(0.9, False), (1.1, True)])
def test_a_difference_of_more_than_a_degree_is_said(off, said):
    phi = closed_state(SECTORS, True, 3)
    letters = ["V" if p > 0 else "M" for p in phi]
    (v,) = fold_vertices(frame(simulator_export(list(np.degrees(phi) + off), phi, letters)))[0]
    assert any("differ" in note for note in v.notes) == said


def test_rest_angles_of_the_namespace_come_first():
    data = simulator_export()
    data[REST_KEY] = [-10, None, None, None, *[None] * 4]
    one = frame(data)
    assert by_edge(one, scene_at(one, 0, symmetry="none").rest_angles) == pytest.approx(
        [-10, 70, 80, 60]
    )
    measured = scene_at(one, 0, symmetry="none", rest_from="measured").rest_angles
    assert by_edge(one, measured) == pytest.approx([0] * 4)


def test_a_flat_form_with_letters_alone_says_what_it_rests_at():
    one = frame(simulator_export(None))
    (v,) = fold_vertices(one)[0]
    assert "rest angles are 0" in v.notes[0]
    assert by_edge(one, scene_at(one, 0, symmetry="none").rest_angles) == pytest.approx([0] * 4)
    rest = scene_at(one, 0, symmetry="none", rest_from="file").rest_angles
    assert by_edge(one, rest) == pytest.approx([-180, 180, 180, 180])


def test_a_series_of_forms_inherits_its_targets():
    """Origami Simulator's series: arrays once, coordinates a frame."""
    data = simulator_export()
    frames = [
        {
            "frame_inherit": True,
            "frame_classes": ["foldedForm"],
            "vertices_coords": data.pop("vertices_coords"),
        }
    ]
    frames = parse_fold(json.dumps({**data, "frame_classes": [], "file_frames": frames}))
    assert [f.number for f in frames] == [1]
    assert by_edge(frames[0], scene_at(frames[0], 0, symmetry="none").rest_angles) == pytest.approx(
        TARGETS
    )


def test_the_command_says_and_chooses(tmp_path):
    file, out = tmp_path / "a.fold", tmp_path / "a.json"
    file.write_text(json.dumps(simulator_export()))
    found = {}
    for choice in ([], ["--rest-from", "file"], ["--rest-from", "measured"]):
        args = ["minima", str(file), "--vertex", "0", "--symmetry", "none", "--max-starts", "9"]
        done = RUN.invoke(app, [*args, "-o", str(out), *choice])
        assert done.exit_code == 0 and "90 degrees" in done.stderr, done.exception
        found[tuple(choice)] = json.loads(out.read_text())["origami"]["creases"]["rest_angles"]
    assert found[()] == found["--rest-from", "file"] != found["--rest-from", "measured"]
    assert all(abs(float(a)) < 1e-12 for a in found["--rest-from", "measured"])
    done = RUN.invoke(app, ["inspect", str(file), "-o", str(out)])
    assert "90 degrees" in done.output
    (v,) = json.loads(out.read_text())["frames"][0]["vertices"]
    assert sorted(v["file_angles"]) == pytest.approx(sorted(np.radians(TARGETS)))
    assert v["fold_angles"] == pytest.approx([0] * 4)


def test_choices_that_cannot_be_are_refused(tmp_path):
    pattern, form, scene = tmp_path / "a.fold", tmp_path / "b.fold", tmp_path / "c.toml"
    pattern.write_text(json.dumps(disc(SECTORS, "MVVV", angles=TARGETS)))
    form.write_text(json.dumps(simulator_export()))
    scene.write_text("[vertex]\n")
    for file, choice, words in (
        (pattern, "measured", "crease pattern"),
        (form, "both", "file or measured"),
        (form, "90", "is --rest-angle, in degrees"),
        (scene, "file", "FOLD files"),
    ):
        done = RUN.invoke(app, ["minima", str(file), "--rest-from", choice])
        assert isinstance(done.exception, OrigamiError)
        assert "--rest-from" in str(done.exception) and words in str(done.exception)


# ---------------------------------------------------------------- legacy units


def legacy(angles):
    data = disc(SECTORS, "MVVV")
    data["edges_foldAngles"] = [*angles, *[0] * 4]
    return data


@pytest.mark.parametrize("scale", [1.0, 0.3])
def test_legacy_angles_in_radians(scale):
    """As Origami Simulator and others wrote them: -pi for a mountain, pi for a valley, or less."""
    one = frame(legacy([-math.pi * scale, *[math.pi * scale] * 3]))
    rest = scene_at(one, 0, symmetry="none").rest_angles
    assert by_edge(one, rest) == pytest.approx([-180 * scale, *[180 * scale] * 3])
    assert any("radians" in note for note in one.notes)


@pytest.mark.parametrize(
    ("largest", "said"), [(math.pi, "180"), (1.5, "85.9437"), (4, None), (0.01, None)]
)
def test_fold_angles_that_look_like_radians_are_read_as_degrees_with_a_note(largest, said):
    data = disc(SECTORS, "MVVV", angles=[-largest, largest, 0.5 * largest, largest])
    one = frame(data)
    rest = scene_at(one, 0, symmetry="none").rest_angles
    assert by_edge(one, rest)[1] == pytest.approx(largest)
    notes = [note for note in one.notes if "radians" in note]
    assert len(notes) == (said is not None) and all(f"write {said}" in note for note in notes)


def test_legacy_angles_in_degrees_and_both_names():
    one = frame(legacy([-90, 3, 2, 1]))
    assert by_edge(one, scene_at(one, 0, symmetry="none").rest_angles) == pytest.approx(
        [-90, 3, 2, 1]
    )
    assert not any("radians" in note for note in one.notes)
    one = frame({**legacy([-1, 1, 1, 1]), "edges_foldAngle": [-2, 2, 2, 2, *[0] * 4]})
    assert by_edge(one, scene_at(one, 0, symmetry="none").rest_angles) == pytest.approx(
        [-2, 2, 2, 2]
    )
    assert any("left out" in note for note in one.notes)


# ---------------------------------------------------------------- no outline


def test_a_pattern_without_outline_says_what_to_add(tmp_path):
    data = disc(SECTORS, "MVVV")
    for key in ("edges_vertices", "edges_assignment"):
        data[key] = data[key][:4]
    found, notes = fold_vertices(frame(data))
    assert not found
    assert (
        'assignment "B"' in notes[0]
        and "vertices 1, 2, 3, 4" in notes[0]
        and "vertices 0 do" in notes[0]
    )
    file = tmp_path / "a.fold"
    file.write_text(json.dumps(data))
    assert 'assignment "B"' in RUN.invoke(app, ["inspect", str(file)]).output
    for args in (["minima", str(file)], ["minima", str(file), "--vertex", "0"]):
        done = RUN.invoke(app, args)
        assert isinstance(done.exception, OrigamiError) and 'assignment "B"' in str(done.exception)


def test_an_outline_drawn_in_part_is_noticed():
    data = disc(SECTORS, "MVVV")
    for key in ("edges_vertices", "edges_assignment"):
        data[key] = data[key][:6]
    found, notes = fold_vertices(frame(data))
    assert not found and any("outline" in note for note in notes)
    assert not fold_vertices(frame(disc(SECTORS, "MVVV")))[1]


def test_springs_that_were_asked_for_and_not_used_are_named():
    letters = json.loads((FILES / "pattern.fold").read_text())
    ask = {"stiffness": 0.01, "rest_angle": math.pi / 2}

    def notes(data, **options):
        (frame,) = parse_fold(json.dumps(data))
        said = []
        one = fold_vertices(frame)[0][0].number
        vertex_scene(frame, one, on_note=said.append, **options)
        return [
            [n for n in some if "is not used" in n]
            for some in (frame_pattern(frame, **options).notes, said)
        ]

    assert notes(letters, **ask) == [[], []]
    angles = [{"M": -60, "V": 60}.get(a, 0) for a in letters["edges_assignment"]]
    folded = {**letters, "edges_foldAngle": angles}
    for said in notes(folded, **ask):
        assert len(said) == 1 and said[0].startswith("--rest-angle 90 is not used")
    assert notes(folded) == [[], []]
    stated = {**letters, STIFFNESS_KEY: [0.02] * len(angles)}
    for said in notes(stated, **ask):
        assert said == ["--stiffness is not used: the file states the stiffness of each crease"]
