"""Facets that bend: how they are cut, and their limit of rigid facets."""

from __future__ import annotations

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import SceneError
from origami_nlp.pattern import double_well, make_pattern, with_bending
from tests.relabelled import relabelled

ASKED = {"effort": "quick", "starts": 4, "escape": False, "prove": False}


def test_quadrilaterals_get_their_short_diagonals():
    sheet = o.examples.pattern("miura", 2, 3).with_springs(1.0, 0.7).with_limits((-2.5, 2.5))
    soft = with_bending(sheet, 2.0)
    n = sheet.creases
    assert soft.facets == 2 * sheet.facets and soft.creases == n + sheet.facets
    assert np.array_equal(soft.ends[:n], sheet.ends) and np.array_equal(soft.rest[:n], sheet.rest)
    assert np.allclose(soft.stiffness[n:], 2.0 * soft.lengths[n:]) and not soft.rest[n:].any()
    assert np.allclose(soft.limit_angles[:, :n], sheet.limit_angles)
    assert np.allclose(np.abs(soft.limit_angles[:, n:]), np.pi)
    assert "short diagonals" in soft.notes[-1]
    laws = with_bending(sheet.with_laws(double_well(1.0, 1.0)), 2.0).laws
    assert laws[:n].count(None) == 0 and set(laws[n:]) == {None}


def test_states_tend_to_those_of_rigid_facets_like_one_over_the_stiffness():
    """Of a vertex whose rest angles do not fit together: rigid facets and bending ones differ, by slope -1."""
    sheet = o.examples.pattern("miura", 2, 2).with_springs(1.0, [1.2, -1.0, 0.9, 1.1])
    rigid = o.find_minima(sheet, prove=False, escape=False).minima[0]
    off, energies = [], []
    for stiffness in (1e1, 1e2, 1e3, 1e4):
        soft = o.find_minima(with_bending(sheet, stiffness), **ASKED)
        found = np.array([m.fold_angles[: sheet.creases] for m in soft.minima])
        apart = np.abs(found - rigid.fold_angles).max(axis=1)
        off.append(apart.min())
        energies.append(rigid.energy - soft.minima[int(apart.argmin())].energy)
    assert np.allclose(np.diff(np.log10(off)), -1, atol=0.1)
    # a sheet that may bend as well is never stiffer
    assert min(energies) > 0 and np.allclose(np.diff(np.log10(energies)), -1, atol=0.1)


def test_what_cannot_bend_says_so():
    triangles = make_pattern(np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]), [(0, 1, 2), (0, 2, 3)])
    with pytest.raises(SceneError, match="three corners"):
        with_bending(triangles, 1.0)
    dart = np.array([[0.0, 0], [2, -1], [1, 0], [2, 1], [3, 0]])
    arrow = make_pattern(dart, [(0, 1, 2, 3), (1, 4, 3, 2)])
    with pytest.raises(SceneError, match="not convex"):
        with_bending(arrow, 1.0)


def squares(rows, columns, springs=None):
    """A sheet of squares."""
    corners = np.array([[x, y] for y in range(rows + 1) for x in range(columns + 1)], float)
    at = lambda x, y: y * (columns + 1) + x  # noqa: E731
    facets = [
        (at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1))
        for y in range(rows)
        for x in range(columns)
    ]
    sheet = make_pattern(corners, facets)
    return sheet if springs is None else sheet.with_springs(springs[: sheet.creases])


def seen_from_cuts(sheet, soft):
    """What does not change with numbers: from each end of each diagonal, distances to all corners and all ends."""
    ends = soft.corners[soft.ends[sheet.creases :]]
    others = np.concatenate([sheet.corners, ends.reshape(-1, 3)])
    away = np.linalg.norm(ends[:, :, None] - others, axis=-1).round(6)
    return sorted(sorted(tuple(sorted(d)) for d in pair) for pair in away.tolist())


@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_equal_diagonals_are_chosen_whatever_corners_are_called(seed, mirror):
    springs = np.exp(np.random.default_rng(3).normal(size=40))
    for sheet in (squares(2, 3, springs), squares(2, 3), o.examples.pattern("squaretwist")):
        one = with_bending(sheet, 1.0)
        other_sheet = relabelled(sheet, seed, mirror)[0]
        other = with_bending(other_sheet, 1.0)
        assert seen_from_cuts(sheet, one) == seen_from_cuts(other_sheet, other)
