"""Multi-start: states spread over the feasible set, one IPOPT solve each, polished and told apart."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.model.nlp import Model
from origami_nlp.solve.ipopt import Solve, solve
from origami_nlp.solve.polish import Polished, polish
from origami_nlp.solve.starts import StartStream, crossed_pairs

SAME = 1e-6
"""Polished states closer than this in every fold angle [rad] are one state."""
MOST_PAIR_ROUNDS = 4


@dataclass(eq=False)
class Answer:
    """A distinct state that solves ended at: its polish, and how many starts reached it."""

    polished: Polished
    hits: int = 1


@dataclass
class Record:
    """Everything a search did, failures included.

    answers: distinct states that solves ended at.  listed: flat foldings that no solve ended at.
    statuses: IPOPT's return statuses, counted over all solves.  starts, feasible_starts: starts
    drawn, and those that satisfied every constraint.  converged: starts that ended at an answer.
    """

    answers: list[Answer] = field(default_factory=list)
    listed: list[Answer] = field(default_factory=list)
    statuses: Counter[str] = field(default_factory=Counter)
    starts: int = 0
    feasible_starts: int = 0
    solves: int = 0
    converged: int = 0


def run_starts(model: Model, seed: int, record: Record) -> Iterator[Answer | None]:
    """Run starts for ever, one for each `next`; yields the new answer, or None where nothing new was found."""
    for start in StartStream(model, seed):
        record.starts += 1
        record.feasible_starts += start.feasible
        yield run_one(model, start.x, record)


def run_one(model: Model, x: np.ndarray, record: Record, *, count: bool = True) -> Answer | None:
    """Solve from one start, polish, and file the answer in `record`; returns it if it is new.

    With `count` false the solve is not a random start and does not enter the stopping rule.
    """
    answer = solve_without_crossing(model, x, record)
    if not answer.succeeded:
        return None
    record.converged += count
    for known in record.answers:  # most starts end where another did: no need to polish again
        if known.polished.converged and np.abs(known.polished.x - answer.x).max() <= SAME:
            known.hits += count
            return None
    polished = polish(model, answer)
    for known in record.answers:
        if np.abs(known.polished.x - polished.x).max() <= SAME:
            known.hits += count
            return None
    # a solve's answer is stationary where a listed flat folding beside it may not be: it takes its place
    record.listed = [
        known for known in record.listed if np.abs(known.polished.x - polished.x).max() > SAME
    ]
    new = Answer(polished, int(count))
    record.answers.append(new)
    return new


def add_state(model: Model, x: np.ndarray, record: Record) -> Answer | None:
    """File a state that was listed, not solved for, unless it is known; it has no hits until a solve ends there."""
    for known in (*record.answers, *record.listed):
        if np.abs(known.polished.x - x).max() <= SAME:
            return None
    closure = float(np.abs(model.closure(x)[0]).max())
    listed = Answer(Polished(x, (), closure, math.nan, True), 0)
    record.listed.append(listed)
    return listed


def solve_without_crossing(model: Model, x: np.ndarray, record: Record) -> Solve:
    """Solve; facet pairs enter, with their separating planes, only when a solve makes them cross.

    (Modelling a pair from the first try on, once it has crossed often, was slower: planes cost more than the
    second solve, and lead to more answers without a layer order.)
    """
    pairs: tuple[tuple[int, int], ...] = ()
    for _ in range(MOST_PAIR_ROUNDS):
        answer = solve(model, x, pairs)
        record.solves += 1
        record.statuses[answer.status] += 1
        crossed = crossed_pairs(model, answer.x, 1e-6)
        if not crossed or set(crossed) <= set(pairs):
            return answer
        pairs = tuple(sorted({*pairs, *crossed}))
    return answer
