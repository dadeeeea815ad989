"""A contact: what it is worth at a state, how it is held, on which side it is open; and closure of loops.

Fold limits, mirrors, the axis and rays on facets are all one inequality constraint each, active where the contact is
closed.  What motions of a
state obey is closure, vertex by vertex.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, order=True)
class Contact:
    """One contact with the side on which it is open: side * gap >= 0, or side * phi <= pi for a fold limit.

    kind: ``limit`` (two adjacent facets) or ``gap`` (a mirror, the axis, or a ray on a facet).
    index: variable of a limit, or position in `Structure.gaps`.
    side: +1 or -1.

    What it is worth at a state: `openings`.  Its name, weight and moment: `Model.name`, `Model.weight`.
    """

    kind: str
    index: int
    side: int

    @property
    def is_limit(self) -> bool:
        """Whether it is a fold limit."""
        return self.kind == "limit"

    def hold(self, x: np.ndarray) -> None:
        """Set the fold angle of a closed limit to +-pi exactly, in states [..., n] (in place); gaps need Newton."""
        if self.is_limit:
            x[..., self.index] = self.side * math.pi


def fold_limit(variable: int, angle: float) -> Contact:
    """Return the fold limit on the side of `angle` (that of zero is the lower one)."""
    return Contact("limit", variable, 1 if angle > 0 else -1)


def held(x: np.ndarray, contacts: Iterable[Contact]) -> np.ndarray:
    """Return states [..., n] with the fold angles of closed limits at +-pi exactly."""
    x = np.array(x, dtype=float)
    for contact in contacts:
        contact.hold(x)
    return x


def openings(
    x: np.ndarray, gaps: np.ndarray, gradients: np.ndarray, contacts: Sequence[Contact]
) -> tuple[np.ndarray, np.ndarray]:
    """Return how far contacts are open (>= 0 where they are) and the gradients of that.

    x [..., n], gaps [..., c] and their gradients [..., c, n] -> [..., r], [..., r, n].
    """
    lead = x.shape[:-1]
    values, slopes = np.zeros((*lead, len(contacts))), np.zeros((*lead, len(contacts), x.shape[-1]))
    for r, c in enumerate(contacts):
        if c.is_limit:
            values[..., r] = math.pi - c.side * x[..., c.index]
            slopes[..., r, c.index] = -c.side
        else:
            values[..., r] = c.side * gaps[..., c.index]
            slopes[..., r, :] = c.side * gradients[..., c.index, :]
    return values, slopes


def gap_weights(count: int, contacts: Sequence[Contact], multipliers: np.ndarray) -> np.ndarray:
    """Spread multipliers [..., r] over `count` gaps, [..., c], for a Hessian; limits are linear and drop out."""
    weights = np.zeros((*np.shape(multipliers)[:-1], count))
    for r, c in enumerate(contacts):
        if not c.is_limit:
            weights[..., c.index] += c.side * multipliers[..., r]
    return weights


@dataclass(frozen=True, eq=False)
class LoopClosure:
    """Closure round one vertex, or one hole, at a closed state.

    Attributes
    ----------
    variables
        Of the problem that it turns, [d].
    jacobian
        Of its equations, [k, d].
    hessians
        Of each of its equations, [k, d, d]; zeros where second order is not asked for.
    """

    variables: np.ndarray
    jacobian: np.ndarray
    hessians: np.ndarray
