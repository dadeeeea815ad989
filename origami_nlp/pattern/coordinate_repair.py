"""Corners of a file moved, within the digits that it states, so that its sheet is what was drawn.

Patterns that fold at all often do so by relations between their sector angles: a Miura sheet is rigid unless these are
exact.  Coordinates with few digits miss them, and what a search finds is then a matter of rounding.  Faces of a folded
form that are not quite plane are worse: whether facets that meet touch or cross depends on the corner that one measures
from.

What holds within the digits is made to hold: plane faces; sectors that are equal, or supplementary; creases in a line;
alternate sectors with the sum pi (Kawasaki); sides of equal length, so that layers end where they did.  Corners move as
little as that takes.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy as sp

from origami_nlp.numerics import EPS, RESOLVED, SUMMED, cross, unit_normals
from origami_nlp.pattern.polygons import Side, rings, side

ROUNDS = 8
"""Of Newton."""
COARSE = 1e-3
"""Angles [rad] below which a file must state its sectors, or nothing can be said of what was drawn."""
SNAPPED = 0.1
"""As much where a person says how far corners may be off."""
SHARES = 0.5, 0.125, 0.03, 0.008, 0.0
"""Of that distance, within which relations are looked for; flat folds of vertices within all of it."""
DRAWN = 0.02
"""What alternate angles round a vertex of a drawing that is meant to fold flat miss, at most [rad]."""
SOFT = 1e-10
"""Rows that depend on others are weighed with this, so that they need not be known beforehand."""
SHORTENS = 0.1
"""Share of the shortest side by which corners may move: one that moves more is drawn anew, not made exact."""
MOST_ROUND = 12
"""Sectors of a vertex up to which creases in a line are looked for."""
MOST_POLYGONS = 2_000
"""Up to which relations are looked for: some seconds."""


@dataclass(frozen=True, eq=False)
class Exact:
    """What was made of a file's corners.

    Attributes
    ----------
    corners
        Points, [V, 3]; those that were given where nothing is to be done.
    moved
        How far the one that moved most did, 0 for none.
    relations
        Number of relations between sectors that missed by more than rounding and hold now.
    misses
        By how much vertices still miss folding flat [rad], of those that do by what a drawing does; else 0.
    """

    corners: np.ndarray
    moved: float
    relations: int
    misses: float


def made_exact(
    corners: np.ndarray,
    polygons: Sequence[Sequence[int]],
    joins: Sequence[Side] = (),
    unit: float = 0.0,
    snap: float = 0.0,
) -> Exact:
    """Move corners as little as makes faces plane and relations between sectors hold.

    Parameters
    ----------
    corners
        Points, [V, 3].
    polygons
        Corners of each, of one sense.
    joins
        Sides that are no creases.
    unit
        Last decimal place of the corners; 0 for whole doubles.
    snap
        How far a person lets corners move; 0: within the digits alone.

    Returns
    -------
    Exact
        With planes only where relations ask for more than the digits allow.

    Examples
    --------
    >>> import numpy as np
    >>> square = np.array([[0, 0, 1e-6], [1, 0, 0], [1, 1, 1e-6], [0, 1, 0]])
    >>> made = made_exact(square, [(0, 1, 2, 3)], unit=1e-6)
    >>> float(np.ptp(made.corners[:, 2])) < 1e-15, round(made.moved, 12)
    (True, 5e-07)
    """
    origin = corners.mean(axis=0)
    size = float(np.abs(corners - origin).max())
    x = (corners - origin) / size
    at = _Sectors(polygons, joins)
    if not (shortest := size * float(at.lengths(x).min())):
        return Exact(corners, 0.0, 0, 0.0)
    for asked in at.choices(x, unit / size, snap / size):
        wanted = np.abs(asked.missing(at.measures(x)))
        if max(wanted.max(initial=0.0), np.abs(_heights(x, at)[0]).max(initial=0.0)) <= at.rounding(
            x
        ):
            break
        if (found := _solved(x, at, asked)) is None:
            continue
        moved = size * float(np.linalg.norm(found - x, axis=1).max())
        # sides that moves change the length of by more than a share of it are not what was drawn
        if moved <= min(size * asked.most, SHORTENS * shortest):
            many = int((wanted > at.rounding(x)).sum())
            return Exact(origin + size * found, moved, many, at.misses(found))
    return Exact(corners, 0.0, 0, at.misses(x))


class _Sectors:
    """Corners and sides of polygons, and how corners follow each other round interior vertices."""

    def __init__(self, polygons: Sequence[Sequence[int]], joins: Sequence[Side]) -> None:
        self.wide = [np.array(p) for p in polygons if len(p) > 3]
        flat = [
            (p[i - 1], v, p[(i + 1) % len(p)], k)
            for k, p in enumerate(polygons)
            for i, v in enumerate(p)
        ]
        self.before, self.here, self.after, self.polygon = np.array(flat).T
        self.many = len(polygons)
        by_length: dict[int, list[int]] = {}
        for k, p in enumerate(polygons):
            by_length.setdefault(len(p), []).append(k)
        # polygons with as many corners at once: which, and the corners of each
        self.alike = [(ks, np.array([polygons[k] for k in ks])) for ks in by_length.values()]
        starts = {(v, w): i for i, (_, v, w, _) in enumerate(flat)}
        joined = {side(*s) for s in joins}
        self.inside = np.zeros(len(flat), bool)
        sides = np.unique(np.sort(np.column_stack([self.here, self.after]), axis=1), axis=0)
        self.start, self.end = sides.T
        # of each interior vertex, its sectors, the corners of each
        self.rings: list[list[list[int]]] = []
        for leaving in rings(polygons):
            creases = [j for j, s in enumerate(leaving) if side(*s) not in joined]
            ring = [starts[s] for s in leaving]
            if creases:
                around = [c - creases[0] for c in [*creases, creases[0] + len(ring)]]
                ring = ring[creases[0] :] + ring[: creases[0]]
                self.rings.append([ring[a:b] for a, b in itertools.pairwise(around)])
                self.inside[ring] = True

    def lengths(self, x: np.ndarray) -> np.ndarray:
        """Return the length of each side, [S]."""
        found: np.ndarray = np.linalg.norm(x[self.end] - x[self.start], axis=1)
        return found

    def rounding(self, x: np.ndarray) -> float:
        """Return what sums of measures miss by rounding: corners are known to `EPS`, angles to that over a side."""
        return SUMMED + 16 * EPS / float(self.lengths(x).min())

    def frames(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return both sides at each corner and the normal of its polygon, [C, 3] each."""
        normals = np.empty((self.many, 3))
        for which, corners in self.alike:
            normals[which] = unit_normals(x[corners])
        return x[self.before] - x[self.here], x[self.after] - x[self.here], normals[self.polygon]

    def measures(self, x: np.ndarray) -> np.ndarray:
        """Return the inner angle at each corner [rad], then the length of each side, [C + S]."""
        u, v, n = self.frames(x)
        angle = np.arctan2((n * cross(v, u)).sum(axis=1), (u * v).sum(axis=1))
        return np.concatenate([np.where(angle < 0, angle + 2 * math.pi, angle), self.lengths(x)])

    def misses(self, x: np.ndarray) -> float:
        """Return the largest miss of Kawasaki's condition that is one of a drawing [rad]; 0 for rounding."""
        angles = self.measures(x)
        even = [ring[::2] for ring in self.rings if len(ring) % 2 == 0]
        off = [abs(sum(angles[c] for s in half for c in s) - math.pi) for half in even]
        return 2 * max((o for o in off if self.rounding(x) < 2 * o <= DRAWN), default=0.0)

    def slopes(self, x: np.ndarray) -> sp.sparse.csr_array:
        """Return the derivatives of the measures, [C + S, 3 V]."""
        u, v, n = self.frames(x)
        # a side that moves by m across itself turns by m over its length
        du = cross(n, u) / (u**2).sum(axis=1, keepdims=True)
        dv = -cross(n, v) / (v**2).sum(axis=1, keepdims=True)
        along = x[self.end] - x[self.start]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        places = np.concatenate([self.before, self.after, self.here, self.start, self.end])
        values = np.concatenate([du, dv, -du - dv, -along, along])
        angles, sides = np.arange(len(u)), len(u) + np.arange(len(along))
        rows = np.repeat(np.concatenate([angles, angles, angles, sides, sides]), 3)
        columns = (3 * places[:, None] + np.arange(3)).ravel()
        shape = len(angles) + len(sides), x.size
        return sp.sparse.csr_array((values.ravel(), (rows, columns)), shape=shape)

    def choices(self, x: np.ndarray, unit: float, snap: float) -> Iterator[_Relations]:
        """Go through what may be asked for, the most first; at last nothing but plane faces."""
        if self.rings and self.many <= MOST_POLYGONS:
            for share in SHARES if snap else ():
                blur = self.blur(x, share * snap)
                if self._widest(blur) <= SNAPPED:
                    yield self.relations(x, blur, self.blur(x, 0.5 * snap), snap)
            blur = self.blur(x, unit)
            by_digits = RESOLVED < self._widest(blur) <= COARSE
            blur = blur if by_digits else self.blur(x, 0.0)
            yield self.relations(x, blur, blur, 2 * unit if by_digits else RESOLVED)
        yield _Relations(self.measures(x), np.zeros(0), math.inf)

    def _widest(self, blur: np.ndarray) -> float:
        return float(blur[: len(self.inside)][self.inside].max())

    def blur(self, x: np.ndarray, unit: float) -> np.ndarray:
        """Return what a last place leaves open of each measure, [C + S]."""
        u, v, _ = self.frames(x)
        # both ends of a side off by a last place turn it by twice that over its length
        with np.errstate(divide="ignore", invalid="ignore"):  # corners in one place: nothing stated
            angles = 2 * unit * (1 / np.linalg.norm(u, axis=1) + 1 / np.linalg.norm(v, axis=1))
        return np.fmax(np.concatenate([angles, np.full(len(self.start), 2 * unit)]), RESOLVED)

    def relations(
        self, x: np.ndarray, blur: np.ndarray, of_folds: np.ndarray, most: float
    ) -> _Relations:
        """Find what holds within a blur of each measure, and within another one where that folds a vertex flat."""
        found = _Relations(self.measures(x), blur, most)
        for ring in self.rings:
            d = len(ring)
            # paper that lies flat; Kawasaki's theorem; two creases in one line
            found.hold(ring, 2 * math.pi)
            if d % 2 == 0:
                found.hold(ring[::2], math.pi, of_folds)
                found.hold(ring[1::2], math.pi, of_folds)
            for first in range(d) if d <= MOST_ROUND else ():
                for many in range(2, d - 1):
                    found.hold([ring[(first + j) % d] for j in range(many)], math.pi)
        sectors = [sector for ring in self.rings for sector in ring]
        rim = [[int(c)] for c in np.flatnonzero(~self.inside)]
        found.group([*sectors, *rim], math.pi / 2)
        corners = len(self.here)
        found.group([[corners + k] for k in range(len(self.start))], 0.0)
        return found


