"""Curves of events over two parameters: each point is an event over one, and counts change across them."""

from __future__ import annotations

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.paths import Plane, find_bifurcation_set, follow_family


@pytest.fixture(scope="module")
def contact():
    """Where the contact of pi/3 begins to carry, over the ratio and alpha."""
    return find_bifurcation_set(o.examples.degree6("pi/4"), "ratio=0.2:3", "alpha=50deg:pi/3")


@pytest.mark.slow
def test_a_contact_curve_passes_what_is_known_of_both_parameters(contact):
    (curve,) = contact.curves
    ratio, alpha = np.array([p.t for p in curve.points]).T
    a = math.acos(1 / 3)  # at pi/3 in closed form
    assert alpha[-1] == math.pi / 3
    assert ratio[-1] == pytest.approx((math.pi - 2 * a) / (math.pi - a), rel=1e-12)
    # r_k = 1 at 50.34254652 deg: by the points around it, whose curve is smooth
    near = np.argsort(np.abs(np.log(ratio)))[:5]
    fit = np.polyfit(np.log(ratio[near]), np.degrees(alpha[near]), 4)
    assert fit[-1] == pytest.approx(50.34254652, abs=1e-5)
    assert all(max(p.kkt, abs(p.event)) < 1e-11 for p in curve.points)


@pytest.mark.slow
def test_a_point_of_a_curve_is_the_event_over_one_parameter(contact):
    (curve,) = contact.curves
    point = curve.points[len(curve.points) // 2]
    plane = Plane(contact.scene, contact.parameters)
    atlas = follow_family(plane.family(point.t[1]), checks=2, full=False)
    assert min(abs(e.t / point.t[0] - 1) for e in atlas.events) < 1e-11


@pytest.mark.slow
def test_every_event_of_a_line_lies_on_a_curve(contact):
    for line in contact.lines:
        assert line.events and all(number for _, number in line.events)


@pytest.mark.slow
def test_a_curve_along_which_the_second_parameter_stays_is_found():
    """Crease 4 is fully folded in a state that contact pins: whatever the springs, at one angle."""
    scene = o.examples.degree6("5*pi/12")
    (curve, *_) = find_bifurcation_set(scene, "ratio=5:50", "alpha=77deg:81deg", lines=1).curves
    alpha = np.degrees([p.t[1] for p in curve.points])
    assert np.ptp(alpha) < 1e-9 and alpha[0] == pytest.approx(79.1874819, abs=1e-6)
    assert curve.ends == ("range", "range")


@pytest.mark.slow
def test_two_folds_end_at_a_cusp_and_counts_change_across_them():
    found = find_bifurcation_set(
        o.examples.degree6("5*pi/12"), "ratio=0.1:100", "alpha=61deg:70deg", lines=2, across=3
    )
    folds = [c for c in found.curves if c.type == "fold"]
    assert len(folds) == 2
    for fold in folds:
        (tip,) = [k for k, why in zip((0, -1), fold.ends, strict=True) if why != "range"]
        assert np.degrees(fold.points[tip].t[1]) == pytest.approx(65.0496, abs=2e-3)
    (fold,) = [c for c in folds if c.points[0].t[0] > 1 or c.points[-1].t[0] > 1]
    plane = Plane(found.scene, found.parameters)
    for point in fold.points[3:-3:6]:
        r, a = point.t
        counts = []
        for shift in (-0.3, 0.3):
            scene = plane.family(a + math.radians(shift)).scene_of(r)
            near = [
                m
                for m in o.find_minima(scene, prove=False, effort="thorough", escape=False).minima
                if np.abs(np.subtract(m.fold_angles, point.fold_angles)).max() < 0.8
            ]
            counts.append(len(near))
        assert counts[0] == counts[1] + 1
    for line in found.lines:
        assert all(number for _, number in line.events)
