"""The check of a proof of a mesh that folds flat, with contact: all minima in which no facets cross, found again.

The statement is that of `check_mesh`, for vertices without creases in line: all tangents of half the folds are
proportional to one, T.  Along each curve T or 1/T is cut into intervals in which all facets are apart, or two cross
(`check_strip_contact`), or some meet and are apart on one side.  At 1/T = 0 all facets are in one plane: divided by
1/T, which parts or crosses them no less, heights over it there are their slopes.  States that are folded flat are
decided facet on facet (`check_layers`).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_series

from origami_nlp.proof.check_folded_edges import CheckedEdges
from origami_nlp.proof.check_layers import FlatLayers, LayersUnclear
from origami_nlp.proof.check_lists import precision
from origami_nlp.proof.check_mesh import ZERO, MeshCheck, RowGroup, _sign
from origami_nlp.proof.check_points import Refused
from origami_nlp.proof.check_strip_contact import CheckedContact
from origami_nlp.proof.mesh_certificate import MeshCertificate
from origami_nlp.proof.strip_certificate import CertifiedTouch

NARROWEST = 2.0**-40
"""Width of T or 1/T below which an interval is left open."""
NEAR = 2.0**-6
"""Width of T or 1/T above which no first touch is looked for: such intervals are cut first."""
FARTHEST = 2.0**-4
"""Width of 1/T up to which sides that fold onto one line are asked about."""
LOOKED = 4_000
"""Intervals of a curve that are looked at, at most."""
MOST_FOLDED = 4_096
"""States that are folded flat, at most."""
APART, CROSSING, TOUCHING, UNKNOWN = range(4)


class CurveBall:
    """States of a curve over an interval, for `CheckedContact`: folds as balls, and as series about them."""

    def __init__(self, folds: Callable[[Any], list[Any]], low: Any, high: Any) -> None:
        theta = arb(low).union(arb(high))
        self.away = theta - arb(theta.mid())
        self.at = _Series(folds(arb(theta.mid())))
        self.box = _Series(folds(theta))
        self.folds = [
            a[0] + b[1] * self.away for a, b in zip(self.at.folds, self.box.folds, strict=True)
        ]
        self.known = True
        self.corners: Any = None


class _Series(NamedTuple):
    folds: list[Any]


class ContactStretch(NamedTuple):
    """An interval of a chart of a curve, what is known of facets over it, and of those that meet the sign of slopes."""

    low: float
    high: float
    kind: int
    slope: int
    touches: tuple[CertifiedTouch, ...]


class MeshContactCheck(MeshCheck):
    """Find again what a certificate claims, with contact.

    Parameters
    ----------
    said
        The certificate.
    progress
        Called with the curves that are done and their number.
    """

    def __init__(self, said: MeshCertificate, progress: Callable[[int, int], object]) -> None:
        super().__init__(said, progress)
        self.counts = {"curves": 0, "intervals": 0, "folded flat": 0}
        self._found: list[list[Any]] = []
        # creases that do not move along a curve: 0, or +-1 at +-180 degrees
        self._still: tuple[int | None, ...] = (None,) * len(said.creases)
        # of states that are folded flat: whether the energy falls where a curve leaves one, None where facets cross
        self._ways: dict[tuple[int, ...], list[bool | None]] = {}

    @precision()
    def run(self) -> None:
        """Decide every claim.

        Raises
        ------
        Refused
            With the first that is wrong.
        """
        self._sheet()
        self._decide()
        self.hold(self._found)

    def _decide(self) -> None:
        """Find all minima."""
        self._connected()
        self.contact = CheckedContact(self.disk, arb(0, 4 * self.said.deviation))
        curves = list(self._curves())
        for done, group in enumerate(curves):
            self._along_curve(group)
            self.progress(done + 1, len(curves))
        flat = [arb(0)] * len(self.row)
        if self._stays([ZERO] * len(self.rows), flat):
            self._found.append(flat)
        self._folded()

    def _connected(self) -> None:
        """Refuse a mesh in which not all creases move together."""
        together = {*self.crossings[0].creases}
        for _ in self.crossings:
            for c in self.crossings:
                together |= {*c.creases} if together & {*c.creases} else set()
        if len(together) < len(self.row):
            raise Refused("vertices do not hang together, or a crease is none of theirs")
        if 2 ** (len(self.row) - len(self.crossings)) > MOST_FOLDED:
            raise Refused(f"it can be folded flat in more than {MOST_FOLDED} ways")

    def _curves(self) -> Iterator[RowGroup]:
        rows = set(range(len(self.rows)))
        for signs in itertools.product(*(c.multipliers for c in self.crossings)):
            along = self._along(signs, rows)
            moving = None if along is None else self._moving(rows, signs, along)
            if moving:
                (group,) = moving
                yield group

    def _folds(self, group: RowGroup, side: int) -> Callable[..., list[Any]]:
        """Return the folds of all creases as series, by T, or on a side of 180 degrees by 1/T."""

        def folds(t: Any, terms: int = 2) -> list[Any]:
            x = arb_series([t, 1], terms)
            found = [arb_series([(s or 0) * arb.pi()], terms) for s in self._still]
            for c, _, sign, powers in group.creases:
                m = self._value(powers)
                fold = side * arb.pi() - 2 * (x / m).atan() if side else 2 * (m * x).atan()
                found[c] = sign * fold
            return found

        return folds

    def _along_curve(self, group: RowGroup) -> None:
        """Add the minima along a curve, and note what is known of its ends."""
        self.counts["curves"] += 1
        turns = [sign for _, _, sign, _ in group.creases]
        even = self._even(group)
        for side, low, high in ((0, -1.0, 1.0), (-1, -1.0, 0.0), (1, 0.0, 1.0)):
            zeros = []
            for a, b, bend in self._alike(group, side, low, high):
                ends = [_sign(self._chart(group, side, arb(x))[0]) for x in (a, b)]
                if not all(ends):
                    self.open.append(f"the slope along a curve near T = {a:.6g}")
                elif ends[0] != ends[1] and not (even and not side and a <= 0 <= b):
                    zeros.append((self._bisected(group, side, a, b) if bend > 0 else None, a, b))
            stretches = self._stretches(group, side, low, high)
            for zero, a, b in zeros:
                kinds = {
                    s.kind
                    for s in stretches
                    if s.low < (b if zero is None else zero.upper())
                    and s.high > (a if zero is None else zero.lower())
                }
                if zero is not None and kinds == {APART}:
                    self._add_between(group, side, zero)
                elif kinds & {TOUCHING, UNKNOWN}:
                    self.open.append(
                        "whether facets cross at a state where the energy is stationary"
                    )
                elif zero is None:
                    self.maxima += kinds == {APART}
                elif kinds != {CROSSING}:
                    self.open.append("whether facets cross at a minimum")
            for s in stretches:
                if s.kind == TOUCHING:
                    self._meet(group, side, s)
                elif s.kind == UNKNOWN:
                    self._leave(group, side, s)
            if side:
                end = stretches[0 if side > 0 else -1]
                first = side * _sign(self._chart(group, side, arb(0))[0])
                if not first:
                    self.open.append("the slope where a curve ends folded flat")
                way = None if end.kind == CROSSING else first < 0
                self._ways.setdefault(tuple(side * t for t in turns), []).append(way)

    def _add_between(self, group: RowGroup, side: int, zero: Any) -> None:
        """Add a state that is somewhere in an interval; whether its statement closes is asked in the middle."""
        self._closes(list(self._angles(group, side, arb(zero.mid())).values()))
        self._found.append(list(self._angles(group, side, zero).values()))

    def _leave(self, group: RowGroup, side: int, s: ContactStretch) -> None:
        self.open.append(
            f"whether facets cross for {'1/' * bool(side)}T in [{s.low:.9g}, {s.high:.9g}]"
        )

    def _stretches(
        self, group: RowGroup, side: int, low: float, high: float
    ) -> list[ContactStretch]:
        """Return intervals of a chart with what is known of facets, in order."""
        folds = self._folds(group, side)
        turns = {c: sign for c, _, sign, _ in group.creases}
        front, looked = [(low, high)], 0
        out: list[ContactStretch] = []
        while front:
            a, b = front.pop()
            looked += 1
            self.counts["intervals"] += 1
            ball = CurveBall(folds, a, b)
            end = bool(side) and a * b == 0
            if end:
                # on which side of the plane a facet beside it is does not hang on how far it is folded
                ball.folds = [arb(side * turns.get(c, 0)) for c in range(len(self.row))]
                self._blow_up(ball, 1 if a == 0 else -1)
            kind, slope, touches = self._kind(group, side, ball, a, b, end)
            if kind == UNKNOWN and end and b - a <= FARTHEST:
                kind = self._edge_to_edge(ball, CheckedEdges(self.contact, folds, a, b))
            if kind == UNKNOWN and b - a > NARROWEST and looked < LOOKED:
                middle = 0.5 * (a + b)
                front += [(middle, b), (a, middle)]
            elif out and out[-1].kind == kind != TOUCHING:
                out[-1] = out[-1]._replace(high=b)
            else:
                out.append(ContactStretch(a, b, kind, slope, touches))
        return out

    def _blow_up(self, ball: CurveBall, way: int) -> None:
        """Put slopes in place of heights: z = z'(x) t for states between t = 0 and the end of the interval."""
        series = self.contact.placed(ball.box.folds)
        flat = self.contact.placed([a[0] for a in ball.box.folds])
        balls = [
            [(p[0], p[1], q[2][1]) for p, q in zip(x, y, strict=True)]
            for x, y in zip(flat, series, strict=True)
        ]
        middle = [np.array([[float(c.mid()) for c in x] for x in p]) for p in balls]
        # t has the sign of the side: heights are not mirrored
        if way < 0:
            balls = [[(x, y, -z) for x, y, z in p] for p in balls]
            middle = [p * (1.0, 1.0, -1.0) for p in middle]
        ball.corners = balls, series, middle

    def _edge_to_edge(self, ball: CurveBall, edges: CheckedEdges) -> int:
        """Return what facets do up to the end of a curve, given those whose sides fold onto one line there."""
        over: Any = ball
        known = [edges.known(*pair) for pair in self.contact.open_pairs(over, weakly=True)]
        return CROSSING if False in known else UNKNOWN if None in known else APART

    def _kind(
        self, group: RowGroup, side: int, ball: CurveBall, a: float, b: float, end: bool
    ) -> tuple[int, int, tuple[CertifiedTouch, ...]]:
        contact: Any = self.contact
        if contact.apart(ball, weakly=end):
            return APART, 0, ()
        if contact.crosses(ball):
            return CROSSING, 0, ()
        first, second = self._chart(group, side, arb(a).union(arb(b)))
        at = self._chart(group, side, arb(0.5 * (a + b)))[0] + second * arb(0, 0.5 * (b - a))
        if end or b - a > NEAR or not (_sign(first) or _sign(at)):
            return UNKNOWN, 0, ()
        touches = []
        for pair in contact.open_pairs(ball):
            found = next(
                (t for t in _candidates(contact.sizes, pair) if contact.meets(ball, t)), None
            )
            if found is None:
                return UNKNOWN, 0, ()
            touches.append(found)
        slope = contact.touches(ball, touches)
        return (TOUCHING, slope, tuple(touches)) if slope else (UNKNOWN, 0, ())

    def _meet(self, group: RowGroup, side: int, s: ContactStretch) -> None:
        """Add the state where facets meet, if the energy falls towards it."""
        folds = self._folds(group, side)

        def gap(x: float) -> int:
            state: Any = CurveBall(folds, x, x)
            return min(self.contact.gaps(state, s.touches))

        low, high = s.low, s.high
        ends = gap(low), gap(high)
        slope = _sign(self._chart(group, side, arb(0.5 * (low + high)))[0])
        if 0 in ends or not slope:
            self.open.append(f"the gap of facets near T = {low:.9g}")
        elif ends[0] != ends[1] and slope == s.slope:
            while (middle := 0.5 * (low + high)) not in (low, high):
                before = low, high
                for x in (0.5 * (low + middle), middle, 0.5 * (middle + high)):
                    sign = gap(x) * s.slope
                    low, high = max(low, x) if sign < 0 else low, min(high, x) if sign > 0 else high
                if (low, high) == before:
                    break
            self._add_between(group, side, arb(low).union(arb(high)))

    def _folded(self) -> None:
        """Add the states folded flat whose layers can be ordered and from which the energy does not fall."""
        try:
            layers = FlatLayers(self.disk)
        except LayersUnclear:
            self.open.append("how facets that are folded flat lie on each other")
            return
        for signs in itertools.product((1, -1), repeat=len(self.row)):
            if any(math.prod(signs[c] for c in x.creases) > 0 for x in self.crossings):
                continue
            self.counts["folded flat"] += 1
            ways = self._ways.get(signs, [])
            try:
                paper = layers.can_be_stacked(signs)
            except LayersUnclear:
                self.open.append("whether layers can be ordered")
                continue
            if not paper and any(w is not None for w in ways):
                self.open.append("facets cross folded flat, and not before, as far as is known")
            if paper and True not in ways:
                self._found.append([s * arb.pi() for s in signs])


def _candidates(sizes: Sequence[int], pair: tuple[int, int]) -> Iterator[CertifiedTouch]:
    """Yield all ways in which two facets may meet first: a corner on a facet, a side on a side."""
    for a, b in (pair, pair[::-1]):
        n, m = sizes[a], sizes[b]
        for i in range(n):
            plane = ((b, 0), (b, m // 3), (b, 2 * m // 3))
            yield CertifiedTouch(pair, (*plane, (a, i)))
    a, b = pair
    n, m = sizes[a], sizes[b]
    for i, j in itertools.product(range(n), range(m)):
        yield CertifiedTouch(pair, ((a, i), (a, (i + 1) % n), (b, (j + 1) % m), (b, j)))
