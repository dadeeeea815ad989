"""Affine forms with proved rounding: x = centre + sum_j slopes_j xi_j + error eta, every |xi_j|, |eta| <= 1, in
batches.

The xi_j are the box: variable j is mid_j + radius_j xi_j.  So a form keeps how it depends on the variables, to first
order, and only what is of second order goes to `error`.  The last axis of every array is the batch of K boxes; the
axis before it, of `slopes`, the d variables of the form.

Rounding.  With u = 2^-53 a sum of n terms in any order is computed to gamma_{n-1} sum |term|, gamma_n = n u / (1 - n
u), a product to u (Higham, Accuracy and Stability of Numerical Algorithms, 3.1 and 4.2).  Each coefficient of a result
(centre, slopes, error) is a sum of at most n products of coefficients of the arguments, so the sum of what rounding
does to all of them is at most gamma_{n+1} times the sum of all these products' absolute values; and as a coefficient
of x y takes each pair of coefficients of x and y once, that is at most gamma_{n+1} M(x) M(y) with M(x) = |centre| +
sum |slopes| + error. `padded` adds 2 (n + 4) u M(x) M(y) to the error, twice what is needed, for the rounding of M and
of the sum; it enlarges the error by 2^-40 of itself, and adds 2^-1000, for products that underflow.

What is trusted: IEEE 754 doubles, rounded to nearest; NumPy's sine and cosine to 4 ulp (1 is usual), 2^-50 of
themselves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

UNIT = 2.0**-53
"""Unit roundoff u of doubles."""
TINY = 2.0**-1000
"""More than what underflow can lose in a sum of products."""
SLIGHTLY = 1.0 + 2.0**-40
"""Factor above what rounding does to sums of up to a thousand errors."""
TRIGONOMETRIC = 2.0**-50
"""Relative error of NumPy's sine and cosine that is allowed for: 4 ulp."""


