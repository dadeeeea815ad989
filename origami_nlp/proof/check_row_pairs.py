"""Three parts in a row between parallel lines, about which the outer two turn: where these cross, for a check.

With u = cot(x/2) and v = cot(y/2) of the folds x and y, both from 0 to 180 degrees to one side, the lines of the outer
parts meet, in the cross section and for x + y > pi, at s = -w sin y / sin(x + y) and t = -w sin x / sin(x + y) from
those of the rows.  Convex parts cross where s and t are below their widths and every right side of one is right of
every left side of the other there: where all polynomials

    P = (a + c) u + (a + b) v + (c - a) u v^2 + (b - a) u^2 v > 0,   of   a + (b/w) s + (c/w) t > 0

hold.  In 1/u or 1/v coefficients change places alone; where some are 0 what is left has a factor u or v, which is left
away.  Boxes of u or 1/u and v or 1/v, all from 0 to 1, are cut until in each some P < 0, or all P > 0, or, of each P
that may be 0, gradients of P and the energy U say that no state with P = 0 is least among those with P <= 0; or until a
step of Newton shows that there is one.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from flint import arb

Point: TypeAlias = complex
Powers: TypeAlias = dict[tuple[int, int], Any]
"""A polynomial: its coefficients by the powers of u and v."""
Charts: TypeAlias = tuple[int, int]
"""1 where 1/u, or 1/v, is the variable."""
CUT = 30
"""Halvings of a side of a box, at most."""
LOOKED = 20_000
"""Boxes of a pair that are looked at, at most."""
SMALL = 5
"""Halvings from which a root is looked for."""


def sign(x: Any) -> int:
    """Return the sign of a ball, 0 where it is not certain."""
    return 1 if x > 0 else -1 if x < 0 else 0


def _sides(hull: Sequence[Point], room: float) -> list[tuple[int, float, float]]:
    """Return the left (-1) and right (1) sides of a convex polygon: where they begin at height 0, and lean to."""
    found = []
    for p, q in zip(hull, [*hull[1:], hull[0]], strict=True):
        if abs((q - p).imag) > room:
            lean = (q - p).real / (q - p).imag
            found.append((1 if q.imag > p.imag else -1, p.real - lean * p.imag, lean))
    return found


def crossing(
    width: float, below: Sequence[Point], above: Sequence[Point], room: float
) -> list[Powers]:
    """Return polynomials that are all positive where two parts cross, convex polygons over the real axis."""
    tops = [max(z.imag for z in hull) for hull in (below, above)]
    three = [(tops[0], -width, 0.0), (tops[1], 0.0, -width)]
    for (one, x, lean), (two, y, slope) in itertools.product(
        _sides(below, room), _sides(above, room)
    ):
        if one != two:
            three.append((one * (x - y), one * lean * width, -one * slope * width))
    found = []
    for a, b, c in three:
        if max(map(abs, (a, b, c))) <= room:
            return [{(0, 0): arb(-1)}]  # side by side
        terms = {(1, 0): a + c, (0, 1): a + b, (1, 2): c - a, (2, 1): b - a}
        found.append({k: arb(x, room) for k, x in terms.items() if abs(x) > room})
    return found


class CheckedRow:
    """The energy of a row of creases that turn alike: stiffness times (fold^2/2 - rest fold), as fractions."""

    def __init__(self, stiffness: Fraction, load: Fraction) -> None:
        self.k, self.load = (arb(x.numerator) / x.denominator for x in (stiffness, load))

    def slopes(self, chart: int, u: Any) -> tuple[Any, Any]:
        """Return U' and U'' by u = cot of half the fold, or (chart 1) by its tangent."""
        way = 2 if chart else -2
        fold = 2 * u.atan() if chart else arb.pi() - 2 * u.atan()
        rate = way / (1 + u * u)
        torque = self.k * fold - self.load
        return torque * rate, self.k * rate * rate - torque * rate * 2 * u / (1 + u * u)


