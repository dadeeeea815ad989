"""Which features of facets touch at a state: gaps that are closed and that fold limits do not keep open anyway."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, DEEP, INDEPENDENT, INSIDE, nonnegative_least_squares
from origami_nlp.pattern_problem.contact_pairs import ContactPair
from origami_nlp.pattern_problem.equations import PatternEquations
from origami_nlp.pattern_problem.faces import CoplanarContact
from origami_nlp.pattern_problem.features import Features


def touches_at(
    problem: PatternEquations, x: np.ndarray, at_limit: np.ndarray, within: float = CLOSURE_TOL
) -> list[ContactPair]:
    """Return the gaps of features that meet inside each other at a state; those that fold limits keep open are not.

    Parameters
    ----------
    problem
        The problem.
    x
        A closed state in which no facets cross, [n] [rad].
    at_limit
        Creases at their fold limits.
    within
        Gap, over the sheet's size, that counts as closed.

    Returns
    -------
    list of Touch
        Each contact once.
    """
    place, touches = problem.placed(x), []
    for touch, gap in problem.features.facing(place, max(DEEP, within), INSIDE):
        if gap <= within and not any(
            _opened_by(problem, t.row(place), x, at_limit) for t in _seen_otherwise(problem, touch)
        ):
            touches.append(touch)
    return _without_borders(problem.features, touches)


def _opened_by(
    problem: PatternEquations, row: np.ndarray, x: np.ndarray, at_limit: np.ndarray
) -> bool:
    """Return whether a gap with this slope opens as creases at their limits do, and by nothing else."""
    tiny = INDEPENDENT * problem.crossings.size
    # -side d(gap)/dphi >= 0 for creases at their limits, and nothing for the rest: the limits imply the gap
    others = np.abs(np.delete(row, at_limit)).max(initial=0.0)
    return bool(
        others <= tiny
        and (-problem.fold_limits.side(x)[at_limit] * row[at_limit]).min(initial=0.0) >= -tiny
    )


def _seen_otherwise(problem: PatternEquations, touch: ContactPair) -> Iterator[ContactPair]:
    """Go through facets that have the features of a touch: walks between some of them cross fewer creases."""
    rings = problem.features.rings
    # on closed states a gap does not depend on the walk, but its slope names other creases
    ends = touch.corners[:1] if touch.type == "vertex-face" else touch.corners[2:]
    a, b = touch.facets
    yield touch
    ones = [a]
    if touch.type == "edge-edge":
        ones = [f for f, ring in enumerate(rings) if ring.issuperset(touch.corners[:2])]
    for one in ones:
        for other, ring in enumerate(rings):
            if ring.issuperset(ends) and other != one and (one, other) != (a, b):
                yield replace(touch, facets=(one, other))


def _without_borders(features: Features, touches: list[ContactPair]) -> list[ContactPair]:
    """Leave out sides on borders of a facet that lie on it from a corner of it on: one contact, listed twice."""
    lying = [(t.facets[0], t.corners[0]) for t in touches if t.type == "vertex-face"]

    def reported(touch: ContactPair) -> bool:
        a, b, c, d = touch.corners
        return any(
            end == corner and {start, *border} <= features.rings[facet]
            for facet, corner in lying
            for start, end, border in (
                (a, b, (c, d)),
                (b, a, (c, d)),
                (c, d, (a, b)),
                (d, c, (a, b)),
            )
        )

    return [t for t in touches if t.type == "vertex-face" or not reported(t)]


def needed_rows(slopes: np.ndarray, sure: int) -> np.ndarray:
    """Return which gaps are needed beside the first ones: others stay open to first order as long as those do.

    Parameters
    ----------
    slopes
        Of gaps along what closure allows, [r, t].
    sure
        How many of them are needed in any case.

    Returns
    -------
    numpy.ndarray
        Of bool, [r]: of those that say the same the one with the longest lever.
    """
    lengths = np.linalg.norm(slopes, axis=1)
    extra = range(sure, len(slopes))
    keep = np.ones(len(slopes), bool)
    keep[sure:] = lengths[sure:] > INDEPENDENT
    columns = (slopes / np.where(lengths > INDEPENDENT, lengths, 1.0)[:, None]).T
    same: set[bytes] = set()
    for k in sorted(extra, key=lambda k: -round(lengths[k], 9)):
        key = (np.round(columns[:, k], 9) + 0.0).tobytes()
        keep[k] &= key not in same
        same.add(key)
    for k in sorted((k for k in extra if keep[k]), key=lambda k: round(lengths[k], 9)):
        keep[k] = False
        others = columns[:, keep]
        # Farkas: a_k d >= 0 follows from the others exactly where a_k is a sum of them with factors >= 0
        left = others @ nonnegative_least_squares(others, columns[:, k]) - columns[:, k]
        keep[k] = float(np.abs(left).max(initial=0.0)) > INDEPENDENT
    return keep


def contact_pair_words(touch: ContactPair, place: Sequence[float]) -> str:
    """Describe what touches, 1-based; of two sides that of the lower facet first, from whichever they were found.

    place: of facets face to face, the point of the second one in the user's coordinates.
    """
    a, b = (f + 1 for f in touch.facets)
    if isinstance(touch, CoplanarContact):
        at = ", ".join(f"{x:.4g}" for x in place)
        which = "front" if touch.sign > 0 else "back"
        return f"facet {b} flat on the {which} of facet {a} at ({at})"
    p, q, r, s = (c + 1 for c in touch.corners)
    if touch.type == "edge-edge":
        (a, p, q), (b, r, s) = sorted([(a, *sorted((p, q))), (b, *sorted((r, s)))])
        return f"side {p}-{q} of facet {a} on side {r}-{s} of facet {b}"
    return f"corner {p} of facet {b} on facet {a}"
