"""States of a pattern with one vertex popped to its other side."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from origami_nlp.facets import Labels
from origami_nlp.pattern import Pattern
from origami_nlp.starts.family import Listed

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

    def __init__(self, pattern: Pattern, labels: Labels, phi: np.ndarray) -> None:
        self.size = pattern.creases
        self._around, self._phi = creases_around(pattern, labels), phi

    def states(self) -> Iterator[np.ndarray]:
        """Yield them, none closed yet."""
        for creases, (size, share) in product(self._around, POPPED):
            if self._phi[creases].any():
                start = size * self._phi
                start[creases] *= share
                yield start


def creases_around(pattern: Pattern, labels: Labels) -> list[list[int]]:
    """Return the creases round each vertex, in an order of vertices that labels do not change."""
    rank = np.argsort(labels.order)
    around = [list(loop.creases) for loop in pattern.vertices]
    return sorted(around, key=lambda creases: sorted(rank[creases].tolist()))
