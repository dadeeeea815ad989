"""Where descents start: corners of the state space, strata between them, touches, the interior, and moments.

Where starts begin matters more than how fast a descent is: minima with many closed contacts are hardly ever reached
from the interior, but a start on their own stratum, with its contacts held, often reaches them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from origami_nlp.problem import Model, vertex_candidates
from origami_nlp.starts.batch_states import Samples, joined
from origami_nlp.starts.crossings import model_rows
from origami_nlp.starts.family import StartFamily
from origami_nlp.starts.moments import Moments, is_chain
from origami_nlp.starts.options import SearchOptions
from origami_nlp.starts.strata import Corners, Interior, NearCorners, Strata
from origami_nlp.starts.touching import Touches

FAMILIES = (Corners, Interior, NearCorners, Strata, Touches, Moments)
"""Of starts that are counted; the numbers of sources are places here."""
CORNER, INTERIOR = 0, 1
SOURCES = tuple(family.name for family in FAMILIES)
"""Their names."""
DRAWN = tuple(k for k in range(len(FAMILIES)) if k != CORNER)
"""Those that are drawn anew: only how often these reach a minimum says how likely another was missed."""
GIVEN = len(FAMILIES)
"""Source of states that are given, guesses, minima of second order, either side of saddles: not counted."""
OTHERS = 8
"""With more creases, one start in so many is no moment."""


class Rounds:
    """Rounds of closed starts of a model, the same for the same seed.

    The corners and the interior come first; each round after them holds corners with some of their creases let go,
    random strata, and touches; all but corners and the interior hold their contacts until they have converged.

    Attributes
    ----------
    opening
        Rounds that belong together, from the first on: a search is not enough before they are made.
    corners, every_corner
        Corners among the starts, and whether there are no others.
    touches
        Where starts with touches are drawn; None without.
    """

    def __init__(self, model: Model, seed: int, options: SearchOptions) -> None:
        self._model, self._options = model, options
        self._rng = np.random.default_rng(seed)
        self._long = model.size > options.most_with_corners
        self._corners = Samples.on(np.zeros((0, model.size)))
        if not self._long:
            self._corners = self._drawn(Corners(model), options.corners)
        self.corners = len(self._corners)
        self.opening = 1 if self._long else 1 + options.hits
        self.every_corner = 0 < vertex_candidates(model) <= options.corners
        touching = model.scene.group.is_trivial and bool(model_rows(model))
        self.touches = Touches(model) if touching else None
        self._interior = Interior(model)
        share = 0.6 if touching else 1.25  # touches are a third kind of start
        dof = min(max(model.dof - 1, 0), 9)
        self._a_round = round(share * options.a_round * min(2.5**dof, 64))
        if self._long:  # a descent takes longer
            self._a_round = 1 + self._a_round * options.most_with_corners // model.size
        self._each = list(self._families(Moments(model) if is_chain(model) else None))

    def _families(self, moments: Moments | None) -> Iterator[tuple[StartFamily, int]]:
        """Yield the families of every round, with how many starts of each."""
        model = self._model
        if self._long and moments is not None:
            yield moments, self._a_round
            yield self._interior, 1 + self._a_round // OTHERS
        elif not model.has_limits:
            yield self._interior, 8 * self._a_round  # each shape in several lifts
        else:
            yield Strata(model), self._a_round
            if self.corners:
                yield NearCorners(self._corners), self._a_round
            if self.touches is not None:
                yield self.touches, self._a_round
            if moments is not None and model.size >= self._options.fewest_for_moments:
                yield moments, self._a_round

    def __iter__(self) -> Iterator[Samples]:
        """Yield round after round, each drawn when it is asked for."""
        order, drawn = self._rng.spawn(1)[0], 0
        if not self._long:
            # without limits there is nothing but the interior, and each shape in several lifts
            interior = self._options.interior * (1 if self._model.has_limits else 8)
            first = joined(self._drawn(self._interior, interior), self._corners)
            yield self._mixed(first, order)
            drawn = len(first)
        for number in range(max(self._options.rounds, self._options.hits)):
            some = self._round()
            opens = number < self.opening - 1
            yield self._mixed(some, order if opens else self._rng)
            drawn += len(some)
            if opens and number + 2 == self.opening:
                self._rng.permutation(drawn)  # a seed's later rounds are those of before

    def _mixed(self, some: Samples, order: np.random.Generator) -> Samples:
        """Samples in random order: of every kind from the first on, and alike whether early or late."""
        return some[order.permutation(len(some))]

    def _round(self) -> Samples:
        return joined(*(self._drawn(family, many) for family, many in self._each))

    def _drawn(self, family: StartFamily, many: int) -> Samples:
        """Draw starts, with the number of their source."""
        s = family.draw(self._rng, many)
        return replace(s, source=np.full(len(s), SOURCES.index(family.name)))
