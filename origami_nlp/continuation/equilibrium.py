"""States of equilibrium over a parameter, as a curve: KKT systems with contacts held closed.

The curve lives in (y, w s), y = root x: multipliers jump at contact events and can be huge, so lengths leave them
out; they follow from the state, see `system`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.continuation.line import Line, Rates
from origami_nlp.continuation.system import BorderedSystem
from origami_nlp.continuation.tracer import ASIDE
from origami_nlp.kkt import Classification, State, classify
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, ROUNDED, STATIONARY
from origami_nlp.problem import Contact, Problem

NEWTON = 10
"""Steps of the corrector: from a predicted point it needs two to four."""
LONGEST = 0.5
"""A Newton step longer than this has left the neighbourhood of the predicted point."""


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A point of the curve, see `tracer.CurveFrame`.

    x: state and parameter, (x, s) [n + 1].  tangent: of length 1 in (y, w s), shape [n + 1].  system: of this point.
    turn: change of the tangent with the arclength as far as it is known from the point before.
    """

    x: np.ndarray
    tangent: np.ndarray
    system: BorderedSystem
    turn: np.ndarray | None = None

    @property
    def bend(self) -> np.ndarray:
        """For the predictor alone: a difference of tangents; zero at a first point."""
        return np.zeros(len(self.x)) if self.turn is None else self.turn

    @property
    def state(self) -> np.ndarray:
        """Variables of the problem, [n]."""
        return self.x[:-1]

    @property
    def s(self) -> float:
        """The parameter of the line."""
        return float(self.x[-1])

    @property
    def problem(self) -> Problem:
        """At this parameter."""
        return self.system.problem

    @property
    def hold(self) -> tuple[Contact, ...]:
        """The contacts held."""
        return self.system.hold

    @property
    def seen(self) -> State:
        """The state as it is judged."""
        seen = self.system.seen
        return seen if np.array_equal(seen.x, self.state) else State(self.problem, self.state)

    @property
    def judged(self) -> Classification:
        """What `kkt.classify` says of the state."""
        seen = self.seen
        return self.system.judged if seen is self.system.seen else classify(seen)

    @property
    def forces(self) -> np.ndarray:
        """Multipliers of the contacts held, scaled energy, positive where they push, [r]."""
        return self.system.multipliers[self.problem.equation_count :]

    @property
    def eigenvalues(self) -> np.ndarray:
        """Of the reduced Hessian, ascending, scaled energy."""
        return self.system.eigenvalues

    @property
    def index(self) -> int:
        """Number of directions in which the energy falls."""
        return int((self.eigenvalues < 0).sum())

    @property
    def fold_angles(self) -> tuple[float, ...]:
        """All N [rad]."""
        return tuple((self.problem.expand(self.state) + 0.0).tolist())

    def opening(self, contact: Contact) -> float:
        """Return the opening of a contact, held or not."""
        return float(self.problem.local(self.state).openings((contact,))[0][0])

    @property
    def ahead(self) -> float:
        """ds along the tangent, w times."""
        return float(self.tangent[-1])


Solved = tuple[np.ndarray, BorderedSystem]
Row = Callable[[np.ndarray, BorderedSystem], tuple[np.ndarray, float]]
"""One more equation at (x, s): its row over (dy, w ds), and what that shall be."""
BISECTIONS = 45
"""Of a step, down to rounding."""


