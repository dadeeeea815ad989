"""Ranks, null spaces and shortest solutions by orthogonal factors, against singular values of NumPy."""

import numpy as np
import pytest

from origami_nlp.numerics import RANK, NullSpaces, shortest_solution


def _matrix(rng: np.random.Generator, values: list[float], m: int, n: int) -> np.ndarray:
    """A matrix with given singular values, the others zero."""
    u, v = (np.linalg.qr(rng.normal(size=(k, k)))[0] for k in (m, n))
    return (u[:, : len(values)] * values) @ v[:, : len(values)].T


@pytest.mark.parametrize("smallest", [1.0, 1e-3, 3e-6, 2e-7, 1.01e-7, 0.99e-7, 5e-8, 1e-12, 0.0])
def test_rank_and_null_spaces_are_those_of_singular_values(smallest: float) -> None:
    rng = np.random.default_rng(0)
    for m, n in ((1, 1), (3, 9), (30, 9), (40, 31), (31, 40), (147, 112)):
        a = _matrix(rng, [*np.geomspace(1, 0.1, min(m, n) // 2), smallest], m, n)
        of, values = NullSpaces(a), np.linalg.svd(a, compute_uv=False)
        for below in (RANK, 1e-9, 1e-3):
            assert of.rank(below) == (values > below).sum()
        assert of.any_between(RANK, 1e-3) == bool(((values > RANK) & (values < 1e-3)).any())
        rank = of.rank()
        z, w = of.kernel, of.lost
        assert z.shape == (n, n - rank) and w.shape == (m - rank, m)
        left = 0.0 if rank == len(values) else values[rank]
        for product, unit in ((a @ z, z.T @ z), (w @ a, w @ w.T)):
            # of pivoted factors within a small multiple of what the singular vectors leave
            assert np.abs(product).max(initial=0.0) <= 10 * left + 1e-14
            assert np.allclose(unit, np.eye(len(unit)), rtol=0, atol=1e-13)


def test_no_rows_leave_everything() -> None:
    of = NullSpaces(np.zeros((0, 4)))
    assert of.rank() == 0 and of.lost.shape == (0, 0)
    assert np.array_equal(of.kernel, np.eye(4))


@pytest.mark.parametrize("lost", [0, 5])
def test_shortest_solutions_are_those_of_singular_values(lost: int) -> None:
    rng = np.random.default_rng(1)
    for m, n in ((3, 9), (147, 112), (112, 147), (60, 60)):
        values = np.geomspace(1, 1e-3, min(m, n) - 1 - min(lost, m - 2))
        a = _matrix(rng, [*values, 1e-13], m, n)
        b = rng.normal(size=m)
        known = np.linalg.lstsq(a, b, rcond=1e-9)[0]
        assert np.abs(shortest_solution(a, b, 1e-9) - known).max() <= 1e-10 * np.abs(known).max()
