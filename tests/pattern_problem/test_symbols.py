"""CasADi's closure and gaps against those that are compiled, and IPOPT on rows projected where it begins."""

import casadi as ca
import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.kkt import classify
from origami_nlp.pattern_problem import PatternProblem, pose

PROBLEMS = {
    "degree 6, D1": lambda: pose(o.examples.degree6("pi/3", ratio=1)),
    "degree 8, D2": lambda: pose(o.examples.degree8("pi/4", ratio=0.1)),
    "sheet": lambda: PatternProblem(o.examples.pattern("miura", 2, 3)),
    "cell": lambda: PatternProblem(o.examples.pattern("miura", 1, 1, cell=True)),
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


def touching():
    """Minima of vertices and a sheet at which facets touch: problem, state, contacts."""
    for made in (o.examples.degree6("pi/3", ratio=1), o.examples.degree8("pi/6", ratio=1.0)):
        found = o.find_minima(made, prove=False, escape=False, full=False)
        for m in found.minima:
            state = found.state_of(m)
            gaps = [c.contact for c in classify(state).contacts if not c.is_limit]
            yield found.model, state, gaps


def test_gaps_are_those_that_are_compiled():
    seen = 0
    for problem, state, gaps in touching():
        symbols = problem.symbols()
        p = ca.vertcat(symbols.springs, ca.vec(symbols.corners))
        for contact in gaps:
            gap = symbols.gap(contact)
            function = ca.Function("g", [symbols.y, p], [gap, ca.jacobian(gap, symbols.y)])
            value, slope = (np.array(v) for v in function(state.x, symbols.values))
            ours, along = state.local.openings([contact]), state.kernel / problem.root[:, None]
            assert float(value[0, 0]) == pytest.approx(ours[0][0], abs=1e-12)
            assert slope @ along == pytest.approx(ours[1] @ along, abs=1e-9)
            seen += 1
    assert seen


def test_ipopt_comes_back_from_beside_minima():
    back, total = 0, 0
    for problem, state, gaps in touching():
        if not state.regular or classify(state).kind == "degenerate":
            continue  # a singular state has no multipliers that IPOPT could find
        y0, total = state.x + 1e-3 * np.cos(np.arange(problem.size)), total + 1
        y0, _ = problem.project(problem.fold_limits.clip(y0))
        symbols = problem.symbols()
        nlp = symbols.nlp(y0, gaps)
        quiet = {
            "print_time": False,
            "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-10},
        }
        form = {"x": nlp.x, "p": nlp.p, "f": nlp.f, "g": nlp.g}
        solver = ca.nlpsol("origami", "ipopt", form, quiet)
        out = solver(
            x0=y0, p=symbols.values, lbg=nlp.lower, ubg=nlp.upper,
            lbx=problem.fold_limits.low, ubx=problem.fold_limits.high,
        )  # fmt: skip
        assert solver.stats()["return_status"] == "Solve_Succeeded"
        back += np.abs(np.array(out["x"]).ravel() - state.x).max() < 1e-5
    assert total >= 3 and back == total
