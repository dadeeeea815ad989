"""Vertices the paper leaves out: odd degrees, degree 3, paper that does not lie flat, noisy data.

Second ways: spherical trigonometry for degree 3, the closed-form branches of flat-foldable degree-4
vertices scanned densely, rotation matrices for closure, random perturbations for minima.
"""

import math

import numpy as np
import pytest

from origami_nlp import OrigamiError, Scene, Vertex, find_minima, format_scene, parse_scene
from tests.computed_once import thinned
from tests.independent.rotations import fold, spin_sign
from tests.minima.test_minima_of_random_vertices import check

DEG = math.pi / 180


def some(first, every):
    """Seeds, all but the first few behind `-m slow`."""
    return [pytest.param(k, marks=[pytest.mark.slow] if k >= first else []) for k in range(every)]


def triangle_fold_angles(a):
    """Exterior angles of the spherical triangle whose sides are the sector angles (cosine rule).

    Crease i lies between sectors i - 1 and i; the side opposite it is sector i + 1.
    """
    out = []
    for i in range(3):
        b, c, opposite = a[i - 1], a[i], a[(i + 1) % 3]
        cosine = (math.cos(opposite) - math.cos(b) * math.cos(c)) / (math.sin(b) * math.sin(c))
        out.append(math.pi - math.acos(cosine))
    return np.array(out)


@pytest.mark.parametrize("sectors", [(80, 70, 60), (100, 90, 120), (20, 170, 160), (1, 1.2, 0.9)])
def test_degree_three_is_rigid(sectors):
    a = np.array(sectors) * DEG
    scene = Scene(Vertex(tuple(a), flat=False), (1, 2, 3), (0.3, 0.2, -0.1))
    found = sorted(
        find_minima(scene, prove=False, escape=False).minima, key=lambda m: m.fold_angles[0]
    )
    exact = triangle_fold_angles(a)
    assert len(found) == 2  # convex from above and from below
    for m, sign in zip(found, (-1, 1), strict=True):
        np.testing.assert_allclose(m.fold_angles, sign * exact, atol=1e-12)
        assert m.local_dimension == 0


def test_a_flat_vertex_of_degree_three_stays_flat():
    (flat,) = find_minima(
        Scene(Vertex(("2*pi/3",) * 3), (1, 2, 3), (0.3, 0.2, -0.1)), prove=False
    ).minima
    assert not any(flat.fold_angles) and flat.local_dimension == 0


# ---------------------------------------------------------------- degree 4


def kawasaki_branches(a, b, t):
    """Fold angles [m, 4] of both branches of the vertex (a, b, pi - a, pi - b), t = tan(phi/2) of one crease.

    Flat-foldable degree 4: opposite creases are equal or opposite, and tan-half-angles keep a ratio
    (fold-angle multipliers): on one branch phi_1 = -phi_3, phi_2 = phi_4, on the other phi_1 = phi_3.
    """
    one = math.sin((a - b) / 2) / math.sin((a + b) / 2)
    two = math.cos((a + b) / 2) / math.cos((a - b) / 2)
    full, first, second = (2 * np.arctan(v) for v in (t, one * t, two * t))
    return (
        np.stack([first, full, -first, full], axis=1),
        np.stack([full, -second, full, second], axis=1),
    )


@pytest.mark.parametrize("seed", some(2, 6))
def test_degree_four_against_its_closed_form(seed):
    rng = np.random.default_rng(seed)
    while True:
        a, b = rng.uniform(0.5, 2.6, 2)
        if abs(a - b) > 0.2 and abs(a + b - math.pi) > 0.2:
            break
    sectors = (a, b, math.pi - a, math.pi - b)
    t = np.tan(np.linspace(-math.pi / 2, math.pi / 2, 4001)[1:-1])
    branches = kawasaki_branches(a, b, t)
    for phi in branches:
        closed = np.abs(fold(np.array(sectors), phi)[1] - np.eye(3)).max()
        assert closed < 1e-12
    scene = Scene(
        Vertex(sectors), 10.0 ** rng.uniform(-1, 1, 4), rng.uniform(-2, 2, 4), "none", "fold-limits"
    )
    result = find_minima(scene, prove=False, escape=False)
    for m in result.minima:
        # +pi and -pi are one shape: angles are compared on the circle
        tan = np.tan(np.clip(np.array(m.fold_angles), -math.pi, math.pi) / 2)
        lead = [tan[1], tan[0]]
        away = [
            np.abs(
                2 * np.sin((kawasaki_branches(a, b, np.array([v]))[k][0] - m.fold_angles) / 2)
            ).max()
            for k, v in enumerate(lead)
        ]
        assert min(away) < 1e-10
    # a dense scan of both branches finds the same interior minima, and no others
    best = []
    for phi in branches:
        u = np.asarray(scene.energy(phi))
        low = np.flatnonzero((u[1:-1] < u[:-2]) & (u[1:-1] <= u[2:])) + 1
        best += [phi[k] for k in low if np.abs(phi[k]).max() > 5e-3]  # the flat state joins both
    flat = [m for m in result.minima if not np.abs(m.fold_angles).max() > 5e-3]
    inside = [m for m in result.minima if m.kind == "interior" and m not in flat]
    assert len(best) == len(inside)
    for phi in best:
        assert (
            min(np.abs(np.array(m.fold_angles) - phi).max() for m in inside) < 3e-3
        )  # the scan's step


