"""Where descents start: corners of the state space, strata between them, touches, the interior, and moments.

Where starts begin matters more than how fast a descent is: minima with many closed contacts are hardly ever reached
from the interior, but a start on their own stratum, with its contacts held, often reaches them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.programme import OPEN, Model, random_strata, vertex_candidates, vertices
from origami_nlp.starts.crossings import model_rows
from origami_nlp.starts.moments import MomentStarts
from origami_nlp.starts.samples import Samples, joined
from origami_nlp.starts.touches import TouchStarts, touch_starts

CORNER, INTERIOR, SUBSET, STRATUM, TOUCH, MOMENT = range(6)
"""Sources of starts."""
DRAWN = (INTERIOR, SUBSET, STRATUM, TOUCH, MOMENT)
"""Those that are drawn anew: only how often these reach a minimum says how likely another was missed."""
GIVEN = 6
"""States that are given, guesses, minima of second order beside the flat state, either side of saddles: not counted."""
SOURCES = ("corners", "interior", "near corners", "strata", "touches", "moments")
"""Their names, in the order of their numbers."""


MOST_WITH_CORNERS = 24
"""Creases up to which corners are started from: with more there are too many that nothing holds."""
FEWEST_FOR_MOMENTS = 16
"""Creases from which moments are started from as well: with 10 and 12 they found no more in the same time."""
OTHERS = 8
"""With more creases, one start in so many is no moment."""


def is_chain(model: Model) -> bool:
    """Tell whether fold limits are all that can touch in a vertex without symmetry: what `MomentStarts` ask for."""
    return model.scene.group.is_trivial and not model.structure.gaps


@dataclass(frozen=True)
class Effort:
    """How much time a search may take.

    Attributes
    ----------
    corners
        Candidates for corners of the state space: all of them up to this many, a sample beyond.
    interior
        Starts in the interior.
    a_round
        Starts of each kind in a round, for one degree of freedom; more with more, up to 64 times.
    rounds
        Rounds at most.
    hits
        How often rounds must have reached every minimum.
    quiet
        Rounds without a new minimum after which the search may stop although one was reached less often.
    in_a_row
        Of a pattern: random starts in a row that find nothing new, after which the search stops.
    """

    corners: int
    interior: int
    a_round: int
    rounds: int
    hits: int
    quiet: int
    in_a_row: int


EFFORTS = {
    "quick": Effort(corners=256, interior=32, a_round=8, rounds=1, hits=1, quiet=1, in_a_row=10),
    "normal": Effort(
        corners=8192, interior=48, a_round=14, rounds=16, hits=2, quiet=2, in_a_row=40
    ),
    "thorough": Effort(
        corners=16384, interior=512, a_round=64, rounds=40, hits=4, quiet=4, in_a_row=160
    ),
}
"""By name."""


def effort_of(name: object) -> Effort:
    """Return an effort by its name, or complain."""
    if not isinstance(name, str) or name not in EFFORTS:
        raise OptionError(f"effort = {name!r} is unknown: use one of {', '.join(EFFORTS)}")
    return EFFORTS[name]


class Rounds:
    """Rounds of closed starts of a model, the same for the same seed.

    The first holds the corners and the interior besides; each holds corners with some of their creases let go,
    random strata, and touches; all but corners and the interior hold their contacts until they have converged.
    """

    def __init__(self, model: Model, seed: int, effort: Effort) -> None:
        self._model, self._effort = model, effort
        self._rng = np.random.default_rng(seed)
        self._long = model.size > MOST_WITH_CORNERS
        corners = np.zeros((0, model.size))
        self._corners = corners if self._long else vertices(model, effort.corners, self._rng)
        self.corners = len(self._corners)
        self.every_corner = 0 < vertex_candidates(model) <= effort.corners
        self._touch = model.scene.group.is_trivial and bool(model_rows(model))
        self.touches: TouchStarts | None = None
        share = 0.6 if self._touch else 1.25  # touches are a third kind of start
        self._moments = MomentStarts(model, self._rng) if is_chain(model) else None
        self._a_round = round(
            share * effort.a_round * min(2.5 ** min(max(model.freedom - 1, 0), 9), 64)
        )
        if self._long:  # a descent takes longer
            self._a_round = 1 + self._a_round * MOST_WITH_CORNERS // model.size

    def __iter__(self) -> Iterator[Samples]:
        """Yield round after round."""
        if self._long:
            yield from (self._mixed(self._round()) for _ in range(self._effort.rounds))
            return
        interior = self._effort.interior
        if not self._model.has_limits:
            interior *= 8  # nothing but the interior, and each shape in several lifts
        inside = random_strata(self._model, self._rng, interior, 0)
        first = [Samples.on(inside, source=INTERIOR)]
        if len(self._corners):
            first.append(Samples.on(self._corners, _shut(self._corners), source=CORNER))
        # batches cost by the call more than by the sample: the first rounds go with them
        yield self._mixed(*first, *(self._round() for _ in range(self._effort.hits)))
        for _ in range(self._effort.rounds - self._effort.hits):
            yield self._mixed(self._round())

    def _mixed(self, *parts: Samples) -> Samples:
        """Samples in random order: of every kind from the first on, and alike whether early or late."""
        some = joined(*parts)
        return some[self._rng.permutation(len(some))]

    def _round(self) -> Samples:
        count = self._a_round
        if self._long and self._moments is not None:
            return self._balanced(self._moments, count)
        if not self._model.has_limits:
            return Samples.on(random_strata(self._model, self._rng, 8 * count, 0), source=INTERIOR)
        drawn = random_strata(self._model, self._rng, count)
        parts = [Samples.on(drawn, _shut(drawn), hold=True, source=STRATUM)]
        if len(self._corners):
            parts.append(self._near_corners(count))
        if self._touch:
            parts.append(self._touching(count))
        if self._moments is not None and self._model.size >= FEWEST_FOR_MOMENTS:
            parts.append(self._moments.samples(count, MOMENT))
        return joined(*parts)

    def _balanced(self, moments: MomentStarts, count: int) -> Samples:
        """States near balance from random moments, and a few others from the interior."""
        inside = random_strata(self._model, self._rng, 1 + count // OTHERS, 0)
        return joined(moments.samples(count, MOMENT), Samples.on(inside, source=INTERIOR))

    def _touching(self, count: int) -> Samples:
        """States on strata with touches, their contacts held until they have converged."""
        self.touches = new = touch_starts(self._model, self._rng, count, self.touches)
        sides = np.where(new.gaps == OPEN, 1, new.touches[..., 2])
        hold, source = np.ones(len(new), dtype=bool), np.full(len(new), TOUCH)
        springs = np.zeros(len(new), dtype=int)
        return Samples(new.x, new.act.astype(int), new.gaps, sides, hold, source, springs)

    def _near_corners(self, count: int) -> Samples:
        """Corners with a random subset of their creases let go."""
        rng = self._rng
        x = self._corners[rng.integers(len(self._corners), size=count)]
        shut = _shut(x)
        closed = shut != 0
        order = np.where(closed, rng.random(x.shape), 2.0).argsort(axis=1).argsort(axis=1)
        keep = (rng.random(count) * closed.sum(axis=1)).astype(int)  # fewer than all
        return Samples.on(x, np.where(order < keep[:, None], shut, 0), hold=True, source=SUBSET)


def _shut(x: np.ndarray) -> np.ndarray:
    """Creases of states [K, n] at their fold limits: -1, 0 or 1."""
    return np.where(np.abs(x) == math.pi, np.sign(x), 0).astype(int)
