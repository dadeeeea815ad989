"""Springs for states that rest on stops: the minima of an independent scan are among those that the design promises."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.inverse_design import Target, Targets
from origami_nlp.kkt import project
from origami_nlp.pattern_problem import pose
from tests.independent import scan_four


def three_states(rng):
    """A random vertex of degree four and three of its states, 20 degrees apart."""
    while True:
        sectors = rng.uniform(40, 140, 3)
        sectors = np.append(sectors, 360 - sectors.sum())
        if 40 < sectors[3] < 140:
            break
    vertex = o.Vertex.from_degrees(tuple(sectors))
    model = pose(o.Scene(vertex, (1,) * 4, (0,) * 4, "none", "fold-limits"))
    states: list[Target] = []
    while len(states) < 3:  # (closed the other way round is no sheet)
        x, residual = project(model, rng.uniform(-2.5, 2.5, model.size))
        far = [np.abs(model.expand(x) - np.array(s.fold_angles)).max() for s in states]
        admissible = residual < 1e-9 and not o.State(model, x).refused
        if admissible and 0.3 < np.abs(x).max() < 2.8 and min(far, default=1) > 0.35:
            states.append(Target(f"s{len(states)}", tuple(model.expand(x))))
    return Targets(o.Scene(vertex, (1,) * 4, (0,) * 4, "none", "fold-limits"), tuple(states))


def drawn(rng):
    """Two states of a random vertex, the first of which is to rest on a stop of one crease."""
    while True:
        asked = three_states(rng)
        one, two = (np.array(s.fold_angles) for s in asked.states[:2])
        c = int(rng.integers(4))
        side = 1 if one[c] > 0 else -1
        if side * (one[c] - two[c]) > 0.1 and abs(one[c]) > 0.1:  # the other is inside
            limits = np.tile([-math.pi, math.pi], (4, 1))
            limits[c, (side + 1) // 2] = one[c]
            limits = tuple(map(tuple, limits.tolist()))
            states = asked.states[:2]
            return Targets(replace(asked.origami, limits=limits), states)


def held(scene, targets):
    """Which states the scan finds as minima, of the angles and energies of springs alone."""
    _, found = scan_four.minima(
        scene.energy,
        np.array(scene.vertex.sector_angles),
        np.array(targets.origami.limits).T,
        scene.contact,
        6_001,
    )
    off = [np.abs(found - np.array(s.fold_angles)).max(axis=1).min() for s in targets.states]
    return np.array(off) < 2e-2


@pytest.mark.parametrize("count", [2, pytest.param(15, marks=pytest.mark.slow)])
def test_states_on_stops_are_held(count):
    rng, made = np.random.default_rng(8), 0
    for _ in range(count):
        targets = drawn(rng)
        found = o.design(targets)
        if found.scene is None:
            continue
        made += 1
        assert found.verified and found.scene.limits == targets.origami.limits
        assert held(found.scene, targets).all()
        first = next(
            m
            for m in found.minima.minima
            if np.allclose(m.fold_angles, targets.states[0].fold_angles, atol=1e-4)
        )
        # it presses: springs that only balance there would hold it without the stop as well
        assert first.contacts[0].multiplier > 0
    assert made >= count / 2
