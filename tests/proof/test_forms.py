"""Common zeros of quadratic forms are never lost, and forms without any are seen to have none."""

import numpy as np
import pytest

from origami_nlp.proof.forms import DirectionBoxes, Forms, left_over, none_beside


def forms(rows: list[tuple], n: int, lower: float = -1.0, order: int = 2) -> Forms:
    """Rows (c, a, M, t, T, b, e) on one stratum."""
    c, a, q, t, tq, b, e = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    holds = np.ones((1, len(c)), dtype=bool)
    return Forms(c, a, q, t, tq, b, e, order, holds, np.full((1, n), lower), np.ones((1, n)))


def through(rng: np.random.Generator, u: np.ndarray, b: float) -> tuple:
    """A random row that u satisfies to within b."""
    n = len(u)
    a, q = rng.normal(size=n), rng.normal(size=(n, n))
    q = q + q.T
    miss = b * rng.uniform(-1, 1)
    return miss - a @ u - u @ q @ u, a, q, np.zeros(n), np.zeros((n, n)), b, 0.0


@pytest.mark.parametrize("n", [2, 3, 5])
def test_a_zero_is_never_lost(n: int) -> None:
    rng = np.random.default_rng(n)
    for _ in range(60):
        u = rng.uniform(-1, 1, n)
        u[rng.integers(n)] = rng.choice([-1.0, 1.0])
        rows = forms([through(rng, u, 10 ** rng.uniform(-15, -3)) for _ in range(n + 1)], n)
        given_up, left = left_over(rows, 1e-3)
        held = ((left.lower <= u) & (u <= left.upper)).all(axis=1)
        assert given_up[0] or held.any()


def test_forms_without_a_zero_are_seen_to_have_none() -> None:
    """Two lines of a plane that meet off the faces, and forms that are definite."""
    rng = np.random.default_rng(0)
    shown = 0
    for _ in range(40):
        u = rng.uniform(-0.8, 0.8, 3)
        rows = [through(rng, u, 0.0) for _ in range(3)]
        straight = [(-a @ u, a, 0 * q, t, tq, b, e) for _, a, q, t, tq, b, e in rows]
        given_up, left = left_over(forms(straight, 3), 1e-3)
        matrix = np.array([a for _, a, *_ in straight])
        if np.linalg.cond(matrix) < 100:  # then u is the only zero, and on no face
            shown += 1
            assert not given_up[0] and not len(left.stratum)
    assert shown > 20
    definite = (0.0, np.zeros(3), np.diag([1.0, 2.0, 3.0]), np.zeros(3), np.zeros((3, 3)), 0.5, 0.0)
    assert not len(left_over(forms([definite], 3), 1e-3)[1].stratum)


def test_an_error_that_reaches_zero_leaves_boxes() -> None:
    row = (0.0, np.zeros(2), np.eye(2), np.zeros(2), np.zeros((2, 2)), 0.0, 2.0)
    given_up, left = left_over(forms([row], 2), 1.0)
    assert given_up[0] or len(left.stratum)
    assert not len(left_over(forms([row], 2), 0.1)[1].stratum)


def test_whole_curves_of_zeros_are_given_up_or_left() -> None:
    given_up, left = left_over(
        forms(
            [
                (
                    0.0,
                    np.array([1.0, -1.0, 0, 0, 0]),
                    *([np.zeros((5, 5))]),
                    np.zeros(5),
                    np.zeros((5, 5)),
                    0,
                    0,
                )
            ],
            5,
        ),
        1e-3,
    )
    assert given_up[0] or len(left.stratum)


def pair(first: float, second: float, error: float = 0.0, base: float = 0.0) -> Forms:
    """u_2 + r first = 0 and 2 u_2 + r second = 0 about u = (1, 0)."""
    square = np.zeros((2, 2))
    return forms(
        [
            (0.0, np.array([0.0, 1.0]), square, np.array([first, 0.0]), square, base, error),
            (0.0, np.array([0.0, 2.0]), square, np.array([second, 0.0]), square, base, error),
        ],
        2,
    )


BOX = DirectionBoxes(np.array([0]), np.array([[1.0, -1e-3]]), np.array([[1.0, 1e-3]]))


def test_the_next_order_decides_where_the_leading_one_cannot() -> None:
    assert none_beside(pair(0.5, 0.0), BOX, 1e-8, 1e-3)[0]
    # u_2 = -r / 2 satisfies both
    assert not none_beside(pair(0.5, 1.0), BOX, 1e-8, 1e-3)[0]
    # and here it does within the errors: of order 2 at r0, of rounding at the core
    assert not none_beside(pair(0.5, 0.0, error=1e3), BOX, 1e-8, 1e-3)[0]
    assert not none_beside(pair(0.5, 0.0, base=1e-8), BOX, 1e-8, 1e-3)[0]
    assert none_beside(pair(0.5, 0.0, base=1e-10), BOX, 1e-8, 1e-3)[0]


@pytest.mark.parametrize("seed", range(20))
def test_zeros_that_move_with_r_are_never_excluded(seed: int) -> None:
    """Rows that vanish along u(r) = z + r d + O(r^2), whatever r in the range."""
    rng = np.random.default_rng(seed)
    n, core, radius = 4, 1e-8, 1e-3
    z = np.append(1.0, rng.uniform(-0.9, 0.9, n - 1))
    d = np.append(0.0, rng.uniform(-1, 1, n - 1))
    rows = []
    for _ in range(n + 2):
        c, a, q, *_ = through(rng, z, 0.0)
        slope = a + 2 * q @ z
        t = rng.normal(size=n)
        t[0] -= (t @ z + slope @ d) / z[0]  # w(z) = -v'(z) d
        rows.append((c, a, q, t, np.zeros((n, n)), 1e-14, 1.01 * abs(d @ q @ d + t @ d)))
    found = forms(rows, n)
    near = DirectionBoxes(np.array([0]), (z - 1e-3 * (d != 0))[None], (z + 1e-3 * (d != 0))[None])
    assert not none_beside(found, near, core, radius)[0]
    # a row that asks for something else is inconsistent
    rows[0] = (*rows[0][:3], rows[0][3] + np.append(3.0, np.zeros(n - 1)), *rows[0][4:])
    assert none_beside(forms(rows, n), near, core, 1e-6)[0]
