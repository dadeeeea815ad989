"""Facets that lie face to face: which layer is above, and the gaps that stay open.

Two convex pieces of paper that overlap in a plane have an order, and beside the state every point of one that lies
inside the other stays on its side: over its plane, or under it.  Seen from one piece the other one moves as a rigid
body, so that to first order its points stay there if those at the corners of the overlap do.  A corner of one facet
inside the other, and sides that cross inside each other, stay on their side to any order; of a corner of the overlap
that is on a border this says nothing to second order, since the point may slide off: `CoplanarContact.inside` is the
same gap of a point that cannot.

Which orders there are is asked of `Orders`; those that all of them agree on are known, the others are a choice.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, INSIDE, cross
from origami_nlp.pattern_problem.contact_pairs import ContactPair, FoldedGeometry
from origami_nlp.pattern_problem.equations import PatternEquations
from origami_nlp.pattern_problem.features import Features
from origami_nlp.pattern_problem.layers import Layers, pose_layers
from origami_nlp.pattern_problem.orders import Orders, Rules
from origami_nlp.pattern_problem.stacks import Stack, Unclear

Point: TypeAlias = tuple[float, float, float]
MOST_PAIRS = 2_000
"""Overlapping pairs of pieces whose gaps are contacts."""
ASIDE = 1e-4
"""Share of the way to the middle of an overlap at which a point is inside it, and stays inside beside the state."""


@dataclass(frozen=True)
class CoplanarContact(ContactPair):
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
    >>> from origami_nlp.pattern_problem import Faces, FoldedGeometry, PatternProblem
    >>> problem = PatternProblem(o.examples.pattern("miura", 1, 3))
    >>> phi = np.array([math.pi, -math.pi])
    >>> faces = Faces(problem, phi)
    >>> touch = faces.touches(*faces.known[-1])[0]
    >>> touch.facets, touch.type, round(touch.gap(FoldedGeometry(problem.crossings.poses, phi)), 12)
    ((2, 0), 'face-face', 0.0)
    """

    place: Point
    middle: Point

    @property
    def key(self) -> tuple[object, ...]:
        """What distinguishes it from others."""
        return self.type, self.facets, self.place

    def reference(self, corners: np.ndarray) -> np.ndarray:
        """Return the point and three corners of the facet in the reference state, [4, 3]."""
        return np.vstack([self.place, corners[list(self.corners[1:])]])

    def points(self, at: FoldedGeometry) -> np.ndarray:
        """Return the point and three corners of the facet in space, [4, 3]."""
        i, j = self.facets
        ring = at.points(np.array((i, i, i)), np.array(self.corners[1:]))
        return np.vstack([at.turn[j] @ np.array(self.place) + at.shift[j], ring])

    def inside(self, share: float = ASIDE) -> CoplanarContact:
        """Return the gap of a point that is this share of the way to the middle of the overlap inside."""
        x = np.array(self.place)
        x += share * (np.array(self.middle) - x)
        return replace(self, place=_point(x))

    @property
    def order(self) -> tuple[int, int, int]:
        """Facets f, g and s as in FOLD: f is on the side of g's normal where s = 1, else on the other."""
        return self.facets[1], self.facets[0], int(self.sign)


