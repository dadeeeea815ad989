"""Proof, by boxes, that no branch of a cone holds two interior minima (small N; up to rounding).

Let F = A' + r B' have two interior minima x1 < x2 at some r > 0: F is negative before x1, positive
at some M between x1 and a zero y < x2, and negative between y and x2.  B' = 4 n (s - s_e).

- s_e <= y: raising r raises F right of s_e and leaves F(s_e) >= 0.  At some r' >= r the dip between
  M (or s_e) and x2 touches 0: F = F' = 0 <= F''.  As B'' is constant this reads
      A'' = -4 n r' < 0,   A''' >= 0,   W := A'' (s - s_e) - A' = 0,   s >= s_e.
- y < s_e < x2: F(s_e) = A'(s_e) < 0 whatever r, and at y, where F = 0 >= F',
      A' > 0,   A'' < 0,   W >= 0,   s < s_e,
  with the same r = -A'/B' at x2, where F' >= 0, and so A''' >= 0 somewhere between.
- s_e >= x2: left of s_e F < 0 where A'/|B'| < r, so that A'/|B'| rises through r at x1, falls
  through it at y, and rises again: it has a largest value r' > r > 0 and a least one,
      A'' = -4 n r' < 0,   W = 0,   s <= s_e    and elsewhere    A''' >= 0,   W = 0,   s <= s_e.

Boxes of the plane of s and |v_0| are discarded where enclosures exclude one of the conditions (left
of s_e of s/|v_0| and |v_0|, and W/|v_0|, as W vanishes with v_0); the others are halved.  On the branch
of the rest state itself F has the sign of s - |v_0|: it is left out.  Enclosures are ranges of
monotone factors, widened by 1e-12, and for W also the mean value form.
"""

from __future__ import annotations

import math

import numpy as np


class Range:
    """Arrays of intervals."""

    def __init__(self, low, high):
        self.low, self.high = low, high

    def __add__(self, other):
        other = _range(other)
        return Range(self.low + other.low, self.high + other.high)

    __radd__ = __add__

    def __neg__(self):
        return Range(-self.high, -self.low)

    def __sub__(self, other):
        return self + (-_range(other))

    def __mul__(self, other):
        other = _range(other)
        parts = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        return Range(np.minimum.reduce(parts), np.maximum.reduce(parts))

    __rmul__ = __mul__

    def wide(self):
        slack = 1e-12 * (1 + np.maximum(np.abs(self.low), np.abs(self.high)))
        return Range(self.low - slack, self.high + slack)

    def meet(self, other):
        return Range(np.maximum(self.low, other.low), np.minimum(self.high, other.high))


def _range(x):
    return x if isinstance(x, Range) else Range(x, x)


def _between(function, low, high):
    """Range of a monotone function."""
    a, b = function(low), function(high)
    return Range(np.minimum(a, b), np.maximum(a, b))


def sizes(degree, low, high):
    """Ranges of P, S, X and three derivatives on [low, high] of s: [kind][order]."""
    alpha = 2 * math.pi / degree
    k = math.tan(math.pi / 4 - alpha / 2)
    big = math.tan(alpha)
    c, k2 = 1 + 2 * big**2, k * k
    t = _between(lambda s: np.tan(s / 2), low, high)
    h = Range((1 + t.low**2) / 2, (1 + t.high**2) / 2)
    lead = 2 * k * (1 - k2)

    def over(x):
        return Range(1 / x.high, 1 / x.low)

    d = Range(1 + k2 * t.low**2, 1 + k2 * t.high**2)
    e = Range(k2 + t.low**2, k2 + t.high**2)
    top_p = Range(
        1 + 3 * (1 - k2) * t.low**2 - k2 * t.high**4, 1 + 3 * (1 - k2) * t.high**2 - k2 * t.low**4
    )
    top_s = Range(
        k2 - 3 * (1 - k2) * t.high**2 - t.high**4, k2 - 3 * (1 - k2) * t.low**2 - t.low**4
    )
    p = [
        _between(lambda s: 4 * np.arctan(k * np.tan(s / 2)), low, high),
        _between(
            lambda s: 2 * k * (1 + np.tan(s / 2) ** 2) / (1 + k2 * np.tan(s / 2) ** 2), low, high
        ),
        2 * lead * (t * h * over(d) * over(d)),
        lead * (h * top_p * over(d) * over(d) * over(d)),
    ]
    st = [
        _between(lambda s: 4 * np.arctan(np.tan(s / 2) / k), low, high),
        _between(lambda s: 2 * k * (1 + np.tan(s / 2) ** 2) / (k2 + np.tan(s / 2) ** 2), low, high),
        -2 * lead * (t * h * over(e) * over(e)),
        -lead * (h * top_s * over(e) * over(e) * over(e)),
    ]
    y = _between(np.sin, low, high)
    cos = _between(np.cos, low, high)
    w = Range(big**2 * y.low**2, big**2 * y.high**2)
    g = over(1 + w)
    top_x = Range(c - 3 * (c + 1) * w.high + w.high**2, c - 3 * (c + 1) * w.low + w.low**2)
    x = [
        _between(lambda s: 2 * np.arctan(big * np.sin(s)), low, high),
        2 * big * (cos * g),
        -2 * big * (y * (c - w) * g * g),
        -2 * big * (cos * top_x * g * g * g),
    ]
    return p, st, x


