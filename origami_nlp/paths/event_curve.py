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
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.continuation import (
    SINGULAR,
    ContinuationOptions,
    End,
    Equilibrium,
    EquilibriumCurve,
    Line,
    flat_event,
    flat_roots,
    is_equilibrium,
    trace,
)
from origami_nlp.numerics import ROUNDED, STATIONARY
from origami_nlp.paths.family import SAMPLES, Family, family_of
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import PatternProblem, pose
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
class Plane:
    """Scenes that differ from one in two parameters."""

    scene: Scene
    parameters: tuple[ParameterRange, ParameterRange]

    @cached_property
    def _like(self) -> PatternProblem:
        """Whose scale and numbers of contacts all problems of the plane take."""
        return pose(self.scene)

    def family(self, value: float, axis: int = 0, samples: int = SAMPLES) -> Family:
        """Return the scenes over the first parameter (axis 0) or the second at one value of the other."""
        along, other = self.parameters[axis], self.parameters[1 - axis]
        made = family_of(self.scene, along, other, at=[value])
        return replace(made, like=self._like, samples=samples)


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


Followed = tuple[Sequence[EventPoint], tuple[str, str]]


@dataclass(eq=False)
class EventTracer:
    """One kind of event in a plane, as a curve to trace (`tracer.CurveProblem`).

    hold: without the contact that closes; None where equilibria pass the flat state.  contact: None for a fold.
    states: variables of a state.  axis: the parameter over which events are looked for at values of the other one.
    """

    plane: Plane
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
        family = self.plane.family(self.plane.parameters[other].at_share(share[other]), axis, 2)
        # steps count shares of the range
        over, length = family.parameter, float(np.ptp(family.parameter.ends))
        near = over.s_of(over.at_share(share[axis]))
        line: Any = replace(family.line, weight=1.0 / length)
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
            found, kkt, value = there, there.system.residual, there.ahead
            if self.contact is not None:
                value = found.opening(self.contact)
        x = np.append(share, found.state)
        x[axis] = over.share_of(found.s)
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
        side = 1.0 if 0.0 <= (x + step)[:2].min() and (x + step)[:2].max() <= 1.0 else -1.0
        there = self.at((x + side * step)[:2], (x + side * step)[2:])
        if here is None or there is None:
            return None
        way = side * self.root * (there.x - here.x)
        length = float(np.linalg.norm(way))
        if not 0.0 < length < 10 * AHEAD:
            return None
        self.axis = int(np.abs(way[:2]).argmin())
        return replace(here, tangent=way / length)

    def follow(self, first: EventPoint, until: float) -> Followed:
        """Follow an event both ways through the plane; return its points in order, and why they end.

        until: when the time is over (`time.monotonic`).
        """

        def run(good: Callable[[EventPoint], bool]) -> Callable[[Sequence[EventPoint]], int]:
            return lambda points: sum(1 for _ in itertools.takewhile(good, points))

        inside = run(lambda p: 0.0 < p.x[:2].min() and p.x[:2].max() < 1.0)
        meets = End(run(lambda p: is_equilibrium(p.frame)), MEETS)
        ends = End(inside, "range", self._at_edge), meets

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
        p, q = a.x, b.x
        if 0.0 <= q[:2].min() and q[:2].max() <= 1.0:
            return b
        out = [k for k in (0, 1) if not 0 <= q[k] <= 1]
        shares = [(float(q[k] > 0) - p[k]) / (q[k] - p[k]) for k in out]
        k = out[int(np.argmin(shares))]
        at = p + min(shares) * (q - p)
        # on the edge to the last bit
        at[k], self.axis = round(at[k]), 1 - k
        return self.at(at[:2], at[2:])
