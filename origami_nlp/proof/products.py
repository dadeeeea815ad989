"""All minima of a sheet whose vertices fold flat, with cycles or without: opposite sectors sum to 180 degrees.

Round a flat vertex with creases 1..4 and sectors a_1 + a_3 = pi = a_2 + a_4 the law of cosines across says phi_3 =
+-phi_1 and phi_4 = +-phi_2, and the product of the four unit quaternions that either phi_3 = phi_1 and phi_4 = -phi_2
(sign 1), or phi_3 = -phi_1 and phi_4 = phi_2 (sign -1), and

    sin(phi_1/2) cos(phi_2/2) cos((a_1 + a_2)/2) = -cos(phi_1/2) sin(phi_2/2) cos((a_1 - a_2)/2),
    sin(phi_1/2) cos(phi_2/2) sin((a_1 + a_2)/2) = cos(phi_1/2) sin(phi_2/2) sin((a_1 - a_2)/2)

with these signs, and nothing else.  So |phi| is one along each row of opposite creases.  Each row is first said to be
0, at +-180 degrees, or neither: every closed state is in one of these 3^rows sets alone.  In each, rows that are
neither move together in tangents T of half their angles, by multipliers whose product round each loop is 1, and the
energy is a sum over groups of them.  A state is a minimum if it is one along its groups, and if the energy grows as any
rows that are 0, or at +-180 degrees, and that can move together, begin to.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_series

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.proof.certificate import ProvedState, Region
from origami_nlp.proof.sheets import (
    TERMS,
    Budget,
    Equal,
    FlatSheet,
    Look,
    VertexRound,
    closer,
    least,
    sign_of,
    state_of,
)

MOST_WAYS = 20_000
"""Of signs of vertices, over all sets of rows that are 0, at +-180 degrees, or neither."""
ZERO, TURNED, FREE = range(3)
Ratio = tuple[int, np.ndarray]
"""A sign, and powers of quantities."""


class Cross(NamedTuple):
    """A vertex: creases, its two rows, which of these are straight, and of each sign the multiplier T_2 = m T_1."""

    creases: tuple[int, ...]
    rows: tuple[int, int]
    straight: tuple[bool, bool]
    multipliers: dict[int, Ratio]


Group = tuple[tuple[int, int, tuple[int, ...]], ...]
"""Creases that move together: each with the sign and the quantities of its multiplier."""


class FoldingSheet:
    """A sheet that folds flat: its vertices and rows, by how much relations that are taken as exact fail."""

    folds_flat = True

    def __init__(self, sheet: FlatSheet) -> None:
        self.sheet, self.pattern, rounds = sheet, sheet.pattern, sheet.rounds
        row = list(range(self.pattern.creases))
        for one in rounds:
            for a, b in (one.creases[::2], one.creases[1::2]):
                row = [row[a] if r == row[b] else r for r in row]
        self.rows = sorted(set(row))
        self.row = [self.rows.index(r) for r in row]
        equal = Equal()
        self.crossings = [self._cross(one, equal) for one in rounds]
        self.quantities = [q + equal.slack for q in equal.known]
        self.deviation, self.unsure = equal.deviation, ""

    def _cross(self, one: VertexRound, equal: Equal) -> Cross:
        a = one.sectors
        equal.deviates(a[0] + a[2] - arb.pi())
        total, apart = (a[0] + a[1]) / 2, (a[0] - a[1]) / 2
        straight = []
        for off in (total - arb.pi() / 2, apart):
            straight.append(bool(abs(off) <= CLOSURE_TOL))
            if straight[-1]:
                equal.deviates(2 * off)
        multipliers = {}
        for line, sign, turn, above, below in (
            (0, 1, -total.cos(), total.cos(), apart.cos()),
            (1, -1, apart, total.sin(), apart.sin()),
        ):
            if not straight[line]:
                ratio = np.zeros(4 * len(self.sheet.rounds), dtype=int)
                ratio[equal.of(abs(above))] += 1
                ratio[equal.of(abs(below))] -= 1
                multipliers[sign] = sign_of(turn), ratio
        rows = self.row[one.creases[0]], self.row[one.creases[1]]
        return Cross(one.creases, rows, (straight[0], straight[1]), multipliers)

    def search(self, budget: Budget) -> ProductSearch:
        """Return what goes through its closed states."""
        return ProductSearch(self, budget)

    @property
    def kinds(self) -> Iterator[tuple[int, ...]]:
        """Of rows, all sets."""
        return itertools.product(range(3), repeat=len(self.rows))

    def value(self, powers: Sequence[int]) -> Any:
        """Return a multiplier."""
        value = arb(1)
        for quantity, power in zip(self.quantities, powers, strict=False):
            value *= quantity ** int(power)
        return value

    def signs(self, kinds: Sequence[int]) -> list[list[int]]:
        """Return the signs that vertices may have where rows are 0, at +-180 degrees, or neither."""
        ways: list[list[int]] = []
        for c in self.crossings:
            one, two = (kinds[r] for r in c.rows)
            if one == two:
                either = [s for s in (1, -1) if one != FREE or s in c.multipliers]
                ways.append(either if one else [0])
            elif two == ZERO or (one == TURNED and two == FREE):
                ways.append([1] if c.straight[0] else [])
            else:
                ways.append([-1] if c.straight[1] else [])
        return ways

    def together(
        self, rows: set[int], signs: Sequence[int], moving: set[int]
    ) -> list[dict[int, Ratio]] | None:
        """Return creases of rows in groups, with signs along them, and multipliers between those that are moving.

        None where vertices of these signs contradict each other, or that is not certain (`unsure`).
        """
        none = np.zeros(4 * len(self.sheet.rounds), dtype=int)
        links: dict[int, list[tuple[int, int, np.ndarray]]] = {}
        for c, s in zip(self.crossings, signs, strict=True):
            edges = [
                (c.creases[i], c.creases[i + 2], sign, none)
                for i, sign in ((0, s), (1, -s))
                if c.rows[i] in rows
            ]
            if {*c.rows} <= moving:
                edges.append((c.creases[0], c.creases[1], *c.multipliers[s]))
            for a, b, sign, ratio in edges:
                links.setdefault(a, []).append((b, sign, ratio))
                links.setdefault(b, []).append((a, sign, -ratio))
        groups, met = [], set[int]()
        for first in (c for c, r in enumerate(self.row) if r in rows):
            if first in met:
                continue
            found: dict[int, Ratio] = {first: (1, none)}
            front = [first]
            for a in front:
                for b, sign, ratio in links.get(a, ()):
                    there = found[a][0] * sign, found[a][1] + ratio
                    if b not in found:
                        found[b] = there
                        front.append(b)
                        continue
                    left = there[1] - found[b][1]
                    value = self.value(left.tolist())
                    if there[0] != found[b][0] or value != 1:
                        return None
                    if left.any():
                        self.unsure = f"whether a loop moves, whose product is {value.str(5)}"
                        return None
            met |= {*found}
            groups.append(found)
        return groups


def as_folding(sheet: FlatSheet) -> tuple[FoldingSheet | None, str]:
    """Return a sheet that folds flat, or None and why its states are not enumerated."""
    found = FoldingSheet(sheet)
    many = 0
    for kinds in found.kinds:
        many += math.prod(map(len, found.signs(kinds)))
        if many > MOST_WAYS:
            return None, f"{len(sheet.rounds)} vertices can fold in more than {MOST_WAYS} ways"
    return found, ""


class GroupEnergy:
    """The energy of creases that move together, in T or, near a side of 180 degrees, in 1/T.

    Attributes
    ----------
    even
        Whether it is even in T: U' is 0 at T = 0.
    """

    def __init__(self, sheet: FoldingSheet, group: Group) -> None:
        self.group = [(c, sign, sheet.value(powers)) for c, sign, powers in group]
        sums: dict[Any, list[Any]] = {}
        for c, sign, powers in group:
            k, rest = (arb(float(v[c])) for v in (sheet.pattern.stiffness, sheet.pattern.rest))
            both = sums.setdefault(powers, [arb(0), arb(0)])
            both[0] += k
            both[1] += k * sign * rest
        self.even = all(load == 0 for _, load in sums.values())
        self.terms = [(sheet.value(p), *both) for p, both in sums.items()]

    def slopes(self, side: int, t: Any) -> tuple[Any, Any]:
        """Return U' and U'' at T = t, or on a side of 180 degrees at T = 1/t."""
        first, second = arb(0), arb(0)
        for m, k, load in self.terms:
            x = _fold(m, side, arb_series([t, 1], TERMS))
            first += (k * x[0] - load) * x[1]
            second += k * x[1] * x[1] + 2 * (k * x[0] - load) * x[2]
        return first, second

    def over(self, side: int, x: Any) -> Look:
        """Return U' and U'' as a curve has them."""
        first, second = self.slopes(side, x)
        middle = self.slopes(side, x.mid())[0]
        return Look(closer(first, middle + second * (x - x.mid())), second, {})

    def angles(self, side: int, t: Any) -> dict[int, Any]:
        """Return the folds there."""
        return {c: sign * _fold(m, side, arb_series([t], 1))[0] for c, sign, m in self.group}


