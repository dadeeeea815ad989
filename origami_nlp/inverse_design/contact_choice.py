"""Which contacts of the states press: one convex program for each choice, and a refutation of all of them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from origami_nlp.inverse_design.convex import ConvexDesign, standing
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.numerics import ConeRows
from origami_nlp.problem import Contact

MOST_CHOICES = 64
"""Choices of contacts that touch."""


def solve(targets: Targets, more: Sequence[ConeRows] = ()) -> ConvexDesign:
    """Pose and solve a question, with contacts pressed, or else touching.

    A contact that can carry no moment is no hindrance where the state is in equilibrium without it.  Each choice of
    touching contacts is a convex program: first none, then all of some states, then one or more of all, at most
    `MOST_CHOICES`.  The first that is feasible is returned.  If none is, it is a refutation where already what all
    choices have in common has no answer (`ConvexDesign.loose`), or where each choice is refuted and no state has more
    than one contact.  (Where several touch without moments, stiffness in the directions that open them would do, which
    is no convex condition.)

    Parameters
    ----------
    targets
        The question.
    more
        See `ConvexDesign`.

    Returns
    -------
    ConvexDesign
        Solved; where not feasible that of the refutation, or of largest margin.
    """
    posed = ConvexDesign(targets, frozenset(), more)
    contacts = [
        sorted({c for p in standing(targets, i).pieces for c in p})
        for i in range(len(targets.placed))
    ]
    if posed.feasible or (not any(contacts) and all(b.regular for _, b, _ in posed.balances)):
        posed.every_refuted = posed.refuted
        return posed
    loose = ConvexDesign(targets, frozenset(), more, loose=True)
    loose.every_refuted = loose.refuted
    if loose.refuted:
        return loose
    best, tried = posed, 1
    refuted = posed.refuted and all(len(c) <= 1 for c in contacts)
    for touching in itertools.islice(_choices(contacts), MOST_CHOICES):
        posed, tried = ConvexDesign(targets, touching, more), tried + 1
        if posed.feasible:
            return posed
        refuted = refuted and posed.refuted
        if posed.margin > best.margin:
            best = posed
    # a refutation of all needs every subset tried
    best.every_refuted = refuted and tried == 2 ** sum(map(len, contacts))
    return best


def _choices(contacts: list[list[Contact]]) -> Iterator[frozenset[tuple[int, Contact]]]:
    """Return which contacts are to touch: all of some states, then some of all; none of them twice."""
    all_of = [frozenset((i, c) for c in some) for i, some in enumerate(contacts) if some]
    each = [frozenset([one]) for one in sorted(frozenset().union(*all_of))]
    seen = {frozenset[tuple[int, Contact]]()}
    for parts in (all_of, each):
        for k in range(1, len(parts) + 1):
            for some in itertools.combinations(parts, k):
                choice = frozenset[tuple[int, Contact]]().union(*some)
                if choice not in seen:
                    seen.add(choice)
                    yield choice
