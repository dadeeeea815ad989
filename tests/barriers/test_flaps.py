"""The bound for handles: every step of the proof in `barriers.flaps` a second way."""

import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from origami_nlp.barriers.flaps import flap_exit
from origami_nlp.barriers.full import exits, proved_exit
from origami_nlp.folding import check_admissible
from origami_nlp.kkt import State, lower_dimensional_at
from origami_nlp.minima import full_scene
from origami_nlp.pattern import Scene, Vertex, examples
from origami_nlp.problem import Model
from tests.independent import rotations

PI = math.pi
UNEQUAL = (0.9, 1.2, 1.2, PI - 2.1, PI - 2.1, 0.9)
"""Pairs of equal sectors about creases 1, 3 and 5, not all equal."""


def three_flaps(hinges, first=0, side=-1):
    """All six fold angles of three fully folded flaps with given angles about the axis."""
    phi = np.full(6, side * PI)
    phi[(np.arange(first, 6, 2) + 1) % 6] = hinges
    return phi


def polygon(rng, side=-1):
    """Random hinge angles on sum = -side pi, |angle| <= pi."""
    while True:
        two = rng.uniform(-PI, PI, 2)
        third = -side * PI - two.sum()
        if abs(third) <= PI:
            return np.array([*two, third])


def opened(sectors, phi, at_limit, most=1e-3):
    """Open the fully folded creases by `most` in all, near by: (closure left over per `most`, least share), best found.

    Shares below zero are beyond the fold limit: bounded at 0 first, then free.
    """
    side = np.sign(phi[at_limit[0]])
    free = [k for k in range(6) if k not in at_limit]

    def residual(z):
        x = phi.copy()
        x[at_limit] -= side * most * z[:3]
        x[free] += z[3:]
        turn = rotations.rotation_vector(rotations.fold(sectors, x)[1])[0]
        return np.array([*turn / most, z[:3].sum() - 1])

    low, high = np.repeat([0.0, -0.01], 3), np.repeat([1.0, 0.01], 3)
    start = np.repeat([1 / 3, 0.0], 3)
    bounded = least_squares(residual, start, bounds=(low, high), x_scale=high)
    polished = least_squares(residual, bounded.x, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    return np.abs(bounded.fun).max(), np.abs(polished.fun).max(), polished.x[:3].min()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sectors", "side"),
    [
        (UNEQUAL, -1),
        pytest.param(UNEQUAL, 1, marks=pytest.mark.slow),
        pytest.param((PI / 3,) * 6, -1, marks=pytest.mark.slow),
        pytest.param((PI / 3,) * 6, 1, marks=pytest.mark.slow),
    ],
)
def test_the_set_closes_on_its_plane_and_opens_only_where_no_gap_is_wide(sectors, side):
    """Closure by rotation matrices: fully folded flaps cannot open where s phi(h_j) > 0 for some j, else they can."""
    rng = np.random.default_rng(side + 1)
    at_limit, sectors = np.array([0, 2, 4]), np.array(sectors)
    seen = {True: 0, False: 0}
    for _ in range(24):
        hinges = polygon(rng, side)
        phi = three_flaps(hinges, 0, side)
        _, m = rotations.fold(sectors, phi)
        assert np.abs(m[0] - np.eye(3)).max() < 1e-14 and rotations.spin_sign(sectors, phi)[0] == 1
        off = phi + 0.1 * np.eye(6)[1]  # off the plane nothing closes
        assert np.abs(rotations.fold(sectors, off)[1][0] - np.eye(3)).max() > 1e-3
        if np.abs(hinges).min() < 0.05:
            continue
        thin = bool((side * hinges > 0).any())
        assert (side * hinges > 0).sum() <= 1
        within, anyhow, least = opened(sectors, phi, at_limit)
        if thin:
            assert within > 1e-3, hinges
        else:
            assert anyhow < 1e-11 and least > 0, hinges
        seen[thin] += 1
    assert min(seen.values()) > 5