def _fold(m: Any, side: int, t: Any) -> Any:
    return side * arb.pi() - 2 * (t / m).atan() if side else 2 * (m * t).atan()


class ProductSearch:
    """All sets of rows that are 0, at +-180 degrees or neither, and the minima in them.

    Attributes
    ----------
    minima, open
        What is shown, and what is left.
    """

    def __init__(self, sheet: FoldingSheet, budget: Budget) -> None:
        self.sheet, self.budget = sheet, budget
        self.minima: list[ProvedState] = []
        self.open: list[Region] = []
        self._known: dict[Group, tuple[GroupEnergy, list[tuple[int, Any]]]] = {}

    @property
    def over(self) -> str:
        """Over which states the statement ranges, in words."""
        return f"products of {len(self._known)} curves, along which tangents of half the fold angles are proportional"

    def run(self) -> None:
        """Go through all sets."""
        for kinds in self.sheet.kinds:
            if self.budget.late():
                self._leave("time was over")
                return
            for signs in itertools.product(*self.sheet.signs(kinds)):
                self._set(kinds, signs)
            if self.sheet.unsure:
                self._leave(self.sheet.unsure)
                self.sheet.unsure = ""

    def _set(self, kinds: Sequence[int], signs: Sequence[int]) -> None:
        free, turned = ({r for r, k in enumerate(kinds) if k == kind} for kind in (FREE, TURNED))
        groups = self.sheet.together(free | turned, signs, free)
        if groups is None:
            return
        at: list[list[dict[int, Any]]] = []
        for group in groups:
            if self.sheet.row[min(group)] in turned:
                at.append([{c: s * arb.pi() * x for c, (x, _) in group.items()} for s in (1, -1)])
            else:
                energy, zeros = self._stationary(group)
                at.append([energy.angles(*zero) for zero in zeros])
        for parts in itertools.product(*at):
            folds = {c: x for part in parts for c, x in part.items()}
            every = [folds.get(c, arb(0)) for c in range(len(self.sheet.row))]
            if self._stays(kinds, every):
                exactly = {
                    c: math.copysign(math.pi, float(x.mid()))
                    for c, x in folds.items()
                    if self.sheet.row[c] in turned
                }
                self.minima.append(state_of(every, exactly))

    def _stationary(self, found: dict[int, Ratio]) -> tuple[GroupEnergy, list[tuple[int, Any]]]:
        """Return the energy of a group, and where it is least inside: 0 and T, or a side of 180 degrees and 1/T."""
        group = tuple((c, s, tuple(p.tolist())) for c, (s, p) in sorted(found.items()))
        if group in self._known:
            return self._known[group]
        energy, zeros = GroupEnergy(self.sheet, group), list[tuple[int, Any]]()
        for side, low, high in ((0, -1.0, 1.0), (-1, -1.0, 0.0), (1, 0.0, 1.0)):
            rests = energy.even and not side
            known = least(partial(energy.over, side), low, high, self.budget, rests)
            for _, _, why in known.open:
                self._leave(f"where the energy is least along a curve: {why}")
            for a, b, _ in known.minima:
                zero = arb(a).union(arb(b))
                if sign_of(zero):
                    zeros.append((side, zero))
                else:
                    self._leave("whether a state is flat, or at 180 degrees")
        self._known[group] = energy, zeros
        return energy, zeros

    def _leave(self, why: str) -> None:
        low, high = (np.full(len(self.sheet.row), s * math.pi) for s in (-1, 1))
        self.open.append(Region(low, high, why))

    def _stays(self, kinds: Sequence[int], folds: Sequence[Any]) -> bool:
        """Return whether the energy grows as rows that are 0, or at +-180 degrees, begin to move."""
        for kind in (ZERO, TURNED):
            rows = [r for r, k in enumerate(kinds) if k == kind]
            for many in range(1, len(rows) + 1):
                for some in itertools.combinations(rows, many):
                    for slope in self._leaving({*some}, kind, kinds, folds):
                        if not slope:
                            self._leave("whether the energy falls from a state along a curve")
                        if slope <= 0:
                            return False
        return True

    def _leaving(
        self, some: set[int], kind: int, kinds: Sequence[int], folds: Sequence[Any]
    ) -> Iterator[int]:
        """Yield the sign of the slope of the energy for each way in which these rows move all at once."""
        signs = [sign_of(f) for f in folds]
        freed = [FREE if r in some else k for r, k in enumerate(kinds)]
        ways = []
        for c, allowed in zip(self.sheet.crossings, self.sheet.signs(freed), strict=True):
            s = [signs[x] for x in c.creases]
            fits = [x for x in allowed if s[2] == x * s[0] and s[3] == -x * s[1]]
            ways.append(fits if some & {*c.rows} else [0])
        for way in itertools.product(*ways):
            groups = self.sheet.together(some, way, some)
            if groups is None or len(groups) > 1:
                continue
            energy, _ = self._stationary(groups[0])
            if kind == ZERO:
                slope, bend = energy.slopes(0, arb(0))
                yield sign_of(bend) if energy.even else -abs(sign_of(slope))
                continue
            sides = {signs[c] * sign for c, (sign, _) in groups[0].items()}
            if len(sides) == 1:
                (side,) = sides
                yield side * sign_of(energy.slopes(side, arb(0))[0])
