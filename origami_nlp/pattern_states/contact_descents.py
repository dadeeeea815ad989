"""Downhill into contact, along states in which no facets cross: by the kernel (`kkt.follow`)."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.kkt import STOPPED, follow
from origami_nlp.pattern_problem import MOST_DENSE, PatternProblem, PopSigns
from origami_nlp.search import TRUST, Descended

MOST_STEPS = 400
"""Of a descent."""
MOST_PAIRS = 1_000
"""Pairs of facets that face each other closely: more are refused."""
REACH = 0.05
"""Features that face each other closer than this, over the sheet's size, do so closely."""
UNTOLD = "facets meet at borders or face to face, where no single gap distinguishes them"
"""Why a descent ends at a state that is neither held on every piece nor left on one."""


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