@dataclass(frozen=True, eq=False)
class Affine:
    """Affine forms of one shape over K boxes.

    Attributes
    ----------
    centre
        Shape [..., K].
    slopes
        Of the d variables, shape [..., d, K].
    error
        At least 0, shape [..., K].
    """

    centre: np.ndarray
    slopes: np.ndarray
    error: np.ndarray

    @cached_property
    def _spread(self) -> np.ndarray:
        return np.abs(self.slopes).sum(axis=-2)

    @cached_property
    def _magnitude(self) -> np.ndarray:
        d = self.slopes.shape[-2]
        return (np.abs(self.centre) + self._spread + self.error) * (1 + 4 * (d + 4) * UNIT)

    def spread(self) -> np.ndarray:
        """Return sum |slopes|, [..., K], as computed."""
        return self._spread

    def magnitude(self) -> np.ndarray:
        """Return an upper bound of |x| over the box, [..., K]."""
        return self._magnitude

    def radius(self) -> np.ndarray:
        """Return an upper bound of |x - centre| over the box, [..., K]."""
        d = self.slopes.shape[-2]
        return (self.spread() + self.error) * (1 + 4 * (d + 4) * UNIT)

    def nonzero(self) -> np.ndarray:
        """Return where x certainly differs from zero over the box, [..., K]."""
        return np.abs(self.centre) > self.radius()

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Return a lower and an upper bound of x over the box, [..., K]."""
        radius = self.radius()
        return np.nextafter(self.centre - radius, -np.inf), np.nextafter(
            self.centre + radius, np.inf
        )

    def signs(self) -> np.ndarray:
        """Return the sign of x over the box, [..., K]; 0 where it is not certain."""
        low, high = self.bounds()
        return np.where(low > 0, 1, np.where(high < 0, -1, 0))

    def on(self, count: int, places: slice | Sequence[int] | None = None) -> Affine:
        """Return the same forms in `count` variables: theirs are those at `places`, by default the first."""
        own = slice(self.variables) if places is None else places
        shape = (*self.slopes.shape[:-2], count, self.slopes.shape[-1])
        slopes = np.zeros(shape)
        slopes[..., own, :] = self.slopes
        return Affine(self.centre, slopes, self.error)

    @property
    def variables(self) -> int:
        """Number of variables."""
        return int(self.slopes.shape[-2])

    def __getitem__(self, index: object) -> Affine:
        """Select along the axes before the batch (and before the variables)."""
        i = index if isinstance(index, tuple) else (index,)
        part = Affine(self.centre[i], self.slopes[i], self.error[i])
        for name in self.__dict__.keys() & {"_spread", "_magnitude"}:
            part.__dict__[name] = self.__dict__[name][i]
        return part

    def __neg__(self) -> Affine:
        out = Affine(-self.centre, -self.slopes, self.error)
        for name in self.__dict__.keys() & {"_spread", "_magnitude"}:
            out.__dict__[name] = self.__dict__[name]
        return out

    def __add__(self, other: Affine) -> Affine:
        total = self.magnitude() + other.magnitude()
        return padded(
            self.centre + other.centre,
            self.slopes + other.slopes,
            self.error + other.error,
            total,
            2,
        )

    def __sub__(self, other: Affine) -> Affine:
        return self + -other

    def __mul__(self, other: Affine) -> Affine:
        """Multiply; xi_j^2 is in [0, 1], and the terms of xi_i xi_j and xi_j xi_i are bounded apart."""
        x, y = self, other
        mx, my = x.magnitude(), y.magnitude()
        # x_j y_j xi_j^2 = x_j y_j (1 + eta) / 2: half of it goes to the centre, half to the error
        same = x.slopes * y.slopes
        centre = x.centre * y.centre + 0.5 * same.sum(axis=-2)
        # (x0 + x1)(y0 + y1) = x0 y0 + (x0 y1 + y0 x1) + x1 y1
        slopes = x.centre[..., None, :] * y.slopes + y.centre[..., None, :] * x.slopes
        error = x.spread() * y.spread() - 0.5 * np.abs(same).sum(axis=-2)
        error = error + mx * y.error + my * x.error
        return padded(centre, slopes, error, mx * my, 2 * same.shape[-2] + 4)

    def scaled(self, factor: np.ndarray | float, doubt: np.ndarray | float = 0.0) -> Affine:
        """Multiply by numbers [..., K] that are known to within `doubt`."""
        f = np.asarray(factor, dtype=float)
        magnitude = self.magnitude()
        error = np.abs(f) * self.error + doubt * magnitude
        slopes = (f[..., None, :] if f.ndim else f) * self.slopes
        return padded(f * self.centre, slopes, error, (np.abs(f) + doubt) * magnitude, 2)


def padded(
    centre: np.ndarray, slopes: np.ndarray, error: np.ndarray, total: np.ndarray, terms: int
) -> Affine:
    """Allow for rounding: coefficients are sums of `terms` products whose absolute values sum to at most `total`."""
    return Affine(centre, slopes, error * SLIGHTLY + (2 * (terms + 4) * UNIT) * total + TINY)


def stacked(forms: Sequence[Affine], boxes: int = 0, count: int = 0) -> Affine:
    """Return forms of one shape as one; where there are none, none in `count` variables over so many boxes."""
    if not forms:
        return Affine(np.zeros((0, boxes)), np.zeros((0, count, boxes)), np.zeros((0, boxes)))
    return Affine(*map(np.stack, zip(*map(parts, forms), strict=True)))


def concatenated(forms: Sequence[Affine], axis: int = 0) -> Affine:
    """Return forms one after the other along an axis before the batch."""
    return Affine(*(np.concatenate(v, axis=axis) for v in zip(*map(parts, forms), strict=True)))


def parts(x: Affine) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return centre, slopes and error."""
    return x.centre, x.slopes, x.error


def constant(values: np.ndarray, doubt: float, variables: int, boxes: int) -> Affine:
    """Return numbers of shape [...], known to within `doubt`, as forms of `variables` variables over `boxes` boxes."""
    shape = (*np.shape(values), boxes)
    centre = np.broadcast_to(np.asarray(values, dtype=float)[..., None], shape)
    slopes = np.zeros((*np.shape(values), variables, boxes))
    return Affine(centre, slopes, np.full(shape, doubt))


def dot(x: Affine, y: Affine) -> Affine:
    """Sum the products of x and y along the last axis before the batch.

    Terms of second order are added up before they are bounded: sum_n (x_ni y_nj + x_nj y_ni) is the slope of
    xi_i xi_j.

    Parameters
    ----------
    x, y
        Centres of shape [..., n, K].

    Returns
    -------
    Affine
        Shape [..., K].
    """
    mx, my = x.magnitude(), y.magnitude()
    total = (mx * my).sum(axis=-2)
    second = np.einsum("...nik,...njk->...ijk", x.slopes, y.slopes)
    d = second.shape[-2]
    i = np.arange(d)
    same = second[..., i, i, :]
    centre = (x.centre * y.centre).sum(axis=-2) + 0.5 * same.sum(axis=-2)
    slopes = (x.centre[..., None, :] * y.slopes + y.centre[..., None, :] * x.slopes).sum(axis=-3)
    mixed = np.abs(second + np.swapaxes(second, -3, -2)).sum(axis=(-3, -2))
    # each pair i, j stands in `mixed` twice, and the diagonal as twice its size
    error = 0.5 * mixed - 0.5 * np.abs(same).sum(axis=-2)
    error = error + (mx * y.error + my * x.error).sum(axis=-2)
    return padded(centre, slopes, error, total, (d * d + 4) * x.centre.shape[-2] + d)


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


