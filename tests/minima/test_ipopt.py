"""A pattern as CasADi symbols, written from the folds alone, and what IPOPT says on them of minima that were found."""

import casadi as ca
import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.kkt import State, classify
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import judge
from tests.pattern_problem.symbols import confirm_minimum, independent_rows, pose
from tests.patterns import miura


@pytest.fixture(scope="module")
def metasheet():
    found = o.find_minima("metasheet:4x4", starts=2, escape=False)
    return PatternProblem(found.pattern), found.minima


def test_symbols_and_values_agree(metasheet):
    """Closure at any folds, gaps at closed ones; derivatives by CasADi; and closure of a sheet with a hole."""
    problem, minima = metasheet
    state = State(problem, next(s.phi for s in minima if s.contacts))
    touches = [problem.touch(c) for c in state.contacts.base if not c.is_limit]
    assert len(touches) >= 2
    every = np.arange(problem.equation_count)
    nlp = pose(problem, every, touches)
    both = ca.Function("g", [nlp.x], [nlp.g, ca.jacobian(nlp.g, nlp.x)])
    at = np.random.default_rng(0).uniform(-2, 2, problem.size)
    assert np.asarray(both(at)[0]).ravel()[: len(every)] == pytest.approx(
        problem.closure.values(at), abs=1e-13
    )
    rows = [problem.contact_of(t) for t in touches]
    values, slopes = problem.constraints(state.x, rows)
    value, slope = (np.asarray(v) for v in both(state.x))
    assert np.abs(value.ravel() - values).max() < 1e-13
    assert np.abs((slope - slopes) @ state.kernel).max() < 1e-11
    holed = PatternProblem(miura(5, 5, without=((2, 2),)))
    assert holed.pattern.holes
    nlp = pose(holed, np.arange(holed.equation_count))
    at = np.random.default_rng(1).uniform(-2, 2, holed.size)
    value = np.asarray(ca.Function("g", [nlp.x], [nlp.g])(at)).ravel()
    assert value == pytest.approx(holed.closure.values(at), abs=1e-13)


def test_ipopt_stays_at_minima_with_multipliers_that_balance(metasheet):
    problem, minima = metasheet
    for minimum in minima:
        solver, (ours, theirs), left = confirm_minimum(problem, minimum)
        assert solver.agrees and solver.moved < 1e-6
        assert left < 1e-6 and theirs.min(initial=0.0) > -1e-7
        assert ours.sum() == pytest.approx(
            theirs.sum(), abs=1e-6
        )  # of two alike contacts what both carry
    held = next(s for s in minima if s.contacts)
    assert classify(State(problem, held.phi)).kind == "degenerate"


def test_unique_multipliers_are_equal():
    found = o.find_minima("miura:2x3", starts=2, escape=False)
    problem, reported = PatternProblem(found.pattern), 0
    for minimum in found.minima:
        said = confirm_minimum(problem, minimum)
        if said is None:
            continue
        solver, (ours, theirs), left = said
        assert solver.agrees and left < 1e-6
        if all(c.unique for c in minimum.contacts):
            assert theirs == pytest.approx(ours, abs=1e-5)
            reported += 1
    assert reported


def test_ipopt_leaves_what_is_no_minimum():
    pattern = o.examples.pattern("miura", 2, 3)
    problem = PatternProblem(pattern)
    phi, residual = problem.project(0.4 * pattern.signs)
    assert residual < 1e-13
    state = judge(problem, phi)
    assert state.refuted
    assert not confirm_minimum(problem, state)[0].agrees


def test_independent_rows_span_all():
    pattern = miura(4, 4)
    problem = PatternProblem(pattern)
    phi, _ = problem.project(0.5 * pattern.signs)
    rows, j = independent_rows(problem, phi), problem.jacobian(phi)
    assert len(rows) == problem.rank(phi) < len(j)
    left = j - j @ np.linalg.pinv(j[rows]) @ j[rows]
    assert np.abs(left).max() < 1e-9
