"""Sweeps over numbers of hinge laws and stops: each scene is the one that is stated by itself."""

from __future__ import annotations

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


@pytest.mark.parametrize(
    ("place", "value", "was", "becomes"),
    [
        ("laws.snap.sum[2].at_deg", 50.0, "at_deg = 60", "at_deg = {}"),
        ("laws.snap.sum[2].energy", 0.2, "energy = 0.5", "energy = {}"),
    ],
)
def test_each_scene_of_a_sweep_is_the_one_stated_alone(place, value, was, becomes):
    axes = f'[[axes]]\nname = "x"\nset = "{place}"\nvalues = [{value - 0.1}, {value}]\n'
    sweep = parse_sweep(tomllib.loads(BASE + axes))
    stated = BASE.replace("[scene.", "[")
    alone, made = o.parse_scene(stated.replace(was, becomes.format(value))), sweep.scene(1)
    assert same_laws(made.laws, alone.laws) and made.limits == alone.limits
    plain = o.parse_scene(stated)
    assert not same_laws(made.laws, plain.laws) or made.limits != plain.limits


@pytest.mark.parametrize(
    "place",
    ["laws.snip.energy", "laws.snap.energy", "laws.snap.sum[3].energy", "law_scale[9]"],
)
def test_places_that_are_not_there_are_named(place):
    axes = f'[[axes]]\nset = "{place}"\nvalues = [1, 2]\n'
    with pytest.raises(OptionError):
        parse_sweep(tomllib.loads(BASE + axes))
