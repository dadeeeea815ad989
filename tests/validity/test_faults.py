"""Faults planted one by one are found, at the right place; what is sound is valid."""

import copy
import json
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OptionError
from origami_nlp.pattern_problem import state_frame, states_to_fold
from tests.patterns import grid as quads, miura, miura_angles

STRETCH = "lengths as in the crease pattern"
PLANES = "plane faces"
ANGLES = "fold angles as in the coordinates"
LETTERS = "mountains and valleys as folded"
CLOSES = "closes round vertices and holes"
CROSSES = "no faces pass through each other"
CREASES = "faceOrders agree with creases"
PAPER = "faceOrders are those of paper"
WHOLE = "faceOrders are whole"
LAYERS = "layers have an order"


def map_3x3():
    """A map of 3 x 3 squares folded flat: thirds over each other, then thirds again."""
    i, j = np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij")
    sheet = quads(np.stack([i, j], axis=2))
    phi = np.zeros(sheet.creases)
    middle = sheet.corners[sheet.ends].mean(axis=1)
    for c, (x, y, _) in enumerate(middle):
        if x == round(
            x
        ):  # across the first folds, all through the sheet: up at x = 1, down at x = 2
            phi[c] = math.pi if x == 1 else -math.pi
        else:  # the second folds alternate with the layers
            side = 1.0 if y == 1 else -1.0
            phi[c] = math.pi * side * (-1.0) ** math.floor(x)
    return sheet, phi


def stated(sheet, phi):
    """FOLD data: the crease pattern and the folded form, with order of layers."""
    return json.loads(json.dumps(states_to_fold(sheet, [state_frame(sheet, phi, "folded")])))


@pytest.fixture(scope="module")
def flat():
    return stated(*map_3x3())


@pytest.fixture(scope="module")
def space():
    sheet = miura(3, 3)
    return stated(sheet, miura_angles(sheet, 3, 1.0))


def faults(data, **options):
    """What is found: (test, fault) by test."""
    found = {}
    for one in o.check(data, **options).faults:
        found.setdefault(one.test, []).append(one)
    return found


def planted(data, change):
    made = copy.deepcopy(data)
    change(made, made["file_frames"][0])
    return made


def spoilt(data, test, change):
    """The one fault of a test where something is another in the folded form."""
    (one,) = faults(planted(data, lambda _, frame: change(frame)))[test]
    return one


def test_what_is_sound_is_valid(flat, space):
    for data in (flat, space):
        seen = o.check(data)
        assert seen.verdict == "valid", seen.report()
        assert all(t.status == "ok" or t.status == "does not apply" for t in seen.tests)


# ---------------------------------------------------------------- coordinates


@pytest.mark.parametrize("by", [1e-4, 1e-2, 0.3])
def test_a_moved_corner_is_blamed_on_its_edges_not_on_layers(flat, space, by):
    for data in (flat, space):

        def move(whole, frame):
            frame["vertices_coords"][5][0] += by

        bad = planted(data, move)
        found = faults(bad)
        at = {e for e, pair in enumerate(bad["edges_vertices"]) if 5 in pair}
        stretched = {e for one in found[STRETCH] for e in one.edges}
        assert stretched and stretched <= at
        assert not {CREASES, PAPER, WHOLE, LAYERS} & set(found)
        size = max(one.size for one in found[STRETCH] if one.edges)
        assert 0.2 * by < size <= 1.01 * by


def test_a_scaled_copy_is_one_fault(space):
    x = (1.1 * np.array(space["file_frames"][0]["vertices_coords"])).tolist()
    one = spoilt(space, STRETCH, lambda frame: frame.update(vertices_coords=x))
    assert one.size == pytest.approx(0.1) and "1.1 times" in one.text


def test_a_sheared_face_is_found_by_its_diagonals():
    flat = quads(np.array([[[0, 0], [0, 1]], [[1, 0], [1, 1]], [[2, 0], [2, 1]]], float))
    data = stated(flat, np.zeros(1))
    shear = np.array([[1.0, math.sin(0.1), 0.0], [0.0, math.cos(0.1), 0.0], [0.0, 0.0, 1.0]])
    frame = data["file_frames"][0]
    frame["vertices_coords"] = (np.array(frame["vertices_coords"]) @ shear.T).tolist()
    found = faults(data)[STRETCH]
    assert [one.faces for one in found] == [(0,), (1,)]
    # law of cosines: the diagonal between sides of length 1 at 90 degrees less 0.1
    assert found[0].size == pytest.approx(
        max(abs(math.sqrt(2 + s * 2 * math.sin(0.1)) - math.sqrt(2)) for s in (1, -1)), rel=1e-6
    )


