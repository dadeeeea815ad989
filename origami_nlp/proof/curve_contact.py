"""Which facets cross along curves, over boxes of theta, with proved rounding.

Facets that share an interior vertex do not cross where it closes turned by no full turn and no crease is beyond +-pi:
each is convex and so within the cone of its sector.  The four sectors are a closed curve of length 2 pi on the sphere,
so within a hemisphere; seen from its centre that is a quadrangle in the plane, of whose two pairs of opposite sides one
crosses at most.  A crossing would be a full turn more, and such states are none of the sheet's.

Two other facets are apart where a plane separates all their corners, and cross where an edge, or a diagonal, of one
passes through the other inside.  Where they meet first, a corner reaches a facet or an edge an edge: a determinant g of
three vectors between corners is 0, and where g' has a sign over a box, they are apart on one side of its zero and cross
on the other.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.pattern import Pattern, in_plane
from origami_nlp.proof.ball_vectors import (
    corner,
    determinant,
    jet_part,
    part,
    product,
    rolled,
    stacked,
)
from origami_nlp.proof.balls import Ball, Jet, exact, rational
from origami_nlp.proof.flat_sheets import cross
from origami_nlp.proof.quad_states import QuadStates

UNKNOWN, APART, CROSSING, TOUCHING = range(4)
"""Of facets over a box: nothing; all apart; two cross; two are apart on one side of a state."""
NEAR = 2.0**-6
"""Width of theta above which no first touch is looked for [rad]: such boxes are cut first."""


class FacetTouch(NamedTuple):
    """Two polygons that meet over a box: g = sign det(x1 - x0, x2 - x0, x3 - x0) > 0 where they are apart.

    Corners x0..x3 as polygon and place in it; g grows with theta or falls: `slope`, +-1.
    """

    polygons: tuple[int, int]
    corners: tuple[tuple[int, int], ...]
    sign: float
    slope: float


def why_no_contact(pattern: Pattern) -> str:
    """Return why contact between the facets of a mesh is not proved; "" where it is.

    Parameters
    ----------
    pattern
        A mesh of which `why_no_quad_mesh` says nothing.

    Returns
    -------
    str
        The first reason.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import why_no_contact
    >>> why_no_contact(o.examples.pattern("metasheet", 2, 3))
    ''
    """
    if len(pattern.polygons) != pattern.facets:
        return "a facet is of several pieces"
    if not all(_is_convex(pattern, p) for p in pattern.polygons):
        return "a facet is not convex"
    if any(set(pattern.polygons[a]) & set(pattern.polygons[b]) for a, b in _far_pairs(pattern)):
        return "two facets share a corner of the border and no vertex"
    return ""


def _is_convex(pattern: Pattern, polygon: tuple[int, ...]) -> bool:
    """Return whether a polygon is convex, in exact arithmetic; corners of 180 degrees may be."""
    x = [(Fraction(a), Fraction(b)) for a, b in in_plane(pattern)[list(polygon)].tolist()]
    u = [(b[0] - a[0], b[1] - a[1]) for a, b in zip(x, x[1:] + x[:1], strict=True)]
    return not {-1, 1} <= {(t > 0) - (t < 0) for t in map(cross, u, u[1:] + u[:1])}


def _far_pairs(pattern: Pattern) -> list[tuple[int, int]]:
    """Return pairs of polygons that share no interior vertex."""
    inside = {v.vertex for v in pattern.vertices}
    at = [inside & set(p) for p in pattern.polygons]
    return [(a, b) for a, b in itertools.combinations(range(len(at)), 2) if not at[a] & at[b]]


class Facets(NamedTuple):
    """All corners of the polygons of a mesh over boxes, [3, q, K] each: in the middle, and over the boxes."""

    middle: list[Ball]
    over: list[Jet]

    def take(self, boxes: Any) -> Facets:
        """Return some of the boxes."""
        some = np.s_[..., boxes]
        return Facets([part(x, some) for x in self.middle], [jet_part(x, some) for x in self.over])


class CurveContact:
    """Which facets of a mesh cross.

    Parameters
    ----------
    pattern
        A mesh of which `why_no_contact` says nothing.
    """

    def __init__(self, pattern: Pattern) -> None:
        self.pattern, self.pairs = pattern, _far_pairs(pattern)
        self._between = [_between(pattern, a, b) for a, b in self.pairs]
        self.steps = [(*step, _turning(pattern, *step[2:])) for step in _walk(pattern)]

    def facets(
        self, at: QuadStates, box: QuadStates, angles: dict[int, Ball], half: np.ndarray
    ) -> Facets:
        """Return the facets in the middle of boxes and over them; fold angles over the boxes are given."""
        middle = [x.value for x in self.corners(at, at.angles)]
        slopes = [x.slope for x in self.corners(box, angles)]
        # x = x(middle) + x' (theta - middle)
        over = [Jet(m.widened(s.magnitude * half), s) for m, s in zip(middle, slopes, strict=True)]
        return Facets(middle, over)

    def corners(self, states: QuadStates, angles: dict[int, Ball]) -> list[Jet]:
        """Return the corners of each polygon in space, [3, q, K]; one facet stays where it is."""
        place = exact(self.pattern.corners.T[:, :, None])
        many = len(states.narrow)
        unit = exact(np.broadcast_to(np.eye(3)[:, :, None], (3, 3, many)))
        zero = exact(np.zeros((3, 1, many)))
        turn = {0: Jet(unit, exact(np.zeros((3, 3, many))))}
        shift = {0: Jet(zero, zero)}
        for facet, before, crease, _, (once, twice) in self.steps:
            rate = states.slopes[crease].value
            s, c = angles[crease].sine(), angles[crease].cosine()
            sine, versed = Jet(s, c * rate), (Jet(-c, s * rate)).plus(exact(1.0))
            # r = 1 + sin phi K + (1 - cos phi) K^2 about a crease through o: x -> R_parent (o + r (x - o)) + t_parent
            r = (sine * once + versed * twice).plus(exact(np.eye(3)[:, :, None]))
            o = part(place, np.s_[:, [self.pattern.ends[crease, 0]]])
            still = Jet(o, exact(np.zeros((3, 1, 1))))
            shift[facet] = product(turn[before], still + -product(r, still)) + shift[before]
            turn[facet] = product(turn[before], r)
        out = []
        for polygon, f in zip(self.pattern.polygons, self.pattern.facet_of.tolist(), strict=True):
            flat = Jet(part(place, np.s_[:, list(polygon)]), exact(np.zeros((3, len(polygon), 1))))
            out.append(product(turn[f], flat) + shift[f])
        return out

    def over(
        self, facets: Facets, angles: dict[int, Ball], width: np.ndarray
    ) -> tuple[np.ndarray, dict[int, tuple[FacetTouch, ...]]]:
        """Return what is known of all facets over boxes, [K], and where pairs of them meet."""
        known = self._of_pairs(facets, _sides_of_folds(angles))
        status = np.full(len(width), APART)
        status[(known == UNKNOWN).any(axis=0)] = UNKNOWN
        status[(known == CROSSING).any(axis=0)] = CROSSING
        touches = {}
        for k in np.flatnonzero((status == UNKNOWN) & (width <= NEAR)).tolist():
            one = facets.take([k])
            found: list[FacetTouch] = []
            for pair in np.flatnonzero(known[:, k] == UNKNOWN).tolist():
                touch = _find_touch(one, *self.pairs[pair])
                if touch is None or touch.slope != (found or [touch])[0].slope:
                    break
                found.append(touch)
            else:
                touches[k], status[k] = tuple(found), TOUCHING
        return status, touches

    def _of_pairs(self, facets: Facets, signs: dict[int, np.ndarray]) -> np.ndarray:
        """Return what is known of each pair over boxes where creases are folded to these sides, [pairs, K]."""
        many = facets.middle[0].centre.shape[-1]
        known = np.array([self._apart(facets, a, b) for a, b in self.pairs])
        known = known.reshape(len(self.pairs), many)
        for of_pair, (a, b), between in zip(known, self.pairs, self._between, strict=True):
            for one, other, _ in between:
                # on either side of the facet between them
                of_pair[signs[one] * signs[other] < 0] = APART
            open_ = np.flatnonzero(of_pair == UNKNOWN)
            some = facets.take(open_)
            crosses = _passes_through(some, a, b) | _passes_through(some, b, a)
            of_pair[open_[crosses]] = CROSSING
        return known

    def at_limits(self, facets: Facets, angles: dict[int, Ball], limits: dict[int, float]) -> int:
        """Return what is known of all facets in a box, at the state where creases reach limits, +-1 times pi.

        Two facets in one plane hold all their corners in it: others may lie on either side of it.  Where facet A is
        folded flat on C and goes on past a crease beyond which B is folded to the same side, A passes from one side of
        C and B to the other: they cross.
        """
        signs = _sides_of_folds(angles) | {c: np.array([s]) for c, s in limits.items()}
        known = self._of_pairs(facets, signs)[:, 0]
        piece = {int(f): k for k, f in enumerate(self.pattern.facet_of)}
        left, right = (
            np.array([piece[int(f)] for f in x]) for x in (self.pattern.left, self.pattern.right)
        )
        # of several that reach their limits all but together, which is first is not known
        for k in np.flatnonzero(known == UNKNOWN).tolist() * (len(limits) == 1):
            for flat, fold in limits.items():
                beside = int(left[flat]), int(right[flat])
                if self._plane_between(facets, self.pairs[k], beside, fold):
                    known[k] = APART
            for one, other, third in self._between[k]:
                for a, flat, crease in (
                    (self.pairs[k][0], one, other),
                    (self.pairs[k][1], other, one),
                ):
                    if flat in limits and crease not in limits and signs[flat] * signs[crease] > 0:
                        ends = self.pattern.ends[crease].tolist()
                        if _reaches_over(facets, self.pattern, a, third, ends):
                            known[k] = CROSSING
        return CROSSING if CROSSING in known else UNKNOWN if UNKNOWN in known else APART

    def _plane_between(
        self, facets: Facets, pair: tuple[int, int], flat: tuple[int, int], fold: float
    ) -> bool:
        """Return whether one of two facets that come to lie on each other is between two polygons, until they do.

        Its own corners are in its plane, those of the other facet on the side to which that is folded, or in it: of a
        valley that of the normal.  A polygon on the far side may have none of the latter.
        """
        for base, over in (flat, flat[::-1]):
            own, folded = (set(self.pattern.polygons[p]) for p in (base, over))
            sides = []
            for p in pair:
                polygon = self.pattern.polygons[p]
                far = (
                    sides_of_plane(facets.over[p].value, facets.over[base].value)
                    .sign[:, 0]
                    .tolist()
                )
                beyond = {s for s, v in zip(far, polygon, strict=True) if v not in own | folded}
                if p == over:
                    beyond = {fold}
                elif beyond == {-fold} and set(polygon) & (folded - own):
                    beyond = set()
                sides.append(sum(beyond) if len(beyond) == 1 and p != base else 0.0)
            if sides[0] * sides[1] < 0:
                return True
        return False

    def gaps(self, touches: tuple[FacetTouch, ...], states: QuadStates) -> Ball:
        """Return all g at single states, [touches, K]."""
        x = self.corners(states, states.angles)
        found = [
            exact(t.sign) * _gap([corner(x[p].value, i) for p, i in t.corners]) for t in touches
        ]
        return stacked(found)

    def _apart(self, facets: Facets, a: int, b: int) -> np.ndarray:
        """Return APART where a plane separates two polygons over the boxes, else UNKNOWN, [K]."""
        x, y = facets.middle[a].centre, facets.middle[b].centre
        axes = np.concatenate(list(_axes(x, y)), axis=1)  # [3, C, K]
        axes = axes / np.maximum(np.linalg.norm(axes, axis=0), np.finfo(float).tiny)
        u, v = (np.einsum("ick,iqk->cqk", axes, z) for z in (x, y))
        ahead = v.min(axis=1) - u.max(axis=1), u.min(axis=1) - v.max(axis=1)
        best = np.nan_to_num(np.stack(ahead), nan=-np.inf).reshape(-1, x.shape[2]).argmax(axis=0)
        chosen = axes[:, best % axes.shape[1], np.arange(x.shape[2])]
        chosen = np.where(best < axes.shape[1], 1.0, -1.0) * chosen
        low, high = (_along(chosen, facets.over[p].value) for p in (b, a))
        apart = (low.centre - low.radius).min(axis=0) > (high.centre + high.radius).max(axis=0)
        return np.where(apart, APART, UNKNOWN)


def _sides_of_folds(angles: dict[int, Ball]) -> dict[int, np.ndarray]:
    """Return to which side creases are folded over boxes, +-1, 0 where it is not certain or they may pass +-pi."""
    return {c: np.where(a.magnitude < math.pi, a.sign, 0.0) for c, a in angles.items()}


def _between(pattern: Pattern, a: int, b: int) -> list[tuple[int, int, int]]:
    """Return the creases from polygon a and from b to a third one beside both, and that, where there is one."""
    beside: dict[int, dict[int, int]] = {a: {}, b: {}}
    piece = {int(f): k for k, f in enumerate(pattern.facet_of)}
    for crease, pair in enumerate(zip(pattern.left.tolist(), pattern.right.tolist(), strict=True)):
        x, y = (piece[f] for f in pair)
        for here, there in ((x, y), (y, x)):
            if here in beside:
                beside[here][there] = crease
    return [(beside[a][c], beside[b][c], c) for c in beside[a].keys() & beside[b].keys()]


def _reaches_over(facets: Facets, pattern: Pattern, a: int, c: int, ends: list[int]) -> bool:
    """Return whether polygon a, flat on c, certainly has a point of a side of c inside, given by the side's ends."""
    x, y = facets.over[a].value, facets.over[c].value
    n = y.centre.shape[1]
    normal = _determinant_normal(y, n)
    one, two = (corner(y, pattern.polygons[c].index(v)) for v in ends)
    for share in (np.arange(1, 20) / 20).tolist():
        point = one + exact(share) * (two - one)
        side = rolled(x) - x
        turn = determinant(normal, side, part(point, np.s_[:, None]) - x).sign[:, 0]
        if turn[0] != 0 and (turn == turn[0]).all():
            return True
    return False


