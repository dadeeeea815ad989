"""Where descents begin: families of starts, each with what it holds; and what a pattern itself gives, listed once."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, permutations
from typing import ClassVar

import numpy as np

from origami_nlp.numerics import OUTSIDE, RESOLVED
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem
from origami_nlp.search.descend import PICKS, SLOTS, StartState

MOST_LINES, MOST_FOLDED = 3, 250
"""Straight lines that are folded at a time, and ways in which so many are."""
GRID = 2.0**-33
"""Of fold angles of minima that are changed [rad]."""
SOONER = 0.15
"""Chance that a feature is made to touch rather than one of those that face each other less closely."""


class StartKind(ABC):
    """Starts of one kind; `sentence` says where they lie, `cost` is what a draw takes, in evaluations of closure.

    Parameters
    ----------
    problem
        In the order of whose `labels` all that is random is drawn.
    """

    name: ClassVar[str]
    sentence: ClassVar[str]
    cost: ClassVar[int]

    def __init__(self, problem: PatternProblem) -> None:
        self.problem, self.labels = problem, problem.labels

    @abstractmethod
    def draw(self, rng: np.random.Generator, count: int) -> list[StartState]:
        """Return the next starts, so many of them, or none where there are none."""

    def _anywhere(self, rng: np.random.Generator, count: int) -> np.ndarray:
        """Return any states [count, n], up to a random size each; each fold angle in any of its lifts."""
        most = min(self.problem.bound, math.pi)
        x = rng.uniform(min(0.3, most), most, (count, 1)) * rng.uniform(
            -1.0, 1.0, (count, self.problem.size)
        )
        if self.problem.bound > math.pi:
            x -= 2 * math.pi * np.sign(x) * (rng.random(x.shape) < 0.5)
        return self.labels.drawn(x)


class Uniform(StartKind):
    """Any fold angles, up to a random size."""

    name = "uniform"
    sentence = "any fold angles"
    cost = 4

    def draw(self, rng: np.random.Generator, count: int) -> list[StartState]:
        """Draw fold angles in the order of labels."""
        none = np.zeros(self.problem.size, int)
        return [StartState(x, none, drawn=True) for x in self._anywhere(rng, count)]


class FoldedCreases(StartKind):
    """States with some creases at their limits, up to half of them or as many as there are degrees of freedom."""

    name = "strata"
    sentence = "some creases fully folded, held until the others are at rest"
    cost = 10

    def draw(self, rng: np.random.Generator, count: int) -> list[StartState]:
        """Draw creases and sides."""
        most = max(1, self.problem.dof, self.problem.size // 2)
        return self._folded(rng, rng.integers(1, 1 + most, count))

    def _folded(self, rng: np.random.Generator, many: np.ndarray) -> list[StartState]:
        """Return states with so many creases at their limits each."""
        count, n = len(many), self.problem.size
        rank = np.argsort(np.argsort(rng.random((count, n)), axis=1), axis=1)
        signs = rng.choice([-1.0, 1.0], (count, n))
        sides = self.labels.drawn(np.where(rank < many[:, None], signs, 0.0)).astype(int)
        pairs = zip(self._anywhere(rng, count), sides, strict=True)
        return [StartState(x, side, drawn=True) for x, side in pairs]


class Touch(FoldedCreases):
    """States at which features touch, of those that face each other at a closed state, one after the other."""

    name = "touch"
    sentence = "facets that touch, held until the others are at rest"
    cost = 20

    def draw(self, rng: np.random.Generator, count: int) -> list[StartState]:
        """Draw states, some creases at their limits, and which of the features that are near each other there meet."""
        dof = max(self.problem.dof, 1)
        folded = np.maximum(dof - rng.geometric(0.5, count), 0)
        starts = self._folded(rng, rng.integers(folded + 1))
        brought = np.minimum(rng.geometric(0.5, count), min(dof, PICKS)).tolist()
        picks = np.minimum(rng.geometric(SOONER, (count, PICKS)), SLOTS).tolist()
        each = zip(starts, picks, brought, strict=True)
        return [replace(s, picks=tuple(ranks[:many])) for s, ranks, many in each]


class Changed(StartKind):
    """Known minima changed: the creases round each vertex, or each crease, as one of two has them; or one crease.

    Each minimum has as many starts as the others: those that were added last catch up.
    """

    name = "changed"
    sentence = "a minimum crossed with another, or with one crease folded otherwise"
    cost = 2

    def __init__(self, problem: PatternProblem) -> None:
        super().__init__(problem)
        self._states, self._others = list[np.ndarray](), list[np.ndarray]()
        self._made, self._way = list[int](), 0
        self._around = variables_around(problem)

    def add(self, x: np.ndarray, *images: np.ndarray) -> None:
        """Add a minimum [n], and its images under symmetries: with these others are crossed."""
        self._states.append(x)
        self._others += [x, *images]
        self._made.append(0)

    def draw(self, rng: np.random.Generator, count: int) -> list[StartState]:
        """Change the minima that were changed least often, in one of three ways in turn."""
        return [self._change(rng) for _ in range(count)] if self._states else []

    def _change(self, rng: np.random.Generator) -> StartState:
        k = self._made.index(min(self._made))
        self._made[k] += 1
        x, other = self._states[k].copy(), self._others[rng.integers(len(self._others))]
        self._way = 1 + self._way % 2 if len(self._around) == 1 else (self._way + 1) % 3
        if self._way == 0:
            for creases in self._around:
                if rng.random() < 0.5:
                    x[creases] = other[creases]
        elif self._way == 1:
            taken = rng.random(len(x))[np.argsort(self.labels.order)] < 0.5
            x = np.where(taken, x, other)
        elif self.problem.bound > math.pi:
            for i in self.labels.order[rng.choice(len(x), min(2, len(x)), replace=False)]:
                x[i] -= math.copysign(2 * math.pi, x[i])
        else:
            i, sign = self.labels.order[rng.integers(len(x))], self.labels.sign
            x[i] = sign * (-math.pi, 0.0, math.pi, -sign * x[i])[rng.integers(4)]
        x = self.problem.fold_limits.clip(x)
        return StartState(x, at_limits(self.problem, x), drawn=True)


def on_grid(problem: PatternProblem, x: np.ndarray) -> np.ndarray:
    """Return a state [n] without the digits that rounding makes, fully folded creases as they are."""
    return np.where(at_limits(problem, x) != 0, x, np.round(x / GRID) * GRID)


def at_limits(problem: PatternProblem, x: np.ndarray) -> np.ndarray:
    """Return at which fold limits a state is, by sign, [n]."""
    return problem.fold_limits.near(x, OUTSIDE)


def given(pattern: Pattern) -> Iterator[np.ndarray]:
    """Yield what a file states, mountains and valleys folded, rest angles, straight lines folded to wells."""
    if not np.isnan(pattern.file_angles).any():
        yield pattern.file_angles
    if pattern.reference.any():
        yield pattern.reference
    if pattern.signs.any():
        yield from (0.4 * pattern.signs, 1.0 * pattern.signs)
    if pattern.rest.any():
        yield from (0.3 * pattern.rest, pattern.rest)
    yield from lines_at_wells(pattern)


def other_wells(
    pattern: Pattern, labels: CanonicalLabelling, x: np.ndarray
) -> Iterator[np.ndarray]:
    """Yield a state with each crease moved to each other well of its law, as bistable hinges snap one by one."""
    rests = hinge_rests(pattern)
    for i in filter(rests.__contains__, labels.order.tolist()):
        for k in np.argsort(np.abs(rests[i] - x[i]))[1:]:
            start = x.copy()
            start[i] = rests[i][k]
            yield start


def hinge_rests(pattern: Pattern) -> dict[int, np.ndarray]:
    """Return where creases (from 0) would rest by their laws alone [rad], of each with more such angles than one."""
    limits = pattern.limit_angles.T
    rests = {i: law.rests(*limits[i]) for i, law in enumerate(pattern.laws) if law is not None}
    return {i: np.array(angles) for i, angles in rests.items() if len(angles) > 1}


def straight_lines(pattern: Pattern) -> list[np.ndarray]:
    """Return the creases of each straight line of flat paper, from border to border, which folds along it alone."""
    onward: dict[tuple[int, int], int] = {}
    for loop in pattern.vertices:
        signs = np.array(loop.signs, float)[:, None]
        away = signs * pattern.directions[list(loop.creases)]
        for (i, a), (j, b) in permutations(zip(loop.creases, away, strict=True), 2):
            if np.abs(a + b).max() <= RESOLVED:
                onward[i, loop.vertex] = j
    inner = {loop.vertex for loop in pattern.vertices}
    lines = []
    for first in range(pattern.creases):
        line, ends = [first], list(pattern.ends[first].tolist())
        for side in (0, 1):  # to the border, or to where it does not go on
            at = first
            while (at, ends[side]) in onward:
                at = onward[at, ends[side]]
                line.append(at)
                ends[side] = int(pattern.ends[at].sum()) - ends[side]
        if first == min(line) and not inner.intersection(ends):
            lines.append(np.array(line))
    return lines


def lines_at_wells(pattern: Pattern) -> Iterator[np.ndarray]:
    """Yield flat paper folded along straight lines that do not cross, the hinges of each in a well of their laws."""
    rests = hinge_rests(pattern)
    if not rests or not pattern.lies_flat:
        return
    on = dict[int, set[int]]()
    for k, loop in enumerate(pattern.vertices):
        for i in loop.creases:
            on.setdefault(i, set()).add(k)
    ways: list[tuple[set[int], np.ndarray, float]] = []
    for line in straight_lines(pattern):
        angles = np.concatenate([rests.get(i, np.zeros(0)) for i in line.tolist()])
        angles = np.unique(np.round(angles[np.abs(angles) > RESOLVED], 6))
        met = set[int]().union(*(on.get(i, set()) for i in line.tolist()))
        ways += [(met, line, angle) for angle in angles.tolist()]
    for many in range(1, MOST_LINES + 1):
        if math.comb(len(ways), many) > MOST_FOLDED:
            return
        for some in combinations(ways, many):
            lines = np.concatenate([line for _, line, _ in some])
            crossings = [v for met, _, _ in some for v in met]
            if len(set(lines.tolist())) == len(lines) and len(set(crossings)) == len(crossings):
                start = np.zeros(pattern.creases)
                for _, line, angle in some:
                    start[line] = angle
                yield start


def variables_around(problem: PatternProblem) -> list[list[int]]:
    """Return the variables round each vertex, in an order of vertices that labels do not change."""
    rank, orbits = np.argsort(problem.labels.order), problem.orbits
    of = np.arange(problem.size) if orbits is None else orbits.orbit
    around = [sorted(set(of[list(loop.creases)].tolist())) for loop in problem.pattern.vertices]
    return sorted(around, key=lambda variables: sorted(rank[variables].tolist()))
