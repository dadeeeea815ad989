"""IPOPT on the same problem: it finds what descents find, its multipliers are ours, and it comes back to minima."""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State, polish
from origami_nlp.search import confirm, solve_with
from origami_nlp.search.ipopt import BESIDE_OPTIONS, rows_near
from tests.search.test_fixed_points import PINNED


@pytest.mark.parametrize("origami", ["miura:2x2", o.examples.degree6("pi/4", ratio=1.0)])
def test_both_engines_list_the_same_minima(origami):
    asked = {"escape": False, "prove": False, "effort": "quick"}
    ours, theirs = (o.find_minima(origami, method=m, **asked).minima for m in ("batch", "ipopt"))
    assert len(ours) == len(theirs)
    for a, b in zip(ours, theirs, strict=True):
        assert np.abs(np.subtract(a.fold_angles, b.fold_angles)).max() < 1e-6


EXACT = {
    **BESIDE_OPTIONS,
    "tol": 1e-12,
    "compl_inf_tol": 1e-13,
    "dual_inf_tol": 1e-11,
    "constr_viol_tol": 1e-12,
    "max_iter": 300,
}
"""IPOPT as exact as it gets: what its barrier leaves of multipliers is below 1e-8 of them."""


@pytest.mark.parametrize("scene", PINNED, ids=lambda s: s.label)
def test_multipliers_are_ours_where_they_are_unique(scene):
    problem, compared = o.pose(scene), 0
    for m in o.find_minima(scene, escape=False, prove=False).minima:
        x = problem.reduce(np.array(m.fold_angles))
        ended, pressed, forces = solve_with(problem, x, rows_near(problem, x), EXACT)
        polished = polish(problem, ended, pressed)
        if not (ended.succeeded and polished.rows) or np.abs(polished.x - x).max() > 1e-6:
            continue
        held = State(problem, polished.x).on(polished.rows)
        found = held.multiplier_set
        if found.upper.max() - found.lower.max() > 1e-9:
            continue  # not unique
        by = dict(zip(pressed, forces.tolist(), strict=True))
        for contact, force in zip(polished.rows, held.forces.tolist(), strict=True):
            if contact in by and force > 1e-3:
                assert by[contact] == pytest.approx(force, rel=1e-8)
                compared += 1
    assert compared


@pytest.mark.parametrize("origami", ["metasheet:2x3", o.examples.degree8("pi/6", 1.0)])
def test_confirmations_start_beside_minima_and_come_back(origami):
    problem = o.pose(origami)
    for m in o.find_minima(origami, escape=False, prove=False).minima:
        said = confirm(problem, problem.reduce(np.array(m.fold_angles)))
        assert said.came_back == "same" and said.agrees and said.iterations > 1


def test_a_solve_answers_from_any_start_and_an_unknown_method_is_refused():
    problem = o.pose("waterbomb:1x1")
    answer = o.solve(problem, np.full(problem.size, 0.3))
    assert answer.succeeded and answer.solves >= 1 and answer.violation < 1e-6
    with pytest.raises(OptionError, match="method"):
        o.find_minima("miura:2x2", method="newton")
