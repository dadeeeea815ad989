"""States of equilibrium over a parameter, as a curve: KKT systems with contacts held closed.

Unknowns are the state x [n], multipliers nu of closure and held contacts, and the parameter s of a line.  The curve
lives in (y, w s), y = root x: multipliers jump at contact events and can be huge, so lengths leave them out; they
follow from the state where closure and contacts are independent.

    F = (grad U - C' nu, closure, openings) = 0,      dF = [H -C' F_s; C 0 c_s] (dy, dnu, ds)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from origami_nlp.kkt import Classification, State, classify
from origami_nlp.numerics import CURVED, DEPENDENT, ROUNDED, SAME, SETTLED, STATIONARY, null_space
from origami_nlp.path.line import ParameterLine
from origami_nlp.path.tracer import ASIDE
from origami_nlp.programme import Contact, Programme

NEWTON = 10
"""Steps of the corrector: from a predicted point it needs two to four."""
ASLANT = 10.0
"""One over the cosine between a curve and where it went before: up to here one factorisation gives a step across it."""
LONGEST = 0.5
"""A Newton step longer than this has left the neighbourhood of the predicted point."""


@dataclass(frozen=True)
class Hold:
    """Which equations are kept: contacts held closed, and rows of closure (all, where they are independent)."""

    contacts: tuple[Contact, ...]
    closure: tuple[int, ...]


@dataclass
class Tally:
    """What following cost: steps accepted, and evaluations of the KKT system."""

    steps: int = 0
    evaluations: int = 0


class System:
    """The KKT system of a point (x, s) with contacts held, its matrix and null vector, in the metric."""

    def __init__(self, line: ParameterLine, point: np.ndarray, hold: Hold) -> None:
        x, s = point[:-1], float(point[-1])
        self.line, self.hold, self.x = line, hold, x
        self.programme: Programme = line.at(s)
        p = self.programme
        root, local = p.root, p.local(x)
        rows = slice(None) if len(hold.closure) == p.equation_count else list(hold.closure)
        closure, jacobian = local.closure[rows], local.closure_jacobian[rows] / root
        self.values, self.jacobian = closure, jacobian
        if hold.contacts:
            values, slopes = local.openings(hold.contacts)
            self.jacobian = np.concatenate([jacobian, slopes / root])
            self.values = np.concatenate([closure, values])
        gradient = local.gradient / root
        self.size = 1.0 + float(np.abs(gradient).max())
        self.multipliers = np.linalg.lstsq(self.jacobian.T, gradient, rcond=DEPENDENT)[0]
        m, kept = p.equation_count, len(closure)
        full = self.multipliers
        if kept < m:
            full = np.zeros(m + len(hold.contacts))
            full[:m][rows], full[m:] = self.multipliers[:kept], self.multipliers[kept:]
        self.all_multipliers = full
        self.hessian = p.lagrangian_hessian(x, full, hold.contacts) / (root[:, None] * root)
        torque, moved = p.drift(x, full, hold.contacts, line.slope(s))
        self.drift = torque / root / line.weight
        moved = moved if kept == m else np.concatenate([moved[:m][rows], moved[m:]])
        self.moved = moved / line.weight
        self.imbalance = gradient - self.jacobian.T @ self.multipliers

    @cached_property
    def seen(self) -> State:
        """Its state as it is judged: what is asked of it twice is computed once."""
        return State(self.programme, self.x)

    @cached_property
    def judged(self) -> Classification:
        """What `kkt.classify` says of it."""
        return classify(self.seen)

    @property
    def residual(self) -> float:
        """Largest entry of the KKT system, torques relative to the largest."""
        balance = float(np.abs(self.imbalance).max(initial=0.0)) / self.size
        return max(balance, float(np.abs(self.values).max(initial=0.0)))

    @property
    def least(self) -> float:
        """Smallest singular value of closure and contacts."""
        return float(np.linalg.svd(self.jacobian, compute_uv=False).min(initial=1.0))

    @cached_property
    def matrix(self) -> np.ndarray:
        """Derivative of the system by (y, nu, w s), shape [n + k, n + k + 1]."""
        k, n = self.jacobian.shape
        out = np.zeros((n + k, n + k + 1))
        out[:n, :n], out[:n, n:-1], out[:n, -1] = self.hessian, -self.jacobian.T, self.drift
        out[n:, :n], out[n:, -1] = self.jacobian, self.moved
        return out

    @cached_property
    def null(self) -> np.ndarray | None:
        """Vector (dy, dnu, w ds) along the curve, of length 1 in (dy, w ds); None where it is not unique."""
        _, values, vt = np.linalg.svd(self.matrix)
        if values[-1] <= CURVED * values[0]:
            return None
        n = len(self.imbalance)
        v = vt[-1]
        size = float(np.hypot(np.linalg.norm(v[:n]), v[-1]))
        return v / size if size > SETTLED * np.linalg.norm(v) else None

    def shortest_step(self, along: np.ndarray) -> np.ndarray | None:
        """Return the shortest Newton's step in (x, s); None where the curve turns far from `along` [n + 1].

        It is the step under the row `null`, by one factorisation instead of singular values.
        """
        n = len(self.imbalance)
        whole = np.zeros((len(self.matrix) + 1,) * 2)
        whole[:-1], whole[-1, :n], whole[-1, -1] = self.matrix, along[:n], along[-1]
        right = np.zeros((len(whole), 2))
        right[:-1, 0], right[-1, 1] = -np.concatenate([self.imbalance, self.values]), 1.0
        try:
            d = np.linalg.solve(whole, right)
        except np.linalg.LinAlgError:
            return None
        step, v = np.vstack([d[:n], d[-1:]]).T  # a step across `along`, and one along the curve
        step = step - (step @ v) / (v @ v) * v
        if not (np.isfinite(step).all() and np.linalg.norm(v) <= ASLANT):
            return None
        return np.append(step[:n] / self.programme.root, step[-1] / self.line.weight)

    def step(self, row: np.ndarray, right: float, short: bool = False) -> np.ndarray | None:
        """Return Newton's step in (x, s) under one more equation, row . (dy, dnu, w ds) = right.

        short: the shortest one where the matrix is all but singular.
        """
        n = len(self.imbalance)
        whole = np.vstack([self.matrix, row])
        minus = -np.concatenate([self.imbalance, self.values, [-right]])
        try:
            # at a branching the matrix is singular: no step along the other branch
            if short:
                d = np.linalg.lstsq(whole, minus, rcond=DEPENDENT)[0]
            else:
                d = np.linalg.solve(whole, minus)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(d).all():
            return None
        return np.append(d[:n] / self.programme.root, d[-1] / self.line.weight)


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A point of the curve, see `tracer.Frame`.

    x: state and parameter, (x, s) [n + 1].  tangent: of length 1 in (y, w s), shape [n + 1].  system: of this point.
    turn: change of the tangent with the arclength as far as it is known from the point before.
    """

    x: np.ndarray
    tangent: np.ndarray
    system: System
    turn: np.ndarray | None = None

    @property
    def bend(self) -> np.ndarray:
        """For the predictor alone: a difference of tangents; zero at a first point."""
        return np.zeros(len(self.x)) if self.turn is None else self.turn

    @property
    def state(self) -> np.ndarray:
        """Variables of the programme, [n]."""
        return self.x[:-1]

    @property
    def s(self) -> float:
        """The parameter of the line."""
        return float(self.x[-1])

    @property
    def programme(self) -> Programme:
        """At this parameter."""
        return self.system.programme

    @property
    def hold(self) -> Hold:
        """The contacts held."""
        return self.system.hold

    @property
    def seen(self) -> State:
        """The state as it is judged."""
        seen = self.system.seen
        return seen if np.array_equal(seen.x, self.state) else State(self.programme, self.state)

    @property
    def judged(self) -> Classification:
        """What `kkt.classify` says of the state."""
        seen = self.seen
        return self.system.judged if seen is self.system.seen else classify(seen)

    @property
    def forces(self) -> np.ndarray:
        """Multipliers of the contacts held, scaled energy, positive where they push, [r]."""
        return self.system.multipliers[len(self.hold.closure) :]

    @cached_property
    def eigenvalues(self) -> np.ndarray:
        """Of the reduced Hessian, ascending, scaled energy."""
        z = null_space(self.system.jacobian)
        return np.linalg.eigvalsh(z.T @ self.system.hessian @ z)

    @property
    def index(self) -> int:
        """Number of directions in which the energy falls."""
        return int((self.eigenvalues < 0).sum())

    @property
    def ahead(self) -> float:
        """ds along the tangent, w times."""
        return float(self.tangent[-1])


