"""Phase boundaries of cones: different counts on either side, and nothing but boundaries where counts change."""

import numpy as np
import pytest

from origami_nlp.paper import cone

SIDE = 1e-9
SLOW = pytest.mark.slow


def counts_of(branches, ratio, nu):
    """Minima of one class: (inside, at its end)."""
    found = cone.count(branches.cone, ratio, nu).minima
    own = found.branches.of_class(branches.valleys, branches.changes, branches.direction)
    inside = found.kind == "interior"
    return int((own & inside).sum()), int((own & ~inside).sum())


def sample(curve, many, rng):
    """Points of a curve away from its ends and from the largest ratios."""
    inner = np.arange(1, len(curve.ratio) - 1)
    inner = inner[(curve.ratio[inner] > 1e-4) & (curve.ratio[inner] < 1e4)]
    return rng.choice(inner, min(many, len(inner)), replace=False) if len(inner) else inner


@pytest.mark.parametrize("degree", [6, *(pytest.param(n, marks=SLOW) for n in (8, 10, 12))])
def test_counts_differ_on_both_sides_of_every_boundary(degree):
    rng = np.random.default_rng(degree)
    kinds = set()
    for curve in cone.phase_boundaries(degree, lines=60):
        for k in sample(curve, 3, rng):
            nu, ratio = float(curve.rest_elevation[k]), float(curve.ratio[k])
            sides = [counts_of(curve.branches, ratio * (1 + s * SIDE), nu) for s in (-1, 1)]
            assert sides[0] != sides[1], (curve, nu, ratio)
            assert curve.kind == "end" or abs(sum(sides[0]) - sum(sides[1])) == 1
            kinds.add(curve.kind)
    assert {"start", "end"} <= kinds
