"""Curves through the flat state: half is followed, and mirrored; the same as followed in whole."""

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import list_branches
from origami_nlp.pattern_states.clearance import Clearance
from origami_nlp.pattern_states.curve import follow_curve, follow_from_flat, tangents
from origami_nlp.pattern_states.curves import LONG
from origami_nlp.pattern_states.interpolant import ON_CURVE, interpolate, wells
from tests.computed_once import thinned


def distance(curve, x):
    """How far a state is from a curve, by all of its polynomials."""
    return min(curve.nearest(step, x)[1] for step in range(len(curve.control)))


@pytest.mark.parametrize(
    "name", thinned(["miura:2x2", "miura:2x3", "metasheet:3x3", "squaretwist"], 4)
)
def test_half_of_a_curve_says_what_the_whole_does(name):
    problem, asked = PatternProblem(as_pattern(name)), 0
    clearance = Clearance(problem)
    for d in list_branches(problem).lines[:4]:
        phi, residual = problem.project(0.2 * d / np.abs(d).max())
        z = tangents(problem, phi)
        if residual > 1e-12 or z.shape[1] != 1:
            continue
        half = follow_from_flat(problem, phi, LONG)
        curve = interpolate(problem, half)
        whole = interpolate(problem, follow_curve(problem, phi, z[:, 0], LONG))
        assert curve.odd
        assert not whole.odd
        assert curve.ends == whole.ends == ("limit", "limit")
        assert (curve.states == -curve.states[::-1]).all()
        assert max(problem.residual(x) for x in curve.states) < 1e-12
        assert max(distance(whole, x) for x in curve.states) < ON_CURVE
        assert max(distance(curve, x) for x in whole.states) < ON_CURVE
        one, other = (np.array(wells(problem, c)) for c in (curve, whole))
        assert len(one) == len(other)
        assert np.abs(one[:, None] - other).max(axis=2).min(axis=1).max() < ON_CURVE
        seen, asked_of = clearance.along(curve), clearance.along(whole)
        assert (seen.states == -seen.states[::-1]).all()
        assert [bool(problem.crossings.find(x)) for x in seen.states] == seen.crosses.tolist()
        assert seen.crosses.any() == asked_of.crosses.any()
        asked += 1
    assert asked


def test_far_from_flat_or_with_limits_on_one_side_curves_are_followed_in_whole():
    pattern = as_pattern("miura:2x2")
    problem = PatternProblem(pattern)
    (d, *_) = list_branches(PatternProblem(pattern)).lines
    phi, _ = problem.project(0.2 * d / np.abs(d).max())
    assert follow_from_flat(problem, phi, LONG) is not None
    far, _ = problem.project(1.5 * d / np.abs(d).max())
    assert follow_from_flat(problem, far, LONG) is None
    limits = [(-2.0, math.pi), *[(-math.pi, math.pi)] * (pattern.creases - 1)]
    limited = PatternProblem(pattern.with_limits(limits))
    assert follow_from_flat(limited, phi, LONG) is None


@pytest.mark.parametrize("name", thinned(["miura:2x2", "miura:2x3", "squaretwist"], 3))
def test_barriers_over_the_flat_state_are_those_of_walks_that_share_no_code(name):
    """By own closure and the Flexible Collision Library, from each minimum to both ends of its curve."""
    pytest.importorskip("fcl", reason="python-fcl, of the extra test")
    from tests.independent.rigid import Rigid

    found = o.find_minima(name, prove=False)
    rigid, asked = Rigid(found.pattern), 0
    for m in found.minima:
        if m.kind != "interior" or m.dof != 1:
            continue
        ways = [_climb(rigid, m.phi, sense) for sense in (1.0, -1.0)]
        (flat,) = (x for x in ways if np.abs(x[-1]).max() < NEAR)
        (other,) = (x for x in ways if x is not flat)
        over_flat = found.pattern.energy(np.array([*flat, 0 * m.phi])).max() - m.energy
        assert found.pattern.energy(np.array(other)).max() - m.energy > over_flat
        assert m.escape.barrier == pytest.approx(over_flat, rel=1e-9)
        asked += 1
    assert asked > 1


NEAR = 0.05
"""So near the flat state a sheet is a graph over its plane: facets do not cross."""


def _climb(rigid, x, sense, step=0.05):
    """Closed states along the one free direction: to the flat state, a limit, where facets collide or a chord fails."""
    out, before = [x], None
    while np.abs(out[-1]).max() >= NEAR:
        slopes = rigid.differences(out[-1])
        d = np.linalg.svd(slopes)[2][-1]
        d = sense * d if before is None else d * np.sign(d @ before)
        new = rigid.closed(out[-1] + step * d, np.linalg.pinv(slopes, rcond=1e-6))
        if new is None or np.abs(new).max() > math.pi or rigid.collide(new):
            assert np.abs(out[-1]).max() > 2.5  # nearly folded
            break
        out.append(new)
        before = d
    return out
