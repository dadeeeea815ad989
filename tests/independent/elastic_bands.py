"""Passes between states of a sheet by strings of images, relaxed and then refined: heights of explicit paths.

Closure is that of `search_sheets`; whether facets cross is asked of their sides.  A string is led from one state to
another: straight, past the flat state, or past a state drawn; its images slide down along the closed states and are
spread evenly again.  Then it is halved until neighbours are near, and led through states with a corner flat where that
corner changes the sign of its folds.  Only such paths count as end to end closed, within fold limits and without
crossing facets; their height is an upper bound of the barrier.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tests.independent.search_sheets import SMALL, Sheet

NEAR = 0.06
"""Distance [rad] of neighbours on a path."""
DEEP = 1e-9
"""Volumes below which a side touches a facet and does not cross it, for sheets of facets of about 1."""


@dataclass(frozen=True)
class Springs:
    """Linear springs: stiffness and rest angle of each crease, [n]."""

    stiffness: np.ndarray
    rest: np.ndarray

    def energy(self, x: np.ndarray) -> np.ndarray:
        return 0.5 * ((x - self.rest) ** 2) @ self.stiffness

    def torque(self, x: np.ndarray) -> np.ndarray:
        return self.stiffness * (x - self.rest)


class Facets:
    """Polygons of a flat sheet in space, and whether any cross: sides of one through triangles of another.

    corners [P, 3]; polygons: corners of each, convex; creases: pairs of corners, in the order of the fold angles.
    """

    def __init__(self, corners: np.ndarray, polygons: list[list[int]], ends: list[list[int]]):
        self.corners, self.polygons = corners, polygons
        crease = {frozenset(e): k for k, e in enumerate(ends)}
        left: dict[tuple[int, int], int] = {}
        for f, ring in enumerate(polygons):
            for pair in zip(ring, ring[1:] + ring[:1], strict=True):
                left[pair] = f
        self.walk: list[tuple[int, int, int, int, int]] = []  # from, to, crease, axis from a to b
        seen, open_, joined = {0}, [0], set[frozenset[int]]()
        for (a, b), f in left.items():
            if (b, a) in left:
                joined.add(frozenset((f, left[b, a])))
        while open_:
            f = open_.pop(0)
            for a, b in zip(polygons[f], polygons[f][1:] + polygons[f][:1], strict=True):
                g = left.get((b, a))
                if g is not None and g not in seen:
                    seen.add(g)
                    open_.append(g)
                    self.walk.append((f, g, crease[frozenset((a, b))], a, b))
        first = np.cumsum([0, *map(len, polygons)])
        sides, triangles, of_side, of_triangle = [], [], [], []
        for f, ring in enumerate(polygons):
            m = len(ring)
            sides += [(first[f] + k, first[f] + (k + 1) % m) for k in range(m)]
            triangles += [(first[f], first[f] + k, first[f] + k + 1) for k in range(1, m - 1)]
            of_side += [f] * m
            of_triangle += [f] * (m - 2)
        # medians as well: of two facets that mirror each other only borders may meet
        many, middles = int(first[-1]), list[tuple[int, int]]()
        for (a, b, c), f in zip(triangles, of_triangle, strict=True):
            for u, v, w in ((a, b, c), (b, c, a), (c, a, b)):
                sides.append((u, many + len(middles)))
                middles.append((v, w))
                of_side.append(f)
        self.middles = np.array(middles).T
        asked = [
            (*s, *t)
            for s, f in zip(sides, of_side, strict=True)
            for t, g in zip(triangles, of_triangle, strict=True)
            if f != g and frozenset((f, g)) not in joined
        ]
        self.asked = np.array(asked, int).reshape(-1, 5).T

    def placed(self, x: np.ndarray) -> np.ndarray:
        """Corners of every polygon in states [K, n], one polygon after the other, [K, corners, 3]."""
        turns = {0: Rotation.identity(len(x))}
        shifts = {0: np.zeros((len(x), 3))}
        for f, g, k, a, b in self.walk:
            at, axis = self.corners[a], self.corners[b] - self.corners[a]
            fold = Rotation.from_rotvec(x[:, [k]] * axis / np.linalg.norm(axis))
            turns[g] = turns[f] * fold
            shifts[g] = turns[f].apply(at - fold.apply(at)) + shifts[f]
        points = [
            turns[f].apply(self.corners[v]) + shifts[f]
            for f, ring in enumerate(self.polygons)
            for v in ring
        ]
        return np.stack(points, axis=1)

    def crossed(self, x: np.ndarray) -> NDArray[np.bool_]:
        """Whether a side passes through a facet that shares no crease with its own, [K]."""
        at = self.placed(x)
        at = np.concatenate([at, 0.5 * (at[:, self.middles[0]] + at[:, self.middles[1]])], axis=1)
        p, q, a, b, c = (at[:, of] for of in self.asked)

        def volume(u: np.ndarray, v: np.ndarray, w: np.ndarray) -> np.ndarray:
            return np.einsum("kmi,kmi->km", np.cross(u, v), w)

        ends = [volume(b - a, c - a, y - a) for y in (p, q)]
        round_ = [volume(u - p, v - p, q - p) for u, v in ((a, b), (b, c), (c, a))]
        hit = (ends[0] * ends[1] < 0) & (np.abs(ends).min(axis=0) > DEEP)
        low, high = np.min(round_, axis=0), np.max(round_, axis=0)
        return np.asarray((hit & ((low > DEEP) | (high < -DEEP))).any(axis=1))


def admissible(facets: Facets, x: np.ndarray) -> NDArray[np.bool_]:
    """Which closed states [K, n] are within fold limits and do not cross."""
    return np.asarray((np.abs(x) <= math.pi + 1e-9).all(axis=1) & ~facets.crossed(x))


def spread(path: np.ndarray, many: int) -> np.ndarray:
    """The same polygon with `many` images at equal distances."""
    length = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))]
    at = np.linspace(0.0, length[-1], many)
    return np.stack([np.interp(at, length, path[:, j]) for j in range(path.shape[1])], axis=1)


def deflated(sheet: Sheet, x: np.ndarray, steps: int = 24) -> np.ndarray:
    """From a state towards the flat one, each step closed from the one before, [steps, n]."""
    out = [x]
    for k in range(steps, 1, -1):
        y, good = sheet.closed(out[-1][None] * (1 - 1 / k), 30)
        if not good[0] or np.abs(y[0] - out[-1]).max() > 0.6:
            break
        out.append(y[0])
    return np.array([*out, np.zeros_like(x)])


def string(
    sheet: Sheet,
    facets: Facets,
    springs: Springs,
    first: np.ndarray,
    rounds: int = 60,
    images: int = 30,
) -> np.ndarray:
    """Relax a polygon of states whose ends stay: images slide down and are spread evenly, by turns."""
    path = spread(first, images)
    path[1:-1] = sheet.closed(path[1:-1], 20)[0]
    fine = admissible(facets, path)
    stiff = float(springs.stiffness.max())
    for _ in range(rounds):
        inner = path[1:-1]
        way = -sheet.down(inner, springs.torque(inner)) / stiff
        size = np.abs(way).max(axis=1, keepdims=True)
        way *= np.minimum(0.3, 0.05 / np.maximum(size, 1e-12))
        for want in (inner + way, None):
            if want is None:
                want = spread(path, images)[1:-1]
            moved, good = sheet.closed(want, 8)
            good &= np.abs(moved - path[1:-1]).max(axis=1) < 0.4
            now = admissible(facets, moved)
            good &= now | ~fine[1:-1]
            path[1:-1] = np.where(good[:, None], moved, path[1:-1])
            fine[1:-1] = np.where(good, now, fine[1:-1])
    return path


def flattened(sheet: Sheet, x: np.ndarray, rings: NDArray[np.bool_]) -> np.ndarray | None:
    """The closed state near x [n] in which some corners are exactly flat, [n]."""
    held = np.zeros(sheet.n, bool)
    for one in np.flatnonzero(rings):
        held[sheet.rings[one][0]] = True
    y = np.where(held, 0.0, x)[None]
    for _ in range(30):
        gap, slope = sheet.closure(y)
        if np.abs(gap).max() < 1e-12:
            return y[0] if sheet.paper(y)[0] else None
        y = y - np.linalg.pinv(np.where(held, 0.0, slope[0]), rcond=SMALL) @ gap[0]
    return None


def refined(sheet: Sheet, facets: Facets, path: np.ndarray) -> np.ndarray | None:
    """Halve steps until they are short, through flat corners where signs change; None if it tears or crosses."""
    rows = np.zeros((len(sheet.rings), sheet.n))
    for row, (creases, _) in zip(rows, sheet.rings, strict=True):
        row[creases] = 1.0
    for _ in range(40):
        size = np.abs(np.diff(path, axis=0)).max(axis=1)
        sums = path @ rows.T
        sums[np.abs(sums) < 1e-9] = 0.0
        pops = sums[1:] * sums[:-1] < 0
        long = np.flatnonzero((size > NEAR) | pops.any(axis=1))
        if not len(long):
            return path if admissible(facets, path).all() else None
        if len(path) > 2_000:
            return None
        middles = []
        for k in long:
            want = 0.5 * (path[k] + path[k + 1])
            if pops[k].any() and size[k] < 0.5:
                middle = flattened(sheet, want, pops[k])
            else:
                moved, good = sheet.closed(want[None], 40, 1e-12)
                middle = moved[0] if good[0] else None
                if middle is not None:
                    off = np.abs(np.array([path[k], path[k + 1]]) - middle).max()
                    middle = middle if off < 0.98 * size[k] else None
            if middle is None or np.abs(middle - want).max() > size[k]:
                return None
            middles.append(middle)
        path = np.insert(path, long + 1, middles, axis=0)
    return None


def passes(
    sheet: Sheet,
    facets: Facets,
    springs: Springs,
    a: np.ndarray,
    b: np.ndarray,
    rng: np.random.Generator,
    drawn: int = 2,
    rounds: int = 60,
) -> list[np.ndarray]:
    """Refined paths from a to b, of strings by several ways."""
    through = np.concatenate([deflated(sheet, a), deflated(sheet, b)[::-1][1:]])
    first = [np.array([a, b]), through]
    for _ in range(drawn):
        middle, good = sheet.closed(0.5 * (a + b)[None] + rng.normal(size=(1, sheet.n)), 40)
        if good[0]:
            first.append(np.array([a, middle[0], b]))
    paths = [string(sheet, facets, springs, one, rounds) for one in first]
    fine = [refined(sheet, facets, path) for path in (*paths, through)]
    return [path for path in fine if path is not None]