class CheckedPair:
    """Two rows that fold by themselves.

    Parameters
    ----------
    polynomials
        Parts cross where all are positive.
    rows
        Of u and v.
    """

    def __init__(self, polynomials: list[Powers], rows: tuple[CheckedRow, CheckedRow]) -> None:
        self.polynomials, self.rows = polynomials, rows
        self.boxes = 0

    def _in(self, charts: Charts) -> list[Powers]:
        """Return the polynomials by u or 1/u and v or 1/v, without factors of these."""
        found = []
        for powers in self.polynomials:
            flipped = {
                (2 - i if charts[0] else i, 2 - j if charts[1] else j): c
                for (i, j), c in powers.items()
            }
            least = [min(k[n] for k in flipped) for n in (0, 1)]
            found.append({(i - least[0], j - least[1]): c for (i, j), c in flipped.items()})
        return found

    def known(self, x: Any, y: Any) -> int:
        """Return 1 where parts cross at folds, or beside them where these are 0 or pi; -1 where they do not; or 0."""
        charts, at = [], []
        for fold in (x, y):
            flat = bool(fold < 2)
            charts.append(int(flat))
            turned = fold if flat else arb.pi() - fold
            at.append(arb(0) if turned.contains(0) else (turned / 2).tan())
        signs = [sign(_value(p, at)) for p in self._in((charts[0], charts[1]))]
        return -1 if -1 in signs else 0 if 0 in signs else 1

    def falls(self, charts: Charts) -> bool | None:
        """Return whether the energy falls as both rows leave 180 degrees (chart 0) or 0 where parts do not cross."""
        slopes = [row.slopes(c, arb(0))[0] for c, row in zip(charts, self.rows, strict=True)]
        down = [sign(z) for z in slopes]
        if 0 in down:
            return None
        verdicts: list[bool | None] = []
        for p in self._in(charts):
            if (0, 0) in p:
                side = sign(p[0, 0])
                verdicts.append(None if not side else side < 0 and -1 in down)
                continue
            # P <= 0 between rays: axes where it is, and that where it is 0
            ends = [p.get((1, 0), arb(0)), p.get((0, 1), arb(0))]
            rays = [(arb(1 - n), arb(n)) for n in (0, 1) if ends[n] < 0]
            if sign(ends[0]) * sign(ends[1]) < 0:
                rays.append((abs(ends[1]), abs(ends[0])))
            elif not sign(ends[0]) or not sign(ends[1]):
                verdicts.append(None)
                continue
            steps = [sign(a * slopes[0] + b * slopes[1]) for a, b in rays]
            verdicts.append(True if -1 in steps else None if 0 in steps else False)
        return True if True in verdicts else None if None in verdicts else False

    def held(self) -> tuple[list[tuple[Any, Any]], bool]:
        """Return the folds x, y at which parts meet and the energy is least; and whether these are all."""
        found: list[tuple[Any, Any]] = []
        whole, looked = True, 0
        for charts in ((0, 0), (0, 1), (1, 0), (1, 1)):
            polynomials = self._in(charts)
            front = [(0.0, 0.0, 0)]
            while front:
                a, b, depth = front.pop()
                looked += 1
                size = 0.5**depth
                left = self._left(polynomials, charts, a, b, size)
                if not left:
                    continue
                if depth >= SMALL and len(left) == 1:
                    root = self._root(polynomials, left[0], charts, a, b, size)
                    if root is not None:
                        found += [_folds(charts, r) for r in (root,) if r]
                        continue
                if depth == CUT or looked > LOOKED:
                    whole = False
                    continue
                front += [
                    (a + i * size / 2, b + j * size / 2, depth + 1) for i in (0, 1) for j in (0, 1)
                ]
        self.boxes += looked
        apart: list[tuple[Any, Any]] = []
        for x, y in found:
            if not any(x.overlaps(z) and y.overlaps(w) for z, w in apart):
                apart.append((x, y))
        return apart, whole

    def _left(
        self, polynomials: list[Powers], charts: Charts, a: float, b: float, size: float
    ) -> list[int]:
        """Return the polynomials of which a least state with P = 0 may be in a box."""
        u, v = (arb(z).union(arb(z + size)) for z in (a, b))
        middle = arb(a + size / 2), arb(b + size / 2)
        away = arb(0, size / 2)
        signs, gradients = [], []
        for p in polynomials:
            slopes = _value(p, (u, v), 1, 0), _value(p, (u, v), 0, 1)
            value = sign(_value(p, middle) + slopes[0] * away + slopes[1] * away)
            if not value and a == b == 0 and (0, 0) not in p:
                # from 0 in the corner
                value = sign(slopes[0]) if sign(slopes[0]) == sign(slopes[1]) else 0
            signs.append(value)
            gradients.append(slopes)
        if -1 in signs:
            return []
        left = []
        for k, (x, y) in enumerate(gradients):
            if signs[k]:
                continue
            e, f = (
                row.slopes(c, z)[0] for row, c, z in zip(self.rows, charts, (u, v), strict=True)
            )
            _, _, (d, d_u, d_v) = self._system(polynomials[k], charts, u, v)
            at = self._system(polynomials[k], charts, *middle)[2][0]
            stationary = not sign(d) and not sign(at + d_u * away + d_v * away)
            if stationary and not e * x + f * y > 0 and not x * d_v - y * d_u > 0:
                left.append(k)
        return left

    def _system(
        self, p: Powers, charts: Charts, u: Any, v: Any
    ) -> tuple[Any, tuple[Any, Any], tuple[Any, Any, Any]]:
        """Return P, its slopes, and U_u P_v - U_v P_u with its slopes."""
        (e, ee), (f, ff) = (
            row.slopes(c, z) for row, c, z in zip(self.rows, charts, (u, v), strict=True)
        )
        x, y = _value(p, (u, v), 1, 0), _value(p, (u, v), 0, 1)
        xx, xy, yy = (_value(p, (u, v), *ij) for ij in ((2, 0), (1, 1), (0, 2)))
        d = e * y - f * x
        return _value(p, (u, v)), (x, y), (d, ee * y + e * xy - f * xx, e * yy - ff * x - f * xy)

    def _root(
        self,
        polynomials: list[Powers],
        k: int,
        charts: Charts,
        a: float,
        b: float,
        size: float,
    ) -> tuple[Any, ...] | None:
        """Return u, v of the least state with P = 0 in a box, () if it has none; None: not decided."""
        # somewhat larger: a state on the border of a box is inside one of them
        box = [arb(z + size / 2, 0.75 * size) for z in (a, b)]
        own = [arb(z).union(arb(z + size)) for z in (a, b)]
        for step in range(60):
            _, (x, y), (_, d_u, d_v) = self._system(polynomials[k], charts, *box)
            if not x * d_v - y * d_u < 0:
                return None
            middle = [arb(z.mid()) for z in box]
            value, _, (d, _, _) = self._system(polynomials[k], charts, *middle)
            whole = x * d_v - y * d_u
            shift = (d_v * value - y * d) / whole, (x * d - d_u * value) / whole
            new = [m - z for m, z in zip(middle, shift, strict=True)]
            if not step:
                if not all(n.overlaps(z) for n, z in zip(new, own, strict=True)):
                    return ()
                if not all(z.contains_interior(n) for n, z in zip(new, box, strict=True)):
                    return None
            before = [z.rad() for z in box]
            box = [n.intersection(z) for n, z in zip(new, box, strict=True)]
            if not any(z.rad() < 0.9 * r for z, r in zip(box, before, strict=True)):
                break
        others = [sign(_value(p, box)) for i, p in enumerate(polynomials) if i != k]
        if -1 in others:
            return ()
        _, (x, y), _ = self._system(polynomials[k], charts, *box)
        e, f = (row.slopes(c, z)[0] for row, c, z in zip(self.rows, charts, box, strict=True))
        pressed = sign(e * x + f * y)
        if pressed > 0:
            return ()
        if not pressed or 0 in others or not all(z > 0 for z in box):
            return None
        return tuple(box)


def _value(p: Powers, at: Sequence[Any], i: int = 0, j: int = 0) -> Any:
    """Return a derivative of a polynomial, i times by u and j times by v."""
    u, v = at
    total = arb(0)
    for (m, n), c in p.items():
        if m >= i and n >= j:
            total += c * math.perm(m, i) * math.perm(n, j) * u ** (m - i) * v ** (n - j)
    return total


def _folds(charts: Charts, root: Sequence[Any]) -> tuple[Any, Any]:
    x, y = (
        2 * z.atan() if c else arb.pi() - 2 * z.atan() for c, z in zip(charts, root, strict=True)
    )
    return x, y