Range.__rsub__ = lambda self, other: _range(other) - self


def bends(degree, weights, direction, reach_kind, valleys, s, v):
    """Ranges of A'', A''', W on boxes s x |v_0|, of dW/ds and dW/d|v_0|, and of s - s_e."""
    n = degree // 2
    z = sizes(degree, s.low, s.high)
    rest = sizes(degree, v.low, v.high)[reach_kind]
    g, g1 = direction * rest[0], direction * rest[1]
    lean = (2 * valleys - n) / n
    arm = s - lean * v
    one = two = three = by_g1 = by_g2 = 0.0
    for w, sign, (z0, z1, z2, z3) in zip(weights, (-1.0, 1.0, 1.0), z, strict=True):
        if w == 0:
            continue
        reach = z0 + sign * g
        one = one + w * (reach * z1)
        two = two + w * (reach * z2 + Range(z1.low**2, z1.high**2))  # z1 > 0
        three = three + w * (reach * z3 + 3.0 * (z1 * z2))
        by_g1 = by_g1 + (w * sign) * z1
        by_g2 = by_g2 + (w * sign) * z2
    whole = two * arm - one
    return two, three, whole, three * arm, by_g2 * g1 * arm - lean * two - by_g1 * g1, arm


def setup(degree, valleys, changes, direction, side):
    """(numbers of odd creases by kind, end of the branch, largest |v_0|, kind of the rest angle)."""
    n, j = degree // 2, changes // 2
    shallow = valleys if direction > 0 else n - valleys
    contact = math.pi / 2 - 2 * math.pi / degree
    weights = (shallow - j, n - shallow - j, 2 * j)
    end = math.pi / 2 if shallow == n else contact
    furthest = math.pi / 2 if side > 0 else contact
    return weights, end, furthest, 0 if side > 0 else 1


def survivors(test, width, height, levels, first):
    """Boxes of [0, width] x [0, height] that `test` (True: not excluded) leaves after all halvings."""
    x, y = np.linspace(0, width, first + 1), np.linspace(0, height, first + 1)
    a, b = (g.ravel() for g in np.meshgrid(x[:-1], y[:-1]))
    c, d = (g.ravel() for g in np.meshgrid(x[1:], y[1:]))
    for level in range(levels + 1):
        left = test(a, b, c, d)
        a, b, c, d = a[left], b[left], c[left], d[left]
        if level == levels or not len(a):
            break
        m, k = (a + c) / 2, (b + d) / 2
        a, c = np.concatenate([a, m, a, m]), np.concatenate([m, c, m, c])
        b, d = np.concatenate([b, b, k, k]), np.concatenate([k, k, d, d])
    return len(a)


def right_of_the_vertex(degree, valleys, changes, direction, side, levels=8, first=24):
    """Boxes where a dip may touch zero at s >= s_e and r > 0."""
    weights, end, furthest, kind = setup(degree, valleys, changes, direction, side)
    args = (degree, weights, direction, kind, valleys)

    def test(a, b, c, d):
        two, three, whole, by_s, by_v, arm = bends(*args, Range(a, c), Range(b, d))
        ms, mv = (a + c) / 2, (b + d) / 2
        middle = bends(*args, Range(ms, ms), Range(mv, mv))[2]
        ds, dv = (c - a) / 2, (d - b) / 2
        mean = middle + by_s * Range(-ds, ds) + by_v * Range(-dv, dv)
        whole = whole.meet(mean).wide()
        left = (two.wide().low < 0) & (three.wide().high >= 0) & (arm.wide().high >= 0)
        return left & (whole.low <= 0) & (whole.high >= 0)

    return survivors(test, end, furthest, levels, first)


