"""Check of certificates that a branch of a vertex of degree four has no three maxima of the energy: by balls.

Folds come from spherical triangles, as in `most_states`: the arc between the neighbours of the leading crease is a side
of a triangle with that crease and of one with the crease opposite; each neighbour's angle in the link is the sum of its
angles in both, by Napier's analogies.  Power series of python-flint's balls enclose them over cells of places.  Of the
certificate only sectors, leading crease, stretch and near, and trees are read; of the package, nothing.

A leaf holds whole numbers x >= 0, for every cluster of places in turn (each place alone, neighbours whose gap is at
most `near` times the widest cell, all three if both gaps are) the multipliers of

    D_j + 2^(2n-2-j) (D_{2n-1} - 3 M), j = 0 ... 2n - 2;    -D_j + ..., the same;    D_{2n-1} - M

of a cluster of n with hull [c - r, c + r], D_j = r^j w^(j)(c), M >= r^2n |w^(2n)|.  Where an energy has maxima at all
these places, none of them is positive when the w are mixed to its slope; so the sum must be positive for all w.  Over a
box of sectors D_j is taken in mean value form: at its middle, and slopes by the first three sectors over the box.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import factorial
from typing import Any, NamedTuple

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


class Turn(NamedTuple):
    """An angle: its value at the place, its derivative along the branch, and by sectors [rad/deg], as series."""

    fold: arb
    rate: arb_series
    by: list[arb_series]

    @classmethod
    def of(cls, s: Any, c: Any, s_by: list[Any], c_by: list[Any], times: int) -> Turn:
        """Return so many times the angle whose tangent is s/c."""
        size = s * s + c * c
        rate = (s.derivative() * c - s * c.derivative()) / size
        by = [times * ((x * c - s * z) / size) for x, z in zip(s_by, c_by, strict=True)]
        return cls(times * arb.atan2(s[0], c[0]), times * rate, by)

    def times(self, sign: int) -> Turn:
        return Turn(sign * self.fold, sign * self.rate, [sign * x for x in self.by])

    @classmethod
    def total(cls, some: list[Turn]) -> Turn:
        """Return the sum."""
        first, *others = some
        for one in others:
            by = [x + z for x, z in zip(first.by, one.by, strict=True)]
            first = cls(first.fold + one.fold, first.rate + one.rate, by)
        return first


def _longer(by: arb, gains: list[arb], side: Any) -> Any:
    """Multiply the first of a pair, both with what they gain by sectors."""
    s, c, s_by, c_by = side
    return by * s, c, [x * s + by * z for x, z in zip(gains, s_by, strict=True)], c_by


def _most(at: list[list[arb]], over: list[list[arb]], half: Fraction) -> list[list[arb]]:
    """Bound derivatives 0 to 6 over a cell by those at its middle and, the highest, over it."""
    found, r = [], _ball(half)
    for row, wide in zip(at, over, strict=True):
        sums = [
            sum((abs(row[k + j]) * r**j / factorial(j) for j in range(MORE)), arb(0))
            + abs(wide[k + MORE]) * r**MORE / factorial(MORE)
            for k in range(ORDERS)
        ]
        found.append([x.upper() for x in sums])
    return found


def _derivatives(w: arb_series) -> list[arb]:
    return [w[k] * factorial(k) for k in range(ORDERS + MORE)]


class Curve:
    """A branch on which the leading crease and the one opposite fold to one side.

    For all vertices whose first three sectors are within tolerance [deg] of those given; all four sum to 360.
    """

    def __init__(self, sectors: list[str], leader: int, stretch: int, tolerance: str = "0") -> None:
        self.tolerance = Fraction(tolerance)
        unit = arb.pi() / 180
        wide = [self.tolerance] * 3 + [3 * self.tolerance]
        turned, along = [], []
        for i in range(4):
            k = (leader - 1 + i) % 4
            turned.append(_ball(Fraction(sectors[k]), wide[k]) * unit)
            # one degree more of the first, second and third sector, less of the fourth
            along.append([unit * ((k == p) - (k == 3)) for p in range(3)])
        self.sin = [a.sin() for a in turned]
        self.half = [a / 2 for a in turned]
        self.leader, self.stretch = leader, stretch
        total = sum((Fraction(a) for a in sectors), Fraction(0))
        self.q = self.sin[0] * self.sin[3] / (self.sin[1] * self.sin[2])
        if total != 360 or not (self.q < 1 and all(s > 0 for s in self.sin)):
            raise Refused("sectors or leading crease")
        cot = [a.cos() / a.sin() for a in turned]
        self.steps = range(3) if self.tolerance else range(0)
        self.q_by = [
            self.q * sum((s * cot[i] * along[i][p] for i, s in enumerate((1, -1, -1, 1))), arb(0))
            for p in self.steps
        ]
        self.half_by = [[along[i][p] / 2 for p in self.steps] for i in range(4)]
        self.middle = Curve(sectors, leader, stretch) if self.tolerance else self
        self._known: dict[Any, Any] = {}

    def folds(self, y: arb_series) -> list[Turn]:
        """Return folds [rad] of the leading crease and the three after it."""
        grown, end = (y * self.stretch).exp(), arb(self.stretch).exp()
        t = (grown - 1 / grown) / (end - 1 / end)
        root = (1 - self.q).sqrt()
        s, c = 2 * t, root * (1 - t * t)  # tan(fold/2) = s/c
        far = (c * c + (1 - self.q) * s * s).sqrt()
        none = s * 0
        c_by = [-x / (2 * root) * (1 - t * t) for x in self.q_by]
        leading = s, c, [none for _ in self.steps], c_by
        opposite = (
            self.q.sqrt() * s,
            far,
            [x / (2 * self.q.sqrt()) * s for x in self.q_by],
            [(2 * c * x - z * s * s) / (2 * far) for x, z in zip(c_by, self.q_by, strict=True)],
        )
        beside: list[list[Turn]] = [[], []]
        for (a, b), side in (((0, 3), leading), ((1, 2), opposite)):
            # Napier: half the sum and half the difference of a triangle's angles at the two neighbours
            less, more = (self.half[b] - self.half[a]), (self.half[a] + self.half[b])
            by = [(self.half_by[b][p], self.half_by[a][p]) for p in self.steps]
            cosines = [
                (more.sin() * (x + z) * less.cos() / more.cos() - less.sin() * (x - z)) / more.cos()
                for x, z in by
            ]
            sines = [
                (less.cos() * (x - z) - more.cos() * (x + z) * less.sin() / more.sin()) / more.sin()
                for x, z in by
            ]
            both = Turn.of(*_longer(less.cos() / more.cos(), cosines, side), -1)
            unlike = Turn.of(*_longer(less.sin() / more.sin(), sines, side), -1)
            # sector b lies across from the first of the neighbours
            for i, sign in ((0, 1), (1, -1)):
                beside[i] += [both, unlike.times(sign)]
        one, two = (Turn.total(some) for some in beside)
        return [Turn.of(*leading, 2), one, Turn.of(*opposite, 2), two]

    def slopes(self, middle: Fraction, radius: Fraction) -> list[list[arb]]:
        """Enclose derivatives 0 to 14 of the eight w over a cell."""
        rows = []
        for turn in self._turns(middle, radius):
            whole = turn.rate.integral() + turn.fold
            for rest in (arb.pi(), -arb.pi()):
                rows.append(_derivatives(turn.rate * (whole - rest)))
        return rows

    def by_sectors(self, middle: Fraction, radius: Fraction) -> list[list[list[arb]]]:
        """Enclose what these gain by a degree more of each of the first three sectors, [3, 8, 15]."""
        found: list[list[list[arb]]] = [[] for _ in self.steps]
        for turn in self._turns(middle, radius):
            whole = turn.rate.integral() + turn.fold
            for rest in (arb.pi(), -arb.pi()):
                for p, by in enumerate(turn.by):
                    found[p].append(_derivatives(by.derivative() * (whole - rest) + turn.rate * by))
        return found

    def _turns(self, middle: Fraction, radius: Fraction) -> list[Turn]:
        ctx.cap = ORDERS + MORE + 2
        turns = self.folds(arb_series([_ball(middle, radius), 1]))
        if radius and not all(abs(turn.fold) < arb(4) for turn in turns):
            raise Refused("a fold is not enclosed")
        return turns

    def within_limits(self) -> bool:
        """Whether the other creases stay below 180 degrees, and those beside the leading one fold to unlike sides."""
        for middle in _cells():
            ctx.cap = 3
            folds = self.folds(arb_series([_ball(middle, FINEST), 1]))
            if not all(abs(turn.fold) < arb.pi() for turn in folds[1:]):
                return False
        folds = [turn.fold for turn in self.folds(arb_series([_ball(Fraction(1, 2)), 1]))]
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
        """Bound derivatives 0 to 6 over a cell: Taylor polynomials with a remainder, and what sectors add."""
        none = Fraction(0)
        found = _most(self.middle.slopes(middle, none), self.middle.slopes(middle, half), half)
        more = zip(self.by_sectors(middle, none), self.by_sectors(middle, half), strict=True)
        for at, over in more if self.tolerance else ():
            room = _ball(self.tolerance)
            gains = _most(at, over, half)
            found = [
                [(x + room * z).upper() for x, z in zip(row, some, strict=True)]
                for row, some in zip(found, gains, strict=True)
            ]
        return found

    def statements(self, low: Fraction, high: Fraction, maxima: int) -> list[list[arb]]:
        """Return for each w what is multiplied."""
        key = ("statements", low, high, maxima)
        if key not in self._known:
            half, last = (high - low) / 2, 2 * maxima - 1
            rows = []
            for row, most in zip(
                self.middle.slopes(low + half, Fraction(0)),
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

    def gains(self, low: Fraction, high: Fraction, maxima: int) -> list[list[list[arb]]]:
        """Enclose what the D_j in these gain by a degree more of each of the first three sectors, [3, 8, ...]."""
        key = ("gains", low, high, maxima)
        if key not in self._known:
            half, last = (high - low) / 2, 2 * maxima - 1
            found: list[list[list[arb]]] = []
            for rows in self.by_sectors(low + half, Fraction(0)):
                found.append([])
                for row in rows:
                    d = [_ball(half**j) * row[j] for j in range(last + 1)]
                    costs = [d[last] * 2 ** (last - 1 - j) for j in range(last)]
                    found[-1].append(
                        [d[j] + costs[j] for j in range(last)]
                        + [costs[j] - d[j] for j in range(last)]
                        + [d[last]]
                    )
            self._known[key] = found
        return self._known[key]


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
        gains = (
            [self.curve.gains(box[i][0], box[j][1], j - i + 1) for i, j in groups]
            if self.curve.steps
            else []
        )
        for w in range(8):
            row = [x for statements in known for x in statements[w]]
            if len(row) != len(numbers):
                raise Refused("number of multipliers")
            total = _sum(numbers, row)
            for p in self.curve.steps:
                gain = _sum(numbers, [x for some in gains for x in some[p][w]])
                total -= _ball(self.curve.tolerance) * abs(gain)
            if not total > 0:
                raise Refused(
                    f"maxima at {[(float(a), float(b)) for a, b in box]} are not excluded"
                )


def _sum(numbers: list[int], row: list[arb]) -> arb:
    return sum((x * value for x, value in zip(numbers, row, strict=True) if x), arb(0))