class _Relations:
    """Sums of measures and what they come to, of those that hold within the `blur` of each measure.

    Corners may move by `most` for them.
    """

    def __init__(self, values: np.ndarray, blur: np.ndarray, most: float) -> None:
        self.values, self.blur, self.most = values, blur, most
        self.terms: list[tuple[int, int, float]] = []
        self.totals: list[float] = []

    def _ask(self, sectors: Sequence[tuple[float, Sequence[int]]], total: float) -> None:
        self.terms += [(len(self.totals), c, sign) for sign, sector in sectors for c in sector]
        self.totals.append(total)

    def hold(
        self, sectors: Sequence[Sequence[int]], total: float, blur: np.ndarray | None = None
    ) -> None:
        """Ask for a sum of sectors, each a sum of measures, if that is so within the blur."""
        row = [c for sector in sectors for c in sector]
        if abs(self.values[row].sum() - total) <= (self.blur if blur is None else blur)[row].sum():
            self._ask([(1.0, row)], total)

    def group(self, sectors: Sequence[Sequence[int]], middle: float) -> None:
        """Ask that sectors be equal that are as far from `middle`, on either side, within the digits."""
        first = np.cumsum([0, *(len(s) for s in sectors[:-1])])
        row = [c for s in sectors for c in s]
        off = np.add.reduceat(self.values[row], first) - middle
        noise = np.add.reduceat(self.blur[row], first)
        order = np.argsort(np.abs(off), kind="stable")
        # cut where neighbours are farther apart than the digits of both
        step = np.diff(np.abs(off)[order]) > noise[order][1:] + noise[order][:-1]
        for one, *others in np.split(order, np.flatnonzero(step) + 1):
            if (np.abs(off[[one, *others]]) <= noise[[one, *others]]).any():
                for s in (one, *others):
                    self.hold([sectors[s]], middle)
                continue
            for s in others:
                sign = math.copysign(1.0, off[s] * off[one])
                self._ask([(1.0, sectors[s]), (-sign, sectors[one])], (1.0 - sign) * middle)

    @cached_property
    def rows(self) -> sp.sparse.csr_array:
        """Rows of measures, [R, C + S]."""
        row, column, value = zip(*self.terms, strict=True) if self.terms else ((),) * 3
        shape = len(self.totals), len(self.values)
        return sp.sparse.csr_array((np.array(value), (row, column)), shape=shape)

    def missing(self, measures: np.ndarray) -> np.ndarray:
        """Return by how much rows miss, [R]."""
        return np.asarray(self.rows @ measures - self.totals)


