"""Smallest multiplier vectors of dependent contacts: optimal by their dual, and always found."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from origami_nlp.judge.linear import minimise
from origami_nlp.judge.multipliers import find_multipliers, nonnegative_least_squares, smallest_norm

# the set at a flat folding of a vertex with sectors pi/13 (5, 5, 5, 1, 5, 5): HiGHS cycled on it for ever
_PAIR = np.array(
    [[0.6612602165519119, 0.6612602165519118], [0.00347567030632986, 0.00347567030633068]]
)
NEARLY_PARALLEL = np.column_stack(
    [
        [-0.7072178924429571, -0.00371722987009026],
        [-0.00540862292602459, 0.7127785604194733],
        _PAIR,
        [-0.00505715028639371, 0.666459531430135],
    ]
)
UNBALANCED = np.array([-7.762988570222266, -0.04881222377576877])
MISSED = 0.0080888050205


def check_smallest(b, mu, c, size):
    """KKT of min |mu|: mu >= 0, B mu = c, and mu = B'y where it is positive, B'y <= 0 elsewhere."""
    assert mu.min() >= 0
    assert np.abs(b @ mu - c).max() <= 1e-11 * max(1.0, size)
    on = mu > 1e-9 * size
    if not on.any():
        return
    y = np.linalg.lstsq(b[:, on].T, mu[on], rcond=None)[0]
    assert np.abs(b[:, on].T @ y - mu[on]).max() <= 1e-7 * size
    if on.sum() >= len(b) and np.linalg.matrix_rank(b[:, on]) == len(b):  # y is unique
        assert (b[:, ~on].T @ y).max(initial=-1.0) <= 1e-7 * size


def test_a_set_on_which_a_quadratic_programme_cycled_is_described():
    found = find_multipliers(NEARLY_PARALLEL, UNBALANCED)
    assert not found.unique
    assert found.residual > 1e-3  # the springs of that state are not balanced
    nearest = nonnegative_least_squares(NEARLY_PARALLEL, UNBALANCED)
    check_smallest(NEARLY_PARALLEL, found.smallest, NEARLY_PARALLEL @ nearest, 12.0)


def test_a_programme_without_end_gives_up_with_nothing():
    low, high = UNBALANCED - MISSED, UNBALANCED + MISSED
    out = minimise(np.zeros(5), NEARLY_PARALLEL, low, high, 0.0, 1e6, squares=True)
    assert out is None or np.isfinite(out).all()


@settings(max_examples=150, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    rows=st.integers(1, 3),
    extra=st.integers(1, 4),
    size=st.floats(-6, 6),
    repeated=st.booleans(),
)
def test_smallest_multipliers_satisfy_their_optimality_conditions(
    seed, rows, extra, size, repeated
):
    rng = np.random.default_rng(seed)
    b = rng.normal(size=(rows, rows + extra))
    if repeated:  # one contact described twice
        b[:, 1] = b[:, 0]
    mu = np.maximum(rng.normal(size=rows + extra), 0) * 10.0**size
    found = nonnegative_least_squares(b, b @ mu)
    assert np.abs(b @ (found - mu)).max() <= 1e-11 * max(1.0, mu.max())
    check_smallest(b, smallest_norm(b, found), b @ mu, max(mu.max(), 1e-300))


@pytest.mark.parametrize("count", [2, 3, 5])
def test_one_contact_described_many_times_shares_its_moment_equally(count):
    b = np.ones((1, count))
    found = find_multipliers(b, np.array([3.0]))
    assert found.smallest == pytest.approx(np.full(count, 3.0 / count), abs=1e-14)
    assert found.lower == pytest.approx(0.0, abs=1e-10)
    assert found.upper == pytest.approx(3.0, rel=1e-10)
