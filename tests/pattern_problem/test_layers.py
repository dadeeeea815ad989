"""Orders of layers: the exact test of one vertex, and all orders of strips one after the other."""

import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Vertex, check_admissible
from origami_nlp.pattern import frame_pattern, parse_fold
from origami_nlp.pattern_problem import (
    PatternProblem,
    Stack,
    check_orders,
    order_layers,
    state_frame,
    states_to_fold,
)
from origami_nlp.pattern_states import analyze_mobility, judge
from tests.fold_files import others
from tests.independent.lattice_chains import is_paper
from tests.patterns import grid, miura, miura_angles, scene_pattern, wheel


@pytest.mark.parametrize("degree", [4, 6])
def test_one_vertex_as_the_exact_test_says(degree):
    """Random flat-foldable vertices (Kawasaki), every assignment."""
    rng, ordered, count = np.random.default_rng(degree), 0, 0
    for _ in range(4):
        sectors = np.full(degree, 3.0)
        while sectors.max() > 2.8 or sectors.min() < 0.15:
            sectors = rng.uniform(0.3, 1.6, degree)
            for half in (sectors[0::2], sectors[1::2]):
                half *= math.pi / half.sum()
        problem, vertex = PatternProblem(wheel(sectors)), Vertex(tuple(sectors.tolist()))
        for signs in itertools.product((1.0, -1.0), repeat=degree):
            phi = math.pi * np.array(signs)
            if problem.residual(phi) > 1e-12 or not problem.closure.lifts_to_one(phi):
                continue
            admissible = check_admissible(vertex, phi).admissible
            assert (order_layers(problem, phi).verdict == "ordered") == admissible
            ordered, count = ordered + admissible, count + 1
    assert 0 < ordered < count


def test_facets_that_lie_on_each_other_are_seen_whatever_rounding_does():
    """Triangles that differ by rounding: of some of them GEOS finds only points in common, unless on a grid."""
    from shapely import area, polygons

    phi = math.pi * np.array([1.0, 0, 0, 0, 1.0, 0, 0, 0])
    stack = Stack(PatternProblem(wheel(np.full(8, math.pi / 4))).crossings, phi)
    assert len(stack.pairs) == 4
    rng = np.random.default_rng(0)
    corner = np.array([[0, 0], [1, 0], [math.sqrt(0.5), math.sqrt(0.5)]])
    one = corner + 1e-16 * rng.integers(-2, 3, (2000, 3, 2))
    other = corner + 1e-16 * rng.integers(-2, 3, (2000, 3, 2))
    common = area(stack._shared(polygons(one), polygons(other)))
    assert np.abs(common - math.sqrt(0.125)).max() < 1e-8


def test_facets_that_share_a_line_besides_an_area_are_intersected_with_others():
    """GEOS refuses polygons together with lines: of two that share both, the lines are left out."""
    from shapely import area, polygons

    stack = Stack(PatternProblem(wheel(np.full(4, math.pi / 2))).crossings, np.zeros(4))
    one = polygons([[(0, 0), (2, 0), (2, 1), (1, 1), (1, 0.5), (0, 0.5)]])
    other = polygons([[(0, 0.5), (1, 0.5), (2, 0.5), (2, 1), (0, 1)]])
    both = stack._shared(one, other)
    assert both[0].geom_type == "MultiPolygon" and area(both)[0] == pytest.approx(0.5)
    assert area(stack._shared(both, other))[0] == pytest.approx(0.5)


def _strip(lengths):
    x = np.concatenate([[0.0], np.cumsum(lengths)])
    return PatternProblem(grid(np.stack(np.meshgrid(x, [0.0, 1.0], indexing="ij"), axis=2)))


def _chains(seed, count):
    """Compare random strips, folded by right angles, with all orders of a chain on a lattice."""
    rng, reported = np.random.default_rng(seed), []
    for _ in range(count):
        n = int(rng.integers(3, 8))
        lengths = rng.choice([1, 1, 2], n).tolist()
        turns = rng.choice([0, 1, -1, 2, -2], n - 1, p=[0.1, 0.2, 0.2, 0.25, 0.25]).tolist()
        expected = is_paper(lengths, turns)
        if expected is None:
            continue
        problem, phi = _strip(lengths), np.array(turns) * math.pi / 2
        found = order_layers(problem, phi)
        assert found.verdict != "not decided"
        assert expected == (found.verdict == "ordered" and not problem.crossings.find(phi))
        reported.append(found.verdict)
    return reported


