"""Counts, ranks and degrees of freedom of patterns; the rank of every Jacobian is that of differences."""

import json
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import Interrupted
from origami_nlp.pattern import frame_pattern, make_pattern, parse_fold
from origami_nlp.pattern_problem import PatternProblem, Poses, angle_sums
from origami_nlp.pattern_states import find_states, search
from tests.command_line import run
from tests.fold_files import others

KEYS = "facets interior_vertices creases closure_rows rank_flat rank_folded dof redundant".split()
TABLE = {
    "miura 2x2": (4, 1, 4, 3, 2, 3, 1, 0),
    "miura 4x4": (16, 9, 24, 27, 18, 23, 1, 4),
    "miura 8x8": (64, 49, 112, 147, 98, 111, 1, 36),
    "metasheet 3x3": (9, 4, 12, 12, 8, 11, 1, 1),
    "metasheet 4x4": (16, 9, 24, 27, 18, 23, 1, 4),
    "metasheet 6x6": (36, 25, 60, 75, 50, 59, 1, 16),
    "metasheet 8x8": (64, 49, 112, 147, 98, 111, 1, 36),
    "yoshimura strips 3x3": (15, 3, 17, 9, 6, 9, 8, 0),
    "yoshimura strips 6x6": (66, 22, 87, 66, 44, 66, 21, 0),
    "waterbomb 3x3": (54, 17, 70, 51, 34, 51, 19, 0),
}
"""Known from a prototype that shares no code, but for waterbombs, whose columns are shifted here the other way."""
LONG = {
    "miura 16x16": (256, 225, 480, 675, 450, 479, 1, 196),
    "miura 32x32": (1024, 961, 1984, 2883, 1922, 1983, 1, 900),
    "waterbomb 5x5": (150, 57, 206, 171, 114, 171, 35, 0),
}
FILES = {
    "fold_squaretwist_4xdeg4": (9, 4, 12, 12, 8, 11, 1, 1),
    "foldforge_miura_9xdeg4": (16, 9, 24, 27, 18, 23, 1, 4),
}


def strips(rows, columns):
    """Yoshimura triangles in rows of 2 columns - 1, leaning to and fro."""
    corners, polygons, number = [], [], {}

    def at(x, y):
        if (x, y) not in number:
            number[x, y] = len(corners)
            corners.append((x, y * math.tan(math.pi / 6)))
        return number[x, y]

    for r in range(rows):
        for k in range(2 * columns - 1):
            low, high = (at(k, r), at(k + 2, r)), (at(k, r + 1), at(k + 2, r + 1))
            up = (k + r) % 2 == 0
            polygons.append((*low, at(k + 1, r + 1)) if up else (at(k + 1, r), high[1], high[0]))
    return make_pattern(np.array(corners), polygons)


def named(name):
    word, size = name.rsplit(" ", 1)
    size = [int(k) for k in size.split("x")]
    return strips(*size) if word == "yoshimura strips" else o.examples.pattern(word, *size)


def hinge_dof(pattern, phi):
    """Degrees of freedom of facets as bodies in space, hinged at both ends of each crease: nothing of closure."""
    turn, shift = Poses(pattern).motions(phi)
    rows = []
    for ends, a, b in zip(pattern.ends, pattern.left, pattern.right, strict=True):
        for v in ends:
            x = turn[a] @ pattern.corners[v] + shift[a]
            arm = np.array([[0, x[2], -x[1]], [-x[2], 0, x[0]], [x[1], -x[0], 0]])  # w x x
            row = np.zeros((3, 6 * pattern.facets))
            row[:, 6 * a : 6 * a + 6] = np.hstack([np.eye(3), arm])
            row[:, 6 * b : 6 * b + 6] = -np.hstack([np.eye(3), arm])
            rows.append(row)
    held = int((np.linalg.svd(np.vstack(rows), compute_uv=False) > 1e-9).sum())
    return 6 * pattern.facets - 6 - held


def differences_rank(problem, phi):
    """Rank of the Jacobian made of central differences of closure."""
    h = 1e-5
    rows = [
        (problem.closure.values(phi + h * e) - problem.closure.values(phi - h * e)) / (2 * h)
        for e in np.eye(len(phi))
    ]
    return int((np.linalg.svd(np.array(rows), compute_uv=False) > 1e-6).sum())


def check_counts(seen, expected, most):
    """Counts and ranks, and those of up to so many creases by differences and by hinges."""
    data = seen.to_dict()
    assert tuple(data[key] for key in KEYS) == expected
    assert data["rank_flat"] == 2 * data["interior_vertices"]  # all creases in a plane
    problem = PatternProblem(seen.pattern)
    assert problem.residual(seen.folded) < 1e-12 and np.abs(seen.folded).min() > 1e-3
    if seen.pattern.creases < most:
        assert differences_rank(problem, seen.folded) == data["rank_folded"]
        assert hinge_dof(seen.pattern, seen.folded) == data["dof"]
        if seen.pattern.is_flat:
            assert differences_rank(problem, 0 * seen.folded) == data["rank_flat"]
    return data


@pytest.mark.parametrize("name", FILES)
def test_counts_of_other_peoples_files(name):
    (path,) = others(f"{name}.fold")
    check_counts(o.analyze_mobility(path), FILES[name], 100)


