"""Flat sheets of vertices of degree four as their proofs read them, over balls (python-flint).

A sheet that is turned in space is laid into its plane first: to rounding, which is reported.  Corners are the doubles
of the pattern; relations between sectors that hold to within `CLOSURE_TOL` are taken as exact, and every number that is
computed from sectors is widened by what they deviate.

And an energy along a curve, cut into intervals in which it is known: where it is least, inside or at what ends it.

The slope U' of the energy has no zero in an interval, by its value in the middle and U'' over it; or U'' has none, and
then U' has one at most, which signs of U' at the ends decide.  States of a curve are those where no gap is negative: in
an interval in which some may be, all of these grow or all of them fall, and U' has a sign.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from flint import arb, ctx

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import Pattern, laid_flat
from origami_nlp.proof.certificate import ProvedState
from origami_nlp.proof.rows import UNIT

BITS = 128
"""Of balls."""
TERMS = 4
"""Of power series: one more than second derivatives, whatever FLINT is set to keep."""


@contextmanager
def precision() -> Iterator[None]:
    """Compute with balls of so many bits and series of so many terms."""
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = BITS, TERMS
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before


def sign_of(x: Any) -> int:
    """Return the sign of a ball, 0 where it is not certain."""
    return 1 if x > 0 else -1 if x < 0 else 0


def closer(x: Any, y: Any) -> Any:
    """Return the narrower of two balls."""
    return y if y.is_finite() and not y.rad() >= x.rad() else x


def state_of(folds: Sequence[Any], exactly: dict[int, float]) -> ProvedState:
    """Return the minimum of fold angles in balls, some of which are known exactly."""
    phi = np.array([exactly.get(c, float(a.mid())) for c, a in enumerate(folds)])
    radius = max(float(abs(a - x).upper()) for a, x in zip(folds, phi.tolist(), strict=True))
    return ProvedState(phi, radius * (1 + 4 * UNIT))


class VertexRound(NamedTuple):
    """A vertex: its creases counter-clockwise, unit vectors along them, and the sectors from each to the next."""

    vertex: int
    creases: tuple[int, ...]
    unit: list[tuple[Any, Any]]
    sectors: list[Any]

    def cross(self, i: int, n: int = 1) -> Any:
        """Return the cross product of unit vectors i and i + n."""
        (a, b), (c, d) = self.unit[i % 4], self.unit[(i + n) % 4]
        return a * d - b * c


class FlatSheet(NamedTuple):
    """A sheet in its plane: the pattern, its vertices, and by how much laying it there moved a crease at most [rad]."""

    pattern: Pattern
    rounds: list[VertexRound]
    moved: float
    folds_flat: bool


class Equal:
    """Numbers of which those that are nearly equal are one."""

    def __init__(self) -> None:
        self.known: list[Any] = []
        self.off: Any = arb(0)

    def of(self, x: Any) -> int:
        """Return the place of a number among those known."""
        for i, y in enumerate(self.known):
            if abs(x - y) <= CLOSURE_TOL:
                self.deviates(x - y)
                return i
        self.known.append(x)
        return len(self.known) - 1

    def deviates(self, by: Any) -> None:
        """Note by how much a relation fails."""
        self.off = self.off.max(abs(by))

    @property
    def slack(self) -> Any:
        """What each number may be off, as a ball round 0."""
        return arb(0, 4 * self.off.upper())

    @property
    def deviation(self) -> float:
        """By how much relations fail, where they do [rad]."""
        return float(self.off.upper()) * (1 + UNIT) if self.off > 0 else 0.0


def flat_sheet(pattern: Pattern) -> tuple[FlatSheet | None, str]:
    """Return a sheet of vertices of degree four all or none of which fold flat, or None and why a pattern is none."""
    if not pattern.is_flat:
        return None, "the reference state is not flat"
    if pattern.cell:
        return None, "it is a cell that repeats"
    for stated, what in ((pattern.limits, "stops"), (pattern.laws, "hinge laws")):
        if stated:
            return (
                None,
                f"creases have {what}: proofs of sheets know linear springs within +-180 degrees",
            )
    if pattern.holes or not pattern.vertices:
        return None, "the pattern has a hole" if pattern.holes else "no vertex is inside"
    for v in pattern.vertices:
        if len(v.creases) != 4:
            return None, f"vertex {v.vertex} has not four creases"
    flat, moved = laid_flat(pattern), 0.0
    if flat is not pattern:
        shortest = float(pattern.lengths.min())
        away = pattern.corners - pattern.corners.mean(axis=0)
        # of all corners, in any direction: the least singular value is no less than the distance from a plane
        off = float(np.linalg.svd(away, compute_uv=False)[-1])
        if off > CLOSURE_TOL * shortest:
            return None, "the corners of the flat state are not in one plane"
        size = float(np.abs(pattern.corners).max())
        moved = (off + 32 * UNIT * size) / shortest
    with precision():
        rounds = [_round(flat, v.vertex, v.creases) for v in pattern.vertices]
        for one in rounds:
            if not all(a > 0 for a in one.sectors):
                return None, f"vertex {one.vertex} has a sector of 180 degrees or more"
        flats = [bool(abs(r.sectors[0] + r.sectors[2] - arb.pi()) <= CLOSURE_TOL) for r in rounds]
    if len(set(flats)) > 1:
        both = [rounds[flats.index(way)].vertex for way in (True, False)]
        return None, f"vertex {both[0]} folds flat, and vertex {both[1]} does not"
    return FlatSheet(flat, rounds, moved, flats[0]), ""


def _round(pattern: Pattern, vertex: int, creases: Sequence[int]) -> VertexRound:
    place = pattern.corners[:, :2].tolist()
    unit = []
    for c in creases:
        away = place[int(pattern.ends[c].sum()) - vertex]
        x, y = (arb(a) - arb(b) for a, b in zip(away, place[vertex], strict=True))
        length = (x * x + y * y).sqrt()
        unit.append((x / length, y / length))
    found = VertexRound(vertex, tuple(creases), unit, [])
    if sum(sign_of(found.cross(i)) for i in range(4)) < 0:
        found = VertexRound(vertex, found.creases[::-1], unit[::-1], [])
    for i in range(4):
        (a, b), (c, d) = found.unit[i], found.unit[(i + 1) % 4]
        found.sectors.append(arb.atan2(a * d - b * c, a * c + b * d))
    return found


DEPTH = 60
"""Halvings of an interval, at most."""
GONE, SLOPE, BEND, HELD, OPEN = range(5)
"""Kinds of intervals: no state; U' has a sign; U'' has one; gaps that have slopes of one sign; undecided."""


