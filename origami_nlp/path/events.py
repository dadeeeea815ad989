"""Events between two points of a curve of equilibria, each located in its own function.

fold            ds/dl = 0 along the curve: the parameter turns back
branching       an eigenvalue of the reduced Hessian is zero, and the parameter does not turn
leaves          the multiplier of a held contact is zero
closes          the opening of another contact is zero
breaks-symmetry the smallest eigenvalue across the symmetry, in the space without it, is zero

These, and `singular` (closure or contacts lose rank), are the generic ways in which a one-parameter family of
programmes changes (Jongen, Jonker and Twilt 1986: types 2 to 5); where a contact event turns the parameter back,
a minimum meets a saddle there without any eigenvalue that tells: `nonsmooth-fold`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.kkt import State
from origami_nlp.numerics import (
    BESIDE,
    ENDS,
    NEAR_CONTACT,
    SETTLED,
    STATIONARY,
    TOUCHES,
    bracketed_roots,
    first_largest,
)
from origami_nlp.path.equilibrium import Equilibrium, EquilibriumCurve
from origami_nlp.path.flat import AT_FLAT, crossing, flat_passage
from origami_nlp.path.halves import PULLS, closes, is_equilibrium, opening_rates, touches
from origami_nlp.programme import Contact

BISECTIONS, SOON = 24, 7
"""Of a step in which a state is refused: what then closes is looked for by Newton.  After so many of them what nearly
touches is what will close."""
POLE = 1e-4
"""An eigenvalue passes infinity where its inverse is no larger: nearer to it Newton loses its digits."""
Value = Callable[[Equilibrium], float]
Forces = Callable[[Equilibrium], np.ndarray]


@dataclass(frozen=True, eq=False)
class Found:
    """An event on a curve.

    type: as in the module, or ``range`` (the end of what is followed), or ``refused``.  frame: where, on the curve that
    comes there.  contact: that closes or leaves.  value: of its own function there.  located: whether value and KKT
    residual are rounding.  why: in words, where it is not.  beyond: a point on the other side of a singular state.
    point, residual: of the event (x, s) where it is no frame, see `flat`.  between: values of s, where that is all.
    """

    type: str
    frame: Equilibrium
    contact: Contact | None
    value: float
    located: bool
    why: str = ""
    beyond: Equilibrium | None = None
    point: np.ndarray | None = None
    residual: float | None = None
    between: tuple[float, float] | None = None


def found_at(
    type: str, frame: Equilibrium, value: float, contact: Contact | None = None, why: str = ""
) -> Found:
    """Return an event, located where its function and the KKT system vanish."""
    located = abs(value) <= STATIONARY and frame.system.residual <= STATIONARY
    why = why if located or why else f"its function is {value:.1e} there"
    return Found(type, frame, contact, value, located, why)


def _step(a: Equilibrium, b: Equilibrium, root: np.ndarray) -> float:
    return float(a.tangent @ (root * (b.x - a.x)))


def root_between(
    curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, value: Value
) -> Equilibrium | None:
    """Return the point between a and b at which a function changes sign, by regula falsi in the arclength."""
    known: dict[float, Equilibrium | None] = {}

    def at(h: np.ndarray) -> np.ndarray:
        frame = known.setdefault(float(h[0]), curve.beside(a, float(h[0])))
        return np.array([np.nan if frame is None else value(frame)])

    h = float(bracketed_roots(at, [0.0], [_step(a, b, curve.root)])[0])
    return known.get(h)


def _towards(
    curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, value: Value
) -> Equilibrium | None:
    """Return the last point before a zero between a and b that Newton reaches; None where it reaches none."""
    low, high = 0.0, _step(a, b, curve.root)
    first, last = value(a), value(b)
    best: Equilibrium | None = None
    share = 1.0  # of the way to where the line through both values is zero: Newton may fail there
    for _ in range(BISECTIONS):
        frame = curve.beside(a, low - share * first * (high - low) / (last - first))
        if frame is None:
            share *= 0.9
            continue
        v = value(frame)
        if (v > 0) != (first > 0):
            high, last = _step(a, frame, curve.root), v
            continue
        low, first, best = _step(a, frame, curve.root), v, frame
        if abs(v) <= POLE:
            break
    return best


def folds_and_branchings(
    curve: EquilibriumCurve,
    a: Equilibrium,
    b: Equilibrium,
    others: Sequence[tuple[str, Value]] = (),
) -> list[Found]:
    """Return the events inside a step that leave the contacts as they are, in order.

    others: further functions, by the type of event that a change of their sign is.
    """
    out: list[Found] = []
    turns = a.ahead * b.ahead < 0
    if turns:
        frame = root_between(curve, a, b, lambda f: f.ahead)
        if frame is not None and (a.index - b.index) % 2:
            out.append(found_at("fold", frame, frame.ahead))
        elif frame is not None:  # a pitchfork, passed along the branch that turns there
            out.append(found_at("branching", _between(frame, a, b), frame.ahead))
    crossing = range(min(a.index, b.index), max(a.index, b.index))
    # an odd number of eigenvalues passes zero where the parameter turns: the fold's own, and pairs beside it
    for k in crossing if not turns else crossing[1:]:
        out.append(_eigenvalue_passes(curve, a, b, k))
    for type, value in others:
        if value(a) * value(b) < 0:
            frame = root_between(curve, a, b, value)
            if frame is not None and _is_zero(value, frame, a, b):
                out.append(found_at(type, frame, value(frame)))
            elif not any(e.type == "singular" for e in out):
                out.append(_pole(curve, a, b, value))
    return sorted(out, key=lambda e: _step(a, e.frame, curve.root))


def _is_zero(value: Value, frame: Equilibrium, a: Equilibrium, b: Equilibrium) -> bool:
    """Tell whether a function that changes sign between a and b does so through zero, and not through infinity."""
    return abs(value(frame)) <= SETTLED * max(abs(value(a)), abs(value(b)))


def _pole(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, value: Value) -> Found:
    """Return the singular state at which a function passes infinity, as the nearest point that Newton reaches."""
    frame = _towards(curve, a, b, lambda f: 1.0 / value(f)) or a
    event = _contacts_become_one(curve, a, b, frame)
    if event is not None:
        return event
    back = _towards(curve, replace(b, tangent=-b.tangent), a, lambda f: 1.0 / value(f)) or b
    between = min(frame.s, back.s), max(frame.s, back.s)
    flat = flat_passage(curve, frame.x, min(a.s, b.s), max(a.s, b.s))
    if flat is not None and max(abs(flat[1]), flat[2]) <= STATIONARY:
        point, off, residual = flat
        why = "a flat state: closure and contacts lose rank, and multipliers pass infinity"
        return Found("singular", frame, None, off, True, why, b, point, residual)
    why = (
        f"closure and contacts lose rank (smallest singular value {frame.system.least:.1e} at the nearest point) and "
        "multipliers grow without bound: the equilibria on both sides are followed, each by itself"
    )
    least = frame.system.least
    return Found("singular", frame, None, least, False, why, b, between=between)


def flat_crossed(
    curve: EquilibriumCurve, root: tuple[float, np.ndarray], a: Equilibrium
) -> tuple[list[Equilibrium], Found]:
    """Return a point on the way from a to the flat state that the curve passes at a root, and this event."""
    between, frame, value, beyond = crossing(curve, root, a)
    residual = float(np.abs(frame.system.values).max())
    located = max(abs(value), residual) <= STATIONARY
    return between, Found(
        "singular", frame, None, value, located, AT_FLAT, beyond, residual=residual
    )


def _contacts_become_one(
    curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, near: Equilibrium
) -> Found | None:
    """Return the event at which held contacts become dependent because facets no longer overlap; None where none is.

    There a state without one or more of them closes another; on the way to it only their sum is a force.
    """
    held = curve.hold.contacts
    reach = 2 * float(np.linalg.norm(curve.root * (b.x - a.x)))
    for count in range(len(held) - 1):
        for rest in itertools.combinations(held, len(held) - 2 - count):
            for contact in (c for c in held if c not in rest):
                other = replace(curve, hold=replace(curve.hold, contacts=rest), known=[], given=[])
                there = other.where_closed(near, contact, near.tangent)
                if there is None or np.linalg.norm(curve.root * (there.x - a.x)) > reach:
                    continue
                openings = there.programme.local(there.state).openings(held)[0]
                if np.abs(openings).max() > TOUCHES or not is_equilibrium(there):
                    continue
                value = float(openings[held.index(contact)])
                frame = Equilibrium(there.x, near.tangent, curve.system(there.x))
                return found_at("leaves", frame, value, contact)
    return None


def _between(frame: Equilibrium, a: Equilibrium, b: Equilibrium) -> Equilibrium:
    """Return a branching with the tangent of its neighbours: there the system has two null vectors."""
    along = a.tangent + b.tangent
    return Equilibrium(frame.x, along / np.linalg.norm(along), frame.system)


def _eigenvalue_passes(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium, k: int) -> Found:
    """Return the event at which eigenvalue k of the reduced Hessian changes sign: through zero, or through infinity."""

    def eigenvalue(f: Equilibrium) -> float:
        return float(f.eigenvalues[k])

    frame = root_between(replace(curve, short=True), a, b, eigenvalue)
    if frame is not None and _is_zero(eigenvalue, frame, a, b):
        return found_at("branching", _between(frame, a, b), eigenvalue(frame))
    fewer = min(a.index, b.index)  # one side has it as the largest, the other as the smallest
    return _pole(curve, a, b, lambda f: float(f.eigenvalues[-1 if f.index == fewer else 0]))


def first_contact_event(
    curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium
) -> tuple[Equilibrium, Found | None]:
    """Return the first point between a (an equilibrium) and b (none) where a contact closes or leaves."""
    leaving = _first_leaving(curve, a, b)
    beyond = b if leaving is None else leaving.frame
    if not beyond.seen.refused and closes(beyond) and touches(beyond):
        if leaving is None:
            return a, Found("refused", a, None, np.nan, False, "no event was found in a step")
        return leaving.frame, leaving
    return _closing(curve, a, beyond)


def _first_leaving(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium) -> Found | None:
    found: list[Found] = []
    for k in np.flatnonzero(b.forces < PULLS * b.system.size):
        frame = root_between(curve, a, b, lambda f, k=k: float(f.forces[k]))  # type: ignore[misc]
        if frame is None:
            continue

        def force(f: Equilibrium, k: int = int(k)) -> float:
            return float(f.forces[k])

        if _is_zero(force, frame, a, b):
            share = force(frame) / frame.system.size
            event = found_at("leaves", frame, share, a.hold.contacts[k])
        else:
            event = _pole(curve, a, b, force)
        found.append(event)
    return _named(curve, a, found) if found else None


def other_piece_leaves(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium) -> Found:
    """Return where, between a and b, a contact of a piece that is not held stops pushing: beyond, nothing balances."""
    found: list[Found] = []
    for piece in b.seen.pieces:

        def forces(f: Equilibrium, piece: tuple[Contact, ...] = piece) -> np.ndarray:
            return f.seen.on(piece).forces

        for k in np.flatnonzero(forces(b) < PULLS * b.system.size):

            def force(f: Equilibrium, k: int = int(k), forces: Forces = forces) -> float:
                return float(forces(f)[k]) / f.system.size

            frame = root_between(curve, a, b, force)
            if frame is not None and _is_zero(force, frame, a, b):
                found.append(found_at("leaves", frame, force(frame), piece[k]))
    if not found:
        why = "no multipliers >= 0 balance the springs on another piece of what contacts allow"
        return Found("singular", a, None, np.nan, False, why)
    return _named(curve, a, found)


def _named(curve: EquilibriumCurve, a: Equilibrium, found: Sequence[Found]) -> Found:
    """Return the first of some events after a; of those at one state that of a contact held, then in their order."""
    steps = [_step(a, e.frame, curve.root) for e in found]
    together = [e for e, h in zip(found, steps, strict=True) if h <= min(steps) + SETTLED]
    held = [e for e in together if e.contact in curve.hold.contacts]
    return min(held or together, key=lambda e: (e.contact is None, e.contact))


def _closing(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium) -> tuple[Equilibrium, Found]:
    """Locate the contact that closes between a and b by bisection on the verdict, then by Newton on its opening."""
    low, high, good, bad = 0.0, _step(a, b, curve.root), a, b
    ahead = _guesses(curve, a, good, bad)
    for k in range(BISECTIONS):
        inside = [h for h in ahead if low < h < high]
        middle = inside[0] if inside else 0.5 * (low + high)
        frame = curve.beside(a, middle)
        if frame is not None and is_equilibrium(frame):
            low, good = middle, frame
        else:
            high = middle
            bad = frame or bad
        if high - low <= NEAR_CONTACT:
            break
        if k == SOON:
            ahead = _guesses(curve, a, good, bad)
    met: list[tuple[float, float, Equilibrium, Contact]] = []
    for contact in _candidates(good, bad):
        frame = curve.where_closed(good, contact, a.tangent)
        if frame is None or np.linalg.norm(curve.root * (frame.x - good.x)) > BESIDE:
            continue
        if not frame.seen.refused:
            rate = _rate(curve, frame, contact)
            met.append((_step(a, frame, curve.root), rate, frame, contact))
    if not met:
        why = bad.seen.refused or "closure"
        return good, Found("refused", good, None, np.nan, False, why)
    first = min(h for h, *_ in met)
    # of contacts that close together, the one that does so to first order knows best where; of several the first
    together = sorted((m for m in met if m[0] <= first + ENDS), key=lambda m: m[3])
    _, _, frame, contact = together[
        int(first_largest(np.array([rate for _, rate, *_ in together])))
    ]
    opening = frame.programme.local(frame.state).openings((contact,))[0][0]
    return frame, found_at("closes", frame, float(opening), contact)


def _guesses(
    curve: EquilibriumCurve, a: Equilibrium, good: Equilibrium, bad: Equilibrium
) -> list[float]:
    """Return lengths of steps from a just before and just after the next contact closes, as far as Newton tells."""
    shut = (curve.where_closed(good, c, a.tangent) for c in _candidates(good, bad))
    first = _step(a, good, curve.root)
    lengths = [_step(a, f, curve.root) for f in shut if f is not None]
    return [
        h + side
        for h in sorted(h for h in lengths if h > first)[:1]
        for side in (-0.25 * NEAR_CONTACT, 0.25 * NEAR_CONTACT)
    ]


def _rate(curve: EquilibriumCurve, frame: Equilibrium, contact: Contact) -> float:
    """Return how fast a contact closes along the curve."""
    slopes, moved = opening_rates(curve, frame.x, (contact,))
    return abs(float(slopes[0] @ frame.tangent[:-1] + moved[0] * frame.ahead))


def _candidates(good: Equilibrium, bad: Equilibrium) -> list[Contact]:
    """Return the contacts that may have closed: nearly closed before, or passed."""
    near = State(good.programme, good.state, BESIDE).contacts
    rows = [*near.base, *(c for branch in near.branches for option in branch for c in option)]
    rows += bad.programme.beyond(bad.state, TOUCHES)
    return [c for c in dict.fromkeys(rows) if c not in good.hold.contacts]
