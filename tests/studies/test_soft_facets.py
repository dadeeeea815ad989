"""Two states of a square twist that bends, by bars and hinges in space, in positions of corners alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from origami_nlp.pattern_problem import PatternProblem
from studies.soft_facets import bistable, settled, twist

ALPHA, STIFF, SOFT = 25, 12.0, 4.0


def fold_angle(x, a, b, c, d):
    """Turn about the side a-b from the facet with c (left of it) to that with d, valley positive."""
    e = (x[b] - x[a]) / np.linalg.norm(x[b] - x[a])
    left, right = np.cross(e, x[c] - x[a]), np.cross(x[d] - x[a], e)
    left, right = left / np.linalg.norm(left), right / np.linalg.norm(right)
    return -math.atan2(float(np.cross(left, right) @ e), float(left @ right))


def hinges(pattern):
    """Each crease with the corners opposite it, in the facets left and right of it."""
    out = []
    for a, b in pattern.ends.tolist():
        c = d = None
        for p in pattern.polygons:
            if a in p and b in p:
                (other,) = set(p) - {a, b}
                k = p.index(a)
                c, d = (other, d) if p[(k + 1) % 3] == b else (c, other)
        out.append((a, b, c, d))
    return out


def relaxed(pattern, phi_start, x):
    """Minimise energies of hinges with bars of fixed length, from positions x; return energy, fold angles and bars."""
    bars = sorted({tuple(sorted((p[i - 1], p[i]))) for p in pattern.polygons for i in range(3)})
    i, j = np.array(bars).T
    flat = pattern.corners
    square = ((flat[i] - flat[j]) ** 2).sum(axis=1)
    where = hinges(pattern)

    def angles(x):
        # of turns beyond a half the one next to where it began
        raw = np.array([fold_angle(x, *h) for h in where])
        return raw + 2 * np.pi * np.round((phi_start - raw) / (2 * np.pi))

    def energy(v):
        return float(0.5 * pattern.stiffness @ (angles(v.reshape(-1, 3)) - pattern.rest) ** 2)

    def long(v):
        y = v.reshape(-1, 3)
        return ((y[i] - y[j]) ** 2).sum(axis=1) - square

    def slope(v):
        y, out = v.reshape(-1, 3), np.zeros((len(bars), v.size))
        for k, (a, b) in enumerate(bars):
            out[k, 3 * a : 3 * a + 3] = 2 * (y[a] - y[b])
            out[k, 3 * b : 3 * b + 3] = -2 * (y[a] - y[b])
        return out

    found = minimize(
        energy, x.ravel(), method="SLSQP", constraints={"type": "eq", "fun": long, "jac": slope},
        options={"maxiter": 200, "ftol": 1e-12},
    )  # fmt: skip
    return found.fun, angles(found.x.reshape(-1, 3)), np.abs(long(found.x)).max()


@pytest.mark.slow
def test_both_states_are_minima_of_bars_and_hinges():
    begun = settled(30, 1e-2, 1.0)
    for stiffness in np.geomspace(1e-2, 1e3, 26):
        begun = settled(30, float(stiffness), begun.phi)
    for alpha in (29, 28, 27, 26, 25):
        begun = settled(alpha, 1e3, begun.phi)
    opened = settled(ALPHA, 1e3, 0.3)
    for stiffness in np.geomspace(1e3, STIFF, 16):
        begun, opened = (settled(ALPHA, float(stiffness), s.phi) for s in (begun, opened))
    assert bistable(begun, opened)
    for state in (begun, opened):
        problem = state.problem
        x = problem.crossings.poses.corners(state.phi)
        x = x + 0.01 * np.random.default_rng(5).normal(size=x.shape)
        energy, phi, off = relaxed(problem.pattern, state.phi, x)
        assert off < 1e-6
        assert energy == pytest.approx(float(problem.pattern.energy(state.phi)), rel=1e-5)
        assert np.abs(phi - state.phi).max() < 5e-3
    # with softer facets the two are one
    for stiffness in np.geomspace(STIFF, SOFT, 10):
        begun, opened = (settled(ALPHA, float(stiffness), s.phi) for s in (begun, opened))
    assert not bistable(begun, opened)


def test_signs_of_the_twist_are_its_letters():
    problem, sign = twist(20, 1.0)
    assert isinstance(problem, PatternProblem)
    assert (np.sign(problem.pattern.rest[:12]) == sign).all() and (sign > 0).sum() == 8
