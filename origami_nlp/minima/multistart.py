"""Multi-start with IPOPT, one solve a start: for vertices with too many creases for batches, and to measure against."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from origami_nlp.kkt import Solve
from origami_nlp.minima.ipopt import solve
from origami_nlp.minima.record import FoundState, Record
from origami_nlp.numerics import ANSWERED, DUPLICATE_TOL
from origami_nlp.problem import Model, Solvable
from origami_nlp.starts import Projected

MOST_PAIR_ROUNDS = 4
FEW_PAIRS = 6
"""Up to this many facet pairs every solve models all of them from the start."""


def run_starts(model: Model, seed: int, record: Record) -> Iterator[FoundState | None]:
    """Run starts for ever, one for each `next`; yields the answer if it has to be judged, else None."""
    pairs = model.structure.pairs
    for start in Projected(model).starts(np.random.default_rng(seed)):
        record.starts += 1
        record.feasible_starts += start.feasible
        record.by_source[Projected.name] += 1
        record.drawn += 1
        # Minima that a facet pair pins can be reached only by solves that respect the pair from the start: without it
        # a solve passes through the facets and ends elsewhere.  With many pairs every second start does without.
        respect = len(pairs) <= FEW_PAIRS or record.starts % 2 == 0
        yield run_one(model, start.x, record, pairs=pairs if respect else ())


def run_one(
    model: Model,
    x: np.ndarray,
    record: Record,
    *,
    pairs: tuple[tuple[int, int], ...] = (),
) -> FoundState | None:
    """Solve from one start, polish, and file the answer; returns it if it has to be judged."""
    answer = solve_without_crossing(model, x, record, pairs)
    if not answer.succeeded:
        return None
    record.converged += 1
    for known in record.answers:  # most starts end where another did: no need to polish again
        if known.polished.converged and np.abs(known.polished.x - answer.x).max() <= DUPLICATE_TOL:
            found, new = known, False
            break
    else:
        found, new = record.settle(model, answer)
    found.hits += 1
    found.in_rounds += 1
    found.first = found.first or record.drawn
    return found if new else None


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
