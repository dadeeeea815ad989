"""Starts of patterns: what the pattern gives, any fold angles, grown out of the flat state, vertices popped."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations, cycle, islice, permutations, product
from typing import Any

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, RESOLVED
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem
from origami_nlp.problem import FoldLimits
from origami_nlp.starts.batch_states import Samples
from origami_nlp.starts.family import Listed, StartFamily

MOST_LINES, MOST_FOLDED = 3, 250
"""Straight lines that are folded at a time, and ways in which so many are."""


class Given(Listed):
    """Fold angles that a pattern itself gives.

    Parameters
    ----------
    pattern
        With its springs.
    """

    name = "starts that the pattern gives"
    sentence = "what the file states, mountains and valleys folded, rest angles, straight lines folded to wells"

    def __init__(self, pattern: Pattern) -> None:
        self.size = pattern.creases
        self._pattern = pattern

    def states(self) -> Iterator[np.ndarray]:
        """Yield them, none closed yet."""
        pattern = self._pattern
        if not np.isnan(pattern.file_angles).any():
            yield pattern.file_angles
        if pattern.reference.any():
            yield pattern.reference
        if pattern.signs.any():
            yield from (0.4 * pattern.signs, 1.0 * pattern.signs)
        if pattern.rest.any():
            yield from (0.3 * pattern.rest, pattern.rest)
        yield from lines_at_wells(pattern)


class Uniform(StartFamily):
    """Fold angles up to a random size, whatever closes.

    Parameters
    ----------
    labels
        Of the pattern: fold angles are drawn in their order.
    limits
        Of its creases: what is drawn beyond is held there.
    """

    name = "uniform"
    sentence = "any fold angles"

    def __init__(self, labels: CanonicalLabelling, limits: FoldLimits) -> None:
        self._labels, self._limits = labels, limits

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Draw states one after the other."""
        drawn = [self._labels.drawn(self._angles(rng)) for _ in range(many)]
        x = self._limits.clip(np.array(drawn).reshape(many, -1))
        return Samples.at_limits(x, self._limits)

    def _angles(self, rng: np.random.Generator) -> np.ndarray:
        size = rng.uniform(0.3, math.pi)
        return rng.uniform(-size, size, len(self._labels.order))


