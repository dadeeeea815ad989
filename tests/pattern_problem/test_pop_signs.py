"""On which side of its flat state each interior vertex is, beside states, and where that says nothing."""

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern_problem import PopSigns
from origami_nlp.pattern_states import find_states
from tests.patterns import make_pattern


def test_signs_are_those_of_sums_round_vertices():
    """Summed from the creases' ends, which the package does not look at."""
    found = find_states("yoshimura:2x3", starts=4, escape=False)
    p = found.pattern
    sides = PopSigns(p)
    assert len(sides.vertices) == len(p.vertices) == 2
    for state in found.minima:
        sums = [state.phi[(p.ends == v).any(axis=1)].sum() for v in sides.vertices]
        assert sides.sums(state.phi) == pytest.approx(sums, abs=1e-12)
    signs = {tuple(np.sign(sides.sums(state.phi))) for state in found.minima}
    assert len(signs) == 4  # each vertex up or down


def test_a_vertex_that_is_flat():
    signs = PopSigns(o.examples.pattern("miura", 3, 3))
    around = [list(c) for c in signs.around]
    phi = np.zeros(signs.origami.creases)
    assert signs.flat(phi).all()
    phi[around[0]] = 1.0, -1.0, 0.5, -0.5 + 1e-6
    assert not signs.flat(phi)[0] and signs.is_jump(phi, -phi)


def test_where_signs_say_nothing():
    """More paper than 360 degrees, by a counterexample: sum 0, far from flat."""
    ring = _up_and_down()
    saddle = make_pattern(
        np.vstack([np.zeros(3), ring]), [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)]
    )
    signs = PopSigns(saddle)
    assert signs.vertices == ()
    normals = [np.cross(ring[k - 1], ring[k]) for k in range(4)]
    turns = [np.cross(normals[k], normals[(k + 1) % 4]) @ ring[k] for k in range(4)]
    folds = [
        math.atan2(t / np.linalg.norm(ring[k]), normals[k] @ normals[(k + 1) % 4])
        for k, t in enumerate(turns)
    ]
    assert abs(sum(folds)) < 1e-12 and min(map(abs, folds)) > 0.5


def _up_and_down() -> np.ndarray:
    """Four directions, up and down in turn by one angle: sectors above 90 degrees."""
    turns = np.arange(4) * math.pi / 2
    return np.column_stack([np.cos(turns), np.sin(turns), 0.5 * (-1.0) ** np.arange(4)])
