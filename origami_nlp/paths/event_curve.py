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
class FlatTracer:
    """Follows where a curve of equilibria passes the flat state."""

    plane: Plane
    contact: None = None

    def at(self, point: np.ndarray, normal: np.ndarray, state: np.ndarray) -> EventPoint | None:
        """Return the event nearest to a point of the plane on a line through it."""
        line = self.plane.line(point, normal * self.plane.size, 1.0)
        roots = [s for s, _ in flat_roots(line, -LONGEST, LONGEST)]
        if not roots:
            return None
        s = min(roots, key=abs)
        frame, value = flat_event(line, s)
        closed = float(np.abs(frame.system.values).max())
        return EventPoint(point + s * normal * self.plane.size, frame, closed, value)


@dataclass(frozen=True, eq=False)
class EventTracer:
    """Follows one kind of event: hold without the contact that closes (None for a fold)."""

    plane: Plane
    hold: Hold
    contact: Contact | None
    tally: Tally

    def at(self, point: np.ndarray, normal: np.ndarray, state: np.ndarray) -> EventPoint | None:
        """Return the event on the line through a point of the plane, from a state nearby."""
        line = self.plane.line(point, normal * self.plane.size, 1.0)
        curve = EquilibriumCurve(line, self.hold, self.tally)
        start = curve.at(np.append(state, 0.0), 0.0, np.append(np.zeros(len(state)), 1.0))
        if start is None:
            start = self._nearby(curve, state)
        if start is None:
            return None
        found = self._fold(curve, start) if self.contact is None else curve.where_closed(
            start, self.contact, start.tangent
        )  # fmt: skip
        if found is None:
            return None
        value = found.ahead
        if self.contact is not None:
            value = float(found.problem.local(found.state).openings((self.contact,))[0][0])
        at = point + found.s * normal * self.plane.size
        return EventPoint(at, found, found.system.residual, value)

    def _nearby(self, curve: EquilibriumCurve, state: np.ndarray) -> Equilibrium | None:
        """Return a point of the curve near a state where none has just this parameter: beyond a fold."""
        x = curve.correct(np.append(state, 0.0))
        return None if x is None else curve.frame(x, np.append(np.zeros(len(state)), 1.0))

    def _fold(self, curve: EquilibriumCurve, start: Equilibrium) -> Equilibrium | None:
        """Return the limit point (fold) near a point by the secant method in the arclength."""
        a, b = start, curve.beside(start, SHORTEST)
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


Tracer = FlatTracer | EventTracer
"""Finds one kind of event on lines through the plane."""


def follow_event(
    tracer: Tracer, first: EventPoint, until: float = math.inf
) -> tuple[list[EventPoint], tuple[str, str]]:
    """Follow an event both ways through the plane; return its points in order, and why they end.

    until: when the time is over (`time.monotonic`).
    """
    along = _direction(tracer, first)
    if along is None:
        return [first], ("no second point",) * 2
    back, why_back = _one_way(tracer, first, -along, until)
    ahead, why = _one_way(tracer, first, along, until)
    return [*reversed(back), first, *ahead], (why_back, why)


def _direction(tracer: Tracer, first: EventPoint) -> np.ndarray | None:
    """Return the unit direction of the curve in shares of the ranges, from a second point."""
    for k in (0, 1):
        normal, step = np.zeros(2), np.zeros(2)
        normal[k], step[1 - k] = 1.0, FIRST / 10
        for sign in (1.0, -1.0):
            there = tracer.at(
                first.point + sign * step * tracer.plane.size, normal, first.frame.state
            )
            if there is not None:
                along = sign * (there.point - first.point) / tracer.plane.size
                if np.linalg.norm(along) <= FIRST:
                    return along / np.linalg.norm(along)
    return None


