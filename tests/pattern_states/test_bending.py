"""Facets that bend: how they are cut, and their limit of rigid facets."""

from __future__ import annotations

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import SceneError
from origami_nlp.pattern import double_well, make_pattern, with_bending


def test_quadrilaterals_get_their_short_diagonals():
    sheet = o.examples.pattern("miura", 2, 3).with_springs(1.0, 0.7).with_limits((-2.5, 2.5))
    soft = with_bending(sheet, 2.0)
    n = sheet.creases
    assert soft.facets == 2 * sheet.facets and soft.creases == n + sheet.facets
    assert np.array_equal(soft.ends[:n], sheet.ends) and np.array_equal(soft.rest[:n], sheet.rest)
    assert np.allclose(soft.stiffness[n:], 2.0 * soft.lengths[n:]) and not soft.rest[n:].any()
    long = with_bending(sheet, 2.0, "long")
    assert (soft.lengths[n:] < long.lengths[n:]).all()
    assert np.allclose(soft.limit_angles[:, :n], sheet.limit_angles)
    assert np.allclose(np.abs(soft.limit_angles[:, n:]), np.pi)
    assert "short diagonals" in soft.notes[-1]
    laws = with_bending(sheet.with_laws(double_well(1.0, 1.0)), 2.0).laws
    assert laws[:n].count(None) == 0 and set(laws[n:]) == {None}


def test_states_tend_to_those_of_rigid_facets_like_one_over_the_stiffness():
    """Of a vertex whose rest angles do not fit together: rigid facets and bending ones differ, by slope -1."""
    sheet = o.examples.pattern("miura", 2, 2).with_springs(1.0, [1.2, -1.0, 0.9, 1.1])
    rigid = o.find_minima(sheet, escape=False).minima[0]
    off, energies = [], []
    for stiffness in (1e1, 1e2, 1e3, 1e4):
        soft = o.find_minima(with_bending(sheet, stiffness), starts=16, escape=False)
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
    with pytest.raises(SceneError, match="short or long"):
        with_bending(o.examples.pattern("miura", 2, 2), 1.0, "other")
