"""Claims of section 4 against independent numbers."""

import numpy as np
import pytest
from origami_nlp.symbolic.claims import section4_combinatorics
from sympy.utilities.iterables import bracelets, necklaces

from origami_nlp.closed_forms import cone_contact_elevation, cone_fold_angles, cone_partial_angles
from tests.symbolic.closed_forms_reference import loop_quaternion


def _printed_valley(v, alpha):
    """eq:partial-valley-N as printed, in doubles."""
    s, c = np.sin(alpha), np.cos(v)
    if v > 0:
        return np.arccos(abs(c + s) / (1 + c * s))
    return np.arccos(abs(c - s) / (1 - c * s))


@pytest.mark.parametrize("degree", [6, 8, 10, 12])
def test_printed_partial_angle_is_right_up_to_contact_and_wrong_beyond(degree):
    contact = cone_contact_elevation(degree)
    alpha = 2 * np.pi / degree
    for v in (0.3 * contact, contact - 0.01, -0.3 * contact, -contact + 0.01):
        ours = cone_partial_angles(degree, v).value[0]
        assert _printed_valley(v, alpha) == pytest.approx(ours, rel=1e-12)
    beyond = -contact - 0.1
    ours = cone_partial_angles(degree, beyond).value[0]
    assert abs(_printed_valley(beyond, alpha) - ours) > 0.05
    flaps = [1] * (degree // 2)
    folds = cone_fold_angles(degree, beyond, flaps).value
    azimuths = 2 * np.pi / degree * np.arange(degree)
    assert np.abs(loop_quaternion(azimuths, folds) - [1, 0, 0, 0]).max() < 1e-13
    folds[0::2] = 2 * _printed_valley(beyond, alpha)
    assert np.abs(loop_quaternion(azimuths, folds) - [1, 0, 0, 0]).max() > 1e-2


def _rotation(axis, angle):
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


@pytest.mark.parametrize("flaps", [(1, 1, 1, 1), (1, -1, -1, 1)])
@pytest.mark.parametrize("v", [0.4, -0.4])
def test_crease_3_from_the_deformation_map(flaps, v):
    """c_3 = F_2 b_3 with F_2 from eq:cone-deformation, against both axes."""
    alpha = np.pi / 4
    b = [np.array([np.cos(i * alpha), np.sin(i * alpha), 0]) for i in range(3)]
    e2 = np.array([0.0, 1.0, 0.0])
    partial = cone_partial_angles(8, v).value
    rho = partial[0] if flaps[0] > 0 else partial[1]
    phi2 = cone_fold_angles(8, v, flaps).value[1]
    c3 = _rotation(e2, v) @ _rotation(b[0], rho) @ _rotation(b[1], phi2) @ b[2]

    def turned(m):
        axis = _rotation(np.array([0.0, 0.0, 1.0]), m * alpha) @ e2
        return _rotation(axis, v) @ b[2]

    assert np.abs(c3 - turned(2)).max() < 1e-14
    assert np.abs(c3 - turned(1)).max() > 0.05


def test_even_fold_angle_is_the_angle_between_normals_not_twice_it():
    v, degree = 0.3, 10
    alpha = 2 * np.pi / degree
    b2 = np.array([np.cos(alpha), np.sin(alpha), 0])
    normal = np.array([b2[1], -b2[0], 0])
    f1 = _rotation(np.array([0.0, 1.0, 0.0]), v) @ _rotation(
        np.array([1.0, 0.0, 0.0]), cone_partial_angles(degree, v).value[0]
    )
    n1 = f1 @ np.array([0.0, 0.0, 1.0])
    angle = np.arccos(n1 @ (n1 - 2 * (n1 @ normal) * normal))
    assert angle == pytest.approx(2 * v, rel=1e-12)


@pytest.mark.parametrize("degree", range(6, 21, 2))
def test_counts_against_sympys_generators(degree):
    """Independent enumeration by sympy.utilities.iterables."""
    flaps = degree // 2
    index = section4_combinatorics.DEGREES.index(degree)
    turns = sum(1 for _ in necklaces(flaps, 2))
    both = sum(1 for _ in bracelets(flaps, 2))
    assert section4_combinatorics.orbit_count(flaps, section4_combinatorics.shifts) == turns
    assert section4_combinatorics.orbit_count(flaps, section4_combinatorics.images) == both
    assert section4_combinatorics.TABLE[index] == turns
    formula = section4_combinatorics.bracelet_formula(*section4_combinatorics.PRINTED)
    assert formula(degree) == both


def test_mirror_image_of_a_chiral_state_is_no_rotation_of_it():
    """N = 12: fold angles of VVMVMM and of its mirror image, as cyclic sequences."""
    word = (1, 1, -1, 1, -1, -1)
    here = cone_fold_angles(12, 0.3, word).value
    there = cone_fold_angles(12, 0.3, word[::-1]).value
    gaps = [np.abs(np.roll(there, 2 * k) - here).max() for k in range(6)]
    assert min(gaps) > 0.1
    mirrored = [np.abs(np.roll(there[::-1], k) - here).max() for k in range(12)]
    assert min(mirrored) < 1e-12
