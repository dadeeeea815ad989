"""Closure of a vertex over balls (python-flint), for the program that finds lists again (`vertex_check`).

Folds are quaternions about the creases of the flat sheet.  A period of C_n, or two wedges of D_n, is one product T;
mirror images are creases of one variable.  Closed is T = 1 or, where states wind w < n times, Re T = cos(w pi / n).
The axes c of T' = c T / 2 or T c / 2 are those that the sheet has where the period begins, each turned by folds on the
shorter side of it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from flint import arb

from origami_nlp.pattern import Scene

ONE_LINE = 1e-14
"""Directions of creases that differ by less are one [rad]."""

Quaternion = Sequence[Any]


def _times(p: Quaternion, q: Quaternion) -> list[Any]:
    a, b, c, d = p
    e, f, g, h = q
    return [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]


def _turned(q: Quaternion, u: Sequence[Any]) -> list[Any]:
    """Turn a vector in the plane of the sheet, to a quaternion."""
    w, x, y, z = q
    a, b = u
    return [
        arb(0),
        a * (1 - 2 * (y * y + z * z)) + 2 * b * (x * y - w * z),
        2 * a * (x * y + w * z) + b * (1 - 2 * (x * x + z * z)),
        2 * a * (x * z - w * y) + 2 * b * (y * z + w * x),
    ]


class Fold(NamedTuple):
    """A crease of the period: its variable, how much of it the period has, its direction in the sheet."""

    variable: int
    share: float
    unit: tuple[Any, Any]


class BallLook(NamedTuple):
    """Over balls: f [r], which is 0 where it closes, and f' [n][r]; f' as it is there [n][r], and its slopes [n][n][r];
    whether T may be 1, and not only -1."""

    f: list[Any]
    first: list[list[Any]]
    rows: list[list[Any]]
    bends: list[list[list[Any]]]
    lift: bool


Diagonal = tuple[int, Any, Any, Fold, tuple[Fold, ...], Fold]
"""A fold x, and cos a cos b and sin a sin b, by which the creases beside it are apart: cos a cos b - sin a sin b cos x;
the way from one of these to the other by all other folds."""
Twins = tuple[int, int, int, frozenset[int]]
"""Creases on one line while those between are at +-180 degrees: variables, whether they point to one side."""


class BallPeriod:
    """What closes of a scene: the folds of a period in order; springs and limits of its variables."""

    def __init__(self, scene: Scene, winding: int) -> None:
        group, pi = scene.group, arb.pi()
        n, creases = group.order, [r.crease for r in group.rays]
        own = [c for c in creases if c is not None]
        at = [arb(0)]
        for ray in group.rays[:-1]:
            at.append(at[-1] + ray.sector)
        folds = [(c, 1.0, a) for c, a in zip(creases, at, strict=True)]
        if group.kind == "D":
            folds[0], folds[-1] = (creases[0], 0.5, at[0]), (creases[-1], 1.0, pi / n)
            folds += [(c, s, 2 * pi / n - a) for c, s, a in folds[-2::-1]]
        self.folds = [
            Fold(own.index(c), s, (a.cos(), a.sin())) for c, s, a in folds if c is not None
        ]
        self.half = (len(self.folds) + 1) // 2
        whole = winding == n
        # mirror images leave T in the plane of the mirror
        self.parts = (0,) if not whole else (1, 3) if group.kind == "D" else (1, 2, 3)
        self.level = arb(0) if whole else (winding * pi / n).cos()
        about = pi / n - pi * whole
        self.end = [about.cos(), arb(0), arb(0), about.sin()]
        most = max(scene.stiffness)
        self.spring = [arb(scene.stiffness[c]) / most for c in own]
        self.rest = [arb(scene.wound_angles[c]) for c in own]
        self.many = [sum(f.share for f in self.folds if f.variable == v) for v in range(len(own))]
        self.limits = [scene.limit_angles[:, c].tolist() for c in own]
        self.of_crease = [r - creases[:r].count(None) for r in group.orbit]
        self.diagonals = list(_diagonals(self.folds)) if n == 1 else []
        self.twins = list(_twins(scene, self.of_crease))

    def end_of(self, v: int, side: int) -> Any:
        """Return the limit of a variable on a side."""
        limit = self.limits[v][side > 0]
        return side * arb.pi() if abs(limit) == math.pi else arb(limit)

    def torque(self, v: int, x: Any) -> Any:
        """Return that of all its creases in the period."""
        return self.many[v] * self.spring[v] * (x - self.rest[v])

    def look(self, x: Sequence[Any], exact: bool = False) -> BallLook:
        """Return closure over balls; rows are f' everywhere if `exact`."""
        zero, half = arb(0), self.half
        turns = []
        for v, share, (a, b) in self.folds:
            s, c = (x[v] * (0.5 * share)).sin_cos()
            turns.append([c, a * s, b * s, zero])
        axes: list[list[Any]] = []
        on: Quaternion = [arb(1), zero, zero, zero]
        for fold, turn in zip(self.folds[:half], turns, strict=False):
            axes.append(_turned(on, fold.unit))
            on = _times(on, turn)
        back: Quaternion = self.end
        for p in range(len(turns) - 1, half - 1, -1):
            back = _times(turns[p], back)
            axes.insert(half, _turned([back[0], *(-y for y in back[1:])], self.folds[p].unit))
        t = _times(on, back)
        moved = [_times(c, t) if i < half else _times(t, c) for i, c in enumerate(axes)]
        n, parts = len(self.rest), self.parts
        first, rows = ([[zero] * len(parts) for _ in range(n)] for _ in range(2))
        bends = [[[zero] * len(parts) for _ in range(n)] for _ in range(n)]
        exact = exact or parts == (0,)
        for i, (v, share, _) in enumerate(self.folds):
            for a, part in enumerate(parts):
                first[v][a] += 0.5 * share * moved[i][part]
                rows[v][a] += 0.5 * share * (moved if exact else axes)[i][part]
                bends[v][v][a] -= 0.25 * share * share * t[part] * exact
            for j in range(i + 1, len(axes)):
                w, other, _ = self.folds[j]
                if exact:
                    both = _times(axes[i], moved[j]) if i < half else _times(moved[i], axes[j])
                    places = [(v, w), (w, v)]
                elif (i < half) == (j < half):
                    both, places = _times(axes[i], axes[j]), [(w, v) if i < half else (v, w)]
                else:
                    continue
                for (x1, x2), (a, part) in itertools.product(places, enumerate(parts)):
                    bends[x1][x2][a] += 0.5 / len(places) * share * other * both[part]
        f = [t[part] - self.level for part in parts]
        return BallLook(f, first, rows, bends, parts == (0,) or not t[0] < 0)


