"""Which contact closes, leaves or slips off a border between two points of a curve of equilibria, the first of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.continuation.equilibrium import Equilibrium, EquilibriumCurve
from origami_nlp.continuation.events import (
    LocatedEvent,
    found_at,
    is_zero,
    pole,
    root_between,
    step_length,
)
from origami_nlp.continuation.one_sided_branches import (
    PULLS,
    is_equilibrium,
    margin,
    opening_rates,
    pushes,
    touches,
)
from origami_nlp.kkt import State
from origami_nlp.numerics import (
    CLOSURE_TOL,
    CONTACT_TOL,
    ENDPOINT_TOL,
    INSIDE,
    NEAR_CONTACT,
    NEAR_SINGULAR_TOL,
    NEARLY,
    NONZERO,
    SETTLED,
    STATIONARY,
    first_largest,
)
from origami_nlp.problem import Contact

BISECTIONS = 24
"""Of a step in which a state is refused: what then closes is looked for by Newton."""
LATE = 30
"""Lengths of what bisection leaves by which is stepped back: facets that cross are seen from a depth on, and there the
sides on which features are can no longer be determined."""
MOST_TRIED = 8
"""Contacts that are looked for by Newton, the nearest ones."""
MOST_NAMED = 8
"""Pairs of facets that are named where they meet at borders."""
Forces = Callable[[Equilibrium], np.ndarray]


def first_contact_event(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium) -> LocatedEvent:
    """Return the first point between a (an equilibrium) and b (none) where a contact closes or leaves."""
    leaving = _first_leaving(curve, a, b)
    beyond = b if leaving is None else leaving.frame
    slides = _first_sliding(curve, a, beyond)
    if slides is not None and not slides.frame.seen.refused:
        return slides
    if not beyond.seen.refused and touches(beyond):
        none = "no event was found in a step"
        return leaving or LocatedEvent("refused", a, None, np.nan, False, none)
    return _closing(curve, a, beyond)


def _first_leaving(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium) -> LocatedEvent | None:
    found: list[LocatedEvent] = []
    for k in np.flatnonzero(b.forces < PULLS * b.system.size):
        frame = root_between(curve, a, b, lambda f, k=k: float(f.forces[k]))  # type: ignore[misc]
        if frame is None:
            continue

        def force(f: Equilibrium, k: int = int(k)) -> float:
            return float(f.forces[k])

        # a sign may also change through infinity, where held contacts become dependent
        if is_zero(force, frame, a, b):
            share = force(frame) / frame.system.size
            event = found_at("leaves", frame, share, a.hold[k])
        else:
            event = pole(curve, a, b, force)
        found.append(event)
    return _named(curve, a, found) if found else None


def _first_sliding(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium) -> LocatedEvent | None:
    """Return where features held first come to a border between a, where they are inside each other, and b.

    Where nothing else happens between `INSIDE` and the border itself it is the border, and the event is located: there
    facets slip off each other.  Otherwise it is the last state at which their gap is meaningful.
    """
    found: list[LocatedEvent] = []
    for contact in (c for c in b.hold if margin(b, c) <= 0.0):

        def reported(f: Equilibrium, contact: Contact = contact) -> float:
            return f.problem.margin(contact, f.state) - INSIDE

        near = a if reported(a) <= 0.0 else root_between(curve, a, b, reported)
        if near is None or abs(reported(near)) > STATIONARY:
            continue

        def border(f: Equilibrium, contact: Contact = contact) -> float:
            return f.problem.margin(contact, f.state)

        why = "to a border: beyond, no single gap keeps the facets apart"
        event = LocatedEvent("slides", near, contact, reported(near), False, why)
        for beyond in (b, curve.beside(a, 2 * step_length(a, b, curve.root))):
            if beyond is not None and border(beyond) < 0.0:
                there = root_between(curve, near, beyond, border)
                if there is not None and pushes(there) and abs(border(there)) <= STATIONARY:
                    event = found_at("slides", there, border(there), contact)
                break
        found.append(event)
    return min(found, key=lambda e: step_length(a, e.frame, curve.root), default=None)


def other_piece_leaves(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium) -> LocatedEvent:
    """Return where, between a and b, a contact of a piece that is not held stops pushing: beyond, nothing balances."""
    found: list[LocatedEvent] = []
    for piece in b.seen.pieces:

        def forces(f: Equilibrium, piece: tuple[Contact, ...] = piece) -> np.ndarray:
            return f.seen.on(piece).forces

        for k in np.flatnonzero(forces(b) < PULLS * b.system.size):

            def force(f: Equilibrium, k: int = int(k), forces: Forces = forces) -> float:
                return float(forces(f)[k]) / f.system.size

            frame = root_between(curve, a, b, force)
            if frame is not None and is_zero(force, frame, a, b):
                found.append(found_at("leaves", frame, force(frame), piece[k]))
    if not found:
        why = "no multipliers >= 0 balance the springs on another piece of what contacts allow"
        return LocatedEvent("singular", a, None, np.nan, False, why)
    return _named(curve, a, found)


def _named(curve: EquilibriumCurve, a: Equilibrium, found: Sequence[LocatedEvent]) -> LocatedEvent:
    """Return the first of some events after a; of those at one state that of a contact held, then in their order."""
    steps = [step_length(a, e.frame, curve.root) for e in found]
    together = [e for e, h in zip(found, steps, strict=True) if h <= min(steps) + SETTLED]
    held = [e for e in together if e.contact in curve.hold]
    return min(held or together, key=lambda e: (e.contact is None, e.contact))


def _closing(curve: EquilibriumCurve, a: Equilibrium, b: Equilibrium) -> LocatedEvent:
    """Locate the contact that closes between a and b by bisection on the verdict, then by Newton on its opening."""
    low, high, good, bad = 0.0, step_length(a, b, curve.root), a, b
    missed = np.inf  # where Newton fails for the length of the step, not for what it meets
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + min(high, missed))
        frame = curve.beside(a, middle)
        if frame is None and good is not a:
            frame = curve.beside(good, middle - low)
        if frame is None:
            missed = middle
        elif is_equilibrium(frame):
            low, good, missed = middle, frame, np.inf
        else:
            high, bad = middle, frame
        if min(high, missed) - low <= NEAR_CONTACT:
            break
    back = curve.beside(a, max(0.0, low - LATE * (high - low))) or good
    passed = b.problem.beyond(b.state)
    met: list[tuple[float, float, Equilibrium, Contact]] = []
    last: list[tuple[float, LocatedEvent]] = []
    for contact in _candidates(curve, good, bad, back):
        if _is_shut(a, contact):  # another gap of what is held
            continue
        frame = curve.where_closed(good, contact, a.tangent)
        # beside singular states Newton may fail before a limit that is passed all the same
        reach = step_length(a, b, curve.root) if contact in passed else NEAR_SINGULAR_TOL
        if frame is None or np.linalg.norm(curve.root * (frame.x - good.x)) > reach:
            continue
        if margin(frame, contact) <= 0.0:
            continue
        h = step_length(a, frame, curve.root)
        # a state is refused where another contact was passed before this one closed: it is not the first
        if not frame.seen.refused:
            met.append((h, _rate(curve, frame, contact), frame, contact))
        elif not frame.problem.crossed(frame.state) and not frame.problem.beyond(frame.state):
            left = frame.problem.local(frame.state).openings((contact,))[0][0]
            event = found_at("closes", frame, float(left), contact)
            last.append((h, replace(event, why=frame.seen.refused)))
    if not met:
        return min(last, key=lambda m: m[0])[1] if last else _not_located(good, bad)
    first = min(h for h, *_ in met)
    # of contacts that close together, the one that does so to first order knows best where; of several the first
    together = sorted((m for m in met if m[0] <= first + ENDPOINT_TOL), key=lambda m: m[3])
    _, _, frame, contact = together[
        int(first_largest(np.array([rate for _, rate, *_ in together])))
    ]
    opening = frame.problem.local(frame.state).openings((contact,))[0][0]
    return found_at("closes", frame, float(opening), contact)


def _is_shut(at: Equilibrium, contact: Contact) -> bool:
    """Return whether a contact is closed at an equilibrium."""
    try:
        opening = at.problem.local(at.state).openings((contact,))[0][0]
    except ArithmeticError:  # where sides run along each other there is no gap between them
        return False
    return bool(opening <= CLOSURE_TOL)


def _not_located(good: Equilibrium, bad: Equilibrium) -> LocatedEvent:
    """Return the last state before one that is refused, where no contact is found that closes."""
    p, crossed = bad.problem, bad.problem.crossed(bad.state)
    if crossed:
        names = "; ".join(f"facets {i + 1} and {j + 1} touch" for i, j in crossed[:MOST_NAMED])
        where = "at borders or face to face, where no single gap keeps them apart"
        return LocatedEvent(
            "touches", good, None, np.nan, False, f"{names}: {where}: bracketed, not located"
        )
    at_limit = [v + 1 for v in np.flatnonzero(p.fold_limits.room(good.state) < NEARLY).tolist()]
    why = bad.seen.refused or "closure"
    if p.beyond(bad.state) and len(at_limit) > 1:
        named = ", ".join(map(str, at_limit[:MOST_NAMED])) + ", ..." * (len(at_limit) > MOST_NAMED)
        why = f"creases {named} at their fold limits: closure loses rank where so many creases close at once"
    return LocatedEvent("refused", good, None, np.nan, False, why)


def _rate(curve: EquilibriumCurve, frame: Equilibrium, contact: Contact) -> float:
    """Return how fast a contact closes along the curve."""
    slopes, moved = opening_rates(curve, frame.x, (contact,))
    return abs(float(slopes[0] @ frame.tangent[:-1] + moved[0] * frame.ahead))


def _candidates(
    curve: EquilibriumCurve, good: Equilibrium, bad: Equilibrium, back: Equilibrium
) -> list[Contact]:
    """Return the contacts that may have closed: nearly closed before, seen from a little further back, or passed."""
    p = good.problem
    rows = list(p.about_to_close(good.state, NEARLY))
    near = State(p, good.state, NEAR_SINGULAR_TOL).contacts
    rows += [*near.base, *(c for branch in near.branches for option in branch for c in option)]
    rows += back.problem.about_to_close(back.state, NEAR_SINGULAR_TOL)
    rows += bad.problem.beyond(bad.state, CONTACT_TOL)
    rows = [c for c in dict.fromkeys(rows) if c not in good.hold]
    if len(rows) <= MOST_TRIED:
        return rows
    opening = p.local(good.state).openings(rows)[0]
    slopes, moved = opening_rates(curve, good.x, tuple(rows))
    # openings over rates: how far along the tangent each contact is, to first order
    rate = -(slopes @ good.tangent[:-1] + moved * good.ahead)
    away = np.where(rate > 0, opening / np.maximum(rate, NONZERO), np.inf)
    return [rows[k] for k in np.argsort(away.round(9), kind="stable")[:MOST_TRIED]]
