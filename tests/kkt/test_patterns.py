"""A pattern as a problem of the kernel: derivatives by differences, dependent rows, one answer with single vertices."""

import math
from collections import Counter
from itertools import product

import numpy as np
import pytest
import scipy as sp

import origami_nlp as o
from origami_nlp import State, classify
from origami_nlp.kkt import judge_branch, loop_modes, tangent_cone
from origami_nlp.kkt.descent_witness import follow_descent
from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem
from tests.computed_once import states, touching
from tests.patterns import miura, miura_angles, strip

COUNTS = {  # states as a separate judgement of patterns decided on them: minima, not decided
    "metasheet:3x3": (2, 0),
    "yoshimura:2x2": (2, 0),
}


@pytest.mark.parametrize("name", COUNTS)
def test_states_are_decided_as_by_a_judgement_of_patterns_alone(name):
    found = states(name)
    many = Counter(s.verdict for s in found.states)
    reported = many["minimum"], many["undecided"]
    assert reported == COUNTS[name]
    problem = PatternProblem(found.pattern)
    for state in found.states:  # in the numbering of the file, not that of the search
        again = classify(State(problem, state.phi))
        assert (again.verdict == "minimum") == (state.verdict == "minimum")
        assert (again.kind or "") == state.kind


def held_state():
    """A metasheet whose facets touch: its problem, the state, and its contacts."""
    found = touching()
    state = next(s for s in found.minima if s.contacts)
    problem = PatternProblem(found.pattern)
    return problem, State(problem, state.phi)


def test_derivatives_of_a_pattern_in_contact_are_those_of_its_values():
    """Along closed states: elsewhere a gap hangs on the walk by which one facet is seen from the other."""
    problem, state = held_state()
    rows = state.contacts.base
    assert any(not c.is_limit for c in rows)
    piece, d, h = state.on(rows), state.kernel[:, 0], 1e-3
    lam = piece.multipliers
    assert np.abs(state.gradient - piece.jacobian.T @ lam).max() < 1e-10
    ways = [problem.project(state.x + t * d)[0] for t in (h, 0.0, -h)]
    values = [problem.constraints(y, rows)[0] for y in ways]
    assert piece.jacobian @ d == pytest.approx((values[0] - values[2]) / (2 * h), abs=1e-5)
    lagrangian = [
        problem.energy_change(state.x, y) / problem.scale - lam @ v
        for y, v in zip(ways, values, strict=True)
    ]
    bent = (lagrangian[0] - 2 * lagrangian[1] + lagrangian[2]) / h**2
    assert d @ piece.hessian @ d == pytest.approx(bent, rel=1e-4)


def test_the_same_contact_has_one_multiplier_or_a_range():
    """Two equal contacts hold one degree of freedom: any sum of their forces balances; the smallest norm halves it."""
    _, state = held_state()
    what = classify(state)
    one, two = what.contacts
    assert what.kind == "degenerate" and one.multiplier == pytest.approx(two.multiplier, rel=1e-9)
    assert one.multiplier_range == pytest.approx((0.0, 2 * one.multiplier), abs=1e-9)


def test_lower_states_that_are_reached_through_facets_refute_nothing():
    """Downhill from a state that contact holds, as if it did not: there are such states, and facets cross in each."""
    problem, state = held_state()
    assert state.contacts.base and not state.contacts.complete
    free = judge_branch(state.on(()))
    assert free.verdict == "not stationary" and free.direction is not None
    assert follow_descent(state, free) is None
    through = State(PatternProblem(problem.pattern, contact=False), state.x)
    lower = follow_descent(through, judge_branch(through.on(())))
    assert lower is not None and lower.gain > 0 and problem.crossings.find(lower.state)
    assert problem.energy(lower.state) == pytest.approx(problem.energy(state.x) - lower.gain)


