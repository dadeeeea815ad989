"""Ends of descents that are no states, states that break linear algebra, guesses: counted, named, listed or refused."""

import math
from functools import cache

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, find_minima
from origami_nlp.kkt import Solve, polish
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern_problem import pose
from origami_nlp.pattern_states import judge, judgement
from tests.independent.closing import EXTENDED
from tests.independent.sheet import product_of_folds

pi = math.pi
UNCLOSED = Scene(
    Vertex(
        (
            0.8142142111813313,
            1.0478755567448639,
            0.9629193894529143,
            1.9763209304502327,
            1.4818552193502434,
        )
    ),
    (
        0.5537553838526724,
        4.653653695452453,
        0.4983622717405983,
        2.308384257937016,
        0.28622076589651524,
    ),
    (
        -2.380638554359822,
        0.9805949174120303,
        -0.8157361711586915,
        -0.7900370113940043,
        -1.1207956599647688,
    ),
    "none",
    "fold-limits",
)
"""A descent ended 1e-2 off closure."""


def random_scene(number, contact="full"):
    """Degree 5, 6, 7 in turn."""
    rng, n = np.random.default_rng([28, number]), (5, 6, 7)[number % 3]
    while True:
        sectors = rng.dirichlet(3 * np.ones(n)) * 2 * pi
        if sectors.max() < pi * 0.95 and sectors.min() > 0.15:
            break
    k = np.exp(rng.uniform(np.log(0.2), np.log(5), n))
    return Scene(Vertex(tuple(sectors)), k, rng.uniform(-pi, pi, n), "none", contact)


def holds(result, angles):
    return any(np.abs(np.subtract(m.fold_angles, angles)).max() < 1e-6 for m in result.minima)


@cache
def unclosed():
    return find_minima(UNCLOSED, escape=False)


def test_the_polish_sees_a_fold_limit_that_newton_went_beyond():
    """It set the fold angle back to the limit, 4 degrees, and called what did not close any more converged."""
    model = pose(UNCLOSED)
    end = np.radians([57.50944478, -68.70722067, -135.17040217, -3.83283704, -180.0])
    for guess in (None, ()):
        state = polish(model, Solve(end, "", 0, math.nan, np.zeros(5)), guess)
        closure = np.abs(model.closure(state.x)[0]).max()
        assert closure == pytest.approx(state.closure_residual, abs=1e-15)
        assert not state.converged or closure <= CLOSURE_TOL


def test_an_end_that_does_not_close_spoils_no_proof():
    result = unclosed()
    assert result.completeness.proved
    assert len(result.minima) == 4
    assert not result.search.undecided


@pytest.mark.skipif(not EXTENDED, reason="no extended precision on this machine")
def test_whatever_a_search_names_closes_by_a_product_of_its_own():
    for scene in (UNCLOSED, random_scene(1)):
        result = find_minima(scene, effort="quick", prove=False, escape=False)
        sectors = np.array(scene.vertex.sector_angles, dtype=np.longdouble)
        for state in (*result.minima, *result.search.undecided, *result.search.rejected):
            whole = product_of_folds(sectors, np.array(state.fold_angles, dtype=np.longdouble))
            assert float(np.abs(whole - np.eye(3)).max()) < 3 * CLOSURE_TOL


def test_a_state_that_does_not_close_has_no_certificate():
    problem, x = pose(UNCLOSED), unclosed().minima[0].phi
    state = judge(problem, x + 1e-2)
    assert (state.verdict, state.kind) == ("not admissible", "")
    assert judge(problem, x).verdict == "minimum"


def test_one_judgement_that_breaks_down_is_named_and_the_search_goes_on(monkeypatch):
    true, x = judgement.classified, unclosed().minima[2].phi

    def breaks(problem, phi):
        if np.abs(phi - x).max() < 1e-6:
            raise np.linalg.LinAlgError("Singular matrix")
        return true(problem, phi)

    monkeypatch.setattr(judgement, "classified", breaks)
    result = find_minima(UNCLOSED, prove=False, escape=False)
    assert len(result.minima) == 3
    assert result.search.failed["LinAlgError: Singular matrix"]


def test_other_guesses_are_refused_by_name():
    flat, off = np.zeros(7), np.full(7, 0.3)
    result = find_minima(
        random_scene(2), guesses=[flat, off], max_starts=8, prove=False, escape=False
    )
    reasons = {r.fold_angles: (r.verdict, r.certificate) for r in result.search.refused}
    assert reasons[tuple(flat)][0] == "not stationary"
    assert reasons[tuple(off)] == ("not admissible", "no state within 0.001 rad of it closes")
    even = Scene(Vertex(("pi/3",) * 6), (1,) * 6, (1,) * 6, "C2")
    (refused,) = find_minima(
        even, guesses=[np.arange(6) / 10], prove=False, escape=False
    ).search.refused
    assert refused.certificate == "it does not have the symmetry of the scene"


def given_back(number, seeds):
    """Minima of a scene by searches of other seeds, and those that a search does not list when it is given them."""
    scene = random_scene(number)
    union: list[np.ndarray] = []
    for seed in seeds:
        for m in find_minima(scene, seed=seed, prove=False, escape=False).minima:
            if not any(np.abs(np.subtract(m.fold_angles, x)).max() < 1e-6 for x in union):
                union.append(np.array(m.fold_angles))
    lost = []
    for x in union:
        result = find_minima(
            scene, guesses=[x], max_starts=8, effort="quick", prove=False, escape=False
        )
        assert not result.search.failed
        if not holds(result, x):
            lost.append((number, x, result.search.refused))
    return len(union), lost


def test_every_minimum_that_is_given_back_is_listed():
    count, lost = given_back(0, (1,))
    assert count
    assert not lost
