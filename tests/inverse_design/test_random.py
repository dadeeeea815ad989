"""Random questions: every design verifies, refutations hold in rational numbers."""

from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
import pytest

from origami_nlp.errors import OrigamiError
from origami_nlp.inverse_design import solve
from origami_nlp.inverse_design.convex import ConvexDesign
from tests.inverse_design.exact import proved
from tests.inverse_design.questions import mixed

pytest.importorskip("clarabel")
AGREES = 1e-6


@dataclass
class Drawn:
    """Questions that were solved."""

    feasible: list[ConvexDesign] = field(default_factory=list)
    others: list[ConvexDesign] = field(default_factory=list)


def one_twice(targets):
    """Whether two targets were drawn that close to one state: `design` refuses them by name."""
    states = [p.state.x for p in targets.placed]
    return any(np.abs(a - b).max() < 1e-6 for a, b in combinations(states, 2))


def drawn(first, feasible):
    """Questions from a seed on, until so many have springs."""
    out = Drawn()
    seed = first
    while len(out.feasible) < feasible:
        asked = mixed(seed)
        seed += 1
        if asked is None or one_twice(asked):
            continue
        try:
            posed = solve(asked)
        except OrigamiError as error:
            assert "smooth pieces" in str(error)
            continue
        (out.feasible if posed.feasible else out.others).append(posed)
    return out


def check_exact(some):
    """What was refuted is, and what is largest is, by sums of rational numbers."""
    count = 0
    for posed in some:
        if posed.feasible and not all(b.regular for _, b, _ in posed.balances):
            continue
        if not posed.feasible and not posed.every_refuted:
            continue
        bound = proved(posed)
        if posed.answer.infeasible:
            assert bound is None
        else:
            assert bound <= max(posed.margin, 0.0) + AGREES
        count += 1
    return count


def test_rational_numbers_agree():
    some = drawn(5, 3)
    assert some.others
    assert check_exact(some.feasible + some.others) >= 3
