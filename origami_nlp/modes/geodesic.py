"""From a state along a mode: the geodesic of the states that close with contacts held, as far as the paper goes.

A straight line of fold angles leaves closure, and what a projection of its points does far away depends on how the
equations of closure are written.  A geodesic does not: it is straight in the space of all N fold angles but for what
closure and held contacts bend, so that mirror images have mirror images.  Each step is one of RATTLE (Andersen,
J. Comput. Phys. 52, 1983) for a free particle: x + h v is pulled back onto closure along the rows at x, and the chord
is turned into the directions that are left there; of second order in h, and the same backward as forward.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.kkt import State, Stratum
from origami_nlp.numerics import DEPENDENT, FOLLOWED, NEAR_CONTACT
from origami_nlp.problem import Contact

STEP = 0.02
"""Length of a step [rad]: distances and energies at the ends are then known to some 1e-4 of themselves."""
NEWTON = 12
"""Steps of the pull back; it needs three or four."""
HALVINGS = 44
"""Of the last step: 0.02 rad / 2^44 is rounding."""
SHORTEST = 0.5
"""A step whose chord is shorter than this share of it has run into the edge of what closes."""


@dataclass(frozen=True, repr=False)
class Reach(ShortRepr):
    """One end of a geodesic.

    Attributes
    ----------
    s
        Signed distance from the state [rad].
    rise
        Energy there above that of the state, in the scene's units.
    why
        The contacts that close there, or why the geodesic ends.
    opening
        Largest |opening| of these [rad]: rounding, where the end was located; nan where nothing touches.
    contacts
        Contacts that close there; none where it was read from a file.
    """

    s: float
    rise: float
    why: str
    opening: float
    contacts: tuple[Contact, ...] = field(default=(), metadata={"plain": False})


@dataclass(frozen=True, repr=False)
class Geodesic(ShortRepr):
    """A geodesic through a state.

    Attributes
    ----------
    s
        Signed arclength in the space of all N fold angles, 0 at the state [P] [rad].
    states
        Fold angles, [P, N] [rad].
    rise
        Energy above that of the state, [P].
    ends
        Backward and forward.
    """

    s: np.ndarray
    states: np.ndarray
    rise: np.ndarray
    ends: tuple[Reach, Reach]


def geodesic(held: Stratum, direction: np.ndarray, step: float = STEP) -> Geodesic:
    """Follow the geodesic that leaves a state along a direction, both ways, to the first other contact.

    Contacts are looked for at each step: one that closes and opens within a step is not seen.

    Parameters
    ----------
    held
        The state with the contacts that stay closed.
    direction
        Unit vector in the metric of all N fold angles that keeps them closed to first order, [n].
    step
        Length of a step [rad].

    Returns
    -------
    Geodesic
        From one end to the other.
    """
    model = held.state.problem
    back, forth = (_one_way(held, sign * direction, step) for sign in (-1.0, 1.0))
    s = np.concatenate([-back.s[:0:-1], forth.s])
    x = np.concatenate([back.x[:0:-1], forth.x])
    rise = np.array([model.energy_change(held.state.x, y) for y in x])
    ends = (
        Reach(-float(back.s[-1]), float(rise[0]), back.why, back.opening, back.contacts),
        Reach(float(forth.s[-1]), float(rise[-1]), forth.why, forth.opening, forth.contacts),
    )
    return Geodesic(s, model.expand(x), rise, ends)


@dataclass(frozen=True)
class _Way:
    """One way from a state: distances [P], states [P, n], and what ends it."""

    s: np.ndarray
    x: np.ndarray
    why: str
    contacts: tuple[Contact, ...]
    opening: float


def _one_way(held: Stratum, v: np.ndarray, step: float) -> _Way:
    model = held.state.problem
    farthest = 2 * model.bound * math.sqrt(len(model.expand(held.state.x)))
    s, x = [0.0], [held.state.x]
    here, why = held, ""
    while s[-1] < farthest:
        # invariant: `here` is admissible, and a step of length `low` from it is; one of `high` is not
        after, why = _tried(here, v, step)
        if after is None:
            break
        here, v = after
        s.append(s[-1] + step)
        x.append(here.state.x)
    low, high = 0.0, step
    end = here
    for _ in range(HALVINGS if why else 0):
        middle = 0.5 * (low + high)
        after, beyond = _tried(here, v, middle)
        if after is None:
            high, why = middle, beyond
        else:
            low, end = middle, after[0]
    if low:
        s.append(s[-1] + low)
        x.append(end.state.x)
    found, opening = _touching(held, end.state.x)
    names = "; ".join(dict.fromkeys(model.name(c) for c in found))
    return _Way(np.array(s), np.array(x), names or why or "it goes on", found, opening)


def _tried(here: Stratum, v: np.ndarray, h: float) -> tuple[tuple[Stratum, np.ndarray] | None, str]:
    """Take a step along the unit vector v [n]; None and why where it leads to no admissible state."""
    model, x, rows = here.state.problem, here.state.x, here.jacobian
    y = x + h * v / model.root
    for _ in range(NEWTON):
        f, jacobian = model.constraints(y, here.contacts)
        if np.abs(f).max() <= FOLLOWED:
            break
        # RATTLE: back onto closure along the rows at x, so that the step is normal to the set where it began
        pull = np.linalg.lstsq(jacobian / model.root @ rows.T, f, rcond=DEPENDENT)[0]
        y = y - rows.T @ pull / model.root
    else:
        return None, "no state that closes lies beyond"
    for contact in here.contacts:
        contact.hold(y)
    chord = model.root * (y - x)
    # a pull back that changes the length of the step so much has found another branch of closed states
    if not SHORTEST * h <= np.linalg.norm(chord) <= h / SHORTEST:
        return None, "no state that closes lies beyond"
    refused = model.refuses(y)
    # facets that are all but on each other end no way: what they come to lie on does
    if refused and not model.doubt(y):
        return None, refused
    there = here.state.at(y).on(here.contacts)
    # the velocity for the next step: the chord, without what the rows at y forbid
    along = there.tangent @ (there.tangent.T @ chord)
    return (there, along / np.linalg.norm(along)), ""


def _touching(held: Stratum, x: np.ndarray) -> tuple[tuple[Contact, ...], float]:
    """Contacts besides those of the state that are closed at x, and how far the widest of them is open."""
    state = State(held.state.problem, x, NEAR_CONTACT)
    new = (*state.contacts.base, *(c for options in state.contacts.branches for c in options[0]))
    found = tuple(c for c in dict.fromkeys(new) if c not in held.contacts)
    if not found:
        return (), math.nan
    return found, float(np.abs(state.local.openings(found)[0]).max())
