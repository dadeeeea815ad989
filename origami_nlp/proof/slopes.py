"""An energy along a curve, cut into intervals in which it is known: where it is least, inside or at what ends it.

The slope U' of the energy has no zero in an interval, by its value in the middle and U'' over it; or U'' has none, and
then U' has one at most, which signs of U' at the ends decide.  States of a curve are those where no gap is negative: in
an interval in which some may be, all of these grow or all of them fall, and U' has a sign.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from flint import arb

from origami_nlp.proof.sheets import sign_of

DEPTH = 60
"""Halvings of an interval, at most."""
GONE, SLOPE, BEND, HELD, OPEN = range(5)
"""Kinds of intervals: no state; U' has a sign; U'' has one; gaps that have slopes of one sign; undecided."""


class Look(NamedTuple):
    """What is known of an interval: U', U'', and gaps that must not be negative, each by a name with its slope."""

    first: Any
    second: Any
    gaps: dict[Any, tuple[Any, Any]]
    known: Any = None


Curve = Callable[[Any], Look | None]
"""A curve of states, of a number: what is known over a ball; None where there is no state."""


class CurvePiece(NamedTuple):
    """An interval: its kind, the sign of U' (of U'' of `BEND`), that of the slopes of gaps, and their names."""

    low: float
    high: float
    kind: int
    sign: int = 0
    way: int = 0
    gaps: tuple[Any, ...] = ()

    def joins(self, other: CurvePiece) -> bool:
        """Return whether both say the same."""
        return self.kind != HELD and self[2:] == other[2:]


@dataclass
class Budget:
    """How many intervals may be looked at, and whether time is left."""

    most: int
    late: Callable[[], bool]
    looked: int = 0

    def spent(self) -> bool:
        """Count one, and return whether it is one too many."""
        self.looked += 1
        return self.looked > self.most or self.late()


@dataclass
class Least:
    """Where an energy is least along a curve.

    Attributes
    ----------
    minima
        Between two numbers each, held by gaps that have these names.
    open
        Between two numbers each, and why.
    """

    minima: list[tuple[float, float, tuple[Any, ...]]] = field(default_factory=list)
    open: list[tuple[float, float, str]] = field(default_factory=list)


def least(curve: Curve, low: float, high: float, budget: Budget, rests: bool = False) -> Least:
    """Find where the energy of a curve is least between two numbers, from 0 on where U' is 0 there, if it `rests`."""
    found = Least()
    pieces: list[CurvePiece] = []
    for one in _pieces(curve, low, high, budget):
        if pieces and pieces[-1].joins(one):
            pieces[-1] = pieces[-1]._replace(high=one.high)
        else:
            pieces.append(one)
    for a, b, kind, sign, way, gaps in pieces:
        if kind == OPEN:
            found.open.append((a, b, "not decided in the smallest intervals"))
        elif kind == BEND and not (rests and a <= 0 <= b):
            ends = [_slope(curve, x) for x in (a, b)]
            if not all(ends):
                found.open.append((a, b, "the slope at the end of an interval"))
            elif ends[0] != ends[1] and sign > 0:
                zero = _halved(lambda x: _slope(curve, x), a, b)
                found.minima.append((*zero, ()))
        elif kind == HELD:
            ends = [_room(curve, gaps, x) for x in (a, b)]
            if not all(ends):
                found.open.append((a, b, "what ends a curve"))
            elif ends[0] != ends[1] and sign == way:
                zero = _halved(lambda x, g=gaps, w=way: w * _room(curve, g, x), a, b)  # type: ignore[misc]
                found.minima.append((*zero, gaps))
    return found


def _pieces(curve: Curve, low: float, high: float, budget: Budget) -> Iterator[CurvePiece]:
    front = [(low, high, 0)]
    while front:
        a, b, depth = front.pop()
        over = budget.spent()
        piece = _piece(curve, a, b)
        middle = 0.5 * (a + b)
        if piece is not None:
            yield piece
        elif over or depth == DEPTH or middle in (a, b):
            yield CurvePiece(a, b, OPEN)
        else:
            front += [(middle, b, depth + 1), (a, middle, depth + 1)]


def _piece(curve: Curve, a: float, b: float) -> CurvePiece | None:
    """Return what is known of an interval; None: it is to be halved."""
    box = curve(arb(a).union(arb(b)))
    if box is None or any(value < 0 for value, _ in box.gaps.values()):
        return CurvePiece(a, b, GONE)
    met = {name: gap for name, gap in box.gaps.items() if not gap[0] > 0}
    slope, bend = sign_of(box.first), sign_of(box.second)
    if not (slope or (bend and not met)):
        return None
    if not met:
        return CurvePiece(a, b, SLOPE, slope) if slope else CurvePiece(a, b, BEND, bend)
    ways = {sign_of(rate) for _, rate in met.values()}
    if not slope or len(ways) > 1 or 0 in ways:
        return None
    return CurvePiece(a, b, HELD, slope, ways.pop(), tuple(met))


def _slope(curve: Curve, x: float) -> int:
    """Return the sign of U' at a number, 0 where it is not certain."""
    at = curve(arb(x))
    return 0 if at is None else sign_of(at.first)


def _room(curve: Curve, gaps: Sequence[Any], x: float) -> int:
    """Return the least sign of gaps at a number, 0 where it is not certain."""
    at = curve(arb(x))
    return -1 if at is None else min(sign_of(at.gaps[name][0]) for name in gaps)


def _halved(sign: Callable[[float], int], low: float, high: float) -> tuple[float, float]:
    """Return where a sign changes from negative to positive, as far as it is certain."""
    while (middle := 0.5 * (low + high)) not in (low, high):
        before = low, high
        for x in (0.5 * (low + middle), middle, 0.5 * (middle + high)):
            if low < x < high and (at := sign(x)):
                low, high = (x, high) if at < 0 else (low, x)
        if (low, high) == before:
            break
    return low, high
