"""All minima of a strip: flat vertices of degree four in a row, each sharing a crease with the next one opposite.

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
and a2 = a3: vertices of these two kinds are refused.  A vertex closes as paper (turned by no full turn) until one of
phi2, phi4 has passed +-pi, and again when the other has.

Each curve is cut into boxes of theta.  The slope U' of the energy has no zero in a box, by its value in the middle and
U'' over the box; or U'' has none, and then U' has one at most, which signs of U' at the ends decide.
"""

from __future__ import annotations

import functools
import itertools
import math
import operator
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.pattern import Pattern
from origami_nlp.proof.affine import UNIT, variables
from origami_nlp.proof.balls import Ball, Jet, argument, exact, rational

HALF_TURN = math.nextafter(math.pi, 0.0)
"""Not above pi, which is between two doubles."""
MOST_VERTICES = 8
"""In a row: 256 curves."""
NARROWEST = 2.0**-44
"""Width of theta below which a box is left open [rad]."""
FIRST = np.array([-0.5 * math.pi, -1.0, -0.1, 0.13, 1.0, 0.5 * math.pi])
"""Where the first boxes end [rad]: the flat state, theta = 0, is within one, at any depth."""
NONE, RISING, FALLING, OUTSIDE, LIMIT, OPEN = range(6)
"""Kinds of boxes: U' is not 0; U'' > 0; U'' < 0; no state within fold limits; a crease reaches +-pi; undecided."""


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
    """Vertices in a row, [k], and the squares of rho along it, [k + 1], which are fractions."""

    corners: tuple[Corner, ...]
    squares: tuple[Fraction, ...]

    @property
    def row(self) -> list[int]:
        """Creases along the row, [k + 1]."""
        return [c.creases[0] for c in self.corners] + [self.corners[-1].creases[2]]


@dataclass(frozen=True)
class StripMinimum:
    """A minimum of the energy on a curve.

    Attributes
    ----------
    signs
        Of the folds along the row for theta > 0, [k + 1].
    theta
        Two numbers that it lies between [rad].
    fold_angles
        In the middle, [n] [rad].
    radius
        None of the fold angles differs by more [rad].
    at_limit
        Whether a crease is at +-pi there.
    """

    signs: tuple[int, ...]
    theta: tuple[float, float]
    fold_angles: np.ndarray
    radius: float
    at_limit: bool


@dataclass(frozen=True)
class StripProof:
    """What is proved of a strip within fold limits.

    Attributes
    ----------
    curves
        Curves through the flat state on which all closed states lie.
    minima
        On them, each once.
    maxima
        How many maxima of the energy lie inside the curves.
    undecided
        What is left open: between which fold angles [n], [n], and why.
    boxes, seconds
        Boxes of theta, and the processor time that they took.
    """

    curves: int
    minima: tuple[StripMinimum, ...]
    maxima: int
    undecided: tuple[tuple[np.ndarray, np.ndarray, str], ...]
    boxes: int
    seconds: float


