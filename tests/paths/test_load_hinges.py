"""Load paths with stops and hinge laws: a linear law is a spring, snaps and stops where scans see them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.pattern import double_well, linear
from tests.independent import scan_four

SECTORS = (70, 80, 120, 90)


def drawn(seed, **more):
    rng = np.random.default_rng(seed)
    k, rest = np.exp(rng.normal(size=4)), rng.uniform(-2, 2, 4)
    return Scene(Vertex.from_degrees(SECTORS), tuple(k), tuple(rest), "none", **more)


def of_laws(plain):
    return replace(plain, laws=tuple(map(linear, plain.stiffness, plain.rest_angles)))


def same_path(one, two, atol=1e-9):
    assert [len(leg.points) for leg in one.legs] == [len(leg.points) for leg in two.legs]
    for a, b in zip(one.legs, two.legs, strict=True):
        for field in ("t", "fold_angles"):
            mine, theirs = ([getattr(p, field) for p in leg.points] for leg in (a, b))
            assert np.allclose(mine, theirs, atol=atol)
    assert [s.t for s in one.snaps] == pytest.approx([s.t for s in two.snaps], rel=1e-9)
    assert [s.released for s in one.snaps] == pytest.approx(
        [s.released for s in two.snaps], rel=1e-8
    )
    assert [e.words() for e in one.events] == [e.words() for e in two.events]


@pytest.mark.parametrize("seed", [9, pytest.param(4, marks=pytest.mark.slow)])
def test_a_linear_law_has_the_path_of_the_spring(seed):
    plain = drawn(seed, limits=((-1.5, 1.5),) * 4)
    same_path(*(o.load_path(s, 1, confirm=False) for s in (plain, of_laws(plain))))


@pytest.mark.slow  # seconds of curves or searches
def test_linear_laws_have_the_path_of_a_panel_with_its_symmetry():
    plain = o.examples.degree6("5*pi/12")
    same_path(*(o.load_path(s, 1, to=0.05, confirm=False) for s in (plain, of_laws(plain))))


@pytest.mark.slow  # a second look at what other tests of the room say
def test_a_linear_law_has_the_path_of_the_spring_on_a_pattern():
    plain = o.examples.pattern("miura", 2, 2).with_springs(1.0, 0.8)
    laws = plain.with_laws([linear(k, r) for k, r in zip(plain.stiffness, plain.rest, strict=True)])
    same_path(*(o.load_path(p, 1, to=0.3) for p in (plain, laws)), atol=1e-7)


def test_a_snap_is_where_a_scan_loses_the_state():
    law = double_well(1.0, 1.0)
    scene = replace(drawn(4), laws=(law,) * 4)
    path = o.load_path(scene, 1, to=4.0)
    (snap,) = path.snaps
    assert snap.confirmed is not None and snap.confirmed.minima == (
        snap.confirmed.minima[1] + 1,
        snap.confirmed.minima[1],
    )
    limits = np.tile([[-math.pi], [math.pi]], 4)

    def near(t, phi):
        """How far the nearest minimum of a scan at a load is."""
        energy = lambda x: ((x**2 - 1) ** 2).sum(axis=1) - t * x[:, 0]  # noqa: E731
        _, states = scan_four.minima(energy, np.radians(SECTORS), limits, "full", 3_001)
        return np.abs(states - phi).max(axis=1).min()

    end = np.array(snap.before)
    assert near(0.999 * snap.t, end) < 0.2 < 0.5 < near(1.001 * snap.t, end)
    # half way, the state of the path is one of the scan's
    middle = min(path.legs[0].points, key=lambda p: abs(p.t - 0.5 * snap.t))
    assert near(middle.t, np.array(middle.fold_angles)) < 5e-3
    # beyond the snap the path rests where the scan does
    assert near(snap.t, np.array(snap.after)) < 5e-3


def test_stops_close_under_a_load_where_a_scan_reaches_them():
    scene = drawn(4, limits=((-1.5, 1.5),) * 4, laws=(None, double_well(0.3, 1.0), None, None))
    path = o.load_path(scene, 1, to=6.0, confirm=False)
    reached = [e for e in path.events if e.type == "closes"]
    assert reached and all("stop" in e.contact for e in reached)
    limits = np.tile([[-1.5], [1.5]], 4)

    def held(t, phi):
        """Whether the minimum of a scan next to a state is at a stop."""
        x_of = lambda x: scene.energy(x) - t * x[:, 0]  # noqa: E731
        _, states = scan_four.minima(x_of, np.radians(SECTORS), limits, "full", 6_001)
        near = states[np.abs(states - phi).max(axis=1).argmin()]
        assert np.abs(near - phi).max() < 0.05
        return bool((np.abs(near) > 1.5 - 2e-3).any())

    event = reached[0]
    phi = np.array(event.fold_angles)
    assert not held(0.97 * event.t, phi) and held(1.03 * event.t, phi)
