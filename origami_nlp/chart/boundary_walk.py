"""Walk along a contact boundary to both its ends: cheap steps first, the exact corner last.

Like `continuation.follow_boundary`, but made to trace all boundaries of a chart: admissibility is looked at for many
points at once, energy plays no part, and ends are put on the corner by Newton.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.continuation import (
    CLOSES_ANOTHER,
    SINGULAR,
    ContinuationOptions,
    End,
    Point,
    closing,
    correct,
    evaluate,
    trace_held,
)
from origami_nlp.kkt import Stratum
from origami_nlp.numerics import NEAR_CONTACT, SETTLED
from origami_nlp.problem import Contact, Problem

STEPS = ContinuationOptions(
    first=1e-2, longest=0.04, shortest=1e-10, turn=0.06, sharpest=0.18, together=12, most=3000
)
"""Wider turns than where an energy is looked at; so many points that any boundary of a chart is done."""

PROBE = 0.01
"""Share of the way from a corner to the points round it at which it is looked at."""
REFUSED = "no state beyond is admissible"
"""Why a line ends, until the contact that closes there is known."""


@dataclass(frozen=True)
class Walk:
    """States [m, n] in the model's variables, arclength [m] in all N fold angles from 0, and why it ends."""

    states: np.ndarray
    s: np.ndarray
    start: str
    end: str


def walk(held: Stratum) -> Walk | None:
    """Follow the contacts of `held` from its admissible state both ways.

    None where no motion, or more than one, keeps them closed, or where both ends come at once.
    """
    problem = held.state.problem
    end = End[Point](lambda points: _admissible_run(problem, points), REFUSED, _corner)
    found = trace_held(held, STEPS, [end], dimension=1)
    if found is None:
        return None
    states, s, why = list(found.states), found.s.tolist(), [found.start, found.end]
    for side, point in ((0, found.frames[0]), (-1, found.frames[-1])):
        if why[side] not in (REFUSED, SINGULAR):
            continue
        new = closing(point.stratum)
        why[side] = closing_words(point.stratum)
        # the end itself, with all of them closed
        corner = correct(point.stratum.state.on((*held.contacts, *new))) if new else None
        if corner is not None and np.abs(corner.x - point.x).max() < NEAR_CONTACT:
            away = float(np.linalg.norm(corner.x - point.x))
            if away <= SETTLED:  # it was met
                continue
            where = 0 if side == 0 else len(s)
            states.insert(where, corner.x)
            s.insert(where, s[side] + (away if side else -away))
    if len(s) < 3:
        return None
    return Walk(np.array(states), np.array(s) - s[0], why[0], why[1])


def closing_words(held: Stratum) -> str:
    """Say which contacts close besides those held where a line ends."""
    new = closing(held)
    names = "; ".join(held.state.problem.name(contact) for contact in new)
    return f"{CLOSES_ANOTHER} ({names})" if new else SINGULAR


def _corner(before: Point, after: Point) -> Point | None:
    """Return the corner between two points of a line, where the contact closes that the second one violates.

    It is the first point itself where states next to that are refused.  None where Newton finds none from which states
    are refused on the one side, and on the other are not.
    """
    held, problem = before.stratum, before.stratum.state.problem
    a, b = before.x, after.x
    size = float(np.linalg.norm(b - a))
    if size <= NEAR_CONTACT:
        return None

    def refused(x: np.ndarray) -> bool:
        state = correct(held.state.at(x).on(held.contacts))
        return state is None or bool(state.refused)

    if refused(a + NEAR_CONTACT / size * (b - a)):
        return before
    limits, (u, v) = problem.fold_limits, (problem.local(x).gaps for x in (a, b))
    shares = u / np.where(u == v, 1.0, u - v)
    closes = [
        (shares[i], Contact("gap", i, int(np.sign(u[i]))))
        for i in np.flatnonzero(u * v < 0).tolist()
    ]
    if problem.has_limits:
        u, v = limits.room(a), limits.room(b)
        closes += [
            (u[c.index] / (u - v)[c.index], c) for c in limits.contacts(b, (u > 0) & (v < 0))
        ]
    met = []
    for share, contact in closes:
        near = held.state.at(a + share * (b - a))
        corner = correct(near.on((*held.contacts, contact)))
        if corner is not None and max(np.linalg.norm(corner.x - x) for x in (a, b)) <= size:
            met.append(corner.x)
    if not met:
        return None
    x = min(met, key=lambda x: float(np.linalg.norm(x - a)))
    if refused(x) or refused(x + PROBE * (a - x)) or not refused(x + PROBE * (b - x)):
        return None
    return evaluate(held.state.at(x).on(held.contacts), before.tangent)


def _admissible_run(problem: Problem, points: Sequence[Point]) -> int:
    """How many of the points, from the first on, are admissible."""
    states = np.array([p.x for p in points])
    # a fold angle exceeds pi, by however little, where a held limit does not keep it there
    inside = problem.fold_limits.inside(states).all(axis=1) | (not problem.has_limits)
    good = inside & problem.admissible(states)
    count = len(points) if good.all() else int(np.argmin(good))
    # the order of layers is looked at where a run ends: it changes at corners, and then stays
    low, high = -1, count
    if count and problem.refuses(states[count - 1]):
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if not problem.refuses(states[middle]) else (low, middle)
    return high