Row = Callable[[np.ndarray, System], tuple[np.ndarray, float]]
"""One more equation at (x, s): its row over (dy, dnu, w ds), and what that shall be."""
BISECTIONS = 45
"""Of a step, down to rounding."""
Move = Callable[[np.ndarray, System], np.ndarray | None]
"""Newton's step at (x, s); None where there is none."""


@dataclass(frozen=True, eq=False)
class EquilibriumCurve:
    """Equilibria over a line of parameters with contacts held; see `tracer.Curve`.

    short: see `System.step`.  known: the last point that Newton reached, with its system.  given: the last frame.
    """

    line: ParameterLine
    hold: Hold
    tally: Tally
    short: bool = False
    known: list[tuple[np.ndarray, System]] = field(default_factory=list)
    given: list[Equilibrium] = field(default_factory=list)

    @cached_property
    def root(self) -> np.ndarray:
        """Metric of (x, s), [n + 1]."""
        return np.append(self.line.programme.root, self.line.weight)

    def system(self, point: np.ndarray) -> System:
        """Evaluate the KKT system at (x, s)."""
        self.tally.evaluations += 1
        return System(self.line, point, self.hold)

    def solve(self, point: np.ndarray, row: Row) -> tuple[np.ndarray, System] | None:
        """Solve the system with one more equation by Newton from (x, s); None if that fails."""
        return self._newton(point, lambda at, system: system.step(*row(at, system), self.short))

    def _newton(self, point: np.ndarray, move: Move) -> tuple[np.ndarray, System] | None:
        for _ in range(NEWTON):
            system = self.system(point)
            step = move(point, system)
            if step is None:
                return None
            length = float(np.linalg.norm(self.root * step))
            if length > LONGEST:
                return None
            if length <= ROUNDED:
                break
            point = point + step
            if length <= SAME:  # its square is rounding
                system = self.system(point)
                break
        else:
            return None
        self.known[:] = [(point, system)]
        return (point, system) if system.residual <= STATIONARY else None

    def correct(self, x: np.ndarray) -> np.ndarray | None:
        """Move (x, s) [n + 1] onto the curve by steps across it."""

        def across(point: np.ndarray, system: System) -> tuple[np.ndarray, float]:
            v = system.null
            n = len(self.root) - 1
            return (np.zeros(system.matrix.shape[1]) if v is None else _flat(v, n)), 0.0

        def shortest(point: np.ndarray, system: System) -> np.ndarray | None:
            step = system.shortest_step(self.given[0].tangent) if self.given else None
            return system.step(*across(point, system)) if step is None else step

        found = self._newton(x, shortest)
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
                forward = (self.root * (frame.x - last.x)) @ frame.tangent
                return change / np.copysign(chord, forward)
        return None

    def frame_of(self, x: np.ndarray, system: System, along: np.ndarray) -> Equilibrium | None:
        """Return the frame of a point whose system is known."""
        if system.null is None:
            return None
        n = len(self.root) - 1
        tangent = np.append(system.null[:n], system.null[-1])
        across = float(tangent @ along)
        if across == 0.0:
            return None
        return Equilibrium(x, tangent * np.sign(across), system)

    def beside(self, frame: Equilibrium, h: float) -> Equilibrium | None:
        """Return the point of the curve whose step from `frame` has length h along its tangent."""
        if h == 0.0:
            return frame
        n = len(self.root) - 1
        row = np.zeros(n + len(frame.system.multipliers) + 1)
        row[:n], row[-1] = frame.tangent[:n], frame.tangent[-1]

        def plane(point: np.ndarray, system: System) -> tuple[np.ndarray, float]:
            return row, h - float(frame.tangent @ (self.root * (point - frame.x)))

        ahead = frame.x + h * frame.tangent / self.root
        found = self.solve(ahead, plane)
        if found is None or np.linalg.norm(self.root * (found[0] - ahead)) > ASIDE * abs(h) + SAME:
            return None
        return self.frame_of(*found, frame.tangent)

    def at(self, point: np.ndarray, s: float, along: np.ndarray) -> Equilibrium | None:
        """Return the point of the curve at the parameter s, by Newton from (x, s') nearby."""

        def fixed(point: np.ndarray, system: System) -> tuple[np.ndarray, float]:
            row = np.zeros(system.matrix.shape[1])
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
            low, high = (middle, high) if (frame.s < s) == (a.s < s) else (low, middle)
        at = frame.x.copy()
        at[-1] = s
        return replace(frame, x=at)

    def where_closed(
        self, frame: Equilibrium, contact: Contact, along: np.ndarray
    ) -> Equilibrium | None:
        """Return the point near `frame` where another contact closes."""

        def shut(point: np.ndarray, system: System) -> tuple[np.ndarray, float]:
            p = system.programme
            value, slope = p.local(point[:-1]).openings((contact,))
            none = np.zeros(p.equation_count + 1)
            moved = p.drift(point[:-1], none, (contact,), self.line.slope(float(point[-1])))[1][-1]
            row = np.zeros(system.matrix.shape[1])
            row[: len(p.root)] = slope[0] / p.root
            row[-1] = moved / self.line.weight
            return row, -float(value[0])

        found = self.solve(frame.x, shut)
        return None if found is None else self.frame_of(*found, along)


def _flat(v: np.ndarray, n: int) -> np.ndarray:
    """Return a null vector without its multipliers, as a row."""
    out = np.zeros_like(v)
    out[:n], out[-1] = v[:n], v[-1]
    return out
