"""Torques of hinge laws over boxes of fold angles, with proved rounding: value, slope and what is not linear.

The law that is meant.  The pieces of a `HingeLaw` meet to rounding only.  Meant is the continuous torque whose slope is
that of the pieces, from its value at the first break on: it differs from the pieces by the sum of what they jump by at
most (`drift`, computed exactly).  The first piece and the last go on beyond the ends.

On one piece, with t = middle + h xi: tau = f0 + f1 h xi + f2 h^2 xi^2 + f3 h^3 xi^3 is its own expansion; xi^2 is in
[0, 1], and xi^3 within 1/4 of 3 xi / 4 (Chebyshev).  Over several pieces, with slopes in [m, M] by what each piece has
of the box: tau(middle) + (m + M) / 2 h xi +- (M - m) / 2 h (mean value), or, where that is narrower, between the least
and the largest torque.  Boxes are so cut at knots, not bisected there.

Rounding.  Each number is a sum of at most ten products of up to six factors that are rounded to `UNIT` each, and the
absolute values of these products are bounded by what Horner's rule gives with |t| + h and absolute coefficients:
`ROUND` times that is added.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from flint import arb

from origami_nlp.pattern import HingeLaw
from origami_nlp.problem import Model
from origami_nlp.proof.rows import UNIT

ROUND = 128 * UNIT
"""Share of the absolute values of all terms that rounding may be."""
SMOOTH = 1e-9
"""Slopes that jump by less at a knot, of the mean stiffness, are meant to go on: the jump counts as doubt of them."""


@lru_cache(maxsize=64)
def _jumps(
    breaks: tuple[float, ...], coefficients: tuple[tuple[float, ...], ...]
) -> tuple[float, np.ndarray]:
    """Sum of |jumps| of the torque, rounded up, and |jumps| of the slope at the inner breaks, rounded up."""
    x, rows = ([Fraction(b) for b in breaks], [[Fraction(v) for v in row] for row in coefficients])
    total, slopes = Fraction(0), []
    for i in range(len(rows) - 1):
        (a, b, c, d), h = rows[i], x[i + 1] - x[i]
        total += abs(((a * h + b) * h + c) * h + d - rows[i + 1][3])
        slopes.append(float(abs((3 * a * h + 2 * b) * h + c - rows[i + 1][2])) * (1 + 4 * UNIT))
    return float(total) * (1 + 4 * UNIT), np.array(slopes)


class _Ranges:
    """Largest of some values [B] from one place to another, by tables of 1, 2, 4, ... of them."""

    def __init__(self, values: np.ndarray) -> None:
        self.levels = [values]
        while 2 ** len(self.levels) <= len(values):
            last, step = self.levels[-1], 2 ** (len(self.levels) - 1)
            self.levels.append(np.maximum(last[:-step], last[step:]))

    def largest(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Largest of values first .. last, both included; -inf where last < first."""
        count = last - first + 1
        out = np.full(count.shape, -np.inf)
        for level, values in enumerate(self.levels):
            some = np.flatnonzero((count >= 2**level) & (count < 2 ** (level + 1)))
            if len(some):
                a, b = first[some], last[some] - 2**level + 1
                out[some] = np.maximum(values[a], values[b])
        return out


