"""Bounds of barriers between signs against passes that strings of images find: no code of the package but its lists."""

import itertools
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import as_pattern
from tests.independent.elastic_bands import Facets, Springs, passes
from tests.independent.search_sheets import sheet_of

NAMES = (
    "yoshimura:2x2",
    "miura:2x3",
    "waterbomb:1x1",
    "squaretwist",
    "resch:1x1",
    "miura:3x3",
    "waterbomb:2x2",
)
LARGE = ("squaretwist", "miura:3x3", "waterbomb:2x2")


def compared(pattern, rng, most, starts=6, **asked):
    """For pairs with different signs, as many with a path as asked for: bounds, least height, package's own pass."""
    result = o.find_minima(pattern, starts=starts, escape=False)
    found = o.find_barriers(pattern, result)
    sheet, springs = sheet_of(pattern), Springs(pattern.stiffness, pattern.rest)
    facets = Facets(
        pattern.corners, [list(ring) for ring in pattern.polygons], pattern.ends.tolist()
    )
    pairs = [p for p in found.passes if math.isfinite(p.least)]
    rng.shuffle(pairs)
    rows = []
    for p in pairs[: most + 1]:
        ends = (result.minima[k - 1].phi for k in (p.from_state, p.to_state))
        heights = [
            springs.energy(x).max() for x in passes(sheet, facets, springs, *ends, rng, **asked)
        ]
        if heights:
            # folds of 1e-6 close to rounding where a vertex is flat
            slack = 1e-6 * float(springs.stiffness @ (math.pi + np.abs(springs.rest)))
            rows.append((p.least, p.listed, min(heights), p.energy, slack))
        if len(rows) == most:
            break
    return rows


def judged(rows):
    """No bound is above a pass; how many passes are as low as the bound in closed form, and over listed states."""
    exact = listed = 0
    for least, over_listed, height, _, slack in rows:
        assert least <= height + slack
        exact += height <= least + slack
        listed += height <= over_listed + slack
    return exact, listed


@pytest.mark.parametrize(
    "name", ["miura:2x3", pytest.param("yoshimura:2x2", marks=pytest.mark.slow)]
)
def test_no_bound_is_above_a_pass_of_a_string(name):
    rows = compared(as_pattern(name), np.random.default_rng(0), 1, 2, drawn=0, rounds=12)
    assert len(rows) == 1
    judged(rows)


def test_facets_that_cross_are_seen():
    """Two flaps that mirror each other: only their borders meet."""
    pattern = as_pattern("yoshimura:2x2")
    facets = Facets(pattern.corners, [list(p) for p in pattern.polygons], pattern.ends.tolist())
    flaps = np.zeros(pattern.creases)
    flaps[[0, 6]] = -0.5 * math.pi
    assert facets.crossed(np.array([flaps, 0.5 * flaps])).tolist() == [True, False]


@pytest.mark.slow
def test_no_bound_is_above_fifty_passes_of_strings():
    """Seven patterns, their own springs; and drawn ones of small patterns."""
    rng, rows = np.random.default_rng(33), []
    for turn, name in itertools.product(range(20), NAMES):
        if turn and name in LARGE:
            continue
        pattern = as_pattern(name)
        if turn:
            n = pattern.creases
            springs = (10 ** rng.uniform(-1, 1, n)).tolist(), rng.uniform(-3, 3, n).tolist()
            pattern = pattern.with_springs(*springs)
        rows += compared(pattern, rng, 3, 4, rounds=40)
        if len(rows) >= 50:
            break
    assert len(rows) >= 50
    exact, listed = judged(rows)
    assert exact >= 15 and listed >= exact