def test_the_package_calls_the_same_states_thin():
    model = Model(full_scene(examples.degree6("pi/3", 1)))
    rng = np.random.default_rng(5)
    thin = 0
    for _ in range(40):
        hinges = polygon(rng)
        phi = three_flaps(hinges)
        if np.abs(hinges).min() < 0.05 or not check_admissible(model.scene.vertex, phi).admissible:
            continue
        found = flap_exit(model.scene, phi)
        assert (found is not None) == bool(lower_dimensional_at(State(model, phi)))
        if found:
            assert found.at_limit == (1, 3, 5) and hinges[found.hinge // 2 - 1] < 0
            thin += 1
    assert thin > 5


@pytest.mark.parametrize("side", [-1, 1])
def test_the_bound_is_the_least_energy_of_the_segment(side):
    """Random springs, by a fine scan of the segment."""
    rng = np.random.default_rng(3)
    for _ in range(30):
        first = int(rng.integers(2))
        sectors = np.roll(UNEQUAL, first)
        stiffness, rest = 10 ** rng.uniform(-2, 1, 6), rng.uniform(-PI, PI, 6)
        scene = Scene(Vertex(tuple(sectors)), tuple(stiffness), tuple(rest), "none", "full")
        hinges = side * np.array([0.8, -1.4, -PI + 0.6])
        found = flap_exit(scene, three_flaps(hinges, first, side))
        x = -side * np.linspace(0, PI, 20001)
        path = np.tile(three_flaps(np.zeros(3), first, side), (len(x), 1))
        others = [h for h in (np.arange(first, 6, 2) + 1) % 6 if h != found.hinge - 1]
        path[:, others[0]], path[:, others[1]] = x, -side * PI - x
        scanned = scene.energy(path)
        assert found.energy <= scanned.min() * (1 + 1e-14)
        assert scanned.min() - found.energy <= 1e-7 * max(stiffness) * PI**2
        _, m = rotations.fold(np.array(sectors), found.fold_angles)
        assert np.abs(m[0] - np.eye(3)).max() < 1e-14


@pytest.mark.parametrize("ratio", [0.01, 1.0, 100.0])
def test_the_symmetric_end_of_the_handles_is_the_proved_exit(ratio):
    """(-pi, pi/2, -pi, 0, -pi, pi/2) and its image."""
    scene = examples.degree6("pi/3", ratio)
    model = Model(full_scene(scene))
    for first, state in ((0, [150, -120, 150]), (1, [150, 150, -120])):
        phi = three_flaps(np.radians(state), first)
        found = proved_exit(model, phi)
        wanted = three_flaps(np.where(np.array(state) < 0, 0.0, PI / 2), first)
        np.testing.assert_allclose(found.state, wanted, atol=1e-15)
        assert found.lowest == pytest.approx(scene.energy(wanted), rel=1e-14)
        assert "proved" in found.proof and found.dimension == 2
    if ratio != 1:
        return
    # samples of the second set, which know no proof, find none lower
    sampled = exits(State(model, phi), spacing=PI / 4)
    assert sampled.complete and not sampled.proof and sampled.held == found.held
    assert sampled.lowest >= found.lowest * (1 - 1e-9)


def test_states_elsewhere_have_no_such_exit():
    scene = examples.degree6("pi/3", 1)
    assert flap_exit(scene, np.zeros(6)) is None
    assert flap_exit(scene, three_flaps([PI / 3] * 3)) is None  # not thin: all gaps below pi
    assert flap_exit(scene, three_flaps([0.0, PI / 2, PI / 2])) is None  # the end itself
    assert flap_exit(scene, three_flaps([2.0, 2.0, -1.0])) is None  # does not close
    thin = three_flaps([2.5, 2.5, PI - 5.0])
    assert flap_exit(scene, thin) is not None
    assert flap_exit(examples.degree6("pi/4", 1), thin) is None  # flaps do not close
    free = examples.degree6("pi/3", 1, contact="none")
    assert flap_exit(free, thin) is None
    assert flap_exit(examples.degree8("pi/4", 1), np.zeros(8)) is None
