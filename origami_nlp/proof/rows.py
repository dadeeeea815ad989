"""Functions of folded chains over boxes of fold angles, by Taylor's formula with a bound that holds everywhere.

A box is phi_v = mid_v + r_v xi_v, |xi_v| <= 1.  A row is p(xi) = value + sum slopes_v xi_v + sum bends_vw xi_v xi_w +-
rest: value, gradient and Hessian at the middle, in doubles, and a bound of all else.  No interval is folded.

Remainder.  Every row is a product of rotations, applied to unit vectors (u . (v x w), turns between) or as unit
quaternions.  A fold by w phi, w = 1, or 1/2 for a crease on a mirror, has derivatives w c x ... of a rotated vector and
w c / 2 of a quaternion, c a unit vector: a partial derivative of order p is at most the product of p factors w (w / 2)
in size.  With s the sum of w_v r_v over the creases between, Taylor's remainder after second order is at most s^3 / 6
for triple products and s^3 / 48 for quaternions, at any point of the box.

Rounding.  u = 2^-53.  A fold turns two vectors of a frame: each entry of c y + s z is a sum of two products, 2 u of
|c y| + |s z| <= (y^2 + z^2)^(1/2), with a cosine and a sine that are off by 2^-50 = 8 u of themselves: 10 u times the
root, 14 u a vector.  A sector does the same, and is off by `SECTORS` ulp of pi itself, 8 u; pi in doubles by 1.1 u.
Together less than 40 u = `CREASE` a crease.  Frames are linear in the frame they begin with: what came before u
multiplies u . (v x w) by the determinant of a frame that E creases made, 1 to within 3 E creases, and v and w are off
by what the L steps between are, and two products by 4 u each: `CREASE` (2 L + 1 + 3 E |value|).  Slopes and bends
have up to five factors: 5 (E + 1) `CREASE` for each, weighed with s + s^2.  The product of folds about the creases as
the sheet has them: a product of quaternions 10 u, a cosine and a sine of half a fold 8 u, those of an azimuth 10 u
and 8 u for each sector before: less than 40 L u + 4 L^2 u.

Near the flat state values are known better.  With t the sum of |phi| over the chain, or 1, parts along e3 of axes, and
the vector part of the product of folds, are sums of products that each hold a sine of size t, and a triple product of
vectors that lie in the sheet where it is flat is one of products with an odd number of such parts: every error is
relative to such a term, and counts t times.

What is made of rows afterwards is sums of products of coefficients: n terms are off by
gamma_{n+1} of the sum of their absolute values (Higham, Accuracy and Stability of Numerical Algorithms, 3.1), for
which `padded` adds twice that.

What is trusted: IEEE 754 doubles, rounded to nearest; NumPy's sine and cosine to 4 ulp (1 is usual).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np

from origami_nlp.numerics import quaternion

UNIT = 2.0**-53
"""Unit roundoff u of doubles."""
TINY = 2.0**-1000
"""More than what underflow can lose in a sum of products."""
SLIGHTLY = 1.0 + 2.0**-40
"""Factor above what rounding does to sums of up to a thousand errors."""
TRIGONOMETRIC = 2.0**-50
"""Relative error of NumPy's sine and cosine that is allowed for: 4 ulp."""
SECTORS = 2
"""Ulp of pi by which a sector angle may differ from the double in the scene."""
CREASE = 40 * UNIT
"""By how much a fold and a sector in doubles may turn a unit vector away."""


Batch = TypeVar("Batch")
"""A record of arrays."""


@dataclass(frozen=True, eq=False)
class Affine:
    """Rows centre + sum slopes_v xi_v + error eta, |xi_v|, |eta| <= 1, over K boxes.

    Attributes
    ----------
    centre, error
        Shape [R, K].
    slopes
        Shape [R, n, K].
    """

    centre: np.ndarray
    slopes: np.ndarray
    error: np.ndarray

    def radius(self) -> np.ndarray:
        """Return an upper bound of |x - centre| over the box, [R, K]."""
        d = self.slopes.shape[-2]
        return (np.abs(self.slopes).sum(axis=-2) + self.error) * (1 + 4 * (d + 4) * UNIT)

    def nonzero(self) -> np.ndarray:
        """Return where a row certainly differs from zero over the box, [R, K]."""
        return np.abs(self.centre) > self.radius()

    def signs(self) -> np.ndarray:
        """Return the sign over the box, [R, K]; 0 where it is not certain."""
        return np.where(self.nonzero(), np.sign(self.centre), 0).astype(int)


