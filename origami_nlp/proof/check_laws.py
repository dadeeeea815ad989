"""Hinge laws for the check of a proof: rational pieces, from the file's doubles alone, and balls around what they are.

The law that is meant is continuous: slopes are those of the pieces as they stand in the file, the torque at the first
break is as stated, and the other constants follow in rational numbers. The first piece
and the last go on beyond the ends. Where boxes hold several pieces, each is looked at on its own part.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import arb, fmpq

from origami_nlp.proof.strip_certificate import StatedLaw

AROUND = arb(0, 1)
"""[-1, 1]."""


class ExactLaw:
    """The torque of a hinge in balls of the precision that is set.

    Parameters
    ----------
    law
        Its breaks and coefficients.
    """

    def __init__(self, law: StatedLaw) -> None:
        breaks = [Fraction(b) for b in law.breaks]
        value = Fraction(law.coefficients[0][3])
        self.breaks, self.inner = law.breaks, law.breaks[1:-1]
        self.pieces: list[tuple[Any, ...]] = []
        for piece, (low, high) in enumerate(pairwise(breaks)):
            a, b, c = (Fraction(v) for v in law.coefficients[piece][:3])
            self.pieces.append(tuple(map(_ball, (a, b, c, value))))
            h = high - low
            value += ((a * h + b) * h + c) * h
        self._whole: dict[int, Any] = {}

    def _expanded(self, piece: int, at: Any) -> tuple[Any, Any, Any, Any]:
        """Torque and its derivatives over 1, 2 and 6 of a piece at a ball."""
        a, b, c, d = self.pieces[piece]
        t = at - arb(self.breaks[piece])
        return ((a * t + b) * t + c) * t + d, (3 * a * t + 2 * b) * t + c, 3 * a * t + b, a

    def _touched(self, low: float, high: float) -> range:
        """Pieces that touch what is between two doubles."""
        return range(bisect_left(self.inner, low), bisect_right(self.inner, high) + 1)

    def _slope_of(self, piece: int, low: float, high: float) -> Any:
        """Ball of the slopes of a piece between two doubles, or of its part there."""
        last = len(self.pieces) - 1
        start = low if piece == 0 else max(low, self.breaks[piece])
        end = high if piece == last else min(high, self.breaks[piece + 1])
        inside = (start, end) == (self.breaks[piece], self.breaks[piece + 1])
        if inside and piece in self._whole:
            return self._whole[piece]
        m, r = _parts(start, end)
        _, f1, f2, f3 = self._expanded(piece, m)
        off = AROUND * r
        found = f1 + off * (2 * f2 + 3 * off * f3)
        if inside:
            self._whole[piece] = found
        return found

    def at(self, x: Any) -> Any:
        """Torque at a ball of fold angles: at its middle, and by the slopes over it."""
        middle = x.mid()
        low, high = _outside(middle)
        found = None
        for piece in self._touched(low, high):
            value = self._expanded(piece, middle)[0]
            found = value if found is None else found.union(value)
        return found if x.rad() == 0 else found + self.slope(x) * (x - middle)

    def slope(self, x: Any) -> Any:
        """All slopes of the torque over a ball of fold angles."""
        low, high = _outside(x)
        found = None
        for piece in self._touched(low, high):
            value = self._slope_of(piece, low, high)
            found = value if found is None else found.union(value)
        return found


def _ball(value: Fraction) -> Any:
    return arb(fmpq(value.numerator, value.denominator))


def _outside(x: Any) -> tuple[float, float]:
    """Doubles that enclose a ball."""
    return (math.nextafter(float(x.lower()), -math.inf), math.nextafter(float(x.upper()), math.inf))


def _parts(low: float, high: float) -> tuple[Any, Any]:
    """Return m, r (exact) such that [low, high] is in m + r [-1, 1]."""
    m = arb(0.5 * (low + high))
    up, down = (arb(high) - m).upper(), (m - arb(low)).upper()
    return m, up if up >= down else down
