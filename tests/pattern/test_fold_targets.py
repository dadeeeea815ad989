"""Folded forms whose file states targets: both kinds of angles are kept, and the user chooses."""

import json
import math

import numpy as np
import pytest

from origami_nlp.pattern import (
    REST_KEY,
    fold_vertices,
    parse_fold,
    scene_at,
)
from tests.fold_files import closed_state, disc, folded

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
    assert v.notes
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


def test_rest_angles_of_the_namespace_come_first():
    data = simulator_export()
    data[REST_KEY] = [-10, None, None, None, *[None] * 4]
    one = frame(data)
    assert by_edge(one, scene_at(one, 0, symmetry="none").rest_angles) == pytest.approx(
        [-10, 70, 80, 60]
    )
    measured = scene_at(one, 0, symmetry="none", rest_from="measured").rest_angles
    assert by_edge(one, measured) == pytest.approx([0] * 4)
