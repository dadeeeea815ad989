"""Ways down of a vertex, from guesses and then from random starts; every new end is judged when it arrives."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from origami_nlp.kkt import Polished, Solve, State, polish, project, singular_beside
from origami_nlp.minima.record import (
    BREAKDOWNS,
    FoundState,
    Record,
    close_orbit,
    closes,
    exact_state,
    judge,
)
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL
from origami_nlp.pattern import canonical_labels
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem, pose
from origami_nlp.problem import Model
from origami_nlp.search import (
    CLOSES_NOT,
    DEEP,
    NO_LOWER,
    ByIpopt,
    Draws,
    StartState,
    at_limits,
    on_grid,
    way_down,
)
from origami_nlp.starts import Moments, is_chain

FEWEST_FOR_MOMENTS = 16
"""Creases from which moments are started from: with 10 and 12 they found no more in the same time."""
BREAKDOWN = "linear algebra broke down on the way"
"""Why a descent failed that has no end."""
Way = Callable[[], tuple[np.ndarray, str]]


class Search:
    """Ways down of one scene, their ends judged and counted.

    Parameters
    ----------
    sides
        Model and record of each winding whose states are searched for.
    seed
        Of what is drawn.
    ipopt
        Whether IPOPT goes down, one solve a start.
    """

    def __init__(
        self, sides: Sequence[tuple[Model, Record]], seed: int, *, ipopt: bool = False
    ) -> None:
        self._sides = sides
        self.model, self.record = sides[0]
        scene = self.model.scene
        # under labels that do not depend on how the scene is labelled; forces count from a facet
        named = scene.group.is_trivial and not scene.loads
        self._labels = canonical_labels(scene) if named else None
        self._problem, under = self.record.problem, self.model
        if self._labels:
            other = self._labels.relabelled(scene)
            self._problem, under = pose(other), Model(other)
        n = self._problem.size
        self._along = np.ones(n)
        more = [Moments(under)] if n >= FEWEST_FOR_MOMENTS and is_chain(under) else []
        self._draws = Draws(
            self._problem, CanonicalLabelling(np.arange(n), 1.0, False, ()), seed, more
        )
        self._go_down = way_down(self._problem, ipopt=ipopt)
        self._by_ipopt = isinstance(self._go_down, ByIpopt)
        self._ends = np.zeros((0, n))
        self._answers: list[FoundState | None] = []  # of each end; None: of no winding, or no state
        self._minima = 0
        self._count()
        for answer in self._known():
            self._feed(answer)

    def from_states(self, states: Sequence[np.ndarray]) -> None:
        """Go down from states [n] of the scene, which are not counted."""
        for state in states:
            self._follow(project(self._problem, self._under(state))[0])

    def draw(self, most: int) -> None:
        """Go down from the next random starts, so many at most; there are none of a family without minima."""
        name, starts, asides = self._draws.next(most)
        record = self.record
        for way in self._go_down.each(starts, asides, self._is_end):
            record.starts += 1
            record.by_source[name] += 1
            before = self._minima
            closed = self._arrive(way, counted=True)
            self._draws.note(name, self._minima - before, closed)
            record.feasible_starts += closed
            for _, each in self._sides:
                each.drawn += closed

    @property
    def made(self) -> int:
        """Random starts so far, those that did not close among them."""
        return self._draws.made

    def _count(self) -> None:
        self._minima = sum(answer.is_minimum for answer in self._known())

    def _known(self) -> Iterator[FoundState]:
        return itertools.chain.from_iterable(record.answers for _, record in self._sides)

    def _under(self, x: np.ndarray) -> np.ndarray:
        """Bring a state [n] of the scene to the labels of descents."""
        return self._labels.sign * x[self._labels.creases] if self._labels else x

    def _at_end(self, x: np.ndarray) -> np.ndarray:
        """Return numbers of the ends that a state is."""
        return np.flatnonzero(np.abs(self._ends - x).max(axis=1, initial=0.0) <= DUPLICATE_TOL)

    def _is_end(self, x: np.ndarray) -> bool:
        return bool(len(self._at_end(x)))

    def _follow(self, x: np.ndarray, deep: int = DEEP) -> None:
        """Go down from a state under the labels of descents."""
        start = StartState(x, at_limits(self._problem, x))
        self._arrive(partial(self._go_down, start, self._along, self._is_end), deep)

    def _arrive(self, way: Way, deep: int = DEEP, *, counted: bool = False) -> bool:
        """File where a way down ends; return whether it could begin."""
        record = self.record
        before = self._go_down.work
        try:
            x, why = way()
        except BREAKDOWNS:
            record.failed[BREAKDOWN] += 1
            return False
        if self._by_ipopt:
            record.solves += 1
            record.iterations += self._go_down.work - before
            record.statuses[why or "Solve_Succeeded"] += 1
        if why == NO_LOWER and (near := singular_beside(self._problem, x)) is not None:
            x, why = near, ""  # it is not told from that state, where closure loses rank
        if why:
            record.stalled += why != CLOSES_NOT
            return why != CLOSES_NOT
        known, new = self._at_end(x), False
        if len(known):
            answer = self._answers[known[0]]
        else:
            answer, new = None, False
            with record.surviving("the end of a descent"):
                answer, new = self._filed(x)
            self._ends = np.vstack([self._ends, x])
            self._answers.append(answer)
        if answer is None:
            return True
        if counted:
            answer.hits += 1
            answer.in_rounds += 1
            answer.first = answer.first or record.drawn + 1
        if new:
            self._feed(answer, deep)
        return True

    def _filed(self, x: np.ndarray) -> tuple[FoundState | None, bool]:
        """Judge a new end, file it under its winding, and return it; whether it was not known otherwise."""
        x = self._labels.back(x) if self._labels else x
        model, record = min(self._sides, key=lambda side: missed(side[0], x))
        if not closes(model, x) or missed(model, x) > DUPLICATE_TOL:
            return None, False
        if not model.has_limits and np.abs(x).max() >= self._problem.bound:
            return None, False  # folds beyond whole turns are not modelled
        answer, new = record.file(model, polished(record.problem, x))
        if new:
            judge(record, answer)
            if answer.is_minimum:
                close_orbit(model, record, answer)
                self._count()
        return answer, new

    def _feed(self, answer: FoundState, deep: int = DEEP) -> None:
        """Start from a minimum changed, later; from beside what is none go on now."""
        x = answer.polished.x
        if answer.is_minimum and x.any():
            images = [sign * x[order] for order, sign in self.model.own_symmetries]
            self._draws.changed.add(*(on_grid(self._problem, self._under(y)) for y in images))
        elif answer.what is not None and answer.what.lower is not None and deep:
            self._follow(self._under(answer.what.lower), deep - 1)


def polished(problem: PatternProblem, x: np.ndarray) -> Polished:
    """Return the end of a descent [n] as Newton leaves it, what is closed there held."""
    at = State(problem, x)
    if at.refused:
        return exact_state(problem, x)
    end = Solve(x, "", 0, math.nan, np.abs(at_limits(problem, x)), None)
    state = polish(problem, end, at.pieces[0])
    if state.converged:
        return state
    return exact_state(problem, state.x if problem.residual(state.x) <= CLOSURE_TOL else x)


def missed(model: Model, x: np.ndarray) -> float:
    """Return how far a state [n] is from closing with the winding of a model."""
    return float(np.abs(model.closure(x)[0]).max())