def shares(degree, s):
    """Z(s)/s for P, S, X: monotone, as P is convex and S and X are concave."""
    s = np.maximum(s, 1e-9)  # changes the quotients by less than 1e-17
    return [kind[0].low / s for kind in sizes(degree, s, s)]


def left_of_the_vertex(degree, valleys, changes, direction, side, levels=8, first=24):
    """Boxes (s/|v_0|, |v_0|) where a second minimum is not excluded at s <= s_e."""
    n = degree // 2
    weights, end, furthest, kind = setup(degree, valleys, changes, direction, side)
    lean = (2 * valleys - n) / n
    if lean <= 0:
        return 0  # s_e <= 0: there is no such s

    def over_v(s, v, share):
        """A'/|v_0| at s = share |v_0|."""
        z = sizes(degree, s.low, s.high)
        ends = [shares(degree, x) for x in (s.low, s.high)]
        rest = [shares(degree, x)[kind] for x in (v.low, v.high)]
        rest = direction * Range(np.minimum(*rest), np.maximum(*rest))
        total = 0.0
        for k, (w, sign) in enumerate(zip(weights, (-1.0, 1.0, 1.0), strict=True)):
            own = Range(np.minimum(ends[0][k], ends[1][k]), np.maximum(ends[0][k], ends[1][k]))
            total = total + w * ((share * own + sign * rest) * z[k][1])
        return total

    def second_root(a, b, d, most):
        """Whether r <= most may be -A'/B' at some s_e < x2 <= end, with A''' >= 0 between y and x2.

        F' <= 0 at y and F' >= 0 at x2 at the same r: A'' must grow between.
        """
        low = np.minimum(a * b, end)
        edges = low[:, None] + np.linspace(0, 1, 201) * (end - low)[:, None]
        at = Range(edges[:, :-1], edges[:, 1:])
        z = sizes(degree, at.low, at.high)
        own = Range(b[:, None], d[:, None])
        rest = direction * sizes(degree, own.low, own.high)[kind][0]
        slope = third = 0.0
        for w, sign, (z0, z1, z2, z3) in zip(weights, (-1.0, 1.0, 1.0), z, strict=True):
            slope = slope + w * ((z0 + sign * rest) * z1)
            third = third + w * ((z0 + sign * rest) * z3 + 3.0 * (z1 * z2))
        arm = at.high - lean * b[:, None] + 1e-12
        with np.errstate(divide="ignore", invalid="ignore"):
            root = (arm > 0) & (-slope.wide().high / (4 * n * arm) <= most[:, None])
        grows = np.cumsum(third.wide().high >= 0, axis=1) > 0
        return (root & grows).any(axis=1)

    def left_test(which):
        def test(a, b, c, d):
            share, v = Range(a, c), Range(b, d)
            high = np.minimum(c * d, end)
            s = Range(np.minimum(a * b, high), high)
            two, three, *_ = bends(degree, weights, direction, kind, valleys, s, v)
            slope = over_v(s, v, share)
            whole = (two * (share - lean) - slope).wide()
            inside = a * b <= end
            if which == "largest":
                return inside & (two.wide().low < 0) & (whole.low <= 0) & (whole.high >= 0)
            if which == "least":
                return inside & (three.wide().high >= 0) & (whole.low <= 0) & (whole.high >= 0)
            vertex = Range(np.minimum(lean * b, end), np.minimum(lean * d, end))
            at_vertex = over_v(vertex, v, Range(lean, lean)).wide()
            left = inside & (slope.wide().high > 0) & (two.wide().low < 0) & (whole.high >= 0)
            left &= (at_vertex.low < 0) & (lean * b <= end)
            rows = np.nonzero(left)[0]
            with np.errstate(divide="ignore"):
                most = slope.wide().high[rows] / (4 * n * np.maximum(lean - c[rows], 0))
            left[rows] = second_root(a[rows], b[rows], d[rows], most)
            return left

        return test

    def count(which):
        return survivors(left_test(which), lean, furthest, levels, first)

    largest = count("largest")
    return (min(largest, count("least")) if largest else 0) + count("around")


def undecided(degree, valleys, changes, direction, levels=8):
    """Boxes in which two interior minima on one branch are not excluded, for both signs of v_0."""
    total = 0
    for side in (1, -1):
        if valleys == degree // 2 and direction == side:
            continue  # the branch of the rest state
        args = (degree, valleys, changes, direction, side, levels)
        total += right_of_the_vertex(*args) + left_of_the_vertex(*args)
    return total
