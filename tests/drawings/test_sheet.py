"""Lines become one planar graph: ends joined, lines split, letters carried, everything odd named with its place."""

from __future__ import annotations

import itertools
import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import origami_nlp as o
from origami_nlp.drawings import DrawingOptions, Lines
from origami_nlp.drawings.noding import node
from origami_nlp.drawings.sheet import RUNGS, make_drawing, planar


def lines(*rows: tuple, angles=None) -> Lines:
    """Rows (letter, x0, y0, x1, y1)."""
    ends = np.array([row[1:] for row in rows], float).reshape(-1, 2, 2)
    phi = np.full(len(rows), math.nan) if angles is None else np.array(angles, float)
    return Lines(ends, tuple(row[0] for row in rows), phi, False)


def square(
    size: float = 4.0, letter: str = "B", at: tuple[float, float] = (0.0, 0.0)
) -> list[tuple]:
    x, y = at
    c = [(x, y), (x + size, y), (x + size, y + size), (x, y + size)]
    return [(letter, *c[i - 1], *c[i]) for i in range(4)]


def made(*rows, options=None, angles=None):
    return make_drawing(lines(*rows, angles=angles), options or DrawingOptions(), "it")


def test_lines_that_cross_or_end_on_each_other_are_split_and_keep_their_letters():
    found = made(*square(), ("M", 0, 0, 4, 4), ("V", 0, 4, 4, 0), ("U", 3, 3, 3, 4))
    assert Counter(found.letters) == {"B": 5, "M": 3, "V": 2, "U": 1}
    assert {(2.0, 2.0), (3.0, 3.0), (3.0, 4.0)} <= set(map(tuple, found.points.tolist()))
    assert len(found.points) == 7


def test_the_border_wins_then_cuts_then_folds_then_the_unassigned():
    rows = [("F", 0, 0, 4, 4), ("U", 0, 0, 4, 4), ("M", 0, 0, 4, 4), ("M", 4, 0, 0, 0)]
    found = made(*square(), *rows)
    assert Counter(found.letters) == {"B": 4, "M": 1}
    assert Counter(made(*square(), *rows[:2]).letters) == {"B": 4, "U": 1}
    assert Counter(made(*square(), *rows, ("C", 4, 4, 0, 0)).letters) == {"B": 4, "C": 1}


def test_a_mountain_on_a_valley_is_a_fault_with_its_place():
    found = made(*square(), ("M", 0, 0, 4, 4), ("V", 2, 2, 4, 4))
    assert Counter(found.letters) == {"B": 4, "M": 2, "V": 1}
    assert any("drawn twice" in note and "(3, 3)" in note for note in found.notes)
    turned = made(
        *square(), ("M", 0, 0, 4, 4), ("M", 0, 0, 4, 4), angles=[math.nan] * 4 + [-90, -45]
    )
    assert any("drawn twice" in note for note in turned.notes)


def test_a_line_that_another_covers_in_part_is_one_line_again():
    whole = made(*square(), ("M", 0, 0, 4, 4), ("M", 1, 1, 2, 2))
    assert len(whole.letters) == 5
    # two lines: what the drawing states stays
    corner = made(*square(), ("M", 0, 0, 2, 2), ("M", 2, 2, 4, 4))
    assert len(corner.letters) == 6


@pytest.mark.parametrize("rung", RUNGS)
def test_the_smallest_tolerance_at_which_the_drawing_is_whole_is_taken(rung):
    off = 0.7 * rung * 4
    found = made(*square(), ("M", 0, 0, 4 - off, 4 - off), ("V", 0, 4, 2, 2 + off / 9))
    assert found.tolerance == rung
    assert len(found.points) == 5
    assert found.error <= rung * 4


def test_a_chain_of_short_lines_does_not_shrink_to_a_point():
    quarter = np.linspace(0, math.pi / 2, 2000)
    arc = [(4 - 4 * math.cos(t), 4 * math.sin(t)) for t in quarter]
    arc[-1] = (3.992, 3.992)  # within the largest tolerance of the corner
    rows = [("M", *a, *b) for a, b in itertools.pairwise(arc)]
    found = made(*square(), *rows)
    assert found.tolerance < 1e-3
    assert len(found.points) >= 2000
    assert any(note.startswith("1 ends hang loose: at (3.992, 3.992)") for note in found.notes)


