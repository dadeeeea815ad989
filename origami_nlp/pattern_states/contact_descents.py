"""Downhill into contact, along states in which no facets cross: by the kernel (`kkt.follow`), and from where."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from origami_nlp.kkt import STOPPED, follow
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern_problem import MOST_DENSE, PatternProblem, PopSigns
from origami_nlp.pattern_states.descent import TRUST, Descended

MOST_STEPS = 400
"""Of a descent."""
MOST_PAIRS = 1_000
"""Pairs of facets that face each other closely: more are refused."""
REACH = 0.05
"""Features that face each other closer than this, over the sheet's size, do so closely."""
UNTOLD = "facets meet at borders or face to face, where no single gap distinguishes them"
"""Why a descent ends at a state that is neither held on every piece nor left on one."""
SMALLER = 0.8, 0.6, 0.45, 0.3, 0.2, 0.1, 0.05
"""Shares of a start's fold angles, from the reference state on, at which it is asked whether facets cross."""


def contact_descent(
    problem: PatternProblem,
    phi: np.ndarray,
    keep: bool = False,
) -> Descended:
    """Follow the energy downhill from a closed state in which no facets cross, along states of the same kind.

    Parameters
    ----------
    problem
        The problem.
    phi
        The start, within the fold limits, [n] [rad].
    keep
        Whether steps that take a vertex past its flat state are refused, see `pops`: motions of paper do not.

    Returns
    -------
    Descended
        Where it arrived, a minimum.
    """
    if problem.size > MOST_DENSE:
        many = f"the pattern has {problem.size:,} creases, contact is solved up to {MOST_DENSE}"
        return Descended(phi, False, 0, many)
    pops = PopSigns(problem.pattern)

    def crowded(x: np.ndarray) -> bool:
        facing = problem.features.facing(problem.placed(x), REACH)
        return len({frozenset(t.facets) for t, _ in facing}) > MOST_PAIRS

    def leads(x: np.ndarray, y: np.ndarray) -> bool:
        return not (keep and pops.is_jump(x, y))

    many_facets = math.comb(problem.pattern.facets, 2) > MOST_PAIRS
    try:
        found = follow(
            problem,
            phi,
            curved=True,
            longest=TRUST,
            until=lambda x: many_facets and crowded(x),
            leads=leads if keep else None,
            most_steps=MOST_STEPS,
        )
    except np.linalg.LinAlgError:  # a ValueError as well
        raise
    except ValueError as refused:
        return Descended(phi, False, 0, str(refused))
    arrived, why = found.what.verdict == "minimum", UNTOLD
    if arrived:
        problem.kept("classified", found.end, lambda: found.what)
    elif found.what is STOPPED:
        why = f"more than {MOST_PAIRS} pairs of facets come close to each other"
    path = tuple(found.states)
    return Descended(found.end, arrived, len(path) - 1, "still" if arrived else why, path=path)


def contact_descent_off(problem: PatternProblem, path: Sequence[np.ndarray]) -> Descended | None:
    """Go down where a descent that let facets cross would have had to stop.

    Parameters
    ----------
    problem
        The problem.
    path
        Closed states of the descent, [n] [rad] each.

    Returns
    -------
    Descended
        From the last state before facets cross; where they cross at the start from one that is folded less.  None
        where they cross at none of the states.
    """
    if (
        problem.size > MOST_DENSE
    ):  # to be refused: it is enough to know whether there was something to do
        return contact_descent(problem, path[-1]) if problem.crossings.find(path[-1]) else None
    crossed = next((k for k, phi in enumerate(path) if problem.crossings.find(phi)), None)
    if crossed is None:
        return None
    if crossed:
        return contact_descent(problem, path[crossed - 1])
    start = less_folded(problem, path[0])
    if start is not None:
        return contact_descent(problem, start)
    return Descended(path[0], False, 0, "no start was found at which facets do not cross")


def less_folded(problem: PatternProblem, phi: np.ndarray) -> np.ndarray | None:
    """Return a closed state at which no facets cross, on the way from one [n] to the reference state."""
    reference = problem.pattern.reference
    for share in SMALLER:
        start, residual = problem.project(reference + share * (phi - reference))
        if (
            residual > CLOSURE_TOL
            or not problem.closure.lifts_to_one(start)
            or not problem.fold_limits.inside(start).all()
        ):
            continue
        if not problem.crossings.find(start):
            return start
    return None
