"""Patterns from FOLD frames: orientation, planes, folded forms, holes, cuts, joined facets, and refusals."""

import copy
import json
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import (
    examples,
    frame_pattern,
    parse_fold,
    pattern_from_dict,
    pattern_to_dict,
)
from origami_nlp.pattern_problem import PatternProblem, Poses
from tests.fold_files import others

FOLDED = {  # facets, creases, interior vertices, counted from the files' arrays by hand or by the file's author
    "fold_squaretwist_4xdeg4.fold": (9, 12, 4),
    "foldforge_miura_9xdeg4.fold": (16, 24, 9),
    "foldforge_single_vertex_deg4.fold": (4, 4, 1),
}


def made(data, **options):
    (frame,) = parse_fold(json.dumps(data))
    return frame_pattern(frame, **options)


def miura(rows=3, columns=3):
    return copy.deepcopy(examples.crease_pattern("miura", rows, columns))


def keyed(p):
    """Everything that must not depend on how a file is written, by the edge."""
    return {
        int(e): (a, round(float(k), 12), round(float(r), 12))
        for e, a, k, r in zip(p.numbers, p.assignment, p.stiffness, p.rest, strict=True)
    }


def test_a_sheet_is_read_alike_however_its_faces_run_or_without_them():
    data = miura()
    whole = made(data)
    assert (whole.facets, whole.creases, len(whole.vertices)) == (9, 12, 4)
    assert whole.numbers.tolist() == sorted(whole.numbers.tolist())
    rng = np.random.default_rng(0)
    mixed = {
        **data,
        "faces_vertices": [f[:: rng.choice([1, -1])] for f in data["faces_vertices"]],
    }
    bare = {k: v for k, v in data.items() if k != "faces_vertices"}
    phi = 0.1 * rng.standard_normal(12)
    residual = PatternProblem(whole).closure.values(phi)
    for other in (made(mixed), made(bare)):
        assert keyed(other) == keyed(whole) and other.is_flat
        # the same closure, so the same side up and the same angles in the same order
        values = PatternProblem(other).closure.values(phi).reshape(-1, 3)
        lengths = np.linalg.norm(values, axis=1)
        assert np.allclose(lengths, np.linalg.norm(residual.reshape(-1, 3), axis=1), atol=1e-15)


@pytest.mark.parametrize("seed", range(3))
def test_any_plane_and_any_folded_form_measure_the_same_angles(seed):
    rng = np.random.default_rng(seed)
    data = miura(4, 4)
    flat = made(data)
    problem = PatternProblem(flat)
    phi, residual = problem.project(0.6 * flat.signs)
    assert residual < 1e-13 and np.abs(phi).min() > 0.1
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    tilted = flat.corners @ turn.T + rng.standard_normal(3)
    again = made({**data, "vertices_coords": tilted.tolist()})
    assert again.is_flat and np.abs(PatternProblem(again).closure.values(phi)).max() < 1e-13
    x = Poses(flat).corners(phi) @ turn.T
    for faces in (data["faces_vertices"], [f[::-1] for f in data["faces_vertices"]]):
        form = {**data, "vertices_coords": x.tolist(), "frame_classes": ["foldedForm"]}
        form |= {"faces_vertices": faces, "edges_foldAngle": None}
        del form["edges_foldAngle"]
        folded = made(form)
        assert np.abs(folded.reference - phi).max() < 1e-12  # measured from normals alone
        # fold angles of other states mean the same, though measured from another reference
        other, _ = problem.project(0.9 * flat.signs)
        assert np.abs(PatternProblem(folded).closure.values(other)).max() < 1e-12


def square(letters="BBBB", extra=()):
    """A square with a vertex in the middle of each side: edges of the border, then more."""
    xy = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1], [1, 1]]
    edges = [[i, (i + 1) % 8] for i in range(8)]
    return {
        "vertices_coords": xy,
        "edges_vertices": [*edges, *[e for e, _ in extra]],
        "edges_assignment": ["B"] * 8 + [a for _, a in extra],
    }