def test_a_tolerance_asked_for_is_taken():
    rows = [*square(), ("M", 0, 0, 3.9, 3.9)]
    assert len(made(*rows, options=DrawingOptions(tolerance=0.05)).points) == 4
    assert len(made(*rows).points) == 5
    with pytest.raises(o.OrigamiError, match="shorter than the tolerance"):
        made(("M", 0, 0, 0.01, 0), ("M", 5, 5, 5, 5.01), options=DrawingOptions(tolerance=0.1))


def test_strays_and_several_sheets_are_named_and_a_part_is_taken():
    rows = [*square(), ("M", 0, 0, 4, 4), *square(2, at=(6, 0))]
    rows += [("V", 6, 0, 8, 2), ("M", 10, 10, 11, 11)]
    both = made(*rows)
    assert len(both.letters) == 10
    second = made(*rows, options=DrawingOptions(part=2))
    assert Counter(second.letters) == {"B": 4, "V": 1}
    with pytest.raises(o.OrigamiError, match="no part 3: it has 2"):
        made(*rows, options=DrawingOptions(part=3))


def test_an_outline_is_taken_where_no_border_is_drawn():
    found = made(*square(letter="U"), ("M", 0, 0, 4, 4))
    assert Counter(found.letters) == {"B": 4, "M": 1}


def test_coordinates_of_the_file_are_kept_to_the_last_digit():
    third = 1 / 3
    found = made(*square(third), ("M", 0, 0, third, third))
    assert set(found.points.ravel().tolist()) == {0.0, third}
    assert found.error == 0.0


@settings(max_examples=30)
@given(seed=st.integers(0, 10**6), noise=st.sampled_from([0.0, 1e-9, 1e-6]))
def test_random_lines_make_a_planar_graph(seed, noise):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 25))
    grid = rng.integers(0, 6, (n, 2, 2)).astype(float)
    ends = grid + noise * rng.uniform(-1, 1, grid.shape)
    ends = ends[np.abs(ends[:, 0] - ends[:, 1]).max(axis=1) > 0.5]
    if not len(ends):
        return
    letters = rng.choice(list("MVUF"), len(ends)).tolist()
    found = node(ends, letters, np.full(len(ends), np.nan), 1e-5 * 6)
    graph = planar(found.points, found.edges)
    pairs = {tuple(sorted(e)) for e in found.edges.tolist()}
    # Euler's formula, component by component
    assert len(found.points) - len(pairs) + graph.faces.sum() == len(graph.faces)
    # what is drawn is what is there: lengths of the union of all lines, by shapely
    from shapely import MultiLineString, unary_union

    drawn = unary_union(MultiLineString(list(np.round(ends)))).length
    kept = sum(np.linalg.norm(found.points[a] - found.points[b]) for a, b in pairs)
    assert kept == pytest.approx(drawn, rel=1e-4)


def test_a_line_that_states_no_angle_agrees_with_one_that_does():
    found = made(
        *square(), ("M", 0, 0, 4, 4), ("M", 0, 0, 4, 4), angles=[math.nan] * 4 + [math.nan, -90]
    )
    assert Counter(found.letters) == {"B": 4, "M": 1}
    assert found.angles[found.letters.index("M")] == -90


def test_ends_that_all_but_meet_are_one_point():
    """Both halves of a line in two colours, a thousandth apart or beyond a crossing: stubs would be creases."""
    found = made(
        *square(2000.0), ("M", 0, 1000, 2000, 1000), ("M", 1000, 0, 1000, 1000.001),
        ("V", 1000, 1000, 1000, 2000),
    )  # fmt: skip
    assert Counter(found.letters) == {"B": 8, "M": 3, "V": 1}
    assert len(found.points) == 9 and found.tolerance == 1e-6
