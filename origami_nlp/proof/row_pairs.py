"""Two parallel rows that fold by themselves, by which three blocks hang together: where the outer two cross or meet.

Let p, q in (0, pi) be the angles between the middle block, of width w, and the outer ones, on one side of it.  Seen
along the rows these cross at distances s = w sin q / sin(p + q) and t = w sin p / sin(p + q) from them, for p + q < pi,
if both have paper there, in one place.  Of outer blocks that are trapezia each condition is, times sin(p + q) > 0,

    f = alpha sin(p + q) + beta sin q + gamma sin p > 0,

and they cross where all of these hold: s < a and t < b, their widths, and two ends beyond each other.  So what is
free is a union of sets f <= 0.  A state where facets meet is a least one only if it is one of each such set with f = 0:
where two of these meet it would be stationary.  With (x, y) = (p, q)/2 in [0, pi/2]^2 boxes are halved until in each

- some f < 0, or all are positive, or
- for each f that may be 0, U_x f_y - U_y f_x, or U_x f_x + U_y f_y > 0, say that the energy U falls along f = 0 or
  away from it, or U is largest along it; or the equations f = 0 = U_x f_y - U_y f_x have one root, which is listed.

Where lengths are equal f vanishes at a border, x = 0 or y = 0, and a factor sin x or sin y is left away.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from functools import reduce
from operator import add
from typing import NamedTuple

import numpy as np

from origami_nlp.proof.affine import UNIT, variables
from origami_nlp.proof.balls import Ball, exact
from origami_nlp.proof.mesh_curves import QUARTER
from origami_nlp.proof.strip_contact import APART, CROSSING, UNKNOWN

MOST_BOXES = 20_000
"""Of a pair."""
NARROWEST = 2.0**-30
"""Width below which a box is left open [rad]."""
FIRST = 8
"""Parts of [0, pi/2] that are looked at first."""
NEAR = 2.0**-5
"""Width of a box below which a root is looked for [rad]."""
Waves = list[tuple[float, int, int, int]]
"""A sum of c cos(m x + n y - k pi/2): c, m, n, k."""


class Condition(NamedTuple):
    """f, positive where blocks cross, as far as this one says: without what vanishes at a border all along."""

    waves: Waves
    corners: frozenset[tuple[int, int]]
    """At which corners of [0, pi/2]^2 it is 0: 1 for pi/2."""


def condition(alpha: float, beta: float, gamma: float, room: float) -> tuple[Condition, float]:
    """Return alpha sin(p + q) + beta sin q + gamma sin p, and by how much it is not what is meant: at most `room`."""
    sums = alpha + beta, alpha + gamma
    zero = [abs(x) <= room for x in sums]
    off = max((abs(x) for x, z in zip(sums, zero, strict=True) if z), default=0.0)
    if max(abs(alpha), abs(beta), abs(gamma)) <= room:
        return Condition([(-1.0, 0, 0, 0)], frozenset()), off  # beside each other
    if all(zero):
        return Condition([(-alpha, 0, 0, 0)], frozenset()), off
    if zero[0]:
        return Condition([(alpha, 1, 2, 0), (gamma, 1, 0, 0)], frozenset({(1, 0), (1, 1)})), off
    if zero[1]:
        return Condition([(alpha, 2, 1, 0), (beta, 0, 1, 0)], frozenset({(0, 1), (1, 1)})), off
    waves = [(alpha, 2, 2, 1), (beta, 0, 2, 1), (gamma, 2, 0, 1)]
    return Condition(waves, frozenset({(0, 0), (0, 1), (1, 0), (1, 1)})), off


class RowEnergy(NamedTuple):
    """The energy of a row, K phi^2/2 - L phi of its fold phi = pi - 2 x towards the other."""

    stiffness: Ball
    load: Ball

    def slope(self, x: Ball) -> Ball:
        """Return dU/dx."""
        fold = Ball(np.array(math.pi), np.array(4 * UNIT)) - exact(2.0) * x
        return exact(-2.0) * (self.stiffness * fold - self.load)


@dataclass
class HeldStates:
    """States where outer blocks meet in which the energy is least, and boxes where that is not decided: of x, y."""

    inside: list[tuple[tuple[float, float], tuple[float, float]]] = field(default_factory=list)
    open: list[tuple[tuple[float, float], tuple[float, float]]] = field(default_factory=list)
    boxes: int = 0


class RowPair:
    """Two such rows.

    Parameters
    ----------
    conditions
        Blocks cross where all are positive.
    rows
        Their energies.
    room
        By how much coefficients of conditions may be off.
    """

    def __init__(
        self, conditions: list[Condition], rows: tuple[RowEnergy, RowEnergy], room: float
    ) -> None:
        self.conditions, self.rows, self.room = conditions, rows, room

    def _value(self, f: Condition, at: tuple[Ball, Ball], i: int = 0, j: int = 0) -> Ball:
        """Return d^(i+j) f / dx^i dy^j."""
        x, y = at
        terms = []
        for c, m, n, k in f.waves:
            angle, turn = exact(float(m)) * x + exact(float(n)) * y, (i + j - k) % 4
            wave = angle.sine() if turn % 2 else angle.cosine()
            size = Ball(np.array(float(c)), np.array(self.room)) * exact(float(m**i * n**j))
            terms.append(size * (-wave if turn in (1, 2) else wave))
        return reduce(add, terms)

    def _over(self, f: Condition, box: tuple[Ball, Ball], i: int = 0, j: int = 0) -> Ball:
        """Return such a derivative over boxes, by its slopes."""
        at = exact(box[0].centre), exact(box[1].centre)
        away = [Ball(np.zeros_like(v.centre), v.radius) for v in box]
        slopes = self._value(f, box, i + 1, j), self._value(f, box, i, j + 1)
        return self._value(f, at, i, j) + slopes[0] * away[0] + slopes[1] * away[1]

    def _turning(self, f: Condition, at: tuple[Ball, Ball]) -> tuple[Ball, Ball, Ball]:
        """Return D = U_x f_y - U_y f_x, 0 where the energy is stationary along f = 0, with D_x and D_y."""
        u, v = (row.slope(z) for row, z in zip(self.rows, at, strict=True))
        k, m = (exact(4.0) * row.stiffness for row in self.rows)
        f_x, f_y = self._value(f, at, 1, 0), self._value(f, at, 0, 1)
        f_xx, f_xy, f_yy = (self._value(f, at, *ij) for ij in ((2, 0), (1, 1), (0, 2)))
        return (
            u * f_y - v * f_x,
            k * f_y + u * f_xy - v * f_xx,
            u * f_yy - m * f_x - v * f_xy,
        )

    def _sign(self, f: Condition, box: tuple[Ball, Ball]) -> np.ndarray:
        """Return the sign of f inside boxes, 0 where it is not certain."""
        sign = self._over(f, box).sign
        ends = [(z.centre - z.radius <= 0, z.centre + z.radius >= 0.5 * math.pi) for z in box]
        slopes = [self._over(f, box, *ij).sign for ij in ((1, 0), (0, 1))]
        for a, b in f.corners:
            ahead = slopes[0] * (1 - 2 * a), slopes[1] * (1 - 2 * b)
            rule = ends[0][a] & ends[1][b] & (ahead[0] == ahead[1])
            sign = np.where((sign == 0) & rule, ahead[0], sign)
        return sign

    def at(self, x: tuple[float, float], y: tuple[float, float]) -> int:
        """Return what blocks do at all states of a box, or beside it, where it is at a border: APART or CROSSING."""
        ends = np.array([x, y])
        box = _balls(ends[:, 0] - 4 * UNIT, ends[:, 1] + 4 * UNIT)
        signs = [int(self._sign(f, box)[0]) for f in self.conditions]
        return APART if -1 in signs else CROSSING if 0 not in signs else UNKNOWN

    def falls(self, corner: tuple[int, int]) -> bool | None:
        """Return whether the energy falls from a corner, 1 for pi/2, as both rows move at once and blocks are apart."""
        at = np.array(corner, float)
        one, two = (Ball(0.5 * math.pi * c, 4 * UNIT * c) for c in at)
        ends = one, two
        inward = [exact(1.0 - 2 * c) for c in corner]
        u = [i * row.slope(z) for i, row, z in zip(inward, self.rows, ends, strict=True)]
        ways = [int(z.sign) for z in u]
        found: list[bool | None] = []
        for f in self.conditions:
            if corner not in f.corners:
                sign = int(self._value(f, ends).sign)
                apart = True if -1 in ways else None if 0 in ways else False
                found.append(False if sign > 0 else apart if sign else None)
                continue
            slopes = [
                i * self._value(f, ends, *ij)
                for i, ij in zip(inward, ((1, 0), (0, 1)), strict=True)
            ]
            signs = [int(z.sign) for z in slopes]
            if 0 in signs or 0 in ways:
                found.append(False if signs == [1, 1] else None)
            elif signs[0] == signs[1]:
                found.append(signs[0] < 0 and -1 in ways)
            else:
                # between an axis, along which f < 0, and the ray on which it is 0
                ray = u[0] * slopes[1] - u[1] * slopes[0]
                ray = ray if signs[1] > 0 else -ray
                axis = ways[signs.index(-1)]
                way = int(ray.sign)
                found.append(True if -1 in (axis, way) else False if way else None)
        return True if True in found else None if None in found else False

    def held(self, until: float = math.inf) -> HeldStates:
        """Find the states where blocks meet, both rows between 0 and 180 degrees, in which the energy is least.

        After `until` (`time.monotonic`) what is left is open.
        """
        found = HeldStates()
        ends = np.linspace(0.0, QUARTER, FIRST + 1)
        low, high = (np.stack(np.meshgrid(e, e), -1).reshape(-1, 2) for e in (ends[:-1], ends[1:]))
        with np.errstate(all="ignore"):
            while len(low):
                stop = found.boxes + len(low) > MOST_BOXES or time.monotonic() > until
                found.boxes += len(low)
                left = self._undecided(low, high)
                more = []
                for k in np.flatnonzero(left.any(axis=0)).tolist():
                    width = float((high[k] - low[k]).max())
                    if width <= NEAR and self._root(left[:, k], low[k], high[k], found):
                        continue
                    if stop or width <= NARROWEST:
                        found.open.append(_as_box(low[k], high[k]))
                    else:
                        more.append(k)
                low, high = _quarters(low[more], high[more])
        return found

    def _undecided(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return which conditions may hold a least state in boxes [K, 2], [conditions, K]."""
        box = _balls(low, high)
        signs = np.array([self._sign(f, box) for f in self.conditions])
        left = (signs == 0) & ~(signs < 0).any(axis=0)
        for f, may in zip(self.conditions, left, strict=True):
            some = np.flatnonzero(may)
            if not len(some):
                continue
            x, y = (Ball(z.centre[some], z.radius[some]) for z in box)
            at = exact(x.centre), exact(y.centre)
            away = [Ball(0 * z.centre, z.radius) for z in (x, y)]
            _, d_x, d_y = self._turning(f, (x, y))
            d = self._turning(f, at)[0] + d_x * away[0] + d_y * away[1]
            f_x, f_y = (self._over(f, (x, y), *ij) for ij in ((1, 0), (0, 1)))
            u, v = (row.slope(z) for row, z in zip(self.rows, (x, y), strict=True))
            away_from = (u * f_x + v * f_y).sign > 0
            largest = (f_x * d_y - f_y * d_x).sign > 0
            may[some] = (d.sign == 0) & ~away_from & ~largest
        return left

    def _root(self, may: np.ndarray, low: np.ndarray, high: np.ndarray, found: HeldStates) -> bool:
        """Return whether a box is decided: list its least state, or find that it has none."""
        if may.sum() != 1:
            return False
        f = self.conditions[int(np.flatnonzero(may)[0])]
        room = high - low
        one, two = low - room, high + room
        first = True
        for _ in range(40):
            new = self._newton(f, one, two)
            if new is None:
                return False
            inside = (new[0] > one).all() and (new[1] < two).all()
            if first and ((new[0] > high).any() or (new[1] < low).any()):
                return True  # of another box
            if first and not inside:
                return False
            if not first and not (new[1] - new[0] < 0.9 * (two - one)).any():
                break
            one, two, first = np.fmax(one, new[0]), np.fmin(two, new[1]), False
        box = _balls(one, two)
        others = [int(self._sign(g, box)[0]) for g in self.conditions if g is not f]
        if -1 in others:
            return True  # the blocks are apart beside it
        pushed = reduce(
            add,
            (
                row.slope(z) * self._value(f, box, *ij)
                for row, z, ij in zip(self.rows, box, ((1, 0), (0, 1)), strict=True)
            ),
        ).sign[0]
        if pushed > 0:
            return True
        if 0 in others or not pushed or (one <= 0).any() or (two >= 0.5 * math.pi).any():
            return False
        state = _as_box(one, two)
        if not any(
            all(a[0] <= b[1] and b[0] <= a[1] for a, b in zip(s, state, strict=True))
            for s in found.inside
        ):
            found.inside.append(state)
        return True

    def _newton(
        self, f: Condition, low: np.ndarray, high: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Return where f = 0 = D can be in a box, by a step of Krawczyk; None where U along f is not least for sure."""
        box = _balls(low, high)
        at = exact(box[0].centre), exact(box[1].centre)
        _, d_x, d_y = self._turning(f, box)
        rows = [[self._value(f, box, 1, 0), self._value(f, box, 0, 1)], [d_x, d_y]]
        if not (rows[0][0] * d_y - rows[0][1] * d_x).sign[0] < 0:
            return None
        middle = np.array([[z.centre[0] for z in row] for row in rows])
        inverse = np.linalg.inv(middle)
        values = [self._value(f, at), self._turning(f, at)[0]]
        new = []
        for i in (0, 1):
            y = [exact(np.array([c])) for c in inverse[i]]
            total = at[i] - (y[0] * values[0] + y[1] * values[1])
            for j in (0, 1):
                share = y[0] * rows[0][j] + y[1] * rows[1][j]
                total = total + (exact(np.array([float(i == j)])) - share) * Ball(
                    np.zeros(1), box[j].radius
                )
            new.append((total.centre[0] - total.radius[0], total.centre[0] + total.radius[0]))
        if not np.isfinite(new).all():
            return None
        return np.array([z[0] for z in new]), np.array([z[1] for z in new])


def _balls(low: np.ndarray, high: np.ndarray) -> tuple[Ball, Ball]:
    """Return x and y of boxes [K, 2]."""
    x, y = (
        Ball(*variables(a, b))
        for a, b in zip(np.atleast_2d(low).T, np.atleast_2d(high).T, strict=True)
    )
    return x, y


def _as_box(low: np.ndarray, high: np.ndarray) -> tuple[tuple[float, float], tuple[float, float]]:
    (a, c), (b, d) = low.tolist(), high.tolist()
    return (a, b), (c, d)


def _quarters(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the four parts of each box [K, 2]."""
    middle = 0.5 * (low + high)
    parts = [
        (np.where(side, middle, low), np.where(side, high, middle))
        for side in ([0, 0], [0, 1], [1, 0], [1, 1])
    ]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])
