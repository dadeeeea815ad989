"""What a search of a vertex starts from: the table of the room, and that listed states close exactly."""

import inspect

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, examples, starts
from origami_nlp.folding import fold_vertex
from origami_nlp.problem import Model
from origami_nlp.search import StartKind

SECTORS = (50.0, 75.0, 40.0, 65.0, 80.0, 50.0)
SCENE = Scene(
    Vertex.from_degrees(SECTORS),
    (1.0, 2.0, 0.5, 1.5, 1.0, 0.7),
    (0.6, -0.8, 0.9, -0.4, 0.7, -1.0),
    "none",
    "full",
)
LIMITS = Scene(SCENE.vertex, SCENE.stiffness, SCENE.rest_angles, "none", "fold-limits")


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
        and issubclass(one, (starts.Listed, StartKind))
        and not inspect.isabstract(one)
    ]
    said = {name.strip("`"): sentence.removesuffix(", drawn") for name, sentence in rows}
    assert said == {one.__name__: one.sentence for one in known}


@pytest.mark.parametrize("name", ["FlatFoldings", "HingeSets"])
def test_listed_states_close(name):
    scene = examples.degree6("pi/3")
    model = Model(scene)
    states = list(getattr(starts, name)(model).states())
    for x in states:
        _, q = fold_vertex(scene.vertex, model.expand(x))
        assert np.linalg.norm(q[1:]) <= 1e-9
    assert len(states)


def test_the_same_generator_draws_the_same_moments():
    family = starts.Moments(Model(LIMITS))
    one, two, other = (family.draw(np.random.default_rng(seed), 20) for seed in (3, 3, 4))
    assert all(np.array_equal(a.x, b.x) for a, b in zip(one, two, strict=True))
    assert len(one) == 20 and not np.array_equal(one[0].x, other[0].x)
