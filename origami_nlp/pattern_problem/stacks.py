"""Facets of a folded pattern that lie on each other, in any planes, as an ordering problem.

Of every two convex pieces of paper that overlap in a plane one is above.  These are the rules (the conditions on a
folded state of Demaine and O'Rourke, Geometric Folding Algorithms, section 11.4, for rigid pieces):

- where three overlap, their order is transitive;
- a crease folded flat says by its sign which of its two facets is above;
- about a line along which paper runs through (from one piece over an edge to the next, or straight on within a piece),
  half planes leave in directions that geometry gives, several of them on each other in an order to be found; two such
  passages must not interleave round the line.  With all paper in one plane these are the rules of flat folding (no
  facet passes through a crease, two creases do not interleave); creases that leave the plane obey the same rule.

Nothing happens at points that does not happen along a line through them, so that a state whose facets do not pierce
each other is one of paper exactly if the rules have an answer.
"""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from origami_nlp.numerics import (
    ANSWERED,
    DEEP,
    INSIDE,
    NEAR_SINGULAR_TOL,
    NONZERO,
    cross,
    groups,
    unit_normals,
)
from origami_nlp.pattern_problem.crossings import PatternCrossings, boxes_that_meet
from origami_nlp.pattern_problem.orders import TRANSITIVE, Rule, Rules, not_interleaved, tied
from origami_nlp.pattern_problem.plain_vectors import Vector, dot, minus, scaled, times, vector

if TYPE_CHECKING:
    from numpy.typing import NDArray


GRID = 1e-3
"""Of coordinates where bodies are intersected, over the distance from which features lie on each other."""

Pair = tuple[int, int]
End: TypeAlias = tuple[int, Vector]
"""Of a passage: a piece, and the direction in which it leaves the line."""


class Unclear(Exception):
    """Two pieces are closer than can be resolved, and yet do not lie on each other."""


@dataclass(frozen=True, eq=False)
class Bends:
    """Edges at which two pieces hang together: creases, joined edges, cuts of facets that are not convex.

    Attributes
    ----------
    left, right
        The pieces, [K].
    crease
        The crease, or -1, [K].
    start, end
        Of the edge in space, with its left piece on the left, [K, 3].
    """

    left: NDArray[np.int_]
    right: NDArray[np.int_]
    crease: NDArray[np.int_]
    start: np.ndarray
    end: np.ndarray


