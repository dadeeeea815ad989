"""Hinge laws with two degrees of freedom, in strips and on sheets, against searches that share no code."""

from __future__ import annotations

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex
from tests.independent import search_slsqp
from tests.minima.test_laws_scanned import drawn


def compared(scene, energies, tie, starts, rng):
    """Minima of a search, and those of another one that are none of them, with their energies."""
    ours = np.array([m.fold_angles for m in o.find_minima(scene).minima])

    def energy(phi):
        return sum(f(phi[i]) for i, f in enumerate(energies))

    theirs = search_slsqp.minima(
        energy, np.array(scene.vertex.sector_angles), scene.limit_angles, tie, starts, rng
    )
    apart = np.abs(ours[:, None] - theirs[None]).max(axis=2)
    return ours, theirs[apart.min(axis=0, initial=9.0) > 2e-2], energy


def five(rng):
    a = rng.uniform(0.7, 1.3, 5)
    laws, energies = zip(*(drawn(rng) for _ in range(5)), strict=True)
    vertex = Vertex(tuple(a * 2 * math.pi / a.sum()))
    scene = Scene(vertex, (1,) * 5, (0,) * 5, "none", "fold-limits", laws=laws)
    return scene, energies, np.arange(5)


def six(rng):
    """Symmetric about creases 1 and 4."""
    some, energies = zip(*(drawn(rng) for _ in range(4)), strict=True)
    tie = np.array([0, 1, 2, 3, 2, 1])
    a, b = rng.uniform(0.7, 1.3, 2)
    vertex = Vertex((a, b, math.pi - a - b, math.pi - a - b, b, a))
    laws = tuple(some[v] for v in tie)
    scene = Scene(vertex, (1,) * 6, (0,) * 6, "D1", "fold-limits", laws=laws)
    return scene, tuple(energies[v] for v in tie), tie


@pytest.mark.slow
@pytest.mark.parametrize(("make", "count"), [(five, 20), (six, 10)])
def test_another_search_finds_no_other_minimum(make, count):
    rng = np.random.default_rng(4)
    for _ in range(count):
        ours, others, _ = compared(*make(rng), starts=60, rng=rng)
        assert len(ours) and not len(others)
