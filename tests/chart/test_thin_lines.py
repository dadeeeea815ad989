"""Contour lines of a vector file: fewer points, and the same lines to the eye."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.path import Path
from shapely import LineString, hausdorff_distance

from origami_nlp.chart.axes import UNSEEN, thinned


def test_contour_lines_keep_their_place_with_fewer_points():
    t = np.linspace(-3.0, 3.0, 301)
    energy = t[:, None] ** 2 + 0.3 * np.sin(2 * t[None]) + (t[None] - 1) ** 2 / 3
    lines = Figure().subplots().contour(t, t, energy, levels=6)
    before = after = 0
    for path in (path for path in lines.get_paths() if len(path)):
        thin = thinned(path)
        old, new = (
            np.split(p.vertices, np.flatnonzero(p.codes == Path.MOVETO)[1:]) for p in (path, thin)
        )
        for one, other in zip(old, new, strict=True):
            before, after = before + len(one), after + len(other)
            assert hausdorff_distance(LineString(one), LineString(other)) <= 1.01 * UNSEEN
            assert (one[0] == other[0]).all() and (one[-1] == other[-1]).all()
    assert 0 < after < before / 4
