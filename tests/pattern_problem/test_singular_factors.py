"""A factorization of closure that breaks down ends one projection, and nothing else."""

import numpy as np
import pytest

from origami_nlp.numerics import SWITCH
from origami_nlp.pattern_problem import PatternProblem, equations
from tests.patterns import miura


@pytest.mark.parametrize("error", [np.linalg.LinAlgError, RuntimeError])
def test_a_factorization_that_breaks_down_ends_one_projection(monkeypatch, error):
    def fails(*_):
        raise error("singular")

    problem = PatternProblem(miura(2, 2))
    start = np.full(problem.size, 0.5)
    monkeypatch.setenv(SWITCH, "0")  # in C a factorization says whether it broke down
    monkeypatch.setattr(equations, "Normal", fails)
    phi, residual = problem.project(start)
    assert (phi == start).all() and residual > 1e-3