@dataclass(frozen=True, eq=False)
class EquilibriumCurve:
    """Equilibria over a line of parameters with contacts held; see `tracer.CurveProblem`.

    known: the last point that Newton reached, with its system.  given: the last
    frame. corrector: steps of Newton at most.
    """

    line: Line
    hold: tuple[Contact, ...] = ()
    known: list[tuple[np.ndarray, BorderedSystem]] = field(default_factory=list)
    given: list[Equilibrium] = field(default_factory=list)
    corrector: int = NEWTON

    @cached_property
    def root(self) -> np.ndarray:
        """Metric of (x, s), [n + 1]."""
        return np.append(self.line.problem.root, self.line.weight)

    def along(self, a: Equilibrium, x: np.ndarray) -> float:
        """Return the length of the step from a to (x, s) along the tangent at a."""
        return float(a.tangent @ (self.root * (x - a.x)))

    def apart(self, x: np.ndarray, other: np.ndarray) -> float:
        """Return the distance of two points (x, s)."""
        return float(np.linalg.norm(self.root * (x - other)))

    def system(self, point: np.ndarray, *given: np.ndarray | None) -> BorderedSystem:
        """Evaluate the KKT system at (x, s); given: multipliers and span, see `BorderedSystem`."""
        return BorderedSystem(self.line, point, self.hold, *given)

    def solve(self, point: np.ndarray, row: Row) -> Solved | None:
        """Solve the system with one more equation by Newton from (x, s); None if that fails."""
        # rows that are independent at the last frame; all of them where closure gains rank since
        spans = [*(frame.system.range for frame in self.given), None]
        return next(filter(None, (self._newton(point, row, span) for span in spans)), None)

    def _newton(self, point: np.ndarray, row: Row, span: np.ndarray | None) -> Solved | None:
        carried: np.ndarray | None = None
        for _ in range(self.corrector):
            system = self.system(point, carried, span)
            step = system.step(*row(point, system))
            if step is None:
                return None
            length = float(np.linalg.norm(self.root * step))
            if length > self._longest:
                return None
            if length <= ROUNDED:
                break
            point, carried = point + step, system.after
            if length <= DUPLICATE_TOL:  # its square is rounding
                system = self.system(point, carried, span)
                if system.missing <= self._least:
                    break
        else:
            return None
        self.known[:] = [(point, system)]
        good = system.residual <= STATIONARY and system.missing <= max(self._least, CLOSURE_TOL)
        return (point, system) if good else None

    @cached_property
    def _longest(self) -> float:
        """Newton's longest step, as a root mean square over creases."""
        return LONGEST * float(np.sqrt(self.line.problem.size))

    @property
    def _least(self) -> float:
        """Closure and openings at which Newton has arrived; off closure a gap is one along a walk, its slope too."""
        return CLOSURE_TOL if all(c.is_limit for c in self.hold) else ROUNDED

    def correct(self, x: np.ndarray) -> np.ndarray | None:
        """Move (x, s) [n + 1] onto the curve by steps across it."""

        def across(point: np.ndarray, system: BorderedSystem) -> tuple[np.ndarray, float]:
            found = system.direction()
            return np.zeros(len(self.root)) if found is None else found[0], 0.0

        found = self.solve(x, across)
        return None if found is None else found[0]

    def frame(self, x: np.ndarray, along: np.ndarray) -> Equilibrium | None:
        """Return the point (x, s) with its tangent on the side of `along` [n + 1]; None where it has none."""
        known = [system for point, system in self.known if point is x]
        frame = self.frame_of((x, known[0] if known else self.system(x)), along)
        if frame is not None:
            frame = replace(frame, turn=self._turn(frame))
            self.given[:] = [frame]
        return frame

    def _turn(self, frame: Equilibrium) -> np.ndarray | None:
        """Return the change of the tangent since the last frame; None where that is far, or the same point."""
        for last in self.given:
            chord = self.apart(frame.x, last.x)
            change = frame.tangent - last.tangent
            if STATIONARY < chord <= LONGEST and np.linalg.norm(change) <= LONGEST:
                # arclength counts along this tangent: backwards where the last frame lies ahead
                return change / np.copysign(chord, -self.along(frame, last.x))
        return None

    def frame_of(self, solved: Solved | None, along: np.ndarray) -> Equilibrium | None:
        """Return the frame of a point whose system is known."""
        if solved is None or (found := solved[1].direction(along)) is None:
            return None
        return Equilibrium(solved[0], found[0], solved[1])

    def beside(self, a: Equilibrium, h: float, near: Any = None) -> Equilibrium | None:
        """Return the point of the curve whose step from a has length h along its tangent, by Newton.

        near: a point known near by.
        """
        if h == 0.0:
            return a
        near = near or a
        left = h - self.along(a, near.x)
        ahead = near.x + left / float(a.tangent @ near.tangent) * near.tangent / self.root
        # pseudo-arclength (Keller): t . (y - y0) = h, a plane across the tangent
        found = self.solve(ahead, lambda point, _: (a.tangent, h - self.along(a, point)))
        if found is None or self.apart(found[0], ahead) > ASIDE * abs(h) + DUPLICATE_TOL:
            return None
        return self.frame_of(found, a.tangent)

    def at(self, point: np.ndarray, s: float, along: np.ndarray) -> Equilibrium | None:
        """Return the point of the curve at the parameter s, by Newton from (x, s') nearby."""
        # natural parameter: Newton at fixed s, which fails next to limit points
        row, weight = np.append(np.zeros(len(point) - 1), 1.0), self.line.weight
        found = self.solve(np.append(point[:-1], s), lambda at, _: (row, (s - at[-1]) * weight))
        return found and self.frame_of((np.append(found[0][:-1], s), found[1]), along)

    def between(self, a: Equilibrium, b: Equilibrium, s: float) -> Equilibrium | None:
        """Return the point at the parameter s between two frames, found along the length from a.

        Next to a fold Newton at s (`at`) may fail, or take the point on the other side of it.
        """
        low, high, frame = 0.0, self.along(a, b.x), a
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            if (found := self.beside(a, middle)) is None:
                return None
            frame = found
            # bisection in the length from a: on this side of a fold s is a monotonic function of it
            low, high = (middle, high) if (frame.s < s) == (a.s < s) else (low, middle)
        return replace(frame, x=np.append(frame.state, s))

    def opening_rates(self, p: Problem, point: np.ndarray, contacts: Any) -> Rates:
        """Return openings at (x, s), and how they change with the state, in the metric, and with w s: [r, n + 1]."""
        none, s = np.zeros(p.equation_count + len(contacts)), float(point[-1])
        values, slopes = p.local(point[:-1]).openings(contacts)
        moved = self.line.drift(p, s, point[:-1], none, contacts)[1][p.equation_count :]
        return values, np.column_stack([slopes / p.root, moved / self.line.weight])

    def where_closed(self, near: Equilibrium, c: Contact, along: np.ndarray) -> Equilibrium | None:
        """Return the point near another where one more contact closes."""

        def at_limit(point: np.ndarray, system: BorderedSystem) -> tuple[np.ndarray, float]:
            # opening(x, s) + slope . dx + d(opening)/ds ds = 0, as the row that fixes the point on the curve
            values, rows = self.opening_rates(system.problem, point, (c,))
            return rows[0], -float(values[0])

        return self.frame_of(self.solve(near.x, at_limit), along)
