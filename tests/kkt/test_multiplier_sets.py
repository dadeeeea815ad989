"""Smallest multiplier vectors of dependent contacts: optimal by their dual, and always found."""

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from scipy.optimize import linprog

from origami_nlp.kkt import find_multipliers
from origami_nlp.kkt.certificates import cone
from origami_nlp.kkt.multipliers import smallest_norm
from origami_nlp.numerics import nearest, nearest_in_cone, nonnegative_least_squares, unbounded

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


def check_smallest(b, mu, c, size):
    """KKT of min |mu|: mu >= 0, B mu = c, and mu = B'y where it is positive, B'y <= 0 elsewhere."""
    assert mu.min() >= 0
    assert np.abs(b @ mu - c).max() <= 1e-11 * size
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
    closest = nonnegative_least_squares(NEARLY_PARALLEL, UNBALANCED)
    check_smallest(NEARLY_PARALLEL, found.smallest, NEARLY_PARALLEL @ closest, 12.0)


def check_nearest(y, point, rows, lower):
    """KKT of min |y - point|: rows y >= lower, and y - point = rows' mu with mu >= 0 where a row holds."""
    size = max(np.abs(point).max(), np.abs(lower).max())
    gaps = rows @ y - lower
    assert gaps.min() >= -1e-10 * size
    on = gaps <= 1e-9 * size
    mu = nonnegative_least_squares(rows[on].T, y - point)
    assert np.abs(rows[on].T @ mu - (y - point)).max() <= 1e-9 * size


@settings(max_examples=150)
@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 6),
    r=st.integers(1, 10),
    size=st.floats(-8, 8),
    cone=st.booleans(),
)
@example(seed=2672007842, n=1, r=7, size=4.150563446090818, cone=False)  # a row of length 1e-3
def test_nearest_points_satisfy_their_optimality_conditions(seed, n, r, size, cone):
    rng = np.random.default_rng(seed)
    rows, point = rng.normal(size=(r, n)), rng.normal(size=n) * 10.0**size
    if cone:
        check_nearest(nearest_in_cone(point, rows), point, rows, np.zeros(r))
    else:
        lower = -np.maximum(rng.normal(size=r), 0) * 10.0**size
        check_nearest(nearest(point, rows, lower), point, rows, lower)


@settings(max_examples=60)
@given(
    seed=st.integers(0, 2**32 - 1),
    rows=st.integers(1, 3),
    extra=st.integers(1, 4),
    size=st.floats(-4, 4),
    repeated=st.booleans(),
)
@example(seed=4212306790, rows=3, extra=2, size=3.4114426087313277, repeated=False)  # far corner
def test_ranges_by_corners_and_by_a_linear_programme_agree(seed, rows, extra, size, repeated):
    rng = np.random.default_rng(seed)
    b = rng.normal(size=(rows, rows + extra))
    if repeated:
        b[:, 1] = b[:, 0]
    c = b @ np.maximum(rng.normal(size=rows + extra), 0) * 10.0**size
    listed = find_multipliers(b, c)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("origami_nlp.numerics.linear.MOST_CORNERS", 0)
        solved = find_multipliers(b, c)
    assert listed.lower == pytest.approx(solved.lower, rel=1e-8, abs=1e-8 * 10.0**size)
    assert listed.upper == pytest.approx(solved.upper, rel=1e-8, abs=1e-8 * 10.0**size)
    for mu in (*listed.vertices, *solved.vertices):
        assert mu.min() >= 0
        assert np.abs(b @ mu - c).max() <= 1e-10 * 10.0**size * max(1.0, mu.max() / 10.0**size)


@settings(max_examples=150)
@given(
    seed=st.integers(0, 2**32 - 1),
    rows=st.integers(1, 3),
    extra=st.integers(1, 4),
    size=st.floats(-6, 6),
    repeated=st.booleans(),
)
@example(seed=43023, rows=1, extra=4, size=-5.5, repeated=False)  # was a corner, not the smallest
def test_smallest_multipliers_satisfy_their_optimality_conditions(
    seed, rows, extra, size, repeated
):
    rng = np.random.default_rng(seed)
    b = rng.normal(size=(rows, rows + extra))
    if repeated:  # one contact described twice
        b[:, 1] = b[:, 0]
    mu = np.maximum(rng.normal(size=rows + extra), 0) * 10.0**size
    found = nonnegative_least_squares(b, b @ mu)
    assert np.abs(b @ (found - mu)).max() <= 1e-11 * mu.max()
    check_smallest(b, smallest_norm(b, found), b @ mu, max(mu.max(), 1e-300))


def rows_with_held_ones(seed, n, r, held):
    """Integers, so that cones are thin or wide and never nearly so; `held` rows stand with their opposites."""
    rng = np.random.default_rng(seed)
    rows = rng.integers(-2, 3, (r, n)).astype(float)
    return np.vstack([rows, -rows[:held]])


@settings(max_examples=40)
@given(
    seed=st.integers(0, 2**32 - 1), n=st.integers(1, 5), r=st.integers(1, 8), held=st.integers(0, 3)
)
def test_cones_and_unbounded_multipliers_are_those_of_linear_programmes(seed, n, r, held):
    rows = rows_with_held_ones(seed, n, r, held)
    count = len(rows)
    opens = [-linprog(-row, -rows, np.zeros(count), bounds=(-1, 1)).fun > 1e-7 for row in rows]
    names = tuple(range(count))
    dimension, inside, kept = cone(rows, names)
    assert set(kept) == {k for k in names if not opens[k]}
    rank = np.linalg.matrix_rank(rows[list(kept)]) if kept else 0
    assert dimension == n - rank
    if inside is not None:
        assert all((rows @ inside)[opens] > 1e-9)
        assert np.abs(rows[list(kept)] @ inside).max(initial=0) < 1e-9
    b = rows.T
    grows = [
        -linprog(-np.eye(count)[k], None, None, b, np.zeros(n), bounds=(0, 1)).fun > 1e-7
        for k in names
    ]
    assert unbounded(b).tolist() == grows


@pytest.mark.parametrize(
    ("b", "c"),
    [
        ([[1.0, 1e-13]], [-1.0]),  # a contact that pushes nowhere
        ([[1.0, -1.0, 0.0], [0.0, 1e-10, -1.0]], [0.0, 1e-3]),  # two that all but cancel
    ],
)
def test_what_counts_as_zero_balances_nothing(b, c):
    b, c = np.array(b), np.array(c)
    assert find_multipliers(b, c).residual >= np.abs(c).max()
