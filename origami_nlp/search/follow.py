"""From a start to where its descent ends, with an order of layers wherever facets come to lie on each other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from origami_nlp.numerics import BESIDE_SINGULAR, CLOSURE_TOL, DUPLICATE_TOL
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search.descend import (
    CLOSES_NOT,
    LEVEL,
    MOST_STEPS,
    CompiledDescent,
    DescentEnd,
    Slot,
    StartState,
)
from origami_nlp.search.layers import AJAR, LevelFaces, Order, leant, ordered_slots
from origami_nlp.search.starts import at_limits

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

    Attributes
    ----------
    work
        Evaluations of closure so far.
    level
        Facets that lie face to face.
    """

    def __init__(self, problem: PatternProblem) -> None:
        self.problem, self.descents, self.work = problem, CompiledDescent(problem), 0
        self.level = LevelFaces(problem)
        self._levels: dict[object, list[tuple[np.ndarray, np.ndarray, str]]] = {}

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
        problem, leaning = self.problem, start
        if problem.residual(start.x) > AJAR:
            # one that is symmetric closes to one of several states, by rounding
            leaning = replace(start, x=leant(problem, start.x, aside))
        (way,) = self.each([leaning], aside[None], known_end)
        x, why = way()
        moved = float(np.abs(x - start.x).max(initial=0.0))
        if not DUPLICATE_TOL < moved <= BESIDE_SINGULAR or problem.residual(start.x) > CLOSURE_TOL:
            return x, why
        # where closure loses rank what closes to rounding is no motion
        return (start.x, "") if problem.rank(start.x) < problem.rank(x, CLOSURE_TOL) else (x, why)

    def each(
        self,
        starts: Sequence[StartState],
        asides: np.ndarray,
        known_end: Callable[[np.ndarray], bool] = lambda x: False,
    ) -> list[Callable[[], tuple[np.ndarray, str]]]:
        """Return what tells where each of some starts leads: the first leg of all is made at once."""
        pauses = self.problem.contact
        opened = [bool(pauses and s.side.any() and not (s.hold or s.drawn)) for s in starts]
        first = [
            replace(s, hold=True, most=0) if o else s for s, o in zip(starts, opened, strict=True)
        ]
        legs = self.descents(first, asides, pauses)
        self.work += sum(leg.work for leg in legs)
        each = zip(starts, opened, legs, asides, strict=True)
        return [partial(self._onward, *given, known_end) for given in each]

    def _onward(
        self,
        start: StartState,
        folded: bool,
        end: DescentEnd,
        aside: np.ndarray,
        known_end: Callable[[np.ndarray], bool],
    ) -> tuple[np.ndarray, str]:
        known, slots, hold = set[Order](), start.slots, end.held
        if start.drawn and hold and end.why == LEVEL:
            # at rest with all that was drawn held: many starts come here, and go on alike
            key = (*end.side.tolist(), *sorted((*s.pieces, *s.places, s.sign) for s in end.slots))
            level = self._levels.setdefault(key, [])
            for x, onward, why in level:
                if np.abs(x - end.x).max() <= DUPLICATE_TOL:
                    return onward, why
            # facets that may lie either way go on otherwise the next time
            faces = self.level(end.x) if self._is_level(end.x) else None
            either = faces is not None and bool(faces.open)
            onward, why = self._onward(replace(start, drawn=False), False, end, aside, known_end)
            if not either:
                level.append((end.x, onward, why))
            return onward, why
        if folded:  # with creases fully folded that are free: their layers are ordered first
            if end.why == CLOSES_NOT:  # what is fully folded opens as it closes
                start = replace(start, side=np.zeros_like(start.side))
            elif (ordered := self._ordered(end.x, None, known, aside)) is None:
                return end.x, self._unordered(end.x)
            else:
                slots = (*slots, *ordered)
                start = replace(start, x=end.x, slots=slots)
            end = self._leg(start, aside)
        for _ in range(MOST_LEGS):
            if end.why != LEVEL:
                settled = not slots or np.abs(end.x - start.x).max() <= DUPLICATE_TOL
                if not end.arrived or settled or known_end(end.x):
                    return end.x, self._refusal(end, known_end) if end.arrived else end.why
                # gaps at corners of overlaps that are no corners any more hold it: ordered anew
            # facets that come to lie on each other stay on the side that they come from
            ordered = self._ordered(end.x, None if hold else end.begun, known, aside)
            if ordered is None:
                return end.x, NO_ORDER
            hold, slots = False, (*end.slots, *ordered)
            start = StartState(end.x, end.side, slots)
            end = self._leg(start, aside)
        return end.x, NOWHERE

    def steps(self, x: np.ndarray, aside: np.ndarray, longest: float) -> np.ndarray:
        """Return where steps downhill, of a length at most [rad], lead from a closed state, [S, n]."""
        problem, known, out = self.problem, set[Order](), [np.zeros((0, len(x)))]
        path, before, slots = np.zeros((MOST_STEPS, len(x))), None, tuple[Slot, ...]()
        start = StartState(x, at_limits(problem, x))
        for _ in range(MOST_LEGS):
            ordered = self._ordered(start.x, before, known, aside)
            if ordered is None:
                break
            start = replace(start, slots=(*slots, *ordered))
            (end,) = self.descents([start], aside[None], problem.contact, longest, path)
            self.work += end.work
            out.append(path[: end.steps + (end.why == LEVEL)].copy())
            if end.why != LEVEL:
                break
            slots, before = end.slots, end.begun
            start = StartState(end.x, end.side)
        return np.concatenate(out)

    def _leg(self, start: StartState, aside: np.ndarray) -> DescentEnd:
        (end,) = self.descents([start], aside[None], self.problem.contact)
        self.work += end.work
        return end

    def _refusal(self, end: DescentEnd, known_end: Callable[[np.ndarray], bool]) -> str:
        """Return why an end that is not known is no state: paper may run through a fold that is level by itself."""
        if not self._is_level(end.x) or known_end(end.x):
            return ""
        return self._unordered(end.x)

    def _unordered(self, x: np.ndarray) -> str:
        """Return that layers have no order; "" where they may have one, which the judge of the state decides."""
        return NO_ORDER if self.problem.faces(x).crosses else ""

    def _is_level(self, x: np.ndarray) -> bool:
        """Return whether creases are fully folded whose facets must not cross."""
        return bool(self.problem.contact and at_limits(self.problem, x).any())

    def _ordered(
        self, x: np.ndarray, before: np.ndarray | None, known: set[Order], aside: np.ndarray
    ) -> tuple[Slot, ...] | None:
        if not self._is_level(x):
            return ()
        return ordered_slots(self.level, x, before, known, aside)
