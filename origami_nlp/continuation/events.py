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

import numpy as np

from origami_nlp.continuation.branch_point import refined
from origami_nlp.continuation.equilibrium import Equilibrium, EquilibriumCurve
from origami_nlp.continuation.flat import AT_FLAT, crossing
from origami_nlp.continuation.one_sided_branches import is_equilibrium, judged
from origami_nlp.numerics import CONTACT_TOL, EPS, NEARLY, SETTLED, STATIONARY, bracketed_roots
from origami_nlp.problem import Contact

BISECTIONS = 24
"""Of a step towards a singular state."""
POLE = 1e-4
"""An eigenvalue passes infinity where its inverse is no larger: nearer to it Newton loses its digits."""
Value = Callable[[Equilibrium], float]


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
    contact: Contact | None
    value: float
    located: bool
    why: str = ""
    beyond: Equilibrium | None = None
    residual: float | None = None
    between: tuple[float, float] | None = None


def found_at(
    type: str, frame: Equilibrium, value: float, contact: Contact | None = None, why: str = ""
) -> LocatedEvent:
    """Return an event, located where its function and the KKT system vanish."""
    if type == "branching" and abs(value) > SETTLED:
        # a pole, no zero: beside a state where closure loses rank multipliers and curvatures grow without bound
        why = f"an eigenvalue changes its sign by a jump, from {value:.1e}"
        return LocatedEvent("singular", frame, contact, value, False, why)
    located = abs(value) <= STATIONARY and frame.system.residual <= STATIONARY
    why = why if located or why else f"its function is {value:.1e} there"
    return LocatedEvent(type, frame, contact, value, located, why)


def step_length(a: Equilibrium, b: Equilibrium, root: np.ndarray) -> float:
    """Return the length of the step from a to b along the tangent at a."""
    return float(a.tangent @ (root * (b.x - a.x)))


def root_between(
    curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, value: Value
) -> Equilibrium | None:
    """Return the point between a and b at which a function changes sign, by regula falsi in the arclength."""
    length = step_length(a, b, curve.root)
    rounding = EPS * max(1.0, abs(value(a)), abs(value(b)))
    known: dict[float, Equilibrium | None] = {0.0: a, length: b}

    def at(h: np.ndarray) -> np.ndarray:
        frame = known.get(float(h[0]))
        if float(h[0]) not in known:
            near = min((k for k, f in known.items() if f), key=lambda k: abs(k - float(h[0])))
            frame = known[float(h[0])] = curve.beside(a, float(h[0]), known[near])
        v = np.nan if frame is None else value(frame)
        return np.array([0.0 if abs(v) <= rounding else v])

    return known.get(float(bracketed_roots(at, [0.0], [length])[0]))


def _towards(
    curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, value: Value
) -> Equilibrium | None:
    """Return the last point before a zero between a and b that Newton reaches; None where it reaches none."""
    low, high = 0.0, step_length(a, b, curve.root)
    first, last = value(a), value(b)
    best: Equilibrium | None = None
    share = 1.0  # of the way to where the line through both values is zero: Newton may fail there
    for _ in range(BISECTIONS):
        frame = curve.beside(a, low - share * first * (high - low) / (last - first))
        if frame is None:
            share *= 0.9
            continue
        v = value(frame)
        # regula falsi from the side of a; `pole` hands over 1 / value, which is zero where the value is infinite
        if (v > 0) != (first > 0):
            high, last = step_length(a, frame, curve.root), v
            continue
        low, first, best = step_length(a, frame, curve.root), v, frame
        if abs(v) <= POLE:
            break
    return best


def folds_and_branchings(
    curve: EquilibriumCurve,
    a: Equilibrium,
    b: Equilibrium,
    others: Sequence[tuple[str, Value]] = (),
) -> list[LocatedEvent]:
    """Return limit points and branch points inside a step, along which the active constraints stay the same, in order.

    others: further functions, by the type of event that a change of their sign is.
    """
    out: list[LocatedEvent] = []
    # limit point (fold): ds/dl changes sign; at a simple one a single eigenvalue passes zero with it
    turns = a.ahead * b.ahead < 0
    if turns:
        frame = root_between(curve, a, b, lambda f: f.ahead)
        # where closure loses rank the tangent flips: its sign alone is no limit point
        if frame is not None and (a.index - b.index) % 2:
            if is_zero(lambda f: f.ahead, frame, a, b):
                out.append(found_at("fold", frame, frame.ahead))
        elif frame is not None:  # a pitchfork, passed along the branch that turns there
            there = refined(curve, _between(frame, a, b))
            least = frame.ahead if there.system is frame.system else _smallest(there)
            out.append(found_at("branching", there, least))
    crossing = range(min(a.index, b.index), max(a.index, b.index))
    # an odd number of eigenvalues passes zero where the parameter turns: the fold's own, and pairs beside it
    for k in crossing if not turns else crossing[1:]:
        out.append(_eigenvalue_passes(curve, a, b, k))
    for type, value in others:
        if value(a) * value(b) < 0:
            frame = root_between(curve, a, b, value)
            if frame is not None and is_zero(value, frame, a, b):
                out.append(found_at(type, frame, value(frame)))
            elif not any(e.type == "singular" for e in out):
                out.append(pole(curve, a, b, value))
    return sorted(out, key=lambda e: step_length(a, e.frame, curve.root))


