"""Vertices of degree four with hinge laws of every type: minima against scans that share no code with the package."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson
from scipy.interpolate import PchipInterpolator, make_interp_spline, make_lsq_spline

import origami_nlp as o
from origami_nlp import Scene, Vertex
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
from tests.computed_once import thinned
from tests.independent import scan_four


def drawn(rng, kinds=4):
    """A law of a random type, with its energy as a formula."""
    k, r = rng.uniform(0.3, 2), rng.uniform(-1, 1)
    kind = rng.integers(kinds)
    if kind == 4:
        a = rng.uniform(0.05, 0.5)
        return polynomial([k, 0.0, a], r), lambda x: k * (x - r) ** 2 / 2 + a * (x - r) ** 4 / 4
    if kind == 5:  # away from flat beyond a: its stiffness grows over w to what it stays
        a, w, stiff = rng.uniform(-2, 2), rng.uniform(0.05, 0.5), rng.uniform(3, 30)
        far = np.linspace(0, math.pi, 20_001)
        torque = cumulative_simpson(stiff * np.clip((far - abs(a)) / w, 0, 1), x=far, initial=0)
        pushed = make_interp_spline(far, cumulative_simpson(torque, x=far, initial=0))
        law = sum_of([linear(k, r), one_sided(stiff, a, w)])
        return law, lambda x: 0.5 * k * (x - r) ** 2 + pushed(np.clip(x * np.sign(a), 0, math.pi))
    if kind == 6:  # as measured, through SciPy's least squares with the same knots
        x = np.sort(rng.uniform(-math.pi, math.pi, 199))
        x[[0, -1]] = -math.pi, math.pi
        y = k * (x - r) + rng.uniform(0.5, 1.5) * np.sin(2 * x) + 0.1 * rng.normal(size=199)
        law = o.fit_hinge(o.HingeData(x, y)).law
        ends = np.repeat([-math.pi, math.pi], 4)
        knots = np.sort([*ends, *law.breaks[1:-1]])
        return law, make_lsq_spline(x, y, knots).antiderivative()
    if kind == 0:
        e, w, c = rng.uniform(0.3, 2), rng.uniform(0.5, 2), rng.uniform(-0.8, 0.8)
        return double_well(e, w, c), lambda x: e * (((x - c) / w) ** 2 - 1) ** 2
    if kind == 1:
        a, n = rng.uniform(0.1, 0.6), int(rng.integers(3, 8))
        energy = lambda x: 0.5 * k * (x - r) ** 2 + a / 2 * (1 - np.cos(n * (x - r / 2)))  # noqa: E731
        return sum_of([linear(k, r), detent(a, n, r / 2)]), energy
    if kind == 2:
        a, at, w = rng.uniform(0.2, 1.5), rng.uniform(-2, 2), rng.uniform(0.2, 0.5)
        energy = lambda x: 0.5 * k * (x - r) ** 2 - a * np.exp(-0.5 * ((x - at) / w) ** 2)  # noqa: E731
        return sum_of([linear(k, r), well(a, at, w)]), energy
    x = np.linspace(-math.pi, math.pi, 15)
    y = x - r + 0.6 * rng.normal(size=15)
    return table(x, y), PchipInterpolator(x, y).antiderivative()


def compared(rng, contact, samples=6_001, kinds=4):
    """States that a search finds and those that a scan finds, of a random vertex of degree four."""
    a = rng.dirichlet([4] * 4) * 2 * math.pi
    while a.max() > 3.0:
        a = rng.dirichlet([4] * 4) * 2 * math.pi
    laws, energies = zip(*(drawn(rng, kinds) for _ in range(4)), strict=True)
    limits = rng.uniform(0.5, 3, (4, 2)) * (-1, 1) if rng.random() < 0.5 else ()
    scene = Scene(Vertex(tuple(a)), (1,) * 4, (0,) * 4, "none", contact, limits=limits, laws=laws)
    _, theirs = scan_four.minima(
        lambda x: sum(f(x[..., i]) for i, f in enumerate(energies)),
        np.array(scene.vertex.sector_angles),
        scene.limit_angles,
        contact,
        samples,
    )
    ours = np.array([m.fold_angles for m in o.find_minima(scene).minima])
    return ours.reshape(-1, 4), theirs


def agree(ours, theirs):
    apart = np.abs(ours[:, None] - theirs[None]).max(axis=2)
    return len(ours) == len(theirs) and (apart.min(axis=0) <= 2e-2).all()


@pytest.mark.parametrize(("seed", "contact"), thinned([(1, "full"), (2, "fold-limits")], 2))
def test_minima_are_those_of_a_scan(seed, contact):
    rng = np.random.default_rng(seed)
    assert all(agree(*compared(rng, contact)) for _ in range(1))