@dataclass(frozen=True, eq=False)
class Turn:
    """Cosine and sine of an angle over boxes: the middle, and what lies within r of it.

    With t = r xi, |xi| <= 1: cos t = mean + spread eta and sin t = slope xi + miss eta', |eta|, |eta'| <= 1.

    Attributes
    ----------
    cosine, sine
        Of the middle; known to within `TRIGONOMETRIC`, or exact where `exact`.
    mean, spread
        (1 + cos r) / 2 and (1 - cos r) / 2.
    slope, miss
        sin r, that of the chord, and the largest distance of the sine from it: sin t* - s t*, cos t* = s = sin r / r,
        which is at most r^3 / (9 sqrt 3), since |sin''(t)| <= t.
    most
        Bound of |sin t|: sin r for r <= pi / 2, where the mean is at least 1/2.
    """

    cosine: np.ndarray
    sine: np.ndarray
    mean: np.ndarray
    spread: np.ndarray
    slope: np.ndarray
    miss: np.ndarray
    most: np.ndarray


def with_centre(cosine: np.ndarray, sine: np.ndarray, half: np.ndarray) -> Turn:
    """Return the turn by angles within half <= pi of those whose cosine and sine are given (exact ones of +-pi)."""
    spread = np.sin(0.5 * half) ** 2
    slope = np.sin(half)
    ratio = np.clip(slope / np.where(half > 0, half, 1.0), 0.0, 1.0)
    at = np.arccos(ratio)
    # near its largest value the distance does not depend on `at` to first order
    # 9 sqrt 3 = 15.5884...: rounded down, so that the bound is rounded up
    miss = np.minimum(half**3 * (1 / 15.588), np.sin(at) - ratio * at + 16 * TRIGONOMETRIC)
    mean = 1.0 - spread
    most = np.where(mean < 0.5, 1.0, np.abs(slope))
    return Turn(cosine, sine, mean, spread, slope, np.maximum(miss, 0.0), most)


def turned(x: Affine, y: Affine, by: Turn) -> Affine:
    """Return cos(t) x + sin(t) y, where t = r xi is a new variable (the last one) that x and y do not depend on.

    Parameters
    ----------
    x, y
        Shape [..., K]; they are at the middle of the turn already.
    by
        Shape [K], or one that broadcasts.

    Returns
    -------
    Affine
        Shape [..., K], one variable more.
    """
    mx, my = x.magnitude(), y.magnitude()
    # sin t y = slope xi y + miss: of xi y only the centre of y stays linear, its slopes and error are of second order
    new = by.slope * y.centre
    cross = (by.slope[..., None, :] * y.slopes) if y.slopes.shape[-2] else y.slopes
    error = np.abs(cross).sum(axis=-2) + by.spread * mx + by.miss * my
    error = error + x.error + by.most * y.error  # |cos t| <= 1
    slopes = np.concatenate([by.mean[..., None, :] * x.slopes, new[..., None, :]], axis=-2)
    total = mx + np.abs(by.slope) * my
    raw = padded(by.mean * x.centre, slopes, error, total, x.slopes.shape[-2] + 8)
    return Affine(raw.centre, raw.slopes, raw.error + (4 * TRIGONOMETRIC) * total)


def mixed(x: Affine, a: np.ndarray, y: Affine, b: np.ndarray, doubt: float = 0.0) -> Affine:
    """Return a x + b y, a and b [..., K] known to `TRIGONOMETRIC` of themselves; where a cosine and a sine are those of
    an angle in doubt, to within `doubt` (|a| + |b|) besides: what the one misses is of the size of the other.
    """
    mx, my = x.magnitude(), y.magnitude()
    total = np.abs(a) * mx + np.abs(b) * my
    centre = a * x.centre + b * y.centre
    slopes = a[..., None, :] * x.slopes + b[..., None, :] * y.slopes
    error = np.abs(a) * x.error + np.abs(b) * y.error + TRIGONOMETRIC * total
    if doubt:
        error = error + doubt * (np.abs(a) + np.abs(b)) * (mx + my)
    return padded(centre, slopes, error, total, 4)
