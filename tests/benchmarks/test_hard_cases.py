"""The hard cases come out as they must, and failures are seen."""

import math

import numpy as np
import pytest

from benchmarks.hard import CASES, Outcome, hard_table, regular_at_pi, run_case
from origami_nlp import Scene, Vertex, find_minima
from origami_nlp.kkt import polish
from origami_nlp.pattern_problem import pose
from origami_nlp.search import solve_with
from tests.computed_once import thinned

QUICK = ("flat state as a start", "weakly active contact")


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in QUICK else pytest.mark.slow) for n in CASES]
)
def test_hard_cases_come_out_as_they_must(name):
    outcomes = run_case(CASES[name])
    assert len(outcomes) >= 3 and not [o for o in outcomes if not o.passed]


def test_failures_are_seen_and_exceptions_do_not_end_the_run():
    def stream():
        yield Outcome("good", {"angles": (1e-16, 1e-14)}, "interior")
        yield Outcome("off", {"angles": (1e-3, 1e-14)}, "interior")
        yield Outcome("not a number", {"angles": (math.nan, 1e-14)}, "interior")
        yield Outcome("wrong", {}, "saddle", False)
        raise ZeroDivisionError("closure")

    outcomes = run_case(stream)
    assert [o.passed for o in outcomes] == [True, False, False, False, False]
    assert sum(row[1] == "fails" for row in hard_table({"made up": outcomes}).rows) == 4


@pytest.mark.parametrize("distance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_regular_state_just_off_the_fold_limit_does_not_snap_to_it(distance, sign):
    scene, x = regular_at_pi(sign * (math.pi - distance))
    problem = pose(scene)
    state = polish(problem, *solve_with(problem, x + 0.01, ())[:2])
    assert state.converged and np.abs(state.x - x).max() <= 1e-14


@pytest.mark.parametrize(
    "sectors",
    thinned([(("pi/3", "2*pi/3") * 2,), (("pi/2",) * 4,), ((0.7, math.pi - 0.7) * 2,)], 3),
)
def test_degree_4_with_collinear_pairs_folds_on_its_two_lines(sectors):
    """Each pair of collinear creases folds alone: its least energy is that of one spring."""
    k, rest = np.array([1.0, 0.5, 2.0, 0.7]), np.array([1.0, -0.8, 0.4, -2.0])
    result = find_minima(
        Scene(Vertex(sectors), tuple(k), tuple(rest), "none"), prove=False, escape=False
    )
    found = np.array([m.fold_angles for m in result.minima])
    for pair in ([0, 2], [1, 3]):
        state = np.zeros(4)
        state[pair] = (k[pair] * rest[pair]).sum() / k[pair].sum()
        best = np.abs(found - state).max(axis=1)
        assert best.min() <= 1e-13
        assert (found[best.argmin()][state == 0] == 0).all() or best.min() <= 1e-15
        energy = result.minima[int(best.argmin())].energy
        assert energy == pytest.approx(float(0.5 * (k * (state - rest) ** 2).sum()), rel=1e-13)


@pytest.mark.parametrize("rest", [(math.pi, 0.0, math.pi, 0.0), (0.0, -math.pi, 0.0, -math.pi)])
def test_a_degree_4_vertex_at_rest_folded_on_one_line_stays_exactly_there(rest):
    scene = Scene(Vertex(("pi/3", "2*pi/3") * 2), (1.0, 2.0, 1.0, 3.0), rest, "none")
    best = find_minima(scene, max_starts=128, prove=False, escape=False).minima[0]
    assert best.fold_angles == rest and best.energy == 0.0
