"""Hinge laws for the check of a proof: rational pieces, from the file's doubles alone, and balls around what they are.

The law that is meant is continuous: slopes are those of the pieces as they stand in the file, the torque at the first
break is as stated (less the preload of the crease), and the other constants follow in rational numbers. The first piece
and the last go on beyond the ends. Where boxes hold several pieces, each is looked at on its own part.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import arb, fmpq

from origami_nlp.pattern import HingeLaw, Scene
from origami_nlp.proof.check_forms import AROUND, SQUARE, Form, parts
from origami_nlp.proof.strip_certificate import StatedLaw


def laws_of(scene: Scene, creases: Sequence[int]) -> list[ExactLaw | None]:
    """Return the laws of some creases of a scene, None for linear springs."""
    if not scene.laws:
        return [None] * len(creases)
    preload = scene.preload or (0.0,) * scene.degree
    laws = [(scene.laws[c], preload[c]) for c in creases]
    return [None if law is None else ExactLaw(law, m) for law, m in laws]


class ExactLaw:
    """The torque of a hinge in balls of the precision that is set.

    Parameters
    ----------
    law
        Its breaks and coefficients.
    preload
        A torque that is taken off.
    """

    def __init__(self, law: HingeLaw | StatedLaw, preload: float) -> None:
        breaks = [Fraction(b) for b in law.breaks]
        value, energy = Fraction(law.coefficients[0][3]) - Fraction(preload), Fraction(0)
        self.breaks, self.inner, self.preload = law.breaks, law.breaks[1:-1], arb(preload)
        self.pieces: list[tuple[Any, ...]] = []
        self.energies: list[Any] = []
        for piece, (low, high) in enumerate(pairwise(breaks)):
            a, b, c = (Fraction(v) for v in law.coefficients[piece][:3])
            self.pieces.append(tuple(map(_ball, (a, b, c, value))))
            self.energies.append(_ball(energy))
            h = high - low
            # the integral of each piece, by Horner's rule in rational numbers
            energy += (((a / 4 * h + b / 3) * h + c / 2) * h + value) * h
            value += ((a * h + b) * h + c) * h
        self._known: dict[tuple[float, float], Form] = {}
        self._whole: dict[int, tuple[Any, Any]] = {}
        self._least: Any = None

    def _expanded(self, piece: int, at: Any) -> tuple[Any, Any, Any, Any]:
        """Torque and its derivatives over 1, 2 and 6 of a piece at a ball."""
        a, b, c, d = self.pieces[piece]
        t = at - arb(self.breaks[piece])
        return ((a * t + b) * t + c) * t + d, (3 * a * t + 2 * b) * t + c, 3 * a * t + b, a

    def _touched(self, low: float, high: float) -> range:
        """Pieces that touch what is between two doubles."""
        return range(bisect_left(self.inner, low), bisect_right(self.inner, high) + 1)

    def _part(self, piece: int, low: float, high: float) -> tuple[Any, Any]:
        """Balls of torque and slope of a piece between two doubles, or of its part there."""
        last = len(self.pieces) - 1
        start = low if piece == 0 else max(low, self.breaks[piece])
        end = high if piece == last else min(high, self.breaks[piece + 1])
        inside = (start, end) == (self.breaks[piece], self.breaks[piece + 1])
        if inside and piece in self._whole:
            return self._whole[piece]
        m, r = parts(start, end)
        f0, f1, f2, f3 = self._expanded(piece, m)
        off = AROUND * r
        found = f0 + off * (f1 + off * (f2 + off * f3)), f1 + off * (2 * f2 + 3 * off * f3)
        if inside:
            self._whole[piece] = found
        return found

    def form(self, i: int, low: float, high: float) -> Form:
        """Return the torque over a box as a form in xi_i."""
        found = self._known.get((low, high))
        if found is None:
            found = self._known[low, high] = self._form(low, high)
        return found[0], {i: found[1][0]} if found[1] else {}

    def _form(self, low: float, high: float) -> Form:
        m, r = parts(low, high)
        pieces = self._touched(low, high)
        if len(pieces) == 1:
            f0, f1, f2, f3 = self._expanded(pieces[0], m)
            # |4 xi^3 - 3 xi| <= 1: the cube is 3/4 xi, to 1/4
            cube = f3 * r**3 / 4
            return f0 + f2 * r * r * SQUARE + AROUND * cube, {0: f1 * r + 3 * cube}
        torque, slope = self._part(pieces[0], low, high)
        for piece in pieces[1:]:
            more = self._part(piece, low, high)
            torque, slope = torque.union(more[0]), slope.union(more[1])
        middle, lean = self.at(m), slope.mid()
        centre = middle + AROUND * ((slope - lean) * r).abs_upper()
        if torque.rad() < centre.rad():
            return torque, {0: arb(0)}
        return centre, {0: lean * r}

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
            value = self._part(piece, low, high)[1]
            found = value if found is None else found.union(value)
        return found

    def energy(self, x: Any) -> Any:
        """Energy at a ball of fold angles: of the law above its least (as far as that is looked for: nothing rests on
        it), less the work of the preload."""
        if self._least is None:
            # breaks, and zeros of the torque between two of them: by bisection
            some = [self._integral(arb(b)) for b in self.breaks]
            for piece, (low, high) in enumerate(pairwise(self.breaks)):
                ends = [self._plain(piece, b) for b in (low, high)]
                if ends[0] < 0 < ends[1]:
                    for _ in range(60):
                        middle = 0.5 * (low + high)
                        below = self._plain(piece, middle) < 0
                        low, high = (middle, high) if below else (low, middle)
                    some.append(self._integral(arb(low)))
            self._least = min(some, key=lambda v: float(v.mid()))
        middle = x.mid()
        whole = self._integral(middle) - self._least - self.preload * middle
        return whole + self.at(x) * (x - middle)

    def _plain(self, piece: int, x: float) -> float:
        """About the torque without the preload."""
        return float((self._expanded(piece, arb(x))[0] + self.preload).mid())

    @property
    def size(self) -> float:
        """About the largest energy, of pieces."""
        return max(abs(float(v.mid())) for v in self.energies)

    def _integral(self, x: Any) -> Any:
        """Energy without the preload, from the first break on."""
        piece = bisect_right(self.inner, float(x.mid()))
        a, b, c, d = self.pieces[piece]
        t = x - arb(self.breaks[piece])
        work = (((a / 4 * t + b / 3) * t + c / 2) * t + d) * t
        return self.energies[piece] + work + self.preload * (x - arb(self.breaks[0]))


def _ball(value: Fraction) -> Any:
    return arb(fmpq(value.numerator, value.denominator))


def _outside(x: Any) -> tuple[float, float]:
    """Doubles that enclose a ball."""
    return (math.nextafter(float(x.lower()), -math.inf), math.nextafter(float(x.upper()), math.inf))
