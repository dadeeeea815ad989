"""Which contact closes, leaves or slips off a border between two points of a curve of equilibria, the first of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.continuation.equilibrium import Equilibrium
from origami_nlp.continuation.events import CurveStep, LocatedEvent, found_at, pole
from origami_nlp.continuation.one_sided_branches import (
    PULLS,
    is_equilibrium,
    margin,
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


def first_contact_event(step: CurveStep) -> LocatedEvent:
    """Return the first point between a (an equilibrium) and b (none) where a contact closes or leaves."""
    leaving = _first_leaving(step)
    before = step if leaving is None else step._replace(b=leaving.frame)
    slides = _first_sliding(before)
    if slides is not None and not slides.frame.seen.refused:
        return slides
    if not before.b.seen.refused and touches(before.b):
        return leaving or LocatedEvent("refused", step.a, why="no event was found in a step")
    return _closing(before)


def _first_leaving(step: CurveStep) -> LocatedEvent | None:
    found: list[LocatedEvent] = []
    for k in np.flatnonzero(step.b.forces < PULLS * step.b.system.size).tolist():

        def force(f: Equilibrium, k: int = k) -> float:
            return float(f.forces[k])

        # a sign may also change through infinity, where held contacts become dependent
        if (frame := step.zero(force)) is not None:
            share = force(frame) / frame.system.size
            found.append(found_at("leaves", frame, share, step.a.hold[k]))
        elif step.root(force) is not None:
            found.append(pole(step, force))
    return _named(step, found) if found else None


def _first_sliding(step: CurveStep) -> LocatedEvent | None:
    """Return where features held first come to a border between a, where they are inside each other, and b.

    Where nothing else happens between `INSIDE` and the border itself it is the border, and the event is located: there
    facets slip off each other.  Otherwise it is the last state at which their gap is meaningful.
    """
    (curve, a, b), found = step, list[LocatedEvent]()
    for contact in (c for c in b.hold if margin(b, c) <= 0.0):

        def border(f: Equilibrium, least: float = 0.0, contact: Contact = contact) -> float:
            return f.problem.margin(contact, f.state) - least

        near = a if border(a, INSIDE) <= 0.0 else step.root(lambda f: border(f, INSIDE))
        if near is None or abs(border(near, INSIDE)) > STATIONARY:
            continue
        why = "to a border: beyond, no single gap keeps the facets apart"
        event = LocatedEvent("slides", near, contact, border(near, INSIDE), why=why)
        for beyond in (b, curve.beside(a, 2 * step.length)):
            if beyond is not None and border(beyond) < 0.0:
                there = CurveStep(curve, near, beyond).root(border)
                if there is not None and pushes(there) and abs(border(there)) <= STATIONARY:
                    event = found_at("slides", there, border(there), contact)
                break
        found.append(event)
    return min(found, key=lambda e: step.to(e.frame), default=None)


def other_piece_leaves(step: CurveStep) -> LocatedEvent:
    """Return where, in a step, a contact of a piece that is not held stops pushing: beyond, nothing balances."""
    found: list[LocatedEvent] = []
    for piece in step.b.seen.pieces:
        pulls = step.b.seen.on(piece).forces < PULLS * step.b.system.size
        for k in np.flatnonzero(pulls).tolist():

            def force(f: Equilibrium, k: int = k, piece: tuple[Contact, ...] = piece) -> float:
                return float(f.seen.on(piece).forces[k]) / f.system.size

            if (frame := step.zero(force)) is not None:
                found.append(found_at("leaves", frame, force(frame), piece[k]))
    if not found:
        why = "no multipliers >= 0 balance the springs on another piece of what contacts allow"
        return LocatedEvent("singular", step.a, why=why)
    return _named(step, found)


def _named(step: CurveStep, found: Sequence[LocatedEvent]) -> LocatedEvent:
    """Return the first of some events after a; of those at one state that of a contact held, then in their order."""
    first = min(step.to(e.frame) for e in found)
    together = [e for e in found if step.to(e.frame) <= first + SETTLED]
    held = [e for e in together if e.contact in step.curve.hold]
    return min(held or together, key=lambda e: (e.contact is None, e.contact))


def _closing(step: CurveStep) -> LocatedEvent:
    """Locate the contact that closes in a step by bisection on the verdict, then by Newton on its opening."""
    curve, a, b = step
    low, high, good, bad = 0.0, step.length, a, b
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
    for contact in _candidates(CurveStep(curve, good, bad), back):
        if _is_shut(a, contact):  # another gap of what is held
            continue
        frame = curve.where_closed(good, contact, a.tangent)
        # beside singular states Newton may fail before a limit that is passed all the same
        reach = step.length if contact in passed else NEAR_SINGULAR_TOL
        if frame is None or curve.apart(frame.x, good.x) > reach or margin(frame, contact) <= 0.0:
            continue
        h = step.to(frame)
        # a state is refused where another contact was passed before this one closed: it is not the first
        if not frame.seen.refused:
            rates = curve.opening_rates(frame.problem, frame.x, (contact,))[1]
            met.append((h, abs(float(rates[0] @ frame.tangent)), frame, contact))
        elif not frame.problem.crossed(frame.state) and not frame.problem.beyond(frame.state):
            event = found_at("closes", frame, frame.opening(contact), contact)
            last.append((h, replace(event, why=frame.seen.refused)))
    if not met:
        return min(last, key=lambda m: m[0])[1] if last else _not_located(good, bad)
    first = min(h for h, *_ in met)
    # of contacts that close together, the one that does so to first order knows best where; of several the first
    together = sorted((m for m in met if m[0] <= first + ENDPOINT_TOL), key=lambda m: m[3])
    fastest = int(first_largest(np.array([rate for _, rate, *_ in together])))
    frame, contact = together[fastest][2:]
    return found_at("closes", frame, frame.opening(contact), contact)


def _is_shut(at: Equilibrium, contact: Contact) -> bool:
    """Return whether a contact is closed at an equilibrium."""
    try:
        return at.opening(contact) <= CLOSURE_TOL
    except ArithmeticError:  # where sides run along each other there is no gap between them
        return False


def _not_located(good: Equilibrium, bad: Equilibrium) -> LocatedEvent:
    """Return the last state before one that is refused, where no contact is found that closes."""
    p, crossed = bad.problem, bad.problem.crossed(bad.state)
    if crossed:
        names = "; ".join(f"facets {i + 1} and {j + 1} touch" for i, j in crossed[:MOST_NAMED])
        where = "at borders or face to face, where no single gap keeps them apart"
        return LocatedEvent("touches", good, why=f"{names}: {where}: bracketed, not located")
    at_limit = [v + 1 for v in np.flatnonzero(p.fold_limits.room(good.state) < NEARLY).tolist()]
    why = bad.seen.refused or "closure"
    if p.beyond(bad.state) and len(at_limit) > 1:
        named = ", ".join(map(str, at_limit[:MOST_NAMED])) + ", ..." * (len(at_limit) > MOST_NAMED)
        why = f"creases {named} at their fold limits: closure loses rank where so many creases close at once"
    return LocatedEvent("refused", good, why=why)


def _candidates(step: CurveStep, back: Equilibrium) -> list[Contact]:
    """Return the contacts that may have closed: nearly closed before, seen from a little further back, or passed."""
    curve, good, bad = step
    p = good.problem
    rows = list(p.about_to_close(good.state, NEARLY))
    near = State(p, good.state, NEAR_SINGULAR_TOL).contacts
    rows += [*near.base, *(c for branch in near.branches for option in branch for c in option)]
    rows += back.problem.about_to_close(back.state, NEAR_SINGULAR_TOL)
    rows += bad.problem.beyond(bad.state, CONTACT_TOL)
    rows = [c for c in dict.fromkeys(rows) if c not in good.hold]
    if len(rows) <= MOST_TRIED:
        return rows
    opening, rates = curve.opening_rates(p, good.x, tuple(rows))
    # openings over rates: how far along the tangent each contact is, to first order
    rate = -rates @ good.tangent
    away = np.where(rate > 0, opening / np.maximum(rate, NONZERO), np.inf)
    return [rows[k] for k in np.argsort(away.round(9), kind="stable")[:MOST_TRIED]]
