"""The lowest minimum that is listed is the lowest state of all: SCIP proves it, for small vertices with fold limits."""

import importlib.util

import numpy as np
import pytest

from benchmarks import family_scene
from origami_nlp import find_minima
from tests.computed_once import thinned
from tests.independent.global_minimum import proved

SECONDS = {4: 60.0, 5: 120.0, 6: 120.0}
"""Time a proof may take, by degree."""
NUMBERS = [k for k in range(15) if 4 + k % 5 <= 6]


@pytest.mark.skipif(
    importlib.util.find_spec("pyscipopt") is None, reason="pyscipopt (extra test) is not installed"
)
@pytest.mark.parametrize("number", thinned(NUMBERS, len(NUMBERS)))
def test_the_lowest_minimum_is_the_proved_one(number):
    scene = family_scene("fold-limits", number)
    sectors, k, rest = (
        np.array(v) for v in (scene.vertex.sector_angles, scene.stiffness, scene.rest_angles)
    )
    energy, bound, state = proved(sectors, k, rest, SECONDS[scene.degree])
    lowest = find_minima(scene, escape=False).minima[0]
    # SCIP's feasibility tolerance of 1e-6 lets energies fall by as much, times the multipliers
    room = 1e-4 * (1.0 + lowest.energy)
    assert lowest.energy <= energy + room, f"SCIP has {state} of energy {energy:.9g}"
    if bound < lowest.energy - room:
        pytest.skip(f"no proof in {SECONDS[scene.degree]:g} s: nothing is below {bound:.6g}")
    assert energy == pytest.approx(lowest.energy, rel=1e-4, abs=1e-4)
    assert np.abs(state - lowest.fold_angles).max() < 0.05
