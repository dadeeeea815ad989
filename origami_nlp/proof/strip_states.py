"""The closed states of a strip: flat vertices of degree four in a row, each sharing a crease with the next, opposite.

Round a vertex with creases 1..4 and sectors a_i from crease i to crease i + 1, the arc D between creases 2 and 4 is a
side of two spherical triangles, and where the sectors sum to 2 pi the two laws of cosines,

    cos D = cos a4 cos a1 - sin a4 sin a1 cos phi1 = cos a2 cos a3 - sin a2 sin a3 cos phi3,

are equal at phi = 0 and so say (1 - cos phi3) = q (1 - cos phi1), that is

    sin(phi3/2) = +-sqrt(q) sin(phi1/2),    q = sin a1 sin a4 / (sin a2 sin a3).

So along the row sin(phi_i/2) = s_i rho_i sin theta with signs s_i and max rho = 1: for k vertices 2^k curves over theta
in [-pi/2, pi/2] that meet at the flat state alone.  Where sin D is not 0 the triangles give the other two folds,

    phi2 = arg(-conj(zA zB)),  zA = sin a1 cos a4 + cos a1 sin a4 cos phi1 + i sin a4 sin phi1,  zB so of a2, a3, phi3,
    d arg zA / d phi1 = sin a4 (sin a1 cos a4 cos phi1 + cos a1 sin a4) / sin^2 D,

so that there are no other closed states.  D = pi needs creases 2 and 4 in one line and phi1 = 0; D = 0 needs a1 = a4
and a2 = a3: vertices of these two kinds are refused, and those that get to fold flat: there signs may be others as
well.  A vertex closes as paper (turned by no full turn) until one of phi2, phi4 has passed +-pi, and again when the
other has.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple, Protocol

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import Pattern
from origami_nlp.proof.balls import Ball, Jet, argument, exact, rational
from origami_nlp.proof.flat_sheets import (
    Vector,
    VertexRound,
    between,
    cross,
    dot,
    flat_sheet,
    off_line,
    sector,
    sector_sum,
)

MOST_VERTICES = 8
"""In a row: 256 curves."""
REACHES = 1e-6
"""Squares of rho that are less by this share reach 180 degrees as well, where vertices that fold flat are refused."""
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
    """A vertex of a strip: its creases, the first and third in the row, and what is on both sides of it."""

    creases: tuple[int, ...]
    sides: tuple[Side, Side]
    directions: np.ndarray


@dataclass(frozen=True)
class Strip:
    """Vertices in a row, [k], the squares of rho along it, [k + 1], which are fractions; and `SheetInPlane.moved`."""

    corners: tuple[Corner, ...]
    squares: tuple[Fraction, ...]
    moved: float

    @property
    def row(self) -> list[int]:
        """Creases along the row, [k + 1]."""
        return [c.creases[0] for c in self.corners] + [self.corners[-1].creases[2]]

    @property
    def across(self) -> list[int]:
        """Creases across the row, those of a vertex together, [2 k]."""
        return [c for v in self.corners for c in (v.creases[1], v.creases[3])]

    @property
    def beside(self) -> list[tuple[int, int]]:
        """Pairs of those at one vertex, by their places in `across`."""
        return [(2 * i, 2 * i + 1) for i in range(len(self.corners))]

    def states(self, signs: np.ndarray, theta: Ball, at: FoldStates | None = None) -> StripStates:
        """Return states over boxes of theta, on curves with these signs, [k + 1, K]."""
        return StripStates(self, signs, theta)


def as_strip(pattern: Pattern) -> tuple[Strip | None, str]:
    """Return the vertices of a pattern in a row, or None and why the pattern is no strip that can be proved.

    Sectors are those of the corners as they are, in exact arithmetic.
    """
    sheet, why = flat_sheet(pattern)
    if sheet is None:
        return None, why
    if len(sheet.rounds) > MOST_VERTICES:
        return None, f"{len(sheet.rounds)} vertices in a row (at most {MOST_VERTICES})"
    rounds = [r.creases for r in sheet.rounds]
    why = "vertices are not in a row, each sharing a crease with the next one opposite"
    reasons = []
    for end, first in itertools.product(range(len(rounds)), range(4)):
        order = _row(rounds, end, first)
        if order is None:
            continue
        rings = [sheet.rounds[v].turned(at) for v, at in order]
        if bad := next(filter(None, map(_why_no_corner, rings)), ""):
            reasons.append(bad)
            continue
        corners = [corner_of(ring) for ring in rings]
        # any other crease is a free hinge, whose energy the curves know nothing of
        around = {crease for c, _ in corners for crease in c.creases}
        if not len(around) == 3 * len(corners) + 1 == pattern.creases:
            reasons.append("a crease is none of the row, or two vertices share more than one")
            continue
        squares = [Fraction(1)]
        for _, ratio in corners:
            squares.append(squares[-1] * ratio)
        largest = max(squares)
        # folded flat it closes by other signs than at the ends of curves, too
        folds = [
            ring.vertex
            for ring, s in zip(rings, squares, strict=False)
            if sector_sum(ring.directions) <= CLOSURE_TOL and largest - s <= REACHES * largest
        ]
        if folds:
            reasons.append(f"vertex {min(folds)} folds flat")
            continue
        return Strip(
            tuple(c for c, _ in corners), tuple(s / largest for s in squares), sheet.moved
        ), ""
    return None, min(reasons, default=why)


def why_no_strip(pattern: Pattern) -> str:
    """Return why a pattern is no strip whose minima are proved; "" where it is.

    Parameters
    ----------
    pattern
        Of any number of vertices.

    Returns
    -------
    str
        The first vertex that is in the way, and why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import why_no_strip
    >>> why_no_strip(o.examples.pattern("miura", 2, 3))
    'vertex 2 is symmetric about the row'
    """
    return why_no_stop(pattern) or as_strip(pattern)[1]


def why_no_stop(pattern: Pattern) -> str:
    """Return which crease has a stop where all curves meet; "" where none has."""
    if any(0.0 in pair for pair in pattern.limits):
        crease = next(i for i, pair in enumerate(pattern.limits, start=1) if 0.0 in pair)
        return f"crease {crease} has a stop at 0 degrees, where all curves meet"
    return ""


def _row(rounds: Sequence[tuple[int, ...]], end: int, first: int) -> list[tuple[int, int]] | None:
    """Return all vertices in a row from a crease of one, each with the place where it begins; None: they are not."""
    order, vertex, crease = [], end, rounds[end][first]
    while True:
        at = rounds[vertex].index(crease)
        ring = rounds[vertex][at:] + rounds[vertex][:at]
        order.append((vertex, at))
        beyond = [v for v, others in enumerate(rounds) if ring[2] in others and v != vertex]
        if not beyond or len(order) > len(rounds):
            break
        vertex, crease = beyond[0], ring[2]
    return order if sorted(v for v, _ in order) == list(range(len(rounds))) else None


def _why_no_corner(ring: VertexRound) -> str:
    """Return why the folds of a vertex, its creases from one of the row, are not known; "" where they are."""
    u = ring.directions
    if off_line(u[1], u[3]) <= CLOSURE_TOL:
        return f"at vertex {ring.vertex} the creases across the row are in one line"
    beside = sector(u[0], u[1]), sector(u[3], u[0])
    if off_line(u[0], u[2]) <= CLOSURE_TOL and between(*beside) <= CLOSURE_TOL:
        return f"vertex {ring.vertex} is symmetric about the row"
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


class FoldStates(Protocol):
    """States of curves over boxes of theta, [K]."""

    @property
    def angles(self) -> dict[int, Ball]:
        """phi of each crease, modulo a full turn."""

    @property
    def slopes(self) -> dict[int, Jet]:
        """phi' of each crease, with phi''."""

    @property
    def outside(self) -> np.ndarray:
        """Where no state closes within fold limits, known without asking the vertices."""

    @property
    def narrow(self) -> np.ndarray:
        """Whether all fold angles are known to within so little that four of them are no quarter of a turn."""

    def closes(self) -> np.ndarray:
        """Return which vertices come back turned by no full turn, [k, K]; asked of boxes that are narrow."""


