"""Rows folded flat that flaps of others keep so, against their springs.

A second way to see them: a graph of all states (`independent/state_graph`), and closed states beside each, made of
rotations alone, of which the lower ones are pierced by the Flexible Collision Library.
"""

import itertools
import math

import numpy as np
import pytest

import origami_nlp as o
from tests.independent.rigid import Rigid, _mesh, fcl
from tests.independent.state_graph import StateGraph
from tests.proof.test_meshes import sprung

SHRUNK = 1e-6
"""Facets are drawn in by this share, so that those that lie on each other do not collide."""
HELD = 180, 180, 159.6, 180, 180, 180, 159.6
"""Size of the fold angles of two states of miura:2x3 with random springs [deg]."""


def folds(found):
    return np.array([m.fold_angles for m in found.minima])


@pytest.fixture(scope="module")
def sheet():
    return sprung(o.examples.pattern("miura", 2, 3), 0)


@pytest.fixture(scope="module")
def found(sheet):
    return o.find_minima(sheet, escape=False, seed=1, effort="thorough")


def held(found):
    """The states in which the left row is folded flat, the right one nearly, and each of one sign in each facet."""
    x = folds(found)
    near = np.abs(np.abs(np.degrees(x)) - HELD).max(axis=1) < 0.1
    return x[near & (x[:, 0] > 0) & (x[:, 5] < 0)]


def agree(listed, graph, within):
    far = np.abs(listed[:, None] - graph[None]).max(axis=2)
    return far.min(axis=0).max() < within and far.min(axis=1).max() < within


def test_the_search_lists_what_a_graph_of_states_has(sheet, found):
    assert len(found.minima) == 12 and not found.search.undecided
    assert agree(folds(found), StateGraph(sheet, 16).minima(), 1.2 * math.pi / 16)


def test_lower_states_beside_those_that_flaps_hold_all_cross(sheet, found):
    rigid, rng = Rigid(sheet), np.random.default_rng(0)
    states, graph = held(found), StateGraph(sheet, 1)
    assert len(states) == 2
    for phi in states:
        assert np.abs(rigid.open(phi)).max() < 1e-9 and graph.paper(phi)
        lower = [x for x in beside(rigid, phi, rng) if energy(sheet, x) < energy(sheet, phi) - 1e-9]
        assert len(lower) > 20 and all(cross(rigid, x) for x in lower)


def energy(sheet, phi):
    return 0.5 * float(sheet.stiffness @ (phi - sheet.rest) ** 2)


def beside(rigid, phi, rng):
    """Closed states near one, within fold limits: rows turned by themselves, and all creases at random."""
    for k in range(200):
        d = 0.02 * rng.uniform(-1, 1, len(phi))
        if k % 2:
            # rows of the left and of the right flap, whose two creases turn by opposite angles
            d = np.array([-abs(d[0]), 0, d[2], 0, 0, abs(d[0]), -d[2]])
        x = np.clip(phi + d, -math.pi, math.pi)
        for _ in range(20):
            miss = rigid.open(x)
            if np.abs(miss).max() < 1e-10:
                # beside states folded flat, where closure loses rank, it is met to the square of the distance
                x = np.where(math.pi - np.abs(x) < 1e-4, np.copysign(math.pi, x), x)
                if np.abs(rigid.open(x)).max() < 1e-9:
                    yield x
                break
            step = np.linalg.lstsq(rigid.differences(x), miss, rcond=1e-6)[0]
            x = np.clip(x - step, -math.pi, math.pi)


def cross(rigid, phi):
    inner, corners = [], rigid.polygons(phi)
    for x in corners:
        middle = x.mean(axis=0)
        inner.append(_mesh(middle + (1 - SHRUNK) * (x - middle)))
    return any(
        fcl.collide(inner[a], inner[b], fcl.CollisionRequest(), fcl.CollisionResult())
        for a, b in itertools.combinations(range(len(inner)), 2)
        if not in_one_plane(corners[a], corners[b])
    )


def in_one_plane(a, b):
    normal = np.cross(a[1] - a[0], a[2] - a[0])
    return np.abs((b - a[0]) @ normal).max() < 1e-9


def test_without_contact_springs_open_them(sheet, found):
    free = folds(o.find_minima(sheet, escape=False, contact="fold-limits"))
    for phi in held(found):
        assert np.abs(free - phi).max(axis=1).min() > 1.0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("size", [(2, 3), (3, 2)])
def test_random_springs(size, seed):
    """States of the graph that a search lacked: of 13 of the 20 sheets of 2 x 3, of six of those of 3 x 2."""
    pressed = sprung(o.examples.pattern("miura", *size), seed)
    steps = 24 if size == (2, 3) else 12
    listed, graph = folds(o.find_minima(pressed, escape=False)), StateGraph(pressed, steps).minima()
    far = np.abs(listed[:, None] - graph[None]).max(axis=2)
    assert far.min(axis=0).max() < 1.2 * math.pi / steps
