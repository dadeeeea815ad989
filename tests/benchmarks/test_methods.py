"""Every method of the benchmark does what it says: same problem, right derivatives, right minimum."""

import importlib.util
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from benchmarks import Judge, draw_starts, ipopt_alone, ours
from benchmarks.attempt import Method, keep_apart
from benchmarks.grids import judge_grid, run_grid
from benchmarks.hessians import compare_hessians, exact_eigenvalues
from benchmarks.methods_casadi import OTHERS, others, silence
from benchmarks.methods_closure import FORMS, closure_residual, closures, wedge_against_tied
from benchmarks.methods_scipy import scipy_methods
from benchmarks.nonlinear_program import Evaluator, problem
from benchmarks.problems import Problem, panel_problems, random_problems
from origami_nlp import examples
from origami_nlp.kkt import State
from origami_nlp.minima import hessian_spectra
from origami_nlp.problem import Model
from tests.computed_once import thinned

SIMPLE = examples.degree6("5*pi/12", 1.0)
METHODS = [*ours(), *ipopt_alone(), *others(), *scipy_methods()]


@pytest.fixture(scope="module")
def judge():
    return Judge.of(SIMPLE, 0)


@pytest.fixture(scope="module")
def starts(judge):
    return draw_starts(judge.model, 0, 8)[0]


@pytest.mark.slow
@pytest.mark.parametrize("method", thinned(METHODS, 2), ids=lambda m: m.label)
def test_each_method_finds_a_right_minimum_of_a_simple_scene(method: Method, judge, starts):
    if method.missing:
        pytest.skip(method.missing)
    solver = method.prepare(judge.model)
    right = 0
    for start in starts:
        with silence():
            answer = solver(start)
        if answer.claims:
            outcome = judge.judge(answer)
            right += outcome.minimum >= 0
            if outcome.minimum >= 0:
                # what is claimed keeps the constraints, and energy errs at second order or with a loaded contact
                assert np.abs(judge.model.closure(answer.x)[0]).max() <= 2e-6
    loose = method.accuracy >= 1e-4 and method.family in ("trust-constr", "SLSQP")
    assert right >= (0 if loose else 1), "no start reached a minimum"


@pytest.mark.parametrize("label", ["IPOPT alone", "IPOPT L-BFGS", "SLSQP"])
def test_smaller_tolerances_give_smaller_errors(label, judge, starts):
    if label == "SLSQP" and importlib.util.find_spec("scipy") is None:
        pytest.skip("scipy is not installed")
    errors = []
    family = sorted((m for m in METHODS if m.family == label), key=lambda m: -m.accuracy)
    for method in (family[0], family[-1]):
        solver = method.prepare(judge.model)
        answers = [a for s in starts if (a := solver(s)).claims]
        of = [o.angle for a in answers if (o := judge.judge(a)).minimum >= 0]
        errors.append(np.median(of))
    assert errors[1] < 1e-3 * errors[0]


def test_ours_claims_only_classified_minima_to_rounding(judge, starts):
    solver = ours()[0].prepare(judge.model)
    answers = [solver(s) for s in starts]
    claimed = [judge.judge(a) for a in answers if a.claims]
    assert claimed and all(o.minimum >= 0 and o.angle < 1e-13 for o in claimed)
    assert all(o.eigenvalue < 1e-12 for o in claimed if np.isfinite(o.eigenvalue))


@pytest.mark.parametrize("index", [3, 4, 17])
def test_rivals_get_the_programme_of_the_package(index):
    model = Model(panel_problems()[index].scene)
    built = problem(model.structure, model.structure.pairs)
    x = draw_starts(model, 1, 1)[0][0].x
    z = built.begin(model, x)
    f, g = built.oracle(z, model.parameters.vector)
    assert float(f) * model.scale == pytest.approx(model.energy(x), rel=1e-12)
    assert np.asarray(g).ravel()[: model.equation_count] == pytest.approx(model.closure(x)[0])
    assert len(built.lower) == g.shape[0] and sum(built.equality) == model.equation_count + len(
        built.pairs
    )


@pytest.mark.parametrize("index", [4, 17])
def test_gradients_and_hessians_of_rivals_agree_with_differences(index):
    model = Model(panel_problems()[index].scene)
    built = problem(model.structure, model.structure.pairs)
    evaluate = Evaluator(built.oracle, model.parameters.vector)
    rng = np.random.default_rng(index)
    z = built.begin(model, draw_starts(model, 1, 1)[0][0].x) + 0.01 * rng.standard_normal(
        model.size + 3 * len(built.pairs)
    )
    v, h = rng.standard_normal(len(built.lower)), 1e-6

    def lagrangian_slope(y):
        at = evaluate.at(y)
        return (0.7 * at.gradient + v @ at.jacobian).copy()

    jacobian, gradient = evaluate.at(z).jacobian.copy(), evaluate.gradient.copy()
    hessian = evaluate.curvature(z, 0.7, v)
    for k in range(len(z)):
        step = h * np.eye(len(z))[k]
        up = evaluate.at(z + step)
        f_up, g_up = up.f[0], up.g.copy()
        down = evaluate.at(z - step)
        assert (f_up - down.f[0]) / (2 * h) == pytest.approx(gradient[k], abs=1e-7)
        assert (g_up - down.g) / (2 * h) == pytest.approx(jacobian[:, k], abs=1e-7)
        change = (lagrangian_slope(z + step) - lagrangian_slope(z - step)) / (2 * h)
        assert change == pytest.approx(hessian[:, k], abs=1e-7)


