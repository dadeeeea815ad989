"""States of an origami, posed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.escapes import Move
from origami_nlp.pattern_problem import PatternProblem


@dataclass(frozen=True)
class CanonicalStates:
    """States."""

    stated: PatternProblem
    problem: PatternProblem
    moves: Sequence[Move]
    labels: None
    minima: np.ndarray
    unit: float

    def back(self, x: np.ndarray) -> np.ndarray:
        """Return x."""
        return x


def canonical_states(stated: PatternProblem, scene: object, states: np.ndarray) -> CanonicalStates:
    """Pose."""
    return CanonicalStates(stated, stated, stated.moves, None, states, 1.0)
