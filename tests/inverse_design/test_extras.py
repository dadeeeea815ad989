"""Forbidden minima: none is left, by a scan of all states of four creases that knows nothing of the package."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp.inverse_design import Ask, design, solve
from tests.inverse_design.quadrilateral import lowest, states
from tests.inverse_design.questions import question

pytest.importorskip("clarabel")
FORBID = Ask(extra_states="forbid")
SCANNED = 0.03
"""A lowest sample is the state wanted [rad]: samples are 0.004 apart in one fold angle, more along the curve."""


def with_extras(n, first, count):
    """Feasible questions of one or two states, some pinned or wound, whose stiffest springs have more minima."""
    for seed in itertools.count(first):
        asked = question(seed, n, 1 + seed % 2, seed // 2 % 2, 0, preload=bool(seed // 4 % 2))
        if asked is not None and solve(asked).feasible:
            found = design(asked, effort="quick")
            if found.extra_minima:
                yield seed, asked, found
                count -= 1
        if not count:
            return


def unwanted(found, scene=None):
    """Lowest samples that are no state wanted."""
    low = lowest(found.scene.vertex.sector_angles, (scene or found.scene).energy)
    return [
        x
        for x in low
        if all(np.abs(x - np.array(s.fold_angles)).max() > SCANNED for s in found.states)
    ]


def test_the_scan_sees_the_minima_of_the_search():
    _, _, found = next(with_extras(4, 504, 1))
    low = lowest(found.scene.vertex.sector_angles, found.scene.energy)
    for m in found.minima.minima:
        assert np.abs(low - np.array(m.fold_angles)).max(axis=1).min() < SCANNED
    assert len(low) == len(found.minima.minima) == len(found.states) + len(unwanted(found))
    model = (
        found.targets.model
    )  # the states that it scans close, and are those that the package admits
    some = states(found.scene.vertex.sector_angles, 50)
    assert max(np.abs(model.closure(x)[0]).max() for x in some) < 1e-14
    assert not any(model.refuses(x) for x in some)


def test_a_forbidden_minimum_is_gone():
    asked = question(504, 4, 1, 0, 0)
    found = design(asked, FORBID, effort="quick")
    assert found.verified and not unwanted(found)
    # the energy is level across at the flat state: springs that are off let it fall into an arm there
    k = np.array(found.scene.stiffness) * (1.2, 1.0, 1.0, 1.0)
    assert unwanted(found, replace(found.scene, stiffness=tuple(k)))


@pytest.mark.slow
def test_forbidden_minima_of_four_creases_are_gone():
    done = []
    for seed, asked, first in with_extras(4, 500, 20):
        found = design(asked, FORBID, effort="quick")
        done.append(found.verified)
        print(
            seed, len(first.extra_minima), found.verified, found.rounds, first.margin, found.margin
        )
        assert found.verified == (not found.extra_minima)
        if found.verified:
            assert not unwanted(found)
    assert all(done)


@pytest.mark.slow
@pytest.mark.parametrize(("n", "least"), [(5, 2), (6, 5)])
def test_forbidden_minima_of_more_creases(n, least):
    done = []
    for seed, asked, first in with_extras(n, 500, 6):
        found = design(asked, FORBID, effort="quick")
        done.append(found.verified)
        print(
            n,
            seed,
            len(first.extra_minima),
            found.verified,
            found.rounds,
            first.margin,
            found.margin,
        )
        assert found.verified == (not found.extra_minima)
    assert sum(done) >= least