def padded(
    centre: np.ndarray, slopes: np.ndarray, error: np.ndarray, total: np.ndarray, terms: int
) -> Affine:
    """Allow for rounding: coefficients are sums of `terms` products whose absolute values sum to at most `total`."""
    return Affine(centre, slopes, error * SLIGHTLY + (2 * (terms + 4) * UNIT) * total + TINY)


def joined(parts: Sequence[Batch], axis: int = 0) -> Batch:
    """Return records of arrays as one, in order."""
    fields = zip(*(vars(p).values() for p in parts), strict=True)
    return type(parts[0])(*(np.concatenate(each, axis) for each in fields))


def variables(lower: np.ndarray, upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the middle and the half width of boxes; [middle - half, middle + half] covers the box.

    Parameters
    ----------
    lower, upper
        Shape [..., K].

    Returns
    -------
    middle, half
        Shape [..., K].
    """
    middle = 0.5 * (lower + upper)
    half = np.maximum(upper - middle, middle - lower)
    return middle, np.where(upper > lower, np.nextafter(half, np.inf), 0.0)


@lru_cache(maxsize=32)
def pairs(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the pairs v <= w of n variables, v and w [P], and the number of each, [n, n]."""
    first, second = np.triu_indices(n)
    number = np.zeros((n, n), dtype=int)
    number[first, second] = number[second, first] = np.arange(len(first))
    return first, second, number


@dataclass(frozen=True, eq=False)
class Quadratic:
    """Rows value + sum slopes_v xi_v + sum over v <= w of bends_vw xi_v xi_w, to within `rest`.

    Attributes
    ----------
    value, rest
        Shape [R, K].
    slopes
        Shape [R, n, K].
    bends
        Of the pairs v <= w of `pairs`, shape [R, P, K].
    """

    value: np.ndarray
    slopes: np.ndarray
    bends: np.ndarray
    rest: np.ndarray

    def __getitem__(self, which: Any) -> Quadratic:
        return Quadratic(*(part[which] for part in self.parts))

    def __add__(self, other: Quadratic) -> Quadratic:
        both = zip(self.parts, other.parts, strict=True)
        return Quadratic(*(a + b for a, b in both))

    def __mul__(self, other: Quadratic) -> Quadratic:
        x, y = self, other
        first, second, _ = pairs(x.slopes.shape[-2])
        cross_terms = x.slopes[..., first, :] * y.slopes[..., second, :]
        cross_terms += (first < second)[:, None] * (
            x.slopes[..., second, :] * y.slopes[..., first, :]
        )
        a, b = (np.abs(v.slopes).sum(axis=-2) for v in (x, y))
        p, q = (np.abs(v.bends).sum(axis=-2) for v in (x, y))
        mx, my = x.magnitude(), y.magnitude()
        rest = a * q + b * p + p * q + mx * y.rest + my * x.rest
        v, w = x.value[..., None, :], y.value[..., None, :]
        return Quadratic(
            x.value * y.value,
            v * y.slopes + w * x.slopes,
            v * y.bends + w * x.bends + cross_terms,
            rest * SLIGHTLY + 32 * UNIT * mx * my,
        )

    @property
    def parts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Value, slopes, bends, rest."""
        return self.value, self.slopes, self.bends, self.rest

    def times(self, factor: float) -> Quadratic:
        """Return the rows times a number."""
        value, slopes, bends = (factor * v for v in self.parts[:3])
        return Quadratic(
            value, slopes, bends, abs(factor) * (self.rest + 8 * UNIT * self.magnitude())
        )

    def mapped(self, matrix: np.ndarray) -> Quadratic:
        """Return sums of the rows, weighed by a matrix."""
        size = np.abs(matrix)
        rounding = 4 * (matrix.shape[1] + 4) * UNIT * (size @ self.magnitude())
        value, slopes, bends = (np.tensordot(matrix, v, 1) for v in self.parts[:3])
        return Quadratic(value, slopes, bends, size @ self.rest * SLIGHTLY + rounding)

    def magnitude(self) -> np.ndarray:
        """Return an upper bound of the rows' size, [R, K]."""
        sums = [np.abs(v).sum(axis=-2) for v in (self.slopes, self.bends)]
        return (np.abs(self.value) + sums[0] + sums[1] + self.rest) * SLIGHTLY

    def affine(self) -> Affine:
        """Return rows of first order: xi_v^2 = (1 + eta) / 2 goes half to the centre, all else to the error."""
        first, second, _ = pairs(self.slopes.shape[-2])
        square = self.bends[..., first == second, :]
        error = np.abs(self.bends).sum(axis=-2) - 0.5 * np.abs(square).sum(axis=-2) + self.rest
        centre = self.value + 0.5 * square.sum(axis=-2)
        return padded(centre, self.slopes, error, self.magnitude(), self.slopes.shape[-2] + 1)


def number(value: np.ndarray, rest: float, n: int) -> Quadratic:
    """Return rows [R, K] that are constant to within `rest`, in n variables."""
    rows, boxes = value.shape
    none = np.zeros((rows, n, boxes)), np.zeros((rows, len(pairs(n)[0]), boxes))
    return Quadratic(value, *none, np.full(value.shape, rest))


@dataclass(frozen=True)
class Gap:
    """What closes where a ray touches.

    Attributes
    ----------
    kind
        ``facet``: ray k on the facet from ray j; ``start``, ``end``: ray k on the plane of that mirror; ``meet``:
        rays 0 and 3 of a D_1 wedge, in the plane of its mirrors, on each other: 3 on facet 0, or 0 on facet 2.
    rays
        (k, j), or (k,).
    """

    kind: str
    rays: tuple[int, ...]

    @property
    def text(self) -> str:
        """Which it is, 1-based."""
        k, *j = self.rays
        return f"ray {k + 1} on {f'facet {j[0] + 1}' if j else 'a mirror'}"


@dataclass(frozen=True, eq=False)
class Folded:
    """A chain at the middle of K boxes.

    Attributes
    ----------
    vectors
        Of `Chain.place`, [3, V, K].
    loop
        Product of the folds of the steps 0 .. `Chain.around` - 1 as the sheet has their rays, a unit quaternion [4, K].
    radii
        Half width of each step's turn, [E, K].
    near
        Sum of |turns|, or 1, [K].
    """

    vectors: np.ndarray
    loop: np.ndarray
    radii: np.ndarray
    near: np.ndarray


class Chain:
    """Rays in the order in which folds carry them: step p folds about ray p, and goes on by a sector to ray p + 1.

    Its vectors: ray p, number p; the normal of the facet after step p, number E + p; then along e2 before step 0, -e2
    after the last fold, e3 before step 0.

    Parameters
    ----------
    variable
        Of each step, -1 where its ray is no crease, [E].
    weight
        Turn of a step over its fold angle, 1 or 1/2, [E].
    sectors
        After each step, [E] [rad].
    around
        Steps of the loop.
    size
        Number of variables.
    """

    def __init__(
        self,
        variable: Sequence[int],
        weight: Sequence[float],
        sectors: Sequence[float],
        around: int,
        size: int,
    ) -> None:
        self.variable, self.weight = np.array(variable), np.array(weight)
        self.sectors, self.around, self.size = np.array(sectors), around, size
        self.steps = e = len(self.variable)
        self.folds = np.where(self.variable >= 0, self.weight, 0.0)
        self.first, self.last, self.up = 2 * e, 2 * e + 1, 2 * e + 2
        azimuth = [math.fsum(self.sectors[:p]) for p in range(e)]
        self.units = [(math.cos(a), math.sin(a), 0.0) for a in azimuth]
        # how many steps carry each vector
        self.place = [*range(e), *range(1, e + 1), 0, e, 0]
        self.rounding = 5 * CREASE * (e + 1)
        self.loop_rounding = UNIT * (40 * around + 4 * around**2)

    def ways(self, k: int, j: int) -> list[tuple[int, int]]:
        """Return ray k and the facet from ray j as places in the chain: round a loop forth and back."""
        n = self.around
        if n == self.steps:
            return [(k, j)]
        return [(j + (k - j) % n, j), (k, k + (j - k) % n)]

    def shortest(self, k: int, j: int) -> tuple[int, int]:
        """Return ray k and the facet from ray j as places in the chain, by the way with fewer folds between."""
        return min(self.ways(k, j), key=lambda way: abs(way[0] - way[1]))

    def gap(self, k: int, j: int) -> tuple[int, int, int]:
        """Return the vectors whose triple product is zero where ray k is in the plane of the facet from ray j."""
        return (j, j + 1, k) if k > j else (k, j, j + 1)

    def gap_slopes(self, k: int, j: int) -> dict[int, tuple[int, int, int]]:
        """Return those of its derivatives, but for a common factor, by variable; j before k."""
        steps = [i for i in range(j + 1, k) if self.folds[i]]
        return {int(self.variable[i]): (self.steps + j, i, k) for i in steps}

    def inside(self, k: int, j: int) -> list[tuple[int, int, int]]:
        """Return those of two that are both negative where ray k, in that plane, is inside the facet."""
        z = self.steps + j
        return [(z, j + 1, k), (j, z, k)] if k > j else [(k, j, z), (k, z, j + 1)]

    def closed(self, k: int, j: int = -1, *, kind: str) -> tuple[int, int, int]:
        """Return those of a gap (`touches.Gap`): off a facet, or off the first mirror or the last."""
        e = self.steps - 1
        off_mirror = (k, e, self.steps + e) if kind == "end" else (self.up, 0, k)
        return off_mirror if j < 0 else self.gap(*self.shortest(k, j))

    def fold(self, middle: np.ndarray, half: np.ndarray) -> Folded:
        """Fold at the middle [n, K] of boxes of half widths [n, K] [rad]."""
        boxes, e = middle.shape[1], self.steps
        vectors = np.zeros((3, 2 * e + 3, boxes))
        x, y, z = (np.repeat(v[:, None], boxes, axis=1) for v in np.eye(3))
        vectors[:, self.first], vectors[:, self.up] = y, z
        loop = (np.ones(boxes), np.zeros(boxes), np.zeros(boxes), np.zeros(boxes))
        for p in range(e):
            vectors[:, p] = x
            if self.folds[p]:
                turn = self.folds[p] * middle[self.variable[p]]
                c, s = np.cos(turn), np.sin(turn)
                y, z = c * y + s * z, c * z - s * y
                if p < self.around:
                    half_turn = np.cos(0.5 * turn), np.sin(0.5 * turn)
                    loop = quaternion.multiply(loop, quaternion.fold(*half_turn, self.units[p]))
            vectors[:, e + p] = z
            vectors[:, self.last] = -y
            c, s = np.cos(self.sectors[p]), np.sin(self.sectors[p])
            x, y = c * x + s * y, c * y - s * x
        size = np.abs(self.folds[:, None] * middle[self.variable]).sum(axis=0)
        radii = self.folds[:, None] * half[self.variable]
        return Folded(vectors, np.stack(loop), radii, np.minimum(1.0, size))

    def turned(
        self,
        v: np.ndarray,
        axes: np.ndarray,
        steps: Sequence[int],
        radii: np.ndarray,
        known: np.ndarray | float,
    ) -> Quadratic:
        """Return the entries of a unit quaternion [4, K], or of a unit vector [3, K], turned by some steps.

        Parameters
        ----------
        v
            Q(c_1, t_1) ... Q(c_m, t_m) v is taken of a quaternion, the vector so rotated of a vector.
        axes
            c of each step, [3, m, K].
        steps
            Their numbers.
        radii
            Of t, negative where a turn goes the other way, [m, K].
        known
            What is not known of v, [4, K] or [3, K] or for all.

        Returns
        -------
        Quadratic
            Slopes are D_i v, D = c / 2 from the left or c x, bends D_i D_j v, and half of that for i = j.
        """
        n, boxes, entries = self.size, v.shape[1], len(v)
        product, beta = (times_half, 0.5) if entries == 4 else (cross, 1.0)
        number_of = pairs(n)[2]
        slopes = np.zeros((entries, n, boxes))
        bends = np.zeros((entries, len(pairs(n)[0]), boxes))
        for j in range(len(steps) - 1, -1, -1):
            w = self.variable[steps[j]]
            one = radii[j] * product(axes[:, j], v)
            slopes[:, w] += one
            bends[:, number_of[w, w]] += 0.5 * radii[j] * product(axes[:, j], one)
            for i in range(j):
                bends[:, number_of[self.variable[steps[i]], w]] += radii[i] * product(
                    axes[:, i], one
                )
        s = np.abs(radii).sum(axis=0)
        rest = (beta * s) ** 3 / 6 * SLIGHTLY + self.rounding * (s + s * s) + known
        return Quadratic(v, slopes, bends, rest * np.ones((entries, 1)))


def times_half(c: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Multiply quaternions [4, K] by half of vectors [3, K] from the left."""
    return 0.5 * times_vector(c, q)


def times_vector(c: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Multiply quaternions [4, K] by vectors [3, K] from the left."""
    scalar = -(c[0] * q[1] + c[1] * q[2] + c[2] * q[3])
    return np.concatenate([scalar[None], q[0] * c + cross(c, q[1:])])


def cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Multiply vectors [3, ...]."""
    on, back = [1, 2, 0], [2, 0, 1]
    return u[on] * v[back] - u[back] * v[on]


class Triples:
    """Triple products u . (v x w) of vectors of a chain, with their first and second derivatives.

    The folds between u and v turn v and w, those between v and w turn w: with c their axes the derivative by some
    folds is u . (a x (b x ... (y x w))), a, b, ... the axes and v in the order of the chain.

    Parameters
    ----------
    chain
        The chain.
    wanted
        u, v, w, numbers of its vectors in the order of their places, [T].
    """

    def __init__(self, chain: Chain, wanted: Sequence[tuple[int, int, int]]) -> None:
        self.chain, self.wanted, self.count = chain, tuple(wanted), len(wanted)
        pair_of = pairs(chain.size)[2]
        left: dict[tuple[int, int], int] = {}
        right: dict[tuple[int, int], int] = {}
        third: dict[tuple[int, int], int] = {}
        values, slopes, bends = [], [], []
        between = np.zeros((self.count, chain.steps))

        def once(table: dict[tuple[int, int], int], a: int, b: int) -> int:
            return table.setdefault((a, b), len(table))

        for t, (u, v, w) in enumerate(wanted):
            place = chain.place
            turns = [
                s
                for s in range(place[u], place[w])
                if chain.folds[s] and not u == s  # a turn about u itself leaves the product
            ]
            values.append((u, once(right, v, w)))
            for i, a in enumerate(turns):
                between[t, a] = 1.0
                x, y = self._order((a,), v)
                slopes.append((t, chain.variable[a], a, a, once(left, u, x), once(right, y, w)))
                for b in turns[i:]:
                    x, y, z = self._order((a, b), v)
                    number = pair_of[chain.variable[a], chain.variable[b]]
                    two = once(third, y, once(right, z, w))
                    bends.append((t, number, a, b, once(left, u, x), two))
        self.values = np.array(values, dtype=int).reshape(-1, 2)
        self.slopes = np.array(slopes, dtype=int).reshape(-1, 6)
        self.bends = np.array(bends, dtype=int).reshape(-1, 6)
        self.between = between
        places = np.array([[chain.place[u], chain.place[w]] for u, _, w in wanted]).reshape(-1, 2)
        self.before, self.steps = places[:, :1], np.diff(places, axis=1)
        # of vectors that are in the plane of the sheet where it is flat
        upright = {chain.up, *range(chain.steps, 2 * chain.steps)}
        self.planar = np.array([[upright.isdisjoint(t)] for t in wanted], dtype=bool).reshape(-1, 1)
        self.left, self.right, self.third = (
            np.array([*table], dtype=int).reshape(-1, 2) for table in (left, right, third)
        )

    def _order(self, steps: tuple[int, ...], v: int) -> list[int]:
        """Axes of steps, and v, in the order of the chain."""
        at = self.chain.place[v]
        return [*(s for s in steps if s < at), v, *(s for s in steps if s >= at)]

    def at(self, folded: Folded) -> Quadratic:
        """Return them over boxes, T rows."""
        chain, x, r = self.chain, folded.vectors, folded.radii
        n, boxes = chain.size, x.shape[2]
        one = cross(x[:, self.right[:, 0]], x[:, self.right[:, 1]])
        left = cross(x[:, self.left[:, 0]], x[:, self.left[:, 1]])
        two = cross(x[:, self.third[:, 0]], one[:, self.third[:, 1]])
        u, v = self.values.T
        value = (x[:, u] * one[:, v]).sum(axis=0)
        slopes = np.zeros((self.count, n, boxes))
        t, w, a, _, u, v = self.slopes.T
        slopes[t, w] = (left[:, u] * one[:, v]).sum(axis=0) * r[a]
        bends = np.zeros((self.count, len(pairs(n)[0]), boxes))
        t, w, a, b, u, v = self.bends.T
        share = np.where(a == b, 0.5, 1.0)[:, None]
        bends[t, w] = (left[:, u] * two[:, v]).sum(axis=0) * (share * r[a] * r[b])
        s = self.between @ r
        rest = s**3 / 6 * SLIGHTLY + chain.rounding * (s + s * s)
        near = np.where(self.planar, folded.near, 1.0)
        rest += CREASE * ((2 * self.steps + 1) * near + 3 * self.before * np.abs(value))
        return Quadratic(value, slopes, bends, rest)
