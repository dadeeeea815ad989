"""Error against time on whole patterns: references, rivals, the report, and the times that are promised."""

import json
import math

import numpy as np
import pytest
from matplotlib.figure import Figure

import origami_nlp as o
from benchmarks import (
    PatternBench,
    draw_patterns,
    measure_contact,
    measure_scale,
    patterns_page,
    run_patterns,
)
from benchmarks.__main__ import app
from benchmarks.pattern_bars import STIFF, Bars
from benchmarks.pattern_contacts import CASES
from benchmarks.pattern_methods import pattern_methods
from benchmarks.pattern_problems import miura_state, pattern_problems, wide_closure
from benchmarks.pattern_scaling import RESTS
from origami_nlp.pattern_problem import Closure
from tests.command_line import run
from tests.computed_once import shared

WIDE = np.finfo(np.longdouble).eps < 1e-18
OURS, PROJECTION, BARS, ELASTIC, ALL_ROWS = [m.name for m in pattern_methods()]


@shared
def found():
    return run_patterns(quick=True, names=["miura:4x4"])


@pytest.mark.parametrize("size", [4, 8])
def test_the_reference_is_the_closed_form(size):
    """Newton in extended precision on closure, against one unknown of spherical trigonometry."""
    (problem,) = pattern_problems([f"miura:{size}x{size}"])
    assert problem.residual < (1e-17 if WIDE else 1e-14)
    assert problem.angle_error(miura_state(problem.pattern)) < 5e-16
    if size == 8:
        assert abs(problem.energy - 5.490285124421671) < 1e-13


@pytest.mark.parametrize(("name", "size"), [("waterbomb", (2, 2)), ("metasheet", (3, 2))])
def test_extended_closure_is_that_of_the_package(name, size):
    """Off closure too; quaternions cut at each crease, against the package's closed-form derivatives."""
    pattern = o.examples.pattern(name, *size)
    rng = np.random.default_rng(3)
    phi, own = rng.uniform(-2, 2, pattern.creases), Closure(pattern)
    lam = rng.normal(size=own.count)
    closure, pull = wide_closure(pattern, phi.astype(np.longdouble), lam)
    assert np.abs((closure - own.values(phi)).astype(float)).max() < 1e-14
    assert np.abs((pull - own.jacobian(phi).T @ lam).astype(float)).max() < 1e-13


def test_bars_see_the_fold_angles_of_rigid_facets():
    """Wherever the sheet is in space; nothing is stretched, no facet bends; forces are slopes of the energy."""
    (problem,) = pattern_problems(["metasheet:4x4"])
    bars, rng = Bars(problem), np.random.default_rng(0)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    x = bars.start @ turn.T + rng.normal(size=3)
    angles, _ = bars.angles(x)
    assert np.abs(angles[: bars.creases] - problem.start).max() < 1e-12
    assert bars.softness(x) < 1e-12
    scale = problem.pattern.stiffness.mean()
    energy, _ = bars.energy(x.ravel(), 1e6)
    assert math.isclose(energy * scale, problem.pattern.energy(problem.start), rel_tol=1e-12)
    bent, way = x.ravel() + 0.02 * rng.normal(size=x.size), rng.normal(size=x.size)
    h = 1e-5
    slope = (bars.energy(bent + h * way, 50.0)[0] - bars.energy(bent - h * way, 50.0)[0]) / (2 * h)
    assert math.isclose(slope, float(bars.energy(bent, 50.0)[1] @ way), rel_tol=1e-7)


def test_methods_end_where_they_should():
    bench = found()
    for method in (OURS, PROJECTION):
        last = bench.of("miura:4x4", method)[-1]
        assert last.angle < 1e-12 and last.energy < 1e-12 and last.closure < 1e-12
    # elastic rows give way by multipliers over the penalty, 1e8
    assert 1e-11 < min(p.angle for p in bench.of("miura:4x4", ELASTIC)) < 1e-6
    (refused,) = bench.of("miura:4x4", ALL_ROWS)
    assert math.isnan(refused.angle) and "Not_Enough_Degrees" in refused.status
    assert bench.seconds_to("miura:4x4", ALL_ROWS, 1e-4) == math.inf


def test_bars_are_wrong_by_one_over_their_stiffness():
    errors = [p.angle for p in found().of("miura:4x4", BARS)]
    assert len(errors) == len(STIFF)
    assert np.allclose(np.diff(np.log10(errors[1:])), -1.0, atol=0.05)


def test_the_report_is_read_back_and_drawn(tmp_path):
    bench = found()
    again = PatternBench.from_dict(json.loads(json.dumps(bench.to_dict())))
    assert str(again) == str(bench) and "refused" in str(bench)
    bench.save(tmp_path / "a.json")
    assert isinstance(draw_patterns(bench, tmp_path / "a.png"), Figure)
    assert bench.to_markdown().count("| this package |") == 1
    with pytest.raises(o.OrigamiError, match="schema"):
        PatternBench.from_dict({"schema": "x"})


def test_the_command(monkeypatch, tmp_path):
    monkeypatch.setattr("benchmarks.run_patterns", lambda **options: found())
    code, said, _ = run("patterns", "--quick", "-o", tmp_path / "a.json", commands=app)
    assert code == 0 and "gradient and projection" in said
    assert json.loads((tmp_path / "a.json").read_text())["schema"] == "origami-nlp/bench-patterns/1"


SECONDS = {64: (0.3, 0.03, 0.15), 256: (0.6, 0.2, 0.15), 1024: (1.5, 0.8, 0.15)}
"""First state with all that is built, another state, crossings, by the number of facets: as promised, quiet machine."""


@pytest.mark.slow
@pytest.mark.parametrize("name", RESTS)
def test_large_sheets_are_solved_in_time(name):
    """Residuals are exact bounds; processor time may be four times what is promised, the machine being shared."""
    scale = measure_scale(name)
    assert scale.verdict == "minimum"
    assert scale.closure <= 1e-12 and scale.torque <= 1e-11
    size = min(SECONDS, key=lambda s: abs(s - scale.facets))
    first, another, crossings = SECONDS[size]
    assert scale.first < 4 * first and scale.another < 4 * another
    assert scale.crossings < 4 * crossings


def _pressed(case):
    """Closed, and without crossings, whatever it is; a minimum only to rounding."""
    assert case.closure <= 1e-12 and case.verdict in ("minimum", "not decided")
    assert case.torque <= 1e-11 or case.verdict == "not decided"
    # 5 s for 100 pairs is promised of a quiet machine
    assert case.seconds < 4 * 5 * max(1.0, case.pairs / 100)


def test_a_pattern_is_pressed_to_a_minimum_in_time():
    (case,) = found().contacts
    _pressed(case)
    assert case.verdict == "minimum" and case.pairs > 2 * case.facets and case.touching > 5


@pytest.mark.slow
@pytest.mark.parametrize(("name", "seed"), CASES)
def test_patterns_are_pressed_together_in_time(name, seed):
    case = measure_contact(name, seed)
    _pressed(case)
    assert case.pairs > 40


def test_tables_of_the_page_are_those_recorded():
    data, text = json.loads(patterns_page.DATA.read_text()), patterns_page.PAGE.read_text()
    assert patterns_page.with_tables(text, data) == text, "run: python -m benchmarks page"
    assert f"`{data['stamp']}`" in text
    ours = [p for p in data["points"] if p["method"] == "this package"]
    last = {p["pattern"]: p["angle"] for p in ours}
    assert len(last) == 7 and max(last.values()) <= 3.5e-13, "as the first sentence says"
