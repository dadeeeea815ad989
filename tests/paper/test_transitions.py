"""Transitions of the admissible space: found without being told where, and confirmed without the sweep."""

import math

import numpy as np
import pytest

from origami_nlp.paper import find_transitions
from origami_nlp.paper.events import find_events
from origami_nlp.pattern import degree6, degree8
from tests.independent.search_layers import symmetrically_admissible
from tests.independent.search_manifold import Piece


@pytest.mark.parametrize(
    ("family", "known", "starts"),
    [
        (degree8, [math.pi / 4], 4),
        pytest.param(degree6, [math.pi / 4, math.pi / 3], 6, marks=pytest.mark.slow),
    ],
)
def test_events_are_where_creases_meet(family, known, starts):
    """Only where 4 alpha = pi, and of degree 6 where 3 alpha = pi: creases 1 and 4, or 1 and 3, meet there."""
    events = find_events(family, starts=starts)
    apart = np.abs(np.subtract.outer([e.alpha for e in events], known))
    assert max(apart.min(axis=1).max(), apart.min(axis=0).max()) < 1e-13
    assert max(e.residual for e in events) < 1e-10


@pytest.mark.parametrize("phi_1", [-2.5, -1.5, -0.5])
@pytest.mark.parametrize(("held", "free"), [(1, 3), (3, 1)])
def test_pi_3_is_confirmed_by_states_that_share_no_code(phi_1, held, free):
    """With phi_2 = -pi, or phi_4 = -pi, a state is admissible above pi/3 (a strip), at pi/3 (a handle), not below."""
    verdicts = []
    for shift in (-1e-5, 0.0, 1e-5):
        piece = Piece.of(degree6(math.pi / 3 + shift))
        x = np.array([phi_1, -math.pi, 2.4, -math.pi])
        for _ in range(60):  # Newton in phi_3 and the free one
            g, jac = piece.closure(x[None])
            x[[2, free]] -= np.linalg.lstsq(jac[0][:, [2, free]], g[0], rcond=1e-9)[0]
        assert np.abs(piece.closure(x[None])[0]).max() < 1e-13
        assert x[held] == -math.pi
        assert x[2] > math.pi / 2  # beyond the end of the surface
        if shift == 0:
            assert x[free] == pytest.approx(-math.pi, abs=1e-12)
            x[free] = -math.pi
        verdicts.append(bool(symmetrically_admissible(piece, x[None])[0]))
    assert verdicts == [False, True, True]


@pytest.mark.slow
def test_the_space_changes_at_events_alone():
    found = find_transitions("degree8")
    assert [t.alpha for t in found.transitions] == pytest.approx([math.pi / 4], abs=1e-13)
    assert found.transitions[0].changes == ("corners",)
    assert found.unexplained == () == found.silent
