"""The hard cases come out as they must, their references are right, and failures are reported."""

import math

import mpmath as mp
import numpy as np
import pytest

from benchmarks.hard import HardReport, hard_cases, run_case
from benchmarks.hard_case import HardCase, Measured, Outcome
from benchmarks.hard_flat import exact_state, regular_at_pi
from benchmarks.hard_fold_point import beside, exact_fold_point, find_fold_point, ratio_scene
from origami_nlp import Scene, Vertex, examples, find_minima
from origami_nlp.kkt import polish
from origami_nlp.minima import ipopt
from origami_nlp.problem import Model

QUICK = (
    "flat state as a start",
    "a minimum about to annihilate with a saddle",
    "weakly active contact",
    "cone next to the flat state, N = 1000",
)
CASES = {case.name: case for case in hard_cases()}


@pytest.mark.parametrize("name", QUICK)
def test_hard_cases_come_out_as_they_must(name):
    result = run_case(CASES[name])
    assert len(result.outcomes) >= 4
    assert not result.failures, result.failures


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in CASES if name not in QUICK])
def test_long_hard_cases_come_out_as_they_must(name):
    failed = {(name, o.setting) for o in run_case(CASES[name]).failures}
    assert not failed


def test_every_case_says_what_is_hard_known_and_due():
    assert len(CASES) >= 13
    for case in CASES.values():
        assert case.hard and case.known and case.must


def test_failures_are_told_and_exceptions_do_not_end_the_run():
    def stream():
        yield Outcome("good", (Measured("angles", 1e-16, 1e-14),), "interior", True)
        yield Outcome("off", (Measured("angles", 1e-3, 1e-14),), "interior", True)
        yield Outcome("not a number", (Measured("angles", math.nan, 1e-14),), "interior", True)
        yield Outcome("wrong", (), "saddle", False)
        raise ZeroDivisionError("closure")

    seen = []
    result = run_case(
        HardCase("made up", "h", "k", "m", stream), lambda n, o: seen.append(o.setting)
    )
    assert [o.passed for o in result.outcomes] == [True, False, False, False, False]
    assert seen == ["good", "off", "not a number", "wrong"]
    report = HardReport((result,))
    assert len(report.failures) == 4 and "4 failures" in report.summary()
    text = report.markdown()
    assert text.count("**fails**") == 4 and "ZeroDivisionError: closure" in text
    outcomes = report.to_dict()["cases"][0]["outcomes"]
    assert [o["passed"] for o in outcomes] == [True, False, False, False, False]


def test_fold_point_is_the_same_in_the_wedge_and_in_the_closed_form():
    exact, elevation, odd = exact_fold_point()
    point = find_fold_point(np.array([2.7, -0.85]), 0.2)
    assert abs(point.ratio / float(exact) - 1) <= 1e-12
    assert point.x == pytest.approx([float(odd), 2 * float(elevation)], abs=1e-10)
    # the closed form by another way: cone_fold_angles, and energies instead of derivatives
    from origami_nlp.closed_forms import cone_fold_angles

    v = float(elevation) + np.linspace(-0.01, 0.01, 2001)
    ratio = float(exact)
    angles = cone_fold_angles(6, v, (1, 1, 1)).value
    slope = np.gradient(ratio_scene(ratio).energy(angles), v[1] - v[0])[1:-1]
    # where slope and curvature vanish together the slope keeps its sign
    assert np.abs(slope).min() <= 1e-4
    assert (slope >= -1e-6).all() or (slope <= 1e-6).all()


def test_both_sides_of_the_fold_point_in_the_search():
    exact = float(exact_fold_point()[0])
    point = find_fold_point(np.array([2.85, -0.93]), 0.16)
    with_pair = find_minima(ratio_scene(exact * 1.0001), max_starts=128, escape=False)
    without = find_minima(ratio_scene(exact * 0.9999), max_starts=128, escape=False)
    near = [
        sum(np.abs(np.array(m.fold_angles[:2]) - point.x).max() < 0.1 for m in r.minima)
        for r in (with_pair, without)
    ]
    assert near == [1, 0]
    (low, what) = next(p for p in beside(point, exact * 1.0001) if p[1] == "minimum")
    found = min(np.abs(np.array(m.fold_angles[:2]) - low).max() for m in with_pair.minima)
    assert what == "minimum" and found <= 1e-12


@pytest.mark.parametrize("ratio", [1.0, 100.0])
def test_50_digits_agree_between_wedge_and_whole_vertex(ratio):
    wedge = examples.degree8("pi/6", ratio)
    minimum = find_minima(wedge, max_starts=128, escape=False).minima[0]
    model, whole = Model(wedge), Model(examples.degree8("pi/6", ratio, symmetry="none"))
    phi = np.array(minimum.fold_angles)
    short, long = exact_state(model, model.reduce(phi)), exact_state(whole, phi)
    assert short is not None and long is not None
    with mp.workdps(60):
        for crease, v in enumerate(model.variable_of_crease):
            assert abs(mp.mpf(short.digits[v]) - mp.mpf(long.digits[crease])) <= mp.mpf("1e-45")
    assert short.energy_error(long.energy) <= 1e-14


@pytest.mark.parametrize("distance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_regular_state_just_off_the_fold_limit_does_not_snap_to_it(distance, sign):
    scene, x = regular_at_pi(sign * (math.pi - distance))
    model = Model(scene)
    state = polish(model, ipopt.solve(model, x + 0.01))
    assert state.converged and np.abs(state.x - x).max() <= 1e-14


@pytest.mark.parametrize(
    "sectors", [("pi/3", "2*pi/3") * 2, ("pi/2",) * 4, (0.7, math.pi - 0.7) * 2]
)
def test_degree_4_with_collinear_pairs_folds_on_its_two_lines(sectors):
    """Each pair of collinear creases folds alone: its least energy is that of one spring."""
    k, rest = np.array([1.0, 0.5, 2.0, 0.7]), np.array([1.0, -0.8, 0.4, -2.0])
    result = find_minima(Scene(Vertex(sectors), tuple(k), tuple(rest), "none"), escape=False)
    found = np.array([m.fold_angles for m in result.minima])
    for pair in ([0, 2], [1, 3]):
        state = np.zeros(4)
        state[pair] = (k[pair] * rest[pair]).sum() / k[pair].sum()
        best = np.abs(found - state).max(axis=1)
        assert best.min() <= 1e-13
        assert (found[best.argmin()][state == 0] == 0).all() or best.min() <= 1e-15
        energy = result.minima[int(best.argmin())].energy
        assert energy == pytest.approx(float(0.5 * (k * (state - rest) ** 2).sum()), rel=1e-13)


@pytest.mark.parametrize("rest", [(math.pi, 0.0, math.pi, 0.0), (0.0, -math.pi, 0.0, -math.pi)])
def test_a_degree_4_vertex_at_rest_folded_on_one_line_stays_exactly_there(rest):
    scene = Scene(Vertex(("pi/3", "2*pi/3") * 2), (1.0, 2.0, 1.0, 3.0), rest, "none")
    best = find_minima(scene, max_starts=128, escape=False).minima[0]
    assert best.fold_angles == rest and best.energy == 0.0
