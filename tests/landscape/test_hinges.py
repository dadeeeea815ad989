"""Pictures, spaces and boundaries with stops and hinge laws: linear laws are springs, laws are no geometry."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.chart import landscape
from origami_nlp.pattern import double_well, linear
from tests.independent.admissible import admissible


def of_laws(plain):
    return replace(plain, laws=tuple(map(linear, plain.stiffness, plain.rest_angles)))


def test_landscapes_show_the_energy_of_laws():
    plain = o.examples.degree6("5*pi/12", 2)
    one, two = (landscape(s, 48) for s in (plain, of_laws(plain)))
    for a, b in zip(one.branches, two.branches, strict=True):
        assert np.allclose(a.energy, b.energy, rtol=1e-9, atol=1e-12, equal_nan=True)
    law = double_well(0.1, 1.0)
    wells = replace(plain, laws=(law, None, None) * 2)
    (branch,) = landscape(wells, 48).branches
    phi = branch.fold_angles
    k, rest = np.array(plain.stiffness), np.array(plain.rest_angles)
    by_hand = 0.5 * k * (phi - rest) ** 2
    by_hand[..., [0, 3]] = 0.1 * (phi[..., [0, 3]] ** 2 - 1) ** 2
    assert np.allclose(branch.energy, by_hand.sum(axis=-1), atol=1e-6, equal_nan=True)
    (held,) = landscape(replace(wells, limits=(-1.0, 1.0)), 48).branches
    within = (np.abs(phi) <= 1.0).all(axis=-1)
    assert np.array_equal(np.isfinite(held.energy), within & np.isfinite(branch.energy))
    assert np.allclose(held.energy[within], branch.energy[within], equal_nan=True)


def test_curves_of_one_degree_of_freedom_end_at_stops():
    vertex = Vertex.from_degrees((70, 80, 120, 90))
    scene = Scene(vertex, (1.0,) * 4, (0.3,) * 4, "none", limits=((-1.2, 0.9),) * 4)
    for branch in landscape(scene, 64).branches:
        phi = branch.fold_angles[np.isfinite(branch.fold_angles).all(axis=-1)]
        assert len(phi) and phi.min() >= -1.2 - 1e-9 and phi.max() <= 0.9 + 1e-9
        # near one of them: nothing more is left out
        assert np.minimum(phi + 1.2, 0.9 - phi).min() < 0.15


@pytest.mark.slow  # a second look at what other tests of the room say
def test_the_admissible_space_knows_no_springs():
    plain = o.examples.degree6("pi/3")
    one, two = (o.find_space(s, rings=8) for s in (plain, of_laws(plain)))
    assert (one.holes, one.euler_characteristic) == (two.holes, two.euler_characteristic)


@pytest.mark.slow  # seconds of curves or searches
def test_landscapes_end_at_stops(tmp_path):
    """The area of the states, against counting points of a grid by the closed form of the paper's chart."""
    from origami_nlp.chart import chart_of, outline_of

    scene = replace(o.examples.degree6("pi/3"), limits=np.radians((-70, 100)))
    t = (np.arange(100) + 0.5) / 100 * 2 * math.pi - math.pi
    for contact in ("fold-limits", "full"):
        some = replace(scene, contact=contact)
        region = outline_of(some).regions[0]
        phi = chart_of(some).fold_angles(0, *np.meshgrid(t, t)).reshape(-1, 6)
        phi = phi[((phi >= math.radians(-70)) & (phi <= math.radians(100))).all(axis=1)]
        inside = admissible(np.array(some.vertex.sector_angles), phi, contact).sum()
        assert region.area == pytest.approx(inside * (2 * math.pi / 100) ** 2, rel=0.02)
    result = o.find_minima(scene, full=False, escape=False, max_starts=16)
    found = o.find_landscape(result, size=41)
    assert found.boundary is None and "there are stops" in str(found)
    result.draw(tmp_path / "map.png")
    assert found.view_content().panels
