"""The order of facets that lie on each other, as gaps that a descent holds: so they do not pass through each other."""

from __future__ import annotations

import numpy as np

from origami_nlp.pattern_problem import ContactPair, PatternProblem
from origami_nlp.search.descend import Slot

Order = tuple[int, int, float]
"""Facets f and g, and the sign with which gaps of g over f are positive."""


def ordered_slots(
    problem: PatternProblem,
    x: np.ndarray,
    before: np.ndarray | None,
    known: set[Order],
    rng: np.random.Generator,
) -> tuple[Slot, ...] | None:
    """Return gaps that keep an order of the facets that lie on each other at a state; None where there is no order.

    Parameters
    ----------
    problem, x
        The problem, and a closed state whose facets do not pierce each other, [n].
    before
        A state at which they did not lie on each other yet, on the way: they stay on the side that they come from.
    known
        Orders that hold already; what holds here is added.
    rng
        Draws an order where several are possible.
    """
    faces = problem.faces(x)
    if faces.reason:
        return None
    chosen = dict(faces.known)
    left = [k for k in faces.open if k not in chosen]
    while left:
        k = left[0]
        above = _side(problem, faces.touches(k, True), before, known)
        above = bool(rng.integers(2)) if above is None else above
        given = {j: v for j, v in chosen.items() if j in faces.open}
        found = faces.follow(given | {k: above}) or faces.follow(given | {k: not above})
        if found is None:
            return None
        chosen |= found
        chosen.setdefault(k, above)
        left = [j for j in left if j not in chosen]
    corners, out = problem.crossings.pattern.corners, list[Slot]()
    for k, above in chosen.items():
        for t in faces.touches(k, above):
            known.add((*t.facets, t.sign))
            sides = t.type == "edge-edge"
            points = t.reference(corners)
            out.append(Slot((-1, -1), (-1, -1), t.sign, t.facets, sides, points, orders=True))
    return tuple(out)


def _side(
    problem: PatternProblem,
    touches: tuple[ContactPair, ...],
    before: np.ndarray | None,
    known: set[Order],
) -> bool | None:
    """Return whether a pair lies as its gaps have it, by what holds already or by where facets come from."""
    for t in touches:
        if (*t.facets, t.sign) in known:
            return True
        if (*t.facets, -t.sign) in known:
            return False
    if before is None:
        return None
    place = problem.placed(before)
    gaps = [t.gap(place) for t in touches]
    furthest = max(gaps, key=abs, default=0.0)
    return None if furthest == 0.0 else furthest > 0
