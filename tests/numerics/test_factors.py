"""Sparse factors of symmetric systems, definite on the null space or not, against dense elimination."""

import numpy as np
import pytest
import scipy as sp

from origami_nlp.numerics.factors import WEIGHT, Factor


@pytest.mark.parametrize("curvature", [(0.5, 2.0), (-2.0, 2.0), (0.0, 0.0)])
@pytest.mark.parametrize("seed", range(3))
def test_solutions_are_those_of_dense_elimination(curvature, seed):
    rng = np.random.default_rng(seed)
    n, m = 40, 15
    h = np.diag(rng.uniform(*curvature, n))
    h[:5, :5] += 0.3 * np.eye(5)[::-1]
    j = rng.normal(size=(m, n)) * (rng.random((m, n)) < 0.3)
    # without curvature rows of closure alone make the system regular: as many as unknowns
    j = rng.normal(size=(n, n)) if curvature == (0.0, 0.0) else j
    whole = np.block([[h, j.T], [j, -WEIGHT * np.eye(len(j))]])
    top, bottom = rng.normal(size=n), rng.normal(size=len(j))
    found = Factor(sp.sparse.csr_array(h), sp.sparse.csr_array(j)).solve(top, bottom)
    expected = np.linalg.solve(whole, np.concatenate([top, bottom]))
    assert np.abs(np.concatenate(found) - expected).max() < 1e-9 * np.abs(expected).max()
