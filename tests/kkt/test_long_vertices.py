"""Long vertices are polished and judged by short cuts: the same as without; and the constant internal moment."""

import math

import numpy as np
import pytest

from origami_nlp.kkt import certificates, polishing
from origami_nlp.problem import Contact


def test_independent_contacts_all_open_at_once(monkeypatch):
    rng = np.random.default_rng(0)
    for r, t in ((14, 20), (20, 20)):
        rows = rng.normal(size=(r, t))
        names = tuple(Contact("limit", v, 1) for v in range(r))
        fast = certificates.cone(rows, names)
        monkeypatch.setattr(certificates, "MANY_ROWS", 99)
        slow = certificates.cone(rows, names)
        monkeypatch.undo()
        assert fast[0] == slow[0] == t
        assert fast[2] == slow[2] == ()
        assert (rows @ fast[1] > 0).all()
    rows[-1] = -rows[0]  # these two cannot open
    assert certificates.cone(rows, names)[2] == (names[0], names[-1])


@pytest.mark.parametrize("n", [4, polishing.LARGE + 1])
def test_a_step_where_closure_leaves_nothing_free(n):
    """Many creases, as many independent rows: what is solved for is closure alone (an error before)."""
    rng = np.random.default_rng(0)
    jacobian = np.eye(n) + 0.1 * rng.normal(size=(n, n)) / math.sqrt(n)
    factors = np.linalg.svd(jacobian, full_matrices=False)
    system = polishing._System(np.zeros(n), np.zeros(n), np.eye(n), jacobian, factors)
    values = rng.normal(size=n)
    assert jacobian @ system.step(values) == pytest.approx(-values, abs=1e-12)
    assert math.isfinite(polishing._uncertainty(system))
