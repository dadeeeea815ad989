"""Proofs with hinge laws: enclosures hold in rational numbers, lists are those of scans, wrong claims are refused."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex, examples
from origami_nlp.pattern import (
    HingeLaw,
    detent,
    double_well,
    linear,
    one_sided,
    polynomial,
    sum_of,
    table,
    well,
)
from origami_nlp.problem import Model
from origami_nlp.proof import (
    prove,
)
from origami_nlp.proof.law_torques import LawPieces
from tests.computed_once import thinned
from tests.independent import scan_four, search_slsqp
from tests.minima.test_law_searches import five, six
from tests.minima.test_laws_scanned import agree, drawn

RNG = np.random.default_rng(5)
KINKED = HingeLaw(
    (-math.pi, -0.4, 0.7, math.pi),
    ((0.0, 0.0, 1.0, 0.4 - math.pi), (0.0, 0.0, 0.2, 1e-16), (0.0, 0.0, 3.0, 0.22)),
    "kinked",
)
"""Its slope jumps, and its torque does not quite meet at the knots."""
LAWS = [
    linear(2.0, 0.5),
    polynomial([1.0, 0.2, 0.3], 0.2),
    well(1.5, 1.0, 0.1),
    double_well(2.0, 1.2, 0.1),
    sum_of([linear(1.0, 0.2), detent(0.4, 5, 0.3)]),
    sum_of([linear(1.0, 0.2), one_sided(20.0, 1.0)]),
    table(np.linspace(-math.pi, math.pi, 9), np.cumsum(RNG.normal(size=9))),
    detent(1.0, 3, 0.3).times(0.7).shifted(0.0),
    KINKED,
]
VERTEX = Vertex.from_degrees((70, 80, 120, 90))


@lru_cache
def rational(law):
    """Breaks and slopes of the pieces, and the torque where each begins so that it is continuous."""
    breaks = [Fraction(b) for b in law.breaks]
    rows = [[Fraction(v) for v in row[:3]] for row in law.coefficients]
    values = [Fraction(law.coefficients[0][3])]
    for (a, b, c), low, high in zip(rows, breaks, breaks[1:], strict=False):
        h = high - low
        values.append(values[-1] + ((a * h + b) * h + c) * h)
    return breaks, rows, values


def exact(law, x):
    """The continuous torque with the slopes of the pieces, and the slope, in rational numbers."""
    breaks, rows, values = rational(law)
    piece = bisect_right(breaks[1:-1], x)
    (a, b, c), h = rows[piece], Fraction(x) - breaks[piece]
    return values[piece] + ((a * h + b) * h + c) * h, (3 * a * h + 2 * b) * h + c


def boxes_at(rng, law, count):
    """Boxes of any width, knots at their ends and inside; beyond the last break by one unit."""
    middle = np.append(rng.uniform(-math.pi, math.pi, count), rng.choice(law.breaks, count))
    half = 10 ** rng.uniform(-9, 0.5, 2 * count)
    half = np.minimum(half, np.maximum(math.pi - np.abs(middle), 0.0)) * rng.choice(
        [0, 1, 1], len(half)
    )
    return middle, half


@pytest.mark.parametrize("law", LAWS, ids=lambda one: one.name)
def test_torques_lie_in_their_enclosures(law):
    rng = np.random.default_rng(1)
    pieces = LawPieces(law, 0.3, 0.125)
    middle, half = boxes_at(rng, law, 80)
    centre, lean, error = pieces.over(middle, half)
    for k in range(len(middle)):
        for xi in (-1.0, 1.0, 0.0, *rng.uniform(-1, 1, 2)):
            x = np.clip(middle[k] + half[k] * xi, middle[k] - half[k], middle[k] + half[k])
            value = (exact(law, x)[0] - Fraction(0.3)) / 8
            place = (Fraction(float(x)) - Fraction(middle[k])) / Fraction(half[k] or 1.0)
            off = value - Fraction(centre[k]) - Fraction(lean[k]) * place
            assert abs(off) <= Fraction(error[k]) * (1 + Fraction(1, 10**9)) + Fraction(1, 10**15)
    # tight: quadratic in the width inside of a piece, not wider than the torque varies over several
    spread = np.ptp([float(exact(law, x)[0]) / 8 for x in np.linspace(-math.pi, math.pi, 400)])
    assert (error + np.abs(lean) <= 1.6 * spread + 1e-9).all()
    narrow = half < 1e-5
    bound = 1e-13 * (1 + pieces.size) + 2 * half[narrow] * (
        pieces.kink.max(initial=0.0) + 1e3 * half[narrow]
    )
    assert (error[narrow] <= bound).all()


@pytest.mark.parametrize("law", LAWS, ids=lambda one: one.name)
def test_slopes_change_no_faster_than_bounded(law):
    rng = np.random.default_rng(2)
    pieces = LawPieces(law, 0.0, 1.0)
    x = rng.uniform(-math.pi, math.pi, 60)
    within = 10 ** rng.uniform(-7, -0.5, 60)
    bound = pieces.bends(x, within)
    for a, w, b in zip(x, within, bound, strict=True):
        for y in np.clip(a + w * rng.uniform(-1, 1, 4), -math.pi, math.pi):
            change = abs(float(exact(law, y)[1] - exact(law, a)[1]))
            assert change <= b * abs(y - a) + pieces.ripple


def laws_of(scene):
    return replace(scene, laws=tuple(map(linear, scene.stiffness, scene.rest_angles)))


PANELS = [examples.degree6("pi/3", 0.1), examples.degree8("pi/4", 1.0)]
TURNED = Scene(
    Vertex.from_degrees((70, 50) * 3), (1.0, 2.0) * 3, (0.5, -1.0) * 3, "C3", "fold-limits"
)


@pytest.mark.parametrize("scene", thinned([TURNED, *PANELS], 2), ids=str)
def test_linear_laws_have_the_proofs_of_springs(scene):
    """The same boxes, points and singular states, these alone where they were."""
    spring, law = (
        prove(Model(replace(one, contact="fold-limits"))) for one in (scene, laws_of(scene))
    )
    one, two = (
        sorted(
            (p.stratum, *np.round(p.x, 6), p.index, p.is_minimum, p.pinned_signs) for p in points
        )
        for points in (spring.points, law.points)
    )
    assert [p[0] for p in one] == [p[0] for p in two] and [p[-3:] for p in one] == [
        p[-3:] for p in two
    ]
    assert np.allclose([p[1:-3] for p in one], [p[1:-3] for p in two], atol=2e-6)
    assert len(law.singular) == len(spring.singular)
    assert len(law.undecided) == len(spring.undecided)
    assert abs(law.boxes - spring.boxes) <= 0.01 * spring.boxes
    one, two = (o.find_minima(s, prove=True) for s in (scene, laws_of(scene)))
    assert two.completeness.status == one.completeness.status
    assert np.allclose([m.energy for m in two.minima], [m.energy for m in one.minima], rtol=1e-9)


def four(seed, contact="fold-limits"):
    """A vertex of degree four with laws of random types, and their energies."""
    rng = np.random.default_rng(seed)
    a = rng.dirichlet([4] * 4) * 2 * math.pi
    while a.max() > 3.0:
        a = rng.dirichlet([4] * 4) * 2 * math.pi
    laws, energies = zip(*(drawn(rng) for _ in range(4)), strict=True)
    limits = rng.uniform(0.5, 3, (4, 2)) * (-1, 1) if rng.random() < 0.5 else ()
    return Scene(Vertex(tuple(a)), (1,) * 4, (0,) * 4, "none", contact, limits=limits, laws=laws), (
        energies
    )


def proved_and_scanned(seed, contact):
    scene, energies = four(seed, contact)
    result = o.find_minima(scene, prove=True)
    _, theirs = scan_four.minima(
        lambda x: sum(f(x[..., i]) for i, f in enumerate(energies)),
        np.array(scene.vertex.sector_angles),
        scene.limit_angles,
        contact,
        6_001,
    )
    return result, np.array([m.fold_angles for m in result.minima]).reshape(-1, 4), theirs


@pytest.mark.parametrize(("seed", "contact"), [(1, "full"), (2, "fold-limits"), (3, "full")])
def test_proved_lists_are_those_of_scans(seed, contact):
    result, ours, theirs = proved_and_scanned(seed, contact)
    assert result.completeness.status == "proved" and agree(ours, theirs)


@pytest.mark.slow
@pytest.mark.parametrize("contact", ["full", "fold-limits"])
def test_many_proved_lists_are_those_of_scans(contact):
    for seed in range(100, 150):
        result, ours, theirs = proved_and_scanned(seed, contact)
        assert result.completeness.status == "proved", seed
        # a scan does not part branches that meet at the flat state: beside it a finer one says whether a state is low
        beside = np.abs(ours).max(axis=1) < scan_four.NEAR
        assert agree(ours[~beside], theirs), seed
        assert all(stands(*four(seed, contact), x) for x in ours[beside]), seed


def stands(scene, energies, x):
    """Whether no closed state nearer than the flat one is lower."""
    states = scan_four.closed_states(np.array(scene.vertex.sector_angles), 200_001)
    near = states[np.abs(states - x).max(axis=1) < 0.8 * np.abs(x).max()]
    low, own = (sum(f(s[..., i]) for i, f in enumerate(energies)) for s in (near, x))
    return len(near) > 10 and low.min() >= own - 1e-9


def others_found(make, rng, starts=60):
    """Status of a proved list, and the minima of another search that are not in it."""
    scene, energies, tie = make(rng)
    result = o.find_minima(scene, prove=True)
    theirs = search_slsqp.minima(
        lambda phi: sum(f(phi[i]) for i, f in enumerate(energies)),
        np.array(scene.vertex.sector_angles),
        scene.limit_angles,
        tie,
        starts,
        rng,
    )
    ours = np.array([m.fold_angles for m in result.minima])
    apart = np.abs(ours[:, None] - theirs[None]).max(axis=2).min(axis=0, initial=9.0)
    return result.completeness, theirs[apart > 2e-2]


@pytest.mark.slow
@pytest.mark.parametrize(("make", "count"), [(five, 20), (six, 10)])
def test_another_search_finds_none_beside_a_proved_list(make, count):
    rng = np.random.default_rng(14)
    for _ in range(count):
        completeness, others = others_found(make, rng)
        assert completeness.status == "proved" and not len(others)


def test_two_degrees_of_freedom():
    proof = prove(Model(five(np.random.default_rng(4))[0]))
    assert proof.complete and len(proof.minima) > 1
    proof = prove(Model(six(np.random.default_rng(4))[0]))
    assert len(proof.minima) > 1 and not proof.undecided


SHARP = sum_of([linear(1.0, 0.4), detent(0.4, 5, 0.3)], "sharp")
MIXED = Scene(
    VERTEX,
    (1, 2, 3, 2),
    (1.0, -0.5, 0.3, 0.8),
    "none",
    "fold-limits",
    laws=(None, SHARP, None, double_well(1.0, 1.0, 0.1)),
    preload=(0.1, 0.2, 0.0, -0.1),
)


VERTEX_OF_KINKS = Scene(VERTEX, (1,) * 4, (0,) * 4, "none", "fold-limits")


def test_kinks_are_proved_too():
    """Torques whose slopes jump."""
    laws = tuple(sum_of([KINKED, linear(0.3, 0.1 * i + 0.05)]) for i in range(4))
    scene = replace(VERTEX_OF_KINKS, laws=laws)
    assert o.find_minima(scene, prove=True).completeness.status == "proved"


def test_what_the_search_lacks_the_proof_adds():
    scene = five(np.random.default_rng(7))[0]
    whole = o.find_minima(scene, prove=False).minima
    poor = {"max_starts": 1}
    assert len(o.find_minima(scene, prove=False, **poor).minima) < len(whole)
    found = o.find_minima(scene, prove=True, **poor)
    assert found.completeness.status == "proved"
    assert np.allclose([m.energy for m in found.minima], [m.energy for m in whole], rtol=1e-9)


def test_states_without_torque_are_not_called_proved():
    """Hinges without torque between soft stops: all states there are critical, none stands alone."""
    law = sum_of([one_sided(3.0, 1.0), one_sided(3.0, -1.0)])
    result = o.find_minima(
        replace(VERTEX_OF_KINKS, laws=(law,) * 4), prove=o.ProofOptions(boxes=20_000)
    )
    assert not result.completeness.status.startswith("proved")