def test_a_face_off_its_plane_is_found(space):
    x = copy.deepcopy(space["file_frames"][0]["vertices_coords"])
    x[0][2] += 2e-3
    assert spoilt(space, PLANES, lambda frame: frame.update(vertices_coords=x)).faces == (0,)


def test_a_stated_fold_angle_that_is_not_that_of_the_coordinates(space):
    angles = space["file_frames"][0]["edges_foldAngle"]
    edge = next(e for e, a in enumerate(angles) if abs(a) > 1)
    new = 1.05 * angles[edge]
    one = spoilt(space, ANGLES, lambda frame: frame["edges_foldAngle"].__setitem__(edge, new))
    turned = 0.05 * abs(angles[edge])
    assert one.edges == (edge,) and math.degrees(one.size) == pytest.approx(turned, rel=1e-6)


@pytest.mark.parametrize("letter, test", [("V", LETTERS), ("B", "cuts as in the crease pattern")])
def test_a_mountain_that_is_another(space, letter, test):
    edge = space["file_frames"][0]["edges_assignment"].index("M")
    one = spoilt(space, test, lambda frame: frame["edges_assignment"].__setitem__(edge, letter))
    assert one.edges == (edge,)


def test_a_letter_of_a_crease_folded_flat_against_the_order(flat):
    letters = flat["file_frames"][0]["edges_assignment"]
    edge = letters.index("M")

    def swap(whole, frame):
        frame["edges_assignment"][edge] = "V"
        frame["edges_foldAngle"][edge] *= -1

    found = faults(planted(flat, swap))
    assert edge in {e for one in found[CREASES] for e in one.edges}


def test_joined_faces_at_an_angle():
    """Two faces joined by an F edge, folded along it, beside a crease."""
    data = {
        "vertices_coords": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0.5], [2, 1, 0.5]],
        "faces_vertices": [[0, 1, 2, 3], [1, 4, 5, 2]],
        "edges_vertices": [[0, 1], [1, 2], [2, 3], [3, 0], [1, 4], [4, 5], [5, 2]],
        "edges_assignment": ["B", "F", "B", "B", "B", "B", "B"],
        "frame_classes": ["foldedForm"],
    }
    (one,) = faults(data)["flat edges are flat"]
    assert one.edges == (1,) and one.size == pytest.approx(math.atan(0.5))


def test_an_angle_sum_that_no_flat_sheet_has():
    """A corner of a cube, without a crease pattern."""
    data = {
        "vertices_coords": [
            [0, 0, 0],
            [1, 0, 0],
            [0, 1, 0],
            [0, 0, 1],
            [1, 1, 0],
            [0, 1, 1],
            [1, 0, 1],
        ],
        "faces_vertices": [[0, 1, 4, 2], [0, 2, 5, 3], [0, 3, 6, 1]],
        "frame_classes": ["foldedForm"],
    }
    (one,) = faults(data)["flat round every vertex"]
    assert one.vertices == (0,) and one.size == pytest.approx(math.pi / 2)
    assert one.place == (0.0, 0.0, 0.0)


def test_faces_that_pass_through_each_other():
    """A strip of four rolled up: its last square dips through the first."""
    turn = math.radians(100.0)
    strip = quads(np.array([[[x, 0], [x, 1]] for x in range(5)], float))
    data = stated(strip, np.full(3, turn))
    (one,) = faults(data)[CROSSES]
    assert one.faces == (0, 3)
    # corners of the strip, seen from its end
    heading = np.cumsum([0, turn, turn, turn])
    corner = np.concatenate([[0], np.cumsum(np.exp(1j * heading))])
    a, b = corner[3], corner[4]
    at = a + (b - a) * (-a.imag / (b.imag - a.imag))
    assert 0 < at.real < 1
    place = np.array(one.place)
    x = np.array(data["file_frames"][0]["vertices_coords"])
    first = x[data["faces_vertices"][0]]
    # on the first square, its distance from the strip's end
    ends = [v for v in data["faces_vertices"][0] if v in (0, 1)]
    start = x[ends].mean(axis=0)
    assert np.linalg.norm(place - start) == pytest.approx(at.real, abs=1e-9)
    assert np.linalg.matrix_rank(np.vstack([first - first[0], place - first[0]]), tol=1e-9) == 2


