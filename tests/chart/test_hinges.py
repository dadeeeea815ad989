"""Pictures, spaces and boundaries with stops and hinge laws: linear laws are springs, laws are no geometry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.chart import landscape
from origami_nlp.pattern import double_well, linear


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
