"""A sweep keeps one symmetry at all of its values."""

import math
import tomllib

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.paths import parse_parameter_range
from origami_nlp.pattern import with_symmetry_of
from origami_nlp.sweep import load_states, parse_sweep, run_sweep
from tests.sweep.test_sweep import Inline

THROUGH = """
[scene]
[scene.vertex]
sector_angles = ["pi/3", "pi/3", "pi/3", "pi/3", "pi/3", "pi/3"]
[scene.creases]
stiffness = [1, 1, 1, 1, 1, 1]
rest_angles = [-1.5, 1.5, 1.5, -1.5, 1.5, 1.5]
[[axes]]
name = "rest"
set = "creases.rest_angles[1]"
values = [-1.7, -1.5, -1.3]
[search]
starts = 60
max_starts = 300
"""
"""Through a value at which the springs have D2; beside it they have D1."""


def test_a_larger_symmetry_of_one_value_is_not_imposed(tmp_path):
    sweep = parse_sweep(tomllib.loads(THROUGH))
    alone = [o.Scene(s.vertex, s.stiffness, s.rest_angles) for s in map(sweep.scene, range(3))]
    assert [s.group.name for s in alone] == ["D1", "D2", "D1"]
    kept = [sweep.scene(k).group for k in range(3)]
    assert [g.name for g in kept] == ["D1"] * 3
    assert len({frozenset(g.elements) for g in kept}) == 1
    run_sweep(sweep, tmp_path, executor=Inline())
    counts = np.bincount(load_states(tmp_path).scene)
    options = {"full": False, "prove": False, "escape": False}
    imposed = o.find_minima(alone[1], **options)
    assert counts[1] > len(imposed.minima) and counts[0] == counts[1] == counts[2]
    # what keeps the larger symmetry is still there
    angles = load_states(tmp_path).query("scene == 1").filter(regex="^phi_").to_numpy()
    for m in imposed.minima:
        state = o.classify(sweep.scene(1), m.phi)
        near = np.abs(angles - m.phi).max(axis=1).min() < 1e-6
        assert near == (state.verdict == "minimum")


def test_a_stated_symmetry_is_kept_everywhere():
    stated = THROUGH.replace("[[axes]]", '[scene.model]\nsymmetry = "none"\n[[axes]]', 1)
    sweep = parse_sweep(tomllib.loads(stated))
    assert all(sweep.scene(k).group.is_trivial for k in range(3))


def test_the_same_mirrors_are_kept():
    """D1 about the third crease; equal springs have twelve symmetries and other mirrors to choose from."""
    vertex = o.Vertex(("pi/3",) * 6)
    rest = np.full(6, 0.4)
    equal = o.Scene(vertex, (1,) * 6, tuple(rest))
    rest[2] = 0.5
    one = o.Scene(vertex, (1,) * 6, tuple(rest))
    kept = with_symmetry_of(equal, one)
    assert equal.group.name == "D6" and set(kept.group.elements) == set(one.group.elements)
    other = o.Scene(vertex, (1, 2, 3, 4, 5, 6), (math.pi / 3,) * 6)
    with pytest.raises(o.OrigamiError, match="D1"):
        with_symmetry_of(other, one)


def test_angles_are_varied_in_the_unit_that_is_named():
    """One name, one meaning: in degrees with _deg, else in radians, in sweeps and in paths, whatever a file states."""
    degrees = THROUGH.replace(
        "rest_angles = [-1.5, 1.5, 1.5, -1.5, 1.5, 1.5]",
        "rest_angles_deg = [-90, 90, 90, -90, 90, 90]",
    )
    for text, given in (
        (THROUGH, math.pi / 6),
        (degrees, math.pi / 6),
        (THROUGH, 30.0),
        (degrees, 30.0),
    ):
        name = "creases.rest_angles_deg[2]" if given == 30.0 else "creases.rest_angles[2]"
        text = text.replace("creases.rest_angles[1]", name).replace(
            "[-1.7, -1.5, -1.3]", f"[{given}]"
        )
        (angle,) = {parse_sweep(tomllib.loads(text)).scene(0).rest_angles[1]}
        assert abs(angle - math.pi / 6) < 1e-15
    plain = parse_parameter_range("rest_angles[2]=30deg:60deg")
    assert parse_parameter_range("creases.rest_angles_deg[2]=30:60").name == f"creases.{plain.name}"
    over = parse_parameter_range("rest_angles_deg[2]=30:60")
    assert over == plain and over.unit == "rad"
    assert (
        parse_parameter_range("sector_angles_deg[1]+sector_angles_deg[2]=30:60deg").high
        == plain.high
    )
