"""Check of certificates that a branch of a vertex of degree four has no three maxima of the energy: by balls.

Folds come from spherical triangles, as in `most_states`: the arc between the neighbours of the leading crease is a side
of a triangle with that crease and of one with the crease opposite; each neighbour's angle in the link is the sum of its
angles in both, by Napier's analogies.  Power series of python-flint's balls enclose them over cells of places.  Of the
certificate only sectors, leading crease, stretch and near, and trees are read; of the package, nothing.

A leaf holds whole numbers x >= 0, for every cluster of places in turn (each place alone, neighbours whose gap is at
most `near` times the widest cell, all three if both gaps are) the multipliers of

    D_j + 2^(2n-2-j) (D_{2n-1} - 3 M), j = 0 ... 2n - 2;    -D_j + ..., the same;    D_{2n-1} - M

of a cluster of n with hull [c - r, c + r], D_j = r^j w^(j)(c), M >= r^2n |w^(2n)|.  Where an energy has maxima at all
these places, none of them is positive when the w are mixed to its slope; so the sum must be positive for all w.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import factorial
from typing import Any

from flint import arb, arb_series, ctx

ORDERS, MORE = 7, 8
"""Derivatives 0 to 6 are asked for; eight more bound them over a cell."""
FINEST = Fraction(1, 512)
"""Half width of cells over which derivatives are enclosed at once."""


class Refused(ValueError):
    """A certificate that does not show what it claims."""


def _ball(value: Fraction, radius: Fraction = Fraction(0)) -> arb:
    wide = arb(radius.numerator) / radius.denominator
    return arb(value.numerator) / value.denominator + arb(0, 1) * wide


class Curve:
    """A branch on which the leading crease and the one opposite fold to one side, for all sectors within tolerance."""

    def __init__(self, sectors: list[str], leader: int, stretch: int, tolerance: str = "0") -> None:
        order = [sectors[(leader - 1 + i) % 4] for i in range(4)]
        turned = [arb(a, tolerance) * arb.pi() / 180 for a in order]
        self.sin = [a.sin() for a in turned]
        self.half = [a / 2 for a in turned]
        self.leader, self.stretch = leader, stretch
        total = sum((Fraction(a) for a in sectors), Fraction(0))
        self.q = self.sin[0] * self.sin[3] / (self.sin[1] * self.sin[2])
        if total != 360 or not (self.q < 1 and all(s > 0 for s in self.sin)):
            raise Refused("sectors or leading crease")
        self._known: dict[Any, Any] = {}

    def folds(self, y: arb_series) -> list[tuple[arb, arb_series]]:
        """Return fold [rad] and its derivative for the leading crease and the three after it."""
        grown, end = (y * self.stretch).exp(), arb(self.stretch).exp()
        t = (grown - 1 / grown) / (end - 1 / end)
        s, c = 2 * t, (1 - self.q).sqrt() * (1 - t * t)  # tan(fold/2) = s/c
        opposite = (self.q.sqrt() * s, (c * c + (1 - self.q) * s * s).sqrt())
        beside: list[Any] = [(arb(0), arb_series([0])), (arb(0), arb_series([0]))]
        for (a, b), (up, along) in (((0, 3), (s, c)), ((1, 2), opposite)):
            # Napier: half the sum and half the difference of a triangle's angles at the two neighbours
            less, more = (self.half[b] - self.half[a]), (self.half[a] + self.half[b])
            both = _turn(less.cos() / more.cos() * up, along, 1)
            unlike = _turn(less.sin() / more.sin() * up, along, 1)
            # sector b lies across from the first of the neighbours
            for i, sign in ((0, 1), (1, -1)):
                beside[i] = tuple(
                    x - y - sign * z for x, y, z in zip(beside[i], both, unlike, strict=True)
                )
        return [_turn(s, c, 2), beside[0], _turn(*opposite, 2), beside[1]]

    def slopes(self, middle: Fraction, radius: Fraction) -> list[list[arb]]:
        """Enclose derivatives 0 to 14 of the eight w over a cell."""
        ctx.cap = ORDERS + MORE + 1
        rows = []
        for fold, rate in self.folds(arb_series([_ball(middle, radius), 1])):
            if radius and not abs(fold) < arb(4):
                raise Refused("a fold is not enclosed")
            whole = rate.integral() + fold
            for rest in (arb.pi(), -arb.pi()):
                w = rate * (whole - rest)
                rows.append([w[k] * factorial(k) for k in range(ORDERS + MORE)])
        return rows

    def within_limits(self) -> bool:
        """Whether the other creases stay below 180 degrees, and those beside the leading one fold to unlike sides."""
        for middle in _cells():
            ctx.cap = 3
            folds = self.folds(arb_series([_ball(middle, FINEST), 1]))
            if not all(abs(fold) < arb.pi() for fold, _ in folds[1:]):
                return False
        folds = [fold for fold, _ in self.folds(arb_series([_ball(Fraction(1, 2)), 1]))]
        return bool(folds[0] > 0 and folds[2] > 0 and folds[1] * folds[3] < 0)

    def bound(self, low: Fraction, high: Fraction, order: int) -> list[arb]:
        """Bound this derivative of each w over a cell."""
        key = (low, high, order)
        if key not in self._known:
            half = (high - low) / 2
            if half <= FINEST:
                if (low, high) not in self._known:
                    self._known[low, high] = self._over(low + half, half)
                self._known[key] = [row[order] for row in self._known[low, high]]
            else:
                steps = (high - low) / (2 * FINEST)
                middle = low + 2 * FINEST * (int(steps) // 2 or 1)
                two = self.bound(low, middle, order), self.bound(middle, high, order)
                self._known[key] = [x.max(y) for x, y in zip(*two, strict=True)]
        return self._known[key]

    def _over(self, middle: Fraction, half: Fraction) -> list[list[arb]]:
        """Bound derivatives 0 to 6 over a cell: Taylor polynomials with a remainder."""
        found = []
        at, over, r = self.slopes(middle, Fraction(0)), self.slopes(middle, half), _ball(half)
        for row, wide in zip(at, over, strict=True):
            sums = [
                sum((abs(row[k + j]) * r**j / factorial(j) for j in range(MORE)), arb(0))
                + abs(wide[k + MORE]) * r**MORE / factorial(MORE)
                for k in range(ORDERS)
            ]
            found.append([x.upper() for x in sums])
        return found

    def statements(self, low: Fraction, high: Fraction, maxima: int) -> list[list[arb]]:
        """Return for each w what is multiplied."""
        key = ("statements", low, high, maxima)
        if key not in self._known:
            half, last = (high - low) / 2, 2 * maxima - 1
            rows = []
            for row, most in zip(
                self.slopes(low + half, Fraction(0)),
                self.bound(low, high, 2 * maxima),
                strict=True,
            ):
                d = [_ball(half**j) * row[j] for j in range(last + 1)]
                m = _ball(half ** (last + 1)) * most
                costs = [(d[last] - 3 * m) * 2 ** (last - 1 - j) for j in range(last)]
                rows.append(
                    [d[j] + costs[j] for j in range(last)]
                    + [costs[j] - d[j] for j in range(last)]
                    + [d[last] - m]
                )
            self._known[key] = rows
        return self._known[key]


def _turn(s: Any, c: Any, times: int) -> tuple[arb, Any]:
    rate = (s.derivative() * c - s * c.derivative()) / (s * s + c * c)
    return times * arb.atan2(s[0], c[0]), times * rate


def _cells() -> Iterator[Fraction]:
    middle = Fraction(-1) + FINEST
    while middle < 1:
        yield middle
        middle += 2 * FINEST


Box = tuple[tuple[Fraction, Fraction], ...]


def _halves(box: Box) -> list[Box]:
    """Cut the widest cell in two, and those equal to it; the first of several; lower places first."""
    wide = max(b - a for a, b in box)
    cut = next(cell for cell in box if cell[1] - cell[0] == wide)
    middle = sum(cut, Fraction(0)) / 2
    equal = [i for i in range(len(box)) if box[i] == cut]
    found = []
    for low in reversed(range(len(equal) + 1)):
        new = dict.fromkeys(equal[:low], (cut[0], middle)) | dict.fromkeys(
            equal[low:], (middle, cut[1])
        )
        found.append(tuple(new.get(i, cell) for i, cell in enumerate(box)))
    return found


def _turned(box: Box) -> Box:
    return tuple((-b, -a) for a, b in reversed(box))


class Check:
    """A certificate gone through: `open` are boxes of three places that it leaves."""

    def __init__(self, certificate: dict[str, Any], curve: Curve | None = None) -> None:
        leader, stretch = int(certificate["leader"]), int(certificate["stretch"])
        self.curve = curve or Curve(
            certificate["sectors"], leader, stretch, certificate["tolerance"]
        )
        if curve is None and not self.curve.within_limits():
            raise Refused("a crease that is not the leading one reaches 180 degrees")
        self.near = int(certificate["near"])
        self.pairs = certificate["pairs"]
        self.open: dict[int, list[Box]] = {2: [], 3: []}
        self.leaves = 0
        line = (Fraction(-1), Fraction(1))
        self._go(self.pairs, (line,) * 2)
        self._go(certificate["triples"], (line,) * 3)

    @property
    def most_maxima(self) -> int | None:
        """Most maxima between the ends of the branch, for all springs with rest angles within 180 degrees."""
        return 2 if not self.open[3] else None

    @property
    def excluded(self) -> float:
        """Share of the ordered triples of places at which there are no three maxima; half of them are looked at."""
        left = Fraction(0)
        for box in self.open[3]:
            part = Fraction(1)
            for i, (a, b) in enumerate(box):
                part *= (b - a) / (1 + sum(box[j] == (a, b) for j in range(i)))
            left += part
        return max(0.0, float(1 - left / Fraction(2, 3)))

    def _go(self, tree: Any, box: Box) -> None:
        word = tree[0]
        if word == "split":
            parts = _halves(box)
            if len(tree) != len(parts) + 1:
                raise Refused("a part is missing")
            for below, part in zip(tree[1:], parts, strict=True):
                self._go(below, part)
        elif word == "mirror":
            if box[0][0] + box[-1][0] < 0:
                raise Refused("no mirror image")
        elif word == "pair" and len(box) == 3:
            if not any(self._without(box[i], box[j]) for i, j in ((0, 1), (0, 2), (1, 2))):
                raise Refused("no two places exclude each other")
        elif word == "open":
            self.open[len(box)].append(box)
        else:
            self._leaf(tree, box)
            self.leaves += 1

    def _without(self, first: Any, second: Any) -> bool:
        box, line = (first, second), (Fraction(-1), Fraction(1))
        return all(self._covers(self.pairs, (line, line), b) for b in (box, _turned(box)))

    def _covers(self, tree: Any, node: Box, box: Box) -> bool:
        if any(max(a, c) >= min(b, d) for (a, b), (c, d) in zip(node, box, strict=True)):
            return True
        if tree[0] != "split":
            return bool(tree[0] != "open")
        return all(self._covers(*below, box) for below in zip(tree[1:], _halves(node), strict=True))

    def _leaf(self, numbers: list[int], box: Box) -> None:
        if not all(type(x) is int and x >= 0 for x in numbers):
            raise Refused("multipliers are whole numbers, none below 0")
        wide = max(b - a for a, b in box)
        near = [box[i + 1][0] - box[i][1] <= self.near * wide for i in range(len(box) - 1)]
        groups = [(i, i) for i in range(len(box))]
        groups += [(i, i + 1) for i, yes in enumerate(near) if yes]
        groups += [(0, 2)] if len(near) == 2 and all(near) else []
        known = [self.curve.statements(box[i][0], box[j][1], j - i + 1) for i, j in groups]
        for w in range(8):
            row = [x for statements in known for x in statements[w]]
            if len(row) != len(numbers):
                raise Refused("number of multipliers")
            total = arb(0)
            for x, value in zip(numbers, row, strict=True):
                if x:
                    total += x * value
            if not total > 0:
                raise Refused(
                    f"maxima at {[(float(a), float(b)) for a, b in box]} are not excluded"
                )
