"""Proofs with stops: every minimum of a scan is there."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex, examples
from tests.independent import scan_four
from tests.minima.test_stops import drawn


def scanned(scene, samples=6_001):
    """Energies of the minima of a scan."""
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    energy, _ = scan_four.minima(
        lambda x: 0.5 * (x - rest) ** 2 @ k,
        np.array(scene.vertex.sector_angles),
        scene.limit_angles,
        scene.contact,
        samples,
    )
    return sorted(energy)


@pytest.mark.parametrize("contact", ["full", "fold-limits"])
def test_minima_are_proved_to_be_all(contact):
    """The flat state is between the stops, beyond one, or at one."""
    rng = np.random.default_rng(3)
    for at_flat in (False, False, True):
        for flat in (True, False):
            scene = drawn(rng, contact, flat)
            if at_flat:
                limits = list(scene.limits)
                limits[0] = (0.0, 2.0)
                scene = replace(scene, limits=limits)
            result = o.find_minima(scene, prove=True)
            assert result.completeness.status in ("proved", "proved-except-singular")
            assert at_flat or result.completeness.status == "proved"
            ours = [m.energy for m in result.minima]
            assert np.allclose(ours, scanned(scene), atol=1e-2, rtol=2e-3)


def five(seed):
    rng = np.random.default_rng(seed)
    s = rng.uniform(0.7, 1.3, 5)
    return Scene(
        Vertex(tuple(s * 2 * math.pi / s.sum())),
        tuple(np.exp(rng.normal(size=5))),
        tuple(rng.uniform(-math.pi, math.pi, 5)),
        "none",
        "fold-limits",
        limits=np.radians(rng.uniform(30, 150, (5, 2))) * (-1, 1),
    )


def test_two_degrees_of_freedom():
    for seed in range(2):
        assert o.find_minima(five(seed), prove=True).completeness.status == "proved"


def test_symmetric_scenes():
    scene = replace(examples.degree6("pi/3", ratio=0.3), limits=(-1.2, 1.2), contact="fold-limits")
    assert scene.group.name == "D1"
    assert o.find_minima(scene, prove=True).completeness.status.startswith("proved")
