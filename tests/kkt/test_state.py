"""A state and a stratum, of vertices and of patterns: derivatives against differences, and one state against many."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from origami_nlp import Scene, State, Vertex, classify, examples
from origami_nlp.kkt import newton, project
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.problem import Contact, Problem
from tests.computed_once import panel_result, thinned, touching
from tests.patterns import strip, wheel

SCENES = {
    "wedge": examples.degree6("pi/3", 1),
    "two mirrors": examples.degree8("pi/6", 1),
    "free": examples.degree6("pi/4", 100, symmetry="none"),
    "rotation": Scene(Vertex((math.pi / 3,) * 6), (1.0, 2.0) * 3, (0.4, -0.3) * 3, symmetry="C3"),
    "no contact": examples.degree6("pi/3", 1, contact="none"),
}
PROBLEMS = {name: lambda s=scene: pose(s) for name, scene in SCENES.items()}
PROBLEMS["pattern"] = lambda: PatternProblem(strip(3))


def some_state(problem: Problem) -> np.ndarray:
    x = np.random.default_rng(0).uniform(-1.5, 1.5, problem.size)
    y, residual = project(problem, x)
    assert residual < 1e-13
    return y


@pytest.mark.parametrize("name", PROBLEMS)
def test_derivatives_are_those_of_the_values(name: str) -> None:
    problem = PROBLEMS[name]()
    problem = problem.loaded(np.linspace(-0.2, 0.3, problem.size))
    x = some_state(problem)
    contacts = problem.limits[:2]
    rng = np.random.default_rng(1)
    weights = rng.normal(size=problem.equation_count + len(contacts))

    def lagrangian(y: np.ndarray) -> float:
        values = problem.constraints(y, contacts)[0]
        return problem.energy(y) / problem.scale - float(weights @ values)

    h = 1e-4
    _, jac = problem.constraints(x, contacts)
    slope = problem.local(x).gradient - jac.T @ weights
    hessian = problem.lagrangian_hessian(x, weights, contacts)
    for _ in range(4):
        d = rng.normal(size=problem.size)
        d /= np.linalg.norm(d)
        ahead, here, behind = (lagrangian(x + s * h * d) for s in (1, 0, -1))
        assert (ahead - behind) / (2 * h) == pytest.approx(slope @ d, abs=1e-6)
        assert (ahead - 2 * here + behind) / h**2 == pytest.approx(d @ hessian @ d, abs=1e-4)


def least_curvature(problem: Problem, x: np.ndarray, h: float = 1e-3) -> float:
    """Smallest eigenvalue of second differences of the energy along closed states."""
    z = State(problem, x).kernel

    def bend(d: np.ndarray) -> float:
        rises = [problem.energy_change(x, project(problem, x + s * h * d)[0]) for s in (1, -1)]
        return sum(rises) / h**2

    own = [bend(d) for d in z.T]
    sums = np.array([[bend(a + b) for b in z.T] for a in z.T])
    return float(np.linalg.eigvalsh((sums - np.add.outer(own, own)) / 2)[0])


SECTORS = 1.1, 1.3, 1.2, 1.4, math.tau - 5.0


@pytest.mark.parametrize("kind", ["vertex", "pattern"])
def test_saddles_are_told_from_minima(kind: str) -> None:
    """Closed states with springs that any multipliers of closure balance: what they are is left to curvature."""

    def problem(k: np.ndarray, rest: np.ndarray) -> Problem:
        if kind == "vertex":
            return pose(Scene(Vertex(SECTORS), tuple(k), tuple(rest), "none", "fold-limits"))
        return PatternProblem(wheel(SECTORS).with_springs(list(k), list(rest)), contact=False)

    rng, seen, free = np.random.default_rng(0), Counter(), problem(np.ones(5), np.zeros(5))
    while seen.total() < 40:
        x, residual = project(free, rng.uniform(-0.8, 0.8, 5))
        k, weights = 10 ** rng.uniform(-1.5, 0.5, 5), rng.normal(size=3)
        if residual > 1e-12:
            continue
        off = free.local(x).closure_jacobian.T @ weights / k
        rest = x - off * ((3.14 + np.sign(off) * x) / np.abs(off)).min()  # as far as springs go
        made = problem(k, rest)
        what, least = classify(State(made, x)), least_curvature(made, x)
        assert what.verdict == ("minimum" if least > 0 else "saddle"), (least, what.reason)
        if what.verdict == "minimum":
            assert min(what.eigenvalues) == pytest.approx(least, rel=1e-3, abs=1e-4)
        seen[what.verdict] += 1
    assert min(seen.values()) >= 3 and len(seen) == 2


PANELS_HELD = {
    "interior": examples.degree6("pi/4", 0.01),
    "creases on each other": examples.degree6("pi/3", 1),
    "axis": examples.degree8("pi/12", 100),
    "fold limit": examples.degree8("pi/12", 0.01),
}


def settled(name: str) -> tuple[Problem, np.ndarray, tuple[Contact, ...]]:
    """A minimum of a panel, or of a pattern, with its contacts."""
    if name in PANELS_HELD:
        result = panel_result(PANELS_HELD[name])
        wanted = "interior" if name == "interior" else "contact-pinned"
        problem = result.model
        x = problem.reduce(next(np.array(m.fold_angles) for m in result.minima if m.kind == wanted))
    else:
        found = touching()
        problem = PatternProblem(found.pattern)
        x = next(s.phi for s in found.minima if bool(s.contacts) == (name == "facets of a pattern"))
    rows = State(problem, x).pieces[0]
    assert bool(rows) == ("interior" not in name)
    return problem, x, rows


@pytest.mark.parametrize("name", thinned([*PANELS_HELD, "interior of a pattern"], 2))
def test_loads_move_states_and_forces_as_their_response_says(name: str) -> None:
    problem, x, rows = settled(name)
    response, motion = State(problem, x).on(rows).response()
    rng = np.random.default_rng(0)
    for _ in range(3):
        d, errors = rng.normal(size=problem.size), []
        for h in (2e-3, 1e-3):
            loads = [problem.loaded(problem.root * s * h * d) for s in (1, -1)]
            (one, push), (other, pull) = (newton(p, x, rows) for p in loads)
            assert one is not None and other is not None and one.converged and other.converged
            moved = problem.root * (one.x - other.x) / (2 * h)
            off = np.append((push - pull) / (2 * h) - response @ d, moved - motion @ d)
            errors.append(np.abs(off).max())
        assert errors[1] < 1e-4 * max(1.0, float(np.abs(motion @ d).max()))
        assert errors[1] < 0.3 * errors[0] + 1e-9  # second order


@pytest.mark.parametrize("name", ["creases on each other", "facets of a pattern"])
def test_newton_returns_to_a_state_in_contact(name: str) -> None:
    problem, x, rows = settled(name)
    start = x + 1e-4 * np.random.default_rng(0).normal(size=problem.size)
    back, multipliers = newton(problem, start, rows)
    assert back is not None and back.closure_residual < 1e-13
    assert np.abs(back.x - x).max() < 1e-9 and multipliers.min() > 0
