"""Where branches of a cone end: at contact, or at a cut where nothing touches."""

import math

import numpy as np
import pytest

from origami_nlp.paper import cone
from origami_nlp.pattern import Vertex
from origami_nlp.pattern_problem import check_admissible


@pytest.mark.parametrize("degree", [6, 8, 10, 12])
@pytest.mark.parametrize("direction", [1, -1])
def test_a_cut_end_is_where_nothing_touches(degree, direction):
    """The embedding knows nothing of branches: contact at all ends but the cut ones, which can be passed."""
    for folding in cone.foldings(degree, mirrors_differ=False):
        branch = cone.ConeBranch(folding.flaps, direction)
        cut = bool(branch.cone.is_cut(branch.steep))
        further = cone.ConeBranch(folding.flaps, direction, "contact")
        assert cut == (branch.steep == 1) and not further.cone.is_cut(branch.steep)
        if not cut:
            continue
        for v in (branch.end, branch.end + 0.5 * (cone.Cone(degree).lone_end - branch.end)):
            reported = check_admissible(
                Vertex((2 * math.pi / degree,) * degree), further.fold_angles(direction * v)
            )
            assert reported.admissible, reported.reason
            assert np.abs(further.fold_angles(direction * v)).max() < math.pi - 1e-3
