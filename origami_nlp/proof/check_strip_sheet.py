"""The sheet of a strip in exact arithmetic, and its closed states over balls of theta, for the check of a proof.

Round a vertex of degree four with unit vectors u_1..u_4 along its creases, counter-clockwise, the rotations
R(u_i, phi_i) have product 1.  Then R(u_3, phi_3) u_4 and R(u_1, -phi_1) u_4 make the same angle with u_2; by Rodrigues'
formula

    (1 - cos phi_3) [u_2.u_4 - (u_3.u_2)(u_3.u_4)] = (1 - cos phi_1) [u_2.u_4 - (u_1.u_2)(u_1.u_4)].

So cosines along the row are given by one, 1 - cos phi_i = rho_i^2 (1 - cos 2 theta) with max rho = 1, and every closed
state is one of theta in [-pi/2, pi/2] and signs.  phi_2 turns the first vector into the second about u_2, phi_4
R(u_1, phi_1) u_2 into R(u_3, -phi_3) u_2 about u_4: each one angle, where the vectors are not along the axis, which is
asked of every ball of theta.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple, Protocol

from flint import arb, arb_series, fmpq

from origami_nlp.proof.check_laws import ExactLaw
from origami_nlp.proof.check_lists import Refused
from origami_nlp.proof.sheet_certificate import StatedSheet
from origami_nlp.proof.strip_certificate import StripCertificate

FLAT = 1e-12
"""Deviation from folding flat, up to which a vertex is one that does [rad]."""
NEAR = 1e-6
"""Share by which a square of rho is less than the largest, of a vertex that may fold flat."""
CHANGE = 0.8
"""Theta beyond which the half-angle is measured from 90 degrees [rad]."""


def _ball(x: Fraction) -> Any:
    return arb(fmpq(x.numerator, x.denominator))


class CreasesRound(Protocol):
    """A vertex, for its product of rotations."""

    @property
    def creases(self) -> tuple[int, ...]:
        """Counter-clockwise."""

    @property
    def directions(self) -> list[tuple[Any, Any]]:
        """Unit vectors along them, as balls."""


class Round(NamedTuple):
    """A vertex: creases counter-clockwise, the first and third in the row; u_i.u_j and u_i x u_j as balls, [4][4]."""

    creases: tuple[int, ...]
    dots: list[list[Any]]
    turns: list[list[Any]]
    directions: list[tuple[Any, Any]]


class FlatDisk:
    """The sheet that a certificate states: one flat piece of paper without holes, and its interior vertices.

    Raises
    ------
    Refused
        If it is none.
    """

    def __init__(self, said: StatedSheet) -> None:
        self.said = said
        self.stiffness = [arb(k) for k in said.stiffness]
        self.rest = [arb(r) for r in said.rest]
        self.points = [tuple(map(Fraction, p)) for p in said.corners]
        self.facets = [self._counter_clockwise(f) for f in said.facets]
        beside: dict[tuple[int, int], int] = {}
        for f, ring in enumerate(self.facets):
            for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
                if (a, b) in beside:
                    raise Refused(f"facets {beside[a, b] + 1} and {f + 1} overlap along a side")
                beside[a, b] = f
        self.beside = beside
        inner = {frozenset(e) for e in beside if e[::-1] in beside}
        if inner != {frozenset(c) for c in said.creases} or len(inner) != len(said.creases):
            raise Refused("the creases are not the sides that two facets share, each once")
        self.crease = {frozenset(c): i for i, c in enumerate(said.creases)}
        self._is_disk(inner)
        self.inside = {v for v in range(len(self.points)) if self.round(v) is not None}

    def _cross(self, o: int, a: int, b: int) -> Fraction:
        (x, y), (u, v), (w, z) = (self.points[i] for i in (o, a, b))
        return (u - x) * (z - y) - (v - y) * (w - x)

    def _counter_clockwise(self, ring: tuple[int, ...]) -> tuple[int, ...]:
        area = sum(self._cross(ring[0], a, b) for a, b in itertools.pairwise(ring[1:]))
        if area <= 0:
            raise Refused("a facet is not counter-clockwise")
        return ring

    def _is_disk(self, inner: set[frozenset[int]]) -> None:
        """Refuse a sheet that is not one disk: facets hang together, V - E + F = 1, and no corner is a pinch."""
        front, seen = [0], {0}
        for f in front:
            ring = self.facets[f]
            for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
                other = self.beside.get((b, a))
                if other is not None and other not in seen:
                    seen.add(other)
                    front.append(other)
        used = {v for f in self.facets for v in f}
        edges = len(self.beside) - len(inner)
        if len(seen) < len(self.facets) or len(used) - edges + len(self.facets) != 1:
            raise Refused("the sheet is not one piece without holes")
        for v in used:
            starts = sum(1 for a, b in self.beside if a == v and (b, a) not in self.beside)
            if starts > 1:
                raise Refused(f"corner {v} joins parts of the sheet alone")

    def round(self, v: int) -> list[int] | None:
        """Return the neighbours of an interior vertex counter-clockwise; None on the border."""
        first = next((e for e in self.beside if e[0] == v), None)
        if first is None:
            return None
        found, edge = [], first
        while True:
            found.append(edge[1])
            ring = self.facets[self.beside[edge]]
            before = ring[ring.index(v) - 1]
            edge = (v, before)
            if edge == first:
                return found
            if edge not in self.beside:
                return None

    def walk(self) -> Iterator[tuple[int, int, int, int]]:
        """Yield each facet but the first from one before it, the crease between, and +-1: from its right or left."""
        front, seen = [0], {0}
        for f in front:
            ring = self.facets[f]
            for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
                g = self.beside.get((b, a))
                if g is not None and g not in seen:
                    seen.add(g)
                    front.append(g)
                    c = self.crease[frozenset((a, b))]
                    # f is on the left of (a, b)
                    yield g, f, c, -1 if self.said.creases[c] == (a, b) else 1


class FlatSheet(FlatDisk):
    """The sheet of a strip.

    Raises
    ------
    Refused
        If it is not flat vertices of degree four in a row, as stated, on one piece of paper without holes.
    """

    def __init__(self, said: StripCertificate) -> None:
        super().__init__(said)
        self.said: StripCertificate = said
        self.vertices, self.squares = self._row()
        laws = said.laws or (None,) * len(self.rest)
        self.laws = [None if law is None else ExactLaw(law) for law in laws]
        self.stops = dict(self._stops())
        self.across = [c for v in self.vertices for c in (v.creases[1], v.creases[3])]

    def _stops(self) -> Iterator[tuple[tuple[int, int], float]]:
        """Yield fold limits within +-180 degrees, by crease and side."""
        for crease, pair in enumerate(self.said.limits):
            if not -math.pi <= pair[0] < pair[1] <= math.pi or 0.0 in pair:
                raise Refused(
                    f"fold limits of crease {crease + 1} are none, or one is at 0 degrees"
                )
            yield from (
                ((crease, s), x) for s, x in zip((-1, 1), pair, strict=True) if abs(x) < math.pi
            )

    def torque(self, crease: int, fold: Any) -> Any:
        """Return the torque of a crease over a ball of fold angles."""
        law = self.laws[crease]
        if law is None:
            return self.stiffness[crease] * (fold - self.rest[crease])
        return law.at(fold) if fold.is_finite() else arb.nan()

    def bend(self, crease: int, fold: Any) -> Any:
        """Return all slopes of the torque over a ball of fold angles."""
        law = self.laws[crease]
        if law is None:
            return self.stiffness[crease]
        return law.slope(fold) if fold.is_finite() else arb.nan()

    def room(self, stop: tuple[int, int], fold: Any) -> Any:
        """Return how far a fold angle is from a stop, negative beyond."""
        return stop[1] * (arb(self.stops[stop]) - fold)

    def _row(self) -> tuple[list[Round], list[Fraction]]:
        said, at = self.said, {v: self.round(v) for v in self.inside}
        ends = [set(said.creases[c]) for c in said.row]
        squares, rounds = [Fraction(1)], []
        met: set[int] = set()
        for one, two in zip(said.row, said.row[1:], strict=False):
            shared = set(said.creases[one]) & set(said.creases[two]) & self.inside
            if len(shared) != 1 or shared & met:
                raise Refused("the row is not vertices one after the other")
            (v,) = shared
            met.add(v)
            ring = at[v] or []
            if len(ring) != 4:
                raise Refused(f"vertex {v} has not four creases")
            start = next(i for i, w in enumerate(ring) if {v, w} == set(said.creases[one]))
            ring = ring[start:] + ring[:start]
            if {v, ring[2]} != set(said.creases[two]):
                raise Refused(f"the row does not go straight on at vertex {v}")
            vertex, square = self._vertex(v, ring)
            rounds.append(vertex)
            squares.append(squares[-1] * square)
        around = {c for r in rounds for c in r.creases}
        if (
            met != self.inside
            or len(ends) != len(met) + 1
            or not len(around) == len(said.creases) == 3 * len(met) + 1
        ):
            raise Refused("a vertex or a crease is none of the row")
        largest = max(squares)
        for vertex, square in zip(rounds, squares, strict=False):
            d, t = vertex.dots, vertex.turns
            off = d[0][1] * t[2][3] + t[0][1] * d[2][3]  # sin(a1 + a3)
            if largest - square <= NEAR * largest and not abs(off) > FLAT:
                raise Refused("a vertex folds flat: signs of folds at +-180 degrees may be others")
        return rounds, [s / largest for s in squares]

    def _vertex(self, v: int, ring: list[int]) -> tuple[Round, Fraction]:
        x, y = self.points[v]
        u = [(self.points[w][0] - x, self.points[w][1] - y) for w in ring]

        def dot(i: int, j: int) -> Fraction:
            return u[i][0] * u[j][0] + u[i][1] * u[j][1]

        def cross(i: int, j: int) -> Fraction:
            return u[i][0] * u[j][1] - u[i][1] * u[j][0]

        # four angles below 180 degrees sum to less than two turns: to one
        if any(cross(i, (i + 1) % 4) <= 0 for i in range(4)):
            raise Refused(f"vertex {v} has a sector of 180 degrees or more")
        before, after = (dot(1, 3) - dot(i, 1) * dot(i, 3) / dot(i, i) for i in (0, 2))
        if before * after <= 0:
            raise Refused(f"at vertex {v} a fold along the row says nothing of the next")
        lengths = [_ball(dot(i, i)).sqrt() for i in range(4)]
        creases = tuple(self.crease[frozenset((v, w))] for w in ring)
        return Round(
            creases,
            [[_ball(dot(i, j)) / (lengths[i] * lengths[j]) for j in range(4)] for i in range(4)],
            [[_ball(cross(i, j)) / (lengths[i] * lengths[j]) for j in range(4)] for i in range(4)],
            [
                (_ball(p) / length, _ball(q) / length)
                for (p, q), length in zip(u, lengths, strict=True)
            ],
        ), before / after

    @cached_property
    def factors(self) -> list[tuple[bool, Any, Any]]:
        """Of each crease of the row: whether rho is 1; rho; 1 - rho^2."""
        return [(s == 1, _ball(s).sqrt(), _ball(1 - s)) for s in self.squares]


class CurveStates:
    """Closed states over a ball of theta on a curve: each fold angle, its first and half its second derivative.

    `finite`: whether they are known at all.
    """

    def __init__(self, sheet: FlatSheet, signs: Sequence[int], theta: Any) -> None:
        self.folds: list[Any] = [arb_series([0], 3)] * len(sheet.said.creases)
        try:
            self._fold(sheet, signs, theta)
            self.finite = all(c.is_finite() for f in self.folds for c in (f[0], f[1], f[2]))
        except ValueError:  # a divisor may be 0 in the ball
            self.finite = False

    def _fold(self, sheet: FlatSheet, signs: Sequence[int], theta: Any) -> None:
        x = arb_series([theta, 1], 3)
        sine, cosine = x.sin(), x.cos()
        beyond = abs(float(theta.mid())) > CHANGE
        trig = []
        for crease, sign, (whole, rho, rest) in zip(
            sheet.said.row, signs, sheet.factors, strict=True
        ):
            if whole:
                half = sign * x
            elif beyond:
                side = sign if theta > 0 else -sign
                cotangent = cosine / sine
                half = side * (arb.pi() / 2 - ((cotangent * cotangent + rest).sqrt() / rho).atan())
            else:
                tangent = sine / cosine
                half = sign * (rho * tangent / (1 + rest * tangent * tangent).sqrt()).atan()
            phi = 2 * half
            self.folds[crease] = phi
            trig.append((phi.cos(), phi.sin()))
        for vertex, one, three in zip(sheet.vertices, trig, trig[1:], strict=False):
            for first, axis, second in ((0, 1, 2), (2, 3, 0)):
                before, after = (one, three) if first == 0 else (three, one)
                self.folds[vertex.creases[axis]] = _turn(vertex, first, axis, second, before, after)


def _turn(vertex: Round, first: int, axis: int, second: int, before: Any, after: Any) -> Any:
    """Return the fold about an axis between two creases of the row: it turns R(second) u into R(first, -) u, u opposite
    the axis, each as its parts beside the axis in the plane and out of it.
    """
    d, k, far = vertex.dots, vertex.turns, (axis + 2) % 4
    w = (
        d[second][far] * k[axis][second] + k[second][far] * d[axis][second] * after[0],
        k[second][far] * after[1],
    )
    v = (
        d[first][far] * k[axis][first] + k[first][far] * d[axis][first] * before[0],
        -k[first][far] * before[1],
    )
    x, y = w[0] * v[0] + w[1] * v[1], w[0] * v[1] - w[1] * v[0]
    rate = (x * y.derivative() - y * x.derivative()) / (x * x + y * y)
    # some value modulo a full turn, without a jump at half a turn
    if x[0] > 0:
        start = (y[0] / x[0]).atan()
    elif x[0] < 0:
        side = 1 if float(y[0].mid()) >= 0 else -1
        start = side * arb.pi() + (y[0] / x[0]).atan()
    elif y[0] > 0 or y[0] < 0:
        start = (arb.pi() / 2 if y[0] > 0 else -arb.pi() / 2) - (x[0] / y[0]).atan()
    else:
        start = arb.nan()
    return arb_series([start, rate[0], rate[1] / 2], 3)


def product_round(vertex: CreasesRound, folds: Sequence[Any]) -> tuple[Any, Any, Any, Any]:
    """Return the product of unit quaternions round a vertex, folds as balls, real part first."""
    a, b, c, d = arb(1), arb(0), arb(0), arb(0)
    for crease, (x, y) in zip(vertex.creases, vertex.directions, strict=True):
        r, s = (folds[crease] / 2).cos(), (folds[crease] / 2).sin()
        i, j = s * x, s * y
        a, b, c, d = (
            a * r - b * i - c * j,
            a * i + b * r - d * j,
            a * j + c * r + d * i,
            d * r + b * j - c * i,
        )
    return a, b, c, d


def turned(vertex: Round, folds: Sequence[Any]) -> Any:
    """Return the real part of the product of unit quaternions round a vertex, folds as balls.

    Raises
    ------
    Refused
        If the product is certainly no full turn or none.
    """
    a, b, c, d = product_round(vertex, folds)
    if any(part.is_finite() and not part.contains(0) for part in (b, c, d)):
        raise Refused("states of a curve do not close")
    return a


def lifted(angle: Any, near: float) -> Any:
    """Return an angle with so many full turns that it is nearest to a number."""
    turns = round((near - float(angle.mid())) / (2 * math.pi))
    return angle + 2 * turns * arb.pi() if turns else angle
