"""Which of two layers is above, for many pairs at once: rules propagated, parts that share no rule searched one by one.

An unknown is a truth value: the first of a pair lies above, or left of, the second.  A rule names a few unknowns and
lists the values that they may take together, so that what known values force is looked up, not derived: it is the same
wherever a rule of that kind stands.  Two rules are those of every stack of paper: an order is transitive, and two
passages of paper through a line (or a point of a polygon) do not interleave.
"""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache

MOST_NODES = 5_000
"""Guesses of a search in each part, where there may be many."""

Allowed = frozenset[tuple[bool, ...]]
Rule = tuple[tuple[int, ...], Allowed]
"""Unknowns, and the values that they may take together."""
Values = list[int]
"""Of each unknown: 0, 1, or -1 while it is not known."""

TRANSITIVE: Allowed = frozenset(
    v
    for v in itertools.product((False, True), repeat=3)
    if v not in ((True, True, False), (False, False, True))
)
"""Values of a < b, b < c, a < c: not a < b < c < a, nor its mirror image."""


class Rules:
    """Rules made ready for questions.

    Parameters
    ----------
    count
        Number of unknowns.
    rules
        What their values must obey.
    """

    def __init__(self, count: int, rules: Iterable[Rule]) -> None:
        self.rules = [(unknowns, _table(allowed, len(unknowns))) for unknowns, allowed in rules]
        self.of: list[list[int]] = [[] for _ in range(count)]
        for k, (unknowns, _) in enumerate(self.rules):
            for u in unknowns:
                self.of[u].append(k)


class Orders:
    """Unknowns under rules; every answer found is kept, since it also answers later questions.

    Parameters
    ----------
    rules
        What their values must obey.
    most
        Guesses of a search in each part; with more it is given up.

    Attributes
    ----------
    values
        What is known so far.
    """

    def __init__(self, rules: Rules, most: float = math.inf) -> None:
        self._rules, self._of, self._most = rules.rules, rules.of, most
        self.values: Values = [-1] * len(self._of)

    def copied(self) -> Orders:
        """Return the same unknowns, whose values may be set apart from these."""
        other = copy.copy(self)
        other.values = list(self.values)
        return other

    def settle(self) -> int:
        """Fill in what all rules force; the rule that cannot be obeyed, or -1."""
        return self._propagate(self.values, range(len(self._rules)))

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
            first = next(self._each(part), None)
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
        counts = self.counts()
        if not all(whole for _, _, whole in counts):
            raise TimeoutError
        return math.prod(many for _, many, _ in counts)

    def counts(self) -> list[tuple[list[int], int, bool]]:
        """Count the answers of each part of the unknowns that rules leave open; parts share no rule.

        Returns
        -------
        list of tuple
            Unknowns, number of their answers, and whether it is the number, or only one that is no larger since the
            guesses were used up.  A part of no unknowns without answer where what is known contradicts itself.
        """
        if self.settle() >= 0:
            return [([], 0, True)]
        found = []
        for part in self._parts():
            guesses = [self._most]
            found.append((part, self._many(self.values, part, guesses), guesses[0] >= 0))
        return found

    def answers(self, part: Sequence[int]) -> Iterator[list[bool]]:
        """Go through the answers of one part of `counts`, false before true.

        Raises
        ------
        TimeoutError
            If the search is given up.
        """
        for values in self._each(part):
            yield [bool(values[u]) for u in part]

    def _many(self, values: Values, part: Sequence[int], guesses: list[float]) -> int:
        """Count the answers of a part: what a guess leaves open falls into parts again, which combine freely."""
        guesses[0] -= 1
        if guesses[0] < 0:
            return 0
        total = 0
        for guess in (0, 1):
            more = list(values)
            more[part[0]] = guess
            if self._propagate(more, self._of[part[0]]) < 0:
                many = 1
                for one in self._parts(more, part):
                    many *= self._many(more, one, guesses)
                    if not many:
                        break
                total += many
        return total

    def _parts(
        self, values: Values | None = None, among: Sequence[int] | None = None
    ) -> list[list[int]]:
        """Return the unknowns that are left, in groups that share no rule; of each group the most bound first."""
        known = self.values if values is None else values
        groups, seen = [], set[int]()
        for first in range(len(known)) if among is None else sorted(among):
            if first in seen or known[first] >= 0:
                continue
            group, todo = [], [first]
            seen.add(first)
            while todo:
                group.append(todo.pop())
                for k in self._of[group[-1]]:
                    unknowns, table = self._rules[k]
                    code = 0
                    for u in unknowns:
                        code = 3 * code + known[u]
                    if table.binds[code]:  # else any values of those that are left obey it
                        new = {u for u in unknowns if known[u] < 0} - seen
                        seen |= new
                        todo += new
            groups.append(sorted(group, key=lambda u: (-len(self._of[u]), u)))
        return groups

    def _each(self, part: Sequence[int]) -> Iterator[Values]:
        """Go through the answers of one part, depth first, false before true."""
        nodes, stack = 0, [list(self.values)]
        while stack:
            values = stack.pop()
            unknown = next((u for u in part if values[u] < 0), None)
            if unknown is None:
                yield values
                continue
            nodes += 1
            if nodes > self._most:
                raise TimeoutError
            # last in, first out: 0 is looked at first
            for guess in (1, 0):
                more = list(values)
                more[unknown] = guess
                if self._propagate(more, self._of[unknown]) < 0:
                    stack.append(more)

    def _propagate(self, values: Values, waiting: Iterable[int]) -> int:
        """Fill in what rules force, in place: the rule that cannot be obeyed, or -1."""
        pending = dict.fromkeys(waiting)
        rules, of = self._rules, self._of
        while pending:
            k, _ = pending.popitem()
            unknowns, table = rules[k]
            code = 0
            for u in unknowns:
                code = 3 * code + values[u]
            forced = table[code]
            if forced is None:
                return k
            for n, v in forced:
                u = unknowns[n]
                if values[u] == 1 - v:  # the same unknown twice in a rule
                    return k
                values[u] = v
                pending.update(dict.fromkeys(of[u]))
        return -1


