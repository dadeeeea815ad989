"""Starts of patterns: what the pattern gives, any fold angles, grown out of the flat state, signs, vertices popped."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, NONZERO, RESOLVED, dense, null_space
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem, PopSigns
from origami_nlp.problem import FoldLimits
from origami_nlp.starts.batch_states import Samples
from origami_nlp.starts.family import Listed, StartFamily


class Given(Listed):
    """Fold angles that a pattern itself gives.

    Parameters
    ----------
    pattern
        With its springs.
    """

    name = "starts that the pattern gives"
    sentence = "what the file states, mountains and valleys folded, rest angles"

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
    grown = Grown(problem, labels) if problem.pattern.is_flat else anywhere
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
    """

    name = "minima with a vertex popped"
    sentence = "a minimum with one vertex on its other side"

    def __init__(self, pattern: Pattern, labels: CanonicalLabelling, phi: np.ndarray) -> None:
        self.size = pattern.creases
        self._around, self._phi = creases_around(pattern, labels), phi

    def states(self) -> Iterator[np.ndarray]:
        """Yield them, none closed yet."""
        for creases, (size, share) in product(self._around, POPPED):
            if self._phi[creases].any():
                start = size * self._phi
                start[creases] *= share
                yield start


MOST_SIGNED = 6
"""Interior vertices up to which every combination of their signs is started from."""
DRAWN = 16
"""Combinations of more vertices, which are drawn."""
TRIED, GROWN = 12, 0.2
"""Directions that are tried for each, and their largest fold angle [rad]."""


class Signed(Listed):
    """States beside the flat one with signs of the vertices that no minimum has yet, none of whose facets cross.

    The sum of the fold angles round a vertex keeps its sign along motions of paper (`PopSigns`), and the states with
    given signs are compact with those on their borders: a descent that does not cross comes to a minimum there, or to a
    vertex that is flat.

    Parameters
    ----------
    problem
        Of a flat pattern.
    labels
        The order of its creases.
    minima
        States whose signs are known, [M, n] [rad].
    """

    name = "signs of vertices that no minimum has"
    sentence = "beside the flat state, with signs of the vertices that no minimum has yet"

    def __init__(
        self, problem: PatternProblem, labels: CanonicalLabelling, minima: np.ndarray
    ) -> None:
        self.size, self._problem, self._labels = problem.size, problem, labels
        can_pop = {frozenset(creases) for creases in PopSigns(problem.pattern).around}
        around = [c for c in creases_around(problem.pattern, labels) if frozenset(c) in can_pop]
        self._rows = np.zeros((len(around), problem.size))
        for row, creases in zip(self._rows, around, strict=True):
            row[creases] = 1.0
        self._seen = {tuple(np.sign(self._rows @ x).tolist()) for x in minima}

    def states(self) -> Iterator[np.ndarray]:
        """Yield one for each combination of signs for which one is found."""
        many, rng = len(self._rows), np.random.default_rng(0)
        free = null_space(dense(self._problem.closure.jacobian(np.zeros(self.size))))
        if many > MOST_SIGNED:
            wanted = np.sign(rng.normal(size=(DRAWN, many)))
        else:
            wanted = np.array(list(product((1.0, -1.0), repeat=many))).reshape(-1, many)
        for signs in wanted if many else ():
            if tuple(signs.tolist()) not in self._seen:
                start = self._beside_flat(signs, free, rng)
                if start is not None:
                    yield start

    def _beside_flat(
        self, signs: np.ndarray, free: np.ndarray, rng: np.random.Generator
    ) -> np.ndarray | None:
        problem = self._problem
        for k in range(TRIED):
            aside = self._labels.drawn(rng.normal(size=self.size))
            d = free @ (free.T @ (self._rows.T @ signs + 0.2 * k * aside))
            start = GROWN * d / max(float(np.abs(d).max()), NONZERO)
            phi, residual = problem.project(start)
            good = residual <= CLOSURE_TOL and (np.sign(self._rows @ phi) == signs).all()
            if good and np.abs(phi).max() > RESOLVED and not problem.crossings.find(phi):
                return phi
        return None


def creases_around(pattern: Pattern, labels: CanonicalLabelling) -> list[list[int]]:
    """Return the creases round each vertex, in an order of vertices that labels do not change."""
    rank = np.argsort(labels.order)
    around = [list(loop.creases) for loop in pattern.vertices]
    return sorted(around, key=lambda creases: sorted(rank[creases].tolist()))
