"""Dead loads: energy and derivatives against other code and 50 digits, states by hand, and what refuses them."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from origami_nlp import (
    Load,
    Scene,
    Vertex,
    find_barriers,
    find_critical_points,
    find_minima,
    format_scene,
    parse_scene,
)
from origami_nlp.errors import OptionError, SceneError, SceneFileError, SymmetryError
from origami_nlp.kkt import project
from origami_nlp.pattern_problem import pose
from origami_nlp.proof import ReducedVertex, prove
from tests.independent.rotations import fold

LOADS = (
    Load(crease=5, distance=0.3, force=(0.1, 0.2, -0.5)),
    Load(facet=4, point=(0.5, 0.3), force=(0.3, -0.1, 0.2)),
    Load(facet=2, point=(0.5, 0.3), force=(0.3, -0.1, 0.2)),
    Load(facet=1, point=(0.7, "pi/18"), force=(-0.2, 0.4, 0.1)),
)
FIVE = Scene(
    Vertex.from_degrees((50, 70, 80, 60, 100)),
    (1, 2, 0.5, 0.7, 1.3),
    (1, -1, 0.5, 0.2, 2),
    loads=LOADS,
    fixed_facet=2,
)
BOOK = Scene(
    Vertex(("pi/2",) * 4),
    (1, 0.1, 1, 0.1),
    (0.4, 0, 0.4, 0),
    fixed_facet=4,
    loads=[{"crease": 2, "distance": 0.5, "force": [0, 0, -0.3]}],
)


@cache
def book():
    return find_minima(BOOK, prove=True, escape=False)


def closed_states(model, count, seed=0):
    x = np.random.default_rng(seed).uniform(-2.5, 2.5, (count, model.size))
    x, residual = project(model, x)
    return x[(residual < 1e-13) & model.lifts_to_one(x)]


def test_the_energy_is_that_of_points_found_from_folded_creases():
    model = pose(FIVE)
    x = closed_states(model, 60)
    assert len(x) > 20
    sectors = np.array(FIVE.vertex.sector_angles)
    creases, _ = fold(sectors, x)
    work = np.zeros(len(x))
    for load in FIVE.loads:
        far, angle = load.place
        i, j = load.number - 1, load.number % 5
        a = sectors[i]
        point = (
            far
            * (math.sin(a - angle) * creases[:, i] + math.sin(angle) * creases[:, j])
            / math.sin(a)
        )
        e1, other = creases[:, 1], creases[:, 2]
        e3 = np.cross(e1, other) / math.sin(sectors[1])
        frame = np.stack([e1, np.cross(e3, e1), e3], axis=1)
        work += np.einsum("kij,kj,i->k", frame, point, load.force)
    springs = replace(FIVE, loads=(), fixed_facet=None).energy(x)
    assert np.abs(model.energies(x) - springs + work).max() < 1e-13
    assert np.abs(FIVE.energy(x) - springs + work).max() < 1e-13


def test_a_weight_on_the_crease_of_a_book_by_hand():
    """Folded by t about creases 1 and 3, crease 2 rises to r sin t: U = (t - 0.4)^2 - f r sin t."""
    f, r, t = -0.3, 0.5, 0.4
    for _ in range(50):
        t -= (2 * (t - 0.4) - f * r * math.cos(t)) / (2 + f * r * math.sin(t))
    found = book()
    lowest = found.minima[0]
    assert np.abs(np.array(lowest.fold_angles) - (t, 0, t, 0)).max() < 1e-14
    assert lowest.energy == pytest.approx((t - 0.4) ** 2 - f * r * math.sin(t), abs=1e-15)
    # fully folded about creases 2 and 4: crease 2 stays on facet 4's side, turned by phi_1 = -phi_3 = u
    u = 0.0
    for _ in range(50):
        u -= (2 * u - f * r * math.cos(u)) / (2 + f * r * math.sin(u))
    at_limit = sorted((m.fold_angles for m in found.minima[1:]), key=lambda angles: angles[1])
    assert np.abs(np.array(at_limit) - [(u, s, -u, s) for s in (-math.pi, math.pi)]).max() < 1e-9
    assert len(found.minima) == 3
    assert any("facet 4 is fixed" in line for line in str(found).splitlines())


def test_minima_under_a_load_are_lower_than_states_near_by_and_depend_on_the_fixed_facet():
    found = find_minima(FIVE, max_starts=32, effort="quick", prove=False, escape=False)
    model = pose(FIVE)
    assert found.minima and found.completeness is None
    rng = np.random.default_rng(3)
    for m in found.minima:
        x = np.array(m.fold_angles) + rng.normal(0, 2e-3, (200, 5))
        y, residual = project(model, np.clip(x, -math.pi, math.pi))
        y = y[(residual < 1e-13) & model.admissible(y)]
        assert len(y) > 10 and (FIVE.energy(y) > m.energy - 1e-13).all()
    other = find_minima(
        replace(FIVE, fixed_facet=4), max_starts=16, effort="quick", prove=False, escape=False
    )
    assert abs(other.minima[0].energy - found.minima[0].energy) > 1e-3


def test_scenes_with_loads_survive_files():
    assert parse_scene(format_scene(FIVE)) == FIVE
    with pytest.raises(SceneFileError, match="loads"):
        parse_scene(format_scene(FIVE).replace("[[loads]]", "[loads]", 1).split("[[loads]]")[0])


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"fixed_facet": None}, "which facet is held"),
        ({"fixed_facet": 9}, "1 to 5"),
        ({"loads": [{"crease": 6, "distance": 1, "force": [0, 0, 1]}]}, "1 to 5"),
        ({"loads": [{"crease": 1, "distance": -1, "force": [0, 0, 1]}]}, "above 0"),
        ({"loads": [{"crease": 1, "force": [0, 0, 1]}]}, "crease, distance and force"),
        ({"loads": [{"facet": 1, "point": [1, 2.0], "force": [0, 0, 1]}]}, "within facet 1"),
        ({"loads": [{"facet": 1, "point": [1, 0.1], "force": [0, 1]}]}, "3 numbers"),
        ({"loads": [{"facet": 1, "point": [1, 0.1], "force": [0, 1, math.inf]}]}, "number"),
        ({"loads": [{"crease": 1, "torque": 0.3}]}, "preload"),
        ({"loads": [{"facet": 1, "colour": 3}]}, "unknown key 'colour'"),
    ],
)
def test_loads_that_make_no_sense_are_refused_by_name(change, word):
    with pytest.raises(SceneError, match=word):
        replace(FIVE, **change)


def test_what_does_not_know_forces_says_so():
    with pytest.raises(SymmetryError, match="not shared by loads"):
        replace(BOOK, symmetry="D1")
    assert BOOK.group.is_trivial
    for ask in (find_critical_points, find_barriers, lambda s: prove(ReducedVertex(s))):
        with pytest.raises(OptionError, match="dead loads"):
            ask(BOOK)
    found = book()
    assert found.completeness.status == "not-proved" and "dead loads" in found.completeness.reason
