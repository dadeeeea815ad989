"""Events between two points of a curve of equilibria, each located in its own function.

fold            limit point: ds/dl = 0 along the curve, the parameter turns back
branching       branch point (bifurcation): an eigenvalue of the reduced Hessian is zero, the parameter does not turn
leaves          the Lagrange multiplier of a held contact is zero: an active constraint becomes inactive
closes          the opening of another contact is zero: a constraint becomes active
breaks-symmetry the smallest eigenvalue across the symmetry, in the space without it, is zero
slides          features of a held contact come to a border, where their gap no longer keeps facets apart: they slip off
                each other there, or the curve ends
touches         facets come to touch where no single gap keeps them apart: the curve ends

These, and `singular` (closure or contacts lose rank), are the generic ways in which a one-parameter family of
parametric problems changes (Jongen, Jonker and Twilt 1986: types 2 to 5); where a contact event turns the parameter
back, a minimum meets a saddle there without any eigenvalue that shows it: `nonsmooth-fold`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.continuation.branch_point import refined
from origami_nlp.continuation.equilibrium import Equilibrium, EquilibriumCurve
from origami_nlp.continuation.flat import AT_FLAT, FlatRoot, beside_flat, flat_event
from origami_nlp.continuation.one_sided_branches import is_equilibrium
from origami_nlp.numerics import CONTACT_TOL, EPS, NEARLY, SETTLED, STATIONARY, bracketed_roots
from origami_nlp.problem import Contact

BISECTIONS = 24
"""Of a step towards a singular state."""
POLE = 1e-4
"""An eigenvalue passes infinity where its inverse is no larger: nearer to it Newton loses its digits."""
Value = Callable[[Equilibrium], float]
Functions = Sequence[tuple[str, Value]]
"""By the type of event that a change of their sign is."""


@dataclass(frozen=True, eq=False)
class LocatedEvent:
    """An event on a curve.

    type: as in the module, or ``range`` (the end of what is followed), or ``refused``.  frame: where, on the curve that
    comes there.  contact: that closes or leaves.  value: of its own function there.  located: whether value and KKT
    residual are rounding.  why: in words, where it is not.  beyond: a point on the other side of a singular state.
    residual: of the event, if not of the frame.  between: values of s, where that is all.
    """

    type: str
    frame: Equilibrium
    contact: Contact | None = None
    value: float = np.nan
    located: bool = False
    why: str = ""
    beyond: Equilibrium | None = None
    residual: float | None = None
    between: tuple[float, float] | None = None


class CurveStep(NamedTuple):
    """A step of a curve of equilibria, from a to b."""

    curve: EquilibriumCurve
    a: Equilibrium
    b: Equilibrium

    @property
    def length(self) -> float:
        """Along the tangent at a."""
        return self.to(self.b)

    def to(self, frame: Equilibrium) -> float:
        """Return the length from a to another point, along the tangent at a."""
        return self.curve.along(self.a, frame.x)

    def root(self, value: Value) -> Equilibrium | None:
        """Return the point at which a function changes sign, by regula falsi in the arclength."""
        rounding = EPS * max(1.0, abs(value(self.a)), abs(value(self.b)))
        known: dict[float, Equilibrium | None] = {0.0: self.a, self.length: self.b}

        def at(h: np.ndarray) -> np.ndarray:
            if (t := float(h[0])) not in known:
                near = min((k for k, f in known.items() if f), key=lambda k: abs(k - t))
                known[t] = self.curve.beside(self.a, t, known[near])
            v = np.nan if (frame := known[t]) is None else value(frame)
            return np.array([0.0 if abs(v) <= rounding else v])

        return known.get(float(bracketed_roots(at, [0.0], [self.length])[0]))

    def zero(self, value: Value) -> Equilibrium | None:
        """Return the point at which it does so through zero, and not through infinity."""
        frame, most = self.root(value), max(abs(value(self.a)), abs(value(self.b)))
        return None if frame is None or abs(value(frame)) > SETTLED * most else frame

    def last(self, good: Callable[[Equilibrium], bool], shortest: float) -> Equilibrium:
        """Return the last point that is good, by bisection."""
        low, high, last = 0.0, self.length, self.a
        while high - low > shortest:
            middle = 0.5 * (low + high)
            frame = self.curve.beside(self.a, middle)
            if frame is not None and good(frame):
                low, last = middle, frame
            else:
                high = middle
        return last


def found_at(type: str, frame: Equilibrium, value: float, contact: Any = None) -> LocatedEvent:
    """Return an event, located where its function and the KKT system vanish."""
    if type == "branching" and abs(value) > SETTLED:
        # a pole, no zero: beside a state where closure loses rank multipliers and curvatures grow without bound
        why = f"an eigenvalue changes its sign by a jump, from {value:.1e}"
        return LocatedEvent("singular", frame, contact, value, False, why)
    located = abs(value) <= STATIONARY and frame.system.residual <= STATIONARY
    why = "" if located else f"its function is {value:.1e} there"
    return LocatedEvent(type, frame, contact, value, located, why)


def _towards(step: CurveStep, value: Value) -> Equilibrium | None:
    """Return the last point before a zero in a step that Newton reaches; None where it reaches none."""
    low, high = 0.0, step.length
    first, last = value(step.a), value(step.b)
    best: Equilibrium | None = None
    share = 1.0  # of the way to where the line through both values is zero: Newton may fail there
    for _ in range(BISECTIONS):
        frame = step.curve.beside(step.a, low - share * first * (high - low) / (last - first))
        if frame is None:
            share *= 0.9
            continue
        v = value(frame)
        # regula falsi from the side of a; `pole` hands over 1 / value, which is zero where the value is infinite
        if (v > 0) != (first > 0):
            high, last = step.to(frame), v
            continue
        low, first, best = step.to(frame), v, frame
        if abs(v) <= POLE:
            break
    return best


def folds_and_branchings(step: CurveStep, others: Functions) -> list[LocatedEvent]:
    """Return limit points and branch points inside a step, along which the active constraints stay the same, in order.

    others: further functions, by the type of event that a change of their sign is.
    """
    out, (curve, a, b) = list[LocatedEvent](), step
    # limit point (fold): ds/dl changes sign; at a simple one a single eigenvalue passes zero with it
    turns = a.ahead * b.ahead < 0
    if turns:
        # where closure loses rank the tangent flips: its sign alone is no limit point
        if (a.index - b.index) % 2:
            if (frame := step.zero(lambda f: f.ahead)) is not None:
                out.append(found_at("fold", frame, frame.ahead))
        # a pitchfork, passed along the branch that turns there
        elif (frame := step.root(lambda f: f.ahead)) is not None:
            there = refined(curve, _between(frame, a, b))
            least = float(min(there.eigenvalues, key=abs, default=np.nan))
            kept = there.system is frame.system
            out.append(found_at("branching", there, frame.ahead if kept else least))
    crossing = range(min(a.index, b.index), max(a.index, b.index))
    # an odd number of eigenvalues passes zero where the parameter turns: the fold's own, and pairs beside it
    for k in crossing if not turns else crossing[1:]:
        out.append(_eigenvalue_passes(step, k))
    for type, value in others:
        if value(a) * value(b) < 0:
            if (frame := step.zero(value)) is not None:
                out.append(found_at(type, frame, value(frame)))
            elif not any(e.type == "singular" for e in out):
                out.append(pole(step, value))
    return out


def pole(step: CurveStep, value: Value) -> LocatedEvent:
    """Return the singular state at which a function passes infinity, as the nearest point that Newton reaches."""
    curve, a, b = step
    frame = _towards(step, lambda f: 1.0 / value(f)) or a
    if (event := _contacts_become_one(step, frame)) is not None:
        return event
    other_way = CurveStep(curve, replace(b, tangent=-b.tangent), a)
    back = _towards(other_way, lambda f: 1.0 / value(f)) or b
    between = min(frame.s, back.s), max(frame.s, back.s)
    least = frame.system.least
    rank = f"closure and contacts lose rank (smallest singular value {least:.1e} near by)"
    why = f"{rank} and multipliers grow without bound: both sides are followed, each by itself"
    return LocatedEvent("singular", frame, None, least, False, why, b, between=between)


def multipliers_pass_infinity(step: CurveStep) -> LocatedEvent | None:
    """Return the last state before one at which closure loses rank, and multipliers pass infinity; None if they do not.

    Ways cross there, at the flat state for one: closure does not balance what pulls along another of them, and the
    curve on the other side is not where the state must go.
    """
    # nu = eta w / h + ... beside a state where closure loses rank: it changes sign with h
    first, beyond = (f.system.shortest_multipliers for f in step[1:])
    if float(first @ beyond) >= 0:
        return None
    grown = [np.inf]

    def before(f: Equilibrium) -> bool:
        nu = f.system.shortest_multipliers
        grown[0] = float(np.abs(nu).max())
        return float(first @ nu) > 0

    last = step.last(before, 0.5**BISECTIONS * step.length)
    if grown[0] <= max(float(np.abs(nu).max()) for nu in (first, beyond)):
        return None  # they pass zero
    flat = float(np.abs(last.state).max()) < NEARLY
    where = "the flat state" if flat else "creases are aligned"
    why = f"{where}: closure loses rank, ways cross, and the load pulls along another one"
    return LocatedEvent("singular", last, why=why)


Crossed = tuple[list[Equilibrium], LocatedEvent]


def flat_crossed(curve: EquilibriumCurve, root: FlatRoot, a: Equilibrium) -> Crossed:
    """Return a point on the way from a to the flat state that the curve `passes` at a root, and this event.

    The point between shows what lies there: at the flat state itself the reduced Hessian says nothing.
    """
    frame, value = flat_event(curve.line, root[0])
    frame = replace(frame, tangent=a.tangent)
    beyond, before = beside_flat(curve.line, *root)
    length = float(np.linalg.norm(a.problem.root * a.state))
    if before is not None and np.linalg.norm(before.problem.root * before.state) < 0.9 * length:
        between: Equilibrium | None = replace(before, tangent=-before.tangent)
    else:
        between = curve.beside(a, 0.5 * curve.along(a, frame.x))
    left = float(np.abs(frame.system.values).max())
    located = max(abs(value), left) <= STATIONARY
    event = LocatedEvent("singular", frame, None, value, located, AT_FLAT, beyond, left)
    return ([] if between is None else [between]), event


def _contacts_become_one(step: CurveStep, near: Equilibrium) -> LocatedEvent | None:
    """Return the event at which held contacts become dependent because facets no longer overlap; None where none is.

    There a state without one or more of them closes another; on the way to it only their sum is a force.
    """
    curve, a, b = step
    held, reach = curve.hold, 2 * curve.apart(b.x, a.x)
    # two contacts are let go first, then more; where one of them closes again the others must do so too
    for count in range(len(held) - 1):
        for rest in itertools.combinations(held, len(held) - 2 - count):
            for contact in (c for c in held if c not in rest):
                other = replace(curve, hold=rest, known=[], given=[])
                there = other.where_closed(near, contact, near.tangent)
                if there is None or curve.apart(there.x, a.x) > reach:
                    continue
                openings = there.problem.local(there.state).openings(held)[0]
                if np.abs(openings).max() > CONTACT_TOL or not is_equilibrium(there):
                    continue
                value = float(openings[held.index(contact)])
                frame = Equilibrium(there.x, near.tangent, curve.system(there.x))
                return found_at("leaves", frame, value, contact)
    return None


def _between(frame: Equilibrium, a: Equilibrium, b: Equilibrium) -> Equilibrium:
    """Return a branching with the tangent of its neighbours: there the system has two null vectors."""
    along = a.tangent + b.tangent
    return Equilibrium(frame.x, along / np.linalg.norm(along), frame.system)


def _eigenvalue_passes(step: CurveStep, k: int) -> LocatedEvent:
    """Return the event at which eigenvalue k of the reduced Hessian changes sign: through zero, or through infinity."""

    def eigenvalue(f: Equilibrium) -> float:
        return float(f.eigenvalues[k]) if k < len(f.eigenvalues) else np.nan

    # next to a branch point the bordered matrix is all but singular
    if (frame := step.zero(eigenvalue)) is not None:
        there = refined(step.curve, _between(frame, step.a, step.b))
        return found_at("branching", there, eigenvalue(there))
    # one side has it as the largest, the other as the smallest
    fewer = min(step.a.index, step.b.index)
    return pole(step, lambda f: float(f.eigenvalues[-1 if f.index == fewer else 0]))


def change_of_verdict(step: CurveStep, verdict: str) -> LocatedEvent:
    """Bisect on the verdict of states that no multiplier judges."""
    other = step.b.judged.verdict
    good = step.last(lambda f: f.judged.verdict == verdict, STATIONARY)
    why = f"{verdict} before, {other} beyond: by bisection on the verdict"
    ends = verdict == "minimum" and other in ("saddle", "not stationary")
    return LocatedEvent("branching" if ends else "singular", good, why=why)