def _heights(x: np.ndarray, at: _Sectors) -> tuple[np.ndarray, sp.sparse.csr_array]:
    """Return how far faces are from plane, [q - 3] heights of each, and the derivatives of these."""
    heights, entries = [np.zeros(0)], [(np.zeros(0, int), np.zeros(0, int), np.zeros(0))]
    row = 0
    for p in at.wide if x[:, 2].any() else ():
        y = x[p] - x[p].mean(axis=0)
        vt = np.linalg.svd(y, full_matrices=False)[2]
        # less what turning or lifting the plane takes away
        plane = np.column_stack([np.ones(len(p)), y @ vt[0], y @ vt[1]])
        free = np.linalg.qr(plane, mode="complete")[0][:, 3:].T
        heights.append(free @ (y @ vt[2]))
        rows = np.repeat(row + np.arange(len(free)), 3 * len(p))
        columns = np.tile((3 * p[:, None] + np.arange(3)).ravel(), len(free))
        entries.append((rows, columns, (free[:, :, None] * vt[2]).ravel()))
        row += len(free)
    rows, columns, values = (np.concatenate(e) for e in zip(*entries, strict=True))
    slopes = sp.sparse.csr_array((values, (rows, columns)), shape=(row, x.size))
    return np.concatenate(heights), slopes


def _solved(x: np.ndarray, at: _Sectors, asked: _Relations) -> np.ndarray | None:
    """Return the nearest points at which planes and relations hold; None where Newton finds none."""
    for _ in range(ROUNDS):
        heights, slopes = _heights(x, at)
        value = np.append(heights, asked.missing(at.measures(x)))
        if np.abs(value).max(initial=0.0) <= at.rounding(x):
            return x
        rows = sp.sparse.vstack([slopes, asked.rows @ at.slopes(x)])
        soft = sp.sparse.eye_array(len(value)) * SOFT
        # KKT system of the shortest step (Nocedal and Wright, section 16.1); -soft where rows depend on each other
        system = sp.sparse.block_array([[sp.sparse.eye_array(x.size), rows.T], [rows, -soft]])
        step = sp.sparse.linalg.splu(system.tocsc()).solve(np.append(np.zeros(x.size), -value))
        x = x + step[: x.size].reshape(-1, 3)
    return None
