"""What every method is given and gives back: a starting state, and one attempt from it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from origami_nlp.minima import FEW_PAIRS, MOST_PAIR_ROUNDS
from origami_nlp.numerics import ANSWERED
from origami_nlp.problem import Model, Solvable
from origami_nlp.starts import Projected

Pairs = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class StartPoint:
    """Where an attempt begins.

    x: a state of the package's own stream, projected onto closure [n].  raw: uniform random fold angles [n].
    pairs: facet pairs that get a separating plane from the start; others enter when an answer makes them cross.
    """

    x: np.ndarray
    raw: np.ndarray
    pairs: Pairs


@dataclass(frozen=True)
class Attempt:
    """What a method answered from one start.

    x: the model's variables [n], or None.  claims: whether the method says that this is a minimum (its own notion of
    success, and constraints met to 1e-6).  status: in its words.  bound_multipliers: those of |phi| <= pi [n], where
    it gives them (energy / `Model.scale`).  building: seconds of the call that went into building functions.
    """

    x: np.ndarray | None
    claims: bool
    status: str
    iterations: int = 0
    bound_multipliers: np.ndarray | None = None
    building: float = 0.0


Solver = Callable[[StartPoint], Attempt]


@dataclass(frozen=True)
class Method:
    """One method at one setting.

    name, setting: what and how, for tables; `label` joins them.  family: methods that a diagram draws as one line.
    accuracy: its tolerance, for the order of settings.  prepare(model) builds what is needed and returns the solver.
    missing: why it cannot run here, or empty.  sweep: a setting of the work-precision diagram only, which runs
    on fewer starts.
    """

    name: str
    setting: str
    family: str
    accuracy: float
    prepare: Callable[[Model], Solver]
    missing: str = ""
    sweep: bool = False

    @property
    def label(self) -> str:
        """Name and setting."""
        return f"{self.name}, {self.setting}" if self.setting else self.name


FEASIBLE = ANSWERED
"""An answer that violates a constraint by more is not claimed, whatever a solver's status says."""


def draw_starts(model: Solvable, seed: int, count: int) -> tuple[list[StartPoint], float]:
    """Return the package's starts for `seed`, and the seconds that one took to draw and project."""
    rng = np.random.default_rng([seed, 1])
    begin = time.process_time()
    stream = Projected(model).starts(np.random.default_rng(seed))
    states = [next(stream).x for _ in range(count)]
    seconds = (time.process_time() - begin) / count
    pairs = model.structure.pairs
    few = len(pairs) <= FEW_PAIRS
    starts = [
        # the package's own rule (minima.search.run_starts)
        StartPoint(
            x, rng.uniform(-np.pi, np.pi, model.size), pairs if few or number % 2 == 0 else ()
        )
        for number, x in enumerate(states, start=1)
    ]
    return starts, seconds


def keep_apart(
    model: Solvable,
    x: np.ndarray,
    pairs: Pairs,
    solve_once: Callable[[np.ndarray, Pairs], Attempt],
) -> Attempt:
    """Solve; facet pairs that the answer makes cross get a plane, and it is solved again.

    The strategy of the package (`minima.solve_without_crossing`), for any solver.
    """
    iterations, building = 0, 0.0
    for _ in range(MOST_PAIR_ROUNDS):
        answer = solve_once(x, pairs)
        iterations += answer.iterations
        building += answer.building
        if answer.x is None:
            break
        crossed = model.crossed(answer.x, ANSWERED)
        if not crossed or set(crossed) <= set(pairs):
            break
        pairs = tuple(sorted({*pairs, *crossed}))
    return Attempt(
        answer.x, answer.claims, answer.status, iterations, answer.bound_multipliers, building
    )