def test_strips_that_leave_the_plane_as_all_orders_of_a_chain_say():
    assert {"ordered", "crosses"} == set(_chains(0, 40))


def _partly_folded(seed, count):
    """Compare random vertices, some creases of which are fully folded or open, with the exact test."""
    rng, reported = np.random.default_rng(seed), []
    while len(reported) < count:
        n, unit = int(rng.integers(4, 9)), int(rng.choice([8, 10, 12]))
        cuts = np.sort(rng.choice(np.arange(1, unit), n - 1, replace=False))
        parts = np.diff([0, *cuts, unit])
        if 2 * parts.max() >= unit:
            continue
        sectors = parts * 2 * math.pi / unit
        problem, vertex = PatternProblem(wheel(sectors)), Vertex(tuple(sectors.tolist()))
        phi, held = rng.uniform(-2.5, 2.5, n), rng.random(n) < 0.45
        phi[held] = rng.choice([-math.pi, math.pi, 0.0], held.sum(), p=[0.4, 0.4, 0.2])
        phi, left = problem.project(phi, held)
        if left > 1e-13 or np.abs(phi).max() > math.pi or not problem.closure.lifts_to_one(phi):
            continue
        found = order_layers(problem, phi)
        assert found.verdict != "not decided"
        paper = found.verdict == "ordered" and not problem.crossings.find(phi)
        assert paper == check_admissible(vertex, phi).admissible, (sectors, phi)
        reported.append((paper, bool(found.pairs), problem.size > len(phi[np.abs(phi) == math.pi])))
    return reported


def test_partly_folded_vertices_as_the_exact_test_says():
    assert {(True, True), (False, True)} <= {one[:2] for one in _partly_folded(0, 8)}


def test_what_passes_through_a_facet_along_a_crease_is_no_paper():
    """No two facets pierce each other, and none lie on each other."""
    problem, phi = _strip([1, 1, 1, 2]), math.pi / 2 * np.array([1, 1, 1])
    assert not problem.crossings.find(phi)
    assert order_layers(problem, phi).verdict == "ordered"  # past a border
    through = _strip([2, 1, 1, 1, 1]), math.pi / 2 * np.array([1, 1, 1, 0])
    assert not through[0].crossings.find(through[1])
    found = order_layers(*through)
    assert found.verdict == "crosses" and "along a crease" in found.reason


def test_facets_that_all_but_lie_on_each_other_are_not_said_to_cross():
    """A crease 3e-6 rad from fully folded, as the ones nearer and farther, and as the same vertex by itself."""
    scene = o.examples.degree6("5*pi/12", ratio=1, symmetry="none")
    problem = PatternProblem(scene_pattern(scene))
    held = np.arange(6) == 2
    at_limit = np.array([-1.375417, 1.2103215, -math.pi, 0.442603, -2.534112, 0.43585])
    for away in (0.0, 1e-6, 2e-6, 2.5e-6, 3e-6, 3.5e-6, 4e-6, 1e-5, 1e-3):
        phi, residual = problem.project(np.where(held, away - math.pi, at_limit), held)
        assert residual < 1e-12 and check_admissible(scene.vertex, phi).admissible
        found = order_layers(problem, phi)
        assert found.verdict == "ordered" or "closer than can be resolved" in found.reason


def _flat_folded(m=3):
    pattern = miura(m, m)
    phi = math.pi * np.sign(miura_angles(pattern, m, 1.0))
    return phi, states_to_fold(pattern, [state_frame(pattern, phi, "flat-folded")])


def _read(data, **changed):
    frame = {**data["file_frames"][0], **changed}
    return frame_pattern(parse_fold(json.dumps({**data, "file_frames": [frame]}))[1])