Forced = tuple[tuple[int, int], ...]


class _Table(dict[int, Forced | None]):
    """What a rule forces: positions with their values, by the values that are known; None: they disobey it.

    Known values are written as one number, in digits 1, 0 and -1 (unknown) to the base 3, the first value highest.
    """

    def __init__(self, allowed: Allowed, count: int) -> None:
        self.allowed, self.count = allowed, count
        self.binds = _Binds(self)

    def __missing__(self, code: int) -> Forced | None:
        known, fits = self.fitting(code)
        free = [k for k, v in enumerate(known) if v < 0]
        # a value that is the same in all that fits is forced
        one = [(k, {int(v[k]) for v in fits}) for k in free]
        self[code] = tuple((k, v.pop()) for k, v in one if len(v) == 1) if fits else None
        return self[code]

    def fitting(self, code: int) -> tuple[list[int], list[tuple[bool, ...]]]:
        """Return the values that a number writes, and all that are allowed with them."""
        known = []
        for _ in range(self.count):
            digit = (code + 1) % 3 - 1
            known.append(digit)
            code = (code - digit) // 3
        known.reverse()
        fits = [
            values
            for values in self.allowed
            if all(k in (-1, int(v)) for k, v in zip(known, values, strict=True))
        ]
        return known, fits


class _Binds(dict[int, bool]):
    """Whether a rule says anything of the values that are not known."""

    def __init__(self, table: _Table) -> None:
        self.table = table

    def __missing__(self, code: int) -> bool:
        known, fits = self.table.fitting(code)
        self[code] = len(fits) < 2 ** known.count(-1)
        return self[code]


@lru_cache(maxsize=4096)
def _table(allowed: Allowed, count: int) -> _Table:
    return _Table(allowed, count)


@lru_cache(maxsize=4096)
def not_interleaved(
    rays: tuple[int, ...], pairs: tuple[tuple[int, int, int, bool], ...]
) -> Allowed:
    """Return the values of unknowns for which two passages do not interleave: ends 0, 1 of one and 2, 3 of the other.

    Parameters
    ----------
    rays
        Of each of the four ends the place of its half line, counter-clockwise; ends on one half line are compared.
    pairs
        Of ends k < m on one half line: k, m, the position of their unknown, and whether its being true means that k
        comes first.

    Returns
    -------
    frozenset of tuple of bool
        In the order of the unknowns.
    """
    allowed = set()
    for values in itertools.product(
        (False, True), repeat=1 + max((p[2] for p in pairs), default=-1)
    ):
        level = {(k, m): values[which] == first for k, m, which, first in pairs}
        place = [0] * 4
        for k, m in itertools.combinations(range(4), 2):
            ahead = level[k, m] if (k, m) in level else rays[k] < rays[m]
            place[m if ahead else k] += 1
        if sorted(place) != [0, 1, 2, 3]:
            continue  # not an order: transitivity forbids these values anyway
        # ends in cyclic order: two passages interleave where exactly one end of the other lies between those of the
        # first
        low, high = sorted(place[:2])
        if sum(low < p < high for p in place[2:]) != 1:
            allowed.add(values)
    return frozenset(allowed)


def tied(unknowns: tuple[int, ...], allowed: Allowed) -> Rule:
    """Return a rule in which an unknown may occur several times as one in which each occurs once.

    Parameters
    ----------
    unknowns
        Of the rule, some of them equal.
    allowed
        Values that they may have together.

    Returns
    -------
    Rule
        On each unknown once; values that give an unknown two values are left out.
    """
    once = tuple(dict.fromkeys(unknowns))
    if len(once) == len(unknowns):
        return unknowns, allowed
    values = (dict(zip(unknowns, v, strict=True)) for v in allowed)
    agree = (d for d, v in zip(values, allowed, strict=True) if v == tuple(d[u] for u in unknowns))
    return once, frozenset(tuple(d[u] for u in once) for d in agree)
