"""Nonnegative least squares, in C and in NumPy, against what Kuhn and Tucker ask for and against SciPy."""

import numpy as np
import pytest
from scipy.optimize import nnls

from origami_nlp.numerics import SWITCH, nonnegative_least_squares


def drawn():
    rng = np.random.default_rng(0)
    for k in range(300):
        t, r = rng.integers(1, 12), rng.integers(1, 16)
        b, c = rng.normal(size=(t, r)), rng.normal(size=t)
        if k % 3 == 0:  # columns that depend on each other
            b[:, -1], b[:, r // 2] = b[:, 0], 0.0
        if k % 5 == 0:  # met exactly
            c = b @ np.maximum(rng.normal(size=r), 0.0)
        yield 10.0 ** rng.integers(-6, 6) * b, c


@pytest.mark.parametrize("compiled", ["1", "0"])
def test_answers_are_optimal(compiled, monkeypatch):
    monkeypatch.setenv(SWITCH, compiled)
    for b, c in drawn():
        mu = nonnegative_least_squares(b, c)
        left, size = c - b @ mu, np.abs(b).max() or 1.0
        assert mu.min() >= 0
        assert (b.T @ left).max() <= 1e-12 * size
        assert abs(mu @ (b.T @ left)) <= 1e-11
        assert np.linalg.norm(left) == pytest.approx(nnls(b / size, c)[1], abs=1e-9)


def test_what_is_not_finite_is_refused_by_numpy():
    with pytest.raises((ValueError, np.linalg.LinAlgError)):
        nonnegative_least_squares(np.full((2, 2), np.nan), np.ones(2))