def test_orders_of_a_file_are_kept_checked_and_completed():
    phi, data = _flat_folded()
    stated = data["file_frames"][0]["faceOrders"]
    whole = check_orders(PatternProblem(_read(data)))
    assert whole.stated and whole.verdict == "ordered"
    assert sorted(map(list, whole.orders)) == sorted(stated) and len(stated) == whole.pairs
    partial = check_orders(PatternProblem(_read(data, faceOrders=stated[::5])))
    assert partial.stated and partial.orders == whole.orders
    for k in range(0, len(stated), 6):
        f, g, s = stated[k]
        wrong = [*stated[:k], [f, g, -s], *stated[k + 1 :]]
        with pytest.raises(o.OrigamiError, match=rf"faceOrders: .*\[{f}, {g}, {-s}\]"):
            check_orders(PatternProblem(_read(data, faceOrders=wrong)))
    with pytest.raises(o.OrigamiError, match="faceOrders"):
        analyze_mobility(_read(data, faceOrders=wrong))
    # another state of the same pattern is not bound by them
    assert order_layers(PatternProblem(_read(data)), -phi).verdict == "ordered"


def test_orders_say_which_way_creases_without_letters_are_shut():
    phi, data = _flat_folded()
    letters = ["U" if a in "MV" else a for a in data["edges_assignment"]]
    data["edges_foldAngle"] = [None] * len(letters)
    bare = _read(data, edges_assignment=letters, edges_foldAngle=[None] * len(letters))
    assert np.array_equal(bare.reference, phi) and not bare.notes


def test_orders_of_faces_that_run_either_way_and_have_other_numbers():
    phi, data = _flat_folded()
    rng = np.random.default_rng(0)
    number = rng.permutation(len(data["faces_vertices"]))
    back = rng.random(len(number)) < 0.4
    faces = [None] * len(number)
    for k, face in enumerate(data["faces_vertices"]):
        faces[number[k]] = face[::-1] if back[k] else face
    orders = [
        [int(number[f]), int(number[g]), -s if back[g] else s]
        for f, g, s in data["file_frames"][0]["faceOrders"]
    ]
    pattern = _read({**data, "faces_vertices": faces}, faceOrders=orders)
    assert np.array_equal(pattern.reference, phi)
    assert check_orders(PatternProblem(pattern)).verdict == "ordered"


def test_a_folded_box_of_another_hand_has_the_order_that_its_file_states():
    pattern = o.read_pattern(*others("fold_box_3d*.fold"))
    found = check_orders(PatternProblem(pattern))
    assert found.stated and found.verdict == "ordered" and found.pairs > 100
    order = {(f, g): s for f, g, s in found.orders}
    same = [order[f, g] == s for f, g, s in pattern.orders if (f, g) in order]
    assert all(same) and len(same) > 5
    for k in range(0, len(pattern.orders), 12):
        f, g, s = pattern.orders[k]
        wrong = (*pattern.orders[:k], (f, g, -s), *pattern.orders[k + 1 :])
        with pytest.raises(o.OrigamiError, match="faceOrders"):
            check_orders(PatternProblem(replace(pattern, orders=wrong)))


@pytest.mark.parametrize("bad", [[0, 1, 2], [0, 99, 1], [0, 0, 1], [0, 1], "ab"])
def test_orders_that_are_none_are_refused(bad):
    with pytest.raises(o.OrigamiError, match=r"faceOrders\[0\]"):
        _read(_flat_folded(2)[1], faceOrders=[bad])


def test_a_miura_sheet_folds_flat_and_large_ones_are_refused_by_name(monkeypatch):
    pattern = miura(4, 4)
    folded = math.pi * np.sign(miura_angles(pattern, 4, 1.0))
    held = pattern.with_springs(1.0, list(folded))
    state = judge(PatternProblem(held), folded)
    assert order_layers(PatternProblem(pattern), folded).verdict == "ordered"
    assert state.verdict in ("minimum", "undecided")
    assert state.energy == 0.0
    monkeypatch.setattr("origami_nlp.pattern_problem.layers.MOST_PAIRS", 2_000)
    large = miura(14, 14)
    far = order_layers(PatternProblem(large), math.pi * np.sign(miura_angles(large, 14, 1.0)))
    assert far.verdict == "not decided"
    assert "pairs" in far.reason
