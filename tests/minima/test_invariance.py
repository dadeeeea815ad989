"""The same vertex, described otherwise, has the same minima: labels, sides, mirror images and units do not matter."""

import math

import numpy as np
import pytest

from benchmarks import family_scene
from origami_nlp import Scene, Vertex, find_minima
from origami_nlp.kkt import project
from origami_nlp.pattern_problem import pose
from tests.computed_once import shared
from tests.relabelled_vertex import Relabelling

SAME_MINIMUM = 1e-6
"""Two minima [rad] of two searches are one: far above what the polish leaves, far below what tells minima apart."""


DESCRIPTIONS = {
    "third crease first": Relabelling(3),
    "mirrored": Relabelling(0, True),
    "turned over": Relabelling(2, True, True),
    "stiffness times 3.7": Relabelling(factor=3.7),
}
PLANTED = Scene(
    Vertex((0.7784849122786709, 2.291547160916454, 1.0231515757129965, 2.1900016582714645)),
    (0.022816280794769387, 0.03205546964080397, 0.04387824855836886, 0.0012500010060577914),
    (-0.2369412983168271, 1.0889080776221243, 3.141592485901434, 3.1415921923256085),
    "none",
    "full",
)
"""Of degree 4, with a state that few starts reach."""
SCENES = [
    *(("fold-limits", k) for k in range(3)),
    *(("full-contact", k) for k in range(3)),
    ("planted", 0),
]
CHEAP = [("full-contact", 0), ("planted", 0)]
"""Of degree 4; the others wait for the long studies."""
CASES = [
    pytest.param(
        family,
        number,
        name,
        id=f"{family} {number + 1}, {name}",
        marks=() if (family, number) in CHEAP else pytest.mark.slow,
    )
    for family, number in SCENES
    for name in DESCRIPTIONS
]


def scene_of(family, number):
    return PLANTED if family == "planted" else family_scene(family, number)


def states(scene):
    return np.array(
        [m.fold_angles for m in find_minima(scene, prove=False, escape=False).minima]
    ).reshape(-1, scene.degree)


@shared
def first_states(family, number):
    return states(scene_of(family, number))


def unmatched(a, b):
    """How many states of a [A, N] have no partner among b [B, N]."""
    far = np.abs(a[:, None] - b).max(axis=2)
    return int((far.min(axis=1, initial=math.inf) > SAME_MINIMUM).sum())


@pytest.mark.parametrize(("family", "number", "name"), CASES)
def test_another_description_has_the_same_minima(family, number, name):
    description, scene = DESCRIPTIONS[name], scene_of(family, number)
    here = first_states(family, number)
    there = description.back(states(description.of(scene)))
    lost, extra = unmatched(here, there), unmatched(there, here)
    assert (lost, extra) == (0, 0), f"{lost} of {len(here)} minima are lost, {extra} are new"
    assert len(here) == len(there) > 0


@pytest.mark.parametrize("name", DESCRIPTIONS)
@pytest.mark.parametrize("number", range(3))
def test_descriptions_are_of_the_same_vertex(name, number):
    """Closure, sheet and energies of closed states agree: the maps are right, whatever a search finds."""
    description, scene = DESCRIPTIONS[name], family_scene("full-contact", number)
    other, rng = description.of(scene), np.random.default_rng(number)
    x, residual = project(pose(scene), rng.uniform(-3, 3, (40, scene.degree)))
    x = x[residual <= 1e-13]
    y = description.seen(x)
    assert len(x) >= 20 and (description.back(y) == x).all()
    ours, theirs = pose(scene), pose(other)
    assert np.abs(theirs.constraints(y)[0]).max() <= 1e-12
    assert (theirs.lifts_to_one(y) == ours.lifts_to_one(x)).all()
    assert (theirs.admissible(y) == ours.admissible(x)).all()
    energies = [description.factor * scene.energy(s) for s in x]
    assert [other.energy(s) for s in y] == pytest.approx(energies, rel=1e-14)


def test_rounding_hangs_on_no_label():
    """Of this vertex two labels listed one minimum more."""
    sectors = (68.0, 46.8, 87.7, 46.6, 64.9, 46.0)
    springs = (1.58, 0.91, 0.7, 0.57, 0.76, 0.79), (0.18, -0.24, 2.29, 2.27, 1.48, 0.86)
    scene = Scene(Vertex.from_degrees(sectors), *springs, "none", "full")
    seen = (
        Relabelling(),
        Relabelling(2),
        Relabelling(1, True),
        Relabelling(3, over=True),
    )
    found = [find_minima(one.of(scene), prove=False, escape=False).minima for one in seen]
    energies = [[m.energy for m in minima] for minima in found]
    assert all(one == pytest.approx(energies[0], rel=1e-9) for one in energies)