class LawPieces:
    """The torque of one law, less a constant torque, times a factor.

    Parameters
    ----------
    law
        As stated.
    less
        The constant torque [N m].
    factor
        Positive.
    """

    def __init__(self, law: HingeLaw, less: float, factor: float) -> None:
        self.breaks = np.array(law.breaks)
        c = np.array(law.coefficients)
        c[:, 3] -= less
        self.c = c = factor * c
        self.inner = self.breaks[1:-1]
        lengths = np.diff(self.breaks)
        drift, jumps = _jumps(law.breaks, law.coefficients)
        jumps = factor * jumps
        own = np.abs(c)
        sizes = ((own[:, 0] * lengths + own[:, 1]) * lengths + own[:, 2]) * lengths + own[:, 3]
        self.size = float(sizes.max()) * (1 + 16 * UNIT) + factor * abs(less)
        """Bound of the terms that torques are sums of."""
        self.drift = 2 * factor * drift + ROUND * factor * abs(less)
        bends = (3 * own[:, 0] * lengths + 2 * own[:, 1]) * lengths + own[:, 2]
        self.steep = float(bends.max()) * (1 + 16 * UNIT)
        """Bound of the terms that slopes are sums of."""
        real = jumps > SMOOTH * factor * law.stiffness
        self.kinks, self.kink = self.inner[real], jumps[real]
        self.ripple = float(jumps[~real].sum()) + ROUND * self.steep
        """What is not known of slopes between knots where they jump."""
        which, low, high = np.arange(len(c)), self.breaks[:-1], self.breaks[1:]
        torque, slope = self._over(which, low, high)
        self._highest, self._lowest = _Ranges(torque[1]), _Ranges(-torque[0])
        self._stiffest, self._softest = _Ranges(slope[1]), _Ranges(-slope[0])
        bent = np.maximum(np.abs(2 * c[:, 1]), np.abs(6 * c[:, 0] * lengths + 2 * c[:, 1]))
        self._bent = _Ranges(bent * (1 + 16 * UNIT))

    def _expanded(self, piece: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Torque and its derivatives over 1, 2 and 6 at angles on pieces, [4, ...]."""
        a, b, c, d = self.c[piece].T
        t = at - self.breaks[piece]
        return np.array(
            [((a * t + b) * t + c) * t + d, (3 * a * t + 2 * b) * t + c, 3 * a * t + b, a]
        )

    def _over(
        self, piece: np.ndarray, low: np.ndarray, high: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Bounds [2, ...] of torque and slope on pieces between angles."""
        middle = 0.5 * (low + high)
        h = np.nextafter(np.maximum(high - middle, middle - low), np.inf)
        value = self._expanded(piece, middle)
        f1, f2, f3 = np.abs(value[1:])
        off = (f1 + (f2 + f3 * h) * h) * h * (1 + 8 * UNIT) + ROUND * self.size
        bent = (2 * f2 + 3 * f3 * h) * h * (1 + 8 * UNIT) + ROUND * self.steep
        return np.array([value[0] - off, value[0] + off]), np.array(
            [value[1] - bent, value[1] + bent]
        )

    def touched(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and last piece that touches what is between angles."""
        return (
            np.searchsorted(self.inner, low, side="left"),
            np.searchsorted(self.inner, high, side="right"),
        )

    def over(self, middle: np.ndarray, half: np.ndarray) -> np.ndarray:
        """Enclose the torque over boxes: centre, slope in xi, error, [3, K]."""
        low = np.nextafter(middle - half, -np.inf)
        high = np.nextafter(middle + half, np.inf)
        first, last = self.touched(low, high)
        f0, f1, f2, f3 = self._expanded(first, middle)
        bow, twist = f2 * half**2, f3 * half**3
        a, b, c, d = np.abs(self.c[first].T)
        t = np.abs(middle - self.breaks[first]) + half
        out = np.array(
            [
                f0 + 0.5 * bow,
                f1 * half + 0.75 * twist,
                0.5 * np.abs(bow) + 0.25 * np.abs(twist) + ROUND * (((a * t + b) * t + c) * t + d),
            ]
        )
        several = np.flatnonzero(first < last)
        if len(several):
            out[:, several] = self._over_several(
                *(v[several] for v in (middle, half, low, high, first, last))
            )
        out[2] = out[2] * (1 + 16 * UNIT) + self.drift
        return out

    def _over_several(
        self,
        middle: np.ndarray,
        half: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        first: np.ndarray,
        last: np.ndarray,
    ) -> np.ndarray:
        """As `over`, of boxes with knots."""
        left = self._over(first, low, np.maximum(low, self.breaks[first + 1]))
        right = self._over(last, np.minimum(high, self.breaks[last]), high)
        a, b = first + 1, last - 1
        top, bottom, most, least = (
            np.maximum(table.largest(a, b), np.maximum(sign * one[row], sign * two[row]))
            for table, sign, one, two, row in (
                (self._highest, 1.0, left[0], right[0], 1),
                (self._lowest, -1.0, left[0], right[0], 0),
                (self._stiffest, 1.0, left[1], right[1], 1),
                (self._softest, -1.0, left[1], right[1], 0),
            )
        )
        bottom, least = -bottom, -least
        value = self._expanded(np.searchsorted(self.inner, middle, side="right"), middle)[0]
        size = self.size + (np.abs(most) + np.abs(least)) * half
        by_slope = np.array([value, 0.5 * (most + least) * half, 0.5 * (most - least) * half])
        by_range = np.array([0.5 * (top + bottom), 0 * value, 0.5 * (top - bottom)])
        out = np.where(by_slope[2] < by_range[2], by_slope, by_range)
        out[2] += ROUND * size
        return np.asarray(out)

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Torque and slope at angles [...]."""
        piece = np.searchsorted(self.inner, x, side="right")
        value = self._expanded(piece.ravel(), x.ravel())
        return value[0].reshape(x.shape), value[1].reshape(x.shape)

    def bends(self, x: np.ndarray, within: np.ndarray) -> np.ndarray:
        """Bound |slope(y) - slope(x)| / |y - x| for |y - x| <= within, but for `ripple`: [...]."""
        first, last = self.touched(x - within, x + within)
        out = self._bent.largest(first, last)
        for at, size in zip(self.kinks, self.kink, strict=True):
            away = np.abs(x - at)
            near = away <= within * (1 + 4 * UNIT)
            out = out + np.where(near, size / np.maximum(away, np.finfo(float).tiny), 0.0)
        return out


class LawBalls:
    """A law over balls (python-flint): the torque that is meant, and its slopes on both sides of what is a knot."""

    def __init__(self, law: HingeLaw) -> None:
        self.inner = law.breaks[1:-1]
        self.pieces = [
            (arb(b), [arb(v) for v in row])
            for b, row in zip(law.breaks[:-1], law.coefficients, strict=True)
        ]
        self.drift = arb(0, _jumps(law.breaks, law.coefficients)[0])

    def over(self, phi: Any) -> tuple[Any, Any]:
        """Return the torque and its slope; nothing where the angle is not known."""
        if not phi.is_finite():
            return arb.nan(), arb.nan()
        low, high = (
            bisect(self.inner, math.nextafter(float(end), way))
            for bisect, end, way in (
                (bisect_left, phi.lower(), -math.inf),
                (bisect_right, phi.upper(), math.inf),
            )
        )
        found = []
        for k in range(low, high + 1):
            start, (a, b, c, d) = self.pieces[k]
            x = phi
            if k > low or k < high:
                ends = [
                    phi.lower() if k == low else start,
                    phi.upper() if k == high else self.pieces[k + 1][0],
                ]
                x = ends[0].union(ends[1])
            t = x - start
            found.append((((a * t + b) * t + c) * t + d, (3 * a * t + 2 * b) * t + c))
        torque, slope = found[0]
        for one, other in found[1:]:
            torque, slope = torque.union(one), slope.union(other)
        return torque + self.drift, slope


class LawTorques:
    """Torques of all variables of a scene with hinge laws, of springs among them too.

    Parameters
    ----------
    model
        Its scene has laws.
    counts
        How often the torque of one crease counts for each variable, [n].
    largest
        Torques are divided by this, over `Model.scale`.

    Attributes
    ----------
    most
        Bound of the terms that torques are sums of, [n].
    drift
        What is not known of torques, [n].
    ripple
        What is not known of slopes, [n].
    """

    def __init__(self, model: Model, counts: np.ndarray, largest: float = 1.0) -> None:
        scene, p = model.scene, model.parameters
        _, first = np.unique(model.variable_of_crease, return_index=True)
        factor = counts / (model.scale * largest)
        preload = scene.preload or (0.0,) * scene.degree
        self.pieces = [
            law and LawPieces(law, preload[c], f)
            for c, law, f in zip(
                first, (scene.laws[c] for c in first), factor.tolist(), strict=True
            )
        ]
        self.k = counts * (p.stiffness / model.multiplicity) / largest
        self.rest = p.rest
        springs = 7.0 * self.k

        def of(name: str, spring: np.ndarray) -> np.ndarray:
            pairs = zip(self.pieces, spring.tolist(), strict=True)
            return np.array([k if law is None else getattr(law, name) for law, k in pairs])

        self.most, none = of("size", springs), 0.0 * springs
        self.drift, self.ripple = of("drift", none), of("ripple", none)

    def over(self, middle: np.ndarray, half: np.ndarray) -> np.ndarray:
        """Enclose torques over boxes [n, K]: centre, slope in the own xi, error, [3, n, K]."""
        k, rest = self.k[:, None], self.rest[:, None]
        out = np.array(
            [k * (middle - rest), k * half, 16 * UNIT * k * (np.abs(middle) + np.abs(rest) + half)]
        )
        for v, law in enumerate(self.pieces):
            if law is not None:
                out[:, v] = law.over(middle[v], half[v])
        return out

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Torques and slopes at states [R, n]."""
        torque, slope = self.k * (x - self.rest), self.k + 0.0 * x
        for v, law in enumerate(self.pieces):
            if law is not None:
                torque[:, v], slope[:, v] = law.at(x[:, v])
        return torque, slope

    def bends(self, x: np.ndarray, within: np.ndarray) -> np.ndarray:
        """Bound how slopes change with fold angles from states [R, n], within [R], but for `ripple`: [R, n]."""
        out = np.zeros(x.shape)
        for v, law in enumerate(self.pieces):
            if law is not None:
                out[:, v] = law.bends(x[:, v], within)
        return out

    def linear_about(self, x: np.ndarray, radius: float) -> tuple[np.ndarray, ...]:
        """Return torque [n] at a state, slopes, by how much these miss within a radius <= 1, and by rounding."""
        torque, slope = self.at(x[None])
        within = np.array([radius])
        known = ROUND * self.most + self.drift + self.ripple
        miss = 0.5 * radius**2 * self.bends(x[None], within)[0]
        return torque[0], slope[0], miss + known, known


def torques_of(model: Model, counts: np.ndarray | float, largest: float) -> LawTorques | None:
    """Return the torques of a model's laws, over the largest stiffness; None where all hinges are linear springs.

    Parameters
    ----------
    model
        The scene.
    counts
        How often the torque of one crease counts for each variable.
    largest
        What torques are divided by, over `Model.scale`.
    """
    if not model.scene.laws:
        return None
    return LawTorques(model, counts + np.zeros(model.size), largest)


def energy_bounds(model: Model, low: Sequence[float], high: Sequence[float]) -> tuple[float, float]:
    """Return bounds of the energy of a scene with laws over a box [rad], [J], to rounding.

    Parameters
    ----------
    model
        The scene.
    low, high
        Ends of the box, [n].
    """
    p, total = model.parameters, np.zeros(2)
    laws = p.laws
    assert laws is not None
    for v, (a, b) in enumerate(zip(low, high, strict=True)):
        law = laws.laws[v]
        x = np.array([a, b])
        if law is None:
            x = np.append(x, np.clip(p.rest[v], a, b))
            energy = 0.5 * p.stiffness[v] * (x - p.rest[v]) ** 2
        else:
            energy = laws.weight[v] * law.extremes(a - laws.shift[v], b - laws.shift[v])
        work = p.load[v] * np.array([a, b])
        total += [energy.min() - work.max(), energy.max() - work.min()]
    low_energy, high_energy = model.scale * total
    return float(low_energy), float(high_energy)
