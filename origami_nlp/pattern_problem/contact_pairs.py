"""The gap between two features of facets that can meet, with its first and second derivatives in the fold angles.

Seen from one facet, the other one is carried by the creases of a walk between them.  With c_i the axis of crease i
where the state has brought it and o_i a point on it, a point p that is carried and a vector v that is carried obey

    dp/dphi_i = c_i x (p - o_i),                dv/dphi_i = c_i x v,
    d2p/dphi_i dphi_j = c_i x (c_j x (p - o_j)),  and so for v                   (i before j in the walk).

The gap of a corner p over a facet with the unit normal n through a is n . (p - a), where n and a stay.  That of two
sides with directions u (stays) and v (is carried), r from a point of one to a point of the other, is
r . (u x v) / |u x v|.
On closed states the gap does not depend on the walk.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from origami_nlp.numerics import INSIDE, cross
from origami_nlp.pattern_problem.poses import Poses

RUN_ALONG = "two sides that face each other run along each other"


class Parallel(ArithmeticError):
    """Two sides whose gap is asked for run along each other: there is none."""


class FoldedGeometry:
    """A pattern at a closed state in space.

    Parameters
    ----------
    poses
        Of the pattern.
    phi
        Fold angles [rad], [n].

    Attributes
    ----------
    turn, shift
        Motions of facets, [F, 3, 3] and [F, 3].
    axes, origins
        Directions of creases and points on them, [n, 3].
    """

    def __init__(self, poses: Poses, phi: np.ndarray) -> None:
        p = poses.pattern
        self.poses = poses
        self.turn, self.shift = poses.motions(phi)
        # the left facet holds its crease: either one would do at a closed state
        self.axes = np.einsum("nij,nj->ni", self.turn[p.left], p.directions)
        ends = p.corners[p.ends[:, 0]]
        self.origins = np.einsum("nij,nj->ni", self.turn[p.left], ends) + self.shift[p.left]

    @cached_property
    def moments(self) -> np.ndarray:
        """Moments of the creases' axes about the origin, [n, 3]."""
        return cross(self.axes, self.origins)

    def points(self, facets: np.ndarray, corners: np.ndarray) -> np.ndarray:
        """Return corners as carried by facets, one each, [k, 3]."""
        x = self.poses.pattern.corners[corners]
        return np.einsum("kij,kj->ki", self.turn[facets], x) + self.shift[facets]

    def walk(self, a: int, b: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return creases [k], axes by which they carry facet b seen from facet a, and points on them, [k, 3]."""
        steps = self.poses.path(a, b)
        creases = np.array([c for c, _ in steps], int)
        signs = np.array([s for _, s in steps])
        return creases, signs[:, None] * self.axes[creases], self.origins[creases]


@dataclass(frozen=True)
class ContactPair:
    """Two features of facets that can meet.

    Attributes
    ----------
    type
        ``"vertex-face"`` (the first corner over the triangle of the others) or ``"edge-edge"`` (two and two).
    facets
        The one that is taken to stay (that of the triangle, or of the first side), and the other.
    corners
        Of the pattern: vertex and triangle, or two ends and two ends, [4].
    sign
        +1 or -1, so that the gap is positive where facets are apart.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> from origami_nlp.pattern_problem import FoldedGeometry, PatternProblem, ContactPair
    >>> problem = PatternProblem(o.examples.pattern("miura", 1, 3))
    >>> problem.pattern.polygons[0], problem.pattern.polygons[2]
    ((0, 1, 2, 3), (4, 6, 7, 5))
    >>> touch = ContactPair("vertex-face", (0, 2), (7, 0, 1, 2), 1.0)
    >>> at = FoldedGeometry(problem.crossings.poses, np.array([0.3, 0.2]))
    >>> creases, slopes = touch.slopes(at)
    >>> creases.tolist(), len(slopes), touch.bends(at).shape
    ([0, 1], 2, (2, 2))
    """

    type: Literal["vertex-face", "edge-edge", "face-face"]
    facets: tuple[int, int]
    corners: tuple[int, int, int, int]
    sign: float

    @property
    def key(self) -> tuple[object, ...]:
        """What distinguishes it from others: a corner and a facet, or two sides, of whichever facets they are taken."""
        a, b, c, d = self.corners
        if self.type == "vertex-face":
            return self.facets[0], a
        return tuple(sorted(((min(a, b), max(a, b)), (min(c, d), max(c, d)))))

    @property
    def owners(self) -> tuple[int, int, int, int]:
        """The facets that carry its four points."""
        i, j = self.facets
        return (i, i, j, j) if self.type == "edge-edge" else (j, i, i, i)

    def reference(self, corners: np.ndarray) -> np.ndarray:
        """Return its four points in the reference state, of the pattern's corners [V, 3], [4, 3]."""
        return corners[list(self.corners)]

    def points(self, at: FoldedGeometry) -> np.ndarray:
        """Return its four points in space, [4, 3]."""
        return at.points(np.array(self.owners), np.array(self.corners))

    def place_in_space(self, at: FoldedGeometry) -> np.ndarray:
        """Return where its features meet, [3]: its corner, or the point of one side that is nearest to the other."""
        p = self.points(at)
        if self.type != "edge-edge":
            return p[0]
        u, v = p[1] - p[0], p[3] - p[2]
        w = cross(u, v)
        return p[0] + u * float(cross(p[2] - p[0], v) @ w) / float(w @ w)

    def gap(self, at: FoldedGeometry) -> float:
        """Return the distance along the common normal, positive where facets are apart [unit of the corners].

        Raises
        ------
        Parallel
            If two sides have no common normal; so do `slopes` and `bends`.
        """
        p = self.points(at)
        if self.type != "edge-edge":
            normal, off = cross(p[2] - p[1], p[3] - p[1]), p[0] - p[1]
        else:
            # |gap| is the distance of two lines; the volume r . (u x v) changes sign as they intersect
            normal, off = _across(p[1] - p[0], p[3] - p[2]), p[2] - p[0]
        return self.sign * float(off @ normal) / float(np.linalg.norm(normal))

    def creases(self, at: FoldedGeometry) -> np.ndarray:
        """Return the variables that creases of the walk from one facet to the other follow, [k]."""
        return at.poses.own([c for c, _ in at.poses.path(*self.facets)])

    def slopes(self, at: FoldedGeometry) -> tuple[np.ndarray, np.ndarray]:
        """Return the creases of the walk and the derivative of the gap by each, [k] and [k]."""
        creases = self.creases(at)
        return creases, self.row(at)[creases]

    def bends(self, at: FoldedGeometry) -> np.ndarray:
        """Return the second derivatives of the gap by what the creases of the walk follow, [k, k]."""
        steps, c, o = at.walk(*self.facets)
        # the axis of a crease that follows the opposite is turned
        c = at.poses.signs(steps.tolist())[:, None] * c
        p = self.points(at)
        if self.type != "edge-edge":
            normal = cross(p[2] - p[1], p[3] - p[1])
            normal /= np.linalg.norm(normal)
            # n . (c_i x (c_j x (p - o_j))) = (n x c_i) . (c_j x (p - o_j)), i before j
            return self.sign * _mirrored(cross(normal, c) @ cross(c, p[0] - o).T)
        u, v, r = p[1] - p[0], p[3] - p[2], p[2] - p[0]
        w = _across(u, v)
        d, volume = float(np.linalg.norm(w)), float(r @ w)
        arms, turned = cross(c, p[2] - o), cross(c, v)
        across, base, beside = cross(u, turned), cross(r, u), cross(w, u)
        # t, s: first derivatives of V and d; tt, ss: second ones; then the quotient rule twice
        t = arms @ w + turned @ base
        s = turned @ beside / d
        tt = _mirrored(cross(w, c) @ arms.T + cross(base, c) @ turned.T)
        tt += arms @ across.T + across @ arms.T
        ss = (_mirrored(cross(beside, c) @ turned.T) + across @ across.T) / d - np.outer(s, s) / d
        both = np.outer(t, s)
        bent = tt / d - (both + both.T + volume * ss) / d**2 + 2 * volume * np.outer(s, s) / d**3
        return self.sign * bent

    def row(self, at: FoldedGeometry) -> np.ndarray:
        """Return the derivative of the gap by every fold angle, [n]."""
        row: np.ndarray = gaps_and_rows([self], at)[1][0]
        return row


def gaps_and_rows(
    touches: Sequence[ContactPair], at: FoldedGeometry
) -> tuple[np.ndarray, np.ndarray]:
    """Return the gaps of touches, [k], and their derivatives by every fold angle, [k, n]; see `ContactPair.gap`."""
    if at.poses.compiled is not None:
        made = at.poses.gaps_in_c(touches, at.turn, at.shift)
        if made is None:
            raise Parallel(RUN_ALONG)
        return made[0], at.poses.gathered(made[1])
    first, second = np.array([t.facets for t in touches], int).T
    sides = np.array([t.type == "edge-edge" for t in touches])
    owners = np.column_stack(
        [np.where(sides, first, second), first, *[np.where(sides, second, first)] * 2]
    )
    p = at.points(owners.ravel(), np.array([t.corners for t in touches]).ravel()).reshape(-1, 4, 3)
    for k, touch in enumerate(touches):
        if touch.type == "face-face":
            p[k] = touch.points(at)
    whole = np.where(sides, 0, 1)[:, None]
    u, v = p[:, 1] - p[:, 0], p[:, 3] - p[:, 2]
    normal = np.where(whole, cross(p[:, 2] - p[:, 1], p[:, 3] - p[:, 1]), cross(u, v))
    size = np.linalg.norm(normal, axis=1)
    lengths = np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1)
    if (sides & ~(size > INSIDE * lengths)).any():
        raise Parallel(RUN_ALONG)
    normal /= size[:, None]
    r = np.where(whole, -u, p[:, 2] - p[:, 0])
    gap = np.einsum("ki,ki->k", r, normal)
    # c x (p - o) . n = c . (p x n) - (c x o) . n, of the point that is carried; the direction of a side is carried too:
    # with n = w / d of unit length, d(V / d) has the terms c . (v x (r x u)) / d and -V c . (v x (w x u)) / d^3
    turned = cross(np.where(whole, p[:, 0], p[:, 2]), normal)
    beside = cross(v, cross(r, u) - gap[:, None] * cross(normal, u)) / size[:, None]
    turned += np.where(whole, 0.0, beside)
    sign = np.array([t.sign for t in touches])
    senses = np.array(
        [at.poses.senses(a, b) for a, b in zip(first.tolist(), second.tolist(), strict=True)]
    )
    rows = sign[:, None] * senses * (turned @ at.axes.T - normal @ at.moments.T)
    return sign * gap, at.poses.gathered(rows)


def _across(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the common normal u x v of two sides."""
    w = cross(u, v)
    if not np.linalg.norm(w) > INSIDE * np.linalg.norm(u) * np.linalg.norm(v):
        raise Parallel(RUN_ALONG)
    out: np.ndarray = w
    return out


def _mirrored(upper: np.ndarray) -> np.ndarray:
    """Return the symmetric matrix with the upper triangle of another."""
    upper = np.triu(upper)
    return upper + np.triu(upper, 1).T
