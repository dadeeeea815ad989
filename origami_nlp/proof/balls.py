"""Balls (centre and radius) with proved rounding, and jets of them: a function with its derivative.

Each operation on doubles errs by at most u = 2^-53 of its result; radii are enlarged by that and by what rounding does
to themselves, as in `proof.affine`.  A ball that is not finite says nothing: no comparison with it is certain.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from origami_nlp.proof.rows import SLIGHTLY, TINY, TRIGONOMETRIC, UNIT


@dataclass(frozen=True, eq=False)
class Ball:
    """Numbers within `radius` of `centre`, both of one shape."""

    centre: np.ndarray
    radius: np.ndarray

    @property
    def magnitude(self) -> np.ndarray:
        """An upper bound of |x|."""
        return (np.abs(self.centre) + self.radius) * SLIGHTLY

    @property
    def sign(self) -> np.ndarray:
        """-1 or 1 where it is certain, else 0."""
        return np.where(np.abs(self.centre) > self.radius, np.sign(self.centre), 0.0)

    def __neg__(self) -> Ball:
        return Ball(-self.centre, self.radius)

    def __add__(self, other: Ball) -> Ball:
        return rounded(self.centre + other.centre, self.radius + other.radius)

    def __sub__(self, other: Ball) -> Ball:
        return self + -other

    def __mul__(self, other: Ball) -> Ball:
        a, b = self, other
        radius = np.abs(a.centre) * b.radius + (np.abs(b.centre) + b.radius) * a.radius
        return rounded(a.centre * b.centre, radius)

    def inverse(self) -> Ball:
        """Return 1/x; not finite where x may be 0."""
        size = np.abs(self.centre)
        room = np.where(size > self.radius, size - self.radius, np.nan)
        return rounded(1 / self.centre, self.radius / (size * room))

    def root(self) -> Ball:
        """Return the square root of x, of what of it is positive."""
        high = np.sqrt(np.maximum(self.centre + self.radius, 0.0))
        low = np.sqrt(np.maximum(self.centre - self.radius, 0.0))
        return rounded(0.5 * (low + high), 0.5 * (high - low) + 2 * UNIT * high)

    def sine(self) -> Ball:
        """Return sin x."""
        return Ball(np.sin(self.centre), self.radius * SLIGHTLY + TRIGONOMETRIC)

    def cosine(self) -> Ball:
        """Return cos x."""
        return Ball(np.cos(self.centre), self.radius * SLIGHTLY + TRIGONOMETRIC)

    def widened(self, by: np.ndarray) -> Ball:
        """Return the numbers within so much of these."""
        return Ball(self.centre, (self.radius + by) * SLIGHTLY)


def rounded(centre: np.ndarray, radius: np.ndarray) -> Ball:
    """Return a ball round a result that was rounded once or twice."""
    return Ball(centre, (radius + 4 * UNIT * np.abs(centre)) * SLIGHTLY + TINY)


def exact(values: np.ndarray | float) -> Ball:
    """Return doubles as they are."""
    c = np.asarray(values, float)
    return Ball(c, np.zeros_like(c))


def rational(value: Fraction) -> Ball:
    """Return the ball of a fraction."""
    return rounded(np.array(float(value)), np.array(0.0))


def argument(x: Ball, y: Ball) -> Ball:
    """Return the argument of x + i y in (-pi, pi], to within its radius modulo 2 pi; not finite where that may be 0."""
    far = np.hypot(x.centre, y.centre)
    share = np.hypot(x.radius, y.radius) / far
    # a disk seen from the origin: arcsin t <= pi t / 2
    radius = np.where(share < 1, 1.6 * share, np.nan) + 4 * TRIGONOMETRIC
    return Ball(np.arctan2(y.centre, x.centre), radius)


@dataclass(frozen=True, eq=False)
class Jet:
    """A function f of one variable over boxes with its derivative f'."""

    value: Ball
    slope: Ball

    def __neg__(self) -> Jet:
        return Jet(-self.value, -self.slope)

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.value + other.value, self.slope + other.slope)

    def __mul__(self, other: Jet | Ball) -> Jet:
        f, g = self, other
        if isinstance(g, Ball):
            return Jet(f.value * g, f.slope * g)
        return Jet(f.value * g.value, f.slope * g.value + f.value * g.slope)

    def plus(self, constant: Ball) -> Jet:
        """Return f + c."""
        return Jet(self.value + constant, self.slope)

    def inverse(self) -> Jet:
        """Return 1/f."""
        r = self.value.inverse()
        return Jet(r, -(r * r * self.slope))

    def inverse_root(self) -> Jet:
        """Return f^(-1/2)."""
        r = self.value.root().inverse()
        return Jet(r, exact(-0.5) * r * r * r * self.slope)