class Faces:
    """Facets that lie face to face at a state, without those that hang together at a crease that is fully folded.

    Parameters
    ----------
    problem
        The problem.
    phi
        A closed state in which no facets pierce each other [rad], [n].

    Attributes
    ----------
    reason
        Why nothing is known of them; empty where it is.
    crosses
        Whether that is since they have no order.
    known
        Pairs that lie on each other the same way in every order, and which: (number, whether the first is above).
    open
        Numbers of pairs that may lie either way.

    Examples
    --------
    >>> import math, numpy as np, origami_nlp as o
    >>> from origami_nlp.pattern_problem import Faces, PatternProblem
    >>> problem = PatternProblem(o.examples.pattern("miura", 1, 3))
    >>> faces = Faces(problem, np.array([math.pi, math.pi]))  # rolled up, either end inside
    >>> len(faces.known), len(faces.open), len(faces.touches(faces.open[0], True))
    (0, 1, 4)
    """

    def __init__(self, problem: PatternEquations, phi: np.ndarray) -> None:
        self.reason, self.known, self.open = "", list[tuple[int, bool]](), list[int]()
        self.crosses = False
        self._problem, self._phi = problem, phi
        self._stack, self._orders = problem.stack(phi), Orders(Rules(0, ()))
        if not len(self._stack.pairs):
            return
        if len(self._stack.pairs) > MOST_PAIRS:
            self.reason = f"more than {MOST_PAIRS:,} pairs of facets lie on each other"
            return
        try:
            posed = pose_layers(problem, phi, self._stack)
            if isinstance(posed, Layers) or posed.solve() is None:
                self.reason, self.crosses = "layers have no order", True
                return
        except (Unclear, TimeoutError):
            self.reason = "which layer is above is not known"
            return
        self._orders = posed
        pattern = problem.crossings.pattern
        at_limit = np.abs(problem.crossings.poses.copied(phi)) > 0.5 * np.pi
        beside = zip(pattern.left[at_limit].tolist(), pattern.right[at_limit].tolist(), strict=True)
        joined = {frozenset(pair) for pair in beside}
        facets = problem.crossings.facet[self._stack.pairs].tolist()
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

    @property
    def _at(self) -> FoldedGeometry:
        return self._problem.placed(self._phi)

    def reach(self) -> float:
        """Return how far facets reach into each other, over the sheet's size: the rest of a state that is not exact.

        Returns
        -------
        float
            Of gaps at corners of overlaps the least, to the side that suits a pair best where it may lie either way;
            not negative where nothing does.
        """
        size = self._problem.crossings.size

        def least(pair: int, above: bool) -> float:
            return min(t.gap(self._at) for t in self.touches(pair, above)) / size

        known = [least(k, above) for k, above in self.known]
        return min([*known, *(max(least(k, False), least(k, True)) for k in self.open), 0.0])

    def touches(self, pair: int, above: bool) -> tuple[ContactPair, ...]:
        """Return the gaps of a pair that stay open where its first piece is above, or below.

        Parameters
        ----------
        pair
            Its number.
        above
            Whether the first piece is above.

        Returns
        -------
        tuple of Touch
            One at each corner of the overlap: a corner inside the other facet, two sides that cross inside each other,
            and else `CoplanarContact`.
        """
        told = self._stack.told
        if (pair, above) not in told:
            found = tuple(self._above(pair))
            told[pair, True], told[pair, False] = (
                found,
                tuple(replace(t, sign=-t.sign) for t in found),
            )
        return told[pair, above]

    def closed(self, pair: int, above: bool, within: float) -> tuple[ContactPair, ...]:
        """Return those of `touches` whose gap is no more than a length: level facets may be open beyond a side."""
        shut = self._stack.shut
        if (pair, above, within) not in shut:
            every = self.touches(pair, above)
            shut[pair, above, within] = tuple(t for t in every if t.gap(self._at) <= within)
        return shut[pair, above, within]

    def _above(self, pair: int) -> list[ContactPair]:
        """Return the gaps of a pair whose first piece is above."""
        stack, crossings = self._stack, self._problem.crossings
        both, features = stack.pairs[pair].tolist(), self._problem.features
        for p in both:
            if p not in stack.outlined:
                stack.outlined[p] = _Piece(stack, features, p)
        one, other = (stack.outlined[p] for p in both)
        up = stack.up[stack.pairs[pair][0]]
        room = INSIDE * crossings.size
        found: list[tuple[np.ndarray, ContactPair | None]] = []
        feature: ContactPair | None
        for of, on, sense in ((one, other, 1.0), (other, one, -1.0)):
            # corners of the overlap: corners of either piece inside the other one, and sides that cross
            for x, corner, depth in zip(of.x, of.corners, on.depth(of.x), strict=True):
                if depth > room:
                    # gaps are along the normal of the facet that stays, which may point up or down
                    sign = sense * float(np.sign(on.way @ up))
                    feature = ContactPair(
                        "vertex-face", (on.facet, of.facet), (corner, *on.triangle), sign
                    )
                    found.append((x, feature))
                elif depth >= -10 * CLOSURE_TOL * crossings.size:
                    found.append((x, None))
        found += [
            (
                x,
                ContactPair("edge-edge", (other.facet, one.facet), sides, sign)
                if far > room
                else None,
            )
            for x, sides, sign, far in _crossings(other, one, up)
        ]
        kept: list[tuple[np.ndarray, ContactPair | None]] = []
        for x, feature in found:
            # a corner on a border is also where sides cross: each point once
            if all(math.dist(x, y) > stack.near for y, _ in kept):
                kept.append((x, feature))
        turn, shift = self._at.turn[one.facet], self._at.shift[one.facet]
        # points of the first piece, also where the other one is not quite in its plane
        points = [x - ((x - one.x[0]) @ one.way) * one.way for x, _ in kept]
        middle = _point((np.mean(points, axis=0) - shift) @ turn)
        corners, sign = (-1, *other.triangle), float(np.sign(other.way @ up))
        facets = other.facet, one.facet
        return [
            feature
            or CoplanarContact(
                "face-face", facets, corners, sign, _point((x - shift) @ turn), middle
            )
            for x, (_, feature) in zip(points, kept, strict=True)
        ]


