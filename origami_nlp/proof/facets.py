"""Which facets cross along curves of a sheet that need not fold flat, over intervals, by balls.

Facets that share an interior vertex do not cross where it closes turned by no full turn and no crease is beyond +-pi:
each is convex and so within the cone of its sector.  The four sectors are a closed curve of length 2 pi on the sphere,
so within a hemisphere; seen from its centre that is a quadrangle in the plane, of whose two pairs of opposite sides one
crosses at most.  A crossing would be a full turn more, and such states are none of the sheet's.

Two other facets are apart where a plane separates all their corners, and cross where an edge, or a diagonal, of one
passes through the other inside.  Beside one third facet, and folded to different sides of it, they are apart.  Where
they meet first, a corner reaches a facet or an edge an edge: a determinant g of three vectors between corners is 0, and
where g' has a sign over an interval, they are apart on one side of its zero and cross on the other.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_mat

from origami_nlp.pattern import Pattern, in_plane
from origami_nlp.proof.sheets import sign_of
from origami_nlp.proof.slopes import Crossing

NEAR = 2.0**-6
"""Width of theta above which no first touch is looked for [rad]: such intervals are cut first."""
TOGETHER = 2.0**-30
"""Width of theta within which facets are asked of the state at a fold limit [rad]."""


class FacetTouch(NamedTuple):
    """Two polygons that meet: g = sign det(x1 - x0, x2 - x0, x3 - x0) > 0 where they are apart; corners by places."""

    polygons: tuple[int, int]
    corners: tuple[tuple[int, int], ...]
    sign: int


def why_no_contact_of_quads(pattern: Pattern) -> str:
    """Return why contact between the facets of a sheet that need not fold flat is not proved; "" where it is."""
    if len(pattern.polygons) != pattern.facets:
        return "a facet is of several pieces"
    if not all(_is_convex(in_plane(pattern)[list(p)]) for p in pattern.polygons):
        return "a facet is not convex"
    if any(set(pattern.polygons[a]) & set(pattern.polygons[b]) for a, b in _far_pairs(pattern)):
        return "two facets share a corner of the border and no vertex"
    return ""


def _is_convex(x: np.ndarray) -> bool:
    """Return whether a polygon [q, 2] is convex, exactly; corners of 180 degrees may be."""
    p = [[arb(float(a)) for a in row] for row in x]
    u = [(b[0] - a[0], b[1] - a[1]) for a, b in zip(p, p[1:] + p[:1], strict=True)]
    turns = [a[0] * b[1] - a[1] * b[0] for a, b in zip(u, u[1:] + u[:1], strict=True)]
    return not any(t < 0 for t in turns) or not any(t > 0 for t in turns)


def _far_pairs(pattern: Pattern) -> list[tuple[int, int]]:
    """Return pairs of polygons that share no interior vertex."""
    inside = {v.vertex for v in pattern.vertices}
    at = [inside & set(p) for p in pattern.polygons]
    return [(a, b) for a, b in itertools.combinations(range(len(at)), 2) if not at[a] & at[b]]


class Facets:
    """The facets of a sheet.

    Parameters
    ----------
    pattern
        A sheet of which `why_no_contact` says nothing, in its plane.
    """

    def __init__(self, pattern: Pattern) -> None:
        self.pattern, self.pairs = pattern, _far_pairs(pattern)
        piece = {int(f): k for k, f in enumerate(pattern.facet_of)}
        self.beside = [
            (piece[a], piece[b])
            for a, b in zip(pattern.left.tolist(), pattern.right.tolist(), strict=True)
        ]
        self.between = [list(self._between(a, b)) for a, b in self.pairs]
        self.place = [[arb(v) for v in row] for row in pattern.corners[:, :2].tolist()]
        self.flat = [
            arb_mat([[self.place[v][i] for v in p] for i in (0, 1)] + [[0] * len(p)])
            for p in pattern.polygons
        ]
        self.steps = list(self._walk())

    def _between(self, a: int, b: int) -> Iterator[tuple[int, int, int]]:
        """Yield the creases from polygon a and from b to a third one beside both, and that."""
        for one, other in itertools.product(enumerate(self.beside), repeat=2):
            (c, pair), (d, two) = one, other
            third = {*pair} & {*two}
            if a in pair and b in two and third and third.isdisjoint((a, b)):
                yield c, d, third.pop()

    def _walk(self) -> Iterator[tuple[int, int, int, Any, Any, Any]]:
        """Yield each facet but the first, the one before, the crease between, and K, K^2 and a corner of it.

        K x = u x x for the direction u of the crease, times the sense in which it is crossed.
        """
        seen, front = {0}, [0]
        for here in front:
            for crease, pair in enumerate(self.beside):
                there = sum(pair) - here
                if here not in pair or there in seen:
                    continue
                seen.add(there)
                front.append(there)
                a, b = (self.place[v] for v in self.pattern.ends[crease].tolist())
                u, v = b[0] - a[0], b[1] - a[1]
                length = (u * u + v * v).sqrt() * (1 if there == pair[0] else -1)
                u, v = u / length, v / length
                once = arb_mat([[0, 0, v], [0, 0, -u], [-v, u, 0]])
                yield there, here, crease, once, once * once, arb_mat([[a[0]], [a[1]], [0]])

    def corners(self, folds: Sequence[Any]) -> list[tuple[Any, Any]]:
        """Return the corners of each polygon in space, 3 x q, with their rates; one facet stays where it is."""
        unit, zero, none = arb_mat(3, 3, [1, 0, 0, 0, 1, 0, 0, 0, 1]), arb_mat(3, 3), arb_mat(3, 1)
        turn, shift = {0: (unit, zero)}, {0: (none, none)}
        for there, here, crease, once, twice, o in self.steps:
            # r = 1 + sin phi K + (1 - cos phi) K^2 about a crease through o
            s, c = folds[crease][0].sin(), folds[crease][0].cos()
            r = unit + once * s + twice * (1 - c)
            rate = (once * c + twice * s) * folds[crease][1]
            (m, dm), (t, dt) = turn[here], shift[here]
            away = o - r * o
            shift[there] = m * away + t, dm * away - m * (rate * o) + dt
            turn[there] = m * r, dm * r + m * rate
        out = []
        for k, x in enumerate(self.flat):
            (m, dm), (t, dt) = turn[k], shift[k]
            one = arb_mat(1, x.ncols(), [1] * x.ncols())
            out.append((m * x + t * one, dm * x + dt * one))
        return out

    def over(self, middle: Sequence[Any], folds: Sequence[Any], away: Any) -> Placed:
        """Return the facets over an interval: from the middle and rates, x = x(middle) + x' (theta - middle)."""
        rates = [rate for _, rate in self.corners(folds)]
        return Placed(
            self,
            [
                (x + rate * away, rate)
                for (x, _), rate in zip(self.corners(middle), rates, strict=True)
            ],
        )


