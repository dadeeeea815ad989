"""Rounds of descents; every new end is polished and judged when it arrives."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.kkt import (
    Classification,
    Polished,
    Solve,
    State,
    classify,
    exact_beside,
    polish,
)
from origami_nlp.minima.descents import Descents, Ends, Samples
from origami_nlp.minima.starts import IN_ROUNDS
from origami_nlp.numerics import BESIDE, SAME
from origami_nlp.programme import OPEN, Contact, Model, fold_limit

ALIKE = 3e-5
"""Ends of descents that differ by no more [rad] are judged once."""
DOWN = 0.05
"""First step [rad] down either side of a saddle."""


@dataclass(eq=False)
class Answer:
    """A distinct state that descents ended at: its polish, how many reached it, what it was judged to be.

    hits: over all starts.  in_rounds: over those of rounds, which are alike.  listed: found by listing, not by descent.
    """

    polished: Polished
    hits: int = 0
    in_rounds: int = 0
    listed: bool = False
    what: Classification | None = None

    @property
    def is_minimum(self) -> bool:
        """Whether it was judged to be a minimum."""
        return self.what is not None and self.what.verdict == "minimum"


@dataclass
class Record:
    """Everything a search did, failures included.

    answers: distinct states.  starts: drawn.  feasible: admissible among them.  stalled: descents that ended nowhere.
    by_source: starts, by kind.
    """

    answers: list[Answer] = field(default_factory=list)
    starts: int = 0
    feasible: int = 0
    stalled: int = 0
    by_source: Counter[int] = field(default_factory=Counter)

    @property
    def minima(self) -> list[Answer]:
        """The answers that are minima."""
        return [a for a in self.answers if a.is_minimum]


class Search:
    """Descents of one model, their ends judged and counted."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.record = Record()
        self._descents = Descents(model)
        self._ends: list[np.ndarray] = []  # as descents left them
        self._answer_of: list[Answer | None] = []

    def list_state(self, x: np.ndarray) -> None:
        """File and judge a state that was listed, not descended to."""
        if self._known(x) is None:
            closure = float(np.abs(self.model.closure(x)[0]).max())
            answer = Answer(Polished(x, (), closure, math.nan, True), listed=True)
            self.record.answers.append(answer)
            self._judge(answer)

    def run(self, starts: Samples, *, count: bool = True) -> None:
        """Descend from starts (those that cross are dropped), and judge what is new among the ends."""
        record = self.record
        feasible = self._feasible(starts)
        if count:
            record.starts += len(starts)
            record.feasible += int(feasible.sum())
            record.by_source.update(starts.source.tolist())
        if not feasible.any():
            return
        ends = self._descents.run(starts[feasible])
        good = ends.converged | ends.settled
        record.stalled += int((~good).sum()) if count else 0
        below = self._file(ends, np.flatnonzero(good), count)
        if below:
            self.run(self._closed(np.array(below)), count=False)

    def _feasible(self, starts: Samples) -> np.ndarray:
        crossings = self._descents.crossings
        good = np.isfinite(starts.x).all(axis=1)
        if not crossings.any:
            return good
        at = self._descents.kinematics.fold(starts.x)
        gap, _ = crossings.of(at, starts.slots)
        return good & (gap == OPEN)

    def _closed(self, x: np.ndarray) -> Samples:
        """Free samples at states [K, n], closed; those that do not close are dropped."""
        s = self._descents.close(Samples.on(np.clip(x, -self.model.bound, self.model.bound)))
        value, _ = self._descents.kinematics.closure(self._descents.kinematics.fold(s.x))
        return s[np.abs(value).max(axis=1) <= SAME]

    def _file(
        self, ends: Ends, which: np.ndarray, count: bool
    ) -> list[np.ndarray]:
        """File ends under the answers that they are; returns starts below new saddles."""
        below: list[np.ndarray] = []
        x = ends.samples.x
        while len(which):
            first = which[0]
            same = np.abs(x[which] - x[first]).max(axis=1) <= ALIKE
            hit, which = which[same], which[~same]
            answer, new = self._answer_at(ends.samples, int(first))
            if answer is None:
                continue
            if count:
                answer.hits += len(hit)
                answer.in_rounds += int(np.isin(ends.samples.source[hit], IN_ROUNDS).sum())
            if new and answer.what is not None and answer.what.descent is not None:
                d = DOWN * answer.what.descent
                below += [answer.polished.x + d, answer.polished.x - d]
        return below

    def _answer_at(self, s: Samples, k: int) -> tuple[Answer | None, bool]:
        """Return the answer that an end is, and whether it is new."""
        x = s.x[k]
        if self._ends:
            apart = np.abs(np.array(self._ends) - x).max(axis=1)
            nearest = int(apart.argmin())
            if apart[nearest] <= ALIKE:
                return self._answer_of[nearest], False
        answer, new = self._settle(s, k)
        self._ends.append(x)
        self._answer_of.append(answer)
        return answer, new

    def _settle(self, s: Samples, k: int) -> tuple[Answer, bool]:
        """Polish an end and file it under the answer that it is, or as a new one, which is judged."""
        polished = polish(self.model, _as_answer(s, k), _held(s, k))
        if not polished.converged:
            polished = self._listed_beside(polished) or exact_beside(self.model, polished)
        for known in self.record.answers:
            if _is_same(known.polished, polished):
                if polished.converged and not known.polished.converged:
                    known.polished = polished
                    self._judge(known)
                    return known, True
                return known, False
        answer = Answer(polished)
        self.record.answers.append(answer)
        self._judge(answer)
        return answer, True

    def _judge(self, answer: Answer) -> None:
        p = answer.polished
        answer.what = classify(State(self.model, p.x), polished=p.converged)

    def _known(self, x: np.ndarray) -> Answer | None:
        near = (a for a in self.record.answers if np.abs(a.polished.x - x).max() <= SAME)
        return next(near, None)

    def _listed_beside(self, state: Polished) -> Polished | None:
        """Return the nearest exact state on record within `BESIDE` of a state, or None."""
        exact = [a.polished for a in self.record.answers if a.polished.converged]
        near = [float(np.abs(known.x - state.x).max()) for known in exact]
        return exact[int(np.argmin(near))] if near and min(near) <= BESIDE else None


def _is_same(one: Polished, other: Polished) -> bool:
    """Tell whether two states are one, as far as their accuracy says."""
    exact = one.converged and other.converged
    near = max(SAME, one.uncertainty + other.uncertainty) if exact else BESIDE
    return bool(np.abs(one.x - other.x).max() <= near)


def _as_answer(s: Samples, k: int) -> Solve:
    """The end of a descent as the polish reads it: all contacts that it holds press."""
    return Solve(s.x[k], "", 0, math.nan, np.abs(s.shut[k]).astype(float), None)


def _held(s: Samples, k: int) -> tuple[Contact, ...]:
    """The contacts that an end holds."""
    limits = [fold_limit(int(v), s.shut[k, v]) for v in np.flatnonzero(s.shut[k])]
    slots = zip(s.slots[k].tolist(), s.sides[k].tolist(), strict=True)
    gaps = [Contact("gap", gap, side) for gap, side in slots if gap != OPEN]
    return tuple(dict.fromkeys((*limits, *gaps)))
