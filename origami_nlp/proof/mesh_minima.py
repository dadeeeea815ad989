"""Which states of a mesh whose vertices fold flat are minima: products of curves, gone through (`mesh_states`).

A state is a minimum if it is one along every curve of every product that it lies in.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from origami_nlp.pattern import Pattern
from origami_nlp.proof.balls import Ball
from origami_nlp.proof.flat_sheets import SheetMinimum
from origami_nlp.proof.mesh_curves import CurveEnergy, CurveMinima, fold
from origami_nlp.proof.mesh_states import Crossing, Curve, FoldingMesh, StateProduct, VertexMode

FLAT = 0
Place = int | tuple[Curve, int]
"""Where a crease is: 0; 1 or -1, at +-180 degrees; or on a curve, at a minimum, by its number."""


class MeshMinima:
    """All products, their curves, and which of their states are minima.

    Attributes
    ----------
    products, minima, maxima, open, boxes
        As those of `MeshProof`.
    """

    def __init__(self, mesh: FoldingMesh, pattern: Pattern, boxes: int, until: float) -> None:
        self.mesh, self.pattern, self.most, self.until = mesh, pattern, boxes, until
        self.known: dict[Curve, CurveMinima] = {}
        self.products: set[StateProduct] = set()
        self.open: list[tuple[np.ndarray, np.ndarray, str]] = []
        self.minima: list[SheetMinimum] = []
        self.boxes, self.maxima = 0, 0
        self._local: dict[tuple[tuple[VertexMode, ...], ...], list[StateProduct] | None] = {}

    def run(self) -> None:
        """Go through all products, and ask of each state that may be a minimum whether it is."""
        for modes in itertools.product(*(c.modes for c in self.mesh.crossings)):
            if self._late():
                return
            for product in self.mesh.products(modes):
                if product is None:
                    self._leave(None, "whether a loop of vertices moves is not certain")
                else:
                    self.products.add(product)
        places: dict[tuple[Place, ...], None] = {}
        for product in sorted(self.products, key=_order):
            for found in self._candidates(product):
                if self._late():
                    return
                places.setdefault(found)
        for curve, known in self.known.items():
            for low, high in known.open:
                self._leave((curve, low, high), "where the energy is least along a curve")
        for one in places:
            self._judge(one)

    def _late(self) -> bool:
        """Whether the time is over: then all is left open."""
        over = time.monotonic() > self.until
        if over:
            self._leave(None, "time was over")
        return over

    def curve(self, curve: Curve) -> CurveMinima:
        """Return what is known of a curve."""
        if curve not in self.known:
            energy = CurveEnergy(self.mesh, curve, self.pattern.stiffness, self.pattern.rest)
            self.known[curve] = energy.minima(max(0, self.most - self.boxes))
            self.boxes += self.known[curve].boxes
            self.maxima += self.known[curve].maxima
        return self.known[curve]

    def _candidates(self, product: StateProduct) -> Iterator[tuple[Place, ...]]:
        """Yield states of a product that are minima along its curves, or at +-180 degrees in any way."""

        def inside(curve: Curve) -> list[Place]:
            found = enumerate(self.curve(curve).inside)
            return [FLAT if low == 0 == high else (curve, k) for k, (low, high) in found]

        for at in self._parts(product, inside):
            yield tuple(at[c] for c in range(self.mesh.creases))

    @staticmethod
    def _parts(
        product: StateProduct, inside: Callable[[Curve], Sequence[Any]]
    ) -> Iterator[dict[int, Any]]:
        """Yield where creases are in a product: each of its curves inside, or at +-180 degrees in any way."""
        ways: list[list[dict[int, Any]]] = [
            [{c: side * sign for c, sign in row} for side in (1, -1)] for row in product.folded
        ]
        for curve in product.curves:
            own = [{c: place for m in curve for c, _ in m.creases} for place in inside(curve)]
            for sides in itertools.product((1, -1), repeat=len(curve)):
                both = zip(curve, sides, strict=True)
                own.append({c: side * s for m, side in both for c, s in m.creases})
            ways.append(own)
        for parts in itertools.product(*ways):
            at: dict[int, Any] = dict.fromkeys(product.flat, FLAT)
            for part in parts:
                at |= part
            yield at

    def _judge(self, places: tuple[Place, ...]) -> None:
        """Add a state to the minima if it is one along all curves through it."""
        low, high = self._angles(places)
        moving = [c for c, place in enumerate(places) if isinstance(place, tuple)]
        if (low[moving] * high[moving] <= 0).any() or time.monotonic() > self.until:
            self.open.append((low, high, "a state beside the flat one, or time was over"))
            return
        options = tuple(
            tuple(o for o in crossing.modes if _holds(o, crossing, places, low))
            for crossing in self.mesh.crossings
        )
        if options not in self._local:
            found = [f for modes in itertools.product(*options) for f in self.mesh.products(modes)]
            self._local[options] = None if None in found else [f for f in found if f is not None]
        products = self._local[options]
        if products is None:
            return  # it is left open for all
        ways = [self._ways_down(c, places) for c in {c for p in products for c in p.curves}]
        if any(ways):
            return
        if None not in ways:
            self.minima.append(SheetMinimum(0.5 * (low + high), float(0.5 * (high - low).max())))
        else:
            self.open.append((low, high, "whether the energy falls from a state along a curve"))

    def _leaving(self, curve: Curve, places: Sequence[Place]) -> list[int]:
        """Return the sides of a curve to which it leaves a state: none from inside it, or from another end."""
        sides = set()
        for member in curve:
            for c, sign in member.creases:
                place = places[c]
                if isinstance(place, tuple):
                    return []
                sides.add(place * sign * member.sign)
        return [] if len(sides) > 1 else [-1, 1] if sides == {FLAT} else list(sides)

    def _ways_down(self, curve: Curve, places: tuple[Place, ...]) -> list[int] | None:
        """Return the sides of a curve into which the energy falls from a state, None where that is not certain."""
        leaving = self._leaving(curve, places)
        if not leaving:
            return []
        known = self.curve(curve)
        if len(leaving) > 1:
            slope, bend = known.flat
            if slope:
                return [-slope]
            return {-1: [-1, 1], 1: []}.get(bend) if slope == 0 else None
        (side,) = leaving
        slope = known.ends[side > 0]
        return ([side] if side * slope > 0 else []) if slope else None

    def _angles(self, places: tuple[Place, ...]) -> tuple[np.ndarray, np.ndarray]:
        low, high = np.zeros(len(places)), np.zeros(len(places))
        for c, place in enumerate(places):
            if isinstance(place, tuple):
                low[c], high[c] = self._within(place[0], *self.curve(place[0]).inside[place[1]])[c]
            else:
                low[c] = high[c] = place * math.pi
        return low, high

    def _within(self, curve: Curve, low: float, high: float) -> dict[int, tuple[float, float]]:
        """Return the fold angles of the creases of a curve over a box of theta."""
        found = {}
        for member in curve:
            kappa = self.mesh.multiplier(member.key)
            ends = [fold(kappa, Ball(np.array(x), np.array(0.0)))[0] for x in (low, high)]
            one, two = (
                float(ends[0].centre - ends[0].radius),
                float(ends[1].centre + ends[1].radius),
            )
            for c, sign in member.creases:
                s = sign * member.sign
                found[c] = (
                    max(min(s * one, s * two), -math.pi),
                    min(max(s * one, s * two), math.pi),
                )
        return found

    def _leave(self, where: tuple[Curve, float, float] | None, why: str) -> None:
        low, high = (np.full(self.mesh.creases, s * math.pi) for s in (-1, 1))
        for c, ends in (self._within(*where) if where else {}).items():
            low[c], high[c] = ends
        self.open.append((low, high, why))


def _order(product: StateProduct) -> tuple[object, ...]:
    return (len(product.curves), sorted(product.flat), product.folded, product.curves)


def _holds(
    option: VertexMode, crossing: Crossing, places: Sequence[Place], angles: np.ndarray
) -> bool:
    """Return whether a vertex is in a state that it reaches by one of its modes."""
    s = np.sign(angles[list(crossing.creases)])
    if s[2] != option.sign * s[0] or s[3] != -option.sign * s[1]:
        return False
    kinds = [_kind(places[c]) for c in crossing.creases[:2]]
    if option.held is None:
        return kinds[0] == kinds[1]
    pair, what = option.held
    return kinds[pair] == what


def _kind(place: Place) -> str:
    return "moves" if isinstance(place, tuple) else "folded" if place else "flat"