class _Piece:
    """A convex piece in space: its corners, those of its sides that are borders of the facet, and its normal."""

    def __init__(self, stack: Stack, features: Features, piece: int) -> None:
        rings = features.rings_of_pieces
        real = rings.valid[piece]
        self.x = stack.x[piece][real]
        self.corners: list[int] = stack.crossings.pieces[piece][real].tolist()
        self.border = rings.border[piece][real]
        self.facet = int(stack.crossings.facet[piece])
        self.way = stack.normal[piece]
        a, b, c = rings.triangle[piece].tolist()
        self.triangle: tuple[int, int, int] = a, b, c
        along = np.roll(self.x, -1, axis=0) - self.x
        long = np.linalg.norm(along, axis=1)
        # corner, side from there on, and its length, in plain numbers
        self.sides = list(zip(self.x.tolist(), along.tolist(), long.tolist(), strict=True))
        inward = cross(self.way, along)
        self._inward = inward / np.linalg.norm(inward, axis=1, keepdims=True)

    def depth(self, points: np.ndarray) -> np.ndarray:
        """Return how far inside points of its plane are, [k, 3] -> [k]."""
        depth = np.einsum("kpi,pi->kp", points[:, None] - self.x[None], self._inward)
        return np.asarray(depth.min(axis=1))


def _crossings(
    one: _Piece, other: _Piece, up: np.ndarray
) -> Iterator[tuple[np.ndarray, tuple[int, int, int, int], float, float]]:
    """Go through sides that cross: point, ends, the sign with which the other is above, and the distance of ends."""
    x, y, z = up.tolist()
    first, second = one.sides, other.sides
    for i, ((a0, a1, a2), (u0, u1, u2), long) in enumerate(first):
        for j, ((c0, c1, c2), (v0, v1, v2), far_long) in enumerate(second):
            size = x * (u1 * v2 - u2 * v1) + y * (u2 * v0 - u0 * v2) + z * (u0 * v1 - u1 * v0)
            if abs(size) <= INSIDE * long * far_long:
                continue  # as good as parallel: corners show what there is
            # a + s u = c + t v in the common plane
            d0, d1, d2 = c0 - a0, c1 - a1, c2 - a2
            s = x * (d1 * v2 - d2 * v1) + y * (d2 * v0 - d0 * v2) + z * (d0 * v1 - d1 * v0)
            t = x * (d1 * u2 - d2 * u1) + y * (d2 * u0 - d0 * u2) + z * (d0 * u1 - d1 * u0)
            s, t = s / size, t / size
            if not (0 < s < 1 and 0 < t < 1):
                continue
            far = min(min(s, 1 - s) * long, min(t, 1 - t) * far_long)
            real = one.border[i] and other.border[j]
            after = one.corners[(i + 1) % len(one.x)], other.corners[(j + 1) % len(other.x)]
            sides = one.corners[i], after[0], other.corners[j], after[1]
            at = np.array([a0 + s * u0, a1 + s * u1, a2 + s * u2])
            yield at, sides, math.copysign(1.0, size), far if real else 0.0


def _point(x: np.ndarray) -> Point:
    a, b, c = x.tolist()
    return a, b, c
