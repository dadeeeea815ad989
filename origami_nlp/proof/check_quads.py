"""The check of a proof of a mesh of vertices of degree four that need not fold flat: all closed states, found again.

The statement.  Let z_i = sin(theta) cot(phi_i/2), and [ij] the cross product of unit vectors along creases i and j.
The four unit quaternions round a flat vertex have product 1 or -1 exactly where (w_1 + u_1)(w_2 + u_2), w =
cot(phi/2), is -[12]/[34] times (w_4 - u_4)(w_3 - u_3): its part out of the sheet says the factor, that in the sheet

    [13] z_2 = -([23] z_1 + [12] z_3),  [13] z_4 = [34] z_1 + [41] z_3,

its real part s^2 + z_3^2 = [23][34]/([12][41]) (s^2 + z_1^2), s = sin(theta).  The product is 1 if the number of
negative folds is odd, and such a state may have one z = 0, a fold at 180 degrees; two are 0 only where the vertex
folds flat, and w is infinite, a fold 0, only in the flat state, or where opposite creases are in one line: both are
refused.

So with one crease at phi = 2 theta, z = cos(theta), and the sign of z_3 chosen at each vertex, all z are functions of
theta, and a state closes where vertices that are reached twice agree.  These differences are followed over intervals
of theta with power series over balls (python-flint); none is singular at the flat state.  They vanish identically if
creases can be put into classes of equal |z| such that each vertex has the sectors, signs and classes, in order, of
one of a few, and those few follow from each other one by one.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from flint import arb, arb_series

from origami_nlp.proof.check_lists import ListCheck, Refused, precision, refuse_wide
from origami_nlp.proof.check_mesh import EXACT
from origami_nlp.proof.check_quad_curves import (
    DEPTH,
    PIECES,
    QUARTER,
    SMALL,
    ClassCurve,
    CurveSlopes,
    QuadRound,
    VertexLink,
    fold_of,
    one_curve,
    others,
    sign_of,
)
from origami_nlp.proof.check_sheet import FlatDisk, product_round
from origami_nlp.proof.mesh_certificate import MeshCertificate

LOOP_TOL = 1e-9
"""What is left of the product of quaternions at a state, at most."""


class QuadCheck(ListCheck):
    """Find again what a certificate claims.

    Parameters
    ----------
    said
        The certificate.
    progress
        Called with the choices that are done and their number, about.
    """

    def __init__(self, said: MeshCertificate, progress: Callable[[int, int], object]) -> None:
        super().__init__(said)
        self.progress = progress
        self.counts = {"choices": 0, "curves": 0, "rigid states": 0, "intervals": 0}
        self._found: list[list[Any]] = []

    @precision()
    def run(self) -> None:
        """Decide every claim.

        Raises
        ------
        Refused
            With the first that is wrong.
        """
        self._sheet()
        self._choose((), [(0.0, QUARTER)])
        if not self.counts["curves"] or not any(self.said.rest):
            self._found.append([arb(0)] * len(self.said.creases))
        self.hold(self._found)

    def _sheet(self) -> None:
        said = self.said
        if any(not k >= 0 for k in said.stiffness):
            raise Refused("a stiffness is negative")
        refuse_wide(said.minima)
        self.disk = FlatDisk(said)
        self.off = 0.0
        self._known: list[Any] = []
        rounds = [self._round(v) for v in sorted(self.disk.inside)]
        if not rounds or self.off > min(1.01 * said.deviation, EXACT):
            raise Refused(
                f"equal sectors are equal to {self.off:.2g} rad only, not {said.deviation:.2g}"
            )
        order = rounds[:1]
        for one in order:
            order += [r for r in rounds if r not in order and {*r.creases} & {*one.creases}]
        if len(order) < len(rounds) or {c for r in rounds for c in r.creases} != {
            *range(len(said.creases))
        }:
            raise Refused("vertices do not hang together, or a crease is none of theirs")
        self.order = order
        k = order[0].beside
        # of two opposite creases that which folds more
        self.drive = order[0].creases[0 if k[1] * k[2] > k[0] * k[3] else 2]
        self.places = self._places(order, self.drive)

    def _round(self, v: int) -> QuadRound:
        ring = self.disk.round(v) or []
        if len(ring) != 4:
            raise Refused(f"vertex {v} has not four creases")
        u = []
        for w in ring:
            x, y = (self.disk.points[w][i] - self.disk.points[v][i] for i in (0, 1))
            a, b = (arb(z.numerator) / arb(z.denominator) for z in (x, y))
            length = (a * a + b * b).sqrt()
            u.append((a / length, b / length))
        slack = arb(0, 4 * self.said.deviation)
        crosses = [
            [u[i][0] * u[(i + n) % 4][1] - u[i][1] * u[(i + n) % 4][0] for i in range(4)]
            for n in (1, 2)
        ]
        if not all(c > 0 for c in crosses[0]):
            raise Refused(f"vertex {v} has a sector of 180 degrees or more")
        if not all(abs(c) > EXACT for c in crosses[1]):
            raise Refused(f"vertex {v} has opposite creases in one line")
        k = crosses[0]
        if not abs(k[0] * k[3] - k[1] * k[2]) > EXACT:
            raise Refused(f"vertex {v} folds flat")
        sectors = []
        for i in range(4):
            one, two = u[i], u[(i + 1) % 4]
            angle = arb.atan2(one[0] * two[1] - one[1] * two[0], one[0] * two[0] + one[1] * two[1])
            near = [j for j, known in enumerate(self._known) if abs(angle - known) <= EXACT]
            if not near:
                self._known.append(angle)
            else:
                off = abs(angle - self._known[near[0]])
                # a sector of the same corners turned is the same: what is left of it is none
                self.off = max(self.off, float(off.upper()) if off > 0 else 0.0)
            sectors.append(near[0] if near else len(self._known) - 1)
        return QuadRound(
            tuple(self.disk.crease[frozenset((v, w))] for w in ring),
            tuple(c + slack for c in crosses[0]),
            tuple(c + slack for c in crosses[1]),
            tuple(sectors),
            u,
        )

    def _places(self, order: Sequence[QuadRound], drive: int) -> list[int]:
        """Return the place of the first crease of each vertex that is known before it."""
        known, found = {drive}, []
        for one in order:
            found.append(next(i for i, c in enumerate(one.creases) if c in known))
            known |= {*one.creases}
        return found

    def _choose(self, signs: tuple[int, ...], left: list[tuple[float, float]]) -> None:
        """Choose a sign of z at each vertex in turn; theta is in what is left."""
        if len(signs) == len(self.order):
            self.counts["choices"] += 1
            self.progress(self.counts["choices"], 2 ** len(signs))
            along = self._identically(signs)
            if along is not None:
                self._curve(along)
                return
            for low, high in left:
                self._rigid(signs, low, high)
            return
        for sign in (1, -1):
            more = (*signs, sign)
            some = left
            if self._has_loop(more) and self._identically(more) is None:
                some = list(self._closing(more, left))
            if some:
                self._choose(more, some)

    def _has_loop(self, signs: Sequence[int]) -> bool:
        """Return whether a vertex of the first ones is reached twice."""
        return len({c for one in self.order[: len(signs)] for c in one.creases}) <= 3 * len(signs)

    def _links(self, signs: Sequence[int]) -> list[VertexLink]:
        return [VertexLink(*one) for one in zip(self.order, self.places, signs, strict=False)]

    def _states(
        self, links: Sequence[VertexLink], theta: Any, at: dict[int, Any] | None = None
    ) -> tuple[dict[int, Any], list[Any], bool]:
        """Return z of creases as series, what differs round loops, and whether a root is certainly not real.

        From those in the middle of theta they are known better, by the mean value theorem.
        """
        x = arb_series([arb(theta), 1], 3)
        s, zs = x.sin(), {self.drive: x.cos()}
        away = theta - arb(theta).mid()
        square = s * s
        loops: list[Any] = []
        for vertex, p, sign in links:
            own = others(vertex, p, zs[vertex.creases[p]], square, sign)
            if own is None:
                return zs, loops, True
            for i, value in own.items():
                crease = vertex.creases[i]
                if crease in zs:
                    loops.append(value - zs[crease])
                    continue
                moved = at[crease][0] + value[1] * away if at and crease in at else value[0]
                if moved.is_finite() and moved.rad() < value[0].rad():
                    value = arb_series([moved, value[1], value[2]], 3)
                zs[crease] = value
        return zs, loops, False

    def _is_even(self, links: Sequence[VertexLink], zs: dict[int, Any]) -> bool:
        """Return whether an even number of folds round some vertex is negative, certainly: no sheet is closed so.

        A fold at 180 degrees, z = 0, has a sign as well: the one that was chosen (with the other it is in another
        choice), or that which a vertex asks for.
        """
        signs = {c: sign_of(z[0]) for c, z in zs.items()}
        for vertex, p, sign in reversed(links):
            signs[vertex.creases[(p + 2) % 4]] = sign
        signs[self.drive] = 1
        left = [vertex.creases for vertex, _, _ in links]
        while True:
            asked = [[c for c in own if not signs[c]] for own in left]
            one = next((i for i, free in enumerate(asked) if len(free) < 2), None)
            if one is None:
                return False
            product = math.prod(signs[c] or 1 for c in left.pop(one))
            for c in asked[one]:
                signs[c] = -product
            if not asked[one] and product > 0:
                return True

    def _none(self, links: Sequence[VertexLink], low: Any, high: Any) -> tuple[bool, int, int]:
        """Return whether no state closes in an interval; a difference that is steep there, the sign of its slope."""
        self.counts["intervals"] += 1
        theta = arb(low).union(arb(high))
        middle = theta.mid()
        away = theta - middle
        known, at, _ = self._states(links, middle)
        zs, loops, unreal = self._states(links, theta, known)
        if unreal or self._is_even(links, zs):
            return True, 0, 0
        for one, here in itertools.zip_longest(loops, at):
            if sign_of(one[0]) or (here is not None and sign_of(here[0] + one[1] * away)):
                return True, 0, 0
        steep = next((i for i, one in enumerate(loops) if sign_of(one[1])), 0)
        return False, steep, sign_of(loops[steep][1]) if loops else 0

    def _closing(
        self, signs: tuple[int, ...], left: list[tuple[float, float]]
    ) -> Iterator[tuple[float, float]]:
        """Yield the intervals in which loops may close, single roots of a difference narrow."""
        links = self._links(signs)
        front, looked = [(low, high, 0) for low, high in reversed(left)], 0
        steep: list[tuple[float, float, tuple[int, int]]] = []
        while front:
            low, high, depth = front.pop()
            looked += 1
            none, loop, slope = self._none(links, low, high)
            if none:
                continue
            middle = 0.5 * (low + high)
            if slope:
                if steep and steep[-1][1:] == (low, (loop, slope)):
                    steep[-1] = (steep[-1][0], high, (loop, slope))
                else:
                    steep.append((low, high, (loop, slope)))
            elif depth == DEPTH or looked > PIECES or middle in (low, high):
                yield low, high
            else:
                front += [(middle, high, depth + 1), (low, middle, depth + 1)]
        for low, high, (loop, slope) in steep:
            ends = [self._difference(links, loop, x) for x in (low, high)]
            if not all(ends):
                yield low, high
            elif ends[0] != ends[1]:
                yield self._narrowed(links, loop, low, high, slope)

    def _difference(self, links: Sequence[VertexLink], loop: int, theta: float) -> int:
        loops = self._states(links, arb(theta))[1]
        return sign_of(loops[loop][0]) if len(loops) > loop else 0

    def _narrowed(
        self, links: Sequence[VertexLink], loop: int, low: float, high: float, slope: int
    ) -> tuple[float, float]:
        while (middle := 0.5 * (low + high)) not in (low, high):
            sign = self._difference(links, loop, middle) * slope
            if not sign:
                break
            low, high = (low, middle) if sign > 0 else (middle, high)
        return low, high

    def _rigid(self, signs: tuple[int, ...], low: float, high: float) -> None:
        """Add the two states in an interval in which the only loop closes once, or leave it open."""
        links = self._links(signs)
        theta = arb(low).union(arb(high))
        zs, loops, unreal = self._states(links, theta)
        if unreal or self._is_even(links, zs):
            return
        name = f"theta in [{low:.9g}, {high:.9g}]"
        ends = [self._difference(links, 0, x) for x in (low, high)]
        if not (
            all(sign_of(z[0]) for z in zs.values())
            and sign_of(loops[0][1])
            and ends[0] * ends[1] < 0
        ):
            self.open.append(f"{name}: whether a loop closes")
        elif len(loops) > 1:
            self.open.append(f"{name}: several loops close, as far as is known")
        else:
            sine = theta.sin()
            folds = [fold_of(zs[c][0], sine) for c in range(len(zs))]
            self._closes(folds)
            self.counts["rigid states"] += 1
            self._found += [folds, [-a for a in folds]]

    def _identically(self, signs: tuple[int, ...]) -> ClassCurve | None:
        """Return the curve along which all loops of these vertices close identically; None where they do not."""
        links = self._links(signs)
        zs, loops, unreal = self._states(links, arb(SMALL))
        if unreal or not all(sign_of(z[0]) for z in zs.values()) or self._is_even(links, zs):
            return None
        if any(abs(g[0]) > LOOP_TOL for g in loops):
            return None
        return one_curve(links, self.drive, zs)

    def _curve(self, along: ClassCurve) -> None:
        """Add the minima of a curve through the flat state."""
        self.counts["curves"] += 1
        curve = CurveSlopes(self.disk, along)
        even = not any(self.said.rest)
        for side in (1, -1):
            for low, high, bend in curve.alike(side):
                ends = [sign_of(curve.slopes(side, arb(x))[0]) for x in (low, high)]
                if even and low == 0:
                    continue
                if not all(ends):
                    self.open.append(f"the slope along a curve near theta = {low:.6g}")
                elif ends[0] != ends[1]:
                    self.maxima += bend < 0
                    if bend > 0:
                        self._add(curve, side, *curve.bisected(side, low, high))
            end = sign_of(curve.slopes(side, arb.pi() / 2)[0])
            if not end:
                self.open.append("the slope at the end of a curve")
            elif end < 0:
                self._add(curve, side, arb.pi() / 2, arb.pi() / 2)
        self.open += curve.open

    def _add(self, curve: CurveSlopes, side: int, low: Any, high: Any) -> None:
        theta = arb(low).union(arb(high))
        folds = curve.folds(side, theta)
        if folds is None:
            self.open.append("whether folds of a minimum are within their limits")
            return
        angles = [f[0] for f in folds]
        self._closes(angles)
        self._found.append(angles)

    def _closes(self, folds: Sequence[Any]) -> None:
        """Refuse a state of the statement round a vertex of which facets do not come back."""
        for vertex in self.order:
            a, *rest = product_round(vertex, folds)
            if not all(abs(x) < LOOP_TOL for x in (a - 1, *rest)):
                raise Refused("states of the statement do not close")
