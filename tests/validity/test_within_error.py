"""Flat-foldability is judged against what coordinates leave open: rounding is no fault, and excuses none."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from origami_nlp.drawings import ERROR_KEY
from origami_nlp.pattern import fold_vertices, parse_fold
from origami_nlp.validity import folds_flat
from tests.fold_files import disc

SECTORS = (70, 50, 110, 130)
"""Kawasaki holds; the smallest sector is smaller than both neighbours."""


def vertex(data):
    ((one,), _) = fold_vertices(parse_fold(json.dumps(data))[0])
    return one


@pytest.mark.parametrize("digits", [2, 3, 4])
@pytest.mark.parametrize(("letters", "flat"), [("MVMM", True), ("MVVV", False), ("VVMV", True)])
def test_rounded_coordinates_do_not_change_the_answer(digits, letters, flat):
    data = disc(SECTORS, letters, turn=17.3, length=[5.0, 4.0, 4.5, 5.5])
    exact = vertex(data)
    assert folds_flat(exact) is flat
    data["vertices_coords"] = np.round(data["vertices_coords"], digits).tolist()
    rounded = vertex(data)
    assert rounded.kawasaki is not None and 0 < rounded.kawasaki <= rounded.kawasaki_error
    assert folds_flat(rounded) is flat


@pytest.mark.parametrize("seed", range(20))
def test_what_is_off_by_the_error_is_explained_and_what_is_off_by_more_is_not(seed):
    rng = np.random.default_rng(seed)
    data = disc(SECTORS, "MVMM", length=rng.uniform(0.5, 2.0, 4))
    x = np.array(data["vertices_coords"])
    error = 10.0 ** rng.uniform(-5, -2.3)
    turn = rng.uniform(0, 2 * math.pi, len(x))
    data["vertices_coords"] = (x + error * np.stack([np.cos(turn), np.sin(turn)], axis=1)).tolist()
    assert vertex(data).kawasaki_error < 0.005  # whole doubles: the noise of any drawing
    data[ERROR_KEY] = error
    one = vertex(data)
    assert one.kawasaki <= one.kawasaki_error  # a bound, whichever way corners are off
    assert folds_flat(one) is True
    far = disc((72, 50, 110, 128), "MVMM")  # alternate sectors sum to 182 degrees
    far[ERROR_KEY] = 1e-4
    assert folds_flat(vertex(far)) is False


def test_sectors_that_the_error_does_not_tell_apart_leave_it_open():
    # the small sector may be the smaller of the two or not: with these letters one of them folds and one does not
    data = disc((60.0, 59.6, 120.3, 120.1), "VVMV")
    data[ERROR_KEY] = 0.01
    assert folds_flat(vertex(data)) in (None, True)
    data = disc((60.0, 40.0, 120.3, 139.7), "MVVV")
    data[ERROR_KEY] = 0.01
    assert folds_flat(vertex(data)) is False


def test_whole_numbers_on_a_small_grid_are_exact():
    data = disc((90, 90, 90, 90), "MVVV")
    data["vertices_coords"] = [[0, 0], [2, 1], [0, 2], [-2, 0], [0, -2]]
    one = vertex(data)
    assert one.kawasaki_error < 0.002
    assert folds_flat(one) is False