def _one_way(
    tracer: Tracer, first: EventPoint, along: np.ndarray, until: float
) -> tuple[list[EventPoint], str]:
    plane = tracer.plane
    out: list[EventPoint] = []
    here, h, moved = first, FIRST, np.zeros(len(first.frame.state))
    cusps = 0
    while len(out) < MOST:
        if time.monotonic() > until:
            return out, OUT_OF_TIME
        # pseudo-arclength in the plane: the next point is looked for on a line across the direction
        normal = np.array([-along[1], along[0]])
        guess = here.point + h * along * plane.size
        there = tracer.at(guess, normal, here.frame.state + h * moved)
        step = None if there is None else (there.point - here.point) / plane.size
        good = there is not None and step is not None and np.linalg.norm(step) <= 1.5 * h
        turn = np.inf
        if good and step is not None:
            turn = float(np.arccos(np.clip(step @ along / np.linalg.norm(step), -1, 1)))
        if there is None or step is None or not good or turn > SHARPEST:
            h /= 2
            if h >= SHORTEST:
                continue
            # at a cusp of folds two fold curves meet tangentially: steps in the plane cannot turn by pi
            there = _past_cusp(tracer, here, along, moved)
            if there is None or cusps == MOST_CUSPS:
                return out, "singular, or no such event beyond"
            cusps, h, step = cusps + 1, FIRST, (there.point - here.point) / plane.size
        share = (there.point - plane.corner) / plane.size
        if (share < 0).any() or (share > 1).any():
            edge = _at_edge(tracer, here, there)
            return ([*out, edge] if edge else out), "range"
        if not is_equilibrium(there.frame):
            h /= 2
            if h < SHORTEST:
                return out, f"{MEETS}{_what(there.frame)}"
            continue
        length = float(np.linalg.norm(step))
        moved = (there.frame.state - here.frame.state) / length
        along = step / length
        out.append(there)
        here, h = there, min(LONGEST, 1.5 * h)
        back = float(np.linalg.norm((here.point - first.point) / plane.size))
        # a curve with cusps may cross itself in the plane, in other states
        apart = float(np.abs(here.frame.state - first.frame.state).max())
        if len(out) > 3 and back < 0.5 * length and apart <= SAMPLED:
            return out, "closed curve"
    return out, f"more than {MOST} points"


def _what(frame: Equilibrium) -> str:
    """Return which other event makes a state none."""
    p = frame.problem
    pulls = [
        p.words(c, frame.state).text
        for c, force in zip(frame.hold.contacts, frame.forces, strict=True)
        if force < 0
    ]
    at_limit = [p.words(c, frame.state).text for c in p.beyond(frame.state)]
    if pulls or at_limit:
        return ": " + (f"{pulls[0]} stops pushing" if pulls else f"{at_limit[0]} closes")
    if why := p.refuses(frame.state):
        return f": {why}"
    return ": a contact leaves the facet that it touches"


def _past_cusp(
    tracer: Tracer, here: EventPoint, along: np.ndarray, moved: np.ndarray
) -> EventPoint | None:
    """Return a fold beyond a cusp: the curve comes back in the plane while the states go on."""
    size = float(np.linalg.norm(moved))
    if tracer.contact is not None or size == 0.0:
        return None
    onward, normal = moved / size, np.array([-along[1], along[0]])
    for back in CUSP:
        for reach in REACHES:
            guess = here.point - back * along * tracer.plane.size
            there = tracer.at(guess, normal, here.frame.state + reach * onward)
            if there is not None and is_equilibrium(there.frame):
                went = float((there.frame.state - here.frame.state) @ onward)
                if 0.3 * reach < went < 3 * reach:
                    return there
    return None


def _at_edge(tracer: Tracer, a: EventPoint, b: EventPoint) -> EventPoint | None:
    """Return the event at the edge of the plane between two points."""
    plane = tracer.plane
    p, q = ((e.point - plane.corner) / plane.size for e in (a, b))
    shares = [
        ((0.0 if q[k] < 0 else 1.0) - p[k]) / (q[k] - p[k]) if not 0 <= q[k] <= 1 else 2.0
        for k in (0, 1)
    ]
    k = int(np.argmin(shares))
    normal = np.zeros(2)
    normal[1 - k] = 1.0
    at = p + shares[k] * (q - p)
    # on the edge to the last bit
    at[k] = round(at[k])
    state = a.frame.state + shares[k] * (b.frame.state - a.frame.state)
    return tracer.at(plane.corner + at * plane.size, normal, state)