def test_facets_are_joined_over_f_and_j_edges_also_to_ones_that_are_not_convex():
    cross = [([1, 8], "V"), ([3, 8], "V"), ([5, 8], "F"), ([7, 8], "J")]
    p = made(square(extra=cross))
    assert (p.facets, p.creases, len(p.polygons)) == (2, 2, 4)  # one of them is an L
    assert len(p.vertices) == 1 and len(p.vertices[0].creases) == 2


def test_faces_with_a_border_all_around_are_holes():
    grid = [[i, j] for j in range(4) for i in range(4)]
    edges, letters = [], []
    for j in range(4):
        for i in range(4):
            for a, b in ((1, 0), (0, 1)):
                if i + a < 4 and j + b < 4:
                    edges.append([4 * j + i, 4 * (j + b) + i + a])
                    middle = (i + a / 2, j + b / 2)
                    rim = 0 in middle or 3 in middle
                    hole = 1 <= middle[0] <= 2 and 1 <= middle[1] <= 2
                    letters.append("B" if rim or hole else "V")
    p = made({"vertices_coords": grid, "edges_vertices": edges, "edges_assignment": letters})
    assert (p.facets, p.creases, len(p.vertices), len(p.holes)) == (8, 8, 0, 1)
    assert PatternProblem(p).closure.count == 6


def test_a_cut_gives_both_sides_a_border_of_their_own():
    cross = [([1, 8], "V"), ([3, 8], "V"), ([5, 8], "C"), ([7, 8], "V")]
    p = made(square(extra=cross))
    assert (p.facets, p.creases, len(p.vertices), len(p.holes)) == (4, 3, 0, 0)
    assert len(p.corners) == 10  # the vertex on the border is there twice


def moebius(count=6):
    """A band with half a turn in it."""
    turn = [2 * math.pi * k / count for k in range(count)]
    rim = [
        [r * math.cos(t), r * math.sin(t), side * math.sin(t / 2)]
        for side in (-1, 1)
        for t in turn
        for r in [2 + side * math.cos(t / 2)]
    ]
    bands = [(k, (k + 1) % count, (k + 1) // count) for k in range(count)]
    faces = []
    for k, after, swapped in bands:  # triangles, which are flat
        low, high = (after + count, after) if swapped else (after, after + count)
        faces += [[k, low, high], [k, high, k + count]]
    return {"vertices_coords": rim, "faces_vertices": faces, "frame_classes": ["foldedForm"]}


REFUSED = {
    "Moebius": moebius,
    "preload": lambda: miura(2, 2) | {"edges_origaminlp:preload": [0.1] * 12},
    "crossing": lambda: square(extra=[([0, 4], "M"), ([2, 6], "M")]),
    "through": lambda: square(extra=[([1, 5], "M"), ([7, 8], "M")]),
    "dangling": lambda: square(extra=[([1, 8], "M")]),
    "no facets": lambda: square() | {"edges_vertices": [[0, 1]] * 8},
    "nothing but holes": square,
    "one place twice, with faces": lambda: _dragged(5) | {"vertices_coords": _twice(5, miura())},
    "a face across itself": lambda: _crossed(miura()),
    "no faces": lambda: (
        square(extra=[([1, 8], "M"), ([8, 5], "M")]) | {"frame_classes": ["foldedForm"]}
    ),
    "bent facet": lambda: _faces(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0], [2, 0, 0]], [[0, 1, 2, 3], [1, 4, 2]]
    ),
    "upside down": lambda: (
        miura(2, 2) | {"vertices_coords": _moved(miura(2, 2)["vertices_coords"])}
    ),
    "ends within": lambda: square(
        extra=[([1, 8], "M"), ([3, 8], "F"), ([5, 8], "F"), ([7, 8], "F")]
    ),
    "not stitched": lambda: _faces(
        [[0, 0], [1, 0], [1, 1], [0, 1], [1, 0], [2, 0], [2, 1], [1, 1]],
        [[0, 1, 2, 3], [4, 5, 6, 7]],
    ),
    "a vertex on a side": lambda: _faces(
        [[0, 0], [2, 0], [2, 1], [0, 1], [2, 2], [0, 2], [1, 1]],
        [[0, 1, 2, 3], [3, 6, 2, 4, 5]],
    ),
    "twice": lambda: square(extra=[([1, 5], "M"), ([1, 5], "V")]),
    "smaller than anything": lambda: miura() | {"vertices_coords": _scaled(1e-200)},
    "springs beyond numbers": lambda: _sprung(1e308),
    "springs too unlike": lambda: _sprung(1e9),
}


