"""What is posed: facets cut into convex pieces as fast as large sheets need it, and what is kept of the last states."""

import numpy as np

from origami_nlp.pattern_problem.crossings import _convex, convex_parts


def test_facets_of_many_corners_are_cut_as_each_by_itself():
    rng = np.random.default_rng(0)
    corners, polygons, convex = [], [], []
    for _ in range(200):
        q = int(rng.integers(3, 8))
        turns = np.sort(rng.uniform(0, 2 * np.pi, q))
        # stars: of radii that differ, some are not convex
        radii = rng.uniform(0.3, 1, q) if rng.random() < 0.5 else np.ones(q)
        if np.diff(turns, append=turns[0] + 2 * np.pi).max() > 3:
            continue
        frame = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
        x = (radii[:, None] * np.column_stack([np.cos(turns), np.sin(turns)])) @ frame
        polygons.append(tuple(range(len(corners), len(corners) + q)))
        corners += x.tolist()
        # an independent answer: every corner is on its hull
        flat = radii[:, None] * np.column_stack([np.cos(turns), np.sin(turns)])
        d = np.roll(flat, -1, axis=0) - flat
        e = np.roll(d, -1, axis=0)
        convex.append(bool((d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0] > 0).all()))
    found = _convex(np.array(corners), polygons)
    assert found.tolist() == convex and 20 < sum(convex) < len(convex) - 20
    for polygon, whole in zip(polygons, convex, strict=True):
        if not whole:
            parts = convex_parts(np.array(corners), polygon)
            assert len(parts) == len(polygon) - 2 and all(len(part) == 3 for part, _ in parts)
