"""States of equilibrium over a parameter, as a curve: KKT systems with contacts held closed.

The curve lives in (y, w s), y = root x: multipliers jump at contact events and can be huge, so lengths leave them
out; they follow from the state, see `system`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from origami_nlp.continuation.line import Line
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
    def ahead(self) -> float:
        """ds along the tangent, w times."""
        return float(self.tangent[-1])


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

    def system(
        self,
        point: np.ndarray,
        multipliers: np.ndarray | None = None,
        span: np.ndarray | None = None,
    ) -> BorderedSystem:
        """Evaluate the KKT system at (x, s)."""
        return BorderedSystem(self.line, point, self.hold, multipliers, span)

    def solve(self, point: np.ndarray, row: Row) -> tuple[np.ndarray, BorderedSystem] | None:
        """Solve the system with one more equation by Newton from (x, s); None if that fails."""
        # rows that are independent at the last frame; all of them where closure gains rank since
        spans = [*(frame.system.range for frame in self.given), None]
        return next(filter(None, (self._newton(point, row, span) for span in spans)), None)

    def _newton(
        self, point: np.ndarray, row: Row, span: np.ndarray | None
    ) -> tuple[np.ndarray, BorderedSystem] | None:
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
        frame = self.frame_of(x, known[0] if known else self.system(x), along)
        if frame is not None:
            frame = replace(frame, turn=self._turn(frame))
            self.given[:] = [frame]
        return frame

    def _turn(self, frame: Equilibrium) -> np.ndarray | None:
        """Return the change of the tangent since the last frame; None where that is far, or the same point."""
        for last in self.given:
            chord = float(np.linalg.norm(self.root * (frame.x - last.x)))
            change = frame.tangent - last.tangent
            if STATIONARY < chord <= LONGEST and np.linalg.norm(change) <= LONGEST:
                # arclength counts along this tangent: backwards where the last frame lies ahead
                forward = (self.root * (frame.x - last.x)) @ frame.tangent
                return change / np.copysign(chord, forward)
        return None

    def frame_of(
        self, x: np.ndarray, system: BorderedSystem, along: np.ndarray
    ) -> Equilibrium | None:
        """Return the frame of a point whose system is known."""
        found = system.direction(along)
        return None if found is None else Equilibrium(x, found[0], system)

    def beside(
        self, frame: Equilibrium, h: float, near: Equilibrium | None = None
    ) -> Equilibrium | None:
        """Return the point of the curve whose step from `frame` has length h along its tangent, by Newton.

        near: a point known near by.
        """
        if h == 0.0:
            return frame

        def plane(point: np.ndarray, system: BorderedSystem) -> tuple[np.ndarray, float]:
            # pseudo-arclength (Keller): t . (y - y0) = h, a plane across the tangent
            return frame.tangent, h - float(frame.tangent @ (self.root * (point - frame.x)))

        near = near or frame
        left = h - float(frame.tangent @ (self.root * (near.x - frame.x)))
        ahead = near.x + left / float(frame.tangent @ near.tangent) * near.tangent / self.root
        found = self.solve(ahead, plane)
        if (
            found is None
            or np.linalg.norm(self.root * (found[0] - ahead)) > ASIDE * abs(h) + DUPLICATE_TOL
        ):
            return None
        return self.frame_of(*found, frame.tangent)

    def at(self, point: np.ndarray, s: float, along: np.ndarray) -> Equilibrium | None:
        """Return the point of the curve at the parameter s, by Newton from (x, s') nearby."""

        def fixed(point: np.ndarray, system: BorderedSystem) -> tuple[np.ndarray, float]:
            # natural parameter: Newton at fixed s, which fails next to limit points
            row = np.zeros(len(self.root))
            row[-1] = 1.0
            return row, (s - point[-1]) * self.line.weight

        found = self.solve(np.append(point[:-1], s), fixed)
        if found is None:
            return None
        at = found[0].copy()
        at[-1] = s
        return self.frame_of(at, found[1], along)

    def between(self, a: Equilibrium, b: Equilibrium, s: float) -> Equilibrium | None:
        """Return the point at the parameter s between two frames, found along the length from a.

        Next to a fold Newton at s (`at`) may fail, or take the point on the other side of it.
        """
        low, high = 0.0, float(a.tangent @ (self.root * (b.x - a.x)))
        frame = a
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            found = self.beside(a, middle)
            if found is None:
                return None
            frame = found
            # bisection in the length from a: on this side of a fold s is a monotonic function of it
            low, high = (middle, high) if (frame.s < s) == (a.s < s) else (low, middle)
        at = frame.x.copy()
        at[-1] = s
        return replace(frame, x=at)

    def where_closed(
        self, frame: Equilibrium, contact: Contact, along: np.ndarray
    ) -> Equilibrium | None:
        """Return the point near `frame` where another contact closes."""

        def at_limit(point: np.ndarray, system: BorderedSystem) -> tuple[np.ndarray, float]:
            p = system.problem
            value, slope = p.local(point[:-1]).openings((contact,))
            none = np.zeros(p.equation_count + 1)
            moved = self.line.drift(p, float(point[-1]), point[:-1], none, (contact,))[1][-1]
            # opening(x, s) + slope . dx + d(opening)/ds ds = 0, as the row that fixes the point on the curve
            return np.append(slope[0] / p.root, moved / self.line.weight), -float(value[0])

        found = self.solve(frame.x, at_limit)
        return None if found is None else self.frame_of(*found, along)
