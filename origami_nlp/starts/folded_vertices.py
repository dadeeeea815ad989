"""Starts with one vertex of a pattern almost folded flat: the others as flat as closure lets them be."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product

import numpy as np

from origami_nlp.errors import OrigamiError
from origami_nlp.folding import check_admissible
from origami_nlp.numerics import CLOSURE_TOL, quaternion
from origami_nlp.pattern import Loop, Pattern
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem, round_vertex
from origami_nlp.starts.family import Listed
from origami_nlp.starts.of_patterns import creases_around

LARGEST_DEGREE = 8
"""Of vertices whose flat foldings are listed one by one."""
OPENED = 0.9
"""Share of 180 degrees by which creases are folded: with layers apart fewer facets touch at the start."""


def vertex_foldings(pattern: Pattern, loop: Loop, contact: bool) -> np.ndarray:
    """Return the ways to fold a vertex flat, 0, 1 or -1 a crease, [F, d].

    Parameters
    ----------
    pattern
        Flat.
    loop
        Round the vertex, of few creases: 3 to the power of their number are tried.
    contact
        Whether to leave out those whose layers have no order.
    """
    axes = np.array(loop.signs)[:, None] * pattern.directions[list(loop.creases)]
    choices = np.array(list(product((0, 1, -1), repeat=len(axes))), float)
    low, high = pattern.limit_angles[:, list(loop.creases)]
    choices = choices[((math.pi * choices >= low) & (math.pi * choices <= high)).all(axis=1)]
    q = tuple(np.full(len(choices), x) for x in (1.0, 0.0, 0.0, 0.0))
    for turn, axis in zip(choices.T, axes, strict=True):
        # cosine and sine of half of 0 or +-pi are 1 and 0, or 0 and +-1: exact
        q = quaternion.multiply(quaternion.fold(turn == 0, turn, axis), q)
    closed = (np.abs(q[1:]).max(axis=0) <= CLOSURE_TOL) & (q[0] > 0)
    at = round_vertex(pattern, loop) if contact else None
    foldings = choices[closed]
    if at is None:
        return foldings
    try:
        return foldings[[check_admissible(at, math.pi * f).admissible for f in foldings]]
    except OrigamiError:
        return foldings


class FoldedVertices(Listed):
    """Each vertex in each of its flat foldings, those that fold least first, in an order that labels do not change.

    Parameters
    ----------
    problem
        Of a flat pattern.
    labels
        The order of its creases.
    contact
        Whether layers round the vertex must have an order.
    """

    name = "vertices almost folded flat"
    sentence = "one vertex almost folded flat, the others as flat as closure lets them be"

    def __init__(self, problem: PatternProblem, labels: CanonicalLabelling, contact: bool) -> None:
        self.size, self._pattern = problem.size, problem.pattern
        self._labels, self._contact = labels, contact

    def states(self) -> Iterator[np.ndarray]:
        """Yield them, none closed yet."""
        order = creases_around(self._pattern, self._labels)
        loops = {frozenset(loop.creases): loop for loop in self._pattern.vertices}
        starts = []
        for creases in order:
            if len(creases) <= LARGEST_DEGREE:
                loop = loops[frozenset(creases)]
                for folding in vertex_foldings(self._pattern, loop, self._contact):
                    if folding.any():
                        start = np.zeros(self.size)
                        start[list(loop.creases)] = OPENED * math.pi * folding
                        starts.append(start)
        yield from sorted(starts, key=lambda x: (np.abs(x).sum(), self._labels.key(x)))
