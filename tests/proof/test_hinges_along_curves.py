"""Strips with stops and hinge laws: proved lists against a scan that shares no code."""

import math

import numpy as np
import pytest
from flint import arb

import origami_nlp as o
from origami_nlp.errors import OptionError
from origami_nlp.pattern import HingeLaw, detent, double_well, linear, one_sided, sum_of, well
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import judge
from origami_nlp.proof import why_no_sheet
from origami_nlp.proof.sheets import LawBalls
from tests.computed_once import prove_sheet
from tests.independent.strips import StripOfHinges
from tests.patterns import strip


def drawn(seed, vertices):
    """A strip with stops on some creases, laws on some."""
    rng = np.random.default_rng(seed)
    pattern = strip(seed, vertices + 1, 2)
    stopped = rng.random(pattern.creases) < 0.5
    limits = [
        (-a, b) if s else (-math.pi, math.pi)
        for s, (a, b) in zip(stopped, rng.uniform(0.3, 2.9, (pattern.creases, 2)), strict=True)
    ]
    k, rest = pattern.stiffness.tolist(), pattern.rest.tolist()
    laws = [
        [
            None,
            double_well(energy=a, at=1.2, centre=b / 3),
            sum_of([linear(a, b), detent(0.4 * a, 5, 0.3)]),
            sum_of([linear(a, b), well(a, b / 2, 0.2)]),
            sum_of([linear(a, b), one_sided(20.0 * a, 1.0)]),
        ][rng.integers(5)]
        for a, b in zip(k, rest, strict=True)
    ]
    if seed % 3 != 1:
        pattern = pattern.with_limits(limits)
    return pattern.with_laws(laws) if seed % 3 and any(laws) else pattern


def at_limit(m):
    return (np.abs(m.fold_angles) == math.pi).any()


def _closest(states, x):
    return min((float(np.abs(x - y).max()) for y in states), default=math.inf)


def _against_scan(seed, vertices):
    pattern = drawn(seed, vertices)
    proof = prove_sheet(pattern)
    assert not proof.undecided
    wells = list(StripOfHinges(pattern).wells())
    held = [m.fold_angles for m in proof.minima if m.stops]
    inside = [m.fold_angles for m in proof.minima if not (m.stops or at_limit(m))]
    for phi, stop in wells:
        assert _closest(held if stop else inside, phi) < 1e-7, (seed, stop)
    problem, missing = PatternProblem(pattern), 0
    for m in proof.minima:
        state = judge(problem, m.fold_angles, False)
        # beside the flat state closure nearly loses rank: what the kernel does not confirm there no list calls proved
        near = np.abs(m.fold_angles).max() < 1e-3 and not state.kkt_residual > 1e-9
        assert state.verdict == "minimum" or near, (seed, state.verdict)
        if not at_limit(m):
            missing += _closest([phi for phi, _ in wells], m.fold_angles) > 1e-7
    return len(wells), len(held), missing


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow), 2])
def test_minima_are_those_of_a_scan(seed):
    _against_scan(seed + 3, 1 + seed % 2)


@pytest.mark.slow
def test_minima_of_two_hundred_strips():
    totals = np.sum([_against_scan(5000 + s, 1 + s % 4) for s in range(200)], axis=0)
    print("of the scan, at stops, of the proof alone:", totals)
    # the scan stops where a crease across has passed 180 degrees, the proof goes on
    assert totals[2] <= 0.05 * totals[0]


def test_a_linear_law_is_a_spring():
    pattern = strip(2, 3, 2)
    laws = [linear(k, r) for k, r in zip(pattern.stiffness, pattern.rest, strict=True)]
    plain, law = prove_sheet(pattern), prove_sheet(pattern.with_laws(laws))
    assert law.boxes == plain.boxes and len(law.minima) == len(plain.minima)
    for one, other in zip(plain.minima, law.minima, strict=True):
        assert np.abs(one.fold_angles - other.fold_angles).max() < 1e-12


def test_slopes_of_a_law_are_enclosed():
    rng = np.random.default_rng(0)
    kinked = HingeLaw((-4.0, -0.4, 0.7, 4.0), ((0, 0, 1, -3.6), (0, 0, 0.2, 0), (0, 0, 3, 0.22)))
    for law in (
        kinked,
        double_well(2.0, 1.2, 0.1),
        sum_of([linear(1.0, 0.2), detent(0.4, 5, 0.3)]),
    ):
        balls = LawBalls(law)
        for middle, half in zip(
            rng.uniform(-3, 3, 200), 10.0 ** rng.uniform(-6, 0, 200), strict=True
        ):
            torque, slope = balls.over(arb(float(middle), float(half)))
            x = np.linspace(max(middle - half, -3.1), min(middle + half, 3.1), 41)
            for ball, values in ((torque, law.torque(x)), (slope, law.slope(x))):
                room = 1e-9 * (1 + np.abs(values).max())
                assert float(ball.lower()) - room <= values.min()
                assert values.max() <= float(ball.upper()) + room
            if half < 1e-3:
                assert slope.rad() < 5 + 6 * np.abs(law.coefficients).max() * half


def test_a_search_has_the_same_list():
    pattern = drawn(2, 2)
    found = o.find_minima(pattern, contact="fold-limits", prove=True, escape=False)
    assert found.completeness.proved
    assert len(found.minima) == len(prove_sheet(pattern).minima)


def test_what_is_not_proved_is_named():
    pattern = strip(0, 3, 2)
    limits = [(0.0, 2.0)] + [(-math.pi, math.pi)] * 6
    assert "stop at 0 degrees" in why_no_sheet(pattern.with_limits(limits))
    sheet = o.examples.pattern("miura", 2, 3)
    assert "stops" in why_no_sheet(sheet.with_limits((-2.0, 2.0)))
    bent = sheet.with_laws([linear(1.0, 0.2)] * sheet.creases)
    assert "hinge laws" in why_no_sheet(bent)
    with pytest.raises(OptionError, match="hinge law"):
        prove_sheet(bent)
    found = o.find_minima(bent, contact="fold-limits", prove=True, starts=1, escape=False)
    assert not found.completeness.proved and "hinge laws" in found.completeness.reason


def test_a_stop_where_a_curve_ends():
    """A crease is at its stop where another one is fully folded, to rounding."""
    pattern = strip(3, 3, 2)
    (end,) = [m.fold_angles for m in prove_sheet(pattern).minima if at_limit(m)]
    crease, limits = 5, [(-math.pi, math.pi)] * pattern.creases
    a = float(end[crease])
    limits[crease] = (-math.pi, a) if a > 0 else (a, math.pi)
    proof = prove_sheet(pattern.with_limits(limits))
    assert proof.undecided or _closest([m.fold_angles for m in proof.minima], end) < 1e-6