class Look(NamedTuple):
    """What is known of an interval: U', U'', and gaps that must not be negative, each by a name with its slope."""

    first: Any
    second: Any
    gaps: dict[Any, tuple[Any, Any]]
    known: Any = None


Curve = Callable[[Any], Look | None]
"""A curve of states, of a number: what is known over a ball; None where there is no state."""


class CurvePiece(NamedTuple):
    """An interval: its kind, the sign of U' (of U'' of `BEND`), that of the slopes of gaps, and their names."""

    low: float
    high: float
    kind: int
    sign: int = 0
    way: int = 0
    gaps: tuple[Any, ...] = ()

    def joins(self, other: CurvePiece) -> bool:
        """Return whether both say the same."""
        return self.kind != HELD and self[2:] == other[2:]


@dataclass
class Budget:
    """How many intervals may be looked at, and whether time is left."""

    most: int
    late: Callable[[], bool]
    looked: int = 0

    def spent(self) -> bool:
        """Count one, and return whether it is one too many."""
        self.looked += 1
        return self.looked > self.most or self.late()


@dataclass
class Least:
    """Where an energy is least along a curve.

    Attributes
    ----------
    minima
        Between two numbers each, held by gaps that have these names.
    open
        Between two numbers each, and why.
    """

    minima: list[tuple[float, float, tuple[Any, ...]]] = field(default_factory=list)
    open: list[tuple[float, float, str]] = field(default_factory=list)


