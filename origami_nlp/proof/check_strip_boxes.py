"""The states of a strip over a box of theta, for the check of a proof: folds, the slope of the energy, what closes."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

from flint import arb

from origami_nlp.proof.check_strip_sheet import CurveStates, FlatSheet, lifted, turned


class ThetaBall:
    """The states of a box of a curve: folds in the middle, over it, and U' and U''."""

    def __init__(self, sheet: FlatSheet, signs: Sequence[int], low: Any, high: Any) -> None:
        self.sheet = sheet
        low, high = arb(low), arb(high)
        self.middle = ((low + high) / 2).mid()
        self.theta = low.union(high)
        self.away = self.theta - self.middle
        self.at, self.box = (CurveStates(sheet, signs, t) for t in (self.middle, self.theta))
        self.known = self.at.finite and self.box.finite
        # phi = phi(middle) + phi' (theta - middle)
        self.folds = [
            a[0] + b[1] * self.away for a, b in zip(self.at.folds, self.box.folds, strict=True)
        ]
        self.turns: dict[int, Any] = {}
        self.corners: Any = None

    def slope(self) -> tuple[Any, Any]:
        """Return U' and U'' over the box."""
        first, second = arb(0), arb(0)
        sheet = self.sheet
        for c, (a, b) in enumerate(zip(self.at.folds, self.box.folds, strict=True)):
            first += sheet.torque(c, a[0] + self.turns.get(c, 0)) * a[1]
            fold = self.folds[c]
            # of a law whose slope jumps: all slopes, on both sides
            second += sheet.bend(c, fold) * b[1] * b[1] + 2 * sheet.torque(c, fold) * b[2]
        return first + second * self.away, second

    def follow(self, before: Sequence[float]) -> None:
        """Continue folds across the row without a jump from those of a state of the box."""
        for c in self.sheet.across:
            moved = lifted(self.at.folds[c][0], before[c])
            self.turns[c] = moved - self.at.folds[c][0]
            self.folds[c] = self.folds[c] + self.turns[c]
            if not abs(self.box.folds[c][1] * self.away) < 1:
                self.known = False

    def inside(self, but: Collection[tuple[int, int]] = ()) -> bool:
        """Return whether all states close as paper and no fold is beyond +-180 degrees, or a stop, certainly."""
        across = [self.folds[c] for c in self.sheet.across]
        if not self.known or not all(abs(a) < arb.pi() for a in across):
            return False
        if not self.within_stops(but):
            return False
        return all(turned(v, self.folds) > 0 for v in self.sheet.vertices)

    def within_stops(self, but: Collection[tuple[int, int]] = ()) -> bool:
        """Return whether no fold is at a stop or beyond, certainly, but for some."""
        sheet = self.sheet
        return all(s in but or bool(sheet.room(s, self.folds[s[0]]) > 0) for s in sheet.stops)

    def _beyond(self, stop: tuple[int, int]) -> bool:
        """Return whether a fold is beyond a stop, certainly: it is known modulo a full turn."""
        crease, side = stop
        fold = self.folds[crease]
        if not self.sheet.room(stop, fold) < 0:
            return False
        other = self.sheet.said.limits[crease][0 if side > 0 else 1]
        # once round it is beyond the other limit
        return bool(side * (fold - arb(other)) < 2 * arb.pi())

    def outside(self) -> bool:
        """Return whether no state closes as paper within stops, certainly: principal values within a half-turn."""
        if not self.known:
            return False
        if any(self._beyond(stop) for stop in self.sheet.stops):
            return True
        return any(
            all(abs(self.folds[c]) < arb.pi() for c in (v.creases[1], v.creases[3]))
            and bool(turned(v, self.folds) < 0)
            for v in self.sheet.vertices
        )