@pytest.mark.parametrize(
    "name", [*TABLE, *(pytest.param(name, marks=pytest.mark.slow) for name in LONG)]
)
def test_counts_ranks_and_dof(name):
    seen = o.analyze_mobility(named(name))
    data = check_counts(seen, (TABLE | LONG)[name], 100 if name in TABLE else 250)
    if name.startswith(("miura", "metasheet")):  # (m - 2)(n - 2) equations say nothing new
        rows, columns = map(int, name.split()[1].split("x"))
        assert data["redundant"] == (rows - 2) * (columns - 2)


def test_a_hole_takes_dof_that_open_vertices_alone_would_leave():
    p = o.examples.pattern("miura", 5, 5)
    middle = [k for k in range(25) if k // 5 in (2, 3) and k % 5 in (1, 2)]
    polygons = [q for k, q in enumerate(p.polygons) if k not in middle]
    holed = make_pattern(p.corners, polygons)
    straight = np.abs(holed.directions[:, 1]) < 1e-9
    letters = dict(zip(map(tuple, p.ends.tolist()), p.signs, strict=True))
    sign = np.array([letters[tuple(e)] for e in holed.ends.tolist()])
    h = 2 * math.atan(0.5 * math.tan(0.6))
    phi = sign * np.where(straight, h, 1.2)
    problem = PatternProblem(holed)
    assert len(holed.holes) == 1 and problem.residual(phi) < 1e-14
    j = problem.closure.jacobian(phi)
    j = j if isinstance(j, np.ndarray) else j.toarray()
    vertices_alone = np.linalg.matrix_rank(j[: 3 * len(holed.vertices)], tol=1e-7)
    assert holed.creases - vertices_alone == 7
    assert holed.creases - problem.rank(phi) == hinge_dof(holed, phi) == 2
    # closed at vertices alone it may be open round the hole
    z = np.linalg.svd(j[: 3 * len(holed.vertices)])[2][3 * len(holed.vertices) :]
    opened = max(np.linalg.norm(j @ d) for d in z)
    assert opened > 0.1


def test_what_cannot_fold_is_said():
    corner = [(0.0, 0.0), (1.0, 0.0), (-0.5, 0.8), (-0.5, -0.8)]
    p = make_pattern(np.array(corner), [(0, 1, 2), (0, 2, 3), (0, 3, 1)])
    seen = o.analyze_mobility(p)
    assert seen.folded is None and seen.dof is None
    assert seen.flags.few_creases and seen.flags.nothing_folded


def test_no_dof_to_first_order_is_none_at_all():
    """A crease with a corner in it: paper of 270 and of 90 degrees, in one plane."""
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, -1), (1, -1)], float)
    p = make_pattern(square, [(0, 1, 2, 3), (0, 3, 4, 5, 6, 1)])
    assert angle_sums(p)[0] == pytest.approx(2 * math.pi, abs=1e-15)
    seen = o.analyze_mobility(p)
    assert seen.folded is None and seen.dof == hinge_dof(p, np.zeros(2)) == 0
    assert o.analyze_mobility(make_pattern(square[:4], [(0, 1, 2, 3)])).dof == 0


def kresling(plates, sides=6, twist=0.7):
    """A tower of triangles between two polygons, which are facets or holes."""
    turns = 2 * math.pi * np.arange(sides) / sides
    rings = [(np.cos(turns + t), np.sin(turns + t), 0 * turns + z) for t, z in ((0, 0), (twist, 1))]
    corners = np.concatenate([np.stack(ring, axis=1) for ring in rings])
    k = np.arange(sides)
    after = (k + 1) % sides
    faces = [*np.stack([k, after, k + sides], 1), *np.stack([after, after + sides, k + sides], 1)]
    faces += [k[::-1], k + sides] if plates else []
    (frame,) = parse_fold(
        json.dumps(
            {
                "vertices_coords": corners.tolist(),
                "faces_vertices": [face.tolist() for face in faces],
                "frame_classes": ["foldedForm"],
            }
        )
    )
    return frame_pattern(frame)


def test_a_tower_between_plates_has_no_dof():
    seen = o.analyze_mobility(kresling(plates=True))
    assert seen.dof == hinge_dof(seen.pattern, seen.pattern.reference) == 0
    assert seen.flags.rigid
    tube = o.analyze_mobility(kresling(plates=False))
    assert tube.dof == hinge_dof(tube.pattern, tube.pattern.reference) == 6


def test_the_command_writes_its_keys(tmp_path):
    fold, out = tmp_path / "a.fold", tmp_path / "a.json"
    assert run("example", "metasheet:3x4", "-o", fold).code == 0
    done = run("inspect", fold, "-o", out, "-o", tmp_path / "a.png")
    assert done.code == 0 and "folds with 1 degree of freedom" in " ".join(done.out.split())
    data = json.loads(out.read_text())
    assert {"holes", *KEYS} <= set(data) and data["holes"] == 0
    assert (data["facets"], data["dof"]) == (12, 1)
    assert (tmp_path / "a.png").stat().st_size > 10_000
    reported = run("inspect", fold, "-o", "-")
    assert json.loads(reported.out)["redundant"] == data["redundant"]
    code, _, err = run("example", "metasheet")
    assert code == 2 and "-o" in err and err.count("\n") == 1


def test_states_that_the_pattern_gives_come_before_branch_directions(monkeypatch):
    """A search that is interrupted while branch directions are listed: of large sheets that had left no state."""

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(search, "list_branches", interrupted)
    with pytest.raises(Interrupted) as stop:
        find_states("miura:3x3", starts=0)
    found = stop.value.result
    assert {s.kind for s in found.minima} == {"interior"}
    assert found.search.left_out[0] == search.FLAT_FOLDED
