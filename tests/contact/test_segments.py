"""Contact boundaries and metastable segments against direct evaluation and finite differences."""

from __future__ import annotations

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.contact.segments import SLOPE, STIFFNESS, SegmentReport, find_segments
from origami_nlp.continuation import (
    BoundaryCurve,
    HeldCurve,
    Point,
    advance,
    evaluate,
    follow_boundary,
)
from origami_nlp.display import METASTABLE
from origami_nlp.kkt import State
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.problem import Contact
from tests.computed_once import panel_result, shared, thinned

SCENES = {
    "fold limit": ("degree8", "pi/12", 0.01),
    "axis": ("degree8", "pi/6", 100.0),
    "facets": ("degree6", "pi/3", 1.0),
    "fold limit, degree 6": ("degree6", "5*pi/12", 100.0),
}


def search(name: str) -> MinimaResult:
    family, alpha, ratio = SCENES[name]
    return panel_result(getattr(o.examples, family)(alpha, ratio))


@shared
def segments(name: str) -> SegmentReport:
    return find_segments(search(name))


def pinned_number(name: str) -> int:
    """Number of the pinned state of lowest energy."""
    return next(n for n, m in enumerate(search(name).minima, 1) if m.kind == "contact-pinned")


def curve_of(name: str) -> tuple[PatternProblem, BoundaryCurve]:
    """The boundary of the pinned state."""
    report = segments(name)
    number = pinned_number(name)
    (curve,) = [c for c, s in zip(report.curves, report.states, strict=True) if number in s]
    return search(name).model, curve


def points(model: PatternProblem, curve: BoundaryCurve, count: int = 5) -> list[Point]:
    """Some regular points of a curve, away from its ends, with the tangent towards growing s."""
    out = []
    inside = np.linspace(curve.s[0], curve.s[-1], count + 2)[1:-1]
    for s in inside:
        k = int(np.abs(curve.s - s).argmin())
        at = model.reduce(curve.fold_angles)
        ahead = np.sqrt(model.multiplicity) * (at[k + 1] - at[k - 1])
        point = evaluate(State(model, at[k]).on(curve.rows), ahead / np.linalg.norm(ahead))
        assert point is not None
        out.append(point)
    return out


def errors(
    model: PatternProblem, point: Point, rows: tuple[Contact, ...], h: float
) -> tuple[float, float]:
    """Errors of dU/ds and d2U/ds2 at a point against energies at arclength -h, 0 and h."""
    sides = []
    for sign in (1.0, -1.0):
        start = evaluate(State(model, point.x).on(rows), sign * point.tangent)
        assert start is not None
        moved = advance(HeldCurve(model, rows, start.dimension), start, h)
        assert moved is not None
        sides.append((moved[1], model.energy_change(point.x, moved[0].x) / model.scale))
    (a, up), (b, um) = sides
    # quadratic through three points at unequal distances
    slope = (up * b * b - um * a * a) / (a * b * (a + b))
    second = 2 * (up * b + um * a) / (a * b * (a + b))
    return abs(slope - point.slope), abs(second - point.stiffness)


@pytest.mark.parametrize("name", thinned(list(SCENES), 4))
def test_slope_integrates_to_the_energy(name: str) -> None:
    _, curve = curve_of(name)
    h = np.diff(curve.s)
    # Hermite: trapezium with the end correction of the second derivative
    step = h / 2 * (curve.slope[1:] + curve.slope[:-1]) - h**2 / 12 * np.diff(curve.stiffness)
    size = np.abs(curve.energy).max()
    assert np.abs(np.diff(curve.energy) - step).max() < 1e-7 * size
    assert abs(curve.energy[-1] - curve.energy[0] - step.sum()) < 1e-6 * size


@pytest.mark.parametrize("name", thinned(list(SCENES), 4))
def test_moments_along_a_curve_start_from_those_of_the_state(name: str) -> None:
    model, curve = curve_of(name)
    k = int(np.flatnonzero(curve.s == 0)[0])
    minimum = search(name).minima[pinned_number(name) - 1]
    assert curve.multipliers[k][0] == pytest.approx(minimum.contacts[0].multiplier, rel=1e-9)
    assert curve.stiffness[k] == pytest.approx(min(minimum.hessian_eigenvalues), rel=1e-6)
    assert abs(curve.slope[k]) < 1e-9 * model.scale
    assert curve.pressed.all()
    for why, multiplier in (
        (curve.start, curve.multipliers[0]),
        (curve.end, curve.multipliers[-1]),
    ):
        if why == "the contact stops pushing":
            assert 0 <= multiplier.min() < 1e-6


def test_a_curve_with_more_dof_is_a_geodesic_in_the_softest_direction() -> None:
    scene = o.Scene(
        o.Vertex((1.2, 0.9, 1.0, 1.1, 0.8, 2 * math.pi - 5.0)),
        (1.0, 2.0, 0.5, 1.5, 1.0, 0.7),
        (2.8, -1.0, 1.3, -2.9, 1.0, 0.4),
        "none",
    )
    result = o.find_minima(scene, max_starts=16, prove=False, escape=False)
    model = result.model
    pinned = [m for m in result.minima if m.kind == "contact-pinned"]
    assert pinned, [m.kind for m in result.minima]
    x = model.reduce(np.array(pinned[0].fold_angles))
    choices = model.closed(x).combinations()
    assert choices
    first = evaluate(State(model, x).on(choices[0]))
    assert first is not None and first.dimension == 2
    assert first.stiffness == pytest.approx(min(pinned[0].hessian_eigenvalues) / model.scale)
    curve = follow_boundary(State(model, x).on(choices[0]), longest=0.6)
    assert curve is not None and curve.dimension == 2 and curve.length > 0.05
    for point in points(model, curve, 3):
        coarse, fine = (errors(model, point, curve.rows, h) for h in (4e-3, 2e-3))
        assert fine[0] < 1e-4 and fine[1] < 1e-3
        assert fine[1] < 0.35 * coarse[1] + 2e-8


def test_segments_satisfy_their_thresholds_and_end_where_they_fail() -> None:
    report = segments("fold limit")
    assert report.segments
    total = sum(report.scene.stiffness)
    for segment in report.segments:
        curve = report.curves[segment.curve]
        inside = (curve.s > segment.start) & (curve.s < segment.end)
        assert inside.sum() > 5
        assert np.abs(curve.slope[inside]).max() <= SLOPE * math.pi * total
        assert np.abs(curve.stiffness[inside]).max() <= STIFFNESS * total
        assert curve.multipliers[inside].min() > 0
        beyond = curve.s > segment.end + 1e-3
        if beyond.any():
            k = int(np.flatnonzero(beyond)[0])
            steep = abs(curve.slope[k]) > SLOPE * math.pi * total
            assert steep or abs(curve.stiffness[k]) > STIFFNESS * total
        assert segment.states == (2,)


def test_figure_marks_segments() -> None:
    figure = segments("fold limit").draw()
    colours = [line.get_color() for axis in figure.axes for line in axis.lines]
    assert colours.count(METASTABLE) == 4  # one segment in each of four rows