class UniformFolded(Uniform):
    """The same with up to half of the creases fully folded, which is kept as long as their springs push."""

    name = "uniform, some fully folded"
    sentence = "any fold angles, some creases fully folded"

    def _angles(self, rng: np.random.Generator) -> np.ndarray:
        angles = super()._angles(rng)
        n = len(angles)
        at_limit = rng.permutation(n)[: int(rng.integers(1, max(2, n // 2)))]
        angles[at_limit] = rng.choice([-math.pi, math.pi], len(at_limit))
        return angles


class Grown(StartFamily):
    """States that steps along what closure leaves free reach from the flat one.

    Parameters
    ----------
    problem
        Of a pattern that is flat at zero.
    labels
        Of the pattern: directions are drawn in their order.
    """

    name = "grown"
    sentence = "grown out of the flat state"

    def __init__(self, problem: PatternProblem, labels: CanonicalLabelling) -> None:
        self._problem, self._labels = problem, labels

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Grow states one after the other."""
        grown = [self._grown(rng) for _ in range(many)]
        x = np.array(grown).reshape(many, self._problem.size)
        return Samples.at_limits(x, self._problem.fold_limits)

    def _grown(self, rng: np.random.Generator) -> np.ndarray:
        problem = self._problem
        n = problem.size
        phi, residual = problem.project(self._labels.drawn(rng.uniform(-0.3, 0.3, n)))
        way = phi
        for _ in range(int(rng.integers(0, 8))):
            aside = self._labels.drawn(rng.normal(size=n))
            way = problem.along(phi, way + 0.5 * aside * np.abs(way).max())
            size = float(np.abs(way).max())
            if residual > CLOSURE_TOL or size < RESOLVED:
                break
            new, residual = problem.project(phi + 0.3 * way / size)
            if (
                residual > CLOSURE_TOL
                or not problem.fold_limits.inside(new).all()
                or not problem.closure.lifts_to_one(new)
            ):
                break
            phi = new
        return phi


def families_in_turn(
    problem: PatternProblem, labels: CanonicalLabelling
) -> tuple[StartFamily, ...]:
    """Return the families of random starts of a pattern, from which one start each is drawn in turn."""
    limits = problem.fold_limits
    anywhere = Uniform(labels, limits)
    grown = Grown(problem, labels) if problem.pattern.lies_flat else anywhere
    return grown, anywhere, UniformFolded(labels, limits)


POPPED = (1.0, -1.0), (1.0, -0.3), (0.3, -1.0), (0.3, -0.3)
"""Where a vertex is popped: what all folds are multiplied by, and those round it besides."""


class Popped(Listed):
    """A state with each vertex popped that is not flat, in an order that labels do not change.

    Parameters
    ----------
    pattern, labels
        The pattern, and the order of its creases.
    phi
        The state, [n] [rad].
    shares
        Some of `POPPED`.
    """

    name = "minima with a vertex popped"
    sentence = "a minimum with one vertex on its other side"

    def __init__(
        self,
        pattern: Pattern,
        labels: CanonicalLabelling,
        phi: np.ndarray,
        shares: Sequence[tuple[float, float]] = POPPED,
    ) -> None:
        self.size, self._shares = pattern.creases, shares
        self._around, self._phi = creases_around(pattern, labels), phi

    def states(self) -> Iterator[np.ndarray]:
        """Yield them, none closed yet."""
        for creases, (size, share) in product(self._around, self._shares):
            if self._phi[creases].any():
                start = size * self._phi
                start[creases] *= share
                yield start


class Changed(StartFamily):
    """States of a list changed at random, in one way after the other.

    With the creases round each vertex, or each crease, as one of two states has them; or with one crease flat, fully
    folded or turned round.  Walks along motions are none of the ways: rounding decides where facets begin to cross.
    Each state has as many starts as the others: those that were added last catch up.

    Parameters
    ----------
    problem
        Of the pattern.
    labels
        Of the pattern: changes are drawn in the order of its creases.
    """

    name = "minima changed at random"
    sentence = "a minimum crossed with another, or with one crease folded otherwise"

    def __init__(self, problem: PatternProblem, labels: CanonicalLabelling) -> None:
        self._problem, self._labels = problem, labels
        self._states, self._others, self._made = [list[Any]() for _ in range(3)]
        self._around = creases_around(problem.pattern, labels)
        self._ways = cycle((self._by_vertex, self._one_crease, self._by_crease))

    def add(self, phi: np.ndarray, images: Sequence[np.ndarray] = ()) -> None:
        """Add a state [n], and its images under symmetries: with these others are crossed."""
        self._states.append(phi)
        self._others += [phi, *images]
        self._made.append(0)

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Draw states one after the other; none where there is none to be changed."""
        x, limits = [], self._problem.fold_limits
        for way in islice(self._ways, many if self._states else 0):
            k = self._made.index(min(self._made))
            self._made[k] += 1
            x.append(
                way(rng, self._states[k].copy(), self._others[rng.integers(len(self._others))])
            )
        return Samples.at_limits(limits.clip(np.array(x).reshape(-1, self._problem.size)), limits)

    def _by_vertex(
        self, rng: np.random.Generator, one: np.ndarray, other: np.ndarray
    ) -> np.ndarray:
        for creases in self._around:
            if rng.random() < 0.5:
                one[creases] = other[creases]
        return one

    def _by_crease(
        self, rng: np.random.Generator, one: np.ndarray, other: np.ndarray
    ) -> np.ndarray:
        taken = rng.random(len(one))[np.argsort(self._labels.order)] < 0.5
        return np.where(taken, one, other)

    def _one_crease(self, rng: np.random.Generator, one: np.ndarray, _: np.ndarray) -> np.ndarray:
        i = self._labels.order[rng.integers(len(one))]
        sign = self._labels.sign
        one[i] = sign * (-math.pi, 0.0, math.pi, -sign * one[i])[rng.integers(4)]
        return one


class OtherWells(Listed):
    """A state with each crease moved to each other well of its law, as bistable hinges snap one by one.

    Parameters
    ----------
    pattern, labels
        The pattern with its laws, and the order of its creases.
    phi
        The state, [n] [rad].
    """

    name = "minima with a hinge in another well"
    sentence = "a minimum with one hinge in another well of its law"

    def __init__(self, pattern: Pattern, labels: CanonicalLabelling, phi: np.ndarray) -> None:
        self.size, self._labels, self._phi = pattern.creases, labels, phi
        self._rests = hinge_rests(pattern)

    def states(self) -> Iterator[np.ndarray]:
        """Yield them, none closed yet."""
        for i in filter(self._rests.__contains__, self._labels.order.tolist()):
            away = np.abs(self._rests[i] - self._phi[i])
            for k in np.argsort(away)[1:]:
                start = self._phi.copy()
                start[i] = self._rests[i][k]
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


def creases_around(pattern: Pattern, labels: CanonicalLabelling) -> list[list[int]]:
    """Return the creases round each vertex, in an order of vertices that labels do not change."""
    rank = np.argsort(labels.order)
    around = [list(loop.creases) for loop in pattern.vertices]
    return sorted(around, key=lambda creases: sorted(rank[creases].tolist()))
