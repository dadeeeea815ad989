"""Facets that lie face to face: which layer is above, and the gaps that stay open.

Two convex pieces of paper that overlap in a plane have an order, and beside the state every point of one that lies
inside the other stays on its side: over its plane, or under it.  Seen from one piece the other one moves as a rigid
body, so that to first order its points stay there if those at the corners of the overlap do.  To second order a corner
of the overlap says nothing where it is on a border, since the point may slide off: `Lying.inside` is the same gap of a
point that cannot.

Which orders there are is asked of `Orders`; those that all of them agree on are known, the others are a choice.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from origami_nlp.facets.features import Features
from origami_nlp.facets.layers import MOST_PAIRS, Layers, pose_layers
from origami_nlp.facets.orders import Orders
from origami_nlp.facets.sheet import Sheet
from origami_nlp.facets.stacks import Stack, Unclear
from origami_nlp.facets.touches import Placed, Touch
from origami_nlp.numerics import CLOSES, cross

Point: TypeAlias = tuple[float, float, float]
ASIDE = 1e-4
"""Share of the way to the middle of an overlap at which a point is inside it, and stays inside beside the state."""


@dataclass(frozen=True)
class Lying(Touch):
    """The gap of a point of one facet over another facet on which it lies.

    Attributes
    ----------
    place
        The point, in the sheet's reference state.
    middle
        Of the overlap, likewise.

    Examples
    --------
    >>> import math, numpy as np, origami_nlp as o
    >>> from origami_nlp.facets import Faces, Placed, Sheet
    >>> sheet = Sheet(o.examples.pattern("miura", 1, 3))
    >>> phi = np.array([math.pi, -math.pi])
    >>> faces = Faces(sheet, phi)
    >>> touch = faces.touches(*faces.known[-1])[0]
    >>> touch.facets, touch.type, round(touch.gap(Placed(sheet.crossings.poses, phi)), 12)
    ((2, 0), 'face-face', 0.0)
    """

    place: Point
    middle: Point

    @property
    def key(self) -> tuple[object, ...]:
        """What tells it from others."""
        return self.type, self.facets, self.place

    def points(self, at: Placed) -> np.ndarray:
        """Return the point and three corners of the facet in space, [4, 3]."""
        i, j = self.facets
        ring = at.points(np.array((i, i, i)), np.array(self.corners[1:]))
        return np.vstack([at.turn[j] @ np.array(self.place) + at.shift[j], ring])

    def inside(self, share: float = ASIDE) -> Lying:
        """Return the gap of a point that is this share of the way to the middle of the overlap inside."""
        x = np.array(self.place)
        x += share * (np.array(self.middle) - x)
        return replace(self, place=_point(x))

    @property
    def order(self) -> tuple[int, int, int]:
        """Facets f, g and s as in FOLD: f is on the side of g's normal where s = 1, else on the other."""
        return self.facets[1], self.facets[0], int(self.sign)


