"""Which of many states can be held together: the largest set that has springs, greedy or exact."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.contact_choice import solve
from origami_nlp.inverse_design.convex import ConvexDesign
from origami_nlp.inverse_design.infeasibility import without
from origami_nlp.inverse_design.targets import Targets

LARGEST_POOL = 20
"""States of a pool of which the largest set is found by branch and bound."""
STARTS = 6
"""Orders in which a greedy choice is begun."""


@dataclass(frozen=True)
class Disjunction:
    """States of a pool that have springs together.

    Attributes
    ----------
    targets
        The question of these states alone.
    names
        Of them.
    margin
        Of their springs.
    exact
        Whether no larger set has springs (of those, whether none has a larger margin), as far as each program is
        decided.
    programs
        How many were solved.
    """

    targets: Targets
    names: tuple[str, ...]
    margin: float
    exact: bool
    programs: int


class _Pool:
    """Programs of subsets of a question's states, each solved once."""

    def __init__(self, targets: Targets) -> None:
        self.targets = targets
        self.known: dict[frozenset[str], float] = {}
        self.undecided = 0

    def only(self, names: frozenset[str]) -> Targets:
        out = self.targets
        for t in self.targets.states:
            if t.name not in names:
                out = without(out, t.name)
        return out

    def margin(self, names: frozenset[str]) -> float:
        """Largest margin of some states; -inf where they have no springs."""
        if names not in self.known:
            posed: ConvexDesign = solve(self.only(names))
            self.undecided += not posed.feasible and not posed.every_refuted
            self.known[names] = posed.margin if posed.feasible else -np.inf
        return self.known[names]


def choose(targets: Targets, *, exact: bool | None = None, seed: int = 0) -> Disjunction:
    """Choose the largest set of states that springs hold together; of equally large ones that of largest margin.

    Parameters
    ----------
    targets
        A question with the pool as its states.
    exact
        Branch and bound over all sets, for at most 20 states; None: where the pool is that small.  A set is given up
        only where a part of it has no springs, or where it cannot become larger than the best one.
    seed
        Of the orders of the greedy choice.

    Returns
    -------
    Disjunction
        The set.

    Raises
    ------
    OptionError
        If the pool is too large for the exact choice, or no state of it has springs.
    """
    pool = _Pool(targets)
    names = [t.name for t in targets.states]
    if exact is None:
        exact = len(names) <= LARGEST_POOL
    if exact and len(names) > LARGEST_POOL:
        raise OptionError(
            f"exact = {shown(exact)}: at most {LARGEST_POOL} states, not {len(names)}"
        )
    alone = [n for n in names if pool.margin(frozenset([n])) > 0]
    if not alone:
        raise OptionError("no state of the pool has springs by itself")
    best = _greedy(pool, alone, np.random.default_rng(seed))
    if exact:
        best = _exact(pool, alone, best)
    chosen = pool.only(best)
    return Disjunction(
        replace(chosen),
        tuple(n for n in names if n in best),
        pool.margin(best),
        exact and not pool.undecided,
        len(pool.known),
    )


def _greedy(pool: _Pool, names: list[str], rng: np.random.Generator) -> frozenset[str]:
    """Grow a set by the state that leaves the largest margin, from several first ones."""
    best: frozenset[str] = frozenset()
    for first in rng.permutation(len(names))[:STARTS]:
        some = frozenset([names[first]])
        while True:
            more = [(pool.margin(some | {n}), n) for n in names if n not in some]
            if not more or max(more)[0] <= 0:
                break
            some = some | {max(more)[1]}
        if not best or (len(some), pool.margin(some)) > (len(best), pool.margin(best)):
            best = some
    return best


def _exact(pool: _Pool, names: list[str], best: frozenset[str]) -> frozenset[str]:
    """Look through all sets, depth first, each in the order of the names."""
    pairs = {
        frozenset(p) for p in itertools.combinations(names, 2) if pool.margin(frozenset(p)) > 0
    }

    def grow(some: frozenset[str], rest: list[str]) -> None:
        nonlocal best
        if some and (len(some), pool.margin(some)) > (len(best), pool.margin(best)):
            best = some
        for k, name in enumerate(rest):
            # bound: with all that is left the set would not be larger
            if len(some) + len(rest) - k < len(best):
                return
            if pool.margin(some | {name}) > 0:
                # a set with a pair that cannot be held together cannot be held either
                after = [n for n in rest[k + 1 :] if frozenset((name, n)) in pairs]
                grow(some | {name}, after)

    grow(frozenset(), names)
    return best