def least(curve: Curve, low: float, high: float, budget: Budget, rests: bool = False) -> Least:
    """Find where the energy of a curve is least between two numbers, from 0 on where U' is 0 there, if it `rests`."""
    found = Least()
    pieces: list[CurvePiece] = []
    for a, b, piece in halved(partial(_piece, curve), low, high, budget):
        one = CurvePiece(a, b, OPEN) if piece is None else piece
        if pieces and pieces[-1].joins(one):
            pieces[-1] = pieces[-1]._replace(high=one.high)
        else:
            pieces.append(one)
    for a, b, kind, sign, way, gaps in pieces:
        if kind == OPEN:
            found.open.append((a, b, "not decided in the smallest intervals"))
        elif kind == BEND and not (rests and a <= 0 <= b):
            ends = [_slope(curve, x) for x in (a, b)]
            if not all(ends):
                found.open.append((a, b, "the slope at the end of an interval"))
            elif ends[0] != ends[1] and sign > 0:
                zero = _halved(lambda x: _slope(curve, x), a, b)
                found.minima.append((*zero, ()))
        elif kind == HELD:
            ends = [_room(curve, gaps, x) for x in (a, b)]
            if not all(ends):
                found.open.append((a, b, "what ends a curve"))
            elif ends[0] != ends[1] and sign == way:
                zero = _halved(lambda x, g=gaps, w=way: w * _room(curve, g, x), a, b)  # type: ignore[misc]
                found.minima.append((*zero, gaps))
    return found


def halved(
    judge: Callable[[float, float], Any], low: float, high: float, budget: Budget
) -> Iterator[tuple[float, float, Any]]:
    """Cut an interval until each part is judged, in order; None of those that are too small, or too many."""
    front = [(low, high, 0)]
    while front:
        a, b, depth = front.pop()
        over, found, middle = budget.spent(), judge(a, b), 0.5 * (a + b)
        if found is not None or over or depth == DEPTH or middle in (a, b):
            yield a, b, found
        else:
            front += [(middle, b, depth + 1), (a, middle, depth + 1)]


def _piece(curve: Curve, a: float, b: float) -> CurvePiece | None:
    """Return what is known of an interval; None: it is to be halved."""
    box = curve(arb(a).union(arb(b)))
    if box is None or any(value < 0 for value, _ in box.gaps.values()):
        return CurvePiece(a, b, GONE)
    met = {name: gap for name, gap in box.gaps.items() if not gap[0] > 0}
    slope, bend = sign_of(box.first), sign_of(box.second)
    if not (slope or (bend and not met)):
        return None
    if not met:
        return CurvePiece(a, b, SLOPE, slope) if slope else CurvePiece(a, b, BEND, bend)
    ways = {sign_of(rate) for _, rate in met.values()}
    if not slope or len(ways) > 1 or 0 in ways:
        return None
    return CurvePiece(a, b, HELD, slope, ways.pop(), tuple(met))


def _slope(curve: Curve, x: float) -> int:
    """Return the sign of U' at a number, 0 where it is not certain."""
    at = curve(arb(x))
    return 0 if at is None else sign_of(at.first)


def _room(curve: Curve, gaps: Sequence[Any], x: float) -> int:
    """Return the least sign of gaps at a number, 0 where it is not certain."""
    at = curve(arb(x))
    return -1 if at is None else min(sign_of(at.gaps[name][0]) for name in gaps)


def _halved(sign: Callable[[float], int], low: float, high: float) -> tuple[float, float]:
    """Return where a sign changes from negative to positive, as far as it is certain."""
    while (middle := 0.5 * (low + high)) not in (low, high):
        before = low, high
        for x in (0.5 * (low + middle), middle, 0.5 * (middle + high)):
            if low < x < high and (at := sign(x)):
                low, high = (x, high) if at < 0 else (low, x)
        if (low, high) == before:
            break
    return low, high
