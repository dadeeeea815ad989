"""Forms over a box, in ball arithmetic: what the check of a proof computes with.

Written from the mathematics alone, in python-flint's `arb` (midpoint and radius, every operation rounded
outwards); nothing here comes from the search that made the proof.

Each free angle is x_j = m_j + r_j xi_j with |xi_j| <= 1.  With t = r xi: cos t lies in [cos r, 1], and
|sin t - xi sin r| <= d for d = sin t* - s t*, s = sin(r)/r, cos t* = s (the chord lies below the concave
sine, farthest where slopes agree).  So cosine and sine of x are c0 + c1 xi with c0 a ball, and a product of
rotations about fixed axes, each angle used once, is a polynomial in the xi of degree one in each: its
coefficients are computed as they are, products of balls.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from typing import Any

from flint import arb, arb_mat

Box = tuple[tuple[float, float], ...]
"""Lower and upper end of each fold angle [rad]; of a pinned one unused."""
Form = tuple[Any, dict[int, Any]]
"""Centre (a ball) and coefficients of the xi: the centre's radius holds all that is not linear."""
Terms = dict[int, Any]
"""Coefficients (column matrices) of products of xi, by the set of their indices as bits."""

AROUND = arb(0, 1)
"""[-1, 1]."""
SQUARE = arb(0.5, 0.5)
"""[0, 1], where xi^2 lies."""
THIN = 1e-3
"""Half widths [rad] below which the chord's error is bounded by a power: nothing cancels."""


def diagonal(size: int, value: Any) -> Any:
    """A ball times the identity."""
    return arb_mat(size, size, [value if i % (size + 1) == 0 else 0 for i in range(size * size)])


def parts(low: float, high: float) -> tuple[Any, Any]:
    """Return m, r (exact) such that [low, high] is in m + r [-1, 1]."""
    m = arb(0.5 * (low + high))
    up, down = (arb(high) - m).upper(), (m - arb(low)).upper()
    return m, up if up >= down else down


def circle(low: float, high: float, over: int) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """Return (c0, c1), (s0, s1): cosine and sine of x/over for x in [low, high] as c0 + c1 xi.

    Parameters
    ----------
    low, high
        Ends of x, at most 2 pi apart.
    over
        1, 2 for half angles, 4 for half of those.
    """
    middle, radius = parts(low, high)
    sine, cosine = (middle / over).sin_cos()
    r = radius / over
    if r == 0:
        return (cosine, arb(0)), (sine, arb(0))
    chord, end = r.sin_cos()
    # cos t in [cos r, 1]
    even = (1 + end) / 2 + AROUND * ((1 - end) / 2)
    if (
        r < THIN
    ):  # sin t - s t is concave in t >= 0, zero at 0 and r, its second derivative within r
        # a concave function that is 0 at both ends, |f''| <= r, is at most r r^2 / 8
        bulge = r**3 / 8
    else:
        s = chord / r
        bulge = (1 - s * s).sqrt() - s * s.acos()
    odd = AROUND * abs(bulge)
    return (cosine * even - sine * odd, -sine * chord), (sine * even + cosine * odd, cosine * chord)


def carry(start: Any, maps: Iterable[tuple[int, Any, Any]]) -> Terms:
    """Apply maps T0 + T1 xi_j, one after the other, to a column; T1 None: a constant map."""
    terms = {0: start}
    for j, constant, slope in maps:
        more = {} if slope is None else {mask | 1 << j: slope * v for mask, v in terms.items()}
        terms = {mask: constant * v for mask, v in terms.items()} | more
    return terms


def linear(terms: Terms) -> list[Form]:
    """Return the rows of a polynomial as forms: products of several xi go to the centre's radius."""
    rows = terms[0].nrows()
    centres, slopes = terms[0].entries(), [dict[int, Any]() for _ in range(rows)]
    for mask, column in terms.items():
        if mask and mask & (mask - 1):
            for r, value in enumerate(column.entries()):
                centres[r] += AROUND * value
        # one bit: linear in one xi; several: a product of them, in [-1, 1]
        elif mask:
            for r, value in enumerate(column.entries()):
                slopes[r][mask.bit_length() - 1] = value
    return list(zip(centres, slopes, strict=True))


def add(x: Form, y: Form, sign: int = 1) -> Form:
    """Return x + sign y."""
    slopes = dict(x[1])
    for j, value in y[1].items():
        value = value if sign > 0 else -value
        slopes[j] = slopes[j] + value if j in slopes else value
    return (x[0] + y[0] if sign > 0 else x[0] - y[0]), slopes


def times(x: Form, y: Form) -> Form:
    """Return x y: xi_j^2 lies in [0, 1], each product of two different xi in [-1, 1]."""
    (a, g), (b, h) = x, y
    if not h:
        return a * b, {j: value * b for j, value in g.items()}
    if not g:
        return a * b, {j: value * a for j, value in h.items()}
    centre = a * b
    keys = sorted({*g, *h})
    spread = arb(0)
    for j, k in itertools.combinations(keys, 2):
        mixed = arb(0)
        if j in g and k in h:
            mixed += g[j] * h[k]
        if k in g and j in h:
            mixed += g[k] * h[j]
        spread += abs(mixed)
    slopes = {}
    for j in keys:
        if j not in g:
            slopes[j] = a * h[j]
        elif j not in h:
            slopes[j] = b * g[j]
        else:
            slopes[j] = a * h[j] + b * g[j]
            # xi_j^2 in [0, 1]
            centre += g[j] * h[j] * SQUARE
    return centre + AROUND * spread, slopes


def cross(x: Sequence[Form], y: Sequence[Form]) -> list[Form]:
    """Vector product of two vectors of forms."""
    return [
        add(times(x[1], y[2]), times(x[2], y[1]), -1),
        add(times(x[2], y[0]), times(x[0], y[2]), -1),
        add(times(x[0], y[1]), times(x[1], y[0]), -1),
    ]


def dot(x: Sequence[Form], y: Sequence[Form]) -> Form:
    """Scalar product of two vectors of forms."""
    return add(add(times(x[0], y[0]), times(x[1], y[1])), times(x[2], y[2]))


def nonzero(form: Form) -> bool:
    """Return whether a form certainly differs from 0 everywhere."""
    return bool(abs(form[0]) > sum((abs(v) for v in form[1].values()), arb(0)))


def scaled(form: Form, factor: Any) -> Form:
    """Return a form times a ball."""
    return form[0] * factor, {j: v * factor for j, v in form[1].items()}


def minor(torques: Sequence[Form], others: Sequence[Form]) -> Form:
    """Determinant expanded along its column G: `others` are the minors without each row, in order."""
    total = times(torques[0], others[0])
    for p in range(1, len(torques)):
        total = add(total, times(torques[p], others[p]), -1 if p % 2 else 1)
    return total
