"""Every family of starts of a vertex keeps to one interface: same generator, same starts, no more than asked for."""

import inspect
import itertools
import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, examples, starts
from origami_nlp.folding import fold_vertex
from origami_nlp.problem import Model

SECTORS = (50.0, 75.0, 40.0, 65.0, 80.0, 50.0)
SCENE = Scene(
    Vertex.from_degrees(SECTORS),
    (1.0, 2.0, 0.5, 1.5, 1.0, 0.7),
    (0.6, -0.8, 0.9, -0.4, 0.7, -1.0),
    "none",
    "full",
)
LIMITS = Scene(SCENE.vertex, SCENE.stiffness, SCENE.rest_angles, "none", "fold-limits")
RIGID = Scene(Vertex.from_degrees((100.0, 120.0, 140.0)), (1.0,) * 3, (0.3, 0.2, 0.4), "none")
SYMMETRIC = examples.degree6("pi/3")


def vertex_families():
    """Every family of a vertex, made anew, with the model of its states."""
    full, limits, rigid, hinged = map(Model, (SCENE, LIMITS, RIGID, SYMMETRIC))
    corners = starts.Corners(limits).draw(np.random.default_rng(5), 500)
    foldings = starts.flat_foldings(hinged)
    return [
        (starts.Corners(limits), limits),
        (starts.Interior(full), full),
        (starts.NearCorners(corners), limits),
        (starts.Strata(limits), limits),
        (starts.Touches(full), full),
        (starts.Moments(limits), limits),
        (starts.Projected(limits), limits),
        (starts.NearFlat(full), full),
        (starts.NearFolded(hinged, foldings), hinged),
        (starts.FlatFoldings(hinged), hinged),
        (starts.HingeSets(hinged), hinged),
        (starts.RigidStates(rigid, 0), rigid),
    ]


def families():
    return [family for family, _ in vertex_families()]


NAMES = [type(family).__name__ for family in families()]


def test_the_table_of_the_room_has_every_family_with_its_sentence():
    rows = [
        tuple(cell.strip() for cell in line.strip("|").split("|"))
        for line in starts.__doc__.splitlines()
        if line.startswith("| `")
    ]
    known = [
        one
        for name in dir(starts)
        if inspect.isclass(one := getattr(starts, name))
        and issubclass(one, starts.StartFamily)
        and not inspect.isabstract(one)
    ]
    assert {name: sentence for name, _, sentence in rows} == {
        f"`{one.__name__}`": one.sentence for one in known
    }
    assert len(known) == len(NAMES)
    assert [name.strip("`") for name, *_ in rows] == NAMES
    # two families of one name would be one in the account of a search: both kinds of interior are no corners
    named = [one.name for one in known]
    assert {name for name in named if named.count(name) > 1} == {"interior"}


@pytest.mark.parametrize("number", range(len(NAMES)), ids=NAMES)
def test_the_same_generator_gives_the_same_starts(number):
    one, two, other = (
        families()[number].draw(np.random.default_rng(seed), 40) for seed in (3, 3, 4)
    )
    assert np.array_equal(one.x, two.x) and np.array_equal(one.at_limit, two.at_limit)
    assert np.array_equal(one.slots, two.slots) and np.isfinite(one.x).all()
    if not isinstance(families()[number], starts.Listed) and NAMES[number] != "Corners":
        most = 80 if NAMES[number] == "Touches" else 40  # and rare strata at first
        assert 0 < len(one) <= most and not np.array_equal(one.x, other.x)


@pytest.mark.parametrize("number", range(len(NAMES)), ids=NAMES)
def test_a_listed_family_gives_each_of_its_states_once(number):
    family = families()[number]
    if not isinstance(family, starts.Listed):
        pytest.skip("its starts are drawn")
    rng, every = np.random.default_rng(0), np.array(list(families()[number].states()))
    parts = list(itertools.takewhile(len, (family.draw(rng, 3) for _ in range(1000))))
    assert all(len(part) <= 3 for part in parts)
    drawn = [x for part in parts for x in part.x]
    assert len(drawn) == len(every) and all(
        np.array_equal(a, b) for a, b in zip(drawn, every, strict=True)
    )
    assert len(family.draw(rng, 1)) == 0


EXACT = ("Corners", "Interior", "NearCorners", "Strata", "Touches", "FlatFoldings", "HingeSets")


@pytest.mark.parametrize("name", [*EXACT, "RigidStates", "Moments"])
def test_starts_of_vertices_close_and_hold_what_they_say(name):
    ((family, model),) = [pair for pair in vertex_families() if type(pair[0]).__name__ == name]
    s = family.draw(np.random.default_rng(1), 500 if name == "Corners" else 30)
    at = math.pi * s.at_limit[s.at_limit != 0]
    assert np.array_equal(s.x[s.at_limit != 0], at)
    for x in s.x:
        _, q = fold_vertex(model.scene.vertex, model.expand(x))
        assert np.linalg.norm(q[1:]) <= 1e-9
    assert len(s) or name == "RigidStates"
