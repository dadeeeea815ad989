"""Coordinates with few digits: what was drawn is what is read, and nothing else is moved."""

import json
import math

import numpy as np
import pytest

from origami_nlp.pattern import examples, frame_pattern, parse_fold
from origami_nlp.pattern_problem import PatternProblem, Poses
from origami_nlp.pattern_states import judge
from tests.fold_files import others
from tests.relabelled import relabelled


def turned(name, digits, rows=None, columns=None, angle=0.3):
    """An example, turned in its plane and written with so many decimals; None: all."""
    data = examples.crease_pattern(name, rows, columns)
    c, s = math.cos(angle), math.sin(angle)
    x = np.array(data["vertices_coords"])[:, :2] @ np.array([[c, -s], [s, c]])
    return {
        **data,
        "vertices_coords": (x if digits is None else np.round(x, digits)).tolist(),
    }


def made(data):
    (frame,) = parse_fold(json.dumps(data))
    return frame_pattern(frame)


def sectors(pattern):
    """Of each interior vertex, from the azimuths of its creases alone."""
    for loop in pattern.vertices:
        d = np.array(loop.signs)[:, None] * pattern.directions[list(loop.creases)]
        azimuth = np.sort(np.arctan2(d[:, 1], d[:, 0]))
        yield np.diff(np.append(azimuth, azimuth[0] + 2 * math.pi))


def kawasaki(pattern):
    return max(abs(a[::2].sum() - math.pi) for a in sectors(pattern))


def lengths(corners, data):
    d = corners[np.array(data["edges_vertices"])]
    return np.linalg.norm(d[:, 1] - d[:, 0], axis=1)


@pytest.mark.parametrize("digits", [4, 6, 9, 12])
@pytest.mark.parametrize(
    ("name", "size"),
    [("miura", (4, 4)), ("waterbomb", (2, 2)), ("yoshimura", (2, 3)), ("metasheet", (3, 3))],
)
def test_patterns_with_few_digits_are_what_was_drawn(name, size, digits):
    data, whole = turned(name, digits, *size), turned(name, None, *size)
    pattern, unit = made(data), 10.0**-digits
    x = np.zeros_like(pattern.corners)
    x[:, :2] = data["vertices_coords"]
    assert np.abs(pattern.corners - x).max() <= 2 * unit
    drawn = made(whole)
    for ours, theirs in zip(sectors(pattern), sectors(drawn), strict=True):
        miss = ours - theirs
        rolled = [np.abs(np.roll(ours, k) - theirs).max() for k in range(len(miss))]
        assert min(rolled) < 20 * unit
    if kawasaki(drawn) < 1e-12:
        assert kawasaki(pattern) < 1e-12
    # sides that were equal are equal again
    order = np.argsort(lengths(drawn.corners, data))
    ours, theirs = lengths(pattern.corners, data)[order], lengths(drawn.corners, data)[order]
    equal = np.diff(theirs) < 1e-12
    assert equal.any() and np.abs(np.diff(ours)[equal]).max() < 1e-12
    assert (
        np.abs(np.diff(lengths(x, data)[order])[equal]).max() > 1e-3 * unit
    )  # as written they are not
    assert any("few digits" in note for note in pattern.notes)


def test_whole_doubles_stay_as_they_are():
    data = turned("miura", None, 4, 4)
    pattern = made(data)
    assert (pattern.corners[:, :2] == np.array(data["vertices_coords"])).all()
    assert not any("digits" in note for note in pattern.notes)


def test_generic_quadrilaterals_stay_generic():
    """Sectors that are not equal within the digits are not made so: no more than a coincidence of two."""
    rng = np.random.default_rng(0)
    data = examples.crease_pattern("metasheet", 3, 3)
    x = np.array(data["vertices_coords"])[:, :2]
    x = np.round(x + rng.uniform(-0.1, 0.1, x.shape), 6)
    pattern = made({**data, "vertices_coords": x.tolist()})
    assert np.abs(pattern.corners[:, :2] - x).max() <= 2e-6
    assert kawasaki(pattern) > 1e-3


def test_coarse_drawings_stay_as_they_are():
    """Sectors of integers are not known to a milliradian: that a relation nearly holds says nothing."""
    data = turned("miura", None, 4, 4)
    x = np.round(20 * np.array(data["vertices_coords"]))
    pattern = made({**data, "vertices_coords": x.tolist()})
    assert (pattern.corners[:, :2] == x).all()


def test_a_side_as_short_as_the_digits_stays():
    """What would bring two corners together is no relation of the drawing."""
    x = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1], [1, 1e-7]]
    edges = [*([i, (i + 1) % 8] for i in range(8)), [1, 8], [3, 8], [5, 8], [7, 8]]
    letters = [*"BBBBBBBBVVMV"]
    pattern = made({"vertices_coords": x, "edges_vertices": edges, "edges_assignment": letters})
    assert (pattern.corners[:, :2] == x).all() and len(pattern.vertices) == 1


@pytest.mark.parametrize("digits", [5, 6])
def test_a_folded_form_with_few_digits_is_read_as_the_folded_sheet(digits):
    flat = made(examples.crease_pattern("miura", 3, 3))
    phi, residual = PatternProblem(flat).project(0.6 * flat.signs)
    assert residual < 1e-13
    data = examples.crease_pattern("miura", 3, 3)
    x = np.round(Poses(flat).corners(phi), digits)
    data |= {"vertices_coords": x.tolist(), "frame_classes": ["foldedForm"]}
    folded = made(data)
    for polygon in folded.polygons:
        p = folded.corners[list(polygon)]
        assert abs(np.linalg.det(p[1:] - p[0])) < 1e-14  # plane
    assert np.abs(folded.reference - phi).max() < 40 * 10.0**-digits
    # the sheet of exact sectors has closed states elsewhere too, as many degrees of freedom, one
    other, _ = PatternProblem(folded).project(folded.reference + 0.2 * folded.signs)
    assert (
        PatternProblem(folded).residual(other) < 1e-12
        and np.abs(other - folded.reference).max() > 0.05
    )
    singular = np.linalg.svd(PatternProblem(folded).closure.jacobian(other), compute_uv=False)
    assert singular[-1] < 1e-12 < 1e-3 < singular[-2]


def test_the_folded_square_twist_is_judged_alike_under_other_labels():
    (file,) = others("fold_squaretwist_4xdeg4.fold")
    (frame,) = parse_fold(file.read_bytes())
    pattern = frame_pattern(frame)
    verdicts = [judge(PatternProblem(pattern), pattern.reference).verdict]
    for seed in range(6):
        copy, _, _ = relabelled(pattern, seed, mirror=seed % 2 == 1, over=seed % 3 == 1)
        verdicts.append(judge(PatternProblem(copy), copy.reference).verdict)
    assert verdicts == ["minimum"] * 7
