"""Sheets with hinge laws that fall: states at tops of wells, and detents against a search that shares no code."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import examples
from origami_nlp.pattern import detent, linear, polynomial, sum_of
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import judge
from tests.independent.rigid import Rigid
from tests.independent.search_sheets import minima, sheet_of
from tests.independent.strips import Strip
from tests.minima.test_hinge_laws import strip
from tests.minima.test_tops_of_wells import balanced

NEAR, LOWER = 0.06, 1e-5
"""Distance [rad] within which closed states are drawn, and by how much [J] one is lower."""


@lru_cache
def folded_flat(creases):
    """Miura's own way of folding, to its end: along it no crease changes its sign."""
    pattern = examples.pattern("miura", *{7: (2, 3), 12: (3, 3)}[creases])
    some = o.find_minima(pattern, starts=2, escape=False, prove=False).minima
    folded = next(m for m in some if np.abs(m.fold_angles).min() > 1e-3)
    return math.pi * np.sign(folded.fold_angles)


def some_state(rng, where):
    """A pattern of vertices and a closed state of it."""
    if where == "inside":
        pattern = examples.pattern("metasheet", 2, 3)
        signs = tuple(rng.choice([-1, 1], 2))
        return pattern, Strip(pattern).at(signs, rng.uniform(0.1, 0.6))[0]
    pattern = examples.pattern("miura", *((2, 3), (3, 3))[rng.integers(2)])
    if where == "flat":
        return pattern, np.zeros(pattern.creases)
    return pattern, folded_flat(pattern.creases)


def wrongly_called_minima(rng, where, count, around=60):
    """Draw sheets balanced at a state; count those called minima that have lower neighbours, and all minima."""
    wrong = called = 0
    for _ in range(count):
        pattern, x = some_state(rng, where)
        hills = rng.uniform()
        laws, energies = zip(*(balanced(rng, c, hills) for c in x), strict=True)
        verdict = o.classify(pattern.with_laws(laws), x).verdict
        sheet = sheet_of(pattern)
        steps = rng.normal(size=(around, sheet.n)) * rng.uniform(0.005, 0.05, (around, 1))
        near, good = sheet.closed(np.clip(x + steps, -math.pi, math.pi), 60, 1e-13)
        good &= (np.abs(near) <= math.pi).all(axis=1) & (np.abs(near - x).max(axis=1) < NEAR)

        def energy(y, energies=energies):
            return sum(f(y[..., i]) for i, f in enumerate(energies))

        assert where == "flat-folded" or good.any()
        low = near[good & (energy(near) < energy(x) - LOWER)]
        lower = any(not Rigid(pattern).collide(y) for y in low[:10])
        called += verdict == "minimum"
        wrong += verdict == "minimum" and lower
    return wrong, called


@pytest.mark.parametrize("where", ["flat", "inside"])
def test_no_top_of_a_well_of_a_sheet_is_called_a_minimum(where):
    wrong, called = wrongly_called_minima(np.random.default_rng(1), where, 3)
    assert not wrong and called < 3


def compared(starts):
    """A Miura sheet with detents: what is found, and minima of another search that are none of it.

    Its descents also end where rank is nearly lost: what has lower closed states beside it is left out.
    """
    pattern = examples.pattern("miura", 3, 3)
    law = sum_of([linear(1.0), detent(1.0, 5)])
    sheet, limits = pattern.with_laws([law] * 12), np.array([[-math.pi] * 12, [math.pi] * 12])
    closure, rng = sheet_of(pattern), np.random.default_rng(0)

    def energy(x):
        return (0.5 * x**2 + 0.5 * (1 - np.cos(5 * x))).sum(axis=-1)

    theirs = minima(closure, energy, lambda x: x + 2.5 * np.sin(5 * x), limits, starts, rng)
    result = o.find_minima(sheet, escape=False, prove=False)
    ours = np.array([m.fold_angles for m in result.minima])
    apart = np.abs(theirs[:, None] - ours[None]).max(axis=2)
    assert sheet_of(pattern).closed(ours, 0)[1].all()
    others = []
    for x in theirs[apart.min(axis=1) > 1e-2]:
        near, good = closure.closed(x + rng.uniform(-0.05, 0.05, (300, 12)), 60)
        good &= (np.abs(near) <= math.pi).all(axis=1) & (np.abs(near - x).max(axis=1) < NEAR)
        if energy(near[good]).min() > energy(x) - 1e-4 and not Rigid(pattern).collide(x):
            others.append(x)
    return theirs, others


@pytest.mark.slow
def test_a_sheet_with_detents_has_the_minima_of_another_search():
    """Among them: both straight lines in their second wells, to opposite sides, which descents seldom reach."""
    theirs, others = compared(4_000)
    assert len(theirs) >= 20 and not others


QUARTIC = polynomial([0.0, 0.0, 1.0], 0.5)


def test_a_state_without_stiffness_is_not_decided():
    # at the bottom itself nothing is certified; its energy is 0, not what rounding leaves
    at = judge(PatternProblem(strip(1).with_laws([QUARTIC])), np.array([0.5]))
    assert (at.verdict, at.energy) == ("undecided", 0.0)
    found = o.find_minima(strip(1).with_laws([QUARTIC]), escape=False)
    assert [s.energy for s in found.minima] == [0.0] and not found.search.undecided