class FoldCurves(Protocol):
    """Curves of closed states."""

    @property
    def across(self) -> list[int]:
        """Creases that may reach +-180 degrees before the curve ends."""

    @property
    def beside(self) -> list[tuple[int, int]]:
        """Pairs of those at one vertex, by their places in `across`."""

    def states(self, signs: np.ndarray, theta: Ball, at: Any = None) -> FoldStates:
        """Return states over boxes of theta, on curves with these signs; those in the middles may help."""


class StripStates:
    """States of a strip over boxes of theta, on curves with these signs, [k + 1, K]."""

    def __init__(self, strip: Strip, signs: np.ndarray, theta: Ball) -> None:
        self.strip = strip
        self.slopes: dict[int, Jet] = {}
        self.angles: dict[int, Ball] = {}
        zero = exact(np.zeros_like(theta.centre))
        s, c = theta.sine(), theta.cosine()
        sine, cosine = Jet(s, c), Jet(c, -s)
        row = []
        for crease, square, sign in zip(strip.row, strip.squares, signs, strict=True):
            rho = exact(sign) * rational(square).root()
            # sin^2(phi/2) = rho^2 sin^2 theta, cos^2(phi/2) = cos^2 theta + (1 - rho^2) sin^2 theta
            low = sine * sine * rational(square)
            high = cosine * cosine + sine * sine * rational(1 - square)
            if square == 1:  # phi = 2 theta
                angle, rate = exact(sign) * theta, Jet(exact(2 * sign) + zero, zero)
                product = exact(sign) * s * c
            else:
                angle = argument(high.value.root(), rho * s)
                rate = cosine * high.inverse_root() * (rho + rho)
                product = rho * s * high.value.root()
            self.angles[crease], self.slopes[crease] = angle + angle, rate
            row.append(Fold(low + low, high + high, product + product, rate))
        for corner, before, after in zip(strip.corners, row[:-1], row[1:], strict=True):
            for crease, (angle, rate) in zip(
                (1, 3), other_folds(corner, before, after), strict=True
            ):
                self.angles[corner.creases[crease]] = angle
                self.slopes[corner.creases[crease]] = rate

    @property
    def outside(self) -> np.ndarray:
        """Where no state closes within fold limits, known without asking the vertices: nowhere, [K]."""
        return np.zeros(self.narrow.shape, bool)

    def closes(self) -> np.ndarray:
        """Return which vertices come back turned by no full turn, [k, K]; asked of boxes that are narrow (`narrow`)."""
        return closing(self.strip.corners, self.angles, self.narrow.shape)

    @property
    def narrow(self) -> np.ndarray:
        """Whether all fold angles are known to within so little that four of them are no quarter of a turn, [K]."""
        return is_narrow(self.angles)


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
