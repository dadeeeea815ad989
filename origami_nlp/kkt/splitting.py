"""A state judged on the union of many pieces, without listing them: sets are split by one choice after the other."""

from __future__ import annotations

from functools import partial

import numpy as np

from origami_nlp.kkt.certificates import BranchJudgement, judge_branch
from origami_nlp.kkt.descent_witness import DescentWitness, follow_descent
from origami_nlp.kkt.state import State
from origami_nlp.numerics import INDEPENDENT

MOST_SETS = 100
"""Sets of pieces that are judged."""


def judge_by_splitting(
    state: State, accuracy: float
) -> tuple[list[BranchJudgement] | DescentWitness, list[BranchJudgement]]:
    """Judge the union of pieces without listing them: split a set by one choice after the other.

    A minimum of a larger set is one of every piece of it, so most sets need no splitting.  Where one is none, its
    direction of descent passes some choice wholly, and the set is split by that; or it passes none, and leads to lower
    states.  Returns the sets of which x is a minimum, which cover all pieces, and the pieces (or sets, where there are
    too many) for which that could not be shown.  A lower state is returned at once.
    """
    tried: list[np.ndarray] = []
    good: list[BranchJudgement] = []
    failed: list[BranchJudgement] = []
    pending = [state.contacts.base]
    while pending:
        state.problem.check_time()
        rows = pending.pop()
        b = judge_branch(state.on(rows), accuracy)
        if b.verdict == "minimum":
            good.append(b)
            continue
        choices = state.choices
        free = choices.open(choices.said(rows))
        # a set that ignores a choice holds more states: where its way down closes every option, the choice forbids it
        passed = [
            k for d in (b.direction, *b.more) if d is not None for k in choices.passed(free, d)
        ]
        if not passed and _is_new(b.direction, tried):
            # what passes a choice leads through facets
            lower = follow_descent(state, b, partial(choices.open_along, free))
            if lower is not None:
                return lower, []
        if not free or len(good) + len(failed) + len(pending) > MOST_SETS:
            failed.append(b)
            break
        for option in choices.branches[passed[0] if passed else free[0]]:
            pending.append(tuple(dict.fromkeys((*rows, *option))))
    return good, failed


def _is_new(direction: np.ndarray | None, tried: list[np.ndarray]) -> bool:
    """Return whether a direction is none of those tried, and note it: sets that share contacts share their descent."""
    if direction is None or any(np.abs(direction - d).max() <= INDEPENDENT for d in tried):
        return False
    tried.append(direction)
    return True
