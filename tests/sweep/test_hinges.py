"""Sweeps over numbers of hinge laws and stops: each scene is the one that is stated by itself."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import SweepError
from origami_nlp.sweep import load_states, parse_sweep, run_sweep
from tests.sweep.test_sweep import Inline

BASE = """
[scene.vertex]
sector_angles_deg = [70, 80, 120, 90]
[scene.creases]
stiffness = [1, 0.5, 1.5, 1]
rest_angles_deg = [10, 30, -20, 40]
limits_deg = [[-150, 150], [-150, 150], [-90, 90], [-150, 150]]
law = ["snap", "", "", "snap"]
[scene.laws.snap]
sum = [{type = "linear", stiffness = 0.1}, {type = "double-well", energy = 0.5, at_deg = 60}]
[scene.model]
contact = "fold-limits"
"""


def swept(axes, tmp_path):
    data = tomllib.loads(BASE + axes)
    sweep = parse_sweep(data)
    run_sweep(sweep, tmp_path, executor=Inline())
    return sweep, load_states(tmp_path)


@pytest.mark.slow  # a second look at what other tests of the room say
@pytest.mark.parametrize(
    ("place", "values"),
    [
        ("creases.limits_deg[3][2]", [40.0, 120.0]),
        pytest.param("laws.snap.scale", [0.5, 2.0], marks=pytest.mark.slow),
        pytest.param("laws.snap.shift_deg", [-10.0, 20.0], marks=pytest.mark.slow),
        pytest.param("laws.snap.sum[2].energy", [0.2, 1.0], marks=pytest.mark.slow),
    ],
)
def test_each_scene_of_a_sweep_is_the_one_stated_alone(place, values, tmp_path):
    axes = f'[[axes]]\nname = "x"\nset = "{place}"\nvalues = {values}\n[search]\nstarts = 4\n'
    sweep, states = swept(axes, tmp_path)
    for k, value in enumerate(values):
        text = BASE.replace("[scene.", "[")
        if place == "laws.snap.sum[2].energy":
            text = text.replace("energy = 0.5", f"energy = {value}")
        elif place.startswith("laws"):
            key = place.rsplit(".", 1)[1]
            text = text.replace("[model]", f"{key} = {value}\n[model]")
        else:
            text = text.replace("[-90, 90]", f"[-90, {value}]")
        alone = o.find_minima(o.parse_scene(text), escape=False, prove=False)
        mine = states[states["x"] == value] if "x" in states else states[states["scene"] == k]
        assert np.sort(mine["energy_J"]) == pytest.approx(
            [m.energy for m in alone.minima], rel=1e-9
        )
    low, high = (sweep.scene(k) for k in (0, 1))
    assert low.laws != high.laws or low.limits != high.limits


@pytest.mark.parametrize(
    "place",
    ["laws.snip.energy", "laws.snap.energy", "laws.snap.sum[3].energy", "creases.limits_deg[9][1]"],
)
def test_places_that_are_not_there_are_named(place):
    axes = f'[[axes]]\nset = "{place}"\nvalues = [1, 2]\n'
    with pytest.raises(SweepError, match="is not in the scene"):
        parse_sweep(tomllib.loads(BASE + axes))
