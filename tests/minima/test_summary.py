"""What people read first of a list of minima: verdict, a line a state, images; all else on demand."""

from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.minima.rows import held_words
from origami_nlp.minima.summary import find_images
from origami_nlp.pattern_problem import pose
from tests.computed_once import once, panel_result

SCENE = o.examples.degree6("pi/3", 1)


@pytest.fixture(scope="module")
def six():
    return panel_result(SCENE, full=True)


@pytest.fixture(scope="module")
def sheet():
    return once(
        "sheet of two rows",
        lambda: o.find_minima("metasheet:2x3", starts=4, prove=False, escape=False),
    )


def images(origami, minima):
    return find_images(origami, pose(origami), minima)


def test_images_are_found_by_symmetry_never_by_energy(six, sheet):
    assert images(six.scene, six.minima) == {4: (3, "rotated copy of 3")}
    assert [k for k in images(sheet.pattern, sheet.minima)] == [3]
    # springs that differ: the same list is no list of images any more
    stiffness = (*SCENE.stiffness[:3], 1.5 * SCENE.stiffness[3], *SCENE.stiffness[4:])
    assert not images(replace(SCENE, stiffness=stiffness), six.minima)
    other = sheet.pattern.with_springs(np.arange(1.0, 8.0), sheet.pattern.rest)
    assert not images(other, sheet.minima)
    # equal energies elsewhere
    third, fourth = six.minima[2:]
    moved = replace(fourth, fold_angles=tuple(np.array(fourth.fold_angles) + 1e-3))
    assert moved.energy == fourth.energy and not images(six.scene, (third, moved))


def test_an_image_is_another_state_with_the_same_energy(six):
    scene, phi = six.scene, np.array([m.fold_angles for m in six.minima])
    group = pose(scene).moves
    assert len(group) == 1  # half a turn: the mirror is imposed
    alike = replace(scene, rest_angles=(1.0,) * 6, symmetry="none")
    assert len(pose(alike).moves) == 11
    assert not pose(replace(alike, stiffness=(1.0, 2.0, 4.0, 3.0, 5.0, 6.0))).moves
    for move in group:
        moved = pose(scene).expand(move(pose(scene).reduce(phi)))
        assert [scene.energy(x) for x in moved] == pytest.approx(
            [m.energy for m in six.minima], abs=1e-14
        )


def test_soft_springs_beside_a_stiff_one_keep_their_energy():
    """Before: an energy below 1e-9 of the mean stiffness, which one crease of 1e8 N m/rad sets, was printed as 0."""
    vertex = o.Vertex.from_degrees((61.2, 58.9, 60.3, 59.6, 60.4, 59.6))
    scene = o.Scene(vertex, (1e8, 1, 1, 1, 1, 1), (0.15, -0.1, 0.05, 0.2, -0.15, 0.1), "none")
    result = o.find_minima(scene, max_starts=60, prove=False, escape=False)
    assert len(result.minima) == 2
    m = result.minima[0]
    springs = sum(
        0.5 * k * (a - b) ** 2
        for k, a, b in zip(scene.stiffness, m.fold_angles, scene.rest_angles, strict=True)
    )
    assert m.energy == pytest.approx(springs, rel=1e-6) and m.energy > 1e-3
    assert f" 1  {m.energy:.6g} " in str(result)


def test_a_small_moment_beside_a_stiff_spring_is_no_idle_contact(six):
    first = six.minima[0]
    (contact,) = first.contacts
    small = replace(contact, multiplier=1e-3, multiplier_range=(1e-3, 1e-3))
    assert held_words(replace(first, contacts=(small,))).endswith(": 0.001 N m")
    idle = replace(
        contact, multiplier=3e-14, multiplier_range=(0.0, 0.0)
    )  # rounding of a vector, exact in its range
    assert held_words(replace(first, contacts=(idle,))).endswith("no load")
