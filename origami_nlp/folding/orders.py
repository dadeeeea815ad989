"""Truth values that tables of constraints allow together: propagation, and search where that does not decide.

A table names a few unknowns and lists the values that they may take together.  Rules are looked up, not derived: what
the known values of a table force is the same wherever a table of that kind stands.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from functools import lru_cache
from typing import Generic, TypeVar

Name = TypeVar("Name", bound=Hashable)
Values = list[int]
"""Of each unknown: 0, 1, or -1 while it is not known."""


class Tables(Generic[Name]):
    """Tables made ready for questions: unknowns numbered, and the tables that name each of them.

    Parameters
    ----------
    tables
        Each a tuple of unknowns (anything hashable) and the values that they may take together.
    """

    def __init__(
        self, tables: Iterable[tuple[tuple[Name, ...], frozenset[tuple[bool, ...]]]]
    ) -> None:
        self.number: dict[Name, int] = {}
        self.rules: list[tuple[tuple[int, ...], frozenset[int]]] = []
        for names, allowed in tables:
            unknowns = tuple(self.number.setdefault(n, len(self.number)) for n in names)
            self.rules.append((unknowns, _bits(allowed)))
        self.used: list[list[int]] = [[] for _ in self.number]
        for k, (unknowns, _) in enumerate(self.rules):
            for u in unknowns:
                self.used[u].append(k)


class Orders(Generic[Name]):
    """Answers of one set of tables; every answer found is kept, since it also answers later questions.

    Parameters
    ----------
    tables
        The constraints.
    fixed
        Values that are given.
    """

    def __init__(self, tables: Tables[Name], fixed: Mapping[Name, bool]) -> None:
        self._number, self._tables, self._used = tables.number, tables.rules, tables.used
        self._free = {name: value for name, value in fixed.items() if name not in self._number}
        start = [-1] * len(self._number)
        pending = set(range(len(self._tables)))
        good = self._assign(start, self._known(fixed)) and self._propagate(start, pending)
        self._start: Values | None = start if good else None
        self._answers: list[Values] = []
        self._impossible: set[tuple[int, int]] = set()

    def _known(self, values: Mapping[Name, bool]) -> list[tuple[int, int]]:
        return [(self._number[n], int(v)) for n, v in values.items() if n in self._number]

    def possible(self, assume: Mapping[Name, bool]) -> bool:
        """Tell whether there is an answer with the values in `assume`."""
        if any(self._free.get(name, value) != value for name, value in assume.items()):
            return False
        known = self._known(assume)
        if any(all(answer[u] == v for u, v in known) for answer in self._answers):
            return True
        if not self._impossible.isdisjoint(known):
            return False
        if self._find(known) is not None:
            return True
        if len(known) == 1:
            self._impossible.add(known[0])
        return False

    def answer(self) -> dict[Name, bool] | None:
        """Return the first answer in the order of the tables, false before true; None where there is none."""
        found = self._find(())
        if found is None:
            return None
        named = {name: bool(found[k]) for name, k in self._number.items()}
        return {**named, **self._free}

    def _find(self, known: Iterable[tuple[int, int]]) -> Values | None:
        if self._start is None:
            return None
        values = list(self._start)
        found = self._search(values) if self._assign(values, known) else None
        if found is not None:
            self._answers.append(found)
        return found

    def _search(self, values: Values) -> Values | None:
        """Decide the unknowns that are left one after the other; `values` agree with every table so far."""
        for unknowns, _ in self._tables:
            for u in unknowns:
                if values[u] < 0:
                    for v in (0, 1):
                        trial = list(values)
                        found = self._search(trial) if self._assign(trial, [(u, v)]) else None
                        if found is not None:
                            return found
                    return None
        return values

    def _assign(self, values: Values, known: Iterable[tuple[int, int]]) -> bool:
        """Set values and what follows from them (in place); False where they contradict each other."""
        pending: set[int] = set()
        for u, v in known:
            if values[u] < 0:
                values[u] = v
                pending.update(self._used[u])
            elif values[u] != v:
                return False
        return self._propagate(values, pending)

    def _propagate(self, values: Values, waiting: set[int]) -> bool:
        """Look at the tables `waiting`, and at those of every value that follows."""
        while waiting:
            unknowns, allowed = self._tables[waiting.pop()]
            mask = value = 0
            for k, u in enumerate(unknowns):
                if values[u] >= 0:
                    mask |= 1 << k
                    value |= values[u] << k
            forced = _forced(allowed, mask, value, len(unknowns))
            if forced is None:
                return False
            for k, v in forced:
                u = unknowns[k]
                if values[u] < 0:
                    values[u] = v
                    waiting.update(self._used[u])
                elif values[u] != v:  # the same unknown twice in a table
                    return False
        return True


@lru_cache(maxsize=4096)
def _bits(allowed: frozenset[tuple[bool, ...]]) -> frozenset[int]:
    """Write each tuple of values as one number, the first value as the lowest bit."""
    return frozenset(sum(int(v) << k for k, v in enumerate(values)) for values in allowed)


@lru_cache(maxsize=65536)
def _forced(
    allowed: frozenset[int], mask: int, value: int, count: int
) -> tuple[tuple[int, int], ...] | None:
    """Return the positions, with their values, that the known ones (mask, value) leave no choice; None: no fit."""
    fits = [v for v in allowed if v & mask == value]
    if not fits:
        return None
    both, either = fits[0], fits[0]
    for v in fits:
        both &= v
        either |= v
    free = (k for k in range(count) if not mask >> k & 1)
    return tuple((k, both >> k & 1) for k in free if (both >> k & 1) == (either >> k & 1))
