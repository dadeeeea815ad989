"""Which of two layers is above, for many pairs at once: rules propagated, parts that share no rule searched one by one.

An unknown is true where the first of its pair is above.  A rule names a few unknowns and lists the values that they
may take together, so that what known values force is looked up, not derived.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache

import numpy as np

MOST_NODES = 5_000
"""Guesses of a search in each part."""

Rule = tuple[tuple[int, ...], frozenset[tuple[bool, ...]]]
"""Unknowns, and the values that they may take together."""


class Orders:
    """Unknowns under rules.

    Parameters
    ----------
    count
        Number of unknowns.
    rules
        What their values must obey.
    """

    def __init__(self, count: int, rules: Sequence[Rule]) -> None:
        self.rules = rules
        self.values = [-1] * count
        self._of: list[list[int]] = [[] for _ in range(count)]
        for k, (unknowns, _) in enumerate(rules):
            for u in unknowns:
                self._of[u].append(k)

    def settle(self) -> int:
        """Fill in what all rules force; the rule that cannot be obeyed, or -1."""
        return self._propagate(self.values, range(len(self.rules)))

    def assume(self, known: Mapping[int, bool]) -> int:
        """Set unknowns, and what follows: the rule that cannot be obeyed, or -1; -2 where a value was forced before.

        Parameters
        ----------
        known
            Values of unknowns.
        """
        if any(self.values[u] == 1 - v for u, v in known.items()):
            return -2
        for u, v in known.items():
            self.values[u] = int(v)
        return self._propagate(self.values, [k for u in known for k in self._of[u]])

    def solve(self) -> list[bool] | None:
        """Return values that obey every rule, None where there are none.

        Raises
        ------
        TimeoutError
            If the search is given up.
        """
        if self.settle() >= 0:
            return None
        found = list(self.values)
        for part in self._parts():
            first = next(self._answers(part), None)
            if first is None:
                return None
            for u in part:
                found[u] = first[u]
        return [bool(v) for v in found]

    def count(self) -> int:
        """Return how many answers there are.

        Raises
        ------
        TimeoutError
            If the search is given up.
        """
        if self.settle() >= 0:
            return 0
        total = 1
        for part in self._parts():
            total *= sum(1 for _ in self._answers(part))
        return total

    def _parts(self) -> list[list[int]]:
        """Return the unknowns that are left, in groups that share no rule; of each group the most bound first."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        left = [u for u, v in enumerate(self.values) if v < 0]
        if not left:
            return []
        links = []
        for unknowns, _ in self.rules:
            open_ones = [u for u in unknowns if self.values[u] < 0]
            links += [(open_ones[0], u) for u in open_ones[1:]]
        i, j = np.array(links, int).reshape(-1, 2).T
        size = len(self.values)
        _, label = connected_components(coo_array((np.ones(len(i)), (i, j)), shape=(size, size)))
        groups: dict[int, list[int]] = {}
        for u in left:
            groups.setdefault(int(label[u]), []).append(u)
        return [sorted(g, key=lambda u: -len(self._of[u])) for g in groups.values()]

    def _answers(self, part: Sequence[int]) -> Iterator[list[int]]:
        """Go through the answers of one part, depth first."""
        nodes, stack = 0, [list(self.values)]
        while stack:
            values = stack.pop()
            unknown = next((u for u in part if values[u] < 0), None)
            if unknown is None:
                yield values
                continue
            nodes += 1
            if nodes > MOST_NODES:
                raise TimeoutError
            for guess in (1, 0):
                more = list(values)
                more[unknown] = guess
                if self._propagate(more, self._of[unknown]) < 0:
                    stack.append(more)

    def _propagate(self, values: list[int], waiting: Iterable[int]) -> int:
        """Fill in what rules force, in place: the rule that cannot be obeyed, or -1."""
        pending = dict.fromkeys(waiting)
        while pending:
            k, _ = pending.popitem()
            unknowns, allowed = self.rules[k]
            forced = _forced(allowed, tuple(values[u] for u in unknowns))
            if forced is None:
                return k
            for n, v in forced:
                u = unknowns[n]
                values[u] = v
                pending.update(dict.fromkeys(self._of[u]))
        return -1


@lru_cache(maxsize=65536)
def _forced(
    allowed: frozenset[tuple[bool, ...]], known: tuple[int, ...]
) -> tuple[tuple[int, int], ...] | None:
    """Return the places, with their values, that known values (-1: not known) leave no choice; None: no fit."""
    fits = [v for v in allowed if all(k < 0 or k == a for k, a in zip(known, v, strict=True))]
    if not fits:
        return None
    free = (n for n, k in enumerate(known) if k < 0)
    return tuple((n, int(fits[0][n])) for n in free if len({v[n] for v in fits}) == 1)