# ---------------------------------------------------------------- any degree, not flat


def not_flat(rng, n, share):
    while True:
        a = 0.15 + rng.dirichlet(np.full(n, 2.0)) * (2 * math.pi * (1 + share) - 0.15 * n)
        if a.max() < 2.9 and 2 * a.max() < a.sum() - 0.05:
            return a


@pytest.mark.parametrize(
    ("n", "share"),
    [
        *((4, -0.2), (5, 0.2)),
        *(
            pytest.param(*p, marks=pytest.mark.slow)
            for p in ((4, 0.2), (5, -0.2), (6, -0.2), (6, 0.2))
        ),
    ],
)
def test_minima_of_vertices_that_are_not_flat(n, share):
    rng = np.random.default_rng([n, int(100 * (share + 1))])
    k, rest = 10.0 ** rng.uniform(-0.5, 0.5, n), rng.uniform(-2.5, 2.5, n)
    scene = Scene(Vertex(tuple(not_flat(rng, n, share)), flat=False), k, rest, "none", "full")
    assert check(scene, 100, 60)


@pytest.mark.parametrize(("order", "name"), [(3, "D3"), (2, "D2"), (1, "D1")])
@pytest.mark.parametrize("share", thinned([-0.2, 0.2], 2))
def test_symmetric_states_of_vertices_that_are_not_flat(order, name, share):
    """The wedge of D_n, unrolled at another angle, gives states that close all around."""
    wedge = math.pi * (1 + share) / order
    half = [0.4 * wedge, 0.6 * wedge] if order > 1 else [0.3 * wedge, 0.5 * wedge, 0.2 * wedge]
    sectors = tuple(half + half[::-1]) * order
    rng = np.random.default_rng(order)
    ends = rng.uniform(-2, 2, len(half) + 1)
    rest = tuple([*ends, *ends[-2:0:-1]] * order)
    scene = Scene(Vertex(sectors, flat=False), (1.0,) * len(sectors), rest, name)
    assert scene.group.name == name
    result = find_minima(scene, prove=False, escape=False)
    assert result.minima
    for m in result.minima:
        phi = np.array(m.fold_angles)
        assert np.abs(fold(np.array(sectors), phi)[1][0] - np.eye(3)).max() < 1e-13
        assert spin_sign(np.array(sectors), phi)[0] == 1


# ---------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    ("sectors", "flat", "words"),
    [
        ((1.0, 1.0, 1.0), True, ["sector_angles", "missing"]),
        ((1.0, 1.0, 2.2), False, ["cannot close"]),
        ((2.4, 2.4, 2.4), False, ["cannot close", "3 largest"]),
        (("2*pi/3",) * 3, False, ["lies flat"]),
        ((1.0, 1.0), False, ["3 at least"]),
        ((1.0, 1.0, 1.0), "no", ["flat"]),
        ((1.0, 1.0, 3.2), False, ["sector_angles[3]", "below"]),
    ],
)
def test_vertices_that_cannot_be_made(sectors, flat, words):
    with pytest.raises(OrigamiError) as error:
        Vertex(sectors, flat)
    assert all(word in str(error.value) for word in words), error.value
    assert "\n" not in str(error.value)


# ---------------------------------------------------------------- noisy data


def test_scenes_that_are_not_flat_are_written_and_read():
    scene = Scene(Vertex((1.2, 1.3, 1.1, 1.4), flat=False), (1,) * 4, (0.4,) * 4, "none")
    assert parse_scene(format_scene(scene)) == scene
    assert "not flat" in str(scene)
