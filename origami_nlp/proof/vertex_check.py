"""The minima of a vertex, found again by a second program: boxes of balls (python-flint), with rows of its own.

Folds are quaternions about the creases of the flat sheet.  A period of C_n, or two wedges of D_n, is one product T;
mirror images are creases of one variable.  Closed is T = 1 or, where states wind w < n times, Re T = cos(w pi / n).
The axes c of T' = c T / 2 or T c / 2 are those that the sheet has where the period begins, each turned by folds on the
shorter side of it.

A minimum on a stratum has k (x - rest) = m . f', f closure.  A box goes where f is not 0; where, Z a basis of
what f' = 0 lets move, Z'k (x - rest) is not 0; where Z'(k - m . f'')Z is negative along a direction; where a crease at
its limit would leave it.  m and Z are solved for from some of the creases.  A box is contracted by cosines of folds,
which are those of the angles between the creases beside them, and by Krawczyk's operator of (x, m).

With the prover it shares lemmas, not code: that a minimum is critical, that creases on one line have one torque, and
what it takes to leave the flat state.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_mat, ctx

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


BITS = 80
"""Of balls."""
CUT = 0.487
"""Where boxes are cut: not in the middle, where states of a symmetry are."""
NARROW = 1e-9
"""Width of boxes that are not cut further, in which it is decided what is there [rad]."""
BESIDE = 1e-3
"""Nearer to what a proof leaves open it is not looked [rad]."""
WIDER = 1e-9
"""By which balls are wider than boxes at least [rad]."""
NEAR_FLAT = (1e-2, 1e-3, 1e-4)
"""Within one of these of the flat state [rad] directions are looked at, not states."""
DIRECTIONS = 200_000
"""Boxes of these."""


class _Box(NamedTuple):
    """Where variables may be, on which stratum; whether it has one critical point."""

    pins: tuple[int, ...]
    low: list[float]
    high: list[float]
    single: bool = False

    @property
    def free(self) -> list[int]:
        """Variables that are not at limits."""
        return [v for v, p in enumerate(self.pins) if not p]

    @property
    def widths(self) -> list[float]:
        """Of variables, 0 for those at limits."""
        return [b - a for a, b in zip(self.low, self.high, strict=True)]


class _Gone(Exception):
    """There is no minimum in a box."""


class VertexSearch:
    """All minima of a vertex whose states wind so often.

    Parameters
    ----------
    scene
        With linear springs.
    winding
        Of its states.
    left_open
        Fold angles between which nothing is looked for, low and high [K, 2, N].
    most
        Boxes, at most.

    Attributes
    ----------
    minima
        Fold angles [N], each once.
    rest
        Where something is left, low and high [2, N].
    """

    def __init__(self, scene: Scene, winding: int, left_open: np.ndarray, most: int) -> None:
        self.minima: list[np.ndarray] = []
        self.rest: list[np.ndarray] = []
        self.boxes, self.flat = 0, -1.0
        with ctx.workprec(BITS):
            self.period = BallPeriod(scene, winding)
            own = [self.period.of_crease.index(v) for v in range(len(self.period.rest))]
            self.left_open = left_open[:, :, own]
            flat = _Box((0,) * len(own), [0.0] * len(own), [0.0] * len(own))
            if scene.group.is_trivial and not self._is_left_open(flat):
                shown = (r for r in NEAR_FLAT if none_near_flat(self.period, r))
                self.flat = next(shown, self.flat)
            self._run(most)
            inside = all(low <= 0 <= high for low, high in self.period.limits)
            if self.flat > 0 and inside and not _falls(self.period):
                self.rest.append(np.zeros((2, scene.degree)))

    def _run(self, most: int) -> None:
        limits, front = self.period.limits, []
        for pins in itertools.product((0, 1, -1), repeat=len(limits)):
            both = [*zip(pins, limits, strict=True)]
            low = [b if p > 0 else a for p, (a, b) in both]
            front.append(_Box(pins, low, [a if p < 0 else b for p, (a, b) in both]))
        while front:
            box = front.pop()
            self.boxes += 1
            with suppress(_Gone):
                front += self._parts(box, self._contracted(box), most)

    def _parts(self, box: _Box, after: _Box, most: int) -> list[_Box]:
        """Return what is to be looked at further of a box that was contracted."""
        if self._is_left_open(after):
            return []
        widths = after.widths
        if self.boxes >= most or max(widths) < NARROW:
            self._decide(after)
            return []
        if math.prod(a / b for a, b in zip(widths, box.widths, strict=True) if b) < 0.5:
            return [after]
        v = widths.index(max(widths))
        at = after.low[v] + CUT * widths[v]
        low, high = ([*ends[:v], at, *ends[v + 1 :]] for ends in (after.low, after.high))
        return [_Box(box.pins, after.low, high), _Box(box.pins, low, after.high)]

    def _ball(self, box: _Box) -> list[Any]:
        """Return balls round a box, a little wider: else none is within what is narrowed."""
        ends = zip(box.pins, box.low, box.high, strict=True)
        return [
            self.period.end_of(v, p) if p else arb(0.5 * (a + b), 0.51 * (b - a) + WIDER)
            for v, (p, a, b) in enumerate(ends)
        ]

    def _is_left_open(self, box: _Box) -> bool:
        near = not any(box.pins) and max(*box.high, *(-a for a in box.low)) <= self.flat
        low, high = self.left_open[:, 0], self.left_open[:, 1]
        return near or bool(((low <= box.low) & (box.high <= high)).all(axis=1).any())

    def _contracted(self, box: _Box) -> _Box:
        """Return what is left of a box."""
        self._ask_twins(box)
        box = self._by_diagonals(box)
        x, free = self._ball(box), box.free
        middle = [a.mid() if v in free else a for v, a in enumerate(x)]
        over, at = self.period.look(x), self.period.look(middle)
        away = [x[v] - middle[v] for v in free]
        lean = [[over.first[v][a] for v in free] for a in range(len(over.f))]
        if not over.lift or any(
            not (dot(row, away) + f).contains(0) for row, f in zip(lean, at.f, strict=True)
        ):
            raise _Gone
        for v, row in enumerate(over.rows):
            for a, one in enumerate(row):
                by_slopes = at.rows[v][a] + dot([over.bends[v][w][a] for w in free], away)
                row[a] = min(one, by_slopes, key=lambda y: float(y.rad()))
        known = self._critical(box, x, over)
        if known is None:
            return _narrower(box, x, _zeros(at.f, lean, away))
        over_m, bent, _ = known
        m = [a.mid() for a in over_m]
        slope = [self.period.torque(v, middle[v]) - dot(m, at.rows[v]) for v in free]
        matrix = [[*bent[i], *(-a for a in over.rows[v])] for i, v in enumerate(free)]
        matrix += [[*row, *[arb(0)] * len(m)] for row in lean]
        every = away + [a - b for a, b in zip(over_m, m, strict=True)]
        moved = _zeros([*slope, *at.f], matrix, every)
        single = all(a.contains_interior(b) for a, b in zip(every, moved, strict=True))
        return _narrower(box, x, moved)._replace(single=box.single or single)

    def _critical(
        self, box: _Box, x: Sequence[Any], over: BallLook
    ) -> tuple[list[Any], list[list[Any]], bool] | None:
        """Return what a critical point is like in a box; None where closure may lose rank.

        Multipliers, k - m . f'' of free variables, and whether it is a minimum for certain.
        """
        period, free = self.period, box.free
        if len(free) < len(over.f):
            return None
        rows = arb_mat([over.rows[v] for v in free])
        solved = _solved(rows, arb_mat([[period.torque(v, x[v])] for v in free]))
        if solved is None:
            return None
        held, inverse, m = solved
        leaves = [
            p * (period.torque(v, x[v]) - dot(m, over.rows[v])) for v, p in enumerate(box.pins) if p
        ]
        if any(a > 0 for a in leaves):
            raise _Gone
        bent = [[-dot(m, over.bends[v][w]) for w in free] for v in free]
        for i, v in enumerate(free):
            bent[i][i] += period.many[v] * period.spring[v]
        move, by_held = [i for i in range(len(free)) if i not in held], rows * inverse
        basis = arb_mat(len(free), len(move))
        for j, i in enumerate(move):
            basis[i, j] = 1
            for k, h in enumerate(held):
                basis[h, j] = -by_held[i, k]
        reduced = basis.transpose() * arb_mat(bent) * basis
        if move:
            values, vectors = np.linalg.eigh(_doubles(reduced))
            way = arb_mat(vectors[:, :1].tolist())
            if values[0] < 0 and (way.transpose() * reduced * way)[0, 0] < 0:
                raise _Gone
        corners = [arb_mat([r[:k] for r in reduced.tolist()[:k]]) for k in range(1, len(move) + 1)]
        least = all(a < 0 for a in leaves) and all(c.det() > 0 for c in corners)
        return m, bent, least

    def _ask_twins(self, box: _Box) -> None:
        """Creases on one line: to turn both at once leaves everything else, so their torques are equal."""
        period, x = self.period, self._ball(box)
        for one, two, sign, closed in period.twins:
            flat = all(box.pins[v] and abs(box.low[v]) == math.pi for v in closed)
            if flat and not (box.pins[one] or box.pins[two]):
                a, b = (period.spring[v] * (x[v] - period.rest[v]) for v in (one, two))
                if not (a - sign * b).contains(0):
                    raise _Gone

    def _by_diagonals(self, box: _Box) -> _Box:
        """Contract folds by the angles between the creases beside them."""
        low, high = [*box.low], [*box.high]
        turns = [a.sin_cos() for a in self._ball(box)]
        for v, cosines, sines, start, path, end in self.period.diagonals:
            x, y, z = *start.unit, arb(0)
            for w, _, (a, b) in path:
                s, c = turns[w]
                along, aside = a * x + b * y, a * y - b * x
                aside, z = aside * c - z * s, aside * s + z * c
                x, y = a * along - b * aside, b * along + a * aside
            cosine = (cosines - dot(end.unit, (x, y))) / sines
            if cosine > 1 or cosine < -1:
                raise _Gone
            # to the doubles beyond
            least = math.nextafter(cosine.upper().acos().lower(), -1) if cosine < 1 else 0.0
            most = math.nextafter(cosine.lower().acos().upper(), 9) if cosine > -1 else math.inf
            if not box.pins[v]:
                low[v], high[v] = max(low[v], -most), min(high[v], most)
                low[v] = max(low[v], least) if low[v] > -least else low[v]
                high[v] = min(high[v], -least) if high[v] < least else high[v]
                if low[v] > high[v]:
                    raise _Gone
                turns[v] = arb(low[v]).union(arb(high[v])).sin_cos()
        return box._replace(low=low, high=high)

    def _decide(self, box: _Box) -> None:
        """Note a minimum, or that something is left."""
        of_crease = self.period.of_crease
        x = self._ball(box)
        known = self._critical(box, x, self.period.look(x))
        if box.single and known is not None and known[2]:
            state = np.array([float(x[v].mid()) for v in of_crease])
            if not any(np.abs(state - y).max() < 2 * NARROW for y in self.minima):
                self.minima.append(state)
        else:
            self.rest.append(np.array([box.low, box.high])[:, of_crease])


def none_near_flat(period: BallPeriod, radius: float) -> bool:
    """Return whether no critical point x = t u, |u| = 1 (largest entry), 0 < t <= radius, is near the flat state.

    There f = O(t), but its last part and that of f' O(t^2) and O(t): divided by these all are means of derivatives over
    [0, x].  With multipliers (m_1, m_2, m_3 / t) what is critical stays so.
    """
    n = len(period.rest)
    front = [
        ([-1.0] * v + [s] + [-1.0] * (n - v - 1) + [0.0], [1.0] * v + [s] + [1.0] * (n - v))
        for v in range(n)
        for s in (-1.0, 1.0)
    ]
    for _ in range(DIRECTIONS):
        if not front:
            return True
        low, high = front.pop()
        *u, t = (arb(a).union(arb(b)) for a, b in zip(low, high, strict=True))
        if _is_closed_and_critical(period, u, t * radius):
            widths = [b - a for a, b in zip(low, high, strict=True)]
            v = widths.index(max(widths))
            at = 0.5 * (low[v] + high[v])
            front += [([*low[:v], at, *low[v + 1 :]], high), (low, [*high[:v], at, *high[v + 1 :]])]
    return False


def _is_closed_and_critical(period: BallPeriod, u: Sequence[Any], t: Any) -> bool:
    """Return whether there may be a critical point in directions, at distances."""
    over = period.look([arb(0).union(t.upper()) * a for a in u], exact=True)
    tilt = [dot([b[2] for b in row], u) for row in over.bends]
    f = [dot([row[a] for row in over.first], u) for a in (0, 1)]
    rows = arb_mat([[*row[:2], z] for row, z in zip(over.first, tilt, strict=True)])
    torque = [[period.torque(v, t * a)] for v, a in enumerate(u)]
    with suppress(_Gone):
        _solved(rows, arb_mat(torque))
        return all(a.contains(0) for a in (*f, dot(tilt, u)))
    return False


def _falls(period: BallPeriod) -> bool:
    """Return whether the energy falls from the flat state along a curve.

    It does where the last part of f is positive along one direction that closes otherwise, and negative along another,
    and the energy falls along both, or along their opposites: so it does along one between them, which closes.
    """
    n, rng = len(period.rest), np.random.default_rng(0)
    flat = period.look([arb(0)] * n, exact=True)
    torque = [period.torque(v, arb(0)) for v in range(n)]
    sides = set[bool]()
    held = arb_mat([[row[a] for row in flat.first[:2]] for a in (0, 1)])
    for some in rng.normal(size=(100, n - 2)).tolist():
        left = [[-dot([row[a] for row in flat.first[2:]], some)] for a in (0, 1)]
        u = [*held.solve(arb_mat(left)).entries(), *some]
        curved = dot(u, [dot([b[2] for b in row], u) for row in flat.bends])
        if dot(torque, u) != 0 and curved != 0:
            sides.add(bool(curved > 0))
    return len(sides) == 2


def _solved(rows: Any, torque: Any) -> tuple[tuple[int, ...], Any, list[Any]] | None:
    """Return which rows are solved for multipliers, their inverse, and these; None where they may be dependent."""
    ways = [*itertools.combinations(range(rows.nrows()), rows.ncols())]
    held = ways[int(np.argmax(np.abs(np.linalg.det(_doubles(rows)[ways, :]))))]
    both = rows.tolist(), torque.tolist()
    try:
        inverse = arb_mat([both[0][i] for i in held]).inv()
    except ZeroDivisionError:
        return None
    m = inverse * arb_mat([both[1][i] for i in held])
    if not (rows * m - torque).contains(arb_mat(len(both[0]), 1)):
        raise _Gone
    return held, inverse, m.entries()


def _doubles(matrix: Any) -> np.ndarray:
    """Return the middles of the entries of a matrix."""
    shape = matrix.nrows(), matrix.ncols()
    return np.array([float(a.mid()) for a in matrix.entries()]).reshape(shape)


def _zeros(f: Sequence[Any], slopes: Sequence[Sequence[Any]], away: Sequence[Any]) -> list[Any]:
    """Return where zeros of f are from the middle: in -Y f + (1 - Y f') away, whatever Y."""
    if not away:
        return []
    matrix, n = arb_mat([*map(list, slopes)]), len(away)
    inverse = arb_mat(np.linalg.pinv(_doubles(matrix)).tolist())
    one = arb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)])
    rest = (one - inverse * matrix) * arb_mat([[a] for a in away])
    return list((rest - inverse * arb_mat([[a] for a in f])).entries())


def _narrower(box: _Box, x: Sequence[Any], moved: Sequence[Any]) -> _Box:
    """Return what a box has in common with the middle of balls and what is away from it."""
    low, high = [*box.low], [*box.high]
    for v, by in zip(box.free, moved, strict=False):
        there = x[v].mid() + by
        low[v] = max(low[v], math.nextafter(float(there.lower()), -9))
        high[v] = min(high[v], math.nextafter(float(there.upper()), 9))
        if not low[v] <= high[v]:
            raise _Gone
    return box._replace(low=low, high=high)
