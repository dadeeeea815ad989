"""Curves of events over two parameters: where a contact closes or leaves, and limit points (folds).

A contact event is one system on either side of it: without the contact its opening is zero; a fold is a zero of ds/dl;
where equilibria pass the flat state one equation says when.
Along the normal of the curve in the plane of parameters both are events over one parameter, so that the curve may turn
in either of them.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np

from origami_nlp.continuation import (
    Equilibrium,
    EquilibriumCurve,
    Hold,
    Line,
    Tally,
    flat_event,
    flat_roots,
    is_equilibrium,
)
from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.numerics import ROUNDED, SAMPLED, STATIONARY
from origami_nlp.paths.family import Plane
from origami_nlp.problem import Contact

FIRST, LONGEST, SHORTEST = 2e-3, 0.05, 1e-4
"""Steps along a curve, as shares of the ranges."""
SHARPEST = 0.3
"""A step that turns the curve by more [rad] is halved."""
CUSP, REACHES = (5e-4, 1e-3, 2e-3), (0.02, 0.05, 0.1, 0.2)
"""Steps back in the plane [shares], and on in the states [rad], with which a fold is looked for beyond a cusp."""
MOST_CUSPS = 4
"""Of a curve, one way."""
MOST = 1000
"""Points of a curve, one way."""
MEETS = "meets another event"
"""Why a curve ends where beyond it there are no states; what is met follows."""
FOLD_STEPS = 12
"""Of the secant method for a fold."""


@dataclass(frozen=True, eq=False)
class EventPoint:
    """An event in the plane of two parameters: point of s [2], state [n], and both residuals."""

    point: np.ndarray
    frame: Equilibrium
    kkt: float
    event: float


@dataclass(frozen=True, eq=False)
class EventTracer:
    """Follows one kind of event through a plane.

    hold: without the contact that closes; None where equilibria pass the flat state.  contact: None for a fold.
    """

    plane: Plane
    hold: Hold | None
    contact: Contact | None
    tally: Tally

    def at(self, point: np.ndarray, normal: np.ndarray, state: np.ndarray) -> EventPoint | None:
        """Return the event on the line through a point of the plane, from a state nearby."""
        line = self.plane.line(point, normal * self.plane.size, 1.0)
        if self.hold is None:
            roots = [s for s, _ in flat_roots(line, -LONGEST, LONGEST)]
            if not roots:
                return None
            s = min(roots, key=abs)
            found, value = flat_event(line, s)
            kkt = float(np.abs(found.system.values).max())
        else:
            there = self._on(line, self.hold, state)
            if there is None:
                return None
            found, s, kkt, value = there, there.s, there.system.residual, there.ahead
            if self.contact is not None:
                value = float(found.problem.local(found.state).openings((self.contact,))[0][0])
        return EventPoint(point + s * normal * self.plane.size, found, kkt, value)

    def _on(self, line: Line, hold: Hold, state: np.ndarray) -> Equilibrium | None:
        """Return the fold, or where the contact closes, on a line."""
        curve, along = EquilibriumCurve(line, hold, self.tally), np.append(0.0 * state, 1.0)
        begin = np.append(state, 0.0)
        a = curve.at(begin, 0.0, along)
        if a is None:  # where no state has just this parameter: beyond a fold
            x = curve.correct(begin)
            a = None if x is None else curve.frame(x, along)
        if a is None:
            return None
        if self.contact is not None:
            return curve.where_closed(a, self.contact, a.tangent)
        # the limit point near a point by the secant method in the arclength
        b = curve.beside(a, SHORTEST)
        for _ in range(FOLD_STEPS):
            if b is None or abs(b.ahead) <= ROUNDED or b.ahead == a.ahead:
                break
            # secant step to ds/dl = 0 from b, in the length along its tangent
            h = float(b.tangent @ (curve.root * (a.x - b.x))) * b.ahead / (b.ahead - a.ahead)
            if abs(h) <= ROUNDED:
                break
            if abs(h) > SHARPEST:
                return None
            a, b = b, curve.beside(b, h)
        return b if b is not None and abs(b.ahead) <= STATIONARY else None

    def follow(
        self, first: EventPoint, until: float = math.inf
    ) -> tuple[list[EventPoint], tuple[str, str]]:
        """Follow an event both ways through the plane; return its points in order, and why they end.

        until: when the time is over (`time.monotonic`).
        """
        along = self._direction(first)
        if along is None:
            return [first], ("no second point",) * 2
        back, why_back = self._one_way(first, -along, until)
        ahead, why = self._one_way(first, along, until)
        return [*reversed(back), first, *ahead], (why_back, why)

    def _direction(self, first: EventPoint) -> np.ndarray | None:
        """Return the unit direction of the curve in shares of the ranges, from a second point."""
        size = self.plane.size
        for normal, step in np.eye(2)[[[0, 1], [1, 0]]]:
            for sign in (1.0, -1.0):
                ahead = first.point + sign * FIRST / 10 * step * size
                there = self.at(ahead, normal, first.frame.state)
                along = None if there is None else sign * (there.point - first.point) / size
                if along is not None and np.linalg.norm(along) <= FIRST:
                    return np.asarray(along / np.linalg.norm(along))
        return None

    def _one_way(
        self, first: EventPoint, along: np.ndarray, until: float
    ) -> tuple[list[EventPoint], str]:
        size, out = self.plane.size, list[EventPoint]()
        here, h, moved, cusps = first, FIRST, np.zeros(len(first.frame.state)), 0
        while len(out) < MOST:
            if time.monotonic() > until:
                return out, OUT_OF_TIME
            # pseudo-arclength in the plane: the next point is looked for on a line across the direction
            normal = np.array([-along[1], along[0]])
            there = self.at(here.point + h * along * size, normal, here.frame.state + h * moved)
            if there is None or not self._is_near(here, there, along, h):
                h /= 2
                if h >= SHORTEST:
                    continue
                # at a cusp of folds two fold curves meet tangentially: steps in the plane cannot turn by pi
                there = self._past_cusp(here, along, moved)
                if there is None or cusps == MOST_CUSPS:
                    return out, "singular, or no such event beyond"
                cusps, h = cusps + 1, FIRST
            share = (there.point - self.plane.corner) / size
            if (share < 0).any() or (share > 1).any():
                edge = self._at_edge(here, there)
                return ([*out, edge] if edge else out), "range"
            if not is_equilibrium(there.frame):
                h /= 2
                if h < SHORTEST:
                    return out, MEETS
                continue
            step = (there.point - here.point) / size
            length = float(np.linalg.norm(step))
            moved, along = (there.frame.state - here.frame.state) / length, step / length
            out.append(there)
            here, h = there, min(LONGEST, 1.5 * h)
            back = float(np.linalg.norm((here.point - first.point) / size))
            # a curve with cusps may cross itself in the plane, in other states
            apart = float(np.abs(here.frame.state - first.frame.state).max())
            if len(out) > 3 and back < 0.5 * length and apart <= SAMPLED:
                return out, "closed curve"
        return out, f"more than {MOST} points"

    def _is_near(self, here: EventPoint, there: EventPoint, along: np.ndarray, h: float) -> bool:
        """Return whether a point is about a step further along the curve, which turns by little."""
        step = (there.point - here.point) / self.plane.size
        length = float(np.linalg.norm(step))
        far = length > 1.5 * h or length == 0.0
        return not far and float(np.arccos(np.clip(step @ along / length, -1, 1))) <= SHARPEST

    def _past_cusp(
        self, here: EventPoint, along: np.ndarray, moved: np.ndarray
    ) -> EventPoint | None:
        """Return a fold beyond a cusp: the curve comes back in the plane while the states go on."""
        size = float(np.linalg.norm(moved))
        if self.hold is None or self.contact is not None or size == 0.0:
            return None
        onward, normal = moved / size, np.array([-along[1], along[0]])
        for back in CUSP:
            for reach in REACHES:
                guess = here.point - back * along * self.plane.size
                there = self.at(guess, normal, here.frame.state + reach * onward)
                if there is not None and is_equilibrium(there.frame):
                    went = float((there.frame.state - here.frame.state) @ onward)
                    if 0.3 * reach < went < 3 * reach:
                        return there
        return None

    def _at_edge(self, a: EventPoint, b: EventPoint) -> EventPoint | None:
        """Return the event at the edge of the plane between two points."""
        corner, size = self.plane.corner, self.plane.size
        p, q = ((e.point - corner) / size for e in (a, b))
        shares = [
            ((0.0 if q[k] < 0 else 1.0) - p[k]) / (q[k] - p[k]) if not 0 <= q[k] <= 1 else 2.0
            for k in (0, 1)
        ]
        k = int(np.argmin(shares))
        at = p + shares[k] * (q - p)
        # on the edge to the last bit
        at[k] = round(at[k])
        state = a.frame.state + shares[k] * (b.frame.state - a.frame.state)
        return self.at(corner + at * size, np.eye(2)[1 - k], state)
