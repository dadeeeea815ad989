"""Facets that come to touch along a curve of states: where it happens, with which features, and with what force.

Facets of a sheet with one freedom touch at single states of its curve.  Such a state is bracketed by the crossing test,
then found as the root of the gap of the features that meet, a corner and a facet, or two sides.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import cross
from origami_nlp.sheets.sheet import Sheet

INSIDE = 1e-6
"""Share of their size by which features meet inside each other; closer to a border more features meet."""


@dataclass(frozen=True, eq=False)
class Touch:
    """Features of two facets that meet: four points whose signed volume over an area is the gap.

    Attributes
    ----------
    type
        ``"vertex-face"`` (the first point over the triangle of the others) or ``"edge-edge"`` (two and two).
    facets
        The pair.
    corners
        Of the reference state, [4].
    carriers
        Which of the two facets each corner is taken from, 0 or 1, [4].
    sign
        +1 or -1, so that the gap is positive where facets are apart.
    """

    type: str
    facets: tuple[int, int]
    corners: tuple[int, int, int, int]
    carriers: tuple[int, int, int, int]
    sign: float

    def points(self, sheet: Sheet, phi: np.ndarray) -> np.ndarray:
        """Return the four points in space, [4, 3]."""
        turn, shift = sheet.crossings.poses.motions(phi)
        f = np.array(self.facets)[list(self.carriers)]
        x = sheet.pattern.corners[list(self.corners)]
        return np.einsum("pij,pj->pi", turn[f], x) + shift[f]

    def gap(self, sheet: Sheet, phi: np.ndarray) -> float:
        """Return the distance along the common normal, positive where facets are apart."""
        p = self.points(sheet, phi)
        if self.type == "vertex-face":
            normal = cross(p[2] - p[1], p[3] - p[1])
            off = p[0] - p[1]
        else:
            normal = cross(p[1] - p[0], p[3] - p[2])
            off = p[2] - p[0]
        return self.sign * float(off @ normal) / float(np.linalg.norm(normal))

    def gradient(self, sheet: Sheet, phi: np.ndarray) -> np.ndarray:
        """Return the derivative of the gap at touch by each fold angle along a shortest walk, [n].

        At touch the points that meet are one: only what moves the second facet along the normal counts.
        """
        p = self.points(sheet, phi)
        if self.type == "vertex-face":
            normal, at = cross(p[2] - p[1], p[3] - p[1]), p[0]
            facing = -1.0 if self.carriers[0] == 0 else 1.0
        else:
            normal, facing = cross(p[1] - p[0], p[3] - p[2]), 1.0
            at = _meeting(p)
        normal = self.sign * facing * normal / np.linalg.norm(normal)
        pattern, (turn, shift) = sheet.pattern, sheet.crossings.poses.motions(phi)
        out = np.zeros(sheet.size)
        for crease, sense in sheet.crossings.poses.path(*self.facets):
            f = int(pattern.left[crease])
            axis = sense * turn[f] @ pattern.directions[crease]
            o = turn[f] @ pattern.corners[pattern.ends[crease, 0]] + shift[f]
            out[crease] += float(normal @ cross(axis, at - o))
        return out

    def inside(self, sheet: Sheet, phi: np.ndarray) -> bool:
        """Tell whether the features meet inside each other."""
        p = self.points(sheet, phi)
        if self.type == "edge-edge":
            s, t = _shares(p)
            return bool(INSIDE < s < 1 - INSIDE and INSIDE < t < 1 - INSIDE)
        own = self.facets[self.carriers[1]]
        crossings = sheet.crossings
        x = crossings.placed(phi)[crossings.facet == own]
        cuts = crossings.inner[crossings.facet == own]
        return any(_within(p[0], piece, cut) for piece, cut in zip(x, cuts, strict=True))


def _shares(p: np.ndarray) -> tuple[float, float]:
    """Return where the lines p0 p1 and p2 p3 are closest, as shares of the sides."""
    a = np.column_stack([p[1] - p[0], p[2] - p[3]])
    s, t = np.linalg.lstsq(a, p[2] - p[0], rcond=None)[0]
    return float(s), float(t)


def _meeting(p: np.ndarray) -> np.ndarray:
    s, _ = _shares(p)
    return p[0] + s * (p[1] - p[0])


def _within(point: np.ndarray, polygon: np.ndarray, cuts: np.ndarray) -> bool:
    """Tell whether a point of the plane of a convex polygon [q, 3] lies inside, cuts through a facet not counted."""
    normal = cross(polygon - polygon[0], np.roll(polygon, -1, axis=0) - polygon[0]).sum(axis=0)
    normal /= np.linalg.norm(normal)
    side = np.roll(polygon, -1, axis=0) - polygon
    length = np.linalg.norm(side, axis=1)
    size = float(length.max())
    reach = np.einsum("qi,qi->q", cross(normal[None], side), point - polygon)
    room = np.where(cuts, -INSIDE, INSIDE) * size * length
    return bool(((reach > room) | (length == 0.0)).all())


def features(
    sheet: Sheet, pair: tuple[int, int]
) -> Iterator[tuple[str, tuple[int, ...], tuple[int, ...]]]:
    """Go through the features of two facets that can meet: type, corners, carriers."""
    pattern = sheet.pattern
    rings = [
        [pattern.polygons[k] for k in np.flatnonzero(pattern.facet_of == facet)] for facet in pair
    ]
    corners = [sorted({v for ring in of for v in ring}) for of in rings]
    for one, other in ((0, 1), (1, 0)):
        a, b, c = rings[other][0][:3]
        for v in corners[one]:
            yield "vertex-face", (v, a, b, c), (one, other, other, other)
    sides = [{(r[i - 1], r[i]) for r in of for i in range(len(r))} for of in rings]
    for a, b in sorted(sides[0]):
        for c, d in sorted(sides[1]):
            if len({a, b, c, d}) == 4:
                yield "edge-edge", (a, b, c, d), (0, 0, 1, 1)


def find_touch(
    sheet: Sheet,
    pair: tuple[int, int],
    state: Callable[[float], np.ndarray],
    free: float,
    crossed: float,
) -> tuple[float, Touch] | None:
    """Find where two facets come to touch along a curve.

    Parameters
    ----------
    sheet
        The programme.
    pair
        Facets that cross at `crossed` and not at `free`.
    state
        Closed states [n] over a parameter.
    free, crossed
        A bracket.

    Returns
    -------
    tuple
        The parameter of the touch and its features; None where none meet inside each other.
    """
    found = []
    first, last = state(free), state(crossed)
    for kind, corners, carriers in features(sheet, pair):
        touch = Touch(kind, pair, corners, carriers, 1.0)  # type: ignore[arg-type]
        a, b = touch.gap(sheet, first), touch.gap(sheet, last)
        if a * b >= 0 or min(abs(a), abs(b)) == 0.0:
            continue
        touch = Touch(kind, pair, corners, carriers, 1.0 if a > 0 else -1.0)  # type: ignore[arg-type]
        low, high, left, right = free, crossed, abs(a), -abs(b)
        for _ in range(100):  # bisection and secants in turn
            secant = low + (high - low) * left / (left - right)
            for middle in (secant, 0.5 * (low + high)):
                if not min(low, high) < middle < max(low, high):
                    continue
                value = touch.gap(sheet, state(middle))
                if value > 0:
                    low, left = middle, value
                else:
                    high, right = middle, value
            if abs(high - low) < 1e-15 * (1 + abs(high)) or left < 1e-15 * sheet.crossings.size:
                break
        if touch.inside(sheet, state(low)):
            found.append((low, touch))
    # the first one met
    return min(found, key=lambda f: abs(f[0] - free)) if found else None