def as_strip(pattern: Pattern) -> tuple[Strip | None, str]:
    """Return the vertices of a pattern in a row, or None and why the pattern is no strip that can be proved.

    Sectors are those of the corners as they are, in exact arithmetic.
    """
    if not pattern.is_flat or pattern.corners[:, 2].any():
        return None, "the reference state is not flat"
    if pattern.holes or not pattern.vertices:
        return None, "the pattern has a hole" if pattern.holes else "no vertex is inside"
    if any(len(v.creases) != 4 for v in pattern.vertices):
        return None, "a vertex has not four creases"
    if len(pattern.vertices) > MOST_VERTICES:
        return None, f"{len(pattern.vertices)} vertices in a row (at most {MOST_VERTICES})"
    rounds = [v.creases for v in pattern.vertices]
    why = "vertices are not in a row, each sharing a crease with the next one opposite"
    reasons = []
    for end, first in itertools.product(range(len(rounds)), range(4)):
        order = _row(rounds, end, first)
        if order is None:
            continue
        corners = [_corner(pattern, pattern.vertices[v].vertex, c) for v, c in order]
        bad = next((w for _, _, w in corners if w), "")
        if bad:
            reasons.append(bad)
            continue
        squares = [Fraction(1)]
        for _, ratio, _ in corners:
            squares.append(squares[-1] * ratio)
        largest = max(squares)
        return Strip(tuple(c for c, _, _ in corners), tuple(s / largest for s in squares)), ""
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
    'at vertex 6 the creases across the row are in one line'
    """
    return as_strip(pattern)[1]


def _row(
    rounds: Sequence[tuple[int, ...]], end: int, first: int
) -> list[tuple[int, tuple[int, ...]]] | None:
    """Return all vertices in a row from a crease of one of them, with their creases from there; None: they are not."""
    order, vertex, crease = [], end, rounds[end][first]
    while True:
        at = rounds[vertex].index(crease)
        ring = rounds[vertex][at:] + rounds[vertex][:at]
        order.append((vertex, ring))
        beyond = [v for v, others in enumerate(rounds) if ring[2] in others and v != vertex]
        if not beyond or len(order) > len(rounds):
            break
        vertex, crease = beyond[0], ring[2]
    return order if sorted(v for v, _ in order) == list(range(len(rounds))) else None


def _corner(pattern: Pattern, vertex: int, ring: tuple[int, ...]) -> tuple[Corner, Fraction, str]:
    """Return a vertex, q of its row, and why it is refused."""
    place = pattern.corners[:, :2]
    away = [int(pattern.ends[c].sum()) - vertex for c in ring]
    u = [
        [Fraction(x) - Fraction(y) for x, y in zip(place[w], place[vertex], strict=True)]
        for w in away
    ]

    def cross(i: int, j: int) -> Fraction:
        return u[i][0] * u[j][1] - u[i][1] * u[j][0]

    def dot(i: int, j: int) -> Fraction:
        return u[i][0] * u[j][0] + u[i][1] * u[j][1]

    name, why = f"vertex {vertex + 1}", ""
    a1, a2, a3, a4 = (cross(i, (i + 1) % 4) for i in range(4))
    q = Fraction(1)
    if min(a1, a2, a3, a4) <= 0 <= max(a1, a2, a3, a4):
        why = f"{name} has a sector of 180 degrees or more"
    else:
        q = a1 * a4 * dot(2, 2) / (a2 * a3 * dot(0, 0))
        if cross(1, 3) == 0:
            why = f"at {name} the creases across the row are in one line"
        elif cross(0, 2) == 0 and a1**2 * dot(3, 3) == a4**2 * dot(1, 1):
            why = f"{name} is symmetric about the row"
    sense = 1 if a1 > 0 else -1
    sides = tuple(_side(cross, dot, sense, *three) for three in ((1, 0, 3), (1, 2, 3)))
    directions = np.array([[float(x) for x in v] for v in u])
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return Corner(ring, sides, directions), q, why  # type: ignore[arg-type]


def _side(
    cross: Callable[[int, int], Fraction],
    dot: Callable[[int, int], Fraction],
    sense: int,
    second: int,
    row: int,
    fourth: int,
) -> Side:
    """Return the sectors between a crease of the row and the two across, from products of directions of creases."""

    def over(value: Fraction, *creases: int) -> Ball:
        """Divide by the lengths of directions: exact but for one root."""
        square = math.prod(dot(c, c) for c in creases)
        return rational(value) * rational(square).root().inverse()

    turn = (
        sense if row == 0 else -sense
    )  # sectors run from crease 4 over 1 to 2, and from 2 over 3 to 4
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


class _States:
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
            row.append(_Fold(low + low, high + high, product + product, rate))
        for corner, before, after in zip(strip.corners, row[:-1], row[1:], strict=True):
            for crease, turn in ((1, False), (3, True)):
                sides = [side.turned if turn else side for side in corner.sides]
                (x, y, f), (v, w, g) = (_part(*p) for p in zip(sides, (before, after), strict=True))
                # phi = arg(-conj(zA zB))
                self.angles[corner.creases[crease]] = argument(y * w - x * v, x * w + y * v)
                self.slopes[corner.creases[crease]] = -(f + g)

    def closes(self) -> np.ndarray:
        """Return whether each vertex comes back turned by no full turn, for folds in the middle of the boxes, [K]."""
        whole = np.ones(len(next(iter(self.angles.values())).centre), bool)
        for corner in self.strip.corners:
            q = np.zeros((4, len(whole)))
            q[0] = 1.0
            for crease, (x, y) in zip(corner.creases, corner.directions, strict=True):
                half = 0.5 * np.broadcast_to(self.angles[crease].centre, whole.shape)
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
            whole &= q[0] > 0.5
        return whole


class _Fold(NamedTuple):
    """A fold phi of the row: 1 - cos phi, 1 + cos phi, sin phi and phi'."""

    low: Jet
    high: Jet
    sine: Ball
    rate: Jet


