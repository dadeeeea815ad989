"""Rounds of descents; every new end is polished and judged when it arrives."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable

import numpy as np

from origami_nlp.kkt import Solve, State
from origami_nlp.minima.descents import Descents
from origami_nlp.minima.record import FoundState, Record, close_orbit, judge
from origami_nlp.numerics import ALIKE, DUPLICATE_TOL, NEAR_CONTACT, OUTSIDE, ROUNDED
from origami_nlp.pattern import Relabelling
from origami_nlp.problem import OPEN, Contact, Model
from origami_nlp.starts import DRAWN, GIVEN, SOURCES, Ends, Samples, joined

BREAKDOWN = "linear algebra broke down on the way"
"""Why a descent failed that has no end."""
EARLY = 64
"""Descents that are made before their ends are judged, by each thread."""
FIRST = 16
"""The same of the first ones: a first answer early."""
DOWN = 0.05
"""First step [rad] down either side of a saddle."""


class Search:
    """Descents of one model, their ends judged and counted.

    Parameters
    ----------
    model
        Of the scene as it is stated.
    under
        The same scene under other labels, where descents are made, and these labels; None: `model` itself.
    workers
        Threads that share descents.
    found
        Called after each new minimum.
    until
        Times of `time.monotonic` after which descents stop, and after which no further end is judged.
    """

    def __init__(
        self,
        model: Model,
        record: Record,
        under: tuple[Model, Relabelling] | None,
        workers: int = 1,
        found: Callable[[], None] = lambda: None,
        until: tuple[float, float] = (math.inf, math.inf),
    ) -> None:
        self.model, self.record = model, record
        self._labels = under[1] if under else None
        self._descents = Descents(under[0] if under else model, until=until[0], threads=workers)
        self._ends = np.empty((1024, model.size))  # as descents left them: with room to spare
        self._answer_of: list[FoundState] = []
        self._below: list[np.ndarray] = []  # uncounted starts, for the next batch
        self._workers, self._found, self._until = workers, found, until[1]
        self._gap_of = _gap_under(model, *under) if under else np.zeros(0)

    @property
    def usable(self) -> bool:
        """Whether descents are compiled, as there is a compiler, and there are no forces in space."""
        return self._descents.usable

    def also_from(self, x: Iterable[np.ndarray]) -> None:
        """Start from states [n] of the scene with the next batch; like guesses, they are not counted."""
        self._below += list(x)

    def run(self, starts: Samples | None = None) -> None:
        """Descend from starts (those that cross are dropped), and judge what is new among the ends.

        Starts either side of the saddles found before go with them: a batch costs by the call more than by the sample.
        Without starts, all that is below saddles is looked at.
        """
        record = self.record
        while starts is not None or self._below:
            below = self.closed(np.array(self._below).reshape(-1, self.model.size))
            some = below if starts is None else joined(starts, below)
            self._below = []
            feasible, counted = self._feasible(some), some.source != GIVEN
            record.starts += int(counted.sum())
            record.feasible_starts += int((feasible & counted).sum())
            for source, name in enumerate(SOURCES):
                record.by_source[name] += int((some.source == source).sum())
            parts = self._parts(some[feasible])
            for part in parts:
                if time.monotonic() > self._descents.until:
                    return
                ends = self._descents.run(part)
                good = ends.converged | ends.settled
                nowhere = ~good & ~ends.broken
                record.stalled += int((nowhere & (ends.samples.source != GIVEN)).sum())
                record.failed[BREAKDOWN] += int(ends.broken.sum())
                self._file(ends, np.flatnonzero(good))
                record.drawn += int(np.isin(ends.samples.source, DRAWN).sum())
            if starts is not None:
                break

    def minima_on_touches(self) -> list[tuple[list[tuple[int, int]], list[int]]]:
        """Return rows (crease on facet) and closed creases of the minima where facets touch, as descents label them."""
        model, out = self._descents.model, []
        for answer in self.record.minima:
            closed = State(model, self._under(answer.polished.x)).contacts
            rows = {c.index for pair in closed.branches for option in pair for c in option}
            if rows:
                touches = [model.structure.gaps[i].rays for i in sorted(rows)]
                at_limit = [c.index for c in closed.base if c.is_limit]
                out.append(([(r[0], r[1]) for r in touches], at_limit))
        return out

    def _parts(self, starts: Samples) -> list[Samples]:
        """Split starts in batches whose sizes do not depend on who makes them, small ones first: early answers."""
        early, most = FIRST * self._workers, EARLY * self._workers
        first, rest = np.split(np.arange(len(starts)), [0 if self._answer_of else early])
        split = [first, *np.array_split(rest, -(-len(rest) // most) or 1)]
        return [starts[part] for part in split if len(part)]

    def _feasible(self, starts: Samples) -> np.ndarray:
        crossings = self._descents.crossings
        good, limits = np.isfinite(starts.x).all(axis=1), self._descents.model.fold_limits
        if not limits.are_flat and self.model.has_limits:  # starts in closed form know +-pi only
            good &= limits.inside(starts.x, OUTSIDE).all(axis=1)
        if not crossings.any:
            return good
        at = self._descents.closing.kinematics.fold(starts.x)
        gap, _ = crossings.of(at, starts.x, limits.folded_flat(starts.at_limit))
        return good & (gap == OPEN)

    def closed(self, x: np.ndarray, *, touching: bool = False) -> Samples:
        """Return samples at states [K, n] of the scene, closed; those that do not close are dropped.

        touching: hold the contacts that are closed there until they pull, so that the first step runs into none.
        """
        x = np.array([self._under(state) for state in x]).reshape(x.shape)
        x = self._descents.model.fold_limits.clip(x)
        s = Samples.on(x, source=GIVEN)
        for k in range(len(x) * touching):
            for contact in State(self._descents.model, x[k], NEAR_CONTACT).pieces[0]:
                if contact.is_limit:
                    contact.hold(s.x[k])
                    s.at_limit[k, contact.index] = contact.side
                elif OPEN in s.slots[k]:
                    slot = s.slots[k].tolist().index(OPEN)
                    s.slots[k, slot], s.sides[k, slot] = contact.index, contact.side
        s = self._descents.closing.close(s, 12, ROUNDED)
        value, _ = self._descents.closing.kinematics.closure(
            self._descents.closing.kinematics.fold(s.x)
        )
        return s[np.abs(value).max(axis=1) <= DUPLICATE_TOL]

    def _file(self, ends: Ends, which: np.ndarray) -> None:
        """File ends under the answers that they are, and note starts below new saddles."""
        x, source = ends.samples.x, ends.samples.source
        drawn, counted = np.isin(source, DRAWN), source != GIVEN
        number = self.record.drawn + np.cumsum(drawn)  # of random starts up to each
        while len(which) and time.monotonic() <= self._until:
            # all ends that are one state as its first, then those that are left
            same = np.abs(x[which] - x[which[0]]).max(axis=1) <= ALIKE
            hit, which = which[same], which[~same]
            answer, new = self._answer_at(ends.samples, int(hit[0]))
            if answer.lost:
                self.record.failed[answer.lost] += len(hit)
            answer.hits += int(counted[hit].sum())
            answer.in_rounds += int(drawn[hit].sum())
            if answer.first == 0 and drawn[hit].any():
                answer.first = int(number[hit][drawn[hit]].min())
            if new and answer.what is not None and answer.what.descent is not None:
                d = DOWN * answer.what.descent
                at = answer.polished.x
                self._below += [at + d, at - d]

    def _answer_at(self, s: Samples, k: int) -> tuple[FoundState, bool]:
        """Return the answer that an end is, and whether it is new."""
        x = s.x[k]
        known = len(self._answer_of)
        if known:
            apart = np.abs(self._ends[:known] - x).max(axis=1)
            nearest = int(apart.argmin())
            if apart[nearest] <= ALIKE:
                return self._answer_of[nearest], False
        end = Solve(
            self._stated(x), "", 0, math.nan, np.abs(self._stated(s.at_limit[k] + 0.0)), None
        )
        answer, new = self.record.settle(self.model, end, self._held(s, k))
        if new:
            judge(self.record, answer)
            if answer.is_minimum:
                close_orbit(self.model, self.record, answer)
                self._found()
        if known == len(self._ends):
            self._ends = np.concatenate([self._ends, np.empty_like(self._ends)])
        self._ends[known] = x
        self._answer_of.append(answer)
        return answer, new

    def _stated(self, x: np.ndarray) -> np.ndarray:
        """Bring a state to the labels of the scene."""
        return self._labels.back(x) if self._labels else x

    def _under(self, x: np.ndarray) -> np.ndarray:
        """Bring a state of the scene to the labels of the descents."""
        return self._labels.sign * x[self._labels.creases] if self._labels else x

    def _held(self, s: Samples, k: int) -> tuple[Contact, ...]:
        """The contacts that an end holds."""
        at_limit, x = self._stated(s.at_limit[k] + 0.0), self._stated(s.x[k])
        limits = self.model.fold_limits.contacts(x, at_limit != 0)
        slots = zip(s.slots[k].tolist(), s.sides[k].tolist(), strict=True)
        sign = self._labels.sign if self._labels else 1
        gaps = [
            Contact("gap", int(self._gap_of[gap]) if self._labels else gap, sign * side)
            for gap, side in slots
            if gap != OPEN
        ]
        return tuple(dict.fromkeys((*limits, *gaps)))


def _gap_under(model: Model, other: Model, labels: Relabelling) -> np.ndarray:
    """For each gap of a model under other labels its position in `model`: crease k on facet j is what it says."""
    at = {gap.index: model.structure.gaps[gap.index].rays for gap in model.gaps}
    position = {rays: index for index, rays in at.items()}
    creases, facets = labels.creases.tolist(), labels.facets.tolist()
    rows = [gap.rays for gap in other.structure.gaps]
    return np.array([position[creases[k], facets[j]] for k, j in rows], dtype=int)
