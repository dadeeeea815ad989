"""What equilibria of a sheet are held by: creases at their fold limits, and features of facets that touch."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

import numpy as np

from origami_nlp.facets import INSIDE, Features, Placed, Sheet, Touch
from origami_nlp.numerics import cross
from origami_nlp.sheets import Rows, SheetContact

Contact: TypeAlias = int | Touch
"""A crease (0-based) at its fold limit, or features that touch."""
MOST_NAMED = 8
"""Contacts of one kind that are named."""


def ordered(contacts: Iterable[Contact]) -> tuple[Contact, ...]:
    """Return creases in order, then touches, by their corners."""
    both = list(contacts)
    creases = sorted({c for c in both if isinstance(c, int)})
    touches = {c.key: c for c in both if isinstance(c, Touch)}
    return (*creases, *sorted(touches.values(), key=lambda t: (t.corners, t.facets)))


def creases_of(held: Iterable[Contact]) -> list[int]:
    """Return the creases among contacts."""
    return [c for c in held if isinstance(c, int)]


def touches_of(held: Iterable[Contact]) -> list[Touch]:
    """Return the features among contacts."""
    return [c for c in held if isinstance(c, Touch)]


def without(contacts: Iterable[Contact], others: Iterable[Contact]) -> tuple[Contact, ...]:
    """Return contacts that are not among others."""
    gone = {_key(c) for c in others}
    return tuple(c for c in contacts if _key(c) not in gone)


def _key(contact: Contact) -> object:
    return contact.key if isinstance(contact, Touch) else contact


def touching_rows(sheet: Sheet, phi: np.ndarray, touches: Iterable[Touch]) -> Rows:
    """Return gaps over the sheet's size, with their slopes, at a state."""
    some, none = list(touches), np.zeros(0, int)
    if not some:
        return Rows(none, (), np.zeros(0), np.zeros((0, sheet.size)))
    return Rows.at(sheet, phi, none, some)


def words(contacts: Iterable[Contact]) -> str:
    """Name contacts, 1-based."""
    both = list(contacts)
    creases = creases_of(both)
    out = [] if not creases else [_limits(creases)]
    touches = [_features(t) for t in touches_of(both)]
    out += touches[:MOST_NAMED]
    return "; ".join(out) + (f"; ... ({len(touches)})" if len(touches) > MOST_NAMED else "")


def _features(touch: Touch) -> str:
    """Name features that touch; of two sides that of the lower facet first, from whichever they were found."""
    facets, (p, q, r, s) = touch.facets, touch.corners
    if touch.type == "edge-edge":
        one, other = sorted([(facets[0], *sorted((p, q))), (facets[1], *sorted((r, s)))])
        facets, (p, q, r, s) = (one[0], other[0]), (*one[1:], *other[1:])
    return SheetContact(touch.type, facets, 0.0, (p, q, r, s)).features()


def _limits(creases: list[int]) -> str:
    numbers = ", ".join(str(i + 1) for i in creases[:MOST_NAMED])
    numbers += f", ... ({len(creases)})" if len(creases) > MOST_NAMED else ""
    return (
        f"crease {numbers} at its fold limit"
        if len(creases) == 1
        else f"creases {numbers} at their fold limits"
    )


def margin(features: Features, touch: Touch, at: Placed) -> float:
    """Return how far inside each other features are, as a share of their size; below 0 they are not.

    Their gap is the one that keeps facets apart as long as it is positive.  For a corner over a facet it is the way to
    the border, for a side that starts on the facet's own corner the angle to its sides there, for two sides what is
    left of either to its end, or the square of their sine less what `INSIDE` asks for.
    """
    p = touch.points(at)
    if touch.type == "edge-edge":
        u, v, r = p[1] - p[0], p[3] - p[2], p[2] - p[0]
        w = cross(u, v)
        square = float(w @ w)
        if square == 0.0:
            return -INSIDE
        shares = float(cross(r, v) @ w) / square, float(cross(r, u) @ w) / square
        steep = square / float((u @ u) * (v @ v))
        return min(*shares, *(1 - s for s in shares), steep - INSIDE)
    crossings = features.crossings
    face, other = touch.facets
    common = features.rings[face] & features.rings[other]
    best = -np.inf
    for k in np.flatnonzero(crossings.facet == face):
        ring = list(dict.fromkeys(crossings.pieces[k].tolist()))
        x = at.points(np.full(len(ring), face), np.array(ring))
        normal = cross(x - x[0], np.roll(x, -1, axis=0) - x[0]).sum(axis=0)
        inward = cross(normal, np.roll(x, -1, axis=0) - x)
        inward /= np.linalg.norm(inward, axis=1)[:, None]
        depth, size = np.einsum("qi,qi->q", inward, p[0] - x), crossings.size
        depth += np.where(crossings.inner[k, : len(ring)], INSIDE * size, 0.0)  # cuts are none
        apex = [i for i, c in enumerate(ring) if c in common]
        if apex:
            depth = depth[[apex[0], apex[0] - 1]]
            size = float(np.linalg.norm(p[0] - x[apex[0]]))
        best = max(best, float(depth.min()) / size)
    return best
