"""Curves of events over two parameters: where a contact closes or leaves, and limit points (folds).

A contact event is one system on either side of it: without the contact its opening is zero; a fold is a zero of ds/dl;
where equilibria pass the flat state one equation says when.  Along a line across the curve in the plane of parameters
both are events over one parameter.  The curve is traced in the plane and the states together, so that it may turn in
either parameter; at a cusp, where two curves of folds meet tangentially, no line across it meets it, and it ends.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.continuation.equilibrium import Equilibrium, EquilibriumCurve
from origami_nlp.continuation.flat import flat_event, flat_roots
from origami_nlp.continuation.line import Line
from origami_nlp.continuation.one_sided_branches import is_equilibrium
from origami_nlp.continuation.tracer import SINGULAR, ContinuationOptions, End, trace
from origami_nlp.numerics import ROUNDED, STATIONARY
from origami_nlp.problem import Contact

STEPS = ContinuationOptions(2e-3, 0.05, 1e-4, growth=1.5, aside=0.5, most=1000)
"""Along a curve: shares of the ranges, and `STATES` times fold angles [rad]."""
STATES = 0.1
AHEAD = 2e-4
"""Step of the difference that is the tangent."""
SHARPEST = 0.3
"""Longest step to a fold over one parameter."""
MEETS = "meets another event"
"""Why a curve ends where beyond it there are no states; what is met follows."""
FOLD_STEPS = 12
"""Of the secant method for a fold."""


@dataclass(frozen=True, eq=False)
class EventPoint:
    """An event in the plane of two parameters, a frame of the curve.

    x: shares of both ranges, and the state, [2 + n].  kkt, event: residuals.
    """

    x: np.ndarray
    frame: Equilibrium
    kkt: float
    event: float
    tangent: np.ndarray

    @property
    def bend(self) -> np.ndarray:
        """Not known: steps are straight."""
        return 0.0 * self.tangent


@dataclass(eq=False)
class EventTracer:
    """One kind of event in a plane of two parameters, as a curve to trace (`tracer.CurveProblem`).

    lines: gives the line over a parameter (0 or 1) at a share of the range of the other, where its range begins, and
    its length.  hold: without the contact that closes; None where equilibria pass the flat state.  contact: None for a
    fold.  states: variables of a state.  axis: the parameter over which events are looked for.
    """

    lines: Callable[[int, float], tuple[Line, float, float]]
    hold: tuple[Contact, ...] | None
    contact: Contact | None
    states: int
    axis: int
    known: EventPoint | None = None

    def at(self, share: np.ndarray, state: np.ndarray) -> EventPoint | None:
        """Return the event over one parameter near a point of the plane, in shares, from a state nearby."""
        axis, other = self.axis, 1 - self.axis
        # outside the ranges there may be no scenes
        share = np.where(np.arange(2) == other, share.clip(0.0, 1.0), share)
        line, low, length = self.lines(axis, share[other])
        near = low + share[axis] * length
        # steps count shares of the range
        line = replace(line, weight=1.0 / length)  # type: ignore[type-var]
        if self.hold is None:
            room = STEPS.longest * length
            roots = [s for s, _ in flat_roots(line, near - room, near + room)]
            if not roots:
                return None
            found, value = flat_event(line, min(roots, key=lambda s: abs(s - near)))
            kkt = float(np.abs(found.system.values).max())
        else:
            there = self._on(line, self.hold, np.append(state, near))
            if there is None:
                return None
            found, kkt = there, there.system.residual
            value = there.ahead if self.contact is None else there.opening(self.contact)
        x = np.append(share, found.state)
        x[axis] = (found.s - low) / length
        return EventPoint(x, found, kkt, value, 0.0 * x)

    def _on(self, line: Line, hold: tuple[Contact, ...], begin: np.ndarray) -> Equilibrium | None:
        """Return the fold, or where the contact closes, on a line, from (x, s) nearby."""
        curve, along = EquilibriumCurve(line, hold), np.append(0.0 * begin[:-1], 1.0)
        a = curve.at(begin, float(begin[-1]), along)
        if a is None:  # where no state has just this parameter: beyond a fold
            x = curve.correct(begin)
            a = None if x is None else curve.frame(x, along)
        if a is None:
            return None
        if self.contact is not None:
            return curve.where_closed(a, self.contact, a.tangent)
        # the limit point near a point by the secant method in the arclength
        b = curve.beside(a, STEPS.shortest)
        for _ in range(FOLD_STEPS):
            if b is None or abs(b.ahead) <= ROUNDED or b.ahead == a.ahead:
                break
            # secant step to ds/dl = 0 from b, in the length along its tangent
            h = curve.along(b, a.x) * b.ahead / (b.ahead - a.ahead)
            if abs(h) <= ROUNDED:
                break
            if abs(h) > SHARPEST:
                return None
            a, b = b, curve.beside(b, h)
        return b if b is not None and abs(b.ahead) <= STATIONARY else None

    @property
    def root(self) -> np.ndarray:
        """Metric of shares and states."""
        return np.append(np.ones(2), np.full(self.states, STATES))

    def correct(self, x: np.ndarray) -> np.ndarray | None:
        """Move x onto the curve."""
        self.known = self.at(x[:2], x[2:])
        return None if self.known is None else self.known.x

    def frame(self, x: np.ndarray, along: np.ndarray) -> EventPoint | None:
        """Return the event at x with its tangent on the side of `along`; None where it has none."""
        here = self.known if self.known and self.known.x is x else self.at(x[:2], x[2:])
        step = AHEAD * along / self.root
        side = 1.0 if np.array_equal((x + step)[:2], (x + step)[:2].clip(0.0, 1.0)) else -1.0
        there = self.at((x + side * step)[:2], (x + side * step)[2:])
        if here is None or there is None:
            return None
        way = side * self.root * (there.x - here.x)
        length = float(np.linalg.norm(way))
        if not 0.0 < length < 10 * AHEAD:
            return None
        self.axis = int(np.abs(way[:2]).argmin())
        return replace(here, tangent=way / length)

    def follow(
        self, first: EventPoint, until: float
    ) -> tuple[Sequence[EventPoint], tuple[str, str]]:
        """Follow an event both ways through the plane; return its points in order, and why they end.

        until: when the time is over (`time.monotonic`).
        """

        def before(good: Callable[[EventPoint], bool]) -> Callable[[Sequence[EventPoint]], int]:
            return lambda points: sum(1 for _ in itertools.takewhile(good, points))

        ends = (
            End(before(lambda p: _strictly_inside(p.x)), "range", self._at_edge),
            End(before(lambda p: is_equilibrium(p.frame)), MEETS),
        )
        for self.axis in (0, 1):
            begun = self.frame(first.x, np.eye(len(first.x))[1 - self.axis])
            found = begun and trace(self, begun, replace(STEPS, until=until), ends)
            if found:
                points, whys = found.frames, (found.start, found.end)
                at_edge = [bool(np.isin(points[k].x[:2], (0.0, 1.0)).any()) for k in (0, -1)]
                a, b = ("range" if e else why for e, why in zip(at_edge, whys, strict=True))
                return points, (a, b)
        return [first], (SINGULAR,) * 2

    def _at_edge(self, a: EventPoint, b: EventPoint) -> EventPoint | None:
        """Return the event at the edge of the plane between two points."""
        p, q = a.x[:2], b.x[:2]
        edge = q.clip(0.0, 1.0)
        if np.array_equal(q, edge):
            return b
        shares = np.where(q == edge, np.inf, (edge - p) / np.where(q == edge, 1.0, q - p))
        k = int(shares.argmin())
        at = a.x + shares[k] * (b.x - a.x)
        # on the edge to the last bit
        at[k], self.axis = edge[k], 1 - k
        return self.at(at[:2], at[2:])


def _strictly_inside(x: np.ndarray) -> bool:
    return bool(0.0 < x[:2].min() and x[:2].max() < 1.0)
