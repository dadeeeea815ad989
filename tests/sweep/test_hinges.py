"""Sweeps over numbers of hinge laws and stops: each scene is the one that is stated by itself."""

from __future__ import annotations

import math
import tomllib

import pytest

import origami_nlp as o
from origami_nlp.errors import OptionError
from origami_nlp.pattern import same_laws
from origami_nlp.sweep import parse_sweep

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


def swept(place, *values):
    axes = f'[[axes]]\nset = "{place}"\nvalues = {[*values]}\n'
    return parse_sweep(tomllib.loads(BASE + axes))


def test_each_scene_of_a_sweep_has_the_law_stated_alone():
    law = o.parse_scene(BASE.replace("[scene.", "[")).laws[0]
    for made, wanted in (
        (swept("law_scale[1]", 1.0, 0.4), law.times(0.4)),
        (swept("law_shift_deg[1]", 1.0, -10.0), law.shifted(math.radians(-10.0))),
    ):
        assert same_laws(made.scene(1).laws, (wanted, None, None, law))


@pytest.mark.parametrize("place", ["laws.snap.energy", "law_scale[9]", "law_scale[2]"])
def test_places_that_are_not_there_are_named(place):
    with pytest.raises(OptionError):
        swept(place, 1, 2)