def test_rows_that_always_depend_on_each_other_are_no_loss_of_rank():
    pattern = miura(3, 4)
    problem = PatternProblem(pattern)
    folded, residual = problem.project(miura_angles(pattern, 4, 1.0))
    state, flat = State(problem, folded), State(problem, np.zeros(problem.size))
    assert residual < 1e-13
    assert problem.rank(folded) < problem.equation_count and state.regular
    assert state.kernel.shape[1] == 1 and not flat.regular


@pytest.mark.parametrize(("rows", "columns"), [(2, 4), (3, 3), (4, 3), (4, 4)])
def test_the_tangent_cone_is_what_all_choices_of_modes_leave(rows, columns):
    """Each choice by one null space of all vertices together; what lies in another is left out: by SciPy."""
    problem = PatternProblem(miura(rows, columns))
    loops = problem.loops(np.zeros(problem.size))
    cone = tangent_cone(loops, problem.size)
    spans = [
        sp.linalg.null_space(
            np.vstack(
                [
                    (np.eye(len(mode)) - mode @ mode.T) @ np.eye(problem.size)[loop.variables]
                    for loop, mode in zip(loops, choice, strict=True)
                ]
            ),
            1e-7,
        )
        for choice in product(*map(loop_modes, loops))
    ]
    projectors = [b @ b.T for b in sorted(spans, key=lambda b: -b.shape[1]) if b.shape[1]]
    expected = []
    for p in projectors:
        if not any(np.abs(q @ p - p).max() < 1e-6 for q in expected):
            expected.append(p)
    found = [b @ b.T for b in (*cone.lines[:, :, None], *cone.families)]
    assert len(found) == len(expected)
    assert all(min(np.abs(p - q).max() for q in found) < 1e-9 for p in expected)


@pytest.mark.parametrize("seed", range(3))
def test_closed_states_follow_the_lines_of_a_generic_pattern_to_second_order(seed):
    pattern = strip(seed)
    problem = PatternProblem(pattern)
    cone = tangent_cone(problem.loops(np.zeros(problem.size)), problem.size)
    assert cone.split and len(cone.lines) == 4 and not cone.families
    for line in cone.lines:
        near, far = (np.abs(problem.closure.values(h * line)).max() for h in (1e-3, 2e-3))
        assert near < 1e-8 and far == pytest.approx(8 * near, rel=0.1)  # it misses by h^3


def test_one_verb_classifies_both():
    scene = o.examples.degree6("pi/4", ratio=0.01)
    minimum = o.find_minima(scene, max_starts=16, escape=False).minima[0]
    assert o.classify(scene, minimum.phi).kind == minimum.kind
    pattern = o.examples.pattern("miura", 2, 2)
    with pytest.raises(o.OrigamiError, match="all 4 fold angles"):
        o.classify(pattern, [0.0])
    with pytest.raises(o.OrigamiError, match="do not close"):
        o.classify(pattern, [1.0, 1.0, 1.0, 1.0])
    assert o.classify(pattern, np.zeros(4)).verdict in ("minimum", "not stationary")


def test_a_state_of_a_large_pattern_that_is_not_stationary_is_refuted_along_its_steepest_descent():
    problem = PatternProblem(o.examples.pattern("miura", 20, 16))
    flat = classify(State(problem, np.zeros(problem.size)))
    # beside the flat state, on the way down: closed, folded, and balanced by nothing
    found = classify(State(problem, flat.lower))
    assert problem.sparse and found.verdict == "not stationary"
    assert problem.energy_change(flat.lower, found.lower) < 0 and not problem.refuses(found.lower)


def test_beside_a_folded_state_where_nothing_touches_yet():
    """Within rounding of contact there are no rows to choose between: not decided, by name."""
    problem, e = PatternProblem(as_pattern("degree6")), 9.4e-9
    phi, residual = problem.project(np.array([e - math.pi, -e, -e, e - math.pi, e, e]))
    what = classify(State(problem, phi))
    assert residual < 1e-15 and what.verdict == "undecided" and "not decided" in what.reason
