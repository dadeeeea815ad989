"""Facets that come to lie edge to edge just as a curve ends folded flat: apart before, or crossing, by third order.

With tau = cot |theta|, which is 0 at the end, all corners are analytic in tau: x and y even, z odd.  Determinants of
corners are odd then, and have the sign of their slope, or where their corners fold onto one line, so that it is 0, of
their third derivative over [0, tau].  Let e, f be sides of two facets that fold onto one line:

- the facets are apart if e x f has all else of one below e, all else of the other above f, and f above e;
- they cross if e goes through the other facet inside, or f does.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Any

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.proof.ball_vectors import part
from origami_nlp.proof.balls import Ball, exact
from origami_nlp.proof.strip_contact import APART, CROSSING, UNKNOWN, StripContact

ORDER = 4
"""Coefficients of a series."""


@dataclass(frozen=True, eq=False)
class Taylor:
    """A function of tau over an interval, with its derivatives over k! there."""

    terms: tuple[Ball, ...]

    def __add__(self, other: Taylor) -> Taylor:
        return Taylor(tuple(map(add, self.terms, other.terms)))

    def __neg__(self) -> Taylor:
        return Taylor(tuple(-x for x in self.terms))

    def __mul__(self, other: Taylor) -> Taylor:
        a, b = self.terms, other.terms
        return Taylor(
            tuple(reduce(add, (a[i] * b[k - i] for i in range(k + 1))) for k in range(ORDER))
        )

    def at(self, index: Any) -> Taylor:
        """Return what an index selects."""
        return Taylor(tuple(part(x, index) for x in self.terms))

    def inverse(self) -> Taylor:
        """Return 1/f."""
        first, *rest = self.terms
        found = [first.inverse()]
        for k in range(1, ORDER):
            total = reduce(add, (rest[i] * found[k - 1 - i] for i in range(k)))
            found.append(-(found[0] * total))
        return Taylor(tuple(found))


class FoldedEdges:
    """Facets of a sheet for tau from 0 to `reach`.

    Parameters
    ----------
    contact
        Of the sheet.
    rows
        Multiplier, sign and creases of each row that reaches the end: those of `FoldingCurve`.
    still
        Of other creases: 0, or +-1 times 180 degrees.
    side, reach
        Which end of the curve, and up to which tau.
    deviation
        By how much directions of creases may be off [rad].

    Attributes
    ----------
    off
        By how much corners that are taken to fold onto one line are off it.
    """

    def __init__(
        self,
        contact: StripContact,
        rows: Iterable[tuple[Ball, int, Sequence[tuple[int, int]]]],
        still: Mapping[int, int],
        side: int,
        reach: float,
        deviation: float,
    ) -> None:
        self.off, self.room = (
            0.0,
            CLOSURE_TOL * float(np.ptp(contact.pattern.corners, axis=0).max()),
        )
        self.contact, self.deviation = contact, np.asarray(4 * deviation)
        self._still = {c: (_constant(0.0), _constant(-1.0 if s else 1.0)) for c, s in still.items()}
        self._rows = [(k, s * side, creases) for k, s, creases in rows]
        self._flat = [
            np.array([x.terms[0].centre[:2, 0] @ (1, 1j) for x in p]) for p in self._placed(0.0)
        ]
        self._corners = self._placed(reach)

    def _placed(self, reach: float) -> list[list[Taylor]]:
        """Return the corners of each polygon, [3, 1]."""
        folds = dict(self._still)
        for kappa, sign, creases in self._rows:
            s, c = _sine_and_cosine(kappa, reach)
            folds |= {x: (s if sign * t > 0 else -s, c) for x, t in creases}
        pattern, slack = self.contact.pattern, self.deviation
        size = np.abs(pattern.corners).max()
        places = exact(pattern.corners.T).widened(slack * size)
        unit, one = _constant(np.eye(3)), _constant(1.0)
        turn, shift = {0: unit}, {0: _constant(np.zeros((3, 1)))}
        for facet, before, crease, _, both in self.contact.steps:
            once, twice = (_still(part(x, np.s_[..., 0]).widened(2 * slack)) for x in both)
            s, c = folds[crease]
            r = unit + s * once + (one + -c) * twice
            o = _still(part(places, np.s_[:, [pattern.ends[crease, 0]]]))
            shift[facet] = _product(turn[before], o + -_product(r, o)) + shift[before]
            turn[facet] = _product(turn[before], r)
        found = []
        for polygon, f in zip(pattern.polygons, pattern.facet_of.tolist(), strict=True):
            own = [_still(part(places, np.s_[:, [v]])) for v in polygon]
            found.append([_product(turn[f], x) + shift[f] for x in own])
        return found

    def pair(self, a: int, b: int) -> int:
        """Return APART or CROSSING where sides of two polygons fold onto one line and decide it, else UNKNOWN."""
        for i, j in itertools.product(*(range(len(self._flat[p])) for p in (a, b))):
            x, y = (self._corners[p][k:] + self._corners[p][:k] for p, k in ((a, i), (b, j)))
            if not self._in_line(a, i, b, j):
                continue
            e, f = x[1] + -x[0], y[1] + -y[0]
            gap = _sign(e, f, y[0] + -x[0], 3)
            below, above = ({_sign(e, f, z + -p[0]) for z in p[2:]} for p in (x, y))
            if gap and above == {gap} and below == {-gap}:
                return APART
            if gap and (_passes(x, y, -gap) or _passes(y, x, -gap)):
                return CROSSING
        return UNKNOWN

    def _in_line(self, a: int, i: int, b: int, j: int) -> bool:
        """Return whether side i of polygon a and side j of polygon b fold onto one line."""
        x, y = (np.roll(self._flat[p], -k)[:2] for p, k in ((a, i), (b, j)))
        far = max(
            float(np.abs((np.conj(u[1] - u[0]) * (v - u[0])).imag).max() / abs(u[1] - u[0]))
            for u, v in ((x, y), (y, x))
        )
        if far <= self.room:
            self.off = max(self.off, far)
        return far <= self.room


def _still(x: Ball) -> Taylor:
    """Return a function that is constant."""
    zero = exact(np.zeros_like(x.centre))
    return Taylor((x, *[zero] * (ORDER - 1)))


def _constant(x: np.ndarray | float) -> Taylor:
    return _still(exact(x))


def _sine_and_cosine(kappa: Ball, reach: float) -> tuple[Taylor, Taylor]:
    """Return those of pi - 2 atan(tau/kappa) for 0 <= tau <= reach."""
    tau, rate = Ball(np.array(0.5 * reach), np.array(0.5 * reach)), kappa.inverse()
    x = Taylor((tau * rate, rate, exact(0.0), exact(0.0)))
    one = _constant(1.0)
    share = (one + x * x).inverse()
    return (x + x) * share, (x * x + -one) * share


def _product(a: Taylor, b: Taylor) -> Taylor:
    """Return the product of matrices [3, 3] and [3, m]."""
    terms = [a.at(np.s_[:, j, None]) * b.at(np.s_[None, j]) for j in range(3)]
    return terms[0] + terms[1] + terms[2]


def _sign(a: Taylor, b: Taylor, c: Taylor, order: int = 1) -> int:
    """Return the sign of det(a, b, c), which is odd in tau, of vectors [3, 1]."""
    (a0, a1, a2), (b0, b1, b2), (c0, c1, c2) = ([v.at(i) for i in range(3)] for v in (a, b, c))
    found = a0 * (b1 * c2 + -(b2 * c1)) + a1 * (b2 * c0 + -(b0 * c2)) + a2 * (b0 * c1 + -(b1 * c0))
    return int(found.terms[order].sign[0])


def _passes(x: list[Taylor], y: list[Taylor], gap: int) -> bool:
    """Return whether the first side of x goes through polygon y inside, and past its first side in this sense."""
    n = len(y)
    plane = [y[k] + -y[0] for k in (n // 3, 2 * n // 3)]
    ends = [_sign(plane[0], plane[1], z + -y[0]) for z in x[:2]]
    if ends[0] * ends[1] >= 0:
        return False
    e = x[1] + -x[0]
    past = {_sign(e, y[k] + -x[0], y[(k + 1) % n] + -x[0]) for k in range(1, n)}
    return past == {gap}
