"""Which facets of a strip are apart, cross or meet, for the check of a proof: planes, and edges through facets.

Facets that share an interior vertex are convex, each within the cone of its sector; the sectors are a closed curve of
length 2 pi on the sphere, within a hemisphere and there a quadrangle, of whose opposite sides one pair crosses at most,
and then the vertex closes with a full turn more.  Such pairs are not asked about where a vertex closes as paper.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Any, TypeAlias

import numpy as np
from flint import arb, arb_series

from origami_nlp.proof.check_lists import Refused
from origami_nlp.proof.check_strip_boxes import ThetaBall
from origami_nlp.proof.check_strip_sheet import FlatDisk
from origami_nlp.proof.strip_certificate import CertifiedTouch

Point: TypeAlias = Any
CornersOver: TypeAlias = tuple[list[list[Any]], list[list[Any]], list[Any]]
"""Corners of all facets over a box, as balls and as series, and in its middle."""


class CheckedContact:
    """The facets of a sheet in space.

    Parameters
    ----------
    sheet
        With convex facets of which no two share a corner of the border alone.
    slack
        Ball round 0 in which directions of creases differ from those that are stated.

    Raises
    ------
    Refused
        If it is another.
    """

    def __init__(self, sheet: FlatDisk, slack: Any = 0) -> None:
        self.sheet = sheet
        facets = sheet.facets
        for ring in facets:
            if any(
                sheet._cross(a, b, c) < 0
                for a, b, c in zip(ring, ring[1:] + ring[:1], ring[2:] + ring[:2], strict=True)
            ):
                raise Refused("a facet is not convex")
        self.pairs = []
        for a, b in itertools.combinations(range(len(facets)), 2):
            shared = set(facets[a]) & set(facets[b])
            if not shared & sheet.inside:
                if shared:
                    raise Refused("two facets share a corner of the border and no vertex")
                self.pairs.append((a, b))
        self.steps = list(sheet.walk())
        self.axes = {}
        for crease, (a, b) in enumerate(sheet.said.creases):
            p, q = ([arb(float(x)) for x in sheet.said.corners[i]] for i in (a, b))
            u, v = q[0] - p[0], q[1] - p[1]
            length = (u * u + v * v).sqrt()
            self.axes[crease] = (p, u / length + slack, v / length + slack)
        self.beside: dict[int, dict[int, int]] = {f: {} for f in range(len(facets))}
        for (a, b), here in sheet.beside.items():
            there = sheet.beside.get((b, a))
            if there is not None:
                self.beside[here][there] = sheet.crease[frozenset((a, b))]

    def placed(self, folds: Sequence[Any]) -> list[list[Point]]:
        """Return the corners of all facets, fold angles given as balls or series."""
        zero, one = folds[0] * 0, folds[0] * 0 + 1
        frames = {0: ([[one, zero, zero], [zero, one, zero], [zero, zero, one]], [zero] * 3)}
        for g, f, crease, side in self.steps:
            (p, u, v), phi = self.axes[crease], side * folds[crease]
            c, s = phi.cos(), phi.sin()
            w = 1 - c
            # Rodrigues about (u, v, 0)
            r = [
                [c + u * u * w, u * v * w, v * s],
                [u * v * w, c + v * v * w, -u * s],
                [-v * s, u * s, c],
            ]
            t = [p[i] - (r[i][0] * p[0] + r[i][1] * p[1]) for i in (0, 1)] + [
                -(r[2][0] * p[0] + r[2][1] * p[1])
            ]
            big, shift = frames[f]
            frames[g] = (
                [
                    [sum((big[i][k] * r[k][j] for k in range(3)), zero) for j in range(3)]
                    for i in range(3)
                ],
                [sum((big[i][k] * t[k] for k in range(3)), zero) + shift[i] for i in range(3)],
            )
        out = []
        for f, ring in enumerate(self.sheet.facets):
            r, t = frames[f]
            flat = [[arb(float(x)) for x in self.sheet.said.corners[i]] for i in ring]
            out.append([tuple(r[i][0] * x + r[i][1] * y + t[i] for i in range(3)) for x, y in flat])
        return out

    def _over(self, over: ThetaBall) -> CornersOver:
        """Return corners over a box, as balls and as series, and in its middle."""
        kept = over.corners
        if kept is None:
            at = self.placed([a[0] for a in over.at.folds])
            box = self.placed(
                [arb_series([a, b[1]], 2) for a, b in zip(over.folds, over.box.folds, strict=True)]
            )
            balls = [
                [
                    [m + s[1] * over.away for m, s in zip(x, y, strict=True)]
                    for x, y in zip(p, q, strict=True)
                ]
                for p, q in zip(at, box, strict=True)
            ]
            middle = [np.array([[float(c.mid()) for c in x] for x in p]) for p in at]
            over.corners = kept = (balls, box, middle)
        return kept

    def apart(
        self, over: ThetaBall, weakly: bool = False, but: frozenset[tuple[int, int]] = frozenset()
    ) -> bool:
        """Return whether a plane certainly is between the two facets of each pair, over a box.

        Weakly: a fold that is nowhere 0 and reaches 180 degrees at most keeps its facet on one side of the one beside
        it, until both are in one plane; then over all states of the box that close.
        """
        balls, _, middle = self._over(over)
        return all(
            _plane_between(balls[a], balls[b], middle[a], middle[b])
            or self._beside(over, a, b, weakly)
            for a, b in self.pairs
            if (a, b) not in but
        )

    def _beside(self, over: ThetaBall, a: int, b: int, weakly: bool) -> bool:
        """Return whether the plane of some facet is between two, corners of it in it."""
        balls, _, _ = self._over(over)
        for c in range(len(balls)):
            sides = [self._side(over, balls, c, f, weakly) for f in (a, b)]
            if sides[0] * sides[1] < 0:
                return True
        return False

    def _side(self, over: ThetaBall, balls: list[list[Point]], c: int, f: int, weakly: bool) -> int:
        """Return on which side of the plane of facet c facet f is, but for corners in c; 0: not certain."""
        if f == c:
            return 0
        ring, own = self.sheet.facets[f], set(self.sheet.facets[c])
        folded = {
            g: self._sense(over.folds[crease], weakly) for g, crease in self.beside[c].items()
        }
        if folded.get(f):
            return folded[f]
        sides = set()
        for y, v in zip(balls[f], ring, strict=True):
            if v not in own:
                value = _common_sign([_volume(*_corners_of_plane(balls[c]), y)])
                # what lies at a corner of a facet beside c goes where that is folded
                sides.add(
                    value or next((s for g, s in folded.items() if v in self.sheet.facets[g]), 0)
                )
        return sides.pop() if len(sides) == 1 else 0

    def _sense(self, fold: Any, weakly: bool) -> int:
        """Return to which side of a facet's normal a fold turns the facet beside it: a valley to that of the normal.

        A convex facet is all beyond its crease.
        """
        return _common_sign([fold]) if weakly or abs(fold) < arb.pi() else 0

    def crosses(self, over: ThetaBall) -> bool:
        """Return whether a chord between corners of a facet certainly passes through another inside, all over a box."""
        balls, _, middle = self._over(over)
        for a, b in self.pairs:
            for one, other in ((a, b), (b, a)):
                for i, j in itertools.combinations(range(len(balls[one])), 2):
                    p, q = middle[one][i], middle[one][j]
                    if _passes(p, q, middle[other]) and _passes(
                        balls[one][i], balls[one][j], balls[other]
                    ):
                        return True
        return False

    def touches(self, over: ThetaBall, touches: Sequence[CertifiedTouch]) -> int:
        """Return the sign of the slope of all gaps, if each pair is apart or crosses by the sign of its own; else 0."""
        pairs = frozenset((min(t.facets), max(t.facets)) for t in touches)
        if not touches or not pairs <= set(self.pairs):
            return 0
        if not self.apart(over, but=pairs):
            return 0
        slopes = {self.meets(over, t) for t in touches}
        return slopes.pop() if len(slopes) == 1 else 0

    def meets(self, over: ThetaBall, touch: CertifiedTouch) -> int:
        """Return the sign of the slope of a gap that says whether its facets are apart or cross; 0: it does not."""
        balls, series, _ = self._over(over)
        sign = self._apart_sign(balls, touch)
        if not sign:
            return 0
        x = [series[f][i] for f, i in touch.corners]
        slope = sign * _volume(*x)[1]
        return 1 if slope > 0 else -1 if slope < 0 else 0

    def _apart_sign(self, balls: list[list[Point]], touch: CertifiedTouch) -> int:
        """Return the sign of the determinant of corners where facets are apart; where it is the other they cross.

        0 where that is not certain.
        """
        of = [f for f, _ in touch.corners]
        places = [i for _, i in touch.corners]
        if any(not 0 <= i < len(balls[f]) for f, i in touch.corners) or set(of) != set(
            touch.facets
        ):
            return 0
        if of[0] == of[1] == of[2] != of[3]:
            return self._corner_on_facet(balls[of[3]], places[3], balls[of[0]], places[:3])
        if of[0] == of[1] != of[2] == of[3]:
            return self._edge_on_edge(balls[of[0]], places[:2], balls[of[2]], places[2:])
        return 0

    def _corner_on_facet(self, a: list[Point], i: int, b: list[Point], plane: list[int]) -> int:
        """All other corners of a are on one side, and a side at the corner goes along a line through b inside."""
        if len(set(plane)) < 3:
            return 0
        x, y, z = (b[k] for k in plane)
        sides = [_volume(x, y, z, a[k]) for k in range(len(a)) if k != i]
        sign = _common_sign(sides)
        through = any(_common_sign(_turns(a[i], a[(i + step) % len(a)], b)) for step in (1, -1))
        return sign if through else 0

    def _edge_on_edge(self, a: list[Point], i: list[int], b: list[Point], j: list[int]) -> int:
        """Return the sign where all other corners are beyond planes along two sides; else that of b goes through a.

        For x0, x1 of a and x2, x3 of b, with n = (x1 - x0) x (x3 - x2): the determinant g is -n.(x2 - x0), and the line
        from x2 to x3 passes the side from x0 to x1 as g, all others of a as where it goes through.
        """
        n, m = len(a), len(b)
        if (i[1] - i[0]) % n not in (1, n - 1) or (j[1] - j[0]) % m not in (1, m - 1):
            return 0
        normal = _product(_minus(a[i[1]], a[i[0]]), _minus(b[j[1]], b[j[0]]))
        below = _common_sign([_dot(normal, _minus(a[k], a[i[0]])) for k in range(n) if k not in i])
        above = _common_sign([_dot(normal, _minus(b[k], b[j[0]])) for k in range(m) if k not in j])
        if not above or below != -above:
            return 0
        ends = [_volume(*_corners_of_plane(a), y) for y in (b[j[0]], b[j[1]])]
        if not (ends[0] > 0 > ends[1] or ends[0] < 0 < ends[1]):
            return 0
        ahead = (i[0] + 1) % n == i[1]
        turns = _turns(b[j[0]], b[j[1]], a)
        others = _common_sign([t for k, t in enumerate(turns) if k != (i[0] if ahead else i[1])])
        return -above if others == (above if ahead else -above) else 0

    def gaps(self, over: ThetaBall, touches: Sequence[CertifiedTouch]) -> list[int]:
        """Return the signs of all gaps at one state, 0 where that is not certain."""
        balls, _, _ = self._over(over)
        values = [
            self._apart_sign(balls, t) * _volume(*(balls[f][i] for f, i in t.corners))
            for t in touches
        ]
        return [_common_sign([value]) for value in values]


def _minus(x: Any, y: Any) -> Point:
    return x[0] - y[0], x[1] - y[1], x[2] - y[2]


def _product(x: Any, y: Any) -> Point:
    return x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]


def _dot(x: Any, y: Any) -> Any:
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]


def _volume(o: Any, x: Any, y: Any, z: Any) -> Any:
    return _dot(_product(_minus(x, o), _minus(y, o)), _minus(z, o))


def _corners_of_plane(x: Sequence[Any]) -> tuple[Any, Any, Any]:
    n = len(x)
    return x[0], x[n // 3], x[2 * n // 3]


def _common_sign(values: Sequence[Any]) -> int:
    """Return the sign that all values certainly have; 0 where there is none."""
    if values and all(v > 0 for v in values):
        return 1
    return -1 if values and all(v < 0 for v in values) else 0


def _turns(p: Any, q: Any, x: Sequence[Any]) -> list[Any]:
    """Return how the line from p to q passes the sides of a polygon: all alike if through it."""
    return [_volume(p, q, x[k], x[(k + 1) % len(x)]) for k in range(len(x))]


def _passes(p: Any, q: Any, x: Sequence[Any]) -> bool:
    """Return whether the edge from p to q passes through a convex polygon inside."""
    plane = _corners_of_plane(x)
    one, two = _volume(*plane, p), _volume(*plane, q)
    return bool((one > 0 and two < 0) or (one < 0 and two > 0)) and bool(
        _common_sign(_turns(p, q, x))
    )


def _plane_between(x: list[Point], y: list[Point], u: np.ndarray, v: np.ndarray) -> bool:
    """Return whether a plane is certainly between two polygons: chosen in their middle u, v, shown for balls x, y."""
    axes = np.concatenate(list(_candidates(u, v)))
    size = np.linalg.norm(axes, axis=1)
    axes = axes[size > 0] / size[size > 0, None]
    along, beyond = u @ axes.T, v @ axes.T
    room = np.stack([beyond.min(0) - along.max(0), along.min(0) - beyond.max(0)])
    way, k = np.unravel_index(int(room.argmax()), room.shape)
    if not room[way, k] > 0:
        return False
    axis = [arb(float(c)) for c in (axes[k] if way == 0 else -axes[k])]
    low = [_dot(axis, p) for p in x]
    high = [_dot(axis, p) for p in y]
    return all(a < b for a in low for b in high)


def _candidates(u: np.ndarray, v: np.ndarray) -> Iterator[np.ndarray]:
    e, f = (np.roll(z, -1, axis=0) - z for z in (u, v))
    n, m = (np.cross(z[1] - z[0], z[2] - z[0])[None] for z in (u, v))
    yield from (n, m, np.cross(n, e), np.cross(m, f), np.cross(e[:, None], f[None]).reshape(-1, 3))
    yield (v.mean(0) - u.mean(0))[None]
