"""Folds round a flat vertex of degree four, from two opposite ones.

Round a vertex with creases 1..4 and sectors a_i from crease i to crease i + 1, the arc D between creases 2 and 4 is a
side of two spherical triangles, and where the sectors sum to 2 pi the two laws of cosines,

    cos D = cos a4 cos a1 - sin a4 sin a1 cos phi1 = cos a2 cos a3 - sin a2 sin a3 cos phi3,

are equal at phi = 0 and so say (1 - cos phi3) = q (1 - cos phi1), that is

    sin(phi3/2) = +-sqrt(q) sin(phi1/2),    q = sin a1 sin a4 / (sin a2 sin a3).

Where sin D is not 0 the triangles give the other two folds,

    phi2 = arg(-conj(zA zB)),  zA = sin a1 cos a4 + cos a1 sin a4 cos phi1 + i sin a4 sin phi1,  zB so of a2, a3, phi3,
    d arg zA / d phi1 = sin a4 (sin a1 cos a4 cos phi1 + cos a1 sin a4) / sin^2 D,

so that there are no other closed states.  D = pi needs creases 2 and 4 in one line and phi1 = 0; D = 0 needs a1 = a4
and a2 = a3: vertices of these two kinds are refused, and those that fold flat.  A vertex closes as paper (turned by no
full turn) until one of phi2, phi4 has passed +-pi, and again when the other has.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from origami_nlp.pattern import Pattern
from origami_nlp.proof.balls import Ball, Jet, argument, exact, rational
from origami_nlp.proof.flat_sheets import (
    Vector,
    VertexRound,
    cross,
    dot,
)

NARROW = 0.1
"""Radius of a fold angle, of which four make less than a quarter of a turn [rad]."""


class Side(NamedTuple):
    """Two sectors beside a crease of the row: b towards the second crease of its vertex, c towards the fourth.

    Their sines and cosines, and sin(b + c), 1 + cos(b + c), 1 - cos(b - c), each to within rounding of itself.
    """

    sin_b: Ball
    cos_b: Ball
    sin_c: Ball
    cos_c: Ball
    sine_of_sum: Ball
    beyond: Ball
    apart: Ball

    @property
    def turned(self) -> Side:
        """The same seen from the other side: b and c change places."""
        return self._replace(sin_b=self.sin_c, cos_b=self.cos_c, sin_c=self.sin_b, cos_c=self.cos_b)


class Corner(NamedTuple):
    """A vertex: its creases, the first and third opposite in a row, and what is on both sides of it."""

    creases: tuple[int, ...]
    sides: tuple[Side, Side]
    directions: np.ndarray


def why_no_stop(pattern: Pattern) -> str:
    """Return which crease has a stop where all curves meet; "" where none has."""
    if any(0.0 in pair for pair in pattern.limits):
        crease = next(i for i, pair in enumerate(pattern.limits, start=1) if 0.0 in pair)
        return f"crease {crease} has a stop at 0 degrees, where all curves meet"
    return ""


def corner_of(ring: VertexRound) -> tuple[Corner, Fraction]:
    """Return a vertex, from one of its creases, and q of the row of that."""
    u = ring.directions
    a1, a2, a3, a4 = (cross(u[i], u[(i + 1) % 4]) for i in range(4))
    q = a1 * a4 * dot(u[2], u[2]) / (a2 * a3 * dot(u[0], u[0]))
    sides = tuple(_side(u, ring.sense, *three) for three in ((1, 0, 3), (1, 2, 3)))
    unit = np.array([[float(x) for x in v] for v in u])
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    return Corner(ring.creases, sides, unit), q  # type: ignore[arg-type]


def _side(u: Sequence[Vector], sense: int, before: int, at: int, after: int) -> Side:
    """Return the sectors between a crease of the row and the two across, from directions of creases."""
    second, row, fourth = u[before], u[at], u[after]

    def over(value: Fraction, *creases: Vector) -> Ball:
        """Divide by the lengths of directions: exact but for one root."""
        square = math.prod((dot(c, c) for c in creases), start=Fraction(1))
        return rational(value) * rational(square).root().inverse()

    # sectors run from crease 4 over 1 to 2, and from 2 over 3 to 4
    turn = sense if at == 0 else -sense
    sin_sum, cos_sum = turn * cross(fourth, second), dot(fourth, second)
    far = dot(second, second) * dot(fourth, fourth)
    sin_apart = abs(cross(row, second)) * dot(row, fourth) - abs(cross(row, fourth)) * dot(
        row, second
    )
    cos_apart = dot(row, second) * dot(row, fourth) + abs(cross(row, second) * cross(row, fourth))

    def one_plus(cosine: Fraction, sine: Fraction, square: Fraction) -> Ball:
        """1 + cos x = sin^2 x / (1 - cos x) where that is small; sine and cosine times the root of a square."""
        root = rational(square).root()
        if cosine > 0:
            return exact(1.0) + rational(cosine) * root.inverse()
        return (
            rational(sine**2 / square) * (exact(1.0) - rational(cosine) * root.inverse()).inverse()
        )

    whole = far * dot(row, row) ** 2
    return Side(
        over(abs(cross(row, second)), row, second),
        over(dot(row, second), row, second),
        over(abs(cross(row, fourth)), row, fourth),
        over(dot(row, fourth), row, fourth),
        over(sin_sum, second, fourth),
        one_plus(cos_sum, sin_sum, far),
        one_plus(-cos_apart, sin_apart, whole),
    )


def is_narrow(angles: dict[int, Ball]) -> np.ndarray:
    """Return whether all fold angles are known to within so little that four of them are no quarter of a turn, [K]."""
    return np.all([a.radius < NARROW for a in angles.values()], axis=0)


def closing(
    corners: Sequence[Corner], angles: dict[int, Ball], shape: tuple[int, ...]
) -> np.ndarray:
    """Return which vertices come back turned by no full turn, [k, K], from the middles of fold angles."""
    found = []
    for corner in corners:
        q = np.zeros((4, *shape))
        q[0] = 1.0
        for crease, (x, y) in zip(corner.creases, corner.directions, strict=True):
            half = 0.5 * np.broadcast_to(angles[crease].centre, shape)
            r, i, j = np.cos(half), np.sin(half) * x, np.sin(half) * y
            a, b, c, d = q
            # q (r + i I + j J)
            q = np.array(
                [
                    a * r - b * i - c * j,
                    a * i + b * r - d * j,
                    a * j + c * r + d * i,
                    d * r + b * j - c * i,
                ]
            )
        found.append(q[0] > 0)
    return np.array(found)


class Fold(NamedTuple):
    """A fold phi over boxes: 1 - cos phi, 1 + cos phi, sin phi and phi'."""

    low: Jet
    high: Jet
    sine: Ball
    rate: Jet

    @classmethod
    def of(cls, angle: Ball, rate: Jet) -> Fold:
        """Return it from phi and phi'."""
        half = exact(0.5) * angle
        s, c = half.sine(), half.cosine()
        sine = exact(2.0) * s * c
        turn = sine * rate.value
        return cls(Jet(exact(2.0) * s * s, turn), Jet(exact(2.0) * c * c, -turn), sine, rate)


def other_folds(corner: Corner, before: Fold, after: Fold) -> list[tuple[Ball, Jet]]:
    """Return the second and fourth fold of a vertex, each with its rate, from the first and third."""
    found = []
    for turn in (False, True):
        sides = [side.turned if turn else side for side in corner.sides]
        (x, y, f), (v, w, g) = (_part(*p) for p in zip(sides, (before, after), strict=True))
        # phi = arg(-conj(zA zB))
        found.append((argument(y * w - x * v, x * w + y * v), -(f + g)))
    return found


def _part(side: Side, fold: Fold) -> tuple[Ball, Ball, Jet]:
    """Return z = sin b cos c + cos b sin c cos phi + i sin c sin phi, and the derivative of its argument."""
    product = side.sin_b * side.sin_c
    # sin^2 D = (1 + cos D) (1 - cos D): sums of what is positive
    square = (fold.low * product).plus(side.beyond) * (fold.high * product).plus(side.apart)
    above = (fold.low * -(side.sin_b * side.cos_c)).plus(side.sine_of_sum)
    x = side.sine_of_sum - side.cos_b * side.sin_c * fold.low.value
    return x, side.sin_c * fold.sine, above * square.inverse() * fold.rate * side.sin_c
