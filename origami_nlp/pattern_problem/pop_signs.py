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
    BESIDE_SINGULAR,
    DUPLICATE_TOL,
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
SIGNS = {1.0: "+", -1.0: "-", 0.0: "0"}
OPEN = "?"
"""Of a sum that rounding leaves without a sign at a vertex that is not flat."""


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
    >>> signs.vertices, signs.of(np.zeros(4)), signs.of(np.array([0.1, 0.2, 0.3, -0.2]))
    ((2,), '0', '+')
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
    def without(self) -> tuple[int, ...]:
        """Interior vertices with more paper: their fold angles may sum to 0 where they are not flat."""
        return tuple(vertex for vertex, _, whole in self._loops if not _pops(whole))

    @cached_property
    def rows(self) -> np.ndarray:
        """What sums the fold angles round each of `vertices`, of 0 and 1, [v, n]."""
        rows = np.zeros((len(self.around), self.origami.creases))
        for row, creases in zip(rows, self.around, strict=True):
            np.add.at(row, list(creases), 1.0)
        return rows

    def of(self, phi: np.ndarray) -> str:
        """Return a sign for each of `vertices`: of a state whose facets do not cross.

        Parameters
        ----------
        phi
            Fold angles [rad], [n].

        Returns
        -------
        str
            ``+`` where they sum to more than 0 (valleys prevail), ``-`` to less, ``0`` where the vertex is flat (all
            within `BESIDE_SINGULAR`), ``?`` where the sum is within rounding of 0 though the vertex is not flat.
        """
        return "".join(self._sign(phi[list(creases)]) for creases in self.around)

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

    def crossed(self, states: np.ndarray) -> tuple[tuple[int, int], ...]:
        """Return where a path takes a vertex from one side to the other though it is not flat between: facets cross.

        Between two states the sum is 0 somewhere; a vertex that is flat there has fold angles no larger than the step.

        Parameters
        ----------
        states
            Along the path, closely, [S, n] [rad].

        Returns
        -------
        tuple of tuple
            Vertex, and number of the state after which it happens (from 0).
        """
        sums, found = self.sums(states), []
        for step, v in np.argwhere(sums[:-1] * sums[1:] < 0).tolist():
            a, b = (states[k][list(self.around[v])] for k in (step, step + 1))
            share = sums[step, v] / (sums[step, v] - sums[step + 1, v])
            if np.abs(a + share * (b - a)).max() > np.abs(b - a).max():
                found.append((self.vertices[v], step))
        return tuple(found)

    def alarms(self, states: np.ndarray) -> list[str]:
        """Return a line for each that is `crossed` along a path [S, n], states numbered from 1."""
        return [
            f"alarm: after state {k + 1} facets cross round vertex {vertex}: its fold angles sum to 0 though it "
            "is not flat; this is no motion of paper"
            for vertex, k in self.crossed(states)
        ]

    @staticmethod
    def _sign(folds: np.ndarray) -> str:
        if np.abs(folds).max() <= BESIDE_SINGULAR:
            return SIGNS[0.0]
        total = float(folds.sum())
        return (
            OPEN if abs(total) <= len(folds) * DUPLICATE_TOL else SIGNS[math.copysign(1.0, total)]
        )


def _pops(angle_sum: float) -> bool:
    return angle_sum <= 2 * math.pi + INPUT_TOL