class Placed:
    """The facets of a sheet in space, over an interval."""

    def __init__(self, facets: Facets, corners: list[tuple[Any, Any]]) -> None:
        self.facets = facets
        self.x, self.rate = ([_columns(c[i]) for c in corners] for i in (0, 1))
        self.middle = [np.array([[float(a.mid()) for a in v] for v in x]) for x in self.x]

    def gaps(
        self, sides: dict[int, int], width: float, closed: dict[int, int]
    ) -> dict[Any, tuple[Any, Any]] | None:
        """Return gaps of facets that may touch, where creases are folded to these sides; None where it is not known.

        Creases that may be closed within the interval, at +-pi, are its end: facets are asked of that state.

        Raises
        ------
        Crossing
            If some cross.
        """
        asked = [
            k
            for k, between in enumerate(self.facets.between)
            if not any(sides[c] != sides[d] for c, d, _ in between)
            and not self._apart(*self.facets.pairs[k])
        ]
        pairs = [self.facets.pairs[k] for k in asked]
        if any(self._passes(a, b) or self._passes(b, a) for a, b in pairs):
            raise Crossing
        if closed and width <= TOGETHER:
            # of several that reach their limits all but together, which is first is not known
            if len(closed) == 1:
                (flat,) = closed
                if any(self._reached(k, flat, sides) for k in asked):
                    raise Crossing(at_end=True)
            return None if pairs else {}
        if width > NEAR:
            return None if pairs else {}
        touches = [self._touch(*pair) for pair in pairs]
        if None in touches:
            return None
        return {t: (self.gap(t), self._rate(t)) for t in touches if t is not None}

    def _apart(self, a: int, b: int) -> bool:
        """Return whether a plane certainly separates two polygons."""
        x, y = self.middle[a], self.middle[b]
        axes = np.concatenate(list(_axes(x, y)))
        axes = axes / np.maximum(np.linalg.norm(axes, axis=1), np.finfo(float).tiny)[:, None]
        u, v = axes @ x.T, axes @ y.T
        ahead = np.array([v.min(axis=1) - u.max(axis=1), u.min(axis=1) - v.max(axis=1)])
        side, best = np.unravel_index(np.nan_to_num(ahead, nan=-np.inf).argmax(), ahead.shape)
        if not ahead[side, best] > 0:
            return False
        axis = [arb(float(z)) for z in (1 - 2 * side) * axes[best]]
        low, high = ([_dot(axis, p) for p in self.x[k]] for k in (b, a))
        return all(p > q for p in low for q in high)

    def _passes(self, a: int, b: int) -> bool:
        """Return whether an edge or diagonal of polygon a certainly passes through polygon b inside.

        Where edges pass edges at both ends of a crossing, as in sheets with half-turns, a diagonal alone does.
        """
        x, y = self.x[a], self.x[b]
        side = [sign_of(_height(y, p)) for p in x]
        for i, j in itertools.combinations(range(len(x)), 2):
            if side[i] * side[j] < 0:
                turns = {sign_of(t) for t in _turns(x[i], x[j], y)}
                if len(turns) == 1 and 0 not in turns:
                    return True
        return False

    def gap(self, touch: FacetTouch) -> Any:
        """Return g."""
        x = [self.x[p][k] for p, k in touch.corners]
        return touch.sign * _det(*(_minus(p, x[0]) for p in x[1:]))

    def _rate(self, touch: FacetTouch) -> Any:
        """Return g'."""
        x, r = ([z[p][k] for p, k in touch.corners] for z in (self.x, self.rate))
        u, v = ([_minus(p, z[0]) for p in z[1:]] for z in (x, r))
        return touch.sign * sum(
            _det(*(v[j] if i == j else u[j] for j in range(3))) for i in range(3)
        )

    def _touch(self, a: int, b: int) -> FacetTouch | None:
        """Return the corners with which two polygons meet, if they are certain."""
        far, i, j = min(_nearest(self.middle[a], self.middle[b]))
        if not np.isfinite(far):
            return None
        if j == -1:
            return self._corner_on_facet(a, b, i)
        return self._corner_on_facet(b, a, j) if i == -1 else self._edge_on_edge(a, b, i, j)

    def _corner_on_facet(self, a: int, b: int, i: int) -> FacetTouch | None:
        """Return how corner i of polygon a meets b, if its others are on one side and a side at it goes through."""
        x, y = self.x[a], self.x[b]
        others = {sign_of(_height(y, p)) for k, p in enumerate(x) if k != i}
        through = [{sign_of(t) for t in _turns(x[k], x[(k + 1) % len(x)], y)} for k in (i - 1, i)]
        if len(others) > 1 or 0 in others or not any(len(t) == 1 and 0 not in t for t in through):
            return None
        n = len(y)
        corners = ((b, 0), (b, n // 3), (b, 2 * n // 3), (a, i))
        return FacetTouch((a, b), corners, others.pop())

    def _edge_on_edge(self, a: int, b: int, i: int, j: int) -> FacetTouch | None:
        """Return how side i of polygon a meets side j of b, if both lie beyond and one goes through beside it."""
        x, y = self.x[a], self.x[b]
        i2, j2 = (i + 1) % len(x), (j + 1) % len(y)
        e, f = _minus(x[i2], x[i]), _minus(y[j2], y[j])
        below, above = (
            {sign_of(_det(e, f, _minus(p, z[k]))) for m, p in enumerate(z) if m not in (k, n)}
            for z, k, n in ((x, i, i2), (y, j, j2))
        )
        sign = next(iter(above))
        if sign == 0 or above != {sign} or below != {-sign}:
            return None
        ends = [sign_of(_height(x, p)) for p in (y[j], y[j2])]
        turn = {sign_of(t) for k, t in enumerate(_turns(y[j], y[j2], x)) if k != i}
        # past side i itself it turns as -sign g: as past all others where g < 0
        if ends[0] * ends[1] >= 0 or turn != {sign}:
            return None
        # det(x1 - x0, y1 - y0, y0 - x0) = det(x1 - x0, y1 - x0, y0 - x0)
        return FacetTouch((a, b), ((a, i), (a, i2), (b, j2), (b, j)), sign)

    def _reached(self, k: int, flat: int, sides: dict[int, int]) -> bool:
        """Return whether a facet, folded flat on another, goes on past a crease beyond which one is folded to it.

        It passes from one side of the facet and of the one beyond to the other: they cross.
        """
        for one, other, third in self.facets.between[k]:
            for a, here, crease in (
                (self.facets.pairs[k][0], one, other),
                (self.facets.pairs[k][1], other, one),
            ):
                if here != flat or sides[here] != sides[crease]:
                    continue
                ring = self.facets.pattern.polygons[third]
                x, y = self.x[a], self.x[third]
                n = len(y)
                normal = _cross(_minus(y[n // 3], y[0]), _minus(y[2 * n // 3], y[0]))
                p, q = (y[ring.index(v)] for v in self.facets.pattern.ends[crease].tolist())
                for share in range(1, 20):
                    at = [u + (v - u) * share / 20 for u, v in zip(p, q, strict=True)]
                    turns = {
                        sign_of(_det(normal, _minus(v, u), _minus(at, u)))
                        for u, v in zip(x, [*x[1:], x[0]], strict=True)
                    }
                    if len(turns) == 1 and 0 not in turns:
                        return True
        return False


def _columns(x: Any) -> list[list[Any]]:
    return [[x[i, k] for i in range(3)] for k in range(x.ncols())]


def _minus(x: Sequence[Any], y: Sequence[Any]) -> list[Any]:
    return [a - b for a, b in zip(x, y, strict=True)]


def _dot(x: Sequence[Any], y: Sequence[Any]) -> Any:
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]


def _cross(x: Sequence[Any], y: Sequence[Any]) -> list[Any]:
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]


def _det(x: Sequence[Any], y: Sequence[Any], z: Sequence[Any]) -> Any:
    return _dot(x, _cross(y, z))


def _height(y: Sequence[Any], p: Sequence[Any]) -> Any:
    """Return on which side of the plane of polygon y a corner is."""
    n = len(y)
    return _det(_minus(y[n // 3], y[0]), _minus(y[2 * n // 3], y[0]), _minus(p, y[0]))


def _turns(p: Sequence[Any], q: Sequence[Any], y: Sequence[Any]) -> Iterator[Any]:
    """Yield how the line from p to q passes the lines of the sides of y: all alike if it goes through it."""
    along = _minus(q, p)
    for r, s in zip(y, [*y[1:], y[0]], strict=True):
        yield _det(along, _minus(r, p), _minus(s, p))


def _axes(x: np.ndarray, y: np.ndarray) -> Iterator[np.ndarray]:
    """Yield normals of planes that may separate two plane polygons [q, 3], [C, 3] each."""
    (n, e), (m, f) = (
        (np.cross(z, np.roll(z, -1, axis=0)).sum(axis=0), np.roll(z, -1, axis=0) - z)
        for z in (x, y)
    )
    yield from (n[None], m[None], np.cross(n, e), np.cross(m, f))
    yield np.cross(e[:, None], f[None]).reshape(-1, 3)


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
