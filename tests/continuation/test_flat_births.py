"""Minima that come out of the flat state: when, by a second formula; found between checks; over two parameters."""

from __future__ import annotations

import numpy as np
import pytest

import origami_nlp as o
from benchmarks import random_vertex
from origami_nlp.continuation import BifurcationDiagram, flat_roots
from origami_nlp.paths import family_of, parse_parameter_range


def drawn(seed, degree):
    return random_vertex(np.random.default_rng(seed), degree, "full")


def tip(scene):
    """g' Q^-1 g on the kernel of closure at flat: sum phi c = 0, and sum_{i<j} phi_i phi_j (c_i x c_j) = 0 beyond."""
    angles = np.cumsum([0.0, *scene.vertex.sector_angles[:-1]])
    rays = np.array([np.cos(angles), np.sin(angles)])
    across = np.triu(np.sin(angles[None] - angles[:, None]), 1)
    k = np.array(scene.stiffness)
    preload = np.array(scene.preload or np.zeros(len(k)))
    kernel = np.linalg.svd(rays)[2][2:].T
    q = kernel.T @ (across + across.T) @ kernel
    g = kernel.T @ -(k * np.array(scene.rest_angles) + preload)
    return float(g @ np.linalg.solve(q, g))


def roots_by_signs(scene, text, count=4001):
    """Where that changes its sign, on a fine grid and by bisection, in what is followed."""
    parameter = parse_parameter_range(text)
    family = family_of(scene, parameter)

    def value(s):
        return tip(family.scene_of(parameter.t_of(s)))

    grid = np.linspace(parameter.s_of(parameter.low), parameter.s_of(parameter.high), count)
    values = np.array([value(s) for s in grid])
    out = []
    for k in np.flatnonzero(values[1:] * values[:-1] < 0):
        low, high = grid[k], grid[k + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if value(middle) * values[k] > 0 else (low, middle)
        out.append(low)
    return out


LINES = [
    (drawn(70001, 5), "rest_angles[1]=-2:2"),
    (drawn(80115, 5), "rest_angles[4]=-1:2"),
    (drawn(9022, 5), "stiffness[1]=0.05:20"),
    (drawn(80162, 6), "torque[1]=-1:3"),
    (drawn(9018, 4), "rest_angles[2]=-3:3"),
    (drawn(9014, 6), "sector_angles[1]=0.7:1.2"),
]


@pytest.mark.parametrize(("scene", "text"), LINES, ids=[text for _, text in LINES])
def test_when_curves_pass_the_flat_state(scene, text):
    parameter = parse_parameter_range(text)
    found = flat_roots(
        family_of(scene, parameter).line,
        parameter.s_of(parameter.low),
        parameter.s_of(parameter.high),
    )
    assert len(found) > 0
    assert [s for s, _ in found] == pytest.approx(roots_by_signs(scene, text, 101), abs=1e-9)


def test_nothing_passes_where_there_is_no_flat_state():
    cone = o.Scene(o.Vertex((1.2,) * 5, False), (1.0,) * 5, (0.1, 0.2, 0.3, 0.4, 0.5))
    assert not flat_roots(family_of(cone, parse_parameter_range("torque[1]=-1:1")).line, -1.0, 1.0)


BETWEEN = drawn(90035, 5), "torque[2]=-9:3.4"
"""Between -2.46 and 2.04 a minimum comes out of the flat state and goes back."""


def test_a_minimum_that_comes_out_of_the_flat_state_is_followed_without_a_search():
    scene, text = BETWEEN
    parameter = parse_parameter_range(text)
    family = family_of(scene, parameter)
    web = BifurcationDiagram(family.line, parameter.low, parameter.high)
    web.add_flat()
    born, gone = roots_by_signs(scene, text, 101)
    flat = sorted(n.s for n in web.nodes if not n.point[:-1].any())
    assert flat == pytest.approx([born, gone], abs=1e-9)
    assert all(n.located and n.type == "singular" for n in web.nodes if n.s in flat)
    low, high = (sorted(a.low for a in web.arcs), sorted(a.high for a in web.arcs))
    assert {*flat} <= {*low} and {*flat} <= {*high}  # arcs end there, on both sides
    near = [
        [f.state for _, f in web.states_at(s + d) if not f.index and np.abs(f.state).max() < 0.2]
        for s in flat
        for d in (-0.1, 0.1)
    ]
    assert [len(states) for states in near] == [0, 1, 1, 0]
    for s, (state,) in zip((born + 0.1, gone - 0.1), near[1:3], strict=True):
        found = o.find_minima(family.scene_of(s), prove=False, max_starts=24, escape=False).minima
        apart = [np.abs(state - m.fold_angles).max() for m in found]
        assert min(apart) < 1e-8