# ---------------------------------------------------------------- order of layers


@pytest.mark.parametrize("k", range(0, 36, 5))
def test_an_order_turned_round_is_found(flat, k):
    def turn(whole, frame):
        frame["faceOrders"][k][2] *= -1

    f, g, _ = flat["file_frames"][0]["faceOrders"][k]
    found = faults(planted(flat, turn))
    assert set(found) <= {CREASES, PAPER}
    named = [set(one.faces) for test in found.values() for one in test]
    assert named and all({f, g} <= faces for faces in named)


def test_two_orders_that_say_the_opposite(flat):
    f, g, s = flat["file_frames"][0]["faceOrders"][4]
    one = spoilt(flat, PAPER, lambda frame: frame["faceOrders"].append([f, g, -s]))
    assert set(one.faces) == {f, g}


def pleats():
    """A strip of five with letters that leave several orders."""
    strip = quads(np.array([[[x, 0], [x, 1]] for x in range(6)], float))
    return strip, math.pi * np.array([1.0, 1.0, -1.0, -1.0])


def test_an_order_that_is_neither_stated_nor_follows():
    data = stated(*pleats())
    count = o.layer_orders(*pleats()).count
    assert count > 1 and o.check(data).verdict == "valid"
    orders = data["file_frames"][0]["faceOrders"]
    lost = []
    for k in range(len(orders)):
        found = faults(planted(data, lambda whole, frame, k=k: frame["faceOrders"].pop(k)))
        if found:
            (one,) = found[WHOLE]
            assert set(one.faces) == set(orders[k][:2])
            lost.append(k)
    one_kept = planted(data, lambda whole, frame: frame.update(faceOrders=orders[:1]))
    assert lost or WHOLE in faults(one_kept)


def test_layers_without_any_order():
    """Three stamps of which the middle is the smallest, both folded onto it: they cannot pass each other."""
    xs = [0.0, 3.0, 4.0, 7.0]
    strip = quads(np.array([[[x, 0], [x, 1]] for x in xs], float))
    data = stated(strip, np.array([math.pi, math.pi]))
    data["file_frames"][0]["faceOrders"] = []
    (one,) = faults(data)[LAYERS]
    assert one.faces or "facets" in one.text


def test_all_faults_are_listed_and_not_the_first_only(space):
    def spoil(whole, frame):
        frame["vertices_coords"][0][2] += 0.02
        frame["vertices_coords"][15][2] += 0.02
        frame["edges_foldAngle"][edge] += 10

    frame = space["file_frames"][0]
    edge = next(
        e
        for e, (a, both) in enumerate(
            zip(frame["edges_foldAngle"], space["edges_vertices"], strict=True)
        )
        if abs(a) > 1 and set(both) <= {5, 6, 9, 10}
    )
    bad = planted(space, spoil)
    found = faults(bad)
    assert {0, 15} <= {v for one in found[STRETCH] for v in one.vertices}
    assert [one.edges for one in found[ANGLES]] == [(edge,)]
    assert {f for one in found[PLANES] for f in one.faces} == {0, 8}


# ---------------------------------------------------------------- results, command


def test_results_print_save_and_load(flat, tmp_path):
    bad = planted(flat, lambda whole, frame: frame["vertices_coords"][5].__setitem__(0, 9.0))
    seen = o.check(bad)
    path = tmp_path / "seen.json"
    seen.save(path)
    again = o.read_result(path)
    assert again.faults == seen.faults and again.verdict == "faults"
    assert json.loads(path.read_text())["verdict"] == "faults"
    assert len(seen.to_frame()) == len(seen.faults) and "faults" in str(seen)
    with pytest.raises(OptionError):
        again.draw()
    assert len(seen.draw().axes) == 1
