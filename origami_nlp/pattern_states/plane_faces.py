"""Where minima that contact holds may be on a plane of closed states: beside the lowest states of its faces.

Within fold limits a plane of closed states is a convex polytope.  Its faces are where rows of creases are folded flat
while others move: facets that lie on others there may keep a row from unfolding although its springs would open it,
in a face that no descent from states beside it leads to, as facets cross in all of them.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from origami_nlp.numerics import DUPLICATE_TOL, SETTLED
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states.branch_points import is_on_plane
from origami_nlp.pattern_states.clearance import Clearance, Stretches
from origami_nlp.pattern_states.closed import lowest_on
from origami_nlp.pattern_states.contact_descents import contact_descent, contact_descents_along
from origami_nlp.pattern_states.descent import Descended

APART = 0.15
"""Largest change of a fold angle between states of a plane at which it is asked whether facets cross [rad]."""
STEP = 0.01
"""From the lowest state of a face to others, after which facets cross where it is kept from them [rad]."""
MOST_DIMENSIONS = 3
"""Of planes whose faces are gone through: a box of them has 26, one of four dimensions 80."""


def contact_descents_on_plane(
    problem: PatternProblem,
    clearance: Clearance,
    plane: tuple[np.ndarray, np.ndarray],
    lowest: np.ndarray,
    known: np.ndarray | None = None,
) -> Iterator[Descended]:
    """Go down from states of a plane's faces that are kept from its lowest state by facets that meet.

    Parameters
    ----------
    problem
        The problem.
    clearance
        Of its curves: where facets cross.
    plane
        Of closed states: one of them [n] and an orthonormal basis [n, t].
    lowest
        Its state of lowest energy, [n].
    known
        As of `contact_descent`.

    Yields
    ------
    Descended
        From the lowest states of faces that are kept where they are, and from where facets meet along edges and along
        the straight ways from the lowest state of each face to that of the plane, where the energy falls on.
    """
    lows, ways = [lowest], []
    for phi, basis in faces(problem, *plane):
        problem.check_time()
        low = lowest_on(problem, phi, basis) if basis.shape[1] else phi
        if low is not None:
            lows.append(low)
            ways.append((low, lowest))
            if basis.shape[1] == 1:
                ways.append(_edge(problem, low, basis[:, 0]))
    for low in lows[1:]:
        torque = problem.torque(low)
        least = -SETTLED * np.abs(torque).max()
        ahead = np.array([x for x in lows if torque @ (x - low) < least])
        if len(ahead):
            near = low + STEP * (ahead - low) / np.abs(ahead - low).max(axis=1)[:, None]
            if clearance.crosses(near).all() and not problem.refuses(low):
                yield contact_descent(problem, low, known=known)
    for begin, end in ways:
        problem.check_time()
        parts = np.linspace(0.0, 1.0, 2 + int(np.abs(end - begin).max() / APART))[1:-1]
        states = begin + parts[:, None] * (end - begin)
        if len(states):
            stretches = Stretches(states, clearance.crosses(states), 0)
            yield from contact_descents_along(problem, stretches, known)


def faces(
    problem: PatternProblem, phi: np.ndarray, basis: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """List the faces of a plane of closed states within fold limits, corners among them, but not the plane itself.

    Parameters
    ----------
    problem
        The problem.
    phi, basis
        A closed state [n] [rad] and an orthonormal basis [n, t].

    Returns
    -------
    list of tuple
        Of each a state and an orthonormal basis; some have no state within the limits.  None of planes of more
        than `MOST_DIMENSIONS`.
    """
    limits, found = problem.fold_limits, [(phi, basis)]
    met = [(basis, phi - basis @ (basis.T @ phi))]
    for at, free in found if basis.shape[1] <= MOST_DIMENSIONS else ():  # which grows
        size = np.linalg.norm(free, axis=1)
        for c in np.flatnonzero(size > SETTLED):
            less = free @ np.linalg.svd(free[[c]] / size[c])[2][1:].T
            for limit in (limits.low[c], limits.high[c]):
                x = at + free @ (free[c] * (limit - at[c]) / size[c] ** 2)
                x = limits.hold(x, limits.near(x, 10 * DUPLICATE_TOL))
                off = x - less @ (less.T @ x)
                within = less.shape[1] or limits.inside(x).all()
                if within and not is_on_plane(met, less, off):
                    met.append((less, off))
                    found.append((x, less))
    return found[1:]


def _edge(
    problem: PatternProblem, phi: np.ndarray, along: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return both ends of an edge within the fold limits, through a state of it."""
    limits, moves = problem.fold_limits, np.abs(along) > SETTLED
    room = np.array([limits.low - phi, limits.high - phi])[:, moves] / along[moves]
    ends = phi + np.outer([room.min(axis=0).max(), room.max(axis=0).min()], along)
    ends = limits.hold(ends, limits.near(ends, 10 * DUPLICATE_TOL))
    return ends[0], ends[1]
