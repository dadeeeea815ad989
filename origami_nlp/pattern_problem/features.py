"""Which features of facets face each other, and which of them touch.

Facets that share no corner begin to cross where a corner of one meets the inside of the other, or where two sides meet
inside each other.  Facets that share one corner are sectors about it: they begin to cross where a side that starts
there meets the inside of the other sector.  Corners that meet sides, sides that meet along a line, and facets that lie
on each other have no single gap, and are no features here.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.numerics import INSIDE, NONZERO, OUTSIDE, area_vectors, cross, first_largest
from origami_nlp.pattern_problem.compiled_facets import FacingInC
from origami_nlp.pattern_problem.contact_pairs import ContactPair, FoldedGeometry
from origami_nlp.pattern_problem.crossings import PatternCrossings


@dataclass(frozen=True)
class _Rings:
    """Convex pieces [P, q]: corners, next and previous places, real corners, sides that are borders, and a triangle."""

    valid: np.ndarray
    after: np.ndarray
    before: np.ndarray
    border: np.ndarray
    triangle: np.ndarray


@dataclass(frozen=True)
class Planes:
    """Convex pieces in space: corners and sides [P, q, 3], normals [P, 3], and normals of sides inward [P, q, 3]."""

    x: np.ndarray
    side: np.ndarray
    normal: np.ndarray
    inward: np.ndarray


class Features:
    """Features of the convex pieces of a pattern's facets.

    Parameters
    ----------
    crossings
        The crossing test, with its pieces.
    """

    def __init__(self, crossings: PatternCrossings) -> None:
        self.crossings = crossings
        self._planes: tuple[FoldedGeometry, Planes] | None = None
        self._facing: (
            tuple[FoldedGeometry, float, list[tuple[ContactPair, float, float]]] | None
        ) = None

    @cached_property
    def rings_of_pieces(self) -> _Rings:
        """Convex pieces with what is next to what."""
        pieces = self.crossings.pieces
        count, q = pieces.shape
        valid = np.ones((count, q), bool)
        valid[:, 1:] = pieces[:, 1:] != pieces[:, :1]
        many = valid.sum(axis=1)[:, None]
        place = np.arange(q)[None]
        after, before = (place + 1) % many, (place - 1) % many
        x = self.crossings.pattern.corners[pieces]
        size = np.linalg.norm(
            cross((x - x[:, :1])[:, :, None], (x - x[:, :1])[:, None]), axis=3
        ).reshape(count, -1)
        # the triangle from the first corner with the largest area stands for the plane
        best = first_largest(size)
        low, high = np.minimum(best // q, best % q), np.maximum(best // q, best % q)
        rows = np.arange(count)
        triangle = np.column_stack([pieces[:, 0], pieces[rows, low], pieces[rows, high]])
        return _Rings(valid, after, before, valid & ~self.crossings.inner, triangle)

    @cached_property
    def rings(self) -> list[set[int]]:
        """Corners of each facet."""
        pattern = self.crossings.pattern
        out: list[set[int]] = [set() for _ in range(pattern.facets)]
        for polygon, facet in zip(pattern.polygons, pattern.facet_of.tolist(), strict=True):
            out[facet].update(polygon)
        return out

    def between(self, touch: ContactPair, pair: tuple[int, int]) -> bool:
        """Return whether features are of these two facets, among others that share a corner or a side with them."""
        (a, b), (p, q, r, s) = pair, touch.corners
        for one, other in ((a, b), (b, a)):
            if touch.type == "vertex-face":
                if touch.facets[0] == one and p in self.rings[other]:
                    return True
            elif {p, q} <= self.rings[one] and {r, s} <= self.rings[other]:
                return True
        return False

    def planes(self, at: FoldedGeometry) -> Planes:
        """Return the pieces in space at a state, with the normals of their planes and sides; kept for the last one."""
        if self._planes is None or self._planes[0] is not at:
            x, rings = self.crossings.carried(at.turn, at.shift), self.rings_of_pieces
            after = x[np.arange(len(x))[:, None], rings.after]
            side = after - x
            normal = cross(x - x[:, :1], after - x[:, :1]).sum(axis=1)
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
            inward = cross(normal[:, None], side)
            inward /= np.maximum(np.linalg.norm(inward, axis=2, keepdims=True), NONZERO)
            self._planes = at, Planes(x, side, normal, inward)
        return self._planes[1]

    def facing(
        self, at: FoldedGeometry, reach: float, room: float = 0.0
    ) -> list[tuple[ContactPair, float]]:
        """Return features that face each other at a distance of less than `reach`, each once.

        Parameters
        ----------
        at
            A state.
        reach
            Over the sheet's size.
        room
            Share of their size by which they face each other inside.

        Returns
        -------
        list of tuple
            Features whose gap is positive where facets are apart, and that gap over the sheet's size.
        """
        if self._facing is None or self._facing[0] is not at or self._facing[1] < reach:
            # what is closed and what may close is asked for in turn: the wider list has both
            self._facing = at, reach, self._face(at, reach)
        found: dict[object, tuple[ContactPair, float]] = {}
        for touch, gap, inside in self._facing[2]:
            if abs(gap) < reach and inside > room:
                found.setdefault(touch.key, (touch, gap))
        return list(found.values())

    def _face(self, at: FoldedGeometry, reach: float) -> list[tuple[ContactPair, float, float]]:
        """Return features within reach, those of several pieces several times: gap, and how far they are inside."""
        crossings, planes = self.crossings, self.planes(at)
        pairs = crossings.candidates(planes.x, margin=0.5 * reach * crossings.size)
        if not len(pairs):
            return []
        if self._compiled is not None:
            return [*self._faced(planes, pairs, reach)]
        valid, ids = self.rings_of_pieces.valid[pairs], crossings.pieces[pairs]
        same = ids[:, 0, :, None] == ids[:, 1, None]
        same &= valid[:, 0, :, None] & valid[:, 1, None]
        shared = same.sum(axis=(1, 2))
        found: list[tuple[ContactPair, float, float]] = []
        # corners of one piece over the other, both ways; pieces with one corner in common leave that corner out
        for joined in (False, True):
            here = shared == int(joined)
            both = np.vstack([pairs[here], pairs[here, ::-1]])
            common = np.concatenate([same[here], same[here].swapaxes(1, 2)]) if joined else None
            found += self._corners(planes, both[:, 0], both[:, 1], common, reach)
        apart = pairs[shared == 0]
        found += self._sides(planes, apart[:, 0], apart[:, 1], reach)
        return found

    @cached_property
    def _compiled(self) -> FacingInC | None:
        return FacingInC(self.rings_of_pieces) if self.crossings.poses.compiled else None

    @cached_property
    def shared(self) -> tuple[np.ndarray, np.ndarray]:
        """Of any two pieces how many corners they share, and the places of the first as one number, [P, P]."""
        ids, valid = self.crossings.pieces, self.rings_of_pieces.valid
        many, first = np.zeros((2, len(ids), len(ids)), int)
        for k, ring in enumerate(ids):
            same = (ring[:, None] == ids[:, None]) & valid[k][:, None] & valid[:, None]
            same = same.reshape(len(ids), -1)
            many[k], first[k] = same.sum(axis=1), same.argmax(axis=1)
        return many, first

    def _faced(
        self, planes: Planes, pairs: np.ndarray, reach: float
    ) -> Iterator[tuple[ContactPair, float, float]]:
        """Go through what `_corners` and `_sides` find, by compiled functions."""
        rings, crossings, (many, first) = self.rings_of_pieces, self.crossings, self.shared
        ids, facet, size, shared = crossings.pieces, crossings.facet, crossings.size, many[*pairs.T]
        find: Any = self._compiled
        apart, joined = (pairs[shared == k] for k in (0, 1))
        both = np.vstack([apart, apart[:, ::-1], joined, joined[:, ::-1]])
        common = first[*both.T]
        common[: 2 * len(apart)] = -1
        which, place, found = find(planes, both, common, reach, size)
        (a, b), i = both[which].T, place[:, 0]
        corners = np.column_stack([ids[a, i], rings.triangle[b]]).tolist()
        facets = np.column_stack([facet[b], facet[a]]).tolist()
        for pair, four, (sign, *far) in zip(facets, corners, found.tolist(), strict=True):
            yield ContactPair("vertex-face", tuple(pair), tuple(four), sign), *far  # type: ignore[misc]
        which, place, found = find(planes, apart, None, reach, size)
        (a, b), (i, j) = apart[which].T, place.T
        ends = ids[a, i], ids[a, rings.after[a, i]], ids[b, j], ids[b, rings.after[b, j]]
        facets = np.column_stack([facet[a], facet[b]]).tolist()
        corners = np.column_stack(ends).tolist()
        for pair, four, (sign, *far) in zip(facets, corners, found.tolist(), strict=True):
            yield ContactPair("edge-edge", tuple(pair), tuple(four), sign), *far  # type: ignore[misc]

    def _corners(
        self,
        planes: Planes,
        a: np.ndarray,
        b: np.ndarray,
        common: np.ndarray | None,
        reach: float,
    ) -> Iterator[tuple[ContactPair, float, float]]:
        """Go through corners of pieces a over pieces b; `common` are places of the corner they share, [K, q, q]."""
        if not len(a):
            return
        rings, size = self.rings_of_pieces, self.crossings.size
        of, on = planes.x[a], planes.x[b]
        k = np.arange(len(a))[:, None]
        height = np.einsum("kqi,ki->kq", of - on[:, :1], planes.normal[b])
        depth = np.einsum("kqpi,kpi->kqp", of[:, :, None] - on[:, None], planes.inward[b])
        bound = rings.valid[b]
        good = rings.valid[a]
        if common is None:
            depth /= size
            # how much higher the corners before and after are: the closest one to the plane is in the middle
            up = height[k, rings.before[a]] - height, height[k, rings.after[a]] - height
            lean = np.stack(up) / size
        else:
            at_a, at_b = np.divmod(common.reshape(len(a), -1).argmax(axis=1), of.shape[1])
            place = np.arange(of.shape[1])[None]
            first, last = (
                rings.after[a][k[:, 0], at_a][:, None],
                rings.before[a][k[:, 0], at_a][:, None],
            )
            borders = rings.border[a]
            good = good & (
                ((place == first) & borders[k, at_a[:, None]]) | ((place == last) & borders)
            )
            bound = bound & (
                (place == at_b[:, None]) | (place == rings.before[b][k[:, 0], at_b][:, None])
            )
            far = np.linalg.norm(of - of[k, at_a[:, None]], axis=2)
            far = np.where(far > 0, far, 1.0)
            # about a common corner lengths scale: sines of angles take their place
            depth /= far[:, :, None]
            steep = height / far
            opposite = np.where(place == first, steep[k, last], steep[k, first])
            lean = np.stack([opposite - steep] * 2)
        depth = np.where(bound[:, None], depth, np.inf)
        # a cut inside a facet is no border: corners on it are inside, whichever part they are looked up in
        depth += np.where(rings.border[b], 0.0, 2 * INSIDE)[:, None]
        sign, reported = _side(height / size, lean.sum(axis=0))
        inside = depth.min(axis=2)
        good = good & reported & (np.abs(height) < reach * size) & (inside > 0)
        ids, facet = self.crossings.pieces, self.crossings.facet
        for p, i in np.argwhere(good):
            corners = (int(ids[a[p], i]), *map(int, rings.triangle[b[p]]))
            pair = int(facet[b[p]]), int(facet[a[p]])
            touch = ContactPair("vertex-face", pair, corners, float(sign[p, i]))  # type: ignore[arg-type]
            yield touch, float(sign[p, i] * height[p, i] / size), float(inside[p, i])

    def _sides(
        self, planes: Planes, a: np.ndarray, b: np.ndarray, reach: float
    ) -> Iterator[tuple[ContactPair, float, float]]:
        """Go through sides of pieces a and b that share no corner."""
        if not len(a):
            return
        rings, size = self.rings_of_pieces, self.crossings.size
        of, on = planes.x[a], planes.x[b]
        u, v = planes.side[a][:, :, None], planes.side[b][:, None]
        r = on[:, None] - of[:, :, None]
        w = cross(u, v)
        # feet of the common normal of two lines: a + s u and c + t v with s = (r x v) . w / w^2, t = (r x u) . w / w^2
        square = (w * w).sum(axis=3)
        lengths = (u * u).sum(axis=3) * (v * v).sum(axis=3)
        good = (
            square > INSIDE * lengths
        )  # sides at less than a thousandth have no common normal to speak of
        good &= rings.border[a][:, :, None] & rings.border[b][:, None]
        square = np.where(good, square, 1.0)
        shares = np.stack([(cross(r, y) * w).sum(axis=3) for y in (v, u)]) / square
        inside = np.minimum(shares, 1 - shares).min(axis=0)
        good &= inside > 0
        w = w / np.sqrt(square)[..., None]
        gap = (r * w).sum(axis=3) / size
        good &= np.abs(gap) < reach
        # in which direction of the common normal the middle of either piece lies
        heart_a = np.einsum("kpri,kpri->kpr", of.mean(axis=1)[:, None, None] - of[:, :, None], w)
        heart_b = np.einsum("kpri,kpri->kpr", on.mean(axis=1)[:, None, None] - on[:, None], w)
        sign, reported = _side(gap, (heart_b - heart_a) / size)
        good &= reported
        ids, facet = self.crossings.pieces, self.crossings.facet
        for p, i, j in np.argwhere(good):
            corners = (
                int(ids[a[p], i]),
                int(ids[a[p], rings.after[a[p], i]]),
                int(ids[b[p], j]),
                int(ids[b[p], rings.after[b[p], j]]),
            )
            pair = int(facet[a[p]]), int(facet[b[p]])
            yield (
                ContactPair("edge-edge", pair, corners, float(sign[p, i, j])),
                float(sign[p, i, j] * gap[p, i, j]),
                float(inside[p, i, j]),
            )

    def margin(self, touch: ContactPair, at: FoldedGeometry) -> float:
        """Return how far inside each other features are, as a share of their size; below 0 they are not.

        Their gap is the one that keeps facets apart as long as it is positive.  For a corner over a facet it is the way
        to the border, for a side that starts on the facet's own corner the angle to its sides there, for two sides what
        is left of either to its end, or the square of their sine less what `INSIDE` asks for.
        """
        p = touch.points(at)
        if touch.type == "edge-edge":
            u, v, r = p[1] - p[0], p[3] - p[2], p[2] - p[0]
            w = cross(u, v)
            square = float(w @ w)
            if square == 0.0:
                return -INSIDE
            shares = float(cross(r, v) @ w) / square, float(cross(r, u) @ w) / square
            steep = square / float((u @ u) * (v @ v))
            return min(*shares, *(1 - s for s in shares), steep - INSIDE)
        crossings = self.crossings
        face, other = touch.facets
        common = self.rings[face] & self.rings[other]
        best = -np.inf
        for k in np.flatnonzero(crossings.facet == face):
            ring = list(dict.fromkeys(crossings.pieces[k].tolist()))
            x = at.points(np.full(len(ring), face), np.array(ring))
            inward = cross(area_vectors(x), np.roll(x, -1, axis=0) - x)
            inward /= np.linalg.norm(inward, axis=1)[:, None]
            depth, size = np.einsum("qi,qi->q", inward, p[0] - x), crossings.size
            depth += np.where(
                crossings.inner[k, : len(ring)], INSIDE * size, 0.0
            )  # cuts do not count
            apex = [i for i, c in enumerate(ring) if c in common]
            if apex:
                depth = depth[[apex[0], apex[0] - 1]]
                size = float(np.linalg.norm(p[0] - x[apex[0]]))
            best = max(best, float(depth.min()) / size)
        return best


def _side(gap: np.ndarray, lean: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return signs that make gaps positive where facets are apart, and whether they are known; all over the size."""
    # a gap near 0 has the sign of rounding: the rest of the facet, which leans to one side, decides
    body = (np.abs(gap) < INSIDE) & (np.abs(lean) > 10 * INSIDE)
    return np.sign(np.where(body, lean, gap)), body | (np.abs(gap) > OUTSIDE)
