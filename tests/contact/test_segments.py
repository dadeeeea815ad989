"""Contact boundaries and metastable segments against direct evaluation and finite differences."""

from __future__ import annotations

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.contact.segments import SLOPE, STIFFNESS, SegmentReport, find_segments
from origami_nlp.continuation import (
    BoundaryCurve,
)
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern_problem import PatternProblem
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
