"""All minima of a mesh whose vertices fold flat, with cycles or without, within fold limits (`mesh_states`).

The closed states are finitely many products of curves, and the energy is a sum over curves: a state is a minimum if it
is one along every curve of every product that it lies in.  Those products are known from which creases are 0, at +-180
degrees or neither, vertex by vertex.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.pattern import Pattern, laid_flat
from origami_nlp.proof.affine import UNIT
from origami_nlp.proof.balls import Ball
from origami_nlp.proof.flat_sheets import SheetMinimum, SheetProof
from origami_nlp.proof.mesh_certificate import MeshCertificate
from origami_nlp.proof.mesh_contact import MeshContact, why_no_mesh_contact
from origami_nlp.proof.mesh_curves import QUARTER, CurveEnergy, CurveMinima, fold
from origami_nlp.proof.mesh_stacks import MeshStacks, Still
from origami_nlp.proof.mesh_states import (
    MOST_MODES,
    Crossing,
    Curve,
    FoldingMesh,
    StateProduct,
    VertexMode,
    as_folding_mesh,
    why_no_mesh,
)
from origami_nlp.proof.sheet_certificate import CertifiedState, OpenInterval, stated_sheet
from origami_nlp.proof.strip_contact import APART, CROSSING, UNKNOWN

FLAT, HALF_TURN = 0, 1
Place = int | tuple[Curve, int]
"""Where a crease is: 0; 1 or -1, at +-180 degrees; or on a curve, at its minimum of some number."""
NEIGHBOURHOOD = 2.0**-40
"""How far from the flat state, or the end of a curve, what is beside it is looked at [rad]."""


@dataclass(frozen=True, kw_only=True)
class MeshProof(SheetProof):
    """What is proved of a mesh whose vertices fold flat: all closed states are products of curves.

    Attributes
    ----------
    products
        Which curves, with all other creases at 0 or +-180 degrees.
    isolated
        How many of these products are of states alone: no curve is in them.
    together
        Curves of one product, at most.
    """

    products: int
    isolated: int
    together: int

    @property
    def states(self) -> str:
        """Where all closed states are, in words."""
        return (
            f"are {self.products} products of {self.curves} curves, along which "
            f"tangents of half the fold angles are proportional ({self.together} of a product at most; "
            f"{self.isolated} products are of flat and flat-folded states alone)"
        )

    meant = "of the sheet whose vertices fold flat and whose equal sectors and lengths are equal exactly"


def prove_mesh(
    pattern: Pattern,
    *,
    contact: bool = False,
    boxes: int = 1_000_000,
    until: float = math.inf,
    modes: int = MOST_MODES,
) -> MeshProof:
    """Find every minimum of the energy of a mesh of vertices that fold flat, within fold limits, with a proof.

    Parameters
    ----------
    pattern
        Flat vertices of degree four, opposite sectors of each summing to 180 degrees; in any order, with cycles.
    contact
        Whether facets must not cross.
    boxes
        At most so many boxes of theta; what is left is undecided.
    until
        Stop then (`time.monotonic`).
    modes
        Ways to fold all vertices, each by itself, that are gone through at most.

    Returns
    -------
    MeshProof
        All minima, but for what is undecided.

    Raises
    ------
    OptionError
        If the pattern is no such mesh, or its contact cannot be proved: `why_no_mesh` and `why_no_mesh_contact` say
        why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import prove_mesh
    >>> proof = prove_mesh(o.examples.pattern("miura", 2, 3))
    >>> proof.curves, len(proof.minima), proof.undecided
    (6, 14, ())
    """
    pattern.check_plain_hinges("a proof")
    mesh, why = as_folding_mesh(pattern, modes)
    if mesh is None:
        raise OptionError(
            f"pattern = {pattern.title}: no mesh that can be proved: {why or why_no_mesh(pattern)}"
        )
    if contact and (why := why_no_mesh_contact(pattern)):
        raise OptionError(f"pattern = {pattern.title}: no mesh whose contact can be proved: {why}")
    started = time.process_time()
    search = _Enumeration(mesh, laid_flat(pattern), boxes, until)
    search.run(contact)
    return MeshProof(
        curves=len({c for f in search.products for c in f.curves}),
        minima=tuple(search.minima),
        maxima=search.maxima,
        undecided=tuple(search.open),
        deviation=max(mesh.deviation, search.stacks.deviation if search.stacks else 0.0) + 4 * UNIT,
        moved=mesh.moved,
        boxes=search.boxes,
        seconds=time.process_time() - started,
        contact=contact,
        products=len(search.products),
        isolated=sum(not f.curves for f in search.products),
        together=max((len(f.curves) for f in search.products), default=0),
    )


def certificate_of_mesh(
    pattern: Pattern, proof: SheetProof, *, generic: bool = False
) -> MeshCertificate:
    """Return the proof of a mesh in the form that is written to a file and checked.

    Parameters
    ----------
    pattern
        The mesh.
    proof
        Of it.
    generic
        Whether it is one of vertices that need not fold flat (`prove_quad_mesh`).

    Returns
    -------
    MeshCertificate
        All that is claimed.

    Raises
    ------
    OptionError
        If a facet is of several pieces, or there are stops or hinge laws: the check knows none.
    """
    pattern.check_plain_hinges("the certificate of a mesh")
    if generic and proof.contact:
        raise OptionError(
            "the certificate of a mesh that does not fold flat: within fold limits only"
        )
    return MeshCertificate(
        **stated_sheet(pattern),
        deviation=proof.deviation,
        minima=tuple(CertifiedState(tuple(m.fold_angles.tolist()), m.radius) for m in proof.minima),
        undecided=tuple(
            OpenInterval(tuple(low.tolist()), tuple(high.tolist()), why)
            for low, high, why in proof.undecided
        ),
        generic=generic,
        contact=proof.contact,
    )


class _Enumeration:
    """All products, their curves, and which of their states are minima."""

    def __init__(self, mesh: FoldingMesh, pattern: Pattern, boxes: int, until: float) -> None:
        self.mesh, self.pattern, self.most, self.until = mesh, pattern, boxes, until
        self.known: dict[Curve, CurveMinima] = {}
        self.products: set[StateProduct] = set()
        self.open: list[tuple[np.ndarray, np.ndarray, str]] = []
        self.minima: list[SheetMinimum] = []
        self.boxes = self.maxima = 0
        self.stacks: MeshStacks | None = None
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
                        both = list(zip(moving, sides, strict=True))
                        if stacks.together(still, both, self._rest(moving)) == UNKNOWN:
                            self._leave(None, "facets that meet where two rows fold by themselves")
        self.boxes += stacks.boxes

    def _rest(self, curves: Sequence[Curve]) -> bool:
        """Return whether the energy along each curve is least once, and there each fold is below 90 degrees."""
        inside = [self.curve(c).inside for c in curves]
        return all(len(x) == 1 and abs(t) < 0.25 * math.pi for x in inside for y in x for t in y)

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
        for curve in {c for product in products for c in product.curves}:
            ways = self._ways_down(curve, places)
            certain &= ways is not None
            for side in ways or ():
                facets = self._facets(places, (curve, side))
                if facets == APART:
                    return
                # where two curves move, others of their states may be free
                one = all(len(p.curves) == 1 for p in products if curve in p.curves)
                certain &= facets == CROSSING and one
        facets = self._facets(places)
        if facets == CROSSING:
            return
        if certain and facets == APART:
            self.minima.append(SheetMinimum(0.5 * (low + high), float(0.5 * (high - low).max())))
        else:
            self.open.append((low, high, "whether the energy falls from a state along a curve"))

    def _ways_down(self, curve: Curve, places: tuple[Place, ...]) -> list[int] | None:
        """Return the sides of a curve into which the energy falls from a state, None where that is not certain."""
        sides = set()
        for member in curve:
            for c, sign in member.creases:
                place = places[c]
                if isinstance(place, tuple):
                    return []  # its minimum
                sides.add(place * sign * member.sign)
        known = self.curve(curve)
        if sides == {FLAT}:
            slope, bend = known.flat
            if slope:
                return [-slope]
            return {-1: [-1, 1], 1: []}.get(bend) if slope == 0 else None
        if len(sides) > 1:
            return []  # another end than those of the curve
        (side,) = sides
        slope = known.ends[side > 0]
        return ([side] if side * slope > 0 else []) if slope else None

    def _facets(self, places: tuple[Place, ...], way: tuple[Curve, int] | None = None) -> int:
        """Return what facets do at a state, or beside it along a way: on a side of a curve that leaves there."""
        if self.stacks is None:
            return APART
        moving = {p[0]: self.curve(p[0]).inside[p[1]] for p in places if isinstance(p, tuple)}
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
        both = [(c, 1 if x[1] > 0 else -1) for c, x in moving.items()]
        return self.stacks.together(still, both, self._rest(list(moving)))

    def _angles(self, places: tuple[Place, ...]) -> tuple[np.ndarray, np.ndarray]:
        low, high = np.zeros(len(places)), np.zeros(len(places))
        for c, place in enumerate(places):
            if isinstance(place, tuple):
                curve, number = place
                low[c], high[c] = self._within(curve, *self.curve(curve).inside[number])[c]
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
