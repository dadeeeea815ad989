"""The sheet that a certificate states, in exact arithmetic, and the product of rotations round a vertex."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from fractions import Fraction
from typing import Any, Protocol

from flint import arb

from origami_nlp.proof.check_lists import Refused
from origami_nlp.proof.sheet_certificate import StatedSheet


class CreasesRound(Protocol):
    """A vertex, for its product of rotations."""

    @property
    def creases(self) -> tuple[int, ...]:
        """Counter-clockwise."""

    @property
    def directions(self) -> list[tuple[Any, Any]]:
        """Unit vectors along them, as balls."""


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
