"""Preload: a torque on a crease that no rest angle gives, in scenes, files, searches and proofs."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp import (
    Scene,
    Vertex,
    examples,
    find_minima,
    format_scene,
    parse_scene,
    read_fold_scene,
    write_fold,
)
from origami_nlp.errors import FoldFileError, SceneError, SymmetryError
from origami_nlp.pattern import PRELOAD_KEY, scene_from_dict, scene_to_dict
from origami_nlp.pattern_problem import pose
from origami_nlp.proof import ReducedVertex, prove
from origami_nlp.sweep import parse_sweep

FOUR = Vertex.from_degrees((80, 100, 70, 110))
SPRINGS = {"stiffness": (1, 0.7, 0.5, 0.3), "rest_angles": (2, -1, 0.5, 1)}
WOUND = Scene(
    FOUR, **SPRINGS, symmetry="none", contact="fold-limits", preload=(3.0, 0.0, -4.0, 0.0)
)


def test_the_energy_is_that_of_springs_and_torque_up_to_the_constant_that_is_stated():
    phi = np.random.default_rng(0).uniform(-math.pi, math.pi, (50, 4))
    k, rest, m = (np.array(v) for v in (WOUND.stiffness, WOUND.rest_angles, WOUND.preload))
    springs = 0.5 * (k * (phi - rest) ** 2).sum(axis=1) - phi @ m
    stated = m @ rest + (m**2 / (2 * k)).sum()
    for energy in (WOUND.energy(phi), pose(WOUND).energies(phi)):
        assert np.abs(energy - springs - stated).max() < 1e-13 * stated
    problem = pose(WOUND)
    gradient = problem.scale * np.array([problem.local(x).gradient for x in phi])
    assert np.abs(gradient - (k * (phi - rest) - m)).max() < 1e-14


def test_a_preload_that_a_rest_angle_gives_too_is_the_same_spring():
    rest = Scene(FOUR, (1, 0.5, 0.5, 0.25), (2, -1, 0.5, 1), "none", "fold-limits")
    both = replace(rest, rest_angles=(1, -1, -0.5, 0), preload=(1, 0, 0.5, 0.25))
    assert both.wound_angles == rest.rest_angles and both != rest
    assert (pose(both).parameters.vector == pose(rest).parameters.vector).all()
    assert pose(both).labels.order.tolist() == pose(rest).labels.order.tolist()


def test_files_and_sweeps_know_it(tmp_path):
    assert parse_scene(format_scene(WOUND)) == WOUND
    assert scene_from_dict(json.loads(json.dumps(scene_to_dict(WOUND)))) == WOUND
    assert replace(WOUND, preload=(0, 0, 0, 0)) == replace(WOUND, preload=())
    assert "preload" not in format_scene(replace(WOUND, preload=(0, 0, 0, 0)))
    data = scene_to_dict(replace(WOUND, preload=()))
    axis = {"set": "creases.preload[3]", "values": [0, -4]}
    sweep = parse_sweep({"scene": data, "axes": [axis]})
    assert sweep.scene(0).preload == () and sweep.scene(1).preload == (0, 0, -4, 0)
    path = tmp_path / "states.fold"
    found = find_minima(WOUND, prove=False, escape=False)
    write_fold(found, path)
    back = read_fold_scene(path, on_note=lambda note: None, symmetry="none", contact="fold-limits")
    assert back.preload == WOUND.preload
    written = json.loads(path.read_text())
    written[PRELOAD_KEY][0] = "3"
    path.write_text(json.dumps(written))
    with pytest.raises(FoldFileError, match="preload"):
        read_fold_scene(path, on_note=lambda note: None)


def test_mechanics_with_preload_must_share_the_symmetry():
    scene = examples.degree6("5*pi/12")
    assert replace(scene, preload=(0.1, 0, 0, 0, 0, 0)).group.name == "D1"
    pair = replace(scene, preload=(0, 0.1, 0, 0, 0, 0.1 + 1e-12), symmetry="auto")
    assert pair.group.name == "D1" and pair.preload[1] == pair.preload[5] != 0.1
    assert 1e-12 < pair.adjusted < 1e-10
    one = replace(scene, preload=(0, 0.1, 0, 0, 0, 0), symmetry="auto")
    assert one.group.is_trivial
    with pytest.raises(SymmetryError, match="preload"):
        replace(one, symmetry="D1")
    # the same torque by rest angles on one side and by preload on the other is no symmetry of what is stated
    rest = list(scene.rest_angles)
    rest[1] -= 1.0
    odd = replace(
        scene, rest_angles=rest, preload=(0, scene.stiffness[1], 0, 0, 0, 0), symmetry="auto"
    )
    assert odd.wound_angles == pytest.approx(scene.wound_angles) and odd.group.is_trivial


@pytest.mark.parametrize("preload", [(1, 2), (math.nan, 0, 0, 0), (0, 0, 0, 400), "1"])
def test_wrong_preload_is_refused_by_name(preload):
    with pytest.raises(SceneError, match="preload"):
        replace(WOUND, preload=preload)


def test_search_and_proof_agree_under_preload():
    found = find_minima(WOUND, prove=False, escape=False)
    proof = prove(ReducedVertex(WOUND))
    assert not proof.undecided
    points = np.array([p.fold_angles for p in proof.minima])
    states = np.array([m.fold_angles for m in found.minima])
    apart = np.abs(points[:, None] - states).max(axis=2)
    assert apart.min(axis=0).max() < 1e-9 and apart.min(axis=1).max() < 1e-9
