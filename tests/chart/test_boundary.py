"""Exact boundaries against the closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.chart import (
    Boundary,
    allowed,
    chart_limits,
    chart_of,
    fold_vertex,
)
from origami_nlp.pattern_problem import check_admissible
from tests.computed_once import PANELS, panel_boundary, thinned

SCENES = {
    "pi/4": o.examples.degree6("pi/4", 1.0),
    "pi/3": o.examples.degree6("pi/3", 1.0),
    "octagon": o.examples.degree8("pi/12", 0.01),
}


def boundary(name: str) -> Boundary:
    return panel_boundary(PANELS.index(SCENES[name]))


@pytest.mark.parametrize("name", thinned([*SCENES], 3))
def test_lines_are_where_admissibility_ends(name):
    """Points of a line close and are admissible; a little to one side, in the chart, no state is."""
    scene, chart = SCENES[name], chart_of(SCENES[name])
    x0, x1, y0, y1 = chart_limits(chart)
    for line in boundary(name):
        _, q = fold_vertex(scene.vertex, line.fold_angles)
        assert np.linalg.norm(q[:, 1:], axis=1).max() < 1e-12 and (q[:, 0] > 0).all()
        assert all(
            check_admissible(scene.vertex, phi).admissible for phi in line.fold_angles[1::25]
        )
        # away from corners, where the line turns in the chart
        far = np.linalg.norm(line.points[:, None] - line.points[[0, -1]], axis=2).min(axis=1) > 0.3
        ahead = np.gradient(line.points, axis=0)[far]
        normal = np.stack([-ahead[:, 1], ahead[:, 0]], axis=-1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        sides = []
        for sign in (1e-4, -1e-4):
            x, y = (line.points[far] + sign * normal).T
            inside = (x > x0) & (x < x1) & (y > y0) & (y < y1)
            sides.append(allowed(chart, line.branch, x, y)[0] & inside)
        assert not (sides[0] & sides[1]).any()
        assert not sides[0].any() if line.thin else (sides[0] | sides[1]).all()
