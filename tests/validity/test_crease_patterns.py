"""Crease patterns: faults of drawings, vertices that do not fold flat, fold angles that do not close."""

import json
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import parse_fold
from origami_nlp.pattern_problem import states_to_fold
from origami_nlp.validity import list_vertices
from tests.patterns import miura, miura_angles
from tests.validity.test_faults import CLOSES, LETTERS, faults


def star(sectors, letters, lengths=None):
    """One vertex of a sheet: a crease pattern without faces."""
    turn = np.concatenate([[0.0], np.cumsum(np.radians(sectors))[:-1]])
    n = len(sectors)
    r = np.ones(n) if lengths is None else np.array(lengths)
    rim = [[float(a * math.cos(t)), float(a * math.sin(t))] for a, t in zip(r, turn, strict=True)]
    return {
        "vertices_coords": [[0.0, 0.0], *rim],
        "edges_vertices": [[0, k + 1] for k in range(n)]
        + [[k + 1, (k + 1) % n + 1] for k in range(n)],
        "edges_assignment": [*letters, *"B" * n],
    }


VERTICES = {
    "Kawasaki": star([80, 100, 101, 79], "MVVV"),
    "odd": star([70, 70, 70, 70, 80], "MVVVV"),
    "Maekawa": star([80, 100, 100, 80], "MVMV"),
    "two equal": star([100, 50, 50, 80, 30, 50], "MMMVVV"),
}


@pytest.mark.parametrize("name", VERTICES)
def test_a_vertex_that_does_not_fold_flat(name):
    data = VERTICES[name]
    found = faults(data)
    test = "Kawasaki" if name == "odd" else "Maekawa" if name == "two equal" else name
    assert test in found and all(one.vertices == (0,) for one in found[test])
    if name == "Kawasaki":
        # 80 + 101 against 100 + 79
        assert found[test][0].size == pytest.approx(math.radians(2.0))


def test_little_angle_between_two_creases_of_one_letter():
    (one,) = faults(star([45, 90, 135, 90], "MMVM"))["layers round each vertex"]
    assert one.vertices == (0,)


def test_noise_of_a_drawing_is_no_fault_and_is_measured():
    drawn = star([90.003, 89.997, 90.002, 89.998], "MVVV")
    assert o.check(drawn).verdict == "valid"
    (one,) = faults(drawn, tolerance=1e-6)["Kawasaki"]
    assert "would explain it" in one.text
    assert one.size == pytest.approx(math.radians(0.01))


def test_fold_angles_that_do_not_close_at_one_vertex():
    sheet = miura(3, 3)
    phi = miura_angles(sheet, 3, 1.0)
    data = states_to_fold(sheet)
    number = {int(e): c for c, e in enumerate(sheet.numbers)}
    data["edges_foldAngle"] = [
        math.degrees(phi[number[e]]) if e in number else 0.0
        for e in range(len(data["edges_vertices"]))
    ]
    assert o.check(data).verdict == "valid"
    rim = next(c for c in range(sheet.creases) if sum(c in v.creases for v in sheet.vertices) == 1)
    vertex = next(v.vertex for v in sheet.vertices if rim in v.creases)
    data["edges_foldAngle"][int(sheet.numbers[rim])] += 2.0
    (one,) = faults(data)[CLOSES]
    assert one.vertices == (vertex,) and one.size == pytest.approx(math.radians(2.0), rel=1e-6)


def test_a_letter_against_its_fold_angle():
    data = star([45, 90, 135, 90], "VMMM")
    data["edges_foldAngle"] = [180, -180, 180, -180, 0, 0, 0, 0]
    (one,) = faults(data)[LETTERS]
    assert one.edges == (2,)


def drawing(change):
    data = star([90, 90, 90, 90], "MVVV")
    change(data)
    return data


@pytest.mark.parametrize(
    "change, edges, vertices",
    [
        (
            lambda d: (d["edges_vertices"].append([2, 4]), d["edges_assignment"].append("V")),
            {8},
            {0},
        ),
        (
            lambda d: (
                d["vertices_coords"].extend([[0.3, -0.2], [0.3, 0.2]]),
                d["edges_vertices"].append([5, 6]),
                d["edges_assignment"].append("F"),
            ),
            {0, 8},
            set(),
        ),
        (
            lambda d: (d["edges_vertices"].append([0, 1]), d["edges_assignment"].append("V")),
            {0},
            set(),
        ),
    ],
    ids=["through a vertex", "crossing", "twice"],
)
def test_a_drawing_that_is_none(change, edges, vertices):
    (found,) = faults(drawing(change)).values()
    assert {e for one in found for e in one.edges} == edges
    assert {v for one in found for v in one.vertices} == vertices


def test_a_crease_that_ends_within_a_facet():
    data = star([90, 90, 90, 90], "MVVV")
    data["vertices_coords"].append([0.5, 0.3])
    data["edges_vertices"].append([1, 5])
    data["edges_assignment"].append("V")
    seen = o.check(data)
    assert seen.verdict == "faults" and "ends within a facet" in seen.faults[0].text


def test_flat_creases_count_for_nothing():
    """Two F edges that cut facets of a vertex, at odd angles: facets on both sides of them are one."""
    data = star([45, 20, 70, 135, 30, 60], "VMFMMF")
    assert o.check(data).verdict == "valid"
    data["edges_assignment"][2] = "V"
    (one,) = faults(data)["Kawasaki"]
    assert one.vertices == (0,) and "5 creases" in one.text


def test_a_vertex_that_cannot_be_folded_does_not_end_the_listing():
    """A sector of 1e-12 rad, beside a vertex that is sound."""
    good, bad = star([45, 90, 135, 90], "VMMM"), star([90, 90, 90, 90], "MVVV")
    bad["vertices_coords"][2] = [1.0, 1e-12]
    shift = len(good["vertices_coords"])
    both = {
        "vertices_coords": [
            *good["vertices_coords"],
            *([x + 5.0, y] for x, y in bad["vertices_coords"]),
        ],
        "edges_vertices": [
            *good["edges_vertices"],
            *([a + shift, b + shift] for a, b in bad["edges_vertices"]),
        ],
        "edges_assignment": [*good["edges_assignment"], *bad["edges_assignment"]],
    }
    (listed,) = list_vertices(parse_fold(json.dumps(both))).to_dict()["frames"]
    assert [v["number"] for v in listed["vertices"]] == [0, shift]
    assert listed["vertices"][0]["folds_flat"] is True
