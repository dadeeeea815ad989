"""Vertices that are off a special one by 1e-10 to 1e-5: one list, whatever the seed, the numbering and the side."""

import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, find_minima
from tests.minima.test_invariance import DESCRIPTIONS, unmatched

SPECIAL = {
    "hexagon": ((60,) * 6, (1, 2) * 3, (2, -1) * 3),
    "miura": ((60, 60, 120, 120), (1,) * 4, (1, -1, 1, 1)),
    "waterbomb": ((45, 90, 45) * 2, (1, 2, 1) * 2, (-1.5, 1.2, -1.5) * 2),
    "cross": ((90,) * 4, (1,) * 4, (1, 1, -1, 1)),
}
"""Sectors [deg], stiffnesses and rest angles [rad]."""
CASES = {
    "hexagon": (1e-10, 1e-8),
    "miura": (1e-10, 1e-8, 1e-6, 1e-5),
    "waterbomb": (1e-10, 1e-8),
    "cross": (1e-10, 1e-8, 1e-6, 1e-5),
}
QUICK = ("cross", 1e-8), ("miura", 1e-6)


def off(name, by):
    """A special vertex whose sectors, stiffnesses and rest angles are off."""
    sectors, stiffness, rest = map(np.array, SPECIAL[name])
    rng = np.random.default_rng(0)
    a, k, r = (by * rng.uniform(-1, 1, len(sectors)) for _ in range(3))
    a = np.radians(sectors) + a
    vertex = Vertex(tuple((a * (2 * math.pi / a.sum())).tolist()))
    return Scene(
        vertex, tuple((stiffness + k).tolist()), tuple((rest + r).tolist()), "none", "fold-limits"
    )


def listed(scene, seed=0):
    found = find_minima(scene, prove=False, escape=False, seed=seed).minima
    return np.array([m.fold_angles for m in found]).reshape(-1, scene.degree)


@pytest.mark.parametrize(
    ("name", "by"),
    [
        case if case in QUICK else pytest.param(*case, marks=pytest.mark.slow)
        for case in ((name, by) for name, bys in CASES.items() for by in bys)
    ],
)
def test_one_list(name, by):
    scene = off(name, by)
    first = listed(scene)
    assert len(first)
    others = [listed(scene, seed) for seed in range(1, 5)]
    others += [d.back(listed(d.of(scene))) for d in DESCRIPTIONS.values() if d.factor == 1]
    for other in others:
        assert (unmatched(first, other), unmatched(other, first)) == (0, 0)
