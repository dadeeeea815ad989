"""Sheets with hinge laws that fall: what is called a minimum has no lower closed state beside it."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import examples
from tests.independent.rigid import Rigid
from tests.independent.search_sheets import sheet_of
from tests.independent.strips import Strip
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


@pytest.mark.slow
@pytest.mark.parametrize("where", ["flat", "inside", "flat-folded"])
def test_no_top_of_many_wells_of_sheets_is_called_a_minimum(where):
    wrong, called = wrongly_called_minima(np.random.default_rng(2), where, 40, 300)
    assert not wrong and called < 40
