"""Bases of kernels as reflections give what the basis itself gives, and systems are solved as SVD does."""

import numpy as np
import pytest

from origami_nlp.numerics import KernelBasis, null_space, solve_symmetric


@pytest.mark.parametrize("many", [0, 1, 3, 7])
def test_products_are_those_of_a_basis(many):
    rng = np.random.default_rng(many)
    n = 40
    rows = np.linalg.qr(rng.normal(size=(n, max(many, 1))))[0].T[:many]
    symmetric = rng.normal(size=(n, n))
    symmetric += symmetric.T
    basis, z = KernelBasis(rows), null_space(rows) if many else np.eye(n)
    made = basis.spread(np.eye(n - many))
    np.testing.assert_allclose(made.T @ made, np.eye(n - many), atol=1e-14)
    np.testing.assert_allclose(rows @ made, 0, atol=1e-14)
    np.testing.assert_allclose(basis.within(symmetric), made.T @ symmetric @ made, atol=1e-13)
    v = rng.normal(size=(n, 2))
    np.testing.assert_allclose(made @ basis.coordinates(v), z @ (z.T @ v), atol=1e-13)
    # whatever the basis, eigenvalues are those on the subspace
    np.testing.assert_allclose(
        np.linalg.eigvalsh(basis.within(symmetric)),
        np.linalg.eigvalsh(z.T @ symmetric @ z),
        atol=1e-12,
    )


@pytest.mark.parametrize("values", [(1, 3), (1e-8, 1e8), (-1, 3), (0, 1)])
def test_systems_are_solved_as_by_singular_values(values):
    rng = np.random.default_rng(1)
    n = 30
    q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    spectrum = np.linspace(*values, n)
    matrix, right = (q * spectrum) @ q.T, rng.normal(size=(n, 1))
    matrix = (matrix + matrix.T) / 2
    found = solve_symmetric(matrix, right)
    kept = np.abs(spectrum) > 1e-14 * np.abs(spectrum).max()
    exact = (q[:, kept] / spectrum[kept]) @ (q[:, kept].T @ right)
    size = np.linalg.norm(exact)
    condition = np.abs(spectrum[kept]).max() / np.abs(spectrum[kept]).min()
    assert np.linalg.norm(found - exact) <= 1e-14 * condition * size
