"""States followed and loaded with stops and hinge laws: linear laws are springs, laws against searches and scans."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.errors import OptionError
from origami_nlp.pattern import double_well, linear
from tests.independent import scan_four

SECTORS = (70, 80, 120, 90)
ALL = np.tile([[-math.pi], [math.pi]], 4)


def random_scene(laws=(), seed=4, **more):
    rng = np.random.default_rng(seed)
    k, rest = np.exp(rng.normal(size=4)), rng.uniform(-2, 2, 4)
    vertex = Vertex.from_degrees(SECTORS)
    return Scene(vertex, tuple(k), tuple(rest), "none", laws=laws, **more)


@pytest.mark.slow  # a survey of several seconds
def test_the_depth_of_wells_against_scans():
    """How many minima there are over the depth of a double well beside springs, and where that changes."""
    law = double_well(1.0, 1.0)
    stated = random_scene((None, law, None, law), seed=2)
    atlas = o.follow(stated, "law_scale[2]+law_scale[4]=0.1:4", checks=3)
    k, rest = np.array(stated.stiffness), np.array(stated.rest_angles)

    def count(t):
        energy = lambda x: (  # noqa: E731
            0.5 * (k * (x - rest) ** 2)[:, [0, 2]].sum(axis=1)
            + t * ((x[:, [1, 3]] ** 2 - 1) ** 2).sum(axis=1)
        )
        return len(scan_four.minima(energy, np.radians(SECTORS), ALL, "full", 4_001)[0])

    folds = [e.t for e in atlas.events if "fold" in e.type]
    assert folds
    for t in (0.11, *(f * share for f in folds for share in (0.97, 1.03)), 3.9):
        assert sum(bool(s.kind) for s in atlas.at(t)) == count(t), t


def test_stops_along_a_path_and_what_is_refused():
    held = random_scene(limits=((-1.2, 1.2),) * 4, seed=9)
    atlas = o.follow(held, "rest_angles[1]=-2.5:2.5", checks=3)
    events = [e for e in atlas.events if "stop" in e.words()]
    assert events
    for e in events:  # a search on either side
        near = [
            min(
                np.abs(np.array(m.fold_angles) - e.fold_angles).max()
                for m in o.find_minima(
                    replace(held, rest_angles=(e.t + d, *held.rest_angles[1:])), escape=False
                ).minima
            )
            for d in (-1e-4, 1e-4)
        ]
        assert min(near) < 1e-3
    law = double_well(1.0, 1.0)
    for what, why in {
        "stiffness[1]=1:2": "hinge law in place of a spring",
        "rest_angles[1]=0:1": "hinge law",
        "law_scale[2]=1:2": "crease 2 has no hinge law",
        "law_shift[1]=-1:1": "known on",
        "law_scale[1]=-1:1": "above 0",
    }.items():
        with pytest.raises((OptionError, o.OrigamiError), match=why):
            o.follow(random_scene((law, None, None, None)), what)
    with pytest.raises(OptionError, match="hinge law"):
        o.follow(o.examples.pattern("miura", 2, 2).with_laws(law), "stiffness[1]=1:2")


# ---------------------------------------------------------------- under a load


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
    plain = random_scene(seed=seed, limits=((-1.5, 1.5),) * 4)
    same_path(*(o.load_path(s, 1) for s in (plain, of_laws(plain))))


def test_a_snap_is_where_a_scan_loses_the_state():
    law = double_well(1.0, 1.0)
    scene = replace(random_scene(seed=4), laws=(law,) * 4)
    path = o.load_path(scene, 1, to=4.0)
    (snap,) = path.snaps
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
    scene = random_scene(
        seed=4, limits=((-1.5, 1.5),) * 4, laws=(None, double_well(0.3, 1.0), None, None)
    )
    path = o.load_path(scene, 1, to=6.0)
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
