"""A contact: what it is worth at a state, how it is held, on which side it is open; and closure of loops.

Fold limits, mirrors, the axis and rays on facets are all one inequality constraint each, active where the contact is
closed.  What motions of a
state obey is closure, vertex by vertex.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

STOP = "(stop)"
"""Behind the fold angle of a limit before facets meet."""


@dataclass(frozen=True, order=True)
class Contact:
    """One contact with the side on which it is open: side * gap >= 0, or side * phi <= at for a fold limit.

    kind: ``limit`` (two adjacent facets, or a stop before they meet) or ``gap`` (a mirror, the axis, a ray on a facet).
    index: variable of a limit, or position in `Structure.gaps`.
    side: +1 or -1.
    at: of a limit, side times the fold angle where it is closed [rad]: pi where the facets lie on each other.

    What it is worth at a state: `openings`.  Its name and weight: `Problem.name`, `Problem.weight`.
    """

    kind: str
    index: int
    side: int
    at: float = math.pi

    def __hash__(self) -> int:  # asked for a thousand times a step of a descent into contact
        return hash((self.index, self.side))

    @property
    def is_limit(self) -> bool:
        """Whether it is a fold limit."""
        return self.kind == "limit"

    @property
    def where(self) -> str:
        """Fold angle of a limit in words: ``+pi``, or that of a stop in degrees."""
        sign = "+" if self.side > 0 else "-"
        return (
            f"{sign}pi"
            if self.at == math.pi
            else f"{math.degrees(self.side * self.at):.6g} degrees {STOP}"
        )

    def hold(self, x: np.ndarray) -> None:
        """Set the fold angle of a closed limit to it exactly, in states [..., n] (in place); gaps need Newton."""
        if self.is_limit:
            x[..., self.index] = self.side * self.at


@dataclass(frozen=True, eq=False)
class FoldLimits:
    """Between which fold angles each variable is: +-pi, or stops that a scene states.

    Attributes
    ----------
    low, high
        Shape [n] [rad]; where no limits are imposed, how far fold angles are looked at.

    Examples
    --------
    >>> limits = FoldLimits(np.array([-1.0, -np.pi]), np.array([2.0, np.pi]))
    >>> limits.room(np.array([1.5, 3.0])).round(3).tolist(), limits.contact(0, 1.9).at
    ([0.5, 0.142], 2.0)
    """

    low: np.ndarray
    high: np.ndarray

    def clip(self, x: np.ndarray) -> np.ndarray:
        """Return states [..., n], what is beyond at the limit."""
        return np.clip(x, self.low, self.high)

    def room(self, x: np.ndarray) -> np.ndarray:
        """Return how far the nearer limit is, [..., n]; negative beyond."""
        return np.minimum(x - self.low, self.high - x)

    def inside(self, x: np.ndarray, tolerance: float = 0.0) -> Any:
        """Return which fold angles [..., n] are within, up to a tolerance."""
        return np.asarray((x <= self.high + tolerance) & (x >= self.low - tolerance))

    def side(self, x: np.ndarray) -> np.ndarray:
        """Return on which side the nearer limit is, -1 or 1; the lower one of two that are equally near."""
        return np.asarray(np.where(self.high - x < x - self.low, 1, -1))

    def near(self, x: np.ndarray, tolerance: float) -> np.ndarray:
        """Return at which limits fold angles are, up to a tolerance: -1, 0 or 1, [..., n]."""
        return np.where(np.abs(self.room(x)) <= tolerance, self.side(x), 0)

    def hold(self, x: np.ndarray, at_limit: np.ndarray) -> np.ndarray:
        """Return states [..., n] with what is at its limit (-1 or 1; 0: neither) exactly there."""
        return np.where(at_limit > 0, self.high, np.where(at_limit < 0, self.low, x))

    def folded_flat(self, at_limit: np.ndarray) -> np.ndarray:
        """Return which creases at their limits are at +-pi, where facets lie on each other: -1, 0 or 1, [..., n]."""
        reached = np.where(at_limit > 0, self.high == math.pi, self.low == -math.pi)
        return at_limit * reached

    def contact(self, variable: int, angle: float) -> Contact:
        """Return the limit that is nearer to an angle of a variable (as `side`)."""
        low, high = float(self.low[variable]), float(self.high[variable])
        upper = high - angle < angle - low
        return Contact("limit", variable, 1 if upper else -1, high if upper else -low)

    def contacts(self, x: np.ndarray, which: np.ndarray) -> tuple[Contact, ...]:
        """Return the nearer limits of some variables of a state [n]; which: of bool, [n]."""
        return tuple(self.contact(int(v), x[v]) for v in np.flatnonzero(which))

    def same(self, order: np.ndarray, sign: int) -> bool:
        """Return whether x -> sign x[order] leaves the limits as they are."""
        low, high = (self.low, self.high) if sign > 0 else (-self.high, -self.low)
        return bool((low[order] == self.low).all() and (high[order] == self.high).all())

    @property
    def both(self) -> tuple[Contact, ...]:
        """Both limits of every variable."""
        return tuple(
            Contact("limit", v, side, float(self.high[v] if side > 0 else -self.low[v]))
            for v in range(len(self.low))
            for side in (-1, 1)
        )


def held(x: np.ndarray, contacts: Iterable[Contact]) -> np.ndarray:
    """Return states [..., n] with the fold angles of closed limits exactly there."""
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
            values[..., r] = c.at - c.side * x[..., c.index]
            slopes[..., r, c.index] = -c.side
        else:
            values[..., r] = c.side * gaps[..., c.index]
            slopes[..., r, :] = c.side * gradients[..., c.index, :]
    return values, slopes


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


@dataclass(frozen=True, eq=False)
class Local:
    """Values and first derivatives at one state x, or at K states; energies are over the problem's scale.

    Attributes
    ----------
    x
        [..., n] [rad].
    gradient
        Of the energy, [..., n].
    closure
        Residuals of loop closure, [..., m].
    closure_jacobian
        [..., m, n].
    gaps
        Of what touches or may, [..., c].
    gaps_jacobian
        [..., c, n].
    """

    x: np.ndarray
    gradient: np.ndarray
    closure: np.ndarray
    closure_jacobian: np.ndarray
    gaps: np.ndarray
    gaps_jacobian: np.ndarray

    def openings(self, contacts: Sequence[Contact]) -> tuple[np.ndarray, np.ndarray]:
        """How far contacts are open (>= 0 where they are), [..., r], and the gradients of that, [..., r, n]."""
        return openings(self.x, self.gaps, self.gaps_jacobian, contacts)
