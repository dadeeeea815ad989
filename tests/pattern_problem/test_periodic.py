"""Cells that repeat: closed forms of the Miura fold, big finite sheets, own closure code, finite differences."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

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
    Lattice,
    PatternProblem,
    find_labels,
    image,
    measured_cell,
    states_to_fold,
)
from tests.independent.rotations import about

GAMMA, STIFF = math.pi / 3, 0.3
NAMES = ("miura", "waterbomb", "yoshimura", "resch", "metasheet")


def folded(cell, size):
    """A closed state of a Miura cell: facets inclined by some angle to the plane of the sheet, and that angle."""
    phi, residual = PatternProblem(cell).project(size * cell.signs)
    assert residual < 1e-13
    # ridges are zigzags, between facets inclined to either side
    zigzag = np.abs(cell.directions[:, 0]) < 0.999
    return phi, float(np.abs(phi[zigzag]).max()) / 2, zigzag


def miura_lengths(theta):
    """Schenk and Guest, PNAS 110 (2013) 3276, with sides 1 (straight) and b (zigzag)."""
    b, tan = 1 / math.sin(GAMMA), math.cos(theta) * math.tan(GAMMA)
    return (
        2 * math.sqrt(1 - (math.sin(theta) * math.sin(GAMMA)) ** 2),
        2 * b * tan / math.sqrt(1 + tan**2),
    )


@pytest.mark.parametrize("rows, columns", [(1, 1), (2, 1)])
@pytest.mark.parametrize("size", [1e-4, 0.05, 0.8, 1.5, 2.5, 3.1])
def test_lattice_of_the_miura_fold_is_its_closed_form(size, rows, columns):
    cell = o.examples.pattern("miura", rows, columns, cell=True)
    phi, theta, _ = folded(cell, size)
    found, (length, width) = (
        measured_cell(cell).at(State(PatternProblem(cell), phi)),
        miura_lengths(theta),
    )
    assert np.allclose(found.lengths, (columns * length, rows * width), rtol=0, atol=1e-11)
    assert abs(found.angle - math.pi / 2) < 1e-11
    assert abs(found.area - rows * columns * length * width) < 1e-11
    if (rows, columns) == (1, 1):
        poisson = -((math.cos(theta) * math.tan(GAMMA)) ** 2)  # force along the zigzags
        assert abs(found.poisson[1] / poisson - 1) < (1e-10 if size > 1e-3 else 1e-6)
        assert abs(found.poisson[0] * poisson - 1) < (1e-10 if size > 1e-3 else 1e-6)


def test_stiffness_of_the_miura_fold_is_that_of_its_energy_over_the_inclination():
    """Along the fold all follows theta: F = U' / L', K = F' / L', by complex steps of the closed forms."""
    cell = o.examples.pattern("miura", 1, 1, cell=True)
    straight = np.abs(cell.directions[:, 0]) > 0.999
    rest = np.where(straight, 0.7, 1.2) * cell.signs
    cell = cell.with_springs(np.where(straight, STIFF, 0.5).tolist(), rest.tolist())

    def energy(theta):
        # four zigzag creases fold by 2 theta, four straight ones by 2 xi with sin xi = sin theta cos gamma / ...
        tan = np.cos(theta) * math.tan(GAMMA)
        # half the angle between the straight creases seen from above, of which their dihedral angle follows
        psi = np.arctan(tan)
        xi = np.arcsin(np.sqrt(1 - (np.sin(psi) / math.sin(GAMMA)) ** 2))
        return 2 * 0.5 * (2 * theta - 1.2) ** 2 + 2 * STIFF * (2 * xi - 0.7) ** 2

    def lengths(theta):
        tan = np.cos(theta) * math.tan(GAMMA)
        return (
            2 * np.sqrt(1 - (np.sin(theta) * math.sin(GAMMA)) ** 2),
            2 / math.sin(GAMMA) * tan / np.sqrt(1 + tan**2),
        )

    for size in (0.5, 1.0, 1.8):
        phi, theta, _ = folded(cell, size)
        assert abs(energy(theta) - cell.energy(phi)) < 1e-13
        found, h = measured_cell(cell).at(State(PatternProblem(cell), phi)), 1e-4
        for k in range(2):

            def force(t, k=k):
                step = 1e-30j
                return (energy(t + step) / lengths(t + step)[k].imag).imag

            slope = (force(theta + h) - force(theta - h)) / (2 * h)
            per = lengths(theta + 1e-30j)[k].imag / 1e-30
            assert abs(found.stiffness[k] * per / slope - 1) < 1e-6


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_of_lattice_and_closure_are_differences(name):
    cell = o.examples.pattern(name, 1, 1, cell=True)
    problem, lattice = PatternProblem(cell), Lattice(cell)
    x, h = np.random.default_rng(1).normal(size=cell.creases), 1e-5

    def slope(f):
        return np.stack([(f(x + h * e) - f(x - h * e)) / (2 * h) for e in np.eye(len(x))], axis=-1)

    assert np.abs(slope(problem.closure.values) - problem.closure(x)[1]).max() < 1e-9
    weights = np.random.default_rng(2).normal(size=problem.equation_count)
    bent = problem.closure.hessian(x, weights)
    assert np.abs(slope(lambda y: weights @ problem.closure(y)[1]) - bent).max() < 1e-8
    assert np.abs(slope(lattice.vectors) - lattice.slopes(x)).max() < 1e-8

    def length_slope(y, k):
        v = lattice.vectors(y)[k]
        return v @ lattice.slopes(y)[k] / np.linalg.norm(v)

    for k in range(2):
        there = slope(lambda y, k=k: length_slope(y, k))
        assert np.abs(there - lattice.length_bends(x, k)).max() < 1e-7


def test_copies_are_translated_where_a_big_sheet_is_folded_alike():
    """A finite sheet of 12 x 12 facets, its facets placed by code of our own, crease by crease."""
    cell = o.examples.pattern("miura", 1, 1, cell=True)
    phi, _, _ = folded(cell, 1.1)
    sheet, crease_of = cell.cell.lay([(i, j) for i in range(6) for j in range(6)])
    assert sheet.facets == 144 and len(sheet.vertices) == 121
    angles = phi[crease_of]
    assert PatternProblem(sheet).residual(angles) < 1e-12
    pose = {0: (np.eye(3), np.zeros(3))}
    while len(pose) < sheet.facets:
        for k, (a, b) in enumerate(zip(sheet.left.tolist(), sheet.right.tolist(), strict=True)):
            for one, other, sense in ((a, b, -1.0), (b, a, 1.0)):
                if one in pose and other not in pose:
                    turn, shift = pose[one]
                    r, p = (
                        about(sense * sheet.directions[k], angles[k]),
                        sheet.corners[sheet.ends[k, 0]],
                    )
                    pose[other] = turn @ r, turn @ (p - r @ p) + shift
    found = measured_cell(cell).at(State(PatternProblem(cell), phi))
    for i in range(6):
        for j in range(6):
            turn, shift = pose[4 * (6 * i + j)]
            at = turn @ (sheet.corners[0] + np.array([i, j]) @ cell.cell.lattice) + shift
            assert np.abs(turn - np.eye(3)).max() < 1e-12
            assert (
                np.abs(at - sheet.corners[0] - np.array([i, j]) @ np.array(found.vectors)).max()
                < 1e-12
            )


@pytest.mark.parametrize("name", NAMES)
def test_symmetries_of_a_cell_take_closed_states_to_closed_ones(name):
    cell = o.examples.pattern(name, 1, 2, cell=True)
    problem = PatternProblem(cell)
    phi, residual = problem.project(0.3 * np.random.default_rng(0).normal(size=cell.creases))
    images = find_labels(cell).images
    assert residual < 1e-8 and len(images) >= 15 - 8 * (name == "resch")
    assert max(problem.residual(image(one, phi)) for one in images) < 1e-8


@pytest.mark.parametrize("name", NAMES)
def test_cells_are_written_and_read(name):
    cell = o.examples.pattern(name, 2, 1, cell=True)
    data = pattern_to_dict(cell)
    assert pattern_to_dict(pattern_from_dict(json.loads(json.dumps(data)))) == data
    (frame,) = parse_fold(json.dumps(states_to_fold(cell)))
    again = pattern_to_dict(frame_pattern(frame))
    assert {k: v for k, v in again.items() if v != data[k]}.keys() <= {"numbers"}


def test_wrong_cells_are_refused_in_one_line():
    def read(**changes):
        data = o.examples.crease_pattern("miura", 1, 1, cell=True) | changes
        return frame_pattern(parse_fold(json.dumps(data))[0])

    given = o.examples.crease_pattern("miura", 1, 1, cell=True)
    moved = [list(p) for p in given["vertices_coords"]]
    corner = max(range(len(moved)), key=lambda v: moved[v][0] + 0.1 * moved[v][1])
    moved[corner][0] += 0.01
    other = list(given["edges_assignment"])
    border = given["edges_vertices"].index([0, 3])
    other[border] = "MV"[other[border] == "M"]
    for changes, words in (
        ({"origaminlp:lattice": [[2, 0], [4, 0]]}, "on one line"),
        ({"origaminlp:lattice": [[3, 0], [0, 2]]}, "span an area of 6"),
        ({"origaminlp:lattice": [[2, 0.2], [0, 2]]}, "has no counterpart"),
        ({"origaminlp:lattice": [2, 0]}, r"lattice\[0\] = 2 must be"),
        ({"origaminlp:lattice": [[2, 0]]}, "two vectors"),
        ({"vertices_coords": moved}, "origaminlp:lattice"),
        ({"edges_assignment": other}, "are one crease"),
    ):
        with pytest.raises(OrigamiError, match=words) as error:
            read(**changes)
        assert "\n" not in str(error.value)


def test_what_a_cell_has_not_is_refused():
    cell = o.examples.pattern("miura", 1, 1, cell=True)
    for ask in (
        lambda: o.find_minima(cell, noise=0.1),
        lambda: o.load_path(cell, 1),
        lambda: o.check(cell),
        lambda: o.layer_orders(cell),
    ):
        with pytest.raises(OrigamiError) as error:
            ask()
        assert "\n" not in str(error.value)


def test_copies_that_cross_are_found():
    """A pleat wider than its cell, leaning over: it crosses its copies, though not itself."""
    wide = make_cell(
        [[0, 0], [0.2, 0], [1.2, 0], [2.2, 0], [2.2, 1], [1.2, 1], [0.2, 1], [0, 1]],
        [(0, 1, 6, 7), (1, 2, 5, 6), (2, 3, 4, 5)],
        [[2.2, 0], [0, 1]],
    )
    problem = PatternProblem(wide)
    x = wide.corners[wide.ends].mean(axis=1)[:, 0]
    for lean, crosses in ((1.5, False), (2.2, True)):
        # a parallelogram's two sides of length 1, folded up by `lean`, back by pi, and down again
        phi = np.zeros(wide.creases)
        phi[np.abs(x - 0.2) < 1e-9], phi[np.abs(x - 1.2) < 1e-9] = lean, -2 * lean
        phi[(np.abs(x) < 1e-9) | (np.abs(x - 2.2) < 1e-9)] = lean
        across = np.abs(wide.directions[:, 1]) < 0.5
        phi[across] = 0.0
        assert problem.residual(phi) < 1e-12
        found = problem.crossings.find(phi)
        sheet, crease_of = wide.cell.lay([(i, 0) for i in range(5)])
        assert bool(found) == bool(PatternProblem(sheet).crossings.find(phi[crease_of])) == crosses
