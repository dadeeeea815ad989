"""Cells that are rolled up: Yoshimura's cylinder in closed form, sheets placed by own code, finite differences."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import origami_nlp as o
from origami_nlp.errors import OrigamiError
from origami_nlp.kkt import State
from origami_nlp.pattern import (
    frame_pattern,
    make_cell,
    parse_fold,
    pattern_from_dict,
    pattern_to_dict,
)
from origami_nlp.pattern_problem import (
    Closure,
    Lattice,
    PatternProblem,
    find_labels,
    find_screws,
    image,
    measured_cell,
    states_to_fold,
)
from origami_nlp.pattern_problem.crossings import cross_each_other
from tests.computed_once import thinned


def tube(name, rolled, rows=1, columns=1):
    return o.examples.pattern(name, rows, columns, cell=True, rolled=rolled)


def closed(cell, many=1, seed=0, size=2.0):
    """Closed states from random starts, so many or fewer."""
    problem, rng, found = PatternProblem(cell, contact=False), np.random.default_rng(seed), []
    for _ in range(400):
        phi, residual = problem.project(rng.uniform(-size, size, cell.creases))
        if residual < 1e-13 and problem.closure.lifts_to_one(phi) and np.abs(phi).max() < math.pi:
            found.append(phi)
            if len(found) == many:
                break
    assert found
    return found


def placed(sheet, angles):
    """Motions of all facets of an open sheet from its flat state, crease by crease: the first stays."""
    across = {}
    for k, (a, b) in enumerate(zip(sheet.left.tolist(), sheet.right.tolist(), strict=True)):
        across.setdefault(a, []).append((b, k, -1.0))
        across.setdefault(b, []).append((a, k, 1.0))
    pose, open_ = {0: (Rotation.identity(), np.zeros(3))}, [0]
    while open_:
        here = open_.pop(0)
        turn, shift = pose[here]
        for there, k, sense in across[here]:
            if there not in pose:
                fold = Rotation.from_rotvec(sense * angles[k] * sheet.directions[k])
                p = sheet.corners[sheet.ends[k, 0]]
                pose[there] = turn * fold, turn.apply(p - fold.apply(p)) + shift
                open_.append(there)
    return pose


@pytest.mark.parametrize("many", thinned([5, 6, 9, 16], 2))
def test_the_diamond_pattern_round_a_cylinder_is_its_closed_form(many):
    """Rings of N corners, each turned by half a side against the next: Yoshimura 1955, Miura 1969.

    By triangles of base a and height h: the circumscribed circle has R = a / (2 sin pi/N), rings are h' apart with
    h'^2 = h^2 - (R - R cos pi/N)^2, and folds are angles between the planes of three corners each.
    """
    cell = tube("yoshimura", many)
    base, height = 2.0, math.tan(math.pi / 6)
    radius = base / (2 * math.sin(math.pi / many))
    apart = math.sqrt(height**2 - (radius * (1 - math.cos(math.pi / many))) ** 2)
    ring = lambda k, z: np.array(  # noqa: E731
        [radius * math.cos(k * math.pi / many), radius * math.sin(k * math.pi / many), z * apart]
    )

    def normal(*points):
        a, b, c = points
        n = np.cross(b - a, c - a)
        return n / np.linalg.norm(n)

    # two corners of the middle ring, those above and below, and the next above
    up = normal(ring(-1, 0), ring(1, 0), ring(0, 1))
    down = normal(ring(-1, 0), ring(0, -1), ring(1, 0))
    beside = normal(ring(1, 0), ring(2, 1), ring(0, 1))
    along, across = math.acos(up @ down), math.acos(up @ beside)
    result = o.find_minima(cell, effort="quick", escape=False)
    seen = 0
    for m, found in zip(result.minima, result.lattices, strict=True):
        folds = np.sort(np.abs(m.phi))
        if (
            abs(found.turns[0] - 2 * math.pi / many) > 1e-9
            or found.radii[1] - found.radii[0] > 1e-9
        ):
            continue
        seen += 1
        assert found.radius == pytest.approx(radius, abs=1e-11)
        assert np.abs(found.advances) == pytest.approx([0, 2 * apart], abs=1e-11)
        assert abs(found.turns[1]) < 1e-11 and found.length == pytest.approx(2 * apart / many)
        assert folds == pytest.approx(np.sort([along, along, *[across] * 4]), abs=1e-10)
    assert seen == 2  # and turned inside out


def kresling(many, turn, high):
    """Rings of sides of 1, each turned by `turn` against the one below and `high` above it: cut open, and flat."""
    radius, part = 0.5 / math.sin(math.pi / many), 2 * math.pi / many
    squares = [high**2 + (2 * radius * math.sin(0.5 * t)) ** 2 for t in (turn, turn + part)]
    x = 0.5 * (squares[1] - squares[0] - 1)
    y = math.sqrt(squares[0] - x * x)
    corners = [[0, 0], [1, 0], [x, y], [x + 1, y]]
    return make_cell(corners, [(0, 1, 3), (0, 3, 2)], [[1, 0], [x, y]], rolled=(many, 0))


def test_triangulated_cylinders_have_the_two_states_of_their_closed_form():
    """Guest and Pellegrino 1994: where rings are turned by t, another is with pi - 2 pi / N - t, lower or higher."""
    many, turn, high = 6, math.radians(45), 1.2
    cell = kresling(many, turn, high)
    other = math.pi - 2 * math.pi / many - turn
    radius = 0.5 / math.sin(math.pi / many)
    chords = [(2 * radius * math.sin(0.5 * t)) ** 2 for t in (turn, other)]
    lower = math.sqrt(high**2 + chords[0] - chords[1])
    result = o.find_minima(cell, escape=False)
    assert len(result.minima) == 4  # and turned inside out
    found = sorted((x.turns[1], abs(x.advances[1])) for x in result.lattices)
    assert np.abs(np.array(found) - sorted([(turn, high), (other, lower)] * 2)).max() < 1e-9
    for x in result.lattices:
        assert x.turns[0] == pytest.approx(2 * math.pi / many, abs=1e-11)
        assert x.radii == pytest.approx((radius, radius), abs=1e-10)


@pytest.mark.parametrize(
    "name, rolled", [("yoshimura", (7, 3)), ("resch", (6, 0)), ("waterbomb", (0, 6))]
)
def test_a_sheet_folded_alike_closes_once_round(name, rolled):
    """Copies of a finite open sheet, placed by code of our own: screws about one axis, and the last on the first."""
    cell = tube(name, rolled)
    (phi,) = closed(cell)
    p, q = rolled
    sheet, crease_of = cell.cell.lay([(i, j) for i in range(p + 2) for j in range(q + 2)])
    at = placed(sheet, phi[crease_of])
    # every way round vertices leads to the same place
    for k, (a, b) in enumerate(zip(sheet.left.tolist(), sheet.right.tolist(), strict=True)):
        ends = [at[f][0].apply(sheet.corners[sheet.ends[k]]) + at[f][1] for f in (a, b)]
        assert np.abs(ends[0] - ends[1]).max() < 1e-10
    many = len(cell.polygons)

    def corners(i, j):
        """The first polygon of a copy, in space."""
        f = int(sheet.facet_of[many * ((q + 2) * i + j)])
        ring = cell.cell.corners[list(cell.cell.polygons[0])] + np.array([i, j]) @ cell.cell.lattice
        return at[f][0].apply(ring) + at[f][1]

    assert np.abs(corners(p, q) - corners(0, 0)).max() < 1e-10
    assert np.abs(corners(p + 1, q + 1) - corners(1, 1)).max() < 1e-10
    found = measured_cell(cell).at(State(PatternProblem(cell), phi))
    for way in ((1, 0), (0, 1)):
        # the rigid motion between two copies, by least squares, and its axis
        x, y = corners(0, 0), corners(*way)
        turn = Rotation.align_vectors(y - y.mean(0), x - x.mean(0))[0]
        size, k = turn.magnitude(), way.index(1)
        assert size == pytest.approx(abs(found.turns[k]), abs=1e-9)
        if size > 1e-6:
            u = turn.as_rotvec() / size
            shift = float(u @ (y.mean(0) - turn.apply(x.mean(0))))
            assert abs(shift) == pytest.approx(abs(found.advances[k]), abs=1e-9)
    assert p * found.advances[0] + q * found.advances[1] == pytest.approx(0, abs=1e-9)
    winding = (p * found.turns[0] + q * found.turns[1]) / (2 * math.pi)
    assert winding == pytest.approx(round(winding), abs=1e-9) and round(winding) % 2 == 1


def test_all_states_that_close_round_vertices_curl_about_one_axis():
    """Without any condition on the walks both motions commute; two degrees of freedom of the cell are left (Tachi)."""
    found = o.find_minima(tube("yoshimura", 0), starts=0, seconds=0.1, escape=False)
    assert found.flags.copies_curl
    for name in ("yoshimura", "waterbomb", "resch"):
        cell = tube(name, 0)
        assert not cell.generators and not cell.holes
        problem = PatternProblem(cell, contact=False)
        for phi in closed(cell, 3):
            sizes = np.linalg.svd(problem.closure(phi)[1], compute_uv=False)
            assert cell.creases - (sizes > 1e-7).sum() == 2
            screws = find_screws(problem.crossings.poses, phi)
            x = np.random.default_rng(0).normal(size=(4, 3))
            one, other = screws.moved(screws.moved(x, (1, 0)), (0, 1)), screws.moved(x, (1, 1))
            assert np.abs(one - other).max() < 1e-12
            # copies that are placed lie where the screws take them
            places, own = problem.crossings.placed(phi), problem.crossings.own_pieces
            many = len(places) // len(cell.cell.copies)
            home = screws.seen(places[own : own + many])
            for k, copy in enumerate(cell.cell.copies):
                there = screws.seen(places[many * k : many * (k + 1)])
                assert np.abs(screws.moved(home, copy) - there).max() < 1e-9


def test_copies_that_are_not_placed_count_as_others(monkeypatch):
    """Whether a tube crosses itself does not hang on which of its copies are placed, and which moved by their screw."""
    seen, alone, kind = set(), 0, type(tube("yoshimura", 5).cell)
    for name, rolled in (("yoshimura", [0, 7]), ("resch", 7)):
        for phi in closed(tube(name, rolled), 3):
            found = []
            for rings in (3, 2, 1):
                monkeypatch.setattr(kind, "_rings", rings)
                crossings = PatternProblem(tube(name, rolled)).crossings
                found.append(bool(crossings.find(phi)))
                _, one, other = crossings._beyond(phi)
                alone += rings == 1 and bool(cross_each_other(one, other, 1e-9).any())
            assert found[0] == found[1] == found[2]
            seen.add(found[0])
    assert seen == {True, False} and alone


@pytest.mark.parametrize("rolled", [6, [0, 5], [5, 2], 0])
def test_tubes_are_written_and_read(rolled):
    cell = tube("yoshimura", rolled)
    data = pattern_to_dict(cell)
    assert pattern_to_dict(pattern_from_dict(json.loads(json.dumps(data)))) == data
    (frame,) = parse_fold(json.dumps(states_to_fold(cell)))
    again = frame_pattern(frame)
    assert (again.cell.rolled == cell.cell.rolled and again.holes[:1] == () == cell.holes[:1]) or (
        again.holes[0].creases == cell.holes[0].creases
    )


@pytest.mark.parametrize("name, rolled", [("yoshimura", 6), ("miura", [0, 8]), ("resch", [5, 3])])
def test_symmetries_of_a_tube_take_closed_states_to_closed_ones(name, rolled):
    cell = tube(name, rolled)
    problem = PatternProblem(cell)
    (phi,) = closed(cell)
    images = find_labels(cell).images
    # of the sheet that is not rolled up there are more: they turn it by 60 or 120 degrees
    assert len(images) >= (1 if name == "resch" else 4)
    assert (len(find_labels(tube(name, 0)).images) > len(images)) == (name == "resch")
    assert max(problem.residual(image(one, phi)) for one in images) < 1e-10


def test_what_is_no_tube_is_refused_in_one_line():
    def read(value):
        data = o.examples.crease_pattern("miura", 1, 1, cell=True) | {"origaminlp:rolled": value}
        return frame_pattern(parse_fold(json.dumps(data))[0])

    for ask, words in (
        (lambda: read(2), "once round a tube"),
        (lambda: read([1, 2, 3]), "once round a tube"),
        (lambda: read("six"), "once round a tube"),
        (lambda: read([True, 5]), "once round a tube"),
        (lambda: o.examples.pattern("miura", 2, 2, rolled=6), "give cell as well"),
        (lambda: Lattice(tube("miura", 6)), "in a plane"),
        (lambda: o.load_path(tube("yoshimura", 6), 1), "cell that repeats"),
    ):
        with pytest.raises(OrigamiError, match=words) as error:
            ask()
        assert "\n" not in str(error.value)
    assert not tube("miura", 6).lies_flat and tube("miura", 6).is_flat
    assert Closure(tube("miura", 6)).values(np.zeros(8)).max() > 0.1
