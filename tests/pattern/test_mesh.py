"""A pattern of arrays is that of the FOLD file that says the same."""

import json

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OrigamiError


def stated():
    """A FOLD dict of an example with its faces, and the letters of its creases by their ends."""
    data = o.examples.crease_pattern("miura", 3, 3)
    pattern = o.examples.pattern("miura", 3, 3)
    ends = map(tuple, data["edges_vertices"])
    letters = dict(zip(ends, data["edges_assignment"], strict=True))
    return data, pattern, {s: x for s, x in letters.items() if x != "B"}


def test_a_mesh_a_dict_and_a_file_are_one_pattern(tmp_path):
    data, _, letters = stated()
    path = tmp_path / "sheet.fold"
    path.write_text(json.dumps(data))
    read = o.read_pattern(path)
    points = np.array(data["vertices_coords"])
    made = o.from_mesh(points, read.polygons, letters, stiffness=2.0, rest_angles=1.0)
    held = {frozenset(e): k for k, e in enumerate(read.ends.tolist())}
    order = [held[frozenset(e)] for e in made.ends.tolist()]
    assert sorted(order) == list(range(read.creases))
    assert (made.stiffness == 2.0).all()
    assert made.rest == pytest.approx(np.sign(read.rest[order]))
    counts = [o.analyze_mobility(x).dof for x in (data, {**data, "vertices_coords": points}, path)]
    assert len(set(counts)) == 1


def test_numbers_of_each_crease_are_in_the_order_of_the_pattern():
    _, pattern, letters = stated()
    n = pattern.creases
    made = o.from_mesh(
        pattern.corners, pattern.polygons, letters, stiffness=np.arange(1.0, n + 1),
        rest_angles=np.linspace(-1, 1, n),
    )  # fmt: skip
    assert made.stiffness.tolist() == list(range(1, n + 1))
    assert made.rest == pytest.approx(np.linspace(-1, 1, n))


def test_points_out_of_one_plane_are_a_folded_form():
    made = o.from_mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 1)], [(0, 1, 2), (1, 3, 2)])
    # two planes: z = 0, and x + y - z = 1
    assert np.cos(made.reference) == pytest.approx([1 / np.sqrt(3)])


@pytest.mark.parametrize(
    "change",
    [
        {"vertices": [[0, 0], [1]]},
        {"vertices": [[0.0, 0.0]] * 3},
        {"vertices": "abc"},
        {"faces": [[0, 1, 99]]},
        {"faces": [[0, "a", 1]]},
        {"faces": 3},
        {"assignment": {(0, 99): "M"}},
        {"assignment": {(0, 1, 2): "M"}},
        {"assignment": "Q"},
        {"stiffness": [1.0]},
        {"stiffness": -1.0},
        {"stiffness": "soft"},
        {"rest_angles": [0.0]},
        {"rest_angles": float("nan")},
    ],
)
def test_what_is_wrong_is_said_in_one_line(change):
    _, pattern, letters = stated()
    given = {"vertices": pattern.corners, "faces": pattern.polygons, "assignment": letters} | change
    vertices, faces, assignment = (given.pop(k) for k in ("vertices", "faces", "assignment"))
    with pytest.raises(OrigamiError) as caught:
        o.from_mesh(vertices, faces, assignment, **given)
    assert "\n" not in str(caught.value)
