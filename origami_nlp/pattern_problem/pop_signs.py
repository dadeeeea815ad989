"""How much paper there is round each interior vertex, and which way each has popped.

The latter is the sign of the sum of its fold angles, which motions of paper keep.  Round a vertex with an angle sum of
360 degrees, or less, whose facets do not cross the fold angles sum to 0 in the flat state only (proved in
docs/validation/landscapes.md).  So admissible motions change the sign only through states in which the vertex is
exactly flat: vertices divide the states of a sheet into cells, and a descent that steps from one into another has
jumped over what parts them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np

from origami_nlp.numerics import (
    INPUT_TOL,
    cross,
    unit_normals,
)
from origami_nlp.pattern import Pattern


def angle_sums(pattern: Pattern) -> dict[int, float]:
    """Return the sum of the angles of paper round each interior vertex [rad], by the vertex.

    Parameters
    ----------
    pattern
        The pattern.

    Returns
    -------
    dict
        A sum a vertex.
    """
    spread = pattern.spread
    sums = np.zeros(len(spread.corners))
    for size in {len(polygon) for polygon in spread.polygons}:
        at = np.array([polygon for polygon in spread.polygons if len(polygon) == size])
        x = spread.corners[at]
        a, b = np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x
        up = (unit_normals(x)[:, None] * cross(a, b)).sum(axis=-1)
        np.add.at(sums, at, np.arctan2(up, (a * b).sum(axis=-1)) % (2 * math.pi))
    return {loop.vertex: float(sums[loop.vertex]) for loop in pattern.vertices}


JUMPS = 1e-3
"""Steps longer than this [rad] do not take a vertex from one side of its flat state to the other: shorter ones may."""


@dataclass(frozen=True, eq=False)
class PopSigns:
    """On which side of its flat state each interior vertex is: the sign of the sum of its fold angles.

    Parameters
    ----------
    origami
        A pattern; facets that meet at a vertex must not cross.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> from origami_nlp.pattern_problem import PopSigns
    >>> signs = PopSigns(o.examples.pattern("miura", 2, 2))
    >>> signs.vertices, signs.is_jump(np.array([0.1, 0.2, 0.3, -0.2]), np.full(4, -0.1))
    ((2,), True)
    """

    origami: Pattern

    @cached_property
    def _loops(self) -> tuple[tuple[int, tuple[int, ...], float], ...]:
        """Number, creases and angle sum [rad] of each interior vertex."""
        sums = angle_sums(self.origami)
        return tuple((at.vertex, at.creases, sums[at.vertex]) for at in self.origami.vertices)

    @cached_property
    def around(self) -> tuple[tuple[int, ...], ...]:
        """Creases (from 0) round each of `vertices`."""
        return tuple(creases for _, creases, whole in self._loops if _pops(whole))

    @cached_property
    def vertices(self) -> tuple[int, ...]:
        """Those with an angle sum of 360 degrees or less, as a file numbers them: the others have no sign."""
        return tuple(vertex for vertex, _, whole in self._loops if _pops(whole))

    @cached_property
    def _round(self) -> tuple[np.ndarray, np.ndarray]:
        """Creases round `vertices`, one vertex after the other, and where each begins."""
        many = np.array([len(creases) for creases in self.around], dtype=int)
        return np.array([*chain(*self.around)], dtype=int), np.cumsum(many) - many

    def sums(self, states: np.ndarray) -> np.ndarray:
        """Return the sum of the fold angles round each of `vertices` [rad], [..., v], of states [..., n]."""
        creases, first = self._round
        return np.add.reduceat(states[..., creases], first, axis=-1)

    def flat(self, phi: np.ndarray) -> np.ndarray:
        """Return which of `vertices` are exactly flat in a state [n], of bool [v]."""
        creases, first = self._round
        return ~np.logical_or.reduceat(phi[creases] != 0, first)

    def is_jump(self, before: np.ndarray, after: np.ndarray) -> bool:
        """Return whether a step between two states [n] takes a vertex past its flat state, by more than `JUMPS`."""
        creases, first = self._round
        passed = self.sums(before) * self.sums(after) < 0
        far = np.maximum.reduceat(np.abs(after - before)[creases], first) > JUMPS
        return bool((passed & far).any())


def _pops(angle_sum: float) -> bool:
    return angle_sum <= 2 * math.pi + INPUT_TOL
