"""Stops: minima against scans that share no code with the package, symmetry, files."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.errors import SceneError, SymmetryError
from origami_nlp.pattern import table, tapered_limit
from tests.independent import scan_four
from tests.patterns import scene_pattern


def drawn(rng, contact, flat=True):
    """A vertex of degree four with a stop on either side of each crease; its flat state may be beyond one."""
    a = rng.dirichlet([4] * 4) * 2 * math.pi
    while a.max() > 3.0:
        a = rng.dirichlet([4] * 4) * 2 * math.pi
    k, rest = np.exp(rng.normal(size=4)), rng.uniform(-math.pi, math.pi, 4)
    limits = np.radians(rng.uniform(20, 175, (4, 2))) * (-1, 1)
    limits[rng.integers(4)] = -math.pi, math.pi
    if not flat:
        limits[rng.integers(4), 0] = 0.2
    return Scene(Vertex(tuple(a)), tuple(k), tuple(rest), "none", contact, limits=limits)


def compared(scene, samples=6_001):
    """Energies that a search finds, and those of a scan."""
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    energy, _ = scan_four.minima(
        lambda x: 0.5 * (x - rest) ** 2 @ k,
        np.array(scene.vertex.sector_angles),
        scene.limit_angles,
        scene.contact,
        samples,
    )
    return [m.energy for m in o.find_minima(scene).minima], sorted(energy)


@pytest.mark.parametrize(
    ("seed", "contact", "flat"), [(3, "full", True), (4, "fold-limits", False)]
)
def test_minima_are_those_of_a_scan(seed, contact, flat):
    rng = np.random.default_rng(seed)
    for _ in range(1):
        ours, theirs = compared(drawn(rng, contact, flat))
        assert np.allclose(ours, theirs, atol=1e-2, rtol=2e-3)


def test_stops_belong_to_the_symmetry():
    scene = o.examples.degree6("pi/3", ratio=0.3)
    same = replace(scene, limits=(-1.2, 1.2))
    assert same.group.name == "D1"
    free = o.find_minima(replace(same, symmetry="none"))
    kept = o.find_minima(same)
    assert [m.energy for m in kept.minima] == pytest.approx([m.energy for m in free.minima])
    with pytest.raises(SymmetryError, match="fold limits"):
        replace(scene, limits=[(-1.2, 1.2)] * 5 + [(-1, 1)])


def test_turned_over_the_stops_change_sides():
    scene = drawn(np.random.default_rng(7), "full")
    over = replace(
        scene,
        rest_angles=tuple(-a for a in scene.rest_angles),
        limits=tuple((-high, -low) for low, high in scene.limits),
    )
    one, two = o.find_minima(scene), o.find_minima(over)
    assert [m.energy for m in one.minima] == pytest.approx(
        [m.energy for m in two.minima], rel=1e-12
    )
    found = [np.array(m.fold_angles) for m in one.minima]
    assert np.allclose(found, [-np.array(m.fold_angles) for m in two.minima], atol=1e-9)


def test_a_vertex_as_a_pattern_has_the_same_states():
    rng = np.random.default_rng(11)
    for _ in range(2):
        scene = drawn(rng, "full")
        sheet = scene_pattern(scene)
        assert sheet.limits == scene.limits
        vertex, pattern = (o.find_minima(x, prove=False, escape=False) for x in (scene, sheet))
        assert [m.energy for m in pattern.minima] == pytest.approx(
            [m.energy for m in vertex.minima]
        )


def test_files_keep_stops(tmp_path):
    scene = replace(drawn(np.random.default_rng(2), "full"), panels=(6.0, 10.0))
    most = tapered_limit(6.0, 10.0)
    assert math.degrees(most) == pytest.approx(180 - 2 * math.degrees(math.atan(3 / 10)))
    assert np.abs(scene.limit_angles).max() <= most
    assert o.parse_scene(o.format_scene(scene)) == scene
    sheet = o.examples.pattern("miura", 2, 2).with_limits([-150, 120], degrees=True)
    result = o.find_minima(sheet.with_springs(1.0, 2.5))
    o.write_fold(result, tmp_path / "states.fold")
    again = o.read_pattern(tmp_path / "states.fold")
    assert np.allclose(again.limit_angles, sheet.limit_angles, atol=1e-15)
    assert all((np.abs(m.fold_angles) <= math.radians(150)).all() for m in result.minima)


@pytest.mark.parametrize(
    ("limits", "why"),
    [
        ((1.0, -1.0), "with room"),
        ((-4.0, 1.0), "within"),
        ([(-1, 1)] * 3, "one for each crease"),
        ("-1..1", "one pair"),
        ((-1, 1, 2), "one pair"),
    ],
)
def test_wrong_limits_are_named(limits, why):
    with pytest.raises(SceneError, match=why):
        Scene(Vertex(("pi/2",) * 4), (1,) * 4, (0,) * 4, limits=limits)


def test_stops_that_leave_no_state_are_said_to():
    """Round a vertex of degree four one crease folds the other way (Kawasaki, Maekawa): no state has all above 0."""
    v = Vertex.from_degrees((70, 80, 120, 90))
    scene = Scene(v, (1, 2, 3, 2), (1.0, -0.5, 2.9, 0.8), "none", "full", limits=(0.3, 1.0))
    found = o.find_minima(scene)
    assert not found.minima and "no state closes within all limits" in found.verdict
    x = scan_four.closed_states(np.array(v.sector_angles), 2_001)
    assert not ((x >= 0.3) & (x <= 1.0)).all(axis=1).any()


def test_what_is_not_decided_is_not_called_no_state():
    """Slack hinges: whole sets of states are level with the flat one."""
    x = np.array([-3.2, -2, -1, 1, 2, 3.2])
    slack = table(np.clip(x, -math.pi, math.pi), [-1.0, -0.5, 0, 0, 0.5, 1.0])
    v = Vertex.from_degrees((70, 80, 120, 90))
    scene = Scene(v, (1,) * 4, (0,) * 4, "none", "full", laws=(slack,) * 4)
    found = o.find_minima(scene, escape=False, prove=False)
    assert 0 < len(found.search.undecided) < 30  # one stands for each level piece of a curve
    assert "not decided whether there is a stable" in found.verdict
    assert not found.stable and "0 stable states" not in str(found)
