"""Which boxes of facets meet: against all pairs, in an order that rounding does not choose."""

import itertools

import numpy as np
import pytest

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern_problem.crossings import boxes_that_meet


@pytest.mark.parametrize("seed", range(4))
def test_boxes_that_begin_level_are_found_in_one_order_whatever_rounding_makes_of_them(
    seed,
) -> None:
    rng = np.random.default_rng(seed)
    low = rng.integers(0, 4, (60, 3)).astype(float)
    high = low + 0.25 + rng.integers(0, 2, (60, 3))
    meet = {
        (i, j)
        for i, j in itertools.combinations(range(60), 2)
        if all(low[i, k] <= high[j, k] and low[j, k] <= high[i, k] for k in range(3))
    }
    orders = []
    for size in (0.0, 1e-15, 1e-15, 1e-15):
        near = low + size * rng.normal(size=(60, 3))
        a, b = boxes_that_meet(near - CLOSURE_TOL, high + CLOSURE_TOL)
        orders.append(list(zip(a.tolist(), b.tolist(), strict=True)))
    assert {(min(pair), max(pair)) for pair in orders[0]} == meet and len(meet) > 40
    assert len(orders[0]) == len(meet) and all(order == orders[0] for order in orders)