def _part(side: Side, fold: _Fold) -> tuple[Ball, Ball, Jet]:
    """Return z = sin b cos c + cos b sin c cos phi + i sin c sin phi, and the derivative of its argument."""
    product = side.sin_b * side.sin_c
    # sin^2 D = (1 + cos D) (1 - cos D): sums of what is positive
    square = (fold.low * product).plus(side.beyond) * (fold.high * product).plus(side.apart)
    above = (fold.low * -(side.sin_b * side.cos_c)).plus(side.sine_of_sum)
    x = side.sine_of_sum - side.cos_b * side.sin_c * fold.low.value
    return x, side.sin_c * fold.sine, above * square.inverse() * fold.rate * side.sin_c


class _Energy:
    """The energy's derivatives U' and U'' along curves with these signs, [k + 1, curves], over boxes of theta."""

    def __init__(self, strip: Strip, pattern: Pattern, signs: np.ndarray) -> None:
        self.strip, self.signs = strip, signs
        self.k, self.rest = pattern.stiffness, pattern.rest
        self.across = [c for v in strip.corners for c in (v.creases[1], v.creases[3])]

    def over(self, curve: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> _Boxes:
        """Return what is known over boxes on curves of these numbers."""
        middle, half = variables(lower, upper)
        signs = self.signs[:, curve]
        at = _States(self.strip, signs, exact(middle))
        box = _States(self.strip, signs, Ball(middle, half))
        # phi = phi(middle) + phi' (theta - middle)
        angles = {c: a.widened(box.slopes[c].value.magnitude * half) for c, a in at.angles.items()}
        return _Boxes(self, at, box, angles, half)

    def first(self, states: _States, angles: dict[int, Ball]) -> Ball:
        """Return U' = sum k (phi - rest) phi'."""
        return total(
            exact(self.k[c]) * (phi - exact(self.rest[c])) * states.slopes[c].value
            for c, phi in angles.items()
        )

    def second(self, states: _States, angles: dict[int, Ball]) -> Ball:
        """Return U'' = sum k (phi'^2 + (phi - rest) phi'')."""
        return total(
            exact(self.k[c])
            * (
                states.slopes[c].value * states.slopes[c].value
                + (phi - exact(self.rest[c])) * states.slopes[c].slope
            )
            for c, phi in angles.items()
        )


def total(parts: Iterable[Ball]) -> Ball:
    """Sum balls."""
    return functools.reduce(operator.add, parts)


@dataclass(frozen=True, eq=False)
class _Boxes:
    """States in the middle of boxes and over them, and all fold angles over them."""

    energy: _Energy
    at: _States
    box: _States
    angles: dict[int, Ball]
    half: np.ndarray

    def slope(self, lifted: dict[int, Ball] | None = None) -> tuple[Ball, Ball]:
        """Return U' over the boxes, from its middle and U'', and U''; folds in the middle may be lifted by 2 pi."""
        middle = self.at.angles | (lifted or {})
        moved = {
            c: a.widened(self.box.slopes[c].value.magnitude * self.half)
            for c, a in (lifted or {}).items()
        }
        bend = self.energy.second(self.box, self.angles | moved)
        first = self.energy.first(self.at, middle)
        return first.widened(bend.magnitude * self.half), bend

    def reaching(self, across: np.ndarray, sides: np.ndarray) -> tuple[Ball, Ball]:
        """Return how far in the middle a fold across the row, [K], is beyond sides pi, and its slope over the boxes."""
        value, rate = [], []
        for i, (a, s) in enumerate(zip(across, sides, strict=True)):
            phi, slope = (
                self.at.angles[self.energy.across[a]],
                self.box.slopes[self.energy.across[a]],
            )
            here = phi.centre[i] + (s * 2 * math.pi if s * phi.centre[i] < 0 else 0.0)
            value.append((here - s * math.pi, phi.radius[i] + 16 * UNIT))
            rate.append((slope.value.centre[i], slope.value.radius[i]))
        return Ball(*np.array(value).T), Ball(*np.array(rate).T)

    def passing(self) -> np.ndarray:
        """Return which folds across the row may be at +-pi, [creases across, K]; where nothing is known, too."""
        return np.array([~(self.angles[c].magnitude < HALF_TURN) for c in self.energy.across])

    def lifted(self, sign: float, passing: np.ndarray) -> dict[int, Ball]:
        """Return folds across the row in the middle, those that pass a limit continued to sign pi."""
        found = {}
        for c, passes in zip(self.energy.across, passing, strict=True):
            a = self.at.angles[c]
            turn = np.where(passes & (sign * a.centre < 0), sign * 2 * math.pi, 0.0)
            found[c] = Ball(a.centre + turn, a.radius + 16 * UNIT)
        return found


def prove_strip(pattern: Pattern, *, boxes: int = 1_000_000, until: float = math.inf) -> StripProof:
    """Find every minimum of the energy of a strip within fold limits, with a proof.

    Parameters
    ----------
    pattern
        Vertices of degree four in a row on flat paper.
    boxes
        At most so many boxes of theta; what is left is undecided.
    until
        Stop then (`time.monotonic`).

    Returns
    -------
    StripProof
        All minima, but for what is undecided.

    Raises
    ------
    OptionError
        If the pattern is no such strip: `why_no_strip` says why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import prove_strip
    >>> points = [[0, 0], [1, 0.1], [0.2, 1], [-1, 0.3], [-0.3, -1]]
    >>> faces = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)]
    >>> vertex = o.make_pattern(points, faces).with_springs(stiffness=0.01, rest_angles=[1.0, -0.5, 0.8, 0.9])
    >>> proof = prove_strip(vertex)
    >>> proof.curves, len(proof.minima), proof.undecided
    (2, 2, ())
    """
    strip, why = as_strip(pattern)
    if strip is None:
        raise OptionError(f"pattern = {pattern.title}: no strip that can be proved: {why}")
    started = time.process_time()
    k = len(strip.corners)
    signs = np.array([(1, *rest) for rest in itertools.product((1, -1), repeat=k)], float).T
    energy = _Energy(strip, pattern, signs)
    curve = np.repeat(np.arange(signs.shape[1]), len(FIRST) - 1)
    lower, upper = (np.tile(ends, signs.shape[1]) for ends in (FIRST[:-1], FIRST[1:]))
    cover: list[np.ndarray] = []
    examined = 0
    with np.errstate(all="ignore"):
        while len(curve):
            stop = examined + len(curve) > boxes or time.monotonic() > until
            examined += len(curve)
            found = _kinds(energy, curve, lower, upper)
            split = (found[0] == OPEN) & (upper - lower > NARROWEST) & (not stop)
            cover.append(np.array([curve, lower, upper, *found])[:, ~split])
            middle = 0.5 * (lower + upper)[split]
            lower, upper = np.r_[lower[split], middle], np.r_[middle, upper[split]]
            curve = np.r_[curve[split], curve[split]]
        boxes_of = np.concatenate(cover, axis=1)
        order = np.lexsort((boxes_of[1], boxes_of[0]))
        ends = _Ends(energy)
        for number in range(signs.shape[1]):
            ends.along([_Piece(*b) for b in boxes_of[:, order].T.tolist() if b[0] == number])
        minima = ends.minima()
    seconds = time.process_time() - started
    return StripProof(
        signs.shape[1], tuple(minima), ends.maxima, tuple(ends.open), examined, seconds
    )


def _kinds(
    energy: _Energy, curve: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Return what a `_Piece` says of each box."""
    boxes = energy.over(curve, lower, upper)
    slope, bend = boxes.slope()
    passing = boxes.passing()
    inside = ~passing.any(axis=0)
    kind = np.full(len(curve), OPEN)
    kind[inside & (bend.sign > 0)] = RISING
    kind[inside & (bend.sign < 0)] = FALLING
    kind[inside & (slope.sign != 0)] = NONE
    kind[inside & ~boxes.at.closes()] = OUTSIDE
    rates = np.array([boxes.box.slopes[c].value.sign for c in energy.across])
    moving = np.where(passing.sum(axis=0) == 1, (rates * passing).sum(axis=0), 0.0)
    ahead, behind = (boxes.slope(boxes.lifted(s, passing))[0].sign for s in (1.0, -1.0))
    kind[(moving != 0) & (ahead != 0) & (behind != 0)] = LIMIT
    return kind, slope.sign, moving, ahead, behind, passing.argmax(axis=0)


class _Piece(NamedTuple):
    """A box of theta of one curve, or several beside each other: its kind, and the sign of U' over it.

    Where a crease across the row (its number among them) reaches a limit: the sign of its slope, and those of U' with
    it continued to +pi and to -pi.
    """

    curve: float
    lower: float
    upper: float
    kind: float
    slope: float
    moving: float
    ahead: float
    behind: float
    across: float

    @property
    def valid(self) -> bool:
        """Whether all its states close within fold limits."""
        return self.kind in (NONE, RISING, FALLING)

    def joins(self, other: _Piece) -> bool:
        """Return whether both are of one kind, and say the same."""
        if self.kind == LIMIT:
            return self[3:4] + self[5:] == other[3:4] + other[5:]
        return self.kind == other.kind and (self.kind != NONE or self.slope == other.slope)


class _Ends:
    """Where the energy has its least values along curves: inside, or where a curve ends."""

    def __init__(self, energy: _Energy) -> None:
        self.energy, self.maxima = energy, 0
        self.open: list[tuple[np.ndarray, np.ndarray, str]] = []
        self._inside: list[_Piece] = []
        self._limits: list[tuple[_Piece, float]] = []
        self._ends: list[tuple[int, float]] = []

    def along(self, boxes: list[_Piece]) -> None:
        """Add what the boxes of a curve show, which cover it."""
        pieces = [boxes[0]]
        for box in boxes[1:]:
            if pieces[-1].joins(box):
                pieces[-1] = pieces[-1]._replace(upper=box.upper)
            else:
                pieces.append(box)
        for before, piece, after in zip([None, *pieces], pieces, [*pieces[1:], None], strict=False):
            if piece.kind == OPEN:
                self._leave(piece, "not decided in the smallest boxes")
            elif piece.kind in (RISING, FALLING):
                low, high = (self._slope(piece, x) for x in (piece.lower, piece.upper))
                if low * high == 0:
                    self._leave(piece, "U' is 0 at an end, to rounding")
                elif low != high:
                    self._inside += [piece] * (piece.kind == RISING)
                    self.maxima += piece.kind == FALLING
            elif piece.kind == LIMIT:
                # another crease reaches its limit in the next box: what is between them, at one state
                before, after = (
                    self._at(p, x) if p is not None and p.kind == LIMIT else p
                    for p, x in ((before, piece.lower), (after, piece.upper))
                )
                sides = [p for p in (before, after) if p is not None and p.valid]
                whole = all(p is None or p.valid or p.kind == OUTSIDE for p in (before, after))
                if whole and not sides and before is not None and after is not None:
                    continue  # another vertex does not close on either side
                if len(sides) != 1 or not whole or before is None or after is None:
                    self._leave(piece, "creases reach +-pi together")
                    continue
                toward = 1.0 if sides[0] is before else -1.0
                # the fold grows to pi, or falls to -pi, towards the end
                side = toward * piece.moving
                if toward * (piece.ahead if side > 0 else piece.behind) < 0:
                    self._limits.append((piece, side))
            if piece.valid and (before is None or after is None):
                toward = -1.0 if before is None else 1.0
                x = piece.lower if before is None else piece.upper
                slope = toward * self._slope(piece, x)
                if slope == 0:
                    self._leave(piece, "U' is 0 at +-pi, to rounding")
                elif slope < 0:
                    self._ends.append((int(piece.curve), x))

    def _leave(self, piece: _Piece, why: str) -> None:
        ends = np.array([piece.lower]), np.array([piece.upper])
        angles = self.energy.over(np.array([int(piece.curve)]), *ends).angles
        low, high = (np.full(len(self.energy.rest), s * math.pi) for s in (-1, 1))
        for crease, a in angles.items():
            low[crease] = np.fmax(-math.pi, a.centre[0] - a.radius[0])
            high[crease] = np.fmin(math.pi, a.centre[0] + a.radius[0])
        self.open.append((low, high, why))

    def _at(self, piece: _Piece, theta: float) -> _Piece:
        """Return what is known of one state of a piece."""
        x = np.array([theta])
        found = _kinds(self.energy, np.array([int(piece.curve)]), x, x)
        return _Piece(piece.curve, theta, theta, *(float(v[0]) for v in found))

    def _slope(self, piece: _Piece, theta: float) -> float:
        """Return the sign of U' at one state of a piece, 0 where it is not certain."""
        if piece.kind == NONE:
            return piece.slope
        x = np.array([theta])
        return float(self.energy.over(np.array([int(piece.curve)]), x, x).slope()[0].sign[0])

    def minima(self) -> list[StripMinimum]:
        """Return all minima that were found, each in a narrow box."""
        found = []
        curve = np.array([int(p.curve) for p in self._inside], int)
        boxes = self._narrowed(curve, self._inside, None)
        flat = 0
        for piece, low, high in zip(self._inside, *boxes, strict=True):
            if low <= 0 <= high:  # at the flat state, if U' is 0 there
                if self.energy.rest.any():
                    self._leave(piece, "a minimum at the flat state, or beside it")
                flat += 1
                if flat != self.energy.signs.shape[1]:
                    continue
            found.append(self._state(int(piece.curve), low, high, {}))
        if 0 < flat < self.energy.signs.shape[1]:
            self._leave(self._inside[0], "the flat state is a minimum of some of its curves only")
        limits = [piece for piece, _ in self._limits]
        curve = np.array([int(p.curve) for p in limits], int)
        boxes = self._narrowed(curve, limits, np.array([side for _, side in self._limits]))
        for (piece, side), low, high in zip(self._limits, *boxes, strict=True):
            across = self.energy.across[int(piece.across)]
            found.append(self._state(int(piece.curve), low, high, {across: side * math.pi}))
        return found + [self._state(curve, x, x, {-1: 0.0}) for curve, x in self._ends]

    def _narrowed(
        self, curve: np.ndarray, pieces: list[_Piece], sides: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends of theta after interval Newton steps: for U' = 0, or for a fold across the row at +-pi."""
        low, high = (np.array([getattr(p, end) for p in pieces]) for end in ("lower", "upper"))
        rising = np.array([1.0 if p.kind == RISING else p.moving for p in pieces])
        for _ in range(40 * bool(pieces)):
            boxes = self.energy.over(curve, low, high)
            middle, _ = variables(low, high)
            if sides is None:
                value, rate = self.energy.first(boxes.at, boxes.at.angles), boxes.slope()[1]
            else:
                value, rate = boxes.reaching(np.array([int(p.across) for p in pieces]), sides)
            step = value * rate.inverse()
            root = Ball(middle - step.centre, step.radius + 4 * UNIT)
            # where the slope over the box is not certain, the half that the sign in the middle points to
            beyond = value.sign * rising
            new_low = np.where(beyond < 0, middle, np.fmax(low, root.centre - root.radius))
            new_high = np.where(beyond > 0, middle, np.fmin(high, root.centre + root.radius))
            shrunk = new_high - new_low < 0.9 * (high - low)
            low, high = np.fmax(low, new_low), np.fmin(high, new_high)
            if not shrunk.any():
                break
        return low, high

    def _state(self, curve: int, low: float, high: float, held: dict[int, float]) -> StripMinimum:
        """Return the state in a narrow box, creases across the row held at limits."""
        boxes = self.energy.over(np.array([curve]), np.array([low]), np.array([high]))
        phi, radius = np.zeros(len(self.energy.rest)), 0.0
        for crease, angle in boxes.angles.items():
            phi[crease] = held.get(crease, angle.centre[0])
            radius = max(radius, 0.0 if crease in held else float(angle.radius[0]))
        signs = tuple(int(s) for s in self.energy.signs[:, curve])
        return StripMinimum(signs, (float(low), float(high)), phi, radius, bool(held))