def _twice(vertex, data=None):
    x = (data or square())["vertices_coords"]
    return [*x, list(x[vertex])]


def _dragged(vertex):
    """One crease at a vertex now ends at a vertex after the last."""
    data = miura()
    pair = next(pair for pair in data["edges_vertices"] if vertex in pair)
    pair[pair.index(vertex)] = len(data["vertices_coords"])
    return data


def _crossed(data):
    a, b, c, d = data["faces_vertices"][0]
    data["faces_vertices"][0] = [a, c, b, d]
    return data


def _scaled(factor):
    return [[factor * v for v in x] for x in miura()["vertices_coords"]]


def _sprung(largest):
    data = miura()
    inner = [a in "MV" for a in data["edges_assignment"]]
    springs = [1.0 if i else None for i in inner]
    springs[inner.index(True)] = largest
    return {**data, "edges_origaminlp:stiffness": springs}


def _faces(coords, faces):
    return {"vertices_coords": coords, "faces_vertices": faces}


def test_paper_that_meets_in_a_point_is_not_joined_there():
    x = [[i, j] for j in range(5) for i in range(5)]
    quads = [
        [5 * j + i, 5 * j + i + 1, 5 * j + i + 6, 5 * j + i + 5]
        for j in range(4)
        for i in range(4)
        if (i, j) not in ((1, 1), (2, 2))
    ]
    p = made(_faces(x, quads))
    assert (p.facets, len(p.vertices), len(p.holes)) == (14, 2, 1)


def _moved(coords):
    """The middle vertex of four facets, far beyond the border."""
    middle = int(np.argmin(np.linalg.norm(np.array(coords) - np.mean(coords, axis=0), axis=1)))
    return [[9.0, 9.0] if k == middle else x for k, x in enumerate(coords)]


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_sheet_is_refused_in_one_line(name):
    with pytest.raises(o.OrigamiError) as refused:
        made(REFUSED[name]())
    assert "\n" not in str(refused.value)


def test_patterns_of_others_are_read():
    for path in others():
        p = o.read_pattern(path)
        problem = PatternProblem(p)
        assert problem.residual(p.reference) == 0.0 and Poses(p).apart(p.reference) < 1e-12
        assert p.facets - p.creases + len(p.vertices) == 1 and not p.holes  # Euler, a disc
        if path.name in FOLDED:
            assert (p.facets, p.creases, len(p.vertices)) == FOLDED[path.name]


@pytest.mark.parametrize("scale", [2.0**-40, 2.0**40])
@pytest.mark.parametrize("axes", [(0, 1), (0, 2), (1, 2)])
def test_the_unit_of_length_changes_nothing(scale, axes):
    """By powers of two nothing rounds differently, whatever plane the sheet is in."""
    data, x = miura(), np.zeros((16, 3))
    x[:, axes] = data["vertices_coords"]
    for faces in (data["faces_vertices"], [f[::-1] for f in data["faces_vertices"]]):
        form = {**data, "faces_vertices": faces}
        one, other = (made({**form, "vertices_coords": (k * x).tolist()}) for k in (1, scale))
        assert (other.corners == scale * one.corners).all() and other.polygons == one.polygons
        assert (other.directions == one.directions).all()


def test_what_was_typed_is_the_title_that_comes_back():
    sheet = examples.pattern("metasheet:2x3")
    assert pattern_from_dict(pattern_to_dict(sheet)).title == sheet.title == "metasheet:2x3"
