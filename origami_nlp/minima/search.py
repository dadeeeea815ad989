"""Multi-start: states spread over the feasible set, one IPOPT solve each, polished and told apart."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.kkt import (
    Classification,
    Polished,
    Solve,
    StartStream,
    exact_beside,
    newton,
    polish,
)
from origami_nlp.minima.ipopt import solve, solve_on_boundary
from origami_nlp.numerics import ANSWERED, BESIDE, SAME
from origami_nlp.programme import Contact, Solvable

MOST_PAIR_ROUNDS = 4
SOLVES_A_BOUNDARY, MOST_BOUNDARY_SOLVES = 4, 160
"""Solves along each contact boundary, and over all of them."""
FEW_PAIRS = 6
"""Up to this many facet pairs every solve models all of them from the start."""


@dataclass(eq=False)
class Answer:
    """A distinct state that solves ended at: its polish, how many starts reached it, and what it was judged to be."""

    polished: Polished
    hits: int = 1
    what: Classification | None = None

    @property
    def is_minimum(self) -> bool:
        """Whether it was judged to be a minimum."""
        return self.what is not None and self.what.verdict == "minimum"


@dataclass
class Record:
    """Everything a search did, failures included.

    answers: distinct states that solves ended at.  listed: flat foldings that no solve ended at.
    statuses: IPOPT's return statuses, counted over all solves.  starts, feasible_starts: starts
    drawn, and those that satisfied every constraint.  iterations: of IPOPT, over all solves.
    converged: starts that ended at an answer.
    """

    answers: list[Answer] = field(default_factory=list)
    listed: list[Answer] = field(default_factory=list)
    statuses: Counter[str] = field(default_factory=Counter)
    starts: int = 0
    feasible_starts: int = 0
    solves: int = 0
    iterations: int = 0
    converged: int = 0


def run_starts(model: Solvable, seed: int, record: Record) -> Iterator[Answer | None]:
    """Run starts for ever, one for each `next`; yields the new answer, or None where nothing new was found."""
    pairs = model.structure.pairs
    for start in StartStream(model, seed):
        record.starts += 1
        record.feasible_starts += start.feasible
        # Minima that a facet pair pins can be reached only by solves that respect the pair from the start: without it
        # a solve passes through the facets and ends elsewhere.  With many pairs every second start does without.
        respect = len(pairs) <= FEW_PAIRS or record.starts % 2 == 0
        yield run_one(model, start.x, record, pairs=pairs if respect else ())


def run_one(
    model: Solvable,
    x: np.ndarray,
    record: Record,
    *,
    pairs: tuple[tuple[int, int], ...] = (),
    count: bool = True,
) -> Answer | None:
    """Solve from one start, polish, and file the answer in `record`; returns it if it is new.

    With `count` false the solve is not a random start and does not enter the stopping rule.
    """
    answer = solve_without_crossing(model, x, record, pairs)
    if not answer.succeeded:
        return None
    record.converged += count
    for known in record.answers:  # most starts end where another did: no need to polish again
        if known.polished.converged and np.abs(known.polished.x - answer.x).max() <= SAME:
            known.hits += count
            return None
    return _file(model, polish(model, answer), record, count)


def run_boundaries(model: Solvable, seed: int, record: Record) -> Iterator[Answer | None]:
    """Minimise along every contact boundary: where pinned states are, narrow as their basins may be.

    A pinned minimum is a minimum among the states that keep its contact closed; a solver that starts in the
    interior can miss it.  Yields the new answers; no random starts are counted.
    """
    rows = (*model.limits, *model.gaps)
    tries = max(1, min(SOLVES_A_BOUNDARY, MOST_BOUNDARY_SOLVES // max(1, len(rows))))
    stream = StartStream(model, seed)
    for row in rows:
        for _ in range(tries):
            answer = solve_on_boundary(model, next(stream).x, row)
            record.solves += 1
            record.statuses[answer.status] += 1
            record.iterations += answer.iterations
            if answer.succeeded:
                yield _settle_on_boundary(model, answer, row, record)


def _settle_on_boundary(
    model: Solvable, answer: Solve, row: Contact, record: Record
) -> Answer | None:
    """Polish a minimum along a boundary with its contact closed; keep it if the contact is loaded."""
    guessed = model.guess(answer.x, answer.pull, answer.pair_force)
    for side in (row.side,) if row.is_limit else (1, -1):
        guess = tuple(dict.fromkeys((Contact(row.kind, row.index, side), *guessed)))
        result = polish(model, answer, guess)
        if result.converged and result.rows and not _free_beside(model, result):
            return _file(model, result, record, 0)
    return None


def _free_beside(model: Solvable, state: Polished) -> bool:
    """Tell whether a state without contacts lies beside one that a contact was asked to hold: it is the answer then."""
    free, _ = newton(model, state.x, ())
    if free is None or not free.converged or np.abs(free.x - state.x).max() > SAME:
        return False
    return not model.beyond(free.x, 0.0)


def _file(model: Solvable, polished: Polished, record: Record, hits: int) -> Answer | None:
    """File a polished state under the answer that it is, or as a new one, which is returned.

    What Newton could not polish is taken for the exact state next to it, where there is one.
    """
    if not polished.converged:
        polished = _listed_beside(polished, record) or exact_beside(model, polished)
    for known in record.answers:
        if _is_same(known.polished, polished):
            known.hits += hits
            if polished.converged and not known.polished.converged:
                known.polished = polished  # judged anew by whoever asks for the answer
                return known
            return None
    for known in record.listed:
        if _is_same(known.polished, polished):
            record.listed.remove(known)
            known.hits += hits
            record.answers.append(known)
            return None
    new = Answer(polished, int(hits))
    record.answers.append(new)
    return new


def _is_same(one: Polished, other: Polished) -> bool:
    """Tell whether two states are one, as far as their accuracy says."""
    exact = one.converged and other.converged
    near = max(SAME, one.uncertainty + other.uncertainty) if exact else BESIDE
    return bool(np.abs(one.x - other.x).max() <= near)


def _listed_beside(state: Polished, record: Record) -> Polished | None:
    """Return the nearest exact state on record within `BESIDE` of a state, or None."""
    exact = [a.polished for a in (*record.answers, *record.listed) if a.polished.converged]
    near = [float(np.abs(known.x - state.x).max()) for known in exact]
    return exact[int(np.argmin(near))] if near and min(near) <= BESIDE else None


def add_state(model: Solvable, x: np.ndarray, record: Record) -> Answer | None:
    """File a state that was listed, not solved for, unless it is known; it has no hits until a solve ends there."""
    for known in (*record.answers, *record.listed):
        if np.abs(known.polished.x - x).max() <= SAME:
            return None
    closure = float(np.abs(model.closure(x)[0]).max())
    listed = Answer(Polished(x, (), closure, math.nan, True), 0)
    record.listed.append(listed)
    return listed


def solve_without_crossing(
    model: Solvable, x: np.ndarray, record: Record, pairs: tuple[tuple[int, int], ...] = ()
) -> Solve:
    """Solve with separating planes for `pairs`; other facet pairs enter when a solve makes them cross."""
    for _ in range(MOST_PAIR_ROUNDS):
        answer = solve(model, x, pairs)
        record.solves += 1
        record.statuses[answer.status] += 1
        record.iterations += answer.iterations
        crossed = model.crossed(answer.x, ANSWERED)
        if not crossed or set(crossed) <= set(pairs):
            return answer
        pairs = tuple(sorted({*pairs, *crossed}))
    return answer
