"""Which facets of a folded pattern intersect: sort and sweep, then chords of polygons."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy as shallow
from functools import cached_property

import numpy as np

from origami_nlp.numerics import DEEP, INSIDE, NONZERO, OUTSIDE, coarse, cross, unit_normals
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem.compiled_facets import crossings_among
from origami_nlp.pattern_problem.orbits import Orbits
from origami_nlp.pattern_problem.poses import Poses
from origami_nlp.pattern_problem.screws import MOST_COPIES, find_screws, near_copies

MOST_LISTED = 300
"""Convex pieces up to which each pair is looked at in C: beyond, pairs are found by sorting and sweeping."""


class PatternCrossings:
    """The crossing test of a pattern.

    Parameters
    ----------
    pattern
        The pattern; non-convex pieces are cut into convex ones.  Of a cell that repeats each of its facets is compared
        with the others and with those of its neighbours, each pair once.
    orbits
        Of states that keep a symmetry.

    Attributes
    ----------
    pattern
        The facets that are looked at: of a cell those of its neighbours as well.
    """

    def __init__(self, pattern: Pattern, orbits: Orbits | None = None) -> None:
        self.cell, self.poses = pattern.cell, Poses(pattern, orbits)
        own, pattern = pattern, self.poses.pattern
        self.pattern = pattern
        pieces, inner, polygons = [], [], []
        convex = _convex(pattern.corners, pattern.polygons)
        for k, polygon in enumerate(pattern.polygons):
            whole = [(polygon, (False,) * len(polygon))]
            for part, cuts in whole if convex[k] else convex_parts(pattern.corners, polygon):
                pieces.append(part)
                inner.append(cuts)
                polygons.append(k)
        most = max(map(len, pieces))
        self.polygon = np.array(polygons, int)
        self.facet = pattern.facet_of[self.polygon]
        # padded by repeating the first corner: a side of no length
        self.pieces = np.array([[*p, *[p[0]] * (most - len(p))] for p in pieces], int)
        self.inner = np.array([[*c, *[True] * (most - len(c))] for c in inner], bool)
        self.size = float(np.ptp(own.corners, axis=0).max())

    def moved(self, pattern: Pattern) -> PatternCrossings:
        """Return the test of a pattern of the same facets, measured in another reference state."""
        other = shallow(self)
        for name in ("joined", "hinges", "listed"):
            vars(other).pop(name, None)
        other.pattern, other.poses = pattern, self.poses.moved(pattern)
        other.size = float(np.ptp(pattern.corners, axis=0).max())
        return other

    @cached_property
    def joined(self) -> np.ndarray:
        """Codes of pairs of convex facets that share a crease: their planes meet in its line alone."""
        p = self.pattern
        whole = np.bincount(self.facet, minlength=p.facets) == 1
        # of convex facets only: pieces of others may meet elsewhere on the line of the crease
        low, high = np.minimum(p.left, p.right), np.maximum(p.left, p.right)
        return np.unique((low * p.facets + high)[whole[low] & whole[high]])

    @cached_property
    def hinges(self) -> np.ndarray:
        """Edges at which two pieces hang together: both pieces, the crease or -1, and the places of the edge's ends.

        Places are those of corners on the first piece, which is on the left of the edge, [K, 5].
        """
        pieces = self.pieces.tolist()
        crease = {(int(a), int(b)): c for c, (a, b) in enumerate(self.pattern.ends)}
        at = {
            (a, b): (k, i)
            for k, piece in enumerate(pieces)
            for i, (a, b) in enumerate(zip(piece, piece[1:] + piece[:1], strict=True))
            if a != b
        }
        found = [
            (k, at[b, a][0], crease.get((a, b), -1), i, (i + 1) % len(pieces[k]))
            for (a, b), (k, i) in at.items()
            if a < b and (b, a) in at
        ]
        return np.array(found, int).reshape(-1, 5)

    def candidates(self, corners: np.ndarray, margin: float = 0.0) -> np.ndarray:
        """Return pairs of pieces whose boxes overlap, of different facets that can cross, [K, 2]."""
        a, b = boxes_that_meet(corners.min(axis=1) - margin, corners.max(axis=1) + margin)
        near = (self.facet[a] != self.facet[b]) & self.counts(a, b)
        a, b = a[near], b[near]
        f = np.sort(np.column_stack([self.facet[a], self.facet[b]]), axis=1)
        code = f[:, 0] * self.pattern.facets + f[:, 1]
        keep = ~np.isin(code, self.joined)
        return np.column_stack([a[keep], b[keep]])

    @cached_property
    def listed(self) -> np.ndarray:
        """All pairs of pieces that `candidates` may return, [K, 2]."""
        meet = np.zeros((len(self.pieces), 1, 3))
        return self.candidates(meet)

    @cached_property
    def _own(self) -> tuple[np.ndarray, np.ndarray]:
        """Which corners of pairs of `listed` are not shared or repeated, [2, K, q], and which pairs share one, [K]."""
        one, other = self.pieces[self.listed.T]
        same = one[:, :, None] == other[:, None]
        repeated = np.zeros(self.pieces.shape, bool)
        repeated[:, 1:] = self.pieces[:, 1:] == self.pieces[:, :1]
        a, b = repeated[self.listed.T]
        own = np.stack([~same.any(axis=2) & ~a, ~same.any(axis=1) & ~b])
        return own, same.any(axis=(1, 2))

    def near(self, phi: np.ndarray, reach: float) -> np.ndarray:
        """Return which of `listed` may be nearer to each other than a length, but for corners that they share, of bool.

        Others lie on one side of a plane of two, or meet the line of both planes apart from each other.
        """
        x, (own, shares) = self.placed(phi), self._own
        normal = unit_normals(x)
        a, b = self.listed.T
        steep, touching = [], np.zeros(len(a), bool)
        for (i, j), mine in zip(((a, b), (b, a)), own, strict=True):
            h = np.einsum("kqi,ki->kq", x[i] - x[j][:, :1], normal[j])
            low = np.where(mine, h, np.inf).min(axis=1)
            high = np.where(mine, h, -np.inf).max(axis=1)
            steep.append((low < reach) & (high > -reach))
            touching |= np.where(mine, np.abs(h), np.inf).min(axis=1) < reach
        both = np.flatnonzero(steep[0] & steep[1])
        out = np.zeros(len(a), bool)
        if len(both):
            common = _common_chord(x[a[both]], x[b[both]])
            out[both] = touching[both] | (common > np.where(shares[both], 0.5, -1.0) * reach)
        return out

    def counts(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Return which pairs of pieces are asked for: of pairs that are lattice vectors apart one, of bool [K]."""
        if self.cell is None:
            return np.ones(len(a), bool)
        one, other = (self.cell.copy_of[self.polygon[x]] for x in (a, b))
        return np.asarray(np.minimum(one, other) == self.cell.home)

    def copied_pairs(self, i: int, j: int) -> Iterator[tuple[int, int]]:
        """Go through the copies of a pair of pieces, itself among them."""
        if self.cell is None:
            yield i, j
            return
        copies = self.cell.copies
        own = len(self.pieces) // len(copies)
        (a, p), (b, q) = divmod(i, own), divmod(j, own)
        number = {copy: k for k, copy in enumerate(copies)}
        way = copies[b][0] - copies[a][0], copies[b][1] - copies[a][1]
        for k, copy in enumerate(copies):
            there = number.get((copy[0] + way[0], copy[1] + way[1]))
            if there is not None:
                yield k * own + p, there * own + q

    @property
    def own_pieces(self) -> int:
        """Number of the first piece of a cell itself."""
        return (
            0 if self.cell is None else self.cell.home * len(self.pieces) // len(self.cell.copies)
        )

    def lattice(self, phi: np.ndarray) -> np.ndarray:
        """Return both lattice vectors of a closed state of a cell, in space, [2, 3]."""
        assert self.cell is not None
        turn, shift = self.poses.motions(phi)
        ways = [self.cell.copies.index(way) for way in ((1, 0), (0, 1))]
        of = [
            int(self.pattern.facet_of[k * len(self.cell.polygons)]) for k in (self.cell.home, *ways)
        ]
        x = self.cell.corners[self.cell.polygons[0][0]]
        at = [
            turn[f] @ (x + s) + shift[f] for f, s in zip(of, (0.0, *self.cell.lattice), strict=True)
        ]
        return np.array([at[1] - at[0], at[2] - at[0]])

    def unseen(self, phi: np.ndarray) -> str:
        """Return why facets of a cell might touch copies that are not looked at; "" where none is within reach."""
        far = self._beyond(phi)
        if far is not None and separated(far[1], far[2], self.size * DEEP).all():
            return ""
        return "not decided: facets may reach copies of the cell that are not looked at"

    def _beyond(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Return pieces whose boxes meet those of copies that are not placed; None where these are too many.

        Pairs [K, 2], the first of each as it is placed, and the second in that copy, [K, q, 3].
        """
        assert self.cell is not None
        if self.cell.rolled is not None:
            return self._round_axis(phi)
        a, b = self.lattice(phi)
        normal = np.cross(a, b)
        area = float(np.linalg.norm(normal))
        if area <= INSIDE * self.size**2:
            return None
        along = a / np.linalg.norm(a)
        frame = np.array([along, np.cross(normal / area, along), normal / area])
        x = self.placed(phi)[self.cell.copy_of[self.polygon] == self.cell.home] @ frame.T
        low, high = x.min(axis=1) - self.size * DEEP, x.max(axis=1) + self.size * DEEP
        size = high.max(axis=0) - low.min(axis=0)
        a, b = frame @ a, frame @ b
        most = int(size[1] / b[1]) + 1
        wide = int((size[0] + most * abs(b[0])) / a[0]) + 1
        if most * wide > MOST_COPIES:
            return None
        known, pairs, moves = set(self.cell.copies), [np.zeros((0, 2), int)], [np.zeros((0, 3))]
        for copy in ((i, j) for i in range(-wide, wide + 1) for j in range(most + 1)):
            if copy not in known:
                moved = copy[0] * a + copy[1] * b
                over = (low[:, None] <= high + moved) & (low + moved <= high[:, None])
                pairs.append(np.argwhere(over.all(axis=2)))
                moves.append(np.tile(moved, (len(pairs[-1]), 1)))
        at = np.concatenate(pairs)
        return at, x[at[:, 0]], x[at[:, 1]] + np.concatenate(moves)[:, None]

    def _round_axis(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Do so for copies round a tube; of a sheet that curls freely only those that are placed count."""
        assert self.cell is not None
        own = self.placed(phi)[self.cell.copy_of[self.polygon] == self.cell.home]
        pairs, others = [np.zeros((0, 2), int)], [own[:0]]
        if not self.cell.tube:
            return pairs[0], own[:0], own[:0]
        screws = find_screws(self.poses, phi)
        if screws is None:
            return None
        x, room = screws.seen(own), self.size * DEEP
        low, high = x.min(axis=1) - room, x.max(axis=1) + room
        copies = near_copies(self.cell, screws, float(np.ptp(x[..., 2])) + 2 * room)
        if copies is None:
            return None
        for copy in set(copies) - set(self.cell.copies):
            y = screws.moved(x, copy)
            below, above = y.min(axis=1) - room, y.max(axis=1) + room
            over = (low[:, None] <= above) & (below <= high[:, None])
            pairs.append(np.argwhere(over.all(axis=2)))
            others.append(y[pairs[-1][:, 1]])
        at = np.concatenate(pairs)
        return at, x[at[:, 0]], np.concatenate(others)

    def placed(self, phi: np.ndarray) -> np.ndarray:
        """Return the corners of the convex pieces in space, [P, q, 3]."""
        return self.carried(*self.poses.motions(phi))

    def carried(self, turn: np.ndarray, shift: np.ndarray) -> np.ndarray:
        """Return the corners of the convex pieces where motions [F, 3, 3], [F, 3] carry them, [P, q, 3]."""
        reference = self.pattern.corners[self.pieces]
        return np.einsum("pij,pqj->pqi", turn[self.facet], reference) + shift[self.facet][:, None]

    def find(self, phi: np.ndarray) -> list[tuple[int, int]]:
        """Find the pairs of facets that cross at a closed state.

        Parameters
        ----------
        phi
            Fold angles, shape [n] [rad].

        Returns
        -------
        list of tuple
            Pairs of facets, sorted; facets that merely touch, or lie on each other, are not among them.
        """
        pairs, _ = self._crossing(phi)
        if self.cell and (far := self._beyond(phi)) is not None and len(far[0]):
            hit = cross_each_other(far[1], far[2], DEEP * self.size)
            # such copies have no number: the facets of the cell stand for them
            pairs = np.vstack([pairs, far[0][hit] + self.own_pieces])
        low, high = np.sort(self.facet[pairs], axis=1).T
        codes = np.unique(low * self.pattern.facets + high)
        return [divmod(code, self.pattern.facets) for code in codes.tolist()]

    def _crossing(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the pairs of pieces that cross, [K, 2], and all pieces in space."""
        x, deep = self.placed(phi), DEEP * self.size
        if len(x) <= MOST_LISTED:
            found = crossings_among(x[None], self.listed[:, 0], self.listed[:, 1], deep)
            if found is not None:
                return self.listed[found[0]], x
        pairs = self.candidates(x)
        hit = np.zeros(len(pairs), bool)
        for start in range(0, len(pairs), 20_000):
            a, b = pairs[start : start + 20_000].T
            hit[start : start + 20_000] = cross_each_other(x[a], x[b], deep)
        return pairs[hit], x

    def measure(self, phi: np.ndarray) -> list[tuple[int, int, float, np.ndarray]]:
        """Measure how deep polygons that cross at a closed state reach into each other, and where.

        Parameters
        ----------
        phi
            Fold angles, shape [n] [rad].

        Returns
        -------
        list of tuple
            Two polygons, the depth (what each reaches through the plane of the other, and the length of the line in
            which they intersect, the least of the three) and the middle of that line [3]; of several pieces the
            deepest.
        """
        pairs, x = self._crossing(phi)
        if not len(pairs):
            return []
        a, b = pairs.T
        depth, middle = intersect(x[a], x[b])
        found: dict[tuple[int, int], tuple[float, np.ndarray]] = {}
        for (p, q), deep, at in zip(
            self.polygon[pairs].tolist(), depth.tolist(), middle, strict=True
        ):
            both = (min(p, q), max(p, q))
            if both not in found or found[both][0] < deep:
                found[both] = deep, at
        return [(*both, *what) for both, what in sorted(found.items())]


def boxes_that_meet(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs of boxes [K, 3] that have a point in common, by sorting and sweeping.

    Pairs are ordered as boxes begin along the widest axis, and those that begin level by their numbers: what is named
    after the first pair that is found must not follow what rounding makes of level ones.
    """
    # the widest axis first
    axis, *others = np.argsort(-coarse(np.ptp(low, axis=0)), kind="stable").tolist()
    order = np.argsort(low[:, axis], kind="stable")
    # along the axis on which boxes are spread most, each box meets those that begin before it ends
    ends = np.searchsorted(low[order, axis], high[order, axis], side="right")
    many = ends - np.arange(len(order)) - 1
    i = np.repeat(np.arange(len(order)), many)
    j = np.arange(len(i)) - np.repeat(np.cumsum(many) - many, many) + i + 1
    a, b = order[i], order[j]
    for k in others:  # of those that meet on the axes before
        near = (low[a, k] <= high[b, k]) & (low[b, k] <= high[a, k])
        a, b = a[near], b[near]
    rank = np.argsort(np.argsort(coarse(low[:, axis]), kind="stable"))
    i, j = np.minimum(rank[a], rank[b]), np.maximum(rank[a], rank[b])
    swapped, order = rank[a] > rank[b], np.lexsort((j, i))
    return np.where(swapped, b, a)[order], np.where(swapped, a, b)[order]


def cross_each_other(a: np.ndarray, b: np.ndarray, deep: float) -> np.ndarray:
    """Return whether convex polygons pass through each other by more than `deep`.

    Each must reach through the plane of the other, and their chords on the line of both planes must overlap: so that
    polygons which share a corner, or whose sides meet, are treated as others are.

    Parameters
    ----------
    a, b
        Corners, [K, q, 3], padded by repeating the first.
    deep
        Length.

    Returns
    -------
    numpy.ndarray
        Of bool, [K].
    """
    return np.asarray(_intersected(a, b)[0] > deep)


def separated(a: np.ndarray, b: np.ndarray, room: float) -> np.ndarray:
    """Return whether a plane between two convex polygons has more than `room` on its way from one to the other.

    If any has, one has that is parallel to a polygon, to a side of each, or to a side and across its polygon.

    Parameters
    ----------
    a, b
        Corners, [K, q, 3], padded by repeating the first.
    room
        Length.

    Returns
    -------
    numpy.ndarray
        Of bool, [K].
    """
    normals = [unit_normals(x)[:, None] for x in (a, b)]
    sides = [np.roll(x, -1, axis=1) - x for x in (a, b)]
    pairs = cross(sides[0][:, :, None], sides[1][:, None])
    both = pairs.reshape(len(a), a.shape[1] * b.shape[1], 3)
    axes = [*normals, both, *(cross(n, e) for n, e in zip(normals, sides, strict=True))]
    axis = np.concatenate(axes, axis=1)
    axis /= np.maximum(np.linalg.norm(axis, axis=2, keepdims=True), NONZERO)
    seen, other = (np.einsum("kmi,kqi->kmq", axis, x) for x in (a, b))
    gap = np.maximum(seen.min(axis=2) - other.max(axis=2), other.min(axis=2) - seen.max(axis=2))
    return np.asarray((gap > room).any(axis=1))


def intersect(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Measure how deep convex polygons that cross reach into each other, and where.

    Parameters
    ----------
    a, b
        Corners, [K, q, 3], padded by repeating the first.

    Returns
    -------
    numpy.ndarray
        How far each reaches through the other's plane, and the length that their chords have in common: the least of
        the three, [K].
    numpy.ndarray
        The middle of what the chords have in common, [K, 3].
    """
    depth, along, line, normal_a, normal_b = _intersected(a, b)
    # from the first corner of b, in whose plane it is: along the line, and across it to the plane of a
    across = cross(line, normal_b)
    off = np.einsum("ki,ki->k", a[:, 0] - b[:, 0], normal_a)
    off /= np.einsum("ki,ki->k", across, normal_a)
    return depth, b[:, 0] + along[:, None] * line + off[:, None] * across


def _intersected(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return depths, middles of common chords from b's first corner, directions of the lines, and both normals."""
    normal_a, normal_b = unit_normals(a), unit_normals(b)
    line = cross(normal_a, normal_b)
    line /= np.maximum(np.linalg.norm(line, axis=1, keepdims=True), NONZERO)
    reach_a, low_a, high_a = _chord(a, normal_b, b[:, :1], line)
    reach_b, low_b, high_b = _chord(b, normal_a, a[:, :1], line)
    # chords are measured from different corners: the one of b from a's, and the other way round
    shift = np.einsum("ki,ki->k", a[:, 0] - b[:, 0], line)
    low, high = np.maximum(low_a, low_b + shift), np.minimum(high_a, high_b + shift)
    depth = np.minimum(np.minimum(reach_a, reach_b), high - low)
    meets = depth > 0
    along = 0.5 * np.add(low, high, out=np.zeros_like(low), where=meets)
    return depth, along, line, normal_a, normal_b


def _common_chord(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return how long the piece of the line of both planes is that polygons have in common, [K]; negative: a gap."""
    normal_a, normal_b = unit_normals(a), unit_normals(b)
    line = cross(normal_a, normal_b)
    line /= np.maximum(np.linalg.norm(line, axis=1, keepdims=True), NONZERO)
    _, low_a, high_a = _chord(a, normal_b, b[:, :1], line)
    _, low_b, high_b = _chord(b, normal_a, a[:, :1], line)
    shift = np.einsum("ki,ki->k", a[:, 0] - b[:, 0], line)
    return np.asarray(np.minimum(high_a, high_b + shift) - np.maximum(low_a, low_b + shift))


def _chord(
    x: np.ndarray, normal: np.ndarray, origin: np.ndarray, line: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cut polygons by planes: how far they reach through, and from where to where along a line."""
    h = np.einsum("kqi,ki->kq", x - origin, normal)
    reach = np.minimum(h.max(axis=1), -h.min(axis=1))
    h2 = np.roll(h, -1, axis=1)
    # half open: a corner in the plane counts for one of its sides, so that a convex polygon has two cuts or none
    cut = ((h > 0) & (h2 <= 0)) | ((h <= 0) & (h2 > 0))
    with np.errstate(invalid="ignore", divide="ignore"):
        s = np.where(cut, h / (h - h2), 0.0)
    t = np.einsum("kqi,ki->kq", x - origin, line)
    t = t + s * (np.roll(t, -1, axis=1) - t)
    return reach, np.where(cut, t, np.inf).min(axis=1), np.where(cut, t, -np.inf).max(axis=1)


def _convex(corners: np.ndarray, polygons: Sequence[tuple[int, ...]]) -> np.ndarray:
    """Return which plane polygons are convex, those with equally many corners at once; of bool, [P]."""
    out = np.zeros(len(polygons), bool)
    many = np.array([len(polygon) for polygon in polygons], int)
    for q in np.unique(many):
        same = np.flatnonzero(many == q)
        x = corners[np.array([polygons[k] for k in same.tolist()], int)]
        sides = np.roll(x, -1, axis=1) - x
        # turns of a plane polygon, along its normal: twice areas
        turns = np.einsum("kqi,ki->kq", cross(np.roll(sides, 1, axis=1), sides), unit_normals(x))
        out[same] = (turns >= -_tiny(x)[:, None]).all(axis=1)
    return out


def _tiny(x: np.ndarray) -> np.ndarray:
    """Return by how much a polygon [..., q, 3] may turn the other way and count as convex: twice an area, [...]."""
    return np.asarray(OUTSIDE * np.ptp(x, axis=-2).max(axis=-1) ** 2)


def convex_parts(
    corners: np.ndarray, polygon: tuple[int, ...]
) -> list[tuple[tuple[int, ...], tuple[bool, ...]]]:
    """Cut a plane polygon that is not convex into triangles, by its ears.

    Each comes as its corners, and which of its sides are cuts.
    """
    x = corners[list(polygon)]
    normal = unit_normals(x)
    u = x[1] - x[0]
    u /= np.linalg.norm(u)
    flat = np.column_stack([(x - x[0]) @ u, (x - x[0]) @ cross(normal, u)])

    def turn(a: int, b: int, c: int) -> float:
        p, q = flat[b] - flat[a], flat[c] - flat[b]
        return float(p[0] * q[1] - p[1] * q[0])

    ring = list(range(len(polygon)))
    tiny = float(_tiny(flat))
    sides = {(i, (i + 1) % len(polygon)) for i in range(len(polygon))}
    parts: list[tuple[int, ...]] = []
    while len(ring) > 3:
        for i in range(len(ring)):
            a, b, c = ring[i - 1], ring[i], ring[(i + 1) % len(ring)]
            if turn(a, b, c) <= tiny:
                continue
            # an ear: a corner that turns to the left, with no other corner in its triangle
            others = [p for p in ring if p not in (a, b, c)]
            if not any(
                turn(a, b, p) >= 0 and turn(b, c, p) >= 0 and turn(c, a, p) >= 0 for p in others
            ):
                break
        else:
            # no ear but for rounding (corners on one line): the corner that turns most
            i = max(
                range(len(ring)),
                key=lambda i: turn(ring[i - 1], ring[i], ring[(i + 1) % len(ring)]),
            )
            a, b, c = ring[i - 1], ring[i], ring[(i + 1) % len(ring)]
        parts.append((a, b, c))
        ring.remove(b)
    parts.append(tuple(ring))
    return [
        (
            tuple(polygon[k] for k in part),
            tuple((part[k], part[(k + 1) % len(part)]) not in sides for k in range(len(part))),
        )
        for part in parts
    ]
