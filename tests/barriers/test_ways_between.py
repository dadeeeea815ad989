"""Paths between stable states of patterns that no descent joins: straight, as strings, over saddles."""

import functools
import math
import time

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.barriers import Known
from origami_nlp.barriers.walks import Walks
from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search import DescentTerrain
from tests.barriers.test_patterns import checked
from tests.independent.search_sheets import sheet_of


@functools.cache
def of_a_waterbomb():
    """Four states, of which no two are joined by descents."""
    stiffness, rest = [3.7, 0.47, 1.91, 0.99, 8.33, 0.17], [-0.3, -2.6, -1.9, 0.1, 0.2, -1.0]
    pattern = as_pattern("waterbomb:1x1").with_springs(stiffness, rest)
    return o.find_barriers(pattern, o.find_minima(pattern, escape=False))


@pytest.mark.slow  # a second look at what other tests of the room say
def test_all_states_are_joined():
    found = of_a_waterbomb()
    checked(found)
    assert len(found.result.minima) == 4 and not found.left_out
    assert all(math.isfinite(p.energy) for p in found.passes)
    for p in found.passes:
        ends = [found.result.minima[k - 1].energy for k in (p.from_state, p.to_state)]
        assert p.energy >= max(ends)
    high = [p for p in found.passes if p.known is Known.BOUND and p.pass_kind == "saddle"]
    assert len(high) == 4 and max(p.residual for p in high) < 1e-9
    assert "an upper bound" in str(found)


@pytest.mark.slow  # a second look at what other tests of the room say
def test_paths_are_looked_at_closely_where_they_are_highest():
    found = of_a_waterbomb()
    problem = PatternProblem(found.result.pattern)
    minima = np.array([m.phi for m in found.result.minima])
    terrain = DescentTerrain(problem, minima)
    path, _ = terrain.walk_to(minima[3], np.zeros(problem.size))
    fine = terrain.with_tops(path)
    top = int(problem.energies(fine).argmax())
    assert 0 < top < len(fine) - 1
    assert problem.energies(fine).max() >= problem.energies(path).max()
    assert np.abs(np.diff(fine[top - 1 : top + 2], axis=0)).max() < 2e-3
    assert {x.tobytes() for x in path} <= {x.tobytes() for x in fine}


@pytest.mark.slow  # a second look at what other tests of the room say
def test_the_limit_of_time_is_kept():
    seconds, result = 0.3, of_a_waterbomb().result
    begin = time.monotonic()
    o.find_barriers(result.pattern, result, seconds=seconds)
    assert time.monotonic() - begin < seconds + 1.0


def test_sheets_folded_onto_themselves_are_unfolded_in_stages():
    """Three creases in a row at 180 degrees: no straight way leads to the flat state, one over flat rows does."""
    pattern = as_pattern("miura:3x3")
    problem, sheet = PatternProblem(pattern), sheet_of(pattern)
    body = pytest.importorskip("tests.independent.rigid").Rigid(pattern)
    degrees = [24.19, 180, 0, 180, 180, -24.19, -12.23, 0, 12.23, 12.23, -24.19, 0]
    row, flat = np.array(degrees) == 180, np.zeros(problem.size)
    state, residual = problem.project(np.radians(degrees), row)
    assert residual < 1e-12 and np.abs(np.degrees(state) - degrees).max() < 0.01
    terrain = DescentTerrain(problem, state[None])
    assert not terrain.walk_to(state, flat)[1]
    ((start, to, path),) = Walks(terrain, [flat], [], []).ways()
    assert (start, to) == (-1, 0) and not path[0].any() and (path[-1] == state).all()
    assert np.abs(np.diff(path, axis=0)).max() < 0.5
    assert np.abs(sheet.closure(path)[0]).max() < 1e-9
    assert np.abs(path).max() <= math.pi + 1e-12 and not any(body.deep(x) for x in path)