def test_an_evaluator_asked_for_curvature_elsewhere_does_not_keep_stale_values():
    model = Model(SIMPLE)
    built = problem(model.structure, ())
    evaluate = Evaluator(built.oracle, model.parameters.vector)
    a, b = np.full(model.size, 0.3), np.full(model.size, -0.8)
    wanted = evaluate.at(a).g.copy()
    evaluate.curvature(b, 1.0, np.ones(len(built.lower)))
    assert (evaluate.at(a).g == wanted).all()


def test_facets_that_cross_get_a_plane_from_any_solver():
    scene = examples.degree6("pi/3", 1.0)
    model = Model(scene)
    method = next(m for m in METHODS if m.name == "IPOPT alone" and m.accuracy == 1e-8)
    solver = method.prepare(model)
    for start in draw_starts(model, 0, 6)[0]:
        answer = solver(replace(start, pairs=()))
        if answer.claims:
            assert not model.crossed(answer.x, 1e-5)
    calls = []

    def once(x, pairs):
        calls.append(pairs)
        return solver(replace(start, x=x, pairs=pairs))

    keep_apart(model, start.x, (), once)
    assert calls[0] == ()


@pytest.mark.parametrize("form", FORMS)
def test_every_form_of_closure_vanishes_exactly_where_the_loop_closes(form):
    problem = random_problems(0)[1]
    model = Model(replace(problem.scene, contact="fold-limits"))
    x = ca.SX.sym("x", model.size)
    residual = ca.Function("g", [x], [closure_residual(form, model, x)])
    rng = np.random.default_rng(0)
    for start in draw_starts(model, 3, 5)[0]:
        closed = np.abs(model.closure(start.x)[0]).max() < 1e-12
        value = float(np.abs(np.asarray(residual(start.x))).max())
        assert (value < 1e-11) == closed or not closed
        away = start.x + 0.3 * rng.standard_normal(model.size)
        assert float(np.abs(np.asarray(residual(away))).max()) > 1e-4


@pytest.fixture(scope="module")
def judge_without_symmetry():
    return Judge.of(replace(SIMPLE, symmetry="none", contact="fold-limits"), 0)


@pytest.mark.parametrize(
    "method",
    [m for m in closures() if "entries" not in m.label and "raw" not in m.label],
    ids=lambda m: m.label,
)
def test_forms_of_closure_reach_the_same_minima(method, judge_without_symmetry):
    judge = judge_without_symmetry
    solver = method.prepare(judge.model)
    with silence():
        answers = [solver(s) for s in draw_starts(judge.model, 0, 6)[0]]
    assert any(judge.judge(a).minimum >= 0 for a in answers if a.claims)


def test_the_wedge_reaches_minima_and_nine_entries_are_too_many_equations():
    scene = replace(SIMPLE, contact="fold-limits")
    judge = Judge.of(scene, 0)
    start = draw_starts(judge.model, 0, 1)[0][0]
    assert judge.judge(wedge_against_tied()[0].prepare(judge.model)(start)).minimum >= 0
    full = Model(replace(scene, symmetry="none"))
    entries = next(m for m in closures() if "entries" in m.label)
    with silence():
        assert not entries.prepare(full)(draw_starts(full, 0, 1)[0][0]).claims


def test_grid_minima_near_exact_ones_count_once():
    problem = panel_problems()[17]
    judge = Judge.of(problem.scene, 0)
    found = run_grid(problem, judge, 65, 1)
    assert (
        found is not None
        and found["reported"] == len(found["found"]) + found["duplicates"] + found["false"]
    )
    assert found["missed"] == len(judge.known) - len(found["found"])
    exact = [judge.model.expand(k.x) for k in judge.known]
    distance = lambda model, x, y: float(np.abs(x - y).max())  # noqa: E731
    perfect = judge_grid(judge, exact, 0.1, distance)
    assert perfect["missed"] == perfect["false"] == perfect["duplicates"] == 0
    assert perfect["error"][-1] < 1e-12
    twice = judge_grid(judge, [*exact, exact[0], np.zeros(8)], 0.1, distance)
    assert twice["duplicates"] == 1 and twice["false"] == 1


def test_exact_eigenvalues_agree_with_the_package_and_beat_appendix_a():
    problem = Problem("p", "panel", SIMPLE)
    judge = Judge.of(SIMPLE, 0)
    states = [judge.model.expand(k.x) for k in judge.known if k.kind == "interior"]
    records = compare_hessians([problem], [states], 1)
    assert records
    full = Model(replace(SIMPLE, symmetry="none", contact="none"))
    for record, phi in zip(records, states, strict=True):
        wanted = hessian_spectra(State(full, phi), SIMPLE)[0]
        assert exact_eigenvalues(full, phi) == pytest.approx(wanted, rel=1e-12, abs=1e-15)
        assert record["error_exact"] < 1e-13
        assert all(1e-13 < e < 1e-3 for e in record["error_appendix"].values())


def test_other_solvers_have_options_and_methods_are_named_once():
    labels = [m.label for m in METHODS]
    assert len(set(labels)) == len(labels)
    assert {m.name for m in others()} == set(OTHERS)


def test_scipy_missing_is_said_and_not_an_error(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert all("pip install scipy" in m.missing for m in scipy_methods())