def is_zero(value: Value, frame: Equilibrium, a: Equilibrium, b: Equilibrium) -> bool:
    """Return whether a function that changes sign between a and b does so through zero, and not through infinity."""
    return abs(value(frame)) <= SETTLED * max(abs(value(a)), abs(value(b)))


def pole(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, value: Value) -> LocatedEvent:
    """Return the singular state at which a function passes infinity, as the nearest point that Newton reaches."""
    frame = _towards(curve, a, b, lambda f: 1.0 / value(f)) or a
    event = _contacts_become_one(curve, a, b, frame)
    if event is not None:
        return event
    back = _towards(curve, replace(b, tangent=-b.tangent), a, lambda f: 1.0 / value(f)) or b
    between = min(frame.s, back.s), max(frame.s, back.s)
    why = (
        f"closure and contacts lose rank (smallest singular value {frame.system.least:.1e} at the nearest point) and "
        "multipliers grow without bound: the equilibria on both sides are followed, each by itself"
    )
    least = frame.system.least
    return LocatedEvent("singular", frame, None, least, False, why, b, between=between)


def multipliers_pass_infinity(
    curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium
) -> LocatedEvent | None:
    """Return the last state before one at which closure loses rank, and multipliers pass infinity; None if they do not.

    Ways cross there, at the flat state for one: closure does not balance what pulls along another of them, and the
    curve on the other side is not where the state must go.
    """
    # nu = eta w / h + ... beside a state where closure loses rank: it changes sign with h
    first, beyond = (f.system.shortest_multipliers for f in (a, b))
    if float(first @ beyond) >= 0:
        return None
    low, high, last, grown = 0.0, step_length(a, b, curve.root), a, np.inf
    for _ in range(BISECTIONS):
        here = curve.beside(a, 0.5 * (low + high))
        there = None if here is None else here.system.shortest_multipliers
        if there is not None:
            grown = float(np.abs(there).max())
        if here is None or there is None or float(first @ there) <= 0:
            high = 0.5 * (low + high)
        else:
            low, last = 0.5 * (low + high), here
    if grown <= max(float(np.abs(nu).max()) for nu in (first, beyond)):
        return None  # they pass zero
    flat = float(np.abs(last.state).max()) < NEARLY
    where = "the flat state" if flat else "creases are aligned"
    why = f"{where}: closure loses rank, ways cross, and the load pulls along another one"
    return LocatedEvent("singular", last, None, np.nan, False, why)


def flat_crossed(
    curve: EquilibriumCurve, root: tuple[float, np.ndarray], a: Equilibrium
) -> tuple[list[Equilibrium], LocatedEvent]:
    """Return a point on the way from a to the flat state that the curve passes at a root, and this event."""
    between, frame, value, beyond = crossing(curve, root, a)
    residual = float(np.abs(frame.system.values).max())
    located = max(abs(value), residual) <= STATIONARY
    return between, LocatedEvent(
        "singular", frame, None, value, located, AT_FLAT, beyond, residual=residual
    )


def _contacts_become_one(
    curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, near: Equilibrium
) -> LocatedEvent | None:
    """Return the event at which held contacts become dependent because facets no longer overlap; None where none is.

    There a state without one or more of them closes another; on the way to it only their sum is a force.
    """
    held = curve.hold
    reach = 2 * float(np.linalg.norm(curve.root * (b.x - a.x)))
    # two contacts are let go first, then more; where one of them closes again the others must do so too
    for count in range(len(held) - 1):
        for rest in itertools.combinations(held, len(held) - 2 - count):
            for contact in (c for c in held if c not in rest):
                other = replace(curve, hold=rest, known=[], given=[])
                there = other.where_closed(near, contact, near.tangent)
                if there is None or np.linalg.norm(curve.root * (there.x - a.x)) > reach:
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


def _smallest(frame: Equilibrium) -> float:
    """Return the eigenvalue of the reduced Hessian that is nearest to zero."""
    return float(min(frame.eigenvalues, key=abs, default=np.nan))


def _eigenvalue_passes(
    curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, k: int
) -> LocatedEvent:
    """Return the event at which eigenvalue k of the reduced Hessian changes sign: through zero, or through infinity."""

    def eigenvalue(f: Equilibrium) -> float:
        return float(f.eigenvalues[k]) if k < len(f.eigenvalues) else np.nan

    # next to a branch point the bordered matrix is all but singular
    frame = root_between(curve, a, b, eigenvalue)
    if frame is not None and is_zero(eigenvalue, frame, a, b):
        there = refined(curve, _between(frame, a, b))
        return found_at("branching", there, eigenvalue(there))
    fewer = min(a.index, b.index)  # one side has it as the largest, the other as the smallest
    return pole(curve, a, b, lambda f: float(f.eigenvalues[-1 if f.index == fewer else 0]))


def change_of_verdict(
    curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, verdict: str
) -> LocatedEvent:
    """Bisect on the verdict of states that no multiplier judges."""
    root = curve.root
    low, high, good, other = 0.0, float(a.tangent @ (root * (b.x - a.x))), a, judged(b)
    while high - low > STATIONARY:
        middle = 0.5 * (low + high)
        frame = curve.beside(a, middle)
        if frame is not None and judged(frame) == verdict:
            low, good = middle, frame
        else:
            high = middle
    why = f"{verdict} before, {other} beyond: by bisection on the verdict"
    ends = verdict == "minimum" and other in ("saddle", "not stationary")
    return LocatedEvent("branching" if ends else "singular", good, None, np.nan, False, why)
