"""Which states of a mesh whose vertices fold flat are minima: products of curves, gone through (`mesh_states`).

A state is a minimum if it is one along every curve of every product that it lies in, as far as facets do not cross.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from origami_nlp.pattern import Pattern
from origami_nlp.proof.affine import UNIT
from origami_nlp.proof.balls import Ball
from origami_nlp.proof.flat_sheets import SheetMinimum
from origami_nlp.proof.mesh_contact import MeshContact
from origami_nlp.proof.mesh_curves import QUARTER, CurveEnergy, CurveMinima, fold
from origami_nlp.proof.mesh_stacks import MeshStacks, Still
from origami_nlp.proof.mesh_states import Crossing, Curve, FoldingMesh, StateProduct, VertexMode
from origami_nlp.proof.row_pairs import RowPair
from origami_nlp.proof.strip_contact import APART, CROSSING, UNKNOWN

FLAT = 0
Place = int | tuple[Curve, int]
"""Where a crease is: 0; 1 or -1, at +-180 degrees; or on a curve, at a minimum, by its number, or where facets hold it
(-1, -2, ...).
"""
NEIGHBOURHOOD = 2.0**-40
"""How far from the flat state, or the end of a curve, what is beside it is looked at [rad]."""


class MeshMinima:
    """All products, their curves, and which of their states are minima.

    Attributes
    ----------
    products, minima, maxima, open, boxes
        As those of `MeshProof`.
    deviation
        By how much lengths that are taken as equal differ, over the size of the sheet, and sectors [rad].
    """

    def __init__(self, mesh: FoldingMesh, pattern: Pattern, boxes: int, until: float) -> None:
        self.mesh, self.pattern, self.most, self.until = mesh, pattern, boxes, until
        self.known: dict[Curve, CurveMinima] = {}
        self.products: set[StateProduct] = set()
        self.open: list[tuple[np.ndarray, np.ndarray, str]] = []
        self.minima: list[SheetMinimum] = []
        self.boxes, self.maxima, self.deviation = 0, 0, mesh.deviation
        self.stacks: MeshStacks | None = None
        # states that facets hold, and theta of each of their curves there
        self.held: dict[tuple[Place, ...], None] = {}
        self.touching: dict[Curve, list[tuple[float, float]]] = {}
        self._local: dict[tuple[tuple[VertexMode, ...], ...], list[StateProduct] | None] = {}

    def run(self, contact: bool) -> None:
        """Go through all products, and ask of each state that may be a minimum whether it is."""
        for modes in itertools.product(*(c.modes for c in self.mesh.crossings)):
            if self._late():
                return
            for product in self.mesh.products(modes):
                if product is None:
                    self._leave(None, "whether a loop of vertices moves is not certain")
                else:
                    self.products.add(product)
        if contact and self.mesh.in_line:
            self.stacks = MeshStacks(self.mesh, self.pattern, self.most, self.until)
            self._look_for_touches(self.stacks)
        elif contact:
            curves = [c for product in sorted(self.products, key=_order) for c in product.curves]
            held = MeshContact(self.mesh, self.pattern, curves, self.most, self.until)
            self.minima, self.maxima, self.boxes = held.minima, held.maxima, held.boxes
            self.deviation = held.deviation
            self.open += held.open
            return
        places: dict[tuple[Place, ...], None] = {}
        for product in sorted(self.products, key=_order):
            for found in self._candidates(product):
                if self._late():
                    return
                places.setdefault(found)
        for curve, known in self.known.items():
            for low, high in known.open:
                self._leave((curve, low, high), "where the energy is least along a curve")
        for one in places | self.held:
            self._judge(one)
        if self.stacks:
            self.deviation = max(self.deviation, self.stacks.deviation)

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

    def _look_for_touches(self, stacks: MeshStacks) -> None:
        """Leave open where facets that meet while curves move may hold a state: elsewhere all cross, or none press."""
        for product in sorted(self.products, key=_order):
            for at in self._parts(product, lambda curve: (None, FLAT)):
                moving = [c for c in product.curves if at[c[0].creases[0][0]] is None]
                still = tuple(at[c] for c in range(self.mesh.creases))
                if self._late():
                    return
                if len(moving) == 1:
                    found = stacks.along(still, moving[0])
                    # one that is free on one side of its flat state may be held there
                    mixed = len({status for *_, status in found}) > 1
                    for low, high, status in found:
                        if status == UNKNOWN or mixed:
                            self._leave(
                                (moving[0], low, high), "whether facets cross along a curve"
                            )
                elif moving:
                    for sides in itertools.product((1, -1), repeat=2):
                        self._look_for_held(
                            at, stacks, still, list(zip(moving, sides, strict=True))
                        )
        self.boxes += stacks.boxes

    def _look_for_held(
        self,
        at: dict[int, Any],
        stacks: MeshStacks,
        still: Still,
        moving: Sequence[tuple[Curve, int]],
    ) -> None:
        """Note states in which facets that meet hold two rows, and leave open where that is not decided."""
        pair = stacks.pair(still, moving)
        if not isinstance(pair, RowPair):
            if pair == UNKNOWN:
                self._leave(None, "facets that meet where two rows fold by themselves")
            return
        held = pair.held(self.until)
        self.boxes += held.boxes
        if held.open:
            self._leave(None, "facets that meet where two rows fold by themselves")
        for box in held.inside:
            places = dict(at)
            for (curve, side), (low, high) in zip(moving, box, strict=True):
                known = self.touching.setdefault(curve, [])
                # x = pi/2 - |theta|
                ends = side * (0.5 * math.pi - high - UNIT), side * (0.5 * math.pi - low + UNIT)
                known.append((min(ends), max(ends)))
                places |= {c: (curve, -len(known)) for m in curve for c, _ in m.creases}
            self.held[tuple(places[c] for c in range(self.mesh.creases))] = None

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
        certain = True
        down: dict[Curve, list[int]] = {}
        for curve in {c for product in products for c in product.curves}:
            ways = self._ways_down(curve, places)
            certain &= ways is not None
            down[curve] = ways or []
            for side in down[curve]:
                facets = self._facets(places, (curve, side))
                if facets == APART:
                    return
                certain &= facets == CROSSING
        for product in products:
            falls = len(product.curves) > 1 and self._falls_at_once(product.curves, places, down)
            if falls:
                return
            certain &= falls is not None
        facets = self._facets(places)
        if facets == CROSSING:
            return
        if certain and facets == APART:
            self.minima.append(SheetMinimum(0.5 * (low + high), float(0.5 * (high - low).max())))
        else:
            self.open.append((low, high, "whether the energy falls from a state along a curve"))

    def _falls_at_once(
        self, curves: Sequence[Curve], places: Sequence[Place], down: dict[Curve, list[int]]
    ) -> bool | None:
        """Return whether the energy falls from a state as two curves leave it at once, and facets are apart there.

        It is a sum over curves: only where one that falls by itself is in the way of facets.
        """
        if self.stacks is None or not any(down[c] for c in curves):
            return False
        leaving = [self._leaving(c, places) for c in curves]
        still = list(places)
        for curve in curves:
            for m in curve:
                for c, _ in m.creases:
                    still[c] = None  # type: ignore[call-overload]
        found = set()
        for sides in itertools.product(*leaving):
            if not any(side in down[c] for c, side in zip(curves, sides, strict=True)):
                continue
            pair = self.stacks.pair(tuple(still), list(zip(curves, sides, strict=True)))  # type: ignore[arg-type]
            corner = tuple(int(places[c[0].creases[0][0]] == FLAT) for c in curves)
            if isinstance(pair, RowPair):
                found.add(pair.falls((corner[0], corner[1])))
            else:
                found.add(False if pair == CROSSING else None)
        return True if True in found else None if None in found else False

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

    def _range(self, place: tuple[Curve, int]) -> tuple[float, float]:
        """Return between which theta a curve is."""
        curve, number = place
        return self.touching[curve][-1 - number] if number < 0 else self.curve(curve).inside[number]

    def _facets(self, places: tuple[Place, ...], way: tuple[Curve, int] | None = None) -> int:
        """Return what facets do at a state, or beside it along a way: on a side of a curve that leaves there."""
        if self.stacks is None:
            return APART
        moving = {p[0]: self._range(p) for p in places if isinstance(p, tuple)}
        if not way and places in self.held:
            return APART  # they meet
        at = [None if isinstance(p, tuple) else p for p in places]
        if way:
            curve, side = way
            first = curve[0].creases[0][0]
            ends = (QUARTER - NEIGHBOURHOOD, QUARTER) if at[first] else (0.0, NEIGHBOURHOOD)
            moving[curve] = min(side * x for x in ends), max(side * x for x in ends)
            for m in curve:
                for c, _ in m.creases:
                    at[c] = None
        still: Still = tuple(at)
        if not moving:
            return self.stacks.ordered(still, math.pi * np.array(at, float))
        if len(moving) == 1:
            ((curve, theta),) = moving.items()
            return self.stacks.near(still, curve, *theta)
        pair = self.stacks.pair(still, [(c, 1 if x[1] > 0 else -1) for c, x in moving.items()])
        if not isinstance(pair, RowPair):
            return pair
        one, two = (_interior(*sorted(map(abs, x))) for x in moving.values())
        return pair.at(one, two)

    def _angles(self, places: tuple[Place, ...]) -> tuple[np.ndarray, np.ndarray]:
        low, high = np.zeros(len(places)), np.zeros(len(places))
        for c, place in enumerate(places):
            if isinstance(place, tuple):
                low[c], high[c] = self._within(place[0], *self._range(place))[c]
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


def _interior(low: float, high: float) -> tuple[float, float]:
    """Return half the angle between blocks, pi/2 - |theta|: at a border where |theta| goes up to one."""
    if high >= QUARTER:
        return 0.0, 0.0
    return (0.5 * math.pi - high - UNIT if low else 0.5 * math.pi), 0.5 * math.pi - low + UNIT * (
        low > 0
    )


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
