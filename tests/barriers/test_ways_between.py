"""Paths between stable states of patterns that no descent joins: straight, as strings, over saddles."""

import math

import numpy as np
import pytest

from origami_nlp.barriers.walks import Walks
from origami_nlp.escapes import Terrain
from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem
from tests.independent.search_sheets import sheet_of


def test_sheets_folded_onto_themselves_are_unfolded_in_stages():
    """Three creases in a row at 180 degrees: no straight way leads to the flat state, one over flat rows does."""
    pattern = as_pattern("miura:3x3")
    problem, sheet = PatternProblem(pattern), sheet_of(pattern)
    body = pytest.importorskip("tests.independent.rigid").Rigid(pattern)
    degrees = [24.19, 180, 0, 180, 180, -24.19, -12.23, 0, 12.23, 12.23, -24.19, 0]
    row, flat = np.array(degrees) == 180, np.zeros(problem.size)
    state, residual = problem.project(np.radians(degrees), row)
    assert residual < 1e-12 and np.abs(np.degrees(state) - degrees).max() < 0.01
    terrain = Terrain(problem, state[None])
    assert not terrain.walk_to(state, flat)[1]
    ((start, to, path),) = Walks(terrain, [flat], [], []).ways()
    assert (start, to) == (-1, 0) and not path[0].any() and (path[-1] == state).all()
    assert np.abs(np.diff(path, axis=0)).max() < 0.5
    assert np.abs(sheet.closure(path)[0]).max() < 1e-9
    assert np.abs(path).max() <= math.pi + 1e-12 and not any(body.deep(x) for x in path)
