"""Energy landscapes against direct evaluation, closure, an independent search, and contact."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st

import origami_nlp as o
from origami_nlp.chart import chart_of, fold_vertex, landscape
from origami_nlp.pattern import double_well
from origami_nlp.pattern_problem import check_admissible, pose
from tests.closed_states import closed_states
from tests.computed_once import thinned

CLOSURE = 1e-12  # |vec q| of completed states, away from the places where charts end
SIZE = 61


def degree6_scene(a1, a2, ratio, contact="full"):
    a3 = math.pi - a1 - a2
    k = (1.0, ratio, 0.5, 2.0, 0.5, ratio)
    rest = (-1.0, 0.7, 1.3, -2.0, 1.3, 0.7)
    return o.Scene(o.Vertex((a1, a2, a3, a3, a2, a1)), k, rest, "D1", contact)


def wedge_scene(n, share, contact="full"):
    a1 = share * math.pi / n
    a2 = math.pi / n - a1
    vertex = o.Vertex((a1, a2, a2, a1) * n)
    k, rest = (1.0, 2.0, 0.5, 2.0) * n, (-1.0, 0.7, -0.5, 0.7) * n
    return o.Scene(vertex, k, rest, f"D{n}", contact, mirror=1)


def check_cells(chart, rng, count=40):
    """Random admissible cells close, are admissible, sit where they say, and have the energy they say."""
    scene = chart.scene
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    checked = 0
    for b, branch in enumerate(chart.branches):
        rows, columns = np.nonzero(np.isfinite(branch.energy))
        if not len(rows):
            continue
        for pick in rng.integers(len(rows), size=count):
            r, c = rows[pick], columns[pick]
            phi = branch.fold_angles[r, c]
            _, q = fold_vertex(scene.vertex, phi)
            assert np.linalg.norm(q[1:]) < CLOSURE and q[0] > 0
            assert branch.energy[r, c] == pytest.approx(0.5 * k @ (phi - rest) ** 2, rel=1e-13)
            if scene.contact == "full":
                assert check_admissible(scene.vertex, phi).admissible
            place = chart.place(phi)
            if not phi.any():  # the flat state lies on every branch
                there = chart_of(scene).fold_angles(place.branch, *map(np.array, place.point))
                assert np.abs(there).max() < CLOSURE
            else:
                assert place.branch == b
            assert place.point == pytest.approx((branch.axes[0][c], branch.axes[1][r]), abs=1e-9)
            checked += 1
    return checked


@settings(max_examples=3)
@given(
    a1=st.floats(0.3, 1.3),
    a2=st.floats(0.3, 1.3),
    ratio=st.floats(0.1, 10),
    seed=st.integers(0, 2**31),
)
def test_degree6_cells(a1, a2, ratio, seed):
    chart = landscape(degree6_scene(a1, a2, ratio), SIZE)
    assert chart.coordinates == ("phi_2", "phi_3")
    assert check_cells(chart, np.random.default_rng(seed)) > 0


@settings(max_examples=3)
@given(
    n=st.sampled_from([2, 3, 4]),
    share=st.floats(0.15, 0.85),
    contact=st.sampled_from(["full", "fold-limits"]),
    seed=st.integers(0, 2**31),
)
@example(n=3, share=0.765625, contact="full", seed=8)  # a cell is the flat state itself
def test_wedge_cells(n, share, contact, seed):
    chart = landscape(wedge_scene(n, share, contact), SIZE)
    assert len(chart.branches) == 2
    assert check_cells(chart, np.random.default_rng(seed)) > 0


CURVE_SCENES = {
    "degree 4, D1": o.Scene(
        o.Vertex(("pi/3", "2*pi/3", "2*pi/3", "pi/3")), (1,) * 4, (1, 1, -1, 1), "D1"
    ),
    "degree 4, none": o.Scene(
        o.Vertex(("pi/3", "2*pi/3", "pi/2", "pi/2")), (1,) * 4, (1, 1, -1, 1), "none"
    ),
    "degree 5, D1": o.Scene(
        o.Vertex(("pi/3", "pi/3", "2*pi/3", "pi/3", "pi/3")), (1,) * 5, (1, -1, 1, 1, -1), "D1"
    ),
    "degree 6, D3": o.Scene(o.Vertex(("pi/3",) * 6), (1,) * 6, (1, -1) * 3, "D3"),
}


@pytest.mark.parametrize("name", thinned([*CURVE_SCENES], 2))
def test_curves(name):
    """Traced states close, and states found otherwise lie on a curve."""
    scene = CURVE_SCENES[name]
    chart = landscape(scene, 201)
    assert chart.kind == "curve"
    every = np.concatenate([b.fold_angles for b in chart.branches])
    every = every[np.isfinite(every).all(axis=1)]
    _, q = fold_vertex(scene.vertex, every)
    assert np.linalg.norm(q[:, 1:], axis=1).max() < 1e-11
    assert all(check_admissible(scene.vertex, phi).admissible for phi in every[::25])
    for b in chart.branches:
        np.testing.assert_allclose(b.energy, scene.energy(b.fold_angles), rtol=1e-13)
    model = pose(scene)
    starts = closed_states(model, np.random.default_rng(11), 200, at_limits=False)
    free = [model.expand(x) for x in starts if np.abs(x).max() < 3.1]
    inside = [phi for phi in free if check_admissible(scene.vertex, phi).admissible]
    assert inside
    for phi in inside:
        # states of one orbit count once: sqrt(N) is the most by which the distance grows
        reach = 4 * math.pi / 201 * math.sqrt(scene.degree)
        assert np.linalg.norm(every - phi, axis=1).min() < reach
    for m in o.find_minima(scene, prove=False, escape=False).minima:
        assert chart.place(m.fold_angles).point[1] == pytest.approx(m.energy, rel=1e-12)


def test_scenes_without_a_chart_say_why():
    chart = landscape(o.Scene(o.Vertex(("pi/5",) * 10), (1,) * 10, (0.5,) * 10, "D1"))
    assert chart.kind == "none" and not chart.branches and "4 degrees of freedom" in chart.reason
    with pytest.raises(o.OrigamiError, match="no landscape"):
        chart.place([0.0] * 10)


def test_landscapes_show_the_energy_of_laws_between_stops():
    plain = o.examples.degree6("5*pi/12", 2)
    wells = replace(plain, laws=(double_well(0.1, 1.0), None, None) * 2)
    (branch,), (held,) = (
        landscape(s, 48).branches for s in (wells, replace(wells, limits=(-1.0, 1.0)))
    )
    phi = branch.fold_angles
    by_hand = 0.5 * np.array(plain.stiffness) * (phi - np.array(plain.rest_angles)) ** 2
    by_hand[..., [0, 3]] = 0.1 * (phi[..., [0, 3]] ** 2 - 1) ** 2
    assert np.allclose(branch.energy, by_hand.sum(axis=-1), atol=1e-6, equal_nan=True)
    within = (np.abs(phi) <= 1.0).all(axis=-1)
    assert np.array_equal(np.isfinite(held.energy), within & np.isfinite(branch.energy))
