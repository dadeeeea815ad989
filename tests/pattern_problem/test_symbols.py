"""CasADi's closure and gaps against those that are compiled, and rows of closure projected where IPOPT begins."""

from functools import cache
from itertools import chain

import casadi as ca
import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.kkt import State, classify
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.search import solve_with
from tests.computed_once import panel_result, touching
from tests.patterns import miura

PROBLEMS = {
    "degree 6, D1": lambda: pose(o.examples.degree6("pi/3", ratio=1)),
    "degree 8, D2": lambda: pose(o.examples.degree8("pi/4", ratio=0.1)),
    "sheet": lambda: PatternProblem(o.examples.pattern("miura", 2, 3)),
    "cell": lambda: PatternProblem(o.examples.pattern("miura", 1, 1, cell=True)),
    "tube": lambda: pose(o.examples.pattern("yoshimura", 1, 1, cell=True, rolled=5)),
    "skew tube": lambda: pose(o.examples.pattern("metasheet", 1, 1, cell=True, rolled=[3, -4])),
    "hole": lambda: pose(miura(5, 5, without=((2, 2),))),
    "quads": lambda: PatternProblem(o.examples.pattern("metasheet", 2, 2)),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_closure_and_energy_with_their_derivatives(name):
    problem = PROBLEMS[name]()
    symbols, rng = problem.symbols(), np.random.default_rng(0)
    lam = ca.SX.sym("lam", symbols.closure.shape[0])
    p = ca.vertcat(symbols.springs, ca.vec(symbols.corners))
    bent = ca.hessian(ca.dot(lam, symbols.closure), symbols.y)[0]
    every = [symbols.closure, ca.jacobian(symbols.closure, symbols.y), bent, symbols.energy]
    function = ca.Function("f", [symbols.y, p, lam], every)
    for _ in range(20):
        y, mu = rng.uniform(-3, 3, problem.size), rng.normal(size=problem.closure.count)
        c, j, h, u = (np.array(v) for v in function(y, symbols.values, mu))
        value, slope = problem.closure(y)
        assert np.abs(c.ravel() - value).max() < 1e-13 and np.abs(j - slope).max() < 1e-13
        assert np.abs(h - problem.closure.hessian(y, mu)).max() < 1e-12
        assert problem.scale * float(u[0, 0]) == pytest.approx(problem.energy(y), rel=1e-12)


def minima(*some):
    """Minima of vertices or sheets: problem, state, and its contacts with what they carry."""
    for found in some:
        problem = found.model or pose(found.pattern)
        for m in found.minima:
            state = State(problem, problem.reduce(np.array(m.fold_angles)))
            yield problem, state, classify(state).contacts


@cache
def of_vertices():
    return list(minima(panel_result(o.examples.degree6("pi/3", ratio=1))))


@cache
def of_sheets():
    return list(minima(touching(), o.find_minima("miura:2x2", escape=False, effort="quick")))


def test_gaps_are_those_that_are_compiled():
    seen = 0
    for problem, state, contacts in chain(of_vertices(), of_sheets()):
        symbols = problem.symbols()
        p = ca.vertcat(symbols.springs, ca.vec(symbols.corners))
        for contact in (c.contact for c in contacts if not c.contact.is_limit):
            gap = symbols.gap(contact)
            function = ca.Function("g", [symbols.y, p], [gap, ca.jacobian(gap, symbols.y)])
            value, slope = (np.array(v) for v in function(state.x, symbols.values))
            ours, along = state.local.openings([contact]), state.kernel / problem.root[:, None]
            assert float(value[0, 0]) == pytest.approx(ours[0][0], abs=1e-12)
            assert slope @ along == pytest.approx(ours[1] @ along, abs=1e-9)
            seen += 1
    assert seen >= 3


def test_ipopt_leaves_what_is_no_minimum():
    pattern = o.examples.pattern("miura", 2, 3)
    problem = pose(pattern)
    phi, _ = problem.project(0.4 * pattern.signs)
    assert classify(State(problem, phi)).verdict == "not stationary"
    end, _, _ = solve_with(problem, phi, ())
    assert end.succeeded and problem.energy_change(phi, end.x) < -0.01


@pytest.mark.parametrize("pattern", [miura(4, 4), miura(5, 5, without=((2, 2),))])
def test_rows_of_closure_span_all_where_it_lies_flat_and_beside(pattern):
    problem = pose(pattern)
    flat = np.zeros(problem.size)
    nlp, values = problem.symbols().nlp(flat), problem.symbols().values
    slope = ca.Function("g", [nlp.x, nlp.p], [ca.jacobian(nlp.g, nlp.x)])
    for aside in (0.0, 0.1, 0.2):
        phi, _ = problem.project(flat + aside * np.sin(1.0 + np.arange(problem.size)))
        rows, j = np.array(slope(phi, values)), problem.jacobian(phi)
        assert problem.rank(phi) <= len(rows) < len(j)
        assert np.abs(j - j @ np.linalg.pinv(rows, 1e-10) @ rows).max() < 1e-9
    assert problem.rank(phi) == len(rows) > problem.rank(flat)
