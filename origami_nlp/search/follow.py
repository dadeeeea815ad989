"""From a start to where its descent ends, with an order of layers wherever facets come to lie on each other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from origami_nlp.numerics import BESIDE_SINGULAR, CLOSURE_TOL, DUPLICATE_TOL
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search.descend import (
    CLOSES_NOT,
    LEVEL,
    MOST_STEPS,
    SLOTS,
    CompiledDescent,
    DescentEnd,
    Slot,
)
from origami_nlp.search.layers import AJAR, Order, ajar, leant, ordered_slots
from origami_nlp.search.starts import StartState

MOST_LEGS = 40
"""Times that facets come to lie on each other on one way down."""
NO_ORDER = "facets that lie on each other have no order"
NOWHERE = "facets come to lie on each other again and again"


class Follower:
    """Ways down of a problem.

    Parameters
    ----------
    problem
        The problem.
    """

    def __init__(self, problem: PatternProblem) -> None:
        self.problem, self.descents = problem, CompiledDescent(problem)

    @property
    def usable(self) -> bool:
        """Whether descents are compiled, and the pattern is small enough."""
        return self.descents.usable

    def __call__(
        self,
        start: StartState,
        aside: np.ndarray,
        known_end: Callable[[np.ndarray], bool] = lambda x: False,
    ) -> tuple[np.ndarray, str]:
        """Return where a start leads, [n], and why it ends there: ``""`` where that is stationary on what it holds.

        Parameters
        ----------
        start
            The start; it need not close.
        aside
            Direction [n] that says to which side saddles are left, and how facets lie where they may lie either way.
        known_end
            Whether an end is known: then it is asked no further.
        """
        x, why = self._down(start, aside, known_end)
        moved, problem = float(np.abs(x - start.x).max(initial=0.0)), self.problem
        if not DUPLICATE_TOL < moved <= BESIDE_SINGULAR or problem.residual(start.x) > CLOSURE_TOL:
            return x, why
        # where closure loses rank what closes to rounding is no motion
        return (start.x, "") if problem.rank(start.x) < problem.rank(x, CLOSURE_TOL) else (x, why)

    def _down(
        self,
        start: StartState,
        aside: np.ndarray,
        known_end: Callable[[np.ndarray], bool],
    ) -> tuple[np.ndarray, str]:
        x, side, slots, hold = start.x, start.side, start.slots, start.hold
        if (
            self.problem.residual(x) > AJAR
        ):  # one that is symmetric closes to one of several states, by rounding
            x = leant(self.problem, x, aside)
        known = set[Order]()
        if side.any() and not hold:
            end = self._leg(x, side, slots, True, aside, 0)
            if end.why == CLOSES_NOT:  # what is fully folded opens as it closes
                side = np.zeros_like(side)
            elif (ordered := self._ordered(end.x, None, known, aside)) is None:
                return end.x, NO_ORDER
            else:
                x, slots = end.x, (*slots, *ordered)
        for _ in range(MOST_LEGS):
            end = self._leg(x, side, slots, hold, aside)
            if end.why != LEVEL:
                settled = not slots or np.abs(end.x - x).max() <= DUPLICATE_TOL
                if not end.arrived or settled or known_end(end.x):
                    return end.x, "" if end.arrived else end.why
                # gaps at corners of overlaps that are no corners any more hold it: ordered anew
            # facets that come to lie on each other stay on the side that they come from
            before = None if hold else x
            x, side, hold = end.x, end.side, False
            if (ordered := self._ordered(x, before, known, aside)) is None:
                return x, NO_ORDER
            slots = (*(s for s in end.slots if s.pieces[0] >= 0), *ordered)
        return x, NOWHERE

    def _leg(
        self,
        x: np.ndarray,
        side: np.ndarray,
        slots: tuple[Slot, ...],
        hold: bool,
        aside: np.ndarray,
        most: int = MOST_STEPS,
    ) -> DescentEnd:
        pauses = self.problem.contact
        return self.descents(x, side, slots[:SLOTS], hold, aside, pauses, most)

    def _ordered(
        self, x: np.ndarray, before: np.ndarray | None, known: set[Order], aside: np.ndarray
    ) -> tuple[Slot, ...] | None:
        if not self.problem.contact:
            return ()
        beside = ajar(self.problem, x, aside) if before is None else before
        return ordered_slots(self.problem, x, beside, known)
