"""The check of a proof of a mesh whose vertices fold flat: all closed states and their minima, found again.

The statement.  Round a flat vertex with creases 1..4 and sectors a_1 + a_3 = pi = a_2 + a_4 every closed state has
phi_3 = phi_1 and phi_4 = -phi_2, or phi_3 = -phi_1 and phi_4 = phi_2, and there

    sin(phi_1/2) cos(phi_2/2) cos((a_1 + a_2)/2) = -cos(phi_1/2) sin(phi_2/2) cos((a_1 - a_2)/2), or
    sin(phi_1/2) cos(phi_2/2) sin((a_1 + a_2)/2) = cos(phi_1/2) sin(phi_2/2) sin((a_1 - a_2)/2).

Here each row of opposite creases is first said to be 0, at +-180 degrees, or neither: every closed state is in one of
these 3^rows sets alone.  In each, rows that are neither move together in tangents T of half their angles, and are
stationary at zeros of U'(T) for |T| <= 1, or of U'(1/T), found with power series over balls (python-flint).  Then each
set of rows that are 0, or at +-180 degrees, and can move together is asked whether the energy falls as they do.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from flint import arb, arb_series

from origami_nlp.proof.check_lists import STATED, ListCheck, Refused, precision, refuse_wide
from origami_nlp.proof.check_sheet import FlatDisk, product_round
from origami_nlp.proof.mesh_certificate import MeshCertificate

EXACT = 1e-12
"""Deviation from exact relations, beyond which a file is not of the sheet that is meant [rad]."""
DEPTH = 50
"""Halvings of an interval of T, at most."""
PIECES = 4_000
"""Intervals of T of one curve that are looked at, at most: a file must not keep the check for ever."""
ZERO, TURNED, FREE = range(3)


class Cross(NamedTuple):
    """A vertex: creases, its two rows, which of these are straight, and of each sign the multiplier T_2 = m T_1."""

    creases: tuple[int, ...]
    rows: tuple[int, int]
    straight: tuple[bool, bool]
    multipliers: dict[int, tuple[int, Counter[int]]]
    directions: list[tuple[Any, Any]]


class RowGroup(NamedTuple):
    """Rows that move together: of each crease its row, and the sign and the quantities of its multiplier."""

    creases: tuple[tuple[int, int, int, tuple[tuple[int, int], ...]], ...]


class MeshCheck(ListCheck):
    """Find again what a certificate claims.

    Parameters
    ----------
    said
        The certificate.
    progress
        Called with the sets of closed states that are done and their number.
    """

    def __init__(self, said: MeshCertificate, progress: Callable[[int, int], object]) -> None:
        super().__init__(said)
        self.progress = progress
        self.counts = {"sets": 0, "curves": 0}
        self._zeros: dict[RowGroup, list[tuple[int, Any]]] = {}

    @precision()
    def run(self) -> None:
        """Decide every claim.

        Raises
        ------
        Refused
            With the first that is wrong.
        """
        self._sheet()
        found = []
        total = 3 ** len(self.rows)
        for done, kinds in enumerate(itertools.product(range(3), repeat=len(self.rows))):
            found += list(self._set(kinds))
            self.progress(done + 1, total)
        self.hold(found)

    def _sheet(self) -> None:
        self.disk = FlatDisk(self.said)
        refuse_wide(self.said.minima)
        rings = {v: self.disk.round(v) or [] for v in sorted(self.disk.inside)}
        n = len(self.said.creases)
        row = list(range(n))
        for v, ring in rings.items():
            if len(ring) != 4:
                raise Refused(f"vertex {v} has not four creases")
            own = [self.disk.crease[frozenset((v, w))] for w in ring]
            for a, b in (own[::2], own[1::2]):
                row = [row[a] if r == row[b] else r for r in row]
        self.rows = sorted(set(row))
        self.row = [self.rows.index(r) for r in row]
        self.off = 0.0
        self.quantities: list[Any] = []
        self.crossings = [self._cross(v, ring) for v, ring in rings.items()]
        if self.off > min(1.01 * self.said.deviation, EXACT):
            raise Refused(
                f"vertices fold flat, and equal sectors are equal, to {self.off:.2g} rad only, "
                f"not {self.said.deviation:.2g}"
            )
        slack = arb(0, 4 * self.said.deviation)
        self.quantities = [q + slack for q in self.quantities]

    def _cross(self, v: int, ring: Sequence[int]) -> Cross:
        u = []
        for w in ring:
            away = [self.disk.points[w][i] - self.disk.points[v][i] for i in (0, 1)]
            x, y = (arb(z.numerator) / arb(z.denominator) for z in away)
            length = (x * x + y * y).sqrt()
            u.append((x / length, y / length))
        sectors = [
            arb.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])
            for a, b in zip(u, u[1:] + u[:1], strict=True)
        ]
        if not all(0 < a < arb.pi() for a in sectors):
            raise Refused(f"vertex {v} has a sector of 180 degrees or more")
        self._deviates(sectors[0] + sectors[2] - arb.pi())
        total, apart = (sectors[0] + sectors[1]) / 2, (sectors[0] - sectors[1]) / 2
        straight = []
        for off in (total - arb.pi() / 2, apart):
            straight.append(bool(abs(off) <= EXACT))
            if straight[-1]:
                self._deviates(2 * off)
        multipliers = {}
        if not straight[0]:
            sign = -1 if total.cos() > 0 else 1
            multipliers[1] = sign, self._ratio(abs(total.cos()), apart.cos())
        if not straight[1]:
            sign = 1 if apart > 0 else -1
            multipliers[-1] = sign, self._ratio(total.sin(), abs(apart.sin()))
        creases = tuple(self.disk.crease[frozenset((v, w))] for w in ring)
        rows = self.row[creases[0]], self.row[creases[1]]
        return Cross(creases, rows, (straight[0], straight[1]), multipliers, u)

    def _deviates(self, by: Any) -> None:
        self.off = max(self.off, float(abs(by).upper()))

    def _ratio(self, above: Any, below: Any) -> Counter[int]:
        """Return a ratio as powers of quantities, of which equal ones are one."""
        found: Counter[int] = Counter()
        for value, power in ((above, 1), (below, -1)):
            equal = [i for i, q in enumerate(self.quantities) if abs(value - q) <= EXACT]
            i = equal[0] if equal else len(self.quantities)
            self.quantities += [] if equal else [value]
            self._deviates(value - self.quantities[i])
            found[i] += power
        return found

    def _set(self, kinds: Sequence[int]) -> Iterator[list[Any]]:
        """Yield the minima in which rows are 0, at +-180 degrees, or neither, as these kinds say."""
        ways: list[list[int]] = []
        for crossing in self.crossings:
            one, two = (kinds[r] for r in crossing.rows)
            if one == two:
                either = [s for s in (1, -1) if one != FREE or s in crossing.multipliers]
                ways.append(either if one else [0])
            elif two == ZERO or (one == TURNED and two == FREE):
                ways.append([1] if crossing.straight[0] else [])
            else:
                ways.append([-1] if crossing.straight[1] else [])
        for signs in itertools.product(*ways):
            along = self._along(signs, {r for r, k in enumerate(kinds) if k != ZERO})
            if along is None:
                continue
            moving = self._moving({r for r, k in enumerate(kinds) if k == FREE}, signs, along)
            if moving is None:
                continue
            self.counts["sets"] += 1
            at: list[list[dict[int, Any]]] = [
                [
                    {c: s * arb.pi() * along[c] for c in range(len(self.row)) if self.row[c] == r}
                    for s in (1, -1)
                ]
                for r, k in enumerate(kinds)
                if k == TURNED
            ]
            for group in moving:
                zeros = self._stationary(group)
                at.append([self._angles(group, *zero) for zero in zeros])
            for parts in itertools.product(*at):
                folds = [arb(0)] * len(self.row)
                for part in parts:
                    for c, value in part.items():
                        folds[c] = value
                if self._stays(kinds, folds):
                    self._closes(folds)
                    yield folds

    def _along(self, signs: Sequence[int], rows: set[int]) -> dict[int, int] | None:
        """Return the sign of each crease along its row, for those that are not 0; None where these are two."""
        found: dict[int, int] = {}
        for r in rows:
            found[self.row.index(r)] = 1
        again = True
        while again:
            again = False
            for c, s in zip(self.crossings, signs, strict=True):
                for i, sign in ((0, s), (1, -s)):
                    a, b = c.creases[i], c.creases[i + 2]
                    if self.row[a] not in rows:
                        continue
                    for x, y in ((a, b), (b, a)):
                        if x in found and y not in found:
                            found[y] = sign * found[x]
                            again = True
                    if a in found and b in found and found[a] != sign * found[b]:
                        return None
        return found

    def _moving(
        self, rows: set[int], signs: Sequence[int], along: dict[int, int]
    ) -> list[RowGroup] | None:
        """Return rows that move together, in groups; None where they cannot, left open if that is not certain."""
        left, groups = set(rows), []
        while left:
            first = min(left)
            found: dict[int, tuple[int, Counter[int]]] = {first: (1, Counter())}
            again = True
            while again:
                again = False
                for c, s in zip(self.crossings, signs, strict=True):
                    one, two = c.rows
                    if one not in rows or two not in rows:
                        continue
                    sign, ratio = c.multipliers[s]
                    sign *= along[c.creases[0]] * along[c.creases[1]]
                    if one in found and two not in found:
                        found[two] = sign * found[one][0], _plus(found[one][1], ratio, 1)
                        again = True
                    elif two in found and one not in found:
                        found[one] = sign * found[two][0], _plus(found[two][1], ratio, -1)
                        again = True
                    elif one in found:
                        if found[two][0] != sign * found[one][0]:
                            return None
                        round_loop = _plus(_plus(found[one][1], ratio, 1), found[two][1], -1)
                        if round_loop and (value := self._value(tuple(round_loop.items()))) != 1:
                            return None
                        elif round_loop:
                            self.open.append(f"a loop of vertices, whose product is {value.str(5)}")
                            return None
            left -= set(found)
            groups.append(
                RowGroup(
                    tuple(
                        (c, r, along[c] * found[r][0], tuple(sorted(found[r][1].items())))
                        for c, r in enumerate(self.row)
                        if r in found
                    )
                )
            )
        return groups

    def _value(self, powers: tuple[tuple[int, int], ...]) -> Any:
        value = arb(1)
        for which, power in powers:
            value *= self.quantities[which] ** power
        return value

    def _even(self, group: RowGroup) -> bool:
        """Return whether U is even in T: U' is 0 at T = 0."""
        loads: dict[tuple[tuple[int, int], ...], Fraction] = {}
        for c, _, sign, powers in group.creases:
            load = sign * Fraction(self.said.stiffness[c]) * Fraction(self.said.rest[c])
            loads[powers] = loads.get(powers, Fraction(0)) + load
        return not any(loads.values())

    def _stationary(self, group: RowGroup) -> list[tuple[int, Any]]:
        """Return where the energy of a group is least inside: 0 and T, or a side of 180 degrees and 1/T."""
        if group in self._zeros:
            return self._zeros[group]
        self.counts["curves"] += 1
        found: list[tuple[int, Any]] = []
        even = self._even(group)
        for side, low, high in ((0, -1.0, 1.0), (-1, -1.0, 0.0), (1, 0.0, 1.0)):
            for a, b, bend in self._alike(group, side, low, high):
                ends = [_sign(self._chart(group, side, arb(x))[0]) for x in (a, b)]
                if not all(ends):
                    self.open.append(f"the slope along a curve near T = {a:.6g}")
                elif ends[0] != ends[1]:
                    self.maxima += bend < 0
                    # at T = 0 the rows are 0: another set
                    if bend > 0 and not (even and not side and a <= 0 <= b):
                        found.append((side, self._bisected(group, side, a, b)))
        self._zeros[group] = found
        return found

    def _alike(
        self, group: RowGroup, side: int, low: float, high: float
    ) -> list[tuple[float, float, int]]:
        """Return intervals in which U'' has a sign, beyond which U' has one."""
        front = [(low, high, 0)]
        found: list[tuple[float, float, int]] = []
        looked = 0
        while front:
            a, b, depth = front.pop()
            looked += 1
            first, second = self._chart(group, side, arb(a).union(arb(b)))
            middle = 0.5 * (a + b)
            at = self._chart(group, side, arb(middle))[0] + second * arb(0, 0.5 * (b - a))
            if _sign(first) or _sign(at):
                continue
            if bend := _sign(second):
                if found and found[-1][0] == b and found[-1][2] == bend:
                    found[-1] = (a, found[-1][1], bend)
                else:
                    found.append((a, b, bend))
            elif depth == DEPTH or looked > PIECES:
                self.open.append(f"where the energy is least along a curve, near T = {a:.6g}")
            else:
                front += [(a, middle, depth + 1), (middle, b, depth + 1)]
        return found

    def _bisected(self, group: RowGroup, side: int, a: float, b: float) -> Any:
        """Return where U' changes from negative to positive."""
        while (middle := 0.5 * (a + b)) not in (a, b):
            before = a, b
            for x in (0.5 * (a + middle), middle, 0.5 * (middle + b)):
                sign = _sign(self._chart(group, side, arb(x))[0])
                a, b = max(a, x) if sign < 0 else a, min(b, x) if sign > 0 else b
            if (a, b) == before:
                break
        zero = arb(a).union(arb(b))
        if not (zero > 0 or zero < 0):
            self.open.append("whether a state is flat, or at 180 degrees")
        return zero

    def _chart(self, group: RowGroup, side: int, t: Any) -> tuple[Any, Any]:
        """Return U' and U'' at T = t, or on a side of 180 degrees at T = 1/t."""
        x, total = arb_series([arb(t), 1], 3), arb_series([0], 3)
        for c, _, sign, powers in group.creases:
            m = self._value(powers)
            fold = side * arb.pi() - 2 * (x / m).atan() if side else 2 * (m * x).atan()
            total += self.disk.stiffness[c] * (sign * fold - self.disk.rest[c]) ** 2
        return total[1], 2 * total[2]

    def _angles(self, group: RowGroup, side: int, t: Any) -> dict[int, Any]:
        found = {}
        for c, _, sign, powers in group.creases:
            m = self._value(powers)
            fold = side * arb.pi() - 2 * (t / m).atan() if side else 2 * (m * t).atan()
            found[c] = sign * fold
        return found

    def _stays(self, kinds: Sequence[int], folds: Sequence[Any]) -> bool:
        """Return whether the energy grows as rows that are 0, or at +-180 degrees, begin to move."""
        for slope in self._all_leaving(kinds, folds):
            if slope < 0:
                return False
            if not slope:
                self.open.append("whether the energy falls from a state along a curve")
                return False
        return True

    def _all_leaving(self, kinds: Sequence[int], folds: Sequence[Any]) -> Iterator[int]:
        for kind in (ZERO, TURNED):
            rows = [r for r, k in enumerate(kinds) if k == kind]
            for many in range(1, len(rows) + 1):
                for some in itertools.combinations(rows, many):
                    yield from self._leaving(set(some), kind, kinds, folds)

    def _leaving(
        self, some: set[int], kind: int, kinds: Sequence[int], folds: Sequence[Any]
    ) -> Iterator[int]:
        """Yield the sign of the slope of the energy for each way in which these rows move all at once."""
        signs = [_sign(f) for f in folds]
        ways = []
        for c in self.crossings:
            within = [r in some for r in c.rows]
            s = [signs[x] for x in c.creases]
            if not any(within):
                ways.append([0])
                continue
            if all(within):
                allowed = list(c.multipliers)
            else:
                moves = within.index(True)
                other = kinds[c.rows[1 - moves]]
                if other == FREE:
                    return
                # the row across is 0 and this one straight, or that one is straight and at +-180 degrees
                line = moves if other == ZERO else 1 - moves
                allowed = [(1, -1)[line]] if c.straight[line] else []
            ways.append([x for x in allowed if s[2] == x * s[0] and s[3] == -x * s[1]])
        for way in itertools.product(*ways):
            along = self._along(way, some)
            groups = along and self._moving(some, way, along)
            if not along or not groups or len(groups) > 1:
                continue
            (group,) = groups
            if kind == ZERO:
                slope, bend = self._chart(group, 0, arb(0))
                yield _sign(bend) if self._even(group) else -abs(_sign(slope))
                continue
            sides = {signs[c] * sign for c, _, sign, _ in group.creases}
            if len(sides) == 1:
                (side,) = sides
                yield side * _sign(self._chart(group, side, arb(0))[0])

    def _closes(self, folds: Sequence[Any]) -> None:
        """Refuse a state of the statement round a vertex of which facets do not come back.

        In the middle of their balls folds are as multipliers in the middle of theirs say: what is left there is of the
        deviation of the sheet alone.  Where it is more than is granted, and not so for certain, nothing is said.
        """
        for crossing in self.crossings:
            middle, over = (
                [a - 1, *rest]
                for a, *rest in (
                    product_round(crossing, x) for x in ([arb(f.mid()) for f in folds], folds)
                )
            )
            if all(abs(x) < STATED for x in middle):
                continue
            if not all(arb(0, STATED).overlaps(x) for x in over):
                raise Refused("states of the statement do not close")
            self.open.append("whether a state closes, of a sheet that deviates so far")


def _plus(one: Counter[int], two: Counter[int], times: int) -> Counter[int]:
    total = Counter(one)
    for which, power in two.items():
        total[which] += times * power
    return Counter({w: p for w, p in total.items() if p})


def _sign(x: Any) -> int:
    return 1 if x > 0 else -1 if x < 0 else 0
