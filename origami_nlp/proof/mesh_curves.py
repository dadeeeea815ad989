"""The energy along a curve of a mesh whose vertices fold flat, enclosed: where it is stationary, and how it ends.

Rows x of a curve move by tan(x/2) = sign kappa tan theta, theta in [-pi/2, pi/2], U = sum_rows K x^2/2 - L x with
K = sum k, L = sum k sign rest of its creases, which are fractions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from origami_nlp.proof.balls import Ball, Jet, argument, exact, rational
from origami_nlp.proof.mesh_states import Curve, FoldingMesh, Key
from origami_nlp.proof.rows import variables

NARROWEST = 2.0**-44
"""Width of theta below which a box is left open [rad]."""
QUARTER = math.nextafter(0.5 * math.pi, math.inf)
"""Not below pi/2, which is between two doubles."""
FIRST = np.array([-QUARTER, -1.0, -0.1, 0.13, 1.0, QUARTER])
"""Where the first boxes end [rad]: the flat state, theta = 0, is within one, at any depth."""


@dataclass
class CurveMinima:
    """What is known of the energy along a curve.

    Attributes
    ----------
    inside
        Theta of each minimum between two numbers; both are 0 where it is the flat state exactly.
    maxima
        How many lie between the ends.
    ends
        Sign of U' at theta = -pi/2 and pi/2; 0 where it is not certain.
    flat
        Sign of U' at theta = 0, None where it is not certain, and of U''.
    open
        Theta between two numbers, where nothing is decided.
    boxes
        How many were examined.
    """

    inside: list[tuple[float, float]] = field(default_factory=list)
    maxima: int = 0
    ends: tuple[int, int] = (0, 0)
    flat: tuple[int | None, int] = (None, 0)
    open: list[tuple[float, float]] = field(default_factory=list)
    boxes: int = 0


class CurveEnergy:
    """U' and U'' along a curve."""

    def __init__(
        self, mesh: FoldingMesh, curve: Curve, stiffness: np.ndarray, rest: np.ndarray
    ) -> None:
        sums: dict[Key, list[Fraction]] = {}
        for member in curve:
            both = sums.setdefault(member.key, [Fraction(0), Fraction(0)])
            for crease, sign in member.creases:
                k = Fraction(float(stiffness[crease]))
                both[0] += k
                both[1] += k * member.sign * sign * Fraction(float(rest[crease]))
        self.even = not any(load for _, load in sums.values())
        self.rows = [
            (mesh.multiplier(key), rational(k), rational(load)) for key, (k, load) in sums.items()
        ]

    def slopes(self, low: np.ndarray, high: np.ndarray) -> tuple[Ball, Ball]:
        """Return U' and U'' over boxes of theta."""
        middle, half = variables(low, high)
        first, second = exact(np.zeros_like(middle)), exact(np.zeros_like(middle))
        for kappa, k, load in self.rows:
            at, rate, _ = fold(kappa, exact(middle))
            _, wide, bend = fold(kappa, Ball(middle, half))
            over = at.widened(wide.magnitude * half)
            first = first + (k * at - load) * rate
            second = second + k * wide * wide + (k * over - load) * bend
        return first.widened(second.magnitude * half), second

    def minima(self, most: int) -> CurveMinima:
        """Find where the energy is least, in so many boxes of theta at most."""
        found = CurveMinima()
        low, high = FIRST[:-1], FIRST[1:]
        pieces: list[tuple[float, float, int, int]] = []
        with np.errstate(all="ignore"):
            while len(low):
                stop = found.boxes + len(low) > most
                found.boxes += len(low)
                first, second = (b.sign.astype(int) for b in self.slopes(low, high))
                split = (first == 0) & (second == 0) & (high - low > NARROWEST) & (not stop)
                kept = ~split
                pieces += zip(*(x[kept].tolist() for x in (low, high, first, second)), strict=True)
                middle = 0.5 * (low + high)[split]
                low, high = np.r_[low[split], middle], np.r_[middle, high[split]]
            self._along(sorted(pieces), found)
            zero = self._sign(0.0)
            bend = self.slopes(np.zeros(1), np.zeros(1))[1]
            found.flat = 0 if self.even else (zero or None), int(bend.sign[0])
            found.ends = self._sign(-QUARTER), self._sign(QUARTER)
        return found

    def _along(self, pieces: list[tuple[float, float, int, int]], found: CurveMinima) -> None:
        joined: list[tuple[float, float, int]] = []
        for low, high, first, second in pieces:
            if first:
                continue
            if joined and joined[-1][1] == low and joined[-1][2] == second:
                joined[-1] = (joined[-1][0], high, second)
            else:
                joined.append((low, high, second))
        for low, high, second in joined:
            one, two = (self._sign(x) for x in (low, high))
            if not second or not one or not two:
                found.open.append((low, high))
            elif one != two and second < 0:
                found.maxima += 1
            elif one != two:
                if self.even and low <= 0 <= high:
                    found.inside.append((0.0, 0.0))
                    continue
                narrow = self._narrowed(low, high)
                (found.open if narrow[0] <= 0 <= narrow[1] else found.inside).append(narrow)

    def _narrowed(self, low: float, high: float) -> tuple[float, float]:
        """Return where U' changes from negative to positive, as far as its sign is certain."""
        while (middle := 0.5 * (low + high)) not in (low, high):
            sign = self._sign(middle)
            if not sign:
                quarter = 0.5 * (low + middle), 0.5 * (middle + high)
                signs = self._sign(quarter[0]), self._sign(quarter[1])
                if not any(signs):
                    break
                low, high = (
                    (quarter[0] if signs[0] < 0 else low),
                    (quarter[1] if signs[1] > 0 else high),
                )
                continue
            low, high = (middle, high) if sign < 0 else (low, middle)
        return low, high

    def _sign(self, theta: float) -> int:
        """Return the sign of U' at one state, 0 where it is not certain."""
        at = np.array([theta])
        # an end of the curve is between two doubles
        inner = np.where(np.abs(at) > 0.5 * math.pi, np.nextafter(at, 0.0), at)
        return int(self.slopes(np.fmin(at, inner), np.fmax(at, inner))[0].sign[0])


def fold(kappa: Ball, theta: Ball) -> tuple[Ball, Ball, Ball]:
    """Return x = 2 atan(kappa tan theta) from -pi to pi, x' and x''."""
    s, c = theta.sine(), theta.cosine()
    sine, cosine = Jet(s, c), Jet(c, -s)
    half = argument(c, kappa * s)
    rate = (cosine * cosine + sine * sine * (kappa * kappa)).inverse() * (kappa + kappa)
    return half + half, rate.value, rate.slope
