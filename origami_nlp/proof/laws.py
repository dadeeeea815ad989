"""Torques of hinge laws over balls.

The pieces of a `HingeLaw` meet to rounding only.  Meant is the continuous torque whose slope is that of the pieces,
from its value at the first break on: it differs from the pieces by the sum of what they jump by at most (`drift`).  The
first piece and the last go on beyond the ends.
"""

from __future__ import annotations

import functools
import itertools
from typing import Any

from flint import arb

from origami_nlp.pattern import HingeLaw

FAR = 10.0
"""Beyond all fold angles [rad]."""


class LawBalls:
    """A law over balls (python-flint): the torque that is meant, and its slopes on both sides of what is a knot."""

    def __init__(self, law: HingeLaw) -> None:
        rows = [[arb(v) for v in row] for row in law.coefficients]
        self.pieces = [(arb(b), row) for b, row in zip(law.breaks, rows, strict=False)]
        ends = [-FAR, *law.breaks[1:-1], FAR]
        self.parts = [arb(a).union(arb(b)) for a, b in itertools.pairwise(ends)]
        jumps = arb(0)
        for (start, (a, b, c, d)), (end, row) in itertools.pairwise(self.pieces):
            h = end - start
            jumps += abs(((a * h + b) * h + c) * h + d - row[3])
        self.drift = arb(0, jumps.upper())

    def over(self, phi: Any) -> tuple[Any, Any]:
        """Return the torque and its slope; nothing where the angle is not known."""
        if not abs(phi) < FAR:
            return arb.nan(), arb.nan()
        found = []
        for part, (start, (a, b, c, d)) in zip(self.parts, self.pieces, strict=True):
            if part.overlaps(phi):
                t = phi.intersection(part) - start
                found.append((((a * t + b) * t + c) * t + d, (3 * a * t + 2 * b) * t + c))
        torque, slope = (functools.reduce(arb.union, v) for v in zip(*found, strict=True))
        return torque + self.drift, slope
