"""Torques of hinge laws over balls.

The pieces of a `HingeLaw` meet to rounding only.  Meant is the continuous torque whose slope is that of the pieces,
from its value at the first break on: it differs from the pieces by the sum of what they jump by at most (`drift`).  The
first piece and the last go on beyond the ends.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left, bisect_right
from typing import Any

from flint import arb

from origami_nlp.pattern import HingeLaw


class LawBalls:
    """A law over balls (python-flint): the torque that is meant, and its slopes on both sides of what is a knot."""

    def __init__(self, law: HingeLaw) -> None:
        self.inner = law.breaks[1:-1]
        self.pieces = [
            (arb(b), [arb(v) for v in row])
            for b, row in zip(law.breaks[:-1], law.coefficients, strict=True)
        ]
        jumps = arb(0)
        for (start, (a, b, c, d)), (end, row) in itertools.pairwise(self.pieces):
            h = end - start
            jumps += abs(((a * h + b) * h + c) * h + d - row[3])
        self.drift = arb(0, jumps.upper())

    def over(self, phi: Any) -> tuple[Any, Any]:
        """Return the torque and its slope; nothing where the angle is not known."""
        if not phi.is_finite():
            return arb.nan(), arb.nan()
        low, high = (
            bisect(self.inner, math.nextafter(float(end), way))
            for bisect, end, way in (
                (bisect_left, phi.lower(), -math.inf),
                (bisect_right, phi.upper(), math.inf),
            )
        )
        found = []
        for k in range(low, high + 1):
            start, (a, b, c, d) = self.pieces[k]
            x = phi
            if k > low or k < high:
                ends = [
                    phi.lower() if k == low else start,
                    phi.upper() if k == high else self.pieces[k + 1][0],
                ]
                x = ends[0].union(ends[1])
            t = x - start
            found.append((((a * t + b) * t + c) * t + d, (3 * a * t + 2 * b) * t + c))
        torque, slope = found[0]
        for one, other in found[1:]:
            torque, slope = torque.union(one), slope.union(other)
        return torque + self.drift, slope
