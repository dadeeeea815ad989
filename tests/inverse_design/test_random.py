"""Random questions: every design verifies, a second solver agrees, refutations hold in rational numbers."""

import math
from collections import Counter
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
import pytest

from origami_nlp.errors import OrigamiError
from origami_nlp.inverse_design import design, solve
from origami_nlp.inverse_design.convex import ConvexDesign
from tests.inverse_design.exact import proved
from tests.inverse_design.questions import mixed
from tests.inverse_design.second import ask, can_be_asked

pytest.importorskip("clarabel")
AGREES = 1e-6
CHUNKS, FEASIBLE = 10, 20


@dataclass
class Drawn:
    """Questions that were solved."""

    feasible: list[ConvexDesign] = field(default_factory=list)
    others: list[ConvexDesign] = field(default_factory=list)
    refused: int = 0


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
            out.refused += 1
            continue
        (out.feasible if posed.feasible else out.others).append(posed)
    return out


def check_second_solver(some):
    """The same question, posed by other code and answered by another solver, has the same margin or none."""
    pytest.importorskip("cvxpy")
    pytest.importorskip("scs")
    some = [p for p in some if can_be_asked(p)]
    for posed, again in zip(some, ask(some), strict=True):
        assert not math.isnan(again)
        if posed.answer.infeasible:
            assert again == -math.inf
        else:
            assert posed.answer.solved
            assert again == pytest.approx(posed.margin, abs=AGREES)
    return len(some)


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


@pytest.mark.slow
def test_a_second_solver_agrees():
    some = drawn(5, 4)
    assert check_second_solver(some.feasible[-2:] + some.others[:2]) >= 3


@pytest.mark.slow
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_two_hundred_random_designs_verify(chunk):
    some = drawn(1000 * chunk, FEASIBLE)
    every = some.feasible + some.others
    again, exact = check_second_solver(every), check_exact(every)
    failed, kinds, extra = [], Counter(), 0
    for posed in some.feasible:
        found = design(posed.targets, effort="quick")
        if not found.verified:  # (a quick search may miss a state)
            found = design(posed.targets)
        extra += len(found.extra_minima)
        names = [s.name for s in found.states]
        kinds[found.scene.degree, len(names)] += 1
        kinds.update(name.split(", ")[1] for name in names)
        if not found.verified or max(s.found for s in found.states) > 1e-9:
            failed.append((found.scene.degree, names, found.failed))
    print(
        f"chunk {chunk}: {len(some.feasible)} feasible, {len(failed)} fail; "
        f"{sum(p.every_refuted for p in some.others)} refuted, "
        f"{sum(not p.every_refuted for p in some.others)} open, {some.refused} refused; second solver {again}, "
        f"rational {exact}; extra minima {extra}; touching {sum(bool(p.touching) for p in some.feasible)}; {kinds}; "
        f"{failed}",
        flush=True,
    )
    assert not failed
