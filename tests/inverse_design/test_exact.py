"""What is asked of energies is met to rounding, over random questions."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp.errors import OptionError
from origami_nlp.inverse_design import BarrierAsk, EnergyGap, design, scene_of, solve, springs_of
from tests.inverse_design.quadrilateral import crest
from tests.inverse_design.questions import question

pytest.importorskip("clarabel")


def test_differences_of_energy_are_exact():
    """25 random questions of two states, four to six creases, some pinned; gaps asked for from -5 to 20 mJ."""
    done = []
    for seed in itertools.count():
        gap = (0.0, 0.0125, -0.005, 0.02)[seed % 4]
        asked = question(seed, 4 + seed % 3, 2, seed // 3 % 2, 0, preload=True)
        if asked is None:
            continue
        asked = replace(asked, energies=(EnergyGap("s1", "s0", gap, gap),))
        posed = solve(asked)
        if not posed.feasible:
            continue
        scene = scene_of(asked, springs_of(posed))
        u = [scene.energy(asked.model.expand(p.state.x)) for p in asked.placed]
        done.append(abs(u[1] - u[0] - gap) / max(u))
        if len(done) == 25:
            break
    assert max(done) <= 1e-12


@pytest.mark.slow
def test_barriers_are_exact():
    """20 random pairs of states on a curve of four creases; the highest state of a scan, to its resolution, agrees."""
    done, same = [], 0
    for seed in itertools.count():
        asked = question(seed, 4, 2, 0, 0, preload=True)
        rise = (0.01, 0.02, 0.05)[seed % 3]
        if asked is None or not solve(asked).feasible:
            continue
        asked = replace(asked, barriers=(BarrierAsk("s0", "s1", rise, rise),))
        try:
            found = design(asked, effort="quick")
        except OptionError as error:
            assert "no curve of closed states" in str(error)
            continue
        if not found.feasible:
            continue
        assert not any("barrier" in why for why in found.failed)
        low, high = (np.array(s.fold_angles) for s in found.states)
        top = crest(found.scene.vertex.sector_angles, found.scene.energy, low, high)
        size = found.states[0].energy + rise
        done.append(abs(found.barriers[0].rise - rise) / size)
        same += top == pytest.approx(size, rel=1e-3)
        assert top <= size * (1 + 1e-3)  # (lower where two ways join the states)
        print(seed, rise, done[-1], top / size, found.verified, flush=True)
        if len(done) == 20:
            break
    assert max(done) <= 1e-12 and same >= 15
