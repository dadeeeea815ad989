"""Scenes made symmetric within a tolerance are exactly so, say by how much, and are left alone when stated again."""

import math
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, format_scene, parse_scene

SECTORS = np.array([59.4, 60.9, 60.2, 59.1, 60.6, 60.3])
REST = np.radians([-170, 95, 88, -172, 91, 93])
STIFFNESS = (0.026, 0.024, 0.025, 0.025, 0.026, 0.025)


def measured(symmetry, degrees):
    vertex = Vertex.from_degrees(SECTORS * 360 / SECTORS.sum())
    return Scene(vertex, STIFFNESS, REST, symmetry, symmetry_tolerance=math.radians(degrees))


def images(values, elements, facets):
    """Values of creases, or of the facets from crease i on, as each element of a group carries them, by loops."""
    n = len(values)
    for s, mirrored in elements:
        out = [0.0] * n
        for i in range(n):
            out[(s - i - facets) % n if mirrored else (i + s) % n] = values[i]
        yield out


def asymmetry(scene):
    """Largest difference between a scene and its images under the group that it claims."""
    parts = [(scene.vertex.sector_angles, 1), (scene.rest_angles, 0), (scene.stiffness, 0)]
    return max(
        float(np.abs(np.subtract(image, values)).max())
        for values, facets in parts
        for image in images(values, scene.group.elements, facets)
    )


@pytest.mark.parametrize("degrees", [4.0, 4.9, 5.05, 5.5])
@pytest.mark.parametrize("symmetry", ["auto", "D1"])
def test_what_claims_a_symmetry_has_it(symmetry, degrees):
    # at 4.9 degrees one mirror is shared; once averaged over it, the half turn comes within the tolerance as well
    scene = measured(symmetry, degrees)
    assert scene.group.name in ("D1", "D2") and asymmetry(scene) < 1e-13
    changes = np.abs(np.subtract(scene.rest_angles, REST)).max()
    assert scene.adjusted >= changes > 1e-3
    assert replace(scene).rest_angles == scene.rest_angles  # stated again: nothing left to do
    assert parse_scene(format_scene(scene)) == scene and replace(scene).group == scene.group


def test_random_noise_at_every_tolerance():
    rng = np.random.default_rng(5)
    seen = set()
    for _ in range(150):
        n = int(rng.choice([4, 6, 8]))
        noise = rng.normal(scale=0.01, size=(3, n))
        sectors = 2 * math.pi / n + noise[0]
        period = int(rng.choice([1, 2]))
        rest = np.resize(rng.uniform(-2, 2, period), n) + noise[1]
        k = np.exp(noise[2])
        tolerance = float(rng.uniform(0.005, 0.08))
        vertex = Vertex(tuple(sectors * 2 * math.pi / sectors.sum()))
        scene = Scene(vertex, k, rest, "auto", "fold-limits", symmetry_tolerance=tolerance)
        seen.add(scene.group.name)
        assert asymmetry(scene) < 1e-13
        order = len(scene.group.elements)
        assert order == scene.group.order * (2 if scene.group.kind == "D" else 1)
    assert len(seen) > 4
