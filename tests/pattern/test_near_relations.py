"""Sector angles next to special relations are decided once: neither reading them again nor other labels move them."""

import numpy as np
import pytest

from origami_nlp import Scene, Vertex
from origami_nlp.proof import ReducedVertex, gaps_of
from tests.relabelled_vertex import Relabelling


def near(seed, size):
    """Equal sectors but for noise of some size [rad]."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(4, 8))
    noise = size * rng.uniform(-1, 1, n)
    return tuple(2 * np.pi / n + noise - noise.mean())


@pytest.mark.parametrize("size", [1e-7, 3e-7, 1e-5, 1e-4])
def test_other_labels_name_the_same_vertex_and_the_same_gaps(size):
    for seed in range(25):
        sectors = near(seed, size)
        n = len(sectors)
        scene = Scene(Vertex(sectors), (1.0,) * n, tuple(0.1 * k for k in range(n)), "none")
        labels = Relabelling(seed % n, bool(seed % 2), bool(seed % 3))
        other, creases, facets = labels.of(scene), labels.creases(n), labels.facets(n)
        moved = np.subtract(
            np.array(scene.vertex.sector_angles)[facets], other.vertex.sector_angles
        )
        assert np.abs(moved).max() == 0
        theirs = {
            (creases[k], facets[j])
            for k, j in (gap.rays for gap in gaps_of(ReducedVertex(other))[0])
        }
        assert theirs == {gap.rays for gap in gaps_of(ReducedVertex(scene))[0]}
