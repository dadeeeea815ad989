"""Pictures, spaces and boundaries with stops and hinge laws: linear laws are springs, laws are no geometry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.chart import landscape
from origami_nlp.errors import OptionError
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
    with pytest.raises(OptionError, match="not decided with fold limits of their own"):
        landscape(replace(wells, limits=(-1.0, 1.0)), 48)


def test_curves_of_one_degree_of_freedom_end_at_stops():
    vertex = Vertex.from_degrees((70, 80, 120, 90))
    scene = Scene(vertex, (1.0,) * 4, (0.3,) * 4, "none", limits=((-1.2, 0.9),) * 4)
    for branch in landscape(scene, 64).branches:
        phi = branch.fold_angles[np.isfinite(branch.fold_angles).all(axis=-1)]
        assert len(phi) and phi.min() >= -1.2 - 1e-9 and phi.max() <= 0.9 + 1e-9
        # near one of them: nothing more is left out
        assert np.minimum(phi + 1.2, 0.9 - phi).min() < 0.15


def test_the_admissible_space_knows_no_springs():
    plain = o.examples.degree6("pi/3")
    one, two = (o.find_space(s, rings=8) for s in (plain, of_laws(plain)))
    assert (one.holes, one.euler_characteristic) == (two.holes, two.euler_characteristic)
    with pytest.raises(OptionError, match="fold limits"):
        o.find_space(replace(plain, limits=(-1.0, 1.0)), rings=8)


def test_boundaries_over_factors_of_linear_laws_are_those_of_stiffnesses():
    plain = o.examples.degree6("pi/3")
    k = np.array(plain.stiffness)
    few = {"lines": 1, "across": 0, "effort": "quick"}
    ranges = [(float(k[0] * 0.3), float(k[0] * 3)), (float(k[1] * 0.5), float(k[1] * 2))]
    names = ["stiffness[1]+stiffness[4]", "stiffness[2]+stiffness[3]+stiffness[5]+stiffness[6]"]
    one = o.find_bifurcation_set(
        plain, *(f"{n}={a!r}:{b!r}" for n, (a, b) in zip(names, ranges, strict=True)), **few
    )
    laws = [n.replace("stiffness", "law_scale") for n in names]
    shares = [(0.3, 3.0), (0.5, 2.0)]
    two = o.find_bifurcation_set(
        of_laws(plain), *(f"{n}={a!r}:{b!r}" for n, (a, b) in zip(laws, shares, strict=True)), **few
    )
    assert len(one.curves) == len(two.curves) > 0
    for a, b in zip(one.curves, two.curves, strict=True):
        mine, theirs = (np.array([p.t for p in c.points]) for c in (a, b))
        mine = mine / k[:2]
        # points lie elsewhere on the same curve: its ends are the same, and cubics through it
        assert sorted(mine[[0, -1], 1]) == pytest.approx(sorted(theirs[[0, -1], 1]), rel=1e-7)
        order = np.argsort(mine[:, 1])
        along = CubicSpline(np.log(mine[order, 1]), np.log(mine[order, 0]))
        assert along(np.log(theirs[:, 1])) == pytest.approx(np.log(theirs[:, 0]), abs=1e-4)
