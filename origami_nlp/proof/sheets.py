"""Flat sheets of vertices of degree four as their proofs read them, over balls (python-flint).

A sheet that is turned in space is laid into its plane first: to rounding, which is reported.  Corners are the doubles
of the pattern; relations between sectors that hold to within `CLOSURE_TOL` are taken as exact, and every number that is
computed from sectors is widened by what they deviate.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
from flint import arb, ctx

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import Pattern, laid_flat
from origami_nlp.proof.result import ProvedState
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
