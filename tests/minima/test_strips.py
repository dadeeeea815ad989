"""Strips of vertices of degree four: every well, against closed forms that share no code with the package."""

import itertools
import math

import numpy as np
import pytest

from origami_nlp.pattern import Pattern, make_pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import find_states, judge
from tests.computed_once import thinned
from tests.independent.strips import Strip
from tests.patterns import strip

CORNERS = [
    [0.0, 0.0], [0.8965535563053896, -0.08030592138255313], [1.030530567092013, 0.5114251104710107],
    [0.31404656886489934, 0.5304176299617941], [-0.173490155935321, -0.504795562190439],
    [0.8496304011220547, -0.6041515626212459], [2.1481285853012095, -0.25302521289567337],
    [1.825092052504891, 0.29059843844011146], [2.1741383049688765, -0.8886979304823559],
    [3.245583776174807, 0.1425438469602201], [3.095531591061124, 0.6570455882139428],
    [3.404634592972366, -0.3827089182097268], [4.013224187242496, -0.14761721062051575],
    [3.7311027538427775, 0.36700876473213534], [3.6946848982516567, -0.6910474627163812],
]  # fmt: skip
FACES = [
    (0, 1, 2, 3), (4, 5, 1, 0), (1, 6, 7, 2), (5, 8, 6, 1), (6, 9, 10, 7), (8, 11, 9, 6), (9, 12, 13, 10),
    (11, 14, 12, 9),
]  # fmt: skip
STIFFNESS = [
    0.07403531585318694, 0.16972018100071867, 0.009055121363920546, 0.004715322299103665, 0.0064305619586019274,
    0.14754461457810322, 0.0033231477725487353, 0.012272090063976782, 0.008431750159207607, 0.005182947851882574,
]  # fmt: skip
REST = [
    0.5952183161596718, -0.06797137542100407, -0.7868251880351648, 1.9210012866878028, -0.7596414514224304,
    2.3390498331862544, 1.6958437191273479, -1.378487883855212, 1.7446911028066694, -1.3817955316280133,
]  # fmt: skip


def _beside_flat(seed: int, far: float) -> tuple[Pattern, np.ndarray]:
    """A strip with springs whose energy has a well so far from the flat state [rad], on one of its curves."""
    pattern = strip(seed, 4, 2)
    form = Strip(pattern)
    signs = tuple(np.random.default_rng(seed).choice([-1, 1], 3).tolist())
    low, high = 0.0, 1.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        beyond = np.abs(form.at(signs, middle)[0]).max() > far
        low, high = (low, middle) if beyond else (middle, high)
    phi, rate = form.at(signs, low)
    k, rest = pattern.stiffness, pattern.rest
    rest = rest + rate * (k * (phi - rest) @ rate) / (k @ rate**2)
    soft = max(
        1.0, np.abs(rest).max() / math.pi
    )  # rest angles beyond pi are none: all come closer to the well
    return pattern.with_springs(list(k), list(phi + (rest - phi) / (1.01 * soft))), phi


def _apart(wells, found) -> list[float]:
    return [min(float(np.abs(x - s.phi).max()) for s in found.minima) for x in wells]


@pytest.mark.parametrize("seed", range(3))
def test_closed_forms_close(seed):
    """Folds of every curve by quaternions, and their derivatives by differences."""
    pattern = strip(seed, 5, 2)
    form, problem = Strip(pattern), PatternProblem(pattern)
    for signs in itertools.product((1, -1), repeat=4):
        for theta in (1e-6, 0.2, -0.4):
            phi, rate = form.at(signs, theta)
            step = 1e-6 * abs(theta)
            ahead, behind = (form.at(signs, theta + s)[0] for s in (step, -step))
            assert problem.residual(phi) < 1e-14
            assert np.abs((ahead - behind) / (2 * step) - rate).max() < 1e-6 * np.abs(rate).max()


@pytest.mark.slow  # nine seconds
def test_a_well_half_a_degree_from_flat():
    """Multipliers are 1.5e5 there, closure's smallest singular value 2.3e-6: it was neither found nor decided."""
    pattern = make_pattern(CORNERS, FACES).with_springs(STIFFNESS, REST)
    wells = sorted(Strip(pattern).wells(), key=lambda x: float(np.abs(x).max()))
    nearest = wells[0]
    flat = float(pattern.energy(np.zeros(pattern.creases)))
    assert np.abs(nearest).max() == pytest.approx(0.0105703312, abs=1e-9)
    assert pattern.energy(nearest) - flat == pytest.approx(-1.224646e-6, abs=1e-11)
    found = find_states(pattern, starts=0, contact=False, escape=False)
    assert max(_apart(wells, found)) < 1e-10
    assert not found.undecided and found.search.stalled == 0
    assert found.search.resolved == found.search.wells >= len(wells)
    assert found.search.every_well
    state = next(s for s in found.minima if np.abs(s.phi - nearest).max() < 1e-9)
    problem = PatternProblem(pattern)
    both = [judge(problem, state.phi, contact) for contact in (True, False)]
    assert [s.verdict for s in both] == ["minimum"] * 2
    assert [s.kind for s in both] == ["interior"] * 2


def _is_whole(pattern: Pattern, known: np.ndarray) -> bool:
    """Whether the search says that it judged every well; if it does, it lists those of the closed form."""
    found = find_states(pattern, starts=0, contact=False, escape=False)
    wells = list(Strip(pattern).wells())
    assert min(np.abs(x - known).max() for x in wells) < 1e-3 * np.abs(known).max()
    claims = found.search.every_well
    inside = [s for s in found.minima if np.abs(s.phi).max() < math.pi - 1e-9]
    if claims:
        assert max(_apart(wells, found)) < 1e-9 and len(inside) == len(wells)
    else:
        assert found.search.resolved < found.search.wells
    return claims


@pytest.mark.slow  # nine seconds
@pytest.mark.parametrize("far", thinned([1.5e-5, 3e-4], 2))
def test_wells_beside_the_flat_state(far):
    """Listed down to some 1e-4 rad; nearer than can be distinguished from flat, no list is said to be whole."""
    assert _is_whole(*_beside_flat(1, far)) == (far > 1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_wells_of_random_strips(seed):
    """Near flat at several distances, and where the springs put them."""
    for far in (0.1, 1e-2, 1e-3, 3e-4, 1e-4, 3e-5, 1.5e-5, 5e-6):
        assert _is_whole(*_beside_flat(seed, far)) or far < 1e-2