class Stack:
    """Pieces that lie on each other, and the rules of their order.

    Parameters
    ----------
    crossings
        The convex pieces of a pattern.
    phi
        Fold angles of a closed state in which no facets pierce each other [rad], [n].
    check
        Called every now and then: may raise to end what takes long.
    near
        Share of the sheet's size up to which features lie on each other: more where corners have few digits.

    Attributes
    ----------
    pairs
        Pieces that overlap, the smaller number first, [K, 2].
    """

    def __init__(
        self,
        crossings: PatternCrossings,
        phi: np.ndarray,
        check: Callable[[], None] = lambda: None,
        near: float = INSIDE,
    ) -> None:
        self.crossings, self.phi, self._check = crossings, crossings.poses.copied(phi), check
        self.near = near * crossings.size
        self.x = crossings.placed(phi)
        self.normal = unit_normals(self.x)
        self.low, self.high = self.x.min(axis=1) - self.near, self.x.max(axis=1) + self.near
        # of a cell that repeats pairs that are lattice vectors apart have one order: they are one unknown
        self._copies = len(crossings.cell.copies) if crossings.cell else 1
        self._own = len(self.x) // self._copies
        self.pairs = self._overlapping()
        # what touches where pairs lie on each other, as `Faces` finds it: of the place of pieces alone
        self.told: dict[tuple[int, bool], tuple[Any, ...]] = {}
        self.shut: dict[tuple[int, bool, float], tuple[Any, ...]] = {}
        self.outlined: dict[int, Any] = {}
        self.unknown: dict[Pair, int] = {}
        for k, (i, j) in enumerate(self.pairs.tolist()):
            self.unknown |= dict.fromkeys(crossings.copied_pairs(i, j), k)

    def at(self, phi: np.ndarray) -> Stack:
        """Return the same pieces on each other, in a state with other fold angles."""
        other = copy.copy(self)
        other.phi = self.crossings.poses.copied(phi)
        return other

    @cached_property
    def ruled(self) -> tuple[Rules, list[tuple[int, ...]]]:
        """All rules, and the pieces that each is about; one without unknowns is the last."""
        rules, about = [], []
        for rule, pieces in self.rules():
            rules.append(rule)
            about.append(pieces)
            if not rule[0]:
                break
        return Rules(len(self.pairs), rules), about

    @property
    def facets(self) -> list[Pair]:
        """Pairs of facets that lie on each other, sorted."""
        f = np.sort(self.crossings.facet[self.pairs], axis=1)
        return sorted({(a, b) for a, b in f.tolist()})

    def _overlapping(self) -> np.ndarray:
        """Return pairs of pieces of different facets, in one plane, that have an area in common."""
        a, b = boxes_that_meet(self.low, self.high)
        a, b = np.minimum(a, b), np.maximum(a, b)
        away = np.maximum(self._off(a, b), self._off(b, a))
        keep = (away <= self.near) & (self.crossings.facet[a] != self.crossings.facet[b])
        keep &= self.crossings.counts(a, b)
        a, b = a[keep], b[keep]
        # what is no further inside one side of a convex piece than `near` has no area in common with it
        inside = np.minimum(self._inside(a, b), self._inside(b, a)) > self.near
        pairs = np.column_stack([a[inside], b[inside]])
        pairs = pairs[np.lexsort(pairs.T[::-1])]
        return pairs[self._is_area(self._common(pairs))] if len(pairs) else pairs

    def _off(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Return how far pieces b reach out of the planes of pieces a, [K]."""
        out = np.einsum("kqi,ki->kq", self.x[b] - self.x[a][:, :1], self.normal[a])
        return np.asarray(np.abs(out).max(axis=1, initial=0.0))

    def _inside(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Return how far pieces b reach inside the sides of pieces a in their planes, the least of these, [K]."""
        x = self.x[a]
        side = np.concatenate([x[:, 1:], x[:, :1]], axis=1) - x
        long = np.linalg.norm(side, axis=2)
        inward = cross(self.normal[a][:, None], side) / np.maximum(long, NONZERO)[..., None]
        reach = np.einsum("kei,kqi->keq", inward, self.x[b]).max(axis=2, initial=-math.inf)
        reach -= np.einsum("kei,kei->ke", inward, x)
        least: np.ndarray = np.where(long > 0, reach, math.inf).min(axis=1)
        return least

    def _drawn(self, which: np.ndarray, on: np.ndarray) -> NDArray[np.object_]:
        """Draw pieces in the planes of others, as polygons, [K]."""
        from shapely import polygons

        u = self.x[on, 1] - self.x[on, 0]
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        frame = np.stack([u, cross(self.normal[on], u)], axis=1)
        flat = np.einsum("kci,kqi->kqc", frame, self.x[which] - self.x[on][:, :1])
        return np.asarray(polygons(flat))

    def _common(self, pairs: np.ndarray) -> NDArray[np.object_]:
        a, b = pairs.T
        return self._shared(self._drawn(a, a), self._drawn(b, a))

    def _shared(self, one: NDArray[np.object_], other: NDArray[np.object_]) -> NDArray[np.object_]:
        """Intersect bodies on a grid: without one, GEOS finds but points in common of some triangles that coincide.

        Lines and points that they share besides are left out: GEOS intersects no such mixture with others.
        """
        from shapely import (
            GeometryType,
            get_dimensions,
            get_parts,
            get_type_id,
            intersection,
            multipolygons,
        )

        shared = np.asarray(intersection(one, other, grid_size=GRID * self.near))
        for i in np.flatnonzero(get_type_id(shared) == GeometryType.GEOMETRYCOLLECTION):
            parts = get_parts(shared[i])
            shared[i] = multipolygons(parts[get_dimensions(parts) == 2])
        return shared

    def _is_area(self, body: NDArray[np.object_]) -> NDArray[np.bool_]:
        """Return which bodies are wider than `near`."""
        from shapely import area, length

        # a strip of width w and length l has the area w l and the perimeter 2 l
        return np.asarray(area(body) > 0.5 * self.near * length(body))

    @cached_property
    def up(self) -> np.ndarray:
        """Of each piece the normal of its plane, from below to above: one for all that lie on each other."""
        # copies of a piece have its direction
        own = self._own
        label = groups(own, self.pairs % own)
        _, first = np.unique(label, return_index=True)
        # the first piece of each stack gives the direction; the others are turned to agree with it
        way = np.einsum("pi,pi->p", self.normal[:own], self.normal[first[label]])
        turned = np.tile(np.where(way < 0, -1.0, 1.0), self._copies)
        return np.asarray(self.normal * turned[:, None])

    @cached_property
    def _up(self) -> list[Vector]:
        up: list[Vector] = self.up.tolist()
        return up

    @cached_property
    def bends(self) -> Bends:
        """Edges at which pieces hang together."""
        left, right, crease, start, end = self.crossings.hinges.T
        return Bends(left, right, crease, self.x[left, start], self.x[left, end])

    def known(self) -> Iterator[tuple[int, bool, int]]:
        """Go through what creases folded flat say: an unknown, its value, the crease."""
        b = self.bends
        for i, j, c in zip(b.left.tolist(), b.right.tolist(), b.crease.tolist(), strict=True):
            if c >= 0 and abs(self.phi[c]) > 0.5 * math.pi and _pair(i, j) in self.unknown:
                # a valley brings the right facet to the side of the left one's normal
                right = (self.phi[c] > 0) == (self.normal[i] @ self.up[i] > 0)
                yield *self.said(j, i, right), c

    def said(self, above: int, below: int, true: bool = True) -> tuple[int, bool]:
        """Write 'the first piece is above the second' as an unknown and its value."""
        return self.unknown[_pair(above, below)], (above < below) == true

    def states(self, order: tuple[int, int, int]) -> Iterator[tuple[int, bool]]:
        """Go through what (f, g, s) of `Layers.orders` says: unknowns and values, wherever polygons f and g overlap."""
        f, g, s = order
        # FOLD: f lies on the side to which g's normal points where s = 1; `up` is one normal for the whole stack
        for k in self._of_polygons.get(_pair(f, g), ()):
            i, j = self.pairs[k].tolist()
            a, b = (i, j) if self.crossings.polygon[i] == f else (j, i)
            yield self.said(a, b, (s > 0) == (self.normal[b] @ self.up[b] > 0))

    @cached_property
    def _of_polygons(self) -> dict[Pair, list[int]]:
        """Of polygons the pairs of their pieces that overlap."""
        found: dict[Pair, list[int]] = {}
        for k, (f, g) in enumerate(self.crossings.polygon[self.pairs].tolist()):
            found.setdefault(_pair(f, g), []).append(k)
        return found

    def rules(self) -> Iterator[tuple[Rule, tuple[int, ...]]]:
        """Go through what orders must obey, each with the pieces that it is about.

        A rule without unknowns that allows nothing says that paper passes through paper whatever the order.

        Raises
        ------
        Unclear
            If two pieces are too close to each other.
        """
        yield from self._transitive()
        yield from self._symmetric()
        seen = set()
        for one, other in self._passages():
            rule = self._apart(one, other)
            if rule is not None and rule not in seen:
                seen.add(rule)
                yield rule, tuple(piece for piece, _ in (*one, *other))

    def _transitive(self) -> Iterator[tuple[Rule, tuple[int, ...]]]:
        if not len(self.pairs):
            return
        beside: dict[int, set[int]] = {}
        for i, j in self.unknown:
            beside.setdefault(i, set()).add(j)
        third = [
            (n, k)
            for n, (i, j) in enumerate(self.pairs.tolist())
            for k in sorted(beside[i] & beside.get(j, set()))
        ]
        if not third:
            return
        n, k = np.array(third).T
        # an order is transitive only where all three have an area in common
        both = self._common(self.pairs)
        common = self._share_a_disc(both, n, k)
        rest = np.flatnonzero(~common)
        drawn = self._drawn(k[rest], self.pairs[n[rest], 0])
        common[rest] = self._is_area(self._shared(both[n[rest]], drawn))
        for (i, j), m in zip(self.pairs[n[common]].tolist(), k[common].tolist(), strict=True):
            unknowns = self.unknown[i, j], self.unknown[j, m], self.unknown[i, m]
            yield tied(unknowns, TRANSITIVE), (i, j, m)

    def _symmetric(self) -> Iterator[tuple[Rule, tuple[int, ...]]]:
        """Go through what states that keep a symmetry obey: images of pieces lie on each other as the pieces do."""
        orbits, crossings = self.crossings.poses.orbits, self.crossings
        if orbits is None:
            return
        number = {frozenset(ring): k for k, ring in enumerate(crossings.pieces.tolist())}
        front = np.einsum("pi,pi->p", self.normal, self.up) > 0
        for image in orbits.images:
            to = [number.get(frozenset(image.corners[r].tolist()), -1) for r in crossings.pieces]
            for k, (i, j) in enumerate(self.pairs.tolist()):
                p, q = to[i], to[j]
                if p >= 0 and q >= 0 and (other := self.unknown.get(_pair(p, q))) is not None:
                    # i is on the front of j as p is on that of q, or on its back where the paper is turned over
                    same = (p < q) == ((front[j] == front[q]) == (image.sign > 0))
                    allowed = frozenset((v, v == same) for v in (False, True))
                    yield tied((k, other), allowed), (i, j, p, q)

    def _share_a_disc(
        self, both: NDArray[np.object_], n: np.ndarray, k: np.ndarray
    ) -> NDArray[np.bool_]:
        """Return which pairs n, that have the areas `both` in common, share a disc wider than `near` with pieces k.

        In a convex body of perimeter l a disc of radius r leaves an area of r l / 2 at least: it is wide enough.
        """
        middle = self._middles(both, self.pairs[:, 0])
        side = np.roll(self.x, -1, axis=1) - self.x
        inward = cross(self.normal[:, None], side)
        length = np.linalg.norm(inward, axis=2, keepdims=True)
        # no side at all where a piece is padded
        inward = np.where(length > 0, inward / np.maximum(length, NONZERO), 0.0)
        a, b = self.pairs[n].T
        others = [
            np.array([self.unknown[_pair(p, q)] for p, q in zip(one, k.tolist(), strict=True)], int)
            for one in (a.tolist(), b.tolist())
        ]
        widest = np.zeros(len(n))
        for at in (n, *others):
            least = np.full(len(n), np.inf)
            for piece in (a, b, k):
                off = middle[at][:, None] - self.x[piece]
                depth = np.einsum("tqi,tqi->tq", off, inward[piece])
                depth[length[piece, :, 0] == 0] = np.inf
                least = np.minimum(least, depth.min(axis=1))
            widest = np.maximum(widest, least)
        # more than the grid moves corners
        return np.asarray(widest > 2 * self.near)

    def _middles(self, both: NDArray[np.object_], on: np.ndarray) -> np.ndarray:
        """Return where in space the middles of areas are that were drawn in the planes of pieces, [K, 3]."""
        from shapely import centroid, get_coordinates

        u = self.x[on, 1] - self.x[on, 0]
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        flat = get_coordinates(centroid(both))
        x = self.x[on, 0] + flat[:, :1] * u + flat[:, 1:] * cross(self.normal[on], u)
        return np.asarray(x)

    def middles(self, which: np.ndarray) -> np.ndarray:
        """Return the middles of what pairs have in common, in space, [K, 3]; which: their numbers, [K]."""
        pairs = self.pairs[which]
        return self._middles(self._common(pairs), pairs[:, 0])

    def _passages(self) -> Iterator[tuple[tuple[End, End], tuple[End, End]]]:
        """Go through pairs of passages along a common piece of a line, the first of them over an edge."""
        b = self.bends
        if not len(b.left):
            return
        count = len(b.left)
        low, high = np.minimum(b.start, b.end), np.maximum(b.start, b.end)
        i, j = boxes_that_meet(np.vstack([low, self.low]), np.vstack([high, self.high]))
        i, j = np.minimum(i, j), np.maximum(i, j)
        mixed = (i < count) & (j >= count)
        edge, piece = i[mixed], j[mixed] - count
        own = (piece == b.left[edge]) | (piece == b.right[edge])
        along = b.end - b.start
        length = np.linalg.norm(along, axis=1)
        along /= length[:, None]
        first = self.x[piece, 0]
        off = [np.einsum("ki,ki->k", e[edge] - first, self.normal[piece]) for e in (b.start, b.end)]
        # edges that lie in the plane of a piece they do not belong to: there its passage can be interleaved with theirs
        keep = ~own & (np.abs(off).max(axis=0, initial=0.0) <= self.near)
        # of a cell its own edges, whatever they meet
        begin = self.crossings.own_pieces
        keep &= (begin <= b.left[edge]) & (b.left[edge] < begin + self._own)
        edge, piece = edge[keep], piece[keep]
        side = cross(self.normal[piece], along[edge])
        low, high, where = self._reach(piece, b.start[edge], along[edge], side)
        low, high = np.maximum(low, 0.0), np.minimum(high, length[edge])
        long = np.flatnonzero(high - low > 10 * self.near)
        seen = set()
        for k, e, p in zip(long.tolist(), edge[long].tolist(), piece[long].tolist(), strict=True):
            self._check()
            one = self._over[e]
            if where[k] == 0:
                at = np.linspace(low[k], high[k], 3)[:, None]
                if not self._goes_round(one, p, (b.start[e] + at * along[e]).tolist()):
                    d = vector(side[k])
                    yield one, ((p, d), (p, scaled(d, -1.0)))
                continue
            for other in self._edges_of[p]:
                if (pair := _pair(e, other)) in seen or e == other:
                    continue
                ends = np.stack([b.start[other], b.end[other]]) - b.start[e]
                t = ends @ along[e]
                apart = np.linalg.norm(ends - t[:, None] * along[e], axis=1).max()
                if apart > self.near or min(t.max(), length[e]) - max(t.min(), 0) <= 10 * self.near:
                    continue
                seen.add(pair)
                yield one, self._over[other]

    def _goes_round(self, one: tuple[End, End], p: int, points: list[list[float]]) -> bool:
        """Return whether a passage over an edge, off a piece by less than `near`, meets its plane beside its paper.

        points: on the edge, [m, 3].  What pierces the piece by more than `DEEP` was found before; what only touches its
        border does not pass through it.
        """
        normal, sides = self._plain[p]
        deep, first = DEEP * self.crossings.size, sides[0][0]
        for piece, way in one:
            slope = dot(way, normal)
            if abs(slope) <= ANSWERED or _pair(piece, p) in self.unknown:
                continue
            any_down, inside = False, True
            for point in points:
                height = dot(minus(point, first), normal)
                # nearer than `DEEP` the edge itself is on the paper
                down = height * slope < 0 and abs(height) > deep
                meets = minus(point, scaled(way, height / slope)) if down else point
                any_down |= down
                inside &= min(dot(minus(meets, x), inward) for x, inward in sides) <= deep
            if any_down and inside:
                return True
        return False

    @cached_property
    def _plain(self) -> list[tuple[Vector, list[tuple[Vector, Vector]]]]:
        """Of each piece its normal, and its corners with the way inward from the side that begins there."""
        inward = cross(self.normal[:, None], np.roll(self.x, -1, axis=1) - self.x)
        inward /= np.maximum(np.linalg.norm(inward, axis=2, keepdims=True), NONZERO)
        each = zip(self.normal.tolist(), self.x.tolist(), inward.tolist(), strict=True)
        return [(n, list(zip(x, way, strict=True))) for n, x, way in each]

    @cached_property
    def _edges_of(self) -> list[list[int]]:
        """Of each piece the edges at which it hangs together with others."""
        found: list[list[int]] = [[] for _ in self.x]
        for e, both in enumerate(
            zip(self.bends.left.tolist(), self.bends.right.tolist(), strict=True)
        ):
            for p in both:
                found[p].append(e)
        return found

    @cached_property
    def _over(self) -> list[tuple[End, End]]:
        """The passage over each edge."""
        b = self.bends
        along = b.end - b.start
        along /= np.linalg.norm(along, axis=1)[:, None]
        ways = cross(self.normal[b.left], along), -cross(self.normal[b.right], along)
        each = zip(
            b.left.tolist(), ways[0].tolist(), b.right.tolist(), ways[1].tolist(), strict=True
        )
        return [((i, vector(u)), (j, vector(v))) for i, u, j, v in each]

    def _reach(
        self, piece: np.ndarray, origin: np.ndarray, along: np.ndarray, d: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return from where to where lines run through pieces (0), or along a border (side on which they lie), [K]."""
        x = self.x[piece] - origin[:, None]
        t, h = np.einsum("kqi,ki->kq", x, along), np.einsum("kqi,ki->kq", x, d)
        # heights over the line within the piece's plane: of both signs where the line runs through it
        h = np.where(np.abs(h) <= self.near, 0.0, h)
        t2, h2 = np.roll(t, -1, axis=1), np.roll(h, -1, axis=1)
        cut = h * h2 < 0
        at = np.where(cut, t + (t2 - t) * h / np.where(cut, h - h2, 1.0), t)
        on = cut | (h == 0.0)
        # of the corners that are on the line and the sides that it cuts
        low = np.where(on, at, np.inf).min(axis=1, initial=np.inf)
        high = np.where(on, at, -np.inf).max(axis=1, initial=-np.inf)
        above, below = (h > 0).any(axis=1), (h < 0).any(axis=1)
        return low, high, np.where(above & below, 0, np.where(above, 1, -1))

    def _apart(self, one: tuple[End, End], other: tuple[End, End]) -> Rule | None:
        """Keep two passages from interleaving; None where no order could make them."""
        ends = [*one, *other]
        d = [way for _, way in ends]
        axis = times(d[0], self._plain[ends[0][0]][0])
        axis = scaled(axis, 1 / math.hypot(*axis))
        e1 = minus(d[0], scaled(axis, dot(d[0], axis)))
        e2 = times(axis, e1)
        turned = [math.atan2(dot(way, e2), dot(way, e1)) for way in d]
        # ends of passages on one ray: pieces that lie on each other and leave the line in the same direction
        ray = list(range(4))
        for k, m in itertools.combinations(range(4), 2):
            i, j = ends[k][0], ends[m][0]
            if _pair(i, j) in self.unknown and dot(d[k], d[m]) > 0:
                ray = [ray[k] if r == ray[m] else r for r in ray]
        for k, m in itertools.combinations(range(4), 2):
            if ray[k] != ray[m] and math.dist(d[k], d[m]) < ANSWERED:
                raise Unclear
        rank = {r: n for n, r in enumerate(sorted(set(ray), key=lambda r: turned[r]))}
        # on a ray, what is above comes later, counter-clockwise about the axis, or earlier
        later = [dot(self._up[p], times(axis, way)) > 0 for p, way in ends]
        pairs: dict[Pair, int] = {}
        level = []
        for k, m in itertools.combinations(range(4), 2):
            if ray[k] == ray[m]:
                (i, _), (j, _) = ends[k], ends[m]
                which = pairs.setdefault(_pair(i, j), len(pairs))
                level.append((k, m, which, (i > j) == later[k]))
        if any(pair not in self.unknown for pair in pairs):
            raise Unclear
        allowed = not_interleaved(tuple(rank[r] for r in ray), tuple(level))
        if not pairs and allowed:
            return None
        if not pairs and any(
            ray[k] != ray[m] and math.dist(d[k], d[m]) < NEAR_SINGULAR_TOL
            for k, m in itertools.combinations(range(4), 2)
        ):
            # the line may be as far off the piece as features that lie on each other: what leaves it at so small an
            # angle may end before it comes to the other side
            raise Unclear
        return tied(tuple(self.unknown[pair] for pair in pairs), allowed)

    def polygons(self, values: Iterable[bool]) -> tuple[tuple[int, int, int], ...]:
        """Return the order as FOLD does: polygons f, g and s = 1 where f lies on the side of g's normal, else -1."""
        number = self.crossings.polygon
        found: dict[Pair, set[int]] = {}
        for (i, j), value in zip(self.pairs.tolist(), values, strict=True):
            s = 1 if value == (self.normal[j] @ self.up[j] > 0) else -1
            f, g = int(number[i]), int(number[j])
            if self._copies > 1:  # orders within the cell, by its own numbers
                f, g = (
                    x - self.crossings.cell.home * len(self.crossings.cell.polygons) for x in (f, g)
                )
                if max(f, g) >= len(self.crossings.cell.polygons):
                    continue
            found.setdefault((f, g), set()).add(s)
        # polygons that are not convex can be above each other here and below there
        return tuple((f, g, s.pop()) for (f, g), s in sorted(found.items()) if len(s) == 1)


def _pair(i: int, j: int) -> Pair:
    return (i, j) if i < j else (j, i)
