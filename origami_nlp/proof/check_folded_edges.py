"""Facets whose sides fold onto one line just as a curve ends folded flat, for the check of a proof.

With t = 1/T, volumes that corners span are odd in t: v(t) = v'(x) t, and v(t) = v'''(x) t^3/6 for corners on one line
at t = 0, with x between 0 and t.  Derivatives are enclosed over all of that by power series.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Any

from flint import arb, ctx

from origami_nlp.proof.check_layers import GRAZING
from origami_nlp.proof.check_strip_contact import (
    CheckedContact,
    Point,
    _common_sign,
    _corners_of_plane,
    _dot,
    _minus,
    _product,
    _volume,
)

TERMS = 4
"""Of power series: to third derivatives."""


class CheckedEdges:
    """Facets over an interval of t with 0 at one end, all in one plane there.

    Parameters
    ----------
    contact
        The facets of the sheet.
    folds
        Folds of all creases by t and the number of terms, as series.
    low, high
        The interval.
    """

    def __init__(
        self,
        contact: CheckedContact,
        folds: Callable[[Any, int], list[Any]],
        low: float,
        high: float,
    ) -> None:
        before, ctx.cap = ctx.cap, TERMS
        try:
            flat = contact.placed([f[0] for f in folds(arb(0), 1)])
            self.over = contact.placed(folds(arb(low).union(arb(high)), TERMS))
        finally:
            ctx.cap = before
        self.flat = [[complex(float(x.mid()), float(y.mid())) for x, y, _ in p] for p in flat]
        self.room = GRAZING * max(abs(z - p[0]) for p in self.flat for z in p)

    def known(self, a: int, b: int) -> bool | None:
        """Return whether two facets are apart, or cross, all over the interval; None: not certain."""
        before, ctx.cap = ctx.cap, TERMS
        try:
            found = (self._of_sides(a, i, b, j) for i, j in self._in_line(a, b))
            return next((x for x in found if x is not None), None)
        finally:
            ctx.cap = before

    def _in_line(self, a: int, b: int) -> list[tuple[int, int]]:
        """Return the sides of two facets that fold onto one line."""
        sides = [
            [(p, q) for p, q in zip(ring, [*ring[1:], ring[0]], strict=True)]
            for ring in (self.flat[a], self.flat[b])
        ]
        return [
            (i, j)
            for (i, (p, q)), (j, (r, s)) in itertools.product(*map(enumerate, sides))
            if max(abs(((q - p).conjugate() * (z - p)).imag / abs(q - p)) for z in (r, s))
            <= self.room
            and max(abs(((s - r).conjugate() * (z - r)).imag / abs(s - r)) for z in (p, q))
            <= self.room
        ]

    def _of_sides(self, a: int, i: int, b: int, j: int) -> bool | None:
        """Decide two facets by a side of each."""
        x, y = self.over[a], self.over[b]
        x, y = [*x[i:], *x[:i]], [*y[j:], *y[:j]]
        normal = _product(_minus(x[1], x[0]), _minus(y[1], y[0]))
        third = _common_sign([_dot(normal, _minus(y[0], x[0]))[3]])
        one = _common_sign([_dot(normal, _minus(z, x[0]))[1] for z in x[2:]])
        two = _common_sign([_dot(normal, _minus(z, y[0]))[1] for z in y[2:]])
        if third and third == two == -one:
            return True
        # the volume of the ends of a side and of those of the other is -n.(y0 - x0), either way round
        if third and any(_goes_through(p, q, -third) for p, q in ((x, y), (y, x))):
            return False
        return None


def _goes_through(x: Sequence[Point], y: Sequence[Point], first: int) -> bool:
    """Return whether the first side of x goes through y, given how it passes the first side of that."""
    plane = _corners_of_plane(y)
    ends = [_common_sign([_volume(*plane, z)[1]]) for z in x[:2]]
    sides = itertools.pairwise([*y[1:], y[0]])
    return ends[0] * ends[1] < 0 and first == _common_sign(
        [_volume(x[0], x[1], p, q)[1] for p, q in sides]
    )