def _determinant_normal(y: Ball, n: int) -> Ball:
    """Return the normal of a polygon, [3, 1, K]."""
    u, v = (part(corner(y, k) - corner(y, 0), np.s_[:, None]) for k in (n // 3, 2 * n // 3))
    (a, b, c), (d, e, f) = ([part(w, i) for i in range(3)] for w in (u, v))
    return stacked([b * f - c * e, c * d - a * f, a * e - b * d])


def _axes(x: np.ndarray, y: np.ndarray) -> Iterator[np.ndarray]:
    """Yield normals of planes that may separate two plane polygons, [3, C, K] each."""
    (n, e), (m, f) = (_normal_andsides_of_plane(z) for z in (x, y))
    yield from (n[:, None], m[:, None])
    yield from (np.cross(n[:, None], e, axis=0), np.cross(m[:, None], f, axis=0))
    yield np.cross(e[:, :, None], f[:, None], axis=0).reshape(3, -1, x.shape[2])


def _normal_andsides_of_plane(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the normal [3, K] and the sides [3, q, K] of a polygon."""
    return np.cross(x, np.roll(x, -1, axis=1), axis=0).sum(axis=1), np.roll(x, -1, axis=1) - x


def _along(axis: np.ndarray, x: Ball) -> Ball:
    """Return x along an axis [3, K], for corners [3, q, K]."""
    parts = [exact(axis[i]) * part(x, i) for i in range(3)]
    return parts[0] + parts[1] + parts[2]


def _passes_through(facets: Facets, a: int, b: int) -> np.ndarray:
    """Return whether an edge or diagonal of polygon a certainly passes through polygon b inside, over the boxes, [K].

    Where edges pass edges at both ends of a crossing, as in sheets with half-turns, a diagonal alone does.
    """
    x, y = facets.over[a].value, facets.over[b].value
    side = sides_of_plane(x, y).sign
    found = np.zeros(side.shape[1:], bool)
    for steps in range(1, len(side) // 2 + 1):
        turn = _orientations(x, y, steps).sign
        through = (turn[:, :1] != 0).all(axis=1) & (turn == turn[:, :1]).all(axis=1)
        found |= (through & (side * np.roll(side, -steps, axis=0) < 0)).any(axis=0)
    return found


def sides_of_plane(x: Ball, y: Ball) -> Ball:
    """Return on which side of the plane of polygon y corners x are, [q, K]."""
    n = y.centre.shape[1]
    q = [part(y, np.s_[:, i : i + 1]) for i in (0, n // 3, 2 * n // 3)]
    return determinant(q[1] - q[0], q[2] - q[0], x - q[0])


def _orientations(x: Ball, y: Ball, steps: int = 1) -> Ball:
    """Return how the lines of the sides of x pass those of y, [sides of x, sides of y, K]: all alike if through it.

    With more steps, lines from each corner of x to the one so many on.
    """
    p, q = (part(z, np.s_[:, :, None]) for z in (x, rolled(x, steps)))
    r, s = (part(z, np.s_[:, None]) for z in (y, rolled(y)))
    return determinant(q - p, r - p, s - p)


def _find_touch(facets: Facets, a: int, b: int) -> FacetTouch | None:
    """Return the corners with which two polygons meet over a single box, if they are certain."""
    x, y = (facets.middle[p].centre[:, :, 0].T for p in (a, b))
    far, i, j = min(_nearest(x, y))
    if not np.isfinite(far):
        return None
    if j == -1:
        return _corner_on_facet(facets, a, b, i)
    return _corner_on_facet(facets, b, a, j) if i == -1 else _edge_on_edge(facets, a, b, i, j)


def _nearest(x: np.ndarray, y: np.ndarray) -> Iterator[tuple[float, int, int]]:
    """Yield distances of polygons [q, 3] and where: corner i of x over y (j = -1), j of y over x, or sides i, j."""
    for first, second, turn in ((x, y, 1), (y, x, -1)):
        normal = np.cross(second, np.roll(second, -1, axis=0)).sum(axis=0)
        normal /= np.linalg.norm(normal)
        side = np.roll(second, -1, axis=0) - second
        inside = (np.cross(side, first[:, None] - second) @ normal > 0).all(axis=1)
        height = np.where(inside, np.abs((first - second[0]) @ normal), np.inf)
        k = int(height.argmin())
        yield (float(height[k]), k, -1) if turn > 0 else (float(height[k]), -1, k)
    e, f = (np.roll(z, -1, axis=0) - z for z in (x, y))
    for i, j in itertools.product(range(len(x)), range(len(y))):
        normal, apart = np.cross(e[i], f[j]), y[j] - x[i]
        square = max(float(normal @ normal), np.finfo(float).tiny)
        s, t = (float(np.cross(apart, z) @ normal) / square for z in (f[j], e[i]))
        if 0 < s < 1 and 0 < t < 1:
            yield abs(float(apart @ normal)) / square**0.5, i, j


def _corner_on_facet(facets: Facets, a: int, b: int, i: int) -> FacetTouch | None:
    """Return how corner i of polygon a meets polygon b, if its others are on one side and a side at it goes through."""
    x, y = facets.over[a].value, facets.over[b].value
    side = sides_of_plane(x, y).sign[:, 0]
    others = np.delete(side, i)
    if not (others != 0).all() or not (others == others[0]).all():
        return None
    turn = _orientations(x, y).sign[[i - 1, i], :, 0]  # of the two sides at the corner
    if not ((turn[:, :1] != 0) & (turn == turn[:, :1])).all(axis=1).any():
        return None
    n = y.centre.shape[1]
    return _touch(facets, (a, b), ((b, 0), (b, n // 3), (b, 2 * n // 3), (a, i)), others[0])


def _edge_on_edge(facets: Facets, a: int, b: int, i: int, j: int) -> FacetTouch | None:
    """Return how side i of polygon a meets side j of polygon b, if both lie beyond and one goes through beside it."""
    x, y = facets.over[a].value, facets.over[b].value
    i2, j2 = (i + 1) % x.centre.shape[1], (j + 1) % y.centre.shape[1]
    e, f = (
        part(corner(z, n) - corner(z, k), np.s_[:, None]) for z, k, n in ((x, i, i2), (y, j, j2))
    )
    below, above = (
        np.delete(determinant(e, f, z - part(z, np.s_[:, [k]])).sign[:, 0], [k, n])
        for z, k, n in ((x, i, i2), (y, j, j2))
    )
    sign = above[0]
    if sign == 0 or not ((above == sign).all() and (below == -sign).all()):
        return None
    ends = sides_of_plane(y, x).sign[[j, j2], 0]
    turn = np.delete(_orientations(y, x).sign[j, :, 0], i)
    # past side i itself it turns as -sign g: as past all others where g < 0
    if ends[0] * ends[1] >= 0 or not (turn == sign).all():
        return None
    # det(x1 - x0, y1 - y0, y0 - x0) = det(x1 - x0, y1 - x0, y0 - x0)
    return _touch(facets, (a, b), ((a, i), (a, i2), (b, j2), (b, j)), sign)


def _touch(
    facets: Facets, polygons: tuple[int, int], corners: tuple[tuple[int, int], ...], sign: float
) -> FacetTouch | None:
    x = [jet_part(facets.over[p], np.s_[:, k]) for p, k in corners]
    first = -x[0]
    slope = sign * determinant(x[1] + first, x[2] + first, x[3] + first).slope.sign[0]
    return FacetTouch(polygons, corners, float(sign), float(slope)) if slope else None


def _gap(x: list[Ball]) -> Ball:
    return determinant(*(y - x[0] for y in x[1:]))


def _turning(pattern: Pattern, crease: int, sense: float) -> tuple[Ball, Ball]:
    """Return K and K^2 for the direction u of a crease of a flat sheet, K x = u x x times its sense, [3, 3, 1]."""
    a, b = pattern.corners[pattern.ends[crease], :2].tolist()
    u, v = (Fraction(q) - Fraction(p) for p, q in zip(a, b, strict=True))
    square = u * u + v * v
    length = rational(square).root().inverse()
    x, y = rational(u) * length, rational(v) * length
    zero = exact(0.0)
    once = [[zero, zero, y], [zero, zero, -x], [-y, x, zero]]
    mixed = rational(u * v / square)
    twice = [
        [rational(-v * v / square), mixed, zero],
        [mixed, rational(-u * u / square), zero],
        [zero, zero, exact(-1.0)],
    ]
    k, kk = (
        part(stacked([stacked(row) for row in rows]), np.s_[..., None]) for rows in (once, twice)
    )
    return exact(sense) * k, kk


def _walk(pattern: Pattern) -> Iterator[tuple[int, int, int, float]]:
    """Yield each facet but the first, from the one before, with the crease between and the sense of crossing it."""
    seen, front = {0}, [0]
    for here in front:
        for crease, (left, right) in enumerate(
            zip(pattern.left.tolist(), pattern.right.tolist(), strict=True)
        ):
            for there, from_, sense in ((right, left, -1.0), (left, right, 1.0)):
                if from_ == here and there not in seen:
                    seen.add(there)
                    front.append(there)
                    yield there, here, crease, sense
