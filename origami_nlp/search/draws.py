"""Random starts of a problem: whose turn it is, and what each family led to."""

from __future__ import annotations

from typing import Any

import numpy as np

from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search.descend import StartState
from origami_nlp.search.moments import Moments, is_chain
from origami_nlp.search.shares import Shares
from origami_nlp.search.starts import Changed, FoldedCreases, StartKind, Touch, Uniform

BATCH, TOGETHER = 2_000, 32
"""Starts that are drawn together, over the square of the number of variables, and at most."""
MOST_TRIED = 10
"""Draws for each start that is to close, where few do."""
DEEP = 6
"""Times that a lower state beside one that was refuted is gone on from."""
FOLLOWED, CLOSED_NOT = 60, 30
"""What a start that is followed takes, and one that does not close, in evaluations of closure."""


class Draws:
    """Families of random starts, each with numbers of its own: one that rounding sends elsewhere moves no other.

    Parameters
    ----------
    problem
        In the order of whose `labels` all that is random is drawn.
    seed
        Of the numbers.

    Attributes
    ----------
    changed
        The family that starts from minima that were found.
    """

    def __init__(self, problem: PatternProblem, seed: int) -> None:
        self.changed = Changed(problem)
        kinds: list[type[Any]] = [Uniform, *[FoldedCreases] * problem.has_limits]
        kinds += [Touch] * problem.contact + [Moments] * is_chain(problem)
        self._labels, self._seed = problem.labels, seed
        self._families: list[StartKind] = [kind(problem) for kind in kinds]
        self._families.append(self.changed)
        self.names = [family.name for family in self._families]
        self._shares, self._made = Shares(self.names), dict.fromkeys(self.names, 0)
        self._together = max(1, min(TOGETHER, BATCH // problem.size**2))
        self._size = problem.size

    @property
    def made(self) -> int:
        """Starts so far."""
        return sum(self._made.values())

    def next(self, most: int) -> tuple[str, list[StartState], np.ndarray]:
        """Return a family, its next starts, so many at most, and to which sides they leave saddles [K, n]."""
        name = self._shares.next()
        number = self.names.index(name)
        rng = np.random.default_rng([self._seed, number, self._made[name]])
        starts = self._families[number].draw(rng, min(self._together, most))
        self._made[name] += len(starts)
        self._shares.work[name] += self._families[number].cost * self._together
        return name, starts, self._labels.drawn(rng.normal(size=(len(starts), self._size)))

    def note(self, name: str, new: int, followed: bool) -> None:
        """Note to how many new states a start of a family led, and whether it was followed."""
        self._shares.new[name] += new
        self._shares.work[name] += FOLLOWED if followed else CLOSED_NOT
