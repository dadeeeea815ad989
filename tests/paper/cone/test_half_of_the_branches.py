"""How many branches of a cone hold a minimum: half, where and under which rule; every exception by brute force."""

import math

import numpy as np
import pytest

from origami_nlp.paper import cone
from origami_nlp.pattern import Vertex
from origami_nlp.pattern_problem import check_admissible


def maps(degree, end, size=200):
    low = -cone.Cone(degree).steep_end
    cells = (np.arange(size) + 0.5) / size
    elevations = low + (math.pi / 2 - low) * cells
    return cone.count_map(cone.Cone(degree, end=end), 10 ** (4 * cells - 2), elevations)


# ---------------------------------------------------------------- ends where nothing touches


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


@pytest.mark.slow
@pytest.mark.parametrize(
    "degree, end, more, share",
    [(8, "contact", 20, 0.0453), (14, "contract", 142, 0.0143), (12, "contract", None, 0)],
)
def test_how_often_the_documented_maps_hold_more_than_half(degree, end, more, share):
    """The table of docs/validation/cones.md: 200 x 200 points, r from 0.01 to 100."""
    plane = maps(degree, end)
    half = plane.cone.branches // 2
    assert set(np.unique(plane.total).tolist()) == {half, more or half}
    assert (plane.total != half).mean() == pytest.approx(share, abs=5e-5)
