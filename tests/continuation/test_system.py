"""KKT systems with dependent rows against singular values of the reduced matrix."""

from functools import cache

import numpy as np
import pytest
from scipy.linalg import null_space

import origami_nlp as o
from origami_nlp.continuation.equilibrium import EquilibriumCurve
from origami_nlp.continuation.system import BorderedSystem
from origami_nlp.paths import Driver
from origami_nlp.pattern_problem import PatternProblem, Pull, Torque
from origami_nlp.search import descend_by_newton


@cache
def systems():
    """A stable state of a sheet, off balance by a load that is linear in the fold angles, or not."""
    pattern = o.examples.pattern("miura", 3, 3).with_springs(1.0, 1.2)
    problem = PatternProblem(pattern)
    start = descend_by_newton(problem, problem.project(0.5 * pattern.rest)[0]).phi
    out = []
    for work in (Torque(pattern, (2,)), Pull(pattern, (0, 15))):
        line = Driver(work).line()
        out.append((line, BorderedSystem(line, np.append(start, 0.3))))
    return out


def test_direction_and_steps_solve_the_equations_that_dependent_rows_leave():
    for _, system in systems():
        j, n = system.jacobian, len(system.imbalance)
        assert np.linalg.matrix_rank(j, 1e-8) < len(j)
        z = null_space(j, rcond=1e-8)
        inside = np.column_stack([z.T @ system.hessian @ z, z.T @ system.drift])
        v = np.linalg.svd(inside)[2][-1]  # the curve, in coordinates of what closure leaves free
        want = np.append(z @ v[:-1], v[-1])
        way, _ = system.direction(want)
        assert way == pytest.approx(want / np.linalg.norm(want), abs=1e-8)
        step = system.step(way, 0.1)
        d = np.append(step[:n], step[-1] * system.line.weight)
        assert d @ way == pytest.approx(0.1, abs=1e-9)
        assert np.abs(j @ d[:n]).max() < 1e-8  # closure stays met, and what is free is balanced
        balance = z.T @ (system.imbalance + system.hessian @ d[:n] + system.drift * d[-1])
        assert np.abs(balance).max() < 1e-8


def test_drift_is_the_derivative_by_the_load():
    h = 1e-6
    for line, system in systems():
        s = 0.3
        ahead, behind = (
            BorderedSystem(line, np.append(system.x, s + d), (), system.multipliers).imbalance
            for d in (h, -h)
        )
        slope = (ahead - behind) / (2 * h) / line.weight
        assert slope == pytest.approx(system.drift, abs=1e-8)


def test_a_point_beside_the_curve_comes_back_to_it():
    for line, system in systems():
        curve = EquilibriumCurve(line)
        found = curve.at(np.append(system.x, 0.0), 0.0, np.append(np.zeros(len(system.x)), 1.0))
        assert found is not None and found.system.residual < 1e-12 and found.index == 0
