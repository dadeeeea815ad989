"""States followed over a number that a hinge law is stated with: derivatives, scans, searches, and what is refused."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OptionError
from origami_nlp.paths.family import family_of
from origami_nlp.paths.parameter_range import parse_parameter_range
from origami_nlp.pattern import (
    detent,
    double_well,
    linear,
    one_sided,
    polynomial,
    sum_of,
    table,
    well,
)
from origami_nlp.pattern_problem import pose
from tests.computed_once import thinned
from tests.independent import scan_four
from tests.paths.test_hinges import ALL, SECTORS, random_scene

EVERY = [
    (linear(1.0, 0.3), "stiffness", 0.5, 2.0),
    (linear(1.0, 0.3), "rest", -1.0, 1.0),
    (polynomial([1.0, -0.3, 0.2], 0.2), "coefficients[2]", -0.5, 0.5),
    (polynomial([1.0, -0.3, 0.2], 0.2), "rest", -1.0, 1.0),
    (well(1.0, 0.5, 0.3), "energy", -1.0, 2.0),
    (well(1.0, 0.5, 0.3), "at", -1.0, 1.0),
    (well(1.0, 0.5, 0.3), "width", 0.1, 0.9),
    (double_well(1.0, 0.8, 0.1), "energy", 0.5, 2.0),
    (double_well(1.0, 0.8, 0.1), "at", 0.4, 1.5),
    (double_well(1.0, 0.8, 0.1), "centre", -0.5, 0.5),
    (detent(0.5, 5, 0.2), "energy", 0.2, 1.0),
    (detent(0.5, 5, 0.2), "centre", -0.3, 0.3),
    (one_sided(2.0, 0.7), "stiffness", 1.0, 3.0),
]


@pytest.mark.parametrize(("law", "key", "low", "high"), thinned(EVERY, 3))
def test_kkt_systems_change_as_differences_say(law, key, low, high):
    """Of each number of each type, in a sum, scaled and shifted; and the laws are those stated with the number."""
    t, x = 0.37 * low + 0.63 * high, np.array([0.3, 0.7, -0.4, 0.2])
    whole = sum_of([linear(0.7, 0.1), law.times(1.5)], "both")
    plain = random_scene((whole, None, whole.times(2.0), None))
    family = family_of(plain, parse_parameter_range(f"laws.both.sum[2].{key}={low!r}:{high!r}"))
    line, h = family.line, 1e-6
    p = line.at(t)
    moved, _ = line.drift(p, t, x, np.zeros(p.equation_count), ())
    ends = [line.at(t + s).parameters.torque(x) for s in (-h, h)]
    assert moved == pytest.approx((ends[1] - ends[0]) / (2 * h), rel=1e-7, abs=1e-9)
    assert np.abs(moved[[1, 3]]).max() == 0
    kind, numbers = law.stated
    numbers = {**numbers, key: t}
    if kind == "polynomial":
        other = polynomial([v for k, v in numbers.items() if k != "rest"], numbers["rest"])
    else:
        makers = (linear, well, double_well, detent, one_sided)
        other = next(m for m in makers if m.__name__ == re.sub(r"\W", "_", kind))(**numbers)
    angles = np.linspace(-3, 3, 301)
    mine = family.scene_of(t).laws[0].torque(angles)
    theirs = 0.7 * (angles - 0.1) + 1.5 * other.torque(angles)
    assert mine == pytest.approx(theirs, abs=1e-5 * np.abs(theirs).max())


def folds_against_scans(law, number, low, high, energy, seed=2):
    """Numbers of minima on either side of each fold, and at both ends, are those of scans of the closed forms."""
    stated = random_scene((None, law, None, law), seed=seed)
    atlas = o.follow(stated, f"laws.{law.name}.{number}={low!r}:{high!r}", checks=3)
    k, rest = np.array(stated.stiffness), np.array(stated.rest_angles)

    def count(t):
        whole = lambda x: (  # noqa: E731
            0.5 * (k * (x - rest) ** 2)[:, [0, 2]].sum(axis=1) + energy(x[:, [1, 3]], t).sum(axis=1)
        )
        return len(scan_four.minima(whole, np.radians(SECTORS), ALL, "full", 4_001)[0])

    size = high - low
    folds = [e.t for e in atlas.events if "fold" in e.type]
    values = [
        low + 0.01 * size,
        high - 0.01 * size,
        *(f + d * size for f in folds for d in (-0.01, 0.01)),
    ]
    for t in values:
        if low < t < high and min((abs(t - f) for f in folds), default=1.0) > 0.005 * size:
            assert sum(bool(s.kind) for s in atlas.at(t)) == count(t), t
    return folds


@pytest.mark.slow  # seconds of curves or searches
def test_the_width_of_a_well_against_scans():
    spring = sum_of([linear(0.3), well(1.0, 1.0, 0.3)], "snap")

    def energy(x, width):
        return 0.15 * x**2 - np.exp(-0.5 * ((x - 1.0) / width) ** 2)

    assert folds_against_scans(spring, "sum[2].width", 0.15, 0.5, energy)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_places_and_widths_of_many_wells_against_scans(seed):
    spring = sum_of([linear(0.3), well(1.0, 1.0, 0.3)], "snap")
    for number, low, high, of in (
        ("sum[2].width", 0.1, 1.0, lambda x, t: np.exp(-0.5 * ((x - 1.0) / t) ** 2)),
        ("sum[2].at", -1.5, 1.5, lambda x, t: np.exp(-0.5 * ((x - t) / 0.3) ** 2)),
        ("sum[2].energy", 0.1, 2.0, lambda x, t: t * np.exp(-0.5 * ((x - 1.0) / 0.3) ** 2)),
    ):
        folds_against_scans(
            spring, number, low, high, lambda x, t, of=of: 0.15 * x**2 - of(x, t), seed
        )


def test_wells_of_a_pattern_are_moved():
    """A Miura vertex as a pattern."""
    sheet = o.examples.pattern("miura", 2, 2)
    law = sum_of([linear(1.0), well(0.5, 0.6, 0.4)], "snap")
    family = family_of(sheet.with_laws(law), parse_parameter_range("laws.snap.sum[2].at_deg=20:60"))
    line, x = family.line, np.array([0.3, 0.7, -0.4, 0.2])
    t, h = 0.7, 1e-6
    moved, _ = line.drift(line.at(t), t, x, np.zeros(line.problem.equation_count), ())
    ends = [line.at(t + s).parameters.torque(x) for s in (-h, h)]
    assert moved == pytest.approx((ends[1] - ends[0]) / (2 * h), rel=1e-7, abs=1e-9)
    posed = pose(family.scene_of(t))
    scale = line.problem.scale / posed.scale
    there = posed.parameters.torque(x)
    assert line.at(t).parameters.torque(x) * scale == pytest.approx(there, rel=1e-12)


def test_what_is_no_number_of_a_law_is_refused():
    law = sum_of([linear(1.0), one_sided(2.0, 1.0), detent(1.0, 3)], "snap")
    some = table(np.linspace(-math.pi, math.pi, 7), np.linspace(-1, 1, 7), "measured")
    plain = random_scene((law, some, None, None))
    for what, why in {
        "laws.other.energy=1:2": "measured, snap",
        "laws.snap.energy=1:2": r"sum\[1\] to sum\[3\]",
        "laws.snap.sum[4].energy=1:2": "parts 1 to 3",
        "laws.snap.sum[2].start=1:2": "numbers of one-sided law 'one-sided': stiffness;",
        "laws.snap.sum[3].wells=1:2": "energy, centre;",
        "laws.snap.sum[3].energi=1:2": "did you mean energy",
        "laws.measured.torque=1:2": "numbers of measured or tabulated law 'measured': none",
        "laws.snap.sum[1].stiffness=-1:2": "stiffness = -1",
        "laws.snap.sum[3].energy=-1:1": "energy = -1",
    }.items():
        with pytest.raises((OptionError, o.OrigamiError), match=why):
            o.follow(plain, what)
    twice = random_scene((double_well(1.0, 1.0), double_well(2.0, 1.0), None, None))
    with pytest.raises(OptionError, match="2 different laws are called 'double-well'"):
        o.follow(twice, "laws.double-well.at=0.5:1")


@pytest.mark.slow  # two maps
def test_a_map_over_the_energy_of_wells_is_that_over_their_factor():
    scene, few = random_scene((double_well(1.0, 1.0),) * 4), {"across": 1, "effort": "quick"}
    factor = "+".join(f"law_scale[{i}]" for i in range(1, 5))
    energy, scale = (
        o.find_bifurcation_set(scene, f"{over}=0.1:4", "torque[1]=-1:1", **few).curves
        for over in ("laws.double-well.energy", factor)
    )
    assert len(energy) == len(scale) == 2
    for one, other in zip(energy, scale, strict=True):
        assert one.type == other.type == "fold" and one.ends == other.ends == ("range", "range")
        for k in (0, -1):
            assert one.points[k].t == pytest.approx(other.points[k].t, rel=1e-9)
