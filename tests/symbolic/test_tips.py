"""Tip-to-tip states: the exact counterexample against finite motions, and the paper's own panels."""

import numpy as np
import pytest
from origami_nlp.symbolic.claims import section3_contact
from origami_nlp.symbolic.claims.section3_energy import crease_average
from origami_nlp.symbolic.tips import (
    descent,
    fold_angles,
    gap_gradient,
    tip_directions,
    tip_example,
)

from origami_nlp import Vertex, check_admissible
from origami_nlp.chart import fold_vertex
from origami_nlp.pattern_problem import pose_paper


def floats(values):
    return np.array([float(v) for v in values])


@pytest.fixture(scope="module")
def tip():
    """Vertex, fold angles, grad g and d of the exact state, in floating point."""
    state, c_1, c_2 = tip_example()
    a = 2 * np.arctan2(1, 3)
    b = np.pi / 2 - a
    directions = tip_directions(c_1, c_2)
    return (
        Vertex((a, b, b, a, a, b, b, a)),
        floats(fold_angles(state)),
        floats(gap_gradient(directions)[0]),
        floats(descent(c_1, c_2)),
    )


def closed(vertex, phi, average=None):
    """The nearest closed fold angles, by Gauss-Newton on the quaternion's vector part.

    average: projection on the symmetric fold angles, applied after each step.
    """
    for _ in range(8 if average is None else 40):
        creases, q = fold_vertex(vertex, phi)
        phi = phi - 2 * np.linalg.pinv(creases.T) @ q[1:]
        phi = phi if average is None else average @ phi
    return phi


def energy(phi, rest):
    return ((phi - rest) ** 2).sum() / 2


def test_finite_slides_stay_admissible_and_descend_at_the_stated_rate(tip):
    vertex, phi, gradient, d = tip
    rest = phi - gradient
    start = check_admissible(vertex, phi)
    assert start.admissible and not pose_paper(vertex).apart(phi)
    slopes = []
    for s in (1e-3, 5e-4, 2.5e-4):
        moved = closed(vertex, phi + s * d)
        seen = check_admissible(vertex, moved)
        assert seen.admissible, seen.reason
        assert pose_paper(vertex).apart(moved)
        slopes.append((energy(moved, rest) - energy(phi, rest)) / s)
    assert max(slopes) < 0
    limit = 2 * slopes[2] - slopes[1]  # Richardson: the slope at the state
    assert limit == pytest.approx(-35 / 74, rel=1e-3)


def test_pressing_without_sliding_crosses(tip):
    vertex, phi, *_ = tip
    _, c_1, _ = tip_example()
    contact_descent = floats([1, 0, -c_1[2], 0] * 2)
    assert not check_admissible(vertex, closed(vertex, phi + 1e-3 * contact_descent)).admissible
    assert check_admissible(vertex, closed(vertex, phi - 1e-3 * contact_descent)).admissible


def test_no_nearby_symmetric_state_is_admissible_and_lower(tip):
    vertex, phi, gradient, _ = tip
    rest = phi - gradient
    rng = np.random.default_rng(3)
    average = np.array(crease_average(2, 8), dtype=float)
    admissible = 0
    for size in (0.3, 0.03, 0.003):
        for _ in range(40):
            a, b, c = size * rng.normal(size=3)
            near = closed(vertex, phi + np.array([a, b, c, b] * 2), average)
            if check_admissible(vertex, near).admissible:
                admissible += 1
                growth = energy(near, rest) - energy(phi, rest)
                assert growth >= 5 / 16 * ((near - phi) ** 2).sum() - 1e-14
    assert admissible > 30


def test_a_broken_step_leaves_the_claim_undecided(monkeypatch):
    monkeypatch.setattr(section3_contact, "_broken_steps", lambda: ["C d = 0"])
    for claim in section3_contact.CLAIMS:
        assert claim.decide().verdict == "unproved"