class Faces:
    """Facets that lie face to face at a state, without those that hang together at a crease that is shut.

    Parameters
    ----------
    sheet
        The programme.
    phi
        A closed state in which no facets pierce each other [rad], [n].

    Attributes
    ----------
    reason
        Why nothing is known of them; empty where it is.
    known
        Pairs that lie on each other the same way in every order, and which: (number, whether the first is above).
    open
        Numbers of pairs that may lie either way.

    Examples
    --------
    >>> import math, numpy as np, origami_nlp as o
    >>> from origami_nlp.facets import Faces, Sheet
    >>> sheet = Sheet(o.examples.pattern("miura", 1, 3))
    >>> faces = Faces(sheet, np.array([math.pi, math.pi]))  # rolled up, either end inside
    >>> len(faces.known), len(faces.open), len(faces.touches(faces.open[0], True))
    (0, 1, 4)
    """

    def __init__(self, sheet: Sheet, phi: np.ndarray) -> None:
        self.reason, self.known, self.open = "", list[tuple[int, bool]](), list[int]()
        self._sheet, self._phi = sheet, phi
        self._stack, self._orders = Stack(sheet.crossings, phi), Orders(0, ())
        if not len(self._stack.pairs):
            return
        if len(self._stack.pairs) > MOST_PAIRS:
            self.reason = f"more than {MOST_PAIRS:,} pairs of facets lie on each other"
            return
        try:
            posed = pose_layers(sheet, phi, self._stack)
            if isinstance(posed, Layers) or posed.solve() is None:
                self.reason = "layers have no order"
                return
        except (Unclear, TimeoutError):
            self.reason = "which layer is above is not known"
            return
        self._orders = posed
        pattern = sheet.pattern
        shut = np.abs(phi) > 0.5 * np.pi
        beside = zip(pattern.left[shut].tolist(), pattern.right[shut].tolist(), strict=True)
        joined = {frozenset(pair) for pair in beside}
        facets = sheet.crossings.facet[self._stack.pairs].tolist()
        for k, (value, pair) in enumerate(zip(posed.values, facets, strict=True)):
            if frozenset(pair) in joined:
                continue  # the fold limit keeps them apart
            if value < 0:
                self.open.append(k)
            else:
                self.known.append((k, bool(value)))

    def follow(self, above: Mapping[int, bool]) -> dict[int, bool] | None:
        """Return how open pairs lie where some of them lie as given.

        Parameters
        ----------
        above
            Of some open pairs, by number, whether the first piece is above.

        Returns
        -------
        dict or None
            Those that are given, and those that rules settle then; None where no order has them so.
        """
        orders, before = self._orders, list(self._orders.values)
        try:
            if orders.assume(above) != -1:
                return None
            found = {k: bool(orders.values[k]) for k in self.open if orders.values[k] >= 0}
            return found if orders.solve() is not None else None
        except TimeoutError:  # more orders than there are: what holds for them holds for those
            return found
        finally:
            orders.values = before

    @cached_property
    def _at(self) -> Placed:
        return Placed(self._sheet.crossings.poses, self._phi)

    def touches(self, pair: int, above: bool) -> tuple[Lying, ...]:
        """Return the gaps of a pair that stay open where its first piece is above, or below.

        Parameters
        ----------
        pair
            Its number.
        above
            Whether the first piece is above.

        Returns
        -------
        tuple of Lying
            One at each corner of the overlap.
        """
        stack, crossings = self._stack, self._sheet.crossings
        upper, lower = (int(p) for p in stack.pairs[pair])
        f, g = int(crossings.facet[upper]), int(crossings.facet[lower])
        rings = Features(crossings).rings_of_pieces
        triangle = tuple(rings.triangle[lower].tolist())
        a, b, c = self._at.points(np.array((g, g, g)), np.array(triangle))
        sign = float(np.sign(cross(b - a, c - a) @ stack.up[lower])) * (1.0 if above else -1.0)
        turn, shift = self._at.turn[f], self._at.shift[f]
        one, other = (_ring(stack.x[p]) for p in (upper, lower))
        exact = 10 * CLOSES * crossings.size
        corners = _overlap(one, other, stack.normal[upper], stack.near, exact)
        reference = self._sheet.pattern.corners[
            [v for v in dict.fromkeys(crossings.pieces[upper].tolist())]
        ]
        x = (corners - shift) @ turn
        for k, y in enumerate(x):  # corners of the piece itself without rounding
            off = np.linalg.norm(reference - y, axis=1)
            if off.min() <= stack.near:
                x[k] = reference[off.argmin()]
        middle = _point(x.mean(axis=0))
        return tuple(
            Lying("face-face", (g, f), (-1, *triangle), sign, _point(y), middle) for y in x
        )


def _point(x: np.ndarray) -> Point:
    a, b, c = x.tolist()
    return a, b, c


def _ring(x: np.ndarray) -> np.ndarray:
    """Drop the corners by which a piece [q, 3] is padded."""
    return x[[True, *(x[1:] != x[0]).any(axis=1)]]


def _overlap(
    one: np.ndarray, other: np.ndarray, normal: np.ndarray, near: float, on: float
) -> np.ndarray:
    """Return the corners of the overlap of two convex polygons in a plane, [p, 3] and [q, 3]: [k, 3]."""
    found = [*_within(one, other, normal, on), *_within(other, one, normal, on)]
    for a, b in zip(one, np.roll(one, -1, axis=0), strict=True):
        for c, d in zip(other, np.roll(other, -1, axis=0), strict=True):
            u, v = b - a, d - c
            size = float(cross(u, v) @ normal)
            if abs(size) <= 1e-9 * np.linalg.norm(u) * np.linalg.norm(v):
                continue
            s, t = (float(cross(c - a, w) @ normal) / size for w in (v, u))
            if 0 < s < 1 and 0 < t < 1:
                found.append(a + s * u)
    kept: list[np.ndarray] = []
    for x in found:
        if all(np.linalg.norm(x - y) > near for y in kept):
            kept.append(x)
    return np.array(kept)


def _within(of: np.ndarray, ring: np.ndarray, normal: np.ndarray, on: float) -> np.ndarray:
    """Return the corners that lie on a convex polygon, whichever way it runs."""
    side = np.roll(ring, -1, axis=0) - ring
    inward = cross(normal, side)
    inward /= np.linalg.norm(inward, axis=1, keepdims=True)
    inward *= np.sign(inward[0] @ (ring.mean(axis=0) - ring[0]))
    depth = np.einsum("kpi,pi->kp", of[:, None] - ring[None], inward)
    return np.asarray(of[depth.min(axis=1) >= -on])
