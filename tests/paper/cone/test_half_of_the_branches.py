"""How many branches of a cone hold a minimum: half, where and under which rule; every exception by brute force."""

import math

import numpy as np
import pytest

from origami_nlp.paper import cone


def maps(degree, end, size=200):
    low = -cone.Cone(degree).steep_end
    cells = (np.arange(size) + 0.5) / size
    elevations = low + (math.pi / 2 - low) * cells
    return cone.count_map(cone.Cone(degree, end=end), 10 ** (4 * cells - 2), elevations)


# ---------------------------------------------------------------- ends where nothing touches


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