def _diagonals(folds: Sequence[Fold]) -> Iterator[Diagonal]:
    """Go through the creases of a whole vertex, between two on each side of them."""
    ring = folds[:-1] if folds[0].share < 1 else folds  # a crease on the mirror is there twice
    n = len(ring)
    for i in range(n):
        before, at, after = (ring[(i + s) % n] for s in (-1, 0, 1))
        (a, b), (c, d), (e, f) = before.unit, at.unit, after.unit
        cosines, sines = (a * c + b * d) * (c * e + d * f), (a * d - b * c) * (c * f - d * e)
        if sines > 0:
            path = tuple(ring[(i + s) % n] for s in range(n - 2, 1, -1))
            yield at.variable, cosines, sines, before, path, after


def _twins(scene: Scene, of_crease: Sequence[int]) -> Iterator[Twins]:
    n, sectors = scene.degree, [arb(a) for a in scene.vertex.sector_angles]
    for first, many in itertools.product(range(n), range(1, n)):
        way = sum(((-1) ** i * sectors[(first + i) % n] for i in range(many)), arb(0))
        closed = frozenset(of_crease[(first + i) % n] for i in range(1, many))
        one, two = of_crease[first], of_crease[(first + many) % n]
        sign = 1 if way.cos() > 0 else -1
        if abs(way.sin()) < ONE_LINE and not closed & {one, two} and (one != two or sign < 0):
            yield one, two, sign, closed


def dot(u: Sequence[Any], v: Sequence[Any]) -> Any:
    """Return the sum of products."""
    return sum((a * b for a, b in zip(u, v, strict=True)), arb(0))
