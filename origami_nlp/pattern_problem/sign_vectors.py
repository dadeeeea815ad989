"""Which signs of vertices (`PopSigns`) states beside the flat one can have: second-order cones, decided exactly.

Beside the flat state the fold angles x round a vertex, along unit vectors u_i in turn, satisfy sum x_i u_i = 0 and, to
second order, Q(x) = sum_{i<j} x_i x_j (u_i x u_j) = 0.  On the former Q has one positive direction, and the sum of x
is of its kind (``docs/validation/landscapes.md``): x of vertices of one sign are in a convex cone, a half of Q >= 0.
Numbers of creases between vertices, added at one end and subtracted at the other, sum to 0 with any fold angles; if at
each vertex of a set they are positive on its half, no state beside the flat one has these signs there.  That is
checked in rational arithmetic, for the coordinates as they are stated: over the length of its crease each x has
rational equations, and the crease has the same length at both ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.numerics import BALL, EQUAL, POSITIVE, ConicProgram, null_space, unit_normals
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem.pop_signs import PopSigns

MARGIN = 1e-6
"""What a direction, or numbers against signs, are worth at least where the largest entry is 1: less is not decided."""
Rational = list[list[Fraction]]


@dataclass(frozen=True, repr=False)
class SignConflict(ShortRepr):
    """Vertices that cannot have these signs together beside the flat state, and the numbers that prove it.

    Attributes
    ----------
    vertices
        Which, as a file numbers them.
    signs
        Of each, such as ``"+-"``; all turned over is impossible as well.
    creases, weights
        Creases between them (from 1), and what their fold angles over their lengths are weighed by at the first of
        their ends, and by minus that at the other: checked by `VertexCones.refutes`.
    """

    vertices: tuple[int, ...]
    signs: str
    creases: tuple[int, ...]
    weights: tuple[float, ...]


@dataclass(frozen=True, repr=False)
class SignVector(ShortRepr):
    """What is known of states with some signs of all vertices.

    Attributes
    ----------
    signs
        A sign a vertex, in the order of `PopSigns.vertices`.
    verdict
        ``"minimum"``: a stable state has them; ``"state"``: `fold_angles` are one beside the flat state, closed,
        without crossing facets; ``"impossible"``: none beside the flat state has; ``"open"``: neither is known.
    fold_angles
        [rad]; empty but for ``"state"``.
    conflict
        Proves that no state beside the flat one has these signs; stable states further off may have them.
    """

    signs: str
    verdict: str
    fold_angles: tuple[float, ...] = ()
    conflict: SignConflict | None = None


class VertexCone:
    """Fold angles round one vertex of a flat sheet near the flat state, [d], with one sign.

    Parameters
    ----------
    creases
        Round it, counter-clockwise (from 0).
    edges
        Along them, away from the vertex, [d, 2].
    """

    def __init__(self, creases: Sequence[int], edges: np.ndarray) -> None:
        self.creases, self._edges = tuple(creases), edges

    @cached_property
    def axes(self) -> np.ndarray | None:
        """Rows A [d - 2, d]: Q(x) is (A x)_0^2 - sum_k (A x)_k^2, and (A x)_0 > 0 for the sign +; None without such."""
        lengths = np.linalg.norm(self._edges, axis=1)
        u = self._edges / lengths[:, None]
        free = null_space(u.T)
        q = np.triu(u[:, :1] * u[:, 1] - u[:, 1:] * u[:, 0], 1)
        values, vectors = np.linalg.eigh(free.T @ (q + q.T) @ free / 2)
        if not len(values) or values[-1] <= MARGIN or (values[:-1] >= -MARGIN).any():
            return None
        rows = (np.sqrt(np.abs(values))[:, None] * vectors.T @ free.T)[::-1]
        # the sum of x is of the kind of the first row: its sign on that is the sign of all of the half
        return rows * math.copysign(1.0, float((free @ vectors[:, -1]).sum()))

    def dual(self) -> np.ndarray:
        """Return rows D [d - 2, d]: z with z . x > 0 on the half of the sign + has (D z)_0 > |(D z)_1...|."""
        assert self.axes is not None
        return np.linalg.pinv(self.axes).T

    def positive(self, z: dict[int, Fraction], sign: int) -> bool:
        """Return whether numbers by crease are positive on the half of a sign, for x over lengths: exactly.

        On directions y with sum y_i e_i = 0, z z' - t G is positive definite for some t > 0 (G of Q): where z . y
        vanishes Q is negative, so that z has one sign on each half; which one is asked of a point of it.  By a
        margin of `MARGIN`, so that coordinates that are off by rounding prove nothing that others would not.
        """
        e = [[Fraction(float(a)) for a in row] for row in self._edges]
        free, d = _null_space(e), len(e)
        if free is None or self.axes is None:
            return False
        q = [[Fraction(0)] * d for _ in range(d)]
        for i in range(d):
            for j in range(i + 1, d):
                q[i][j] = q[j][i] = (e[i][0] * e[j][1] - e[i][1] * e[j][0]) / 2
        given = [z.get(k, Fraction(0)) for k in self.creases]
        inner = self.dual() @ (np.array(given, float) / np.linalg.norm(self._edges, axis=1))
        if abs(inner[0]) - np.linalg.norm(inner[1:]) <= MARGIN * abs(inner[0]):
            return False
        g = [[_dot(a, [_dot(row, b) for row in q]) for b in free] for a in free]
        w = [_dot(given, a) for a in free]
        inside = np.linalg.solve(np.array(g, float), np.array(w, float))  # where z . x is least
        t = Fraction(float(inside @ np.array(w, float)) / 2)
        point = [Fraction(float(x)) for x in inside]
        m = [[a * b - t * g[i][j] for j, b in enumerate(w)] for i, a in enumerate(w)]
        if t <= 0 or not _is_positive_definite(m):
            return False
        if _dot(point, [_dot(row, point) for row in g]) <= 0:
            return False
        x = [
            sum((c * a[k] for c, a in zip(point, free, strict=True)), Fraction(0)) for k in range(d)
        ]
        side = _sign_of_sum(x, e)
        return side != 0 and side * sign * _dot(w, point) > 0


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    return sum((p * q for p, q in zip(a, b, strict=True)), Fraction(0))


def _null_space(edges: Rational) -> Rational | None:
    """Return a basis of x with sum x_i e_i = 0, [d - 2, d]; None where all e_i are in one line."""
    d = len(edges)
    pairs = ((abs(_cross(edges[i], edges[j])), -i, -j) for i in range(d) for j in range(i + 1, d))
    size, i, j = max(pairs, default=(Fraction(0), 0, 0))
    if not size:
        return None
    i, j, basis = -i, -j, []
    whole = _cross(edges[i], edges[j])
    for k in (k for k in range(d) if k not in (i, j)):
        x = [Fraction(0)] * d
        x[k] = Fraction(1)
        x[i], x[j] = -_cross(edges[k], edges[j]) / whole, -_cross(edges[i], edges[k]) / whole
        basis.append(x)
    return basis


def _cross(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    return a[0] * b[1] - a[1] * b[0]


def _is_positive_definite(m: Rational) -> bool:
    """Return whether a symmetric matrix is, by elimination."""
    m = [row[:] for row in m]
    for k, row in enumerate(m):
        if row[k] <= 0:
            return False
        for below in m[k + 1 :]:
            share = below[k] / row[k]
            for j in range(k, len(m)):
                below[j] -= share * row[j]
    return True


DIGITS = 10**24
"""Lengths of edges are enclosed to one part of this."""


def _sign_of_sum(x: Sequence[Fraction], edges: Rational) -> int:
    """Return the sign of the sum of fold angles, each x times the length of its edge; 0 where it is not clear."""
    low = high = Fraction(0)
    for a, (p, q) in zip(x, edges, strict=True):
        root = math.isqrt(int((p * p + q * q) * DIGITS * DIGITS))
        ends = a * Fraction(root, DIGITS), a * Fraction(root + 1, DIGITS)
        low, high = low + min(ends), high + max(ends)
    return (low > 0) - (high < 0)


class VertexCones:
    """The cones of all vertices of a flat sheet that have a sign.

    Parameters
    ----------
    pattern
        Flat; `VertexCones.vertices` are those of `PopSigns`.

    Examples
    --------
    A crease that folds as its vertex pops, at both of its ends, makes them pop to one side:

    >>> import origami_nlp as o
    >>> from origami_nlp.pattern_problem import VertexCones
    >>> cones = VertexCones(o.examples.pattern("metasheet", 3, 3))
    >>> conflict = cones.conflict("++-+")
    >>> conflict.signs, cones.refutes(conflict), cones.conflict("++++")
    ('+-', True, None)
    """

    def __init__(self, pattern: Pattern) -> None:
        self.pattern, signs = pattern, PopSigns(pattern)
        self.vertices = signs.vertices
        self.cones = [self._cone(v, c) for v, c in zip(signs.vertices, signs.around, strict=True)]

    def _cone(self, vertex: int, creases: tuple[int, ...]) -> VertexCone:
        pattern, x = self.pattern, self._plane
        others = np.where(pattern.ends[list(creases), 0] == vertex, 1, 0)
        edges = x[pattern.ends[list(creases), others]] - x[vertex]
        order = np.argsort(np.arctan2(edges[:, 1], edges[:, 0]), kind="stable")
        return VertexCone([creases[k] for k in order], edges[order])

    @cached_property
    def _plane(self) -> np.ndarray:
        """Corners in the plane of the sheet, as they are stated where that is z = const, [V, 2]."""
        x = self.pattern.corners
        if not np.ptp(x[:, 2]):
            return np.asarray(x[:, :2])
        normal = unit_normals(x[list(self.pattern.polygons[0])])
        return np.asarray(x @ np.linalg.svd(normal[None])[2][1:].T)

    @property
    def decidable(self) -> bool:
        """Whether every vertex has a cone: none has edges in one line, or too few."""
        return all(c.axes is not None for c in self.cones)

    def direction(
        self, signs: str, some: Sequence[int] | None = None, towards: np.ndarray | None = None
    ) -> np.ndarray | None:
        """Return fold angles beside the flat state in all cones, [n], the largest 1; None where there are none.

        To first order they close; Q is not negative (it is 0 where a state closes to second order).

        Parameters
        ----------
        signs
            A sign a vertex.
        some
            Vertices (from 0) that are asked about; None: all.
        towards
            What is preferred, [n]; None: vertices far from flat.
        """
        if some is None or towards is not None:
            used = np.arange(self.pattern.creases)
        else:  # what a crease between others does is as good as any
            used = np.unique([k for v in some for k in self.cones[v].creases])
        n, some = len(used), range(len(self.cones)) if some is None else some
        if not some or not self.decidable:
            return None
        problem = ConicProgram(n + 1)
        unit = np.eye(n + 1)
        problem.add(POSITIVE, np.vstack([-unit[:n], unit[:n]]), np.ones(2 * n), "size")
        for v in some:
            cone, sign = self.cones[v], float(f"{signs[v]}1")
            at = sign * unit[np.searchsorted(used, cone.creases)]
            edges = cone._edges / np.linalg.norm(cone._edges, axis=1)[:, None]
            assert cone.axes is not None
            problem.add(EQUAL, edges.T @ at, np.zeros(2), "closes")
            rows = cone.axes @ at
            problem.add(BALL, rows, np.zeros(len(rows)), "Q >= 0")
            problem.add(POSITIVE, rows[:1] - unit[n], np.zeros(1), "sign")
        aim = unit[n]
        found = problem.maximise(aim)
        if not found.solved or found.v[n] <= MARGIN:
            return None
        if towards is not None:
            problem.add(POSITIVE, aim[None], -found.v[n : n + 1] / 4, "far enough")
            aside = problem.maximise(np.append(towards, 0.0))
            found = aside if aside.solved else found
        out = np.zeros(self.pattern.creases)
        out[used] = found.v[:n]
        return out

    def conflict(self, signs: str) -> SignConflict | None:
        """Return vertices that cannot have their signs together beside the flat state; None: there may be none.

        Parameters
        ----------
        signs
            A sign a vertex.

        Returns
        -------
        SignConflict or None
            Checked by `refutes`, of as few vertices as leaving out one after the other comes to.
        """
        some = list(range(len(self.cones)))
        if not self.decidable or self.direction(signs) is not None:
            return None
        kept: list[int] = []
        # leave out one after the other, by bisection: with fewer vertices no more is impossible
        while some and (not kept or self.direction(signs, kept) is not None):
            low, high = (
                0,
                len(some),
            )  # how many of the last are to be kept: more than low, high at most
            while high - low > 1:
                many = (low + high) // 2
                possible = self.direction(signs, [*kept, *some[-many:]]) is not None
                low, high = (many, high) if possible else (low, many)
            kept, some = [*kept, some[-high]], some[len(some) - high + 1 :]
        some = kept
        vertices = tuple(self.vertices[v] for v in some)
        weights = self._weights(signs, some)
        word, creases = "".join(signs[v] for v in some), tuple(k + 1 for k in weights)
        found = SignConflict(vertices, word, creases, tuple(weights.values()))
        return found if self.refutes(found) else None

    def _inner(self, some: Sequence[int]) -> list[int]:
        """Creases between two of some vertices."""
        ends = [k for v in some for k in self.cones[v].creases]
        return sorted({k for k in ends if ends.count(k) == 2})

    def _weights(self, signs: str, some: Sequence[int]) -> dict[int, float]:
        """Return numbers of creases between vertices that are positive on the half of each: by a conic program."""
        inner = self._inner(some)
        column, problem = {k: i for i, k in enumerate(inner)}, ConicProgram(len(inner) + 1)
        unit, last = np.eye(len(inner) + 1), len(inner)
        problem.add(POSITIVE, np.vstack([unit[:last], -unit[:last]]), np.ones(2 * last), "size")
        seen: set[int] = set()
        for v in some:
            cone, sign = self.cones[v], float(f"{signs[v]}1")
            at = np.zeros((len(cone.creases), last + 1))
            for i, k in enumerate(cone.creases):
                if k in column:
                    at[i, column[k]] = -sign if k in seen else sign
                    seen.add(k)
            rows = cone.dual() @ at
            rows[0] -= unit[last]
            problem.add(BALL, rows, np.zeros(len(rows)), "positive")
        found = problem.maximise(unit[last])
        lengths = np.linalg.norm(
            self.pattern.corners[self.pattern.ends[inner, 0]]
            - self.pattern.corners[self.pattern.ends[inner, 1]],
            axis=1,
        )
        return dict(zip(inner, (found.v[:last] * lengths).tolist(), strict=True))

    def refutes(self, conflict: SignConflict) -> bool:
        """Return whether the numbers of a conflict prove it, in rational arithmetic.

        Parameters
        ----------
        conflict
            Of any origin.
        """
        some = [self.vertices.index(v) for v in conflict.vertices]
        weights = {
            k - 1: Fraction(w) for k, w in zip(conflict.creases, conflict.weights, strict=True)
        }
        if not weights or not set(weights) <= set(self._inner(some)):
            return False
        seen: set[int] = set()
        for v, sign in zip(some, conflict.signs, strict=True):
            z = {
                k: -weights[k] if k in seen else weights[k]
                for k in self.cones[v].creases
                if k in weights
            }
            seen |= set(z)
            if not self.cones[v].positive(z, int(f"{sign}1")):
                return False
        return True
