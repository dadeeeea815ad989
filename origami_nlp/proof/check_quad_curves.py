"""Curves of a mesh that need not fold flat, for the check of a proof: z at a vertex, classes of creases, energy."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from flint import arb, arb_series

from origami_nlp.proof.check_sheet import FlatDisk

DEPTH = 60
"""Halvings of an interval of theta, at most."""
PIECES = 20_000
"""Intervals of theta of one choice that are looked at, at most: a file must not keep the check for ever."""
QUARTER = math.nextafter(0.5 * math.pi, math.inf)
"""Not below pi/2, which is between two doubles."""
SMALL = 1.0 / 128
"""A theta at which signs of folds are asked for [rad]."""


class QuadRound(NamedTuple):
    """A vertex: creases counter-clockwise, [i i+1] and [i i+2] of each, classes of its sectors, unit vectors."""

    creases: tuple[int, ...]
    beside: tuple[Any, ...]
    across: tuple[Any, ...]
    sectors: tuple[int, ...]
    directions: list[tuple[Any, Any]]


class VertexLink(NamedTuple):
    """A vertex, the place of a crease that is known, and the sign of z of the crease opposite."""

    vertex: QuadRound
    place: int
    sign: int


class ClassCurve(NamedTuple):
    """A curve: z of each class of creases by links from one, and the class and sign of each crease."""

    links: tuple[VertexLink, ...]
    drive: int
    classes: tuple[int, ...]
    signs: tuple[int, ...]


def others(vertex: QuadRound, p: int, z: Any, square: Any, sign: int) -> dict[int, Any] | None:
    """Return z at the other places of a vertex from that at place p, and sin^2 theta; None where it is not real.

    The one opposite has the sign that is given.
    """
    k, c = vertex.beside, vertex.across[p]
    ratio = k[(p + 1) % 4] * k[(p + 2) % 4] / (k[p] * k[(p + 3) % 4])
    under = (square + z * z) * ratio - square
    if under[0] < 0:
        return None
    opposite = sign * _root(under)
    return {
        (p + 1) % 4: -(k[(p + 1) % 4] * z + k[p] * opposite) / c,
        (p + 2) % 4: opposite,
        (p + 3) % 4: (k[(p + 3) % 4] * opposite + k[(p + 2) % 4] * z) / c,
    }


def _root(under: Any) -> Any:
    """Return the square root of a series; where it may be 0, its value alone."""
    if under[0] > 0:
        return under.sqrt()
    value = arb(0).union(abs(under[0]).upper().sqrt())
    return arb_series([value, arb.nan(), arb.nan()], 3)


def fold_of(z: Any, sine: Any) -> Any:
    """Return phi in (-pi, pi) with sine cot(phi/2) = z, sine > 0."""
    if float(abs(z).mid()) > float(sine.mid()):
        return 2 * (sine / z).atan()
    return (1 if z > 0 else -1) * arb.pi() - 2 * (z / sine).atan()


def one_curve(links: Sequence[VertexLink], drive: int, zs: dict[int, Any]) -> ClassCurve | None:
    """Return the curve along which vertices that are linked close identically, all z known at a state; None: not so."""
    turns = {c: sign_of(z[0]) for c, z in zs.items()}
    classes = {drive: 0}
    kinds: list[tuple[tuple[int, int, int], ...]] = []
    few: list[VertexLink] = []
    for link in links:
        alike = (
            dict(zip(creases, kind, strict=True))
            for creases, seen in _ways(link.vertex, turns)
            for kind in kinds
            if seen == tuple(k[1:] for k in kind)
        )
        # of the creases that are known one is in the class that it has there: so are all, if the loop says so
        one = next((m for m in alike if any(classes.get(c) == k[0] for c, k in m.items())), None)
        if one is not None:
            if any(classes.setdefault(c, k[0]) != k[0] for c, k in one.items()):
                return None
            continue
        place = [i for i, c in enumerate(link.vertex.creases) if c in classes]
        if len(place) != 1:
            return None
        few.append(VertexLink(link.vertex, place[0], 0))
        for c in link.vertex.creases:
            classes.setdefault(c, len(set(classes.values())))
        creases, seen = next(_ways(link.vertex, turns))
        kinds.append(tuple((classes[c], *k) for c, k in zip(creases, seen, strict=True)))
    order = sorted(classes)
    return ClassCurve(
        tuple(few), drive, tuple(classes[c] for c in order), tuple(turns[c] for c in order)
    )


class CurveSlopes:
    """The energy along a curve, given by the class of folds that reaches 180 degrees first.

    Attributes
    ----------
    open
        What is not decided, a line each.
    """

    def __init__(self, disk: FlatDisk, along: ClassCurve) -> None:
        self.disk, self.open = disk, list[str]()
        self.along = self._driven(along)

    def _driven(self, along: ClassCurve) -> ClassCurve:
        """Return a curve given by the class that reaches 180 degrees first, and links from it."""
        # along the curve as it is given, by halving: the last state where no z has changed its sign
        low, high = SMALL, 0.5 * math.pi
        first = along.classes[along.drive]
        for _ in range(40):
            middle = 0.5 * (low + high)
            zs = self._classes(along, arb(middle))
            if zs is None or any(not z[0] > 0 for z in zs.values()):
                high = middle
            else:
                low = middle
        at = self._classes(along, arb(low))
        if at is not None and high < 0.5 * math.pi:
            first = min(at, key=lambda c: float(at[c][0].mid()))
        if first == along.classes[along.drive]:
            return along
        drive = along.classes.index(first)
        turn = along.signs[drive]
        left, links, known = list(along.links), [], {first}
        while left:
            of = [[along.classes[c] for c in link.vertex.creases] for link in left]
            i = next(i for i, own in enumerate(of) if known & {*own})
            links.append(left[i]._replace(place=next(j for j, k in enumerate(of[i]) if k in known)))
            known |= {*of[i]}
            del left[i]
        return ClassCurve(tuple(links), drive, along.classes, tuple(turn * s for s in along.signs))

    def _classes(self, along: ClassCurve, theta: Any) -> dict[int, Any] | None:
        """Return |z| of each class as series, from the few vertices that define them; None where that is not real."""
        x = arb_series([arb(theta), 1], 3)
        s = x.sin()
        square = s * s
        found = {along.classes[along.drive]: x.cos()}
        for vertex, p, _ in along.links:
            own = [along.classes[c] for c in vertex.creases]
            signs = [along.signs[c] for c in vertex.creases]
            values = others(vertex, p, signs[p] * found[own[p]], square, signs[(p + 2) % 4])
            if values is None:
                return None
            for i, value in values.items():
                found[own[i]] = signs[i] * value
        return found

    def folds(self, side: int, theta: Any) -> list[Any] | None:
        """Return all folds as series in theta, on a side of the flat state; None where one may be beyond its limit."""
        along = self.along
        zs = self._classes(along, theta)
        drive = along.classes[along.drive]
        if zs is None or any(not z[0] > 0 for c, z in zs.items() if c != drive):
            return None
        x = arb_series([arb(theta), 1], 3)
        s = x.sin()
        of = {}
        for c, z in zs.items():
            if c == drive:
                of[c] = 2 * x
            elif float(z[0].mid()) > float(s[0].mid()):
                of[c] = 2 * (s / z).atan()
            else:
                of[c] = arb.pi() - 2 * (z / s).atan()
        return [side * t * of[c] for c, t in zip(along.classes, along.signs, strict=True)]

    def slopes(self, side: int, theta: Any) -> tuple[Any, Any]:
        """Return U' and U'' over theta."""
        folds = self.folds(side, theta)
        if folds is None:
            return arb.nan(), arb.nan()
        total = arb_series([0], 3)
        for k, rest, fold in zip(self.disk.stiffness, self.disk.rest, folds, strict=True):
            total += k * (fold - rest) ** 2
        return total[1], 2 * total[2]

    def alike(self, side: int) -> list[tuple[float, float, int]]:
        """Return intervals in which U'' has a sign, beyond which U' has one."""
        front = [(0.0, QUARTER, 0)]
        found: list[tuple[float, float, int]] = []
        looked = 0
        while front:
            low, high, depth = front.pop()
            looked += 1
            first, second = self.slopes(side, arb(low).union(arb(high)))
            middle = 0.5 * (low + high)
            at = self.slopes(side, arb(middle))[0] + second * arb(0, 0.5 * (high - low))
            if sign_of(first) or sign_of(at):
                continue
            if bend := sign_of(second):
                if found and found[-1][1] == low and found[-1][2] == bend:
                    found[-1] = (found[-1][0], high, bend)
                else:
                    found.append((low, high, bend))
            elif depth == DEPTH or looked > PIECES:
                self.open.append(f"where the energy is least along a curve, near theta = {low:.6g}")
            else:
                front += [(middle, high, depth + 1), (low, middle, depth + 1)]
        return found

    def bisected(self, side: int, low: float, high: float) -> tuple[Any, Any]:
        """Return where U' changes from negative to positive."""
        while (middle := 0.5 * (low + high)) not in (low, high):
            sign = sign_of(self.slopes(side, arb(middle))[0])
            if not sign:
                break
            low, high = (low, middle) if sign > 0 else (middle, high)
        return low, high


def _ways(
    vertex: QuadRound, turns: dict[int, int]
) -> Iterator[tuple[list[int], tuple[tuple[int, int], ...]]]:
    """Yield a vertex as it is seen from each crease, both ways round: its creases; signs (the first +1) and sectors."""
    for p, way in itertools.product(range(4), (1, -1)):
        places = [(p + way * i) % 4 for i in range(4)]
        creases = [vertex.creases[i] for i in places]
        yield (
            creases,
            tuple(
                (turns[creases[0]] * turns[c], vertex.sectors[i if way > 0 else (i - 1) % 4])
                for c, i in zip(creases, places, strict=True)
            ),
        )


def sign_of(x: Any) -> int:
    """Return the sign of a ball, 0 where it is not certain."""
    return 1 if x > 0 else -1 if x < 0 else 0
