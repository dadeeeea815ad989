"""The check of a proof of a mesh of vertices of degree four that need not fold flat: all closed states, found again.

The statement.  Let z_i = sin(theta) cot(phi_i/2), and [ij] the cross product of unit vectors along creases i and j.  The
four unit quaternions round a flat vertex have product 1 or -1 exactly where (w_1 + u_1)(w_2 + u_2), w = cot(phi/2), is
-[12]/[34] times (w_4 - u_4)(w_3 - u_3): its part out of the sheet says the factor, that in the sheet

    [13] z_2 = -([23] z_1 + [12] z_3),  [13] z_4 = [34] z_1 + [41] z_3,

its real part s^2 + z_3^2 = [23][34]/([12][41]) (s^2 + z_1^2), s = sin(theta).  The product is 1 if the number of negative
folds is odd, and such a state may have one z = 0, a fold at 180 degrees; two are 0 only where the vertex folds flat, and
w is infinite, a fold 0, only in the flat state, or where opposite creases are in one line: both are refused.

So with one crease at phi = 2 theta, z = cos(theta), and the sign of z_3 chosen at each vertex, all z are functions of theta,
and a state closes where vertices that are reached twice agree.  These differences are followed over intervals of theta
with power series over balls (python-flint); none is singular at the flat state.  They vanish identically if creases can be
put into classes such that each vertex has the sectors of one of a few, and its classes in order, and those few follow
from each other one by one.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from flint import arb, arb_series, ctx

from origami_nlp.proof.check_lists import ListCheck, refuse_wide
from origami_nlp.proof.check_mesh import EXACT
from origami_nlp.proof.check_points import Refused
from origami_nlp.proof.check_strip_sheet import FlatDisk, product_round
from origami_nlp.proof.check_strips import BITS, TERMS
from origami_nlp.proof.mesh_certificate import MeshCertificate

DEPTH = 60
"""Halvings of an interval of theta, at most."""
PIECES = 20_000
"""Intervals of theta of one choice that are looked at, at most: a file must not keep the check for ever."""
ALIKE = 1e-9
"""Folds that differ by less are asked whether they are one identically."""
CLOSES = 1e-9
"""What is left of the product of quaternions at a state, at most."""
QUARTER = math.nextafter(0.5 * math.pi, math.inf)
"""Not below pi/2, which is between two doubles."""


class Round(NamedTuple):
    """A vertex: creases counter-clockwise, [i i+1] and [i i+2] of each, classes of its sectors, unit vectors."""

    creases: tuple[int, ...]
    beside: tuple[Any, ...]
    across: tuple[Any, ...]
    sectors: tuple[int, ...]
    directions: list[tuple[Any, Any]]


class Link(NamedTuple):
    """A vertex, the place of a crease that is known, and the sign of z of the crease opposite."""

    vertex: Round
    place: int
    sign: int


class Along(NamedTuple):
    """A curve: z of each class of creases by links from one, and the class and sign of each crease."""

    links: tuple[Link, ...]
    drive: int
    classes: tuple[int, ...]
    signs: tuple[int, ...]


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

    def run(self) -> None:
        """Decide every claim.

        Raises
        ------
        Refused
            With the first that is wrong.
        """
        before = ctx.prec, ctx.cap
        ctx.prec, ctx.cap = BITS, TERMS
        try:
            self._sheet()
            self._choose((), [(0.0, QUARTER)])
            if not self.counts["curves"] or not any(self.said.rest):
                self._found.append([arb(0)] * len(self.said.creases))
            self.hold(self._found)
        finally:
            ctx.prec, ctx.cap = before

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
            raise Refused(f"equal sectors are equal to {self.off:.2g} rad only, not {said.deviation:.2g}")
        order = rounds[:1]
        for one in order:
            order += [r for r in rounds if r not in order and {*r.creases} & {*one.creases}]
        if len(order) < len(rounds) or {c for r in rounds for c in r.creases} != {*range(len(said.creases))}:
            raise Refused("vertices do not hang together, or a crease is none of theirs")
        self.order = order
        k = order[0].beside
        # of two opposite creases that which folds more
        self.drive = order[0].creases[0 if k[1] * k[2] > k[0] * k[3] else 2]
        self.places = self._places(order, self.drive)

    def _round(self, v: int) -> Round:
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
            a, b = u[i], u[(i + 1) % 4]
            angle = arb.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])
            near = [j for j, known in enumerate(self._known) if abs(angle - known) <= EXACT]
            if not near:
                self._known.append(angle)
            else:
                off = abs(angle - self._known[near[0]])
                # a sector of the same corners turned is the same: what is left of it is none
                self.off = max(self.off, float(off.upper()) if off > 0 else 0.0)
            sectors.append(near[0] if near else len(self._known) - 1)
        return Round(
            tuple(self.disk.crease[frozenset((v, w))] for w in ring),
            tuple(c + slack for c in crosses[0]),
            tuple(c + slack for c in crosses[1]),
            tuple(sectors),
            u,
        )

    def _places(self, order: Sequence[Round], drive: int) -> list[int]:
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

    def _links(self, signs: Sequence[int]) -> list[Link]:
        return [
            Link(*one) for one in zip(self.order, self.places, signs, strict=False)
        ]

    def _states(
        self, links: Sequence[Link], theta: Any, at: dict[int, Any] | None = None
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
            k, c, z = vertex.beside, vertex.across[p], zs[vertex.creases[p]]
            ratio = k[(p + 1) % 4] * k[(p + 2) % 4] / (k[p] * k[(p + 3) % 4])
            under = (square + z * z) * ratio - square
            if under[0] < 0:
                return zs, loops, True
            opposite = sign * _root(under)
            own = {
                (p + 1) % 4: -(k[(p + 1) % 4] * z + k[p] * opposite) / c,
                (p + 2) % 4: opposite,
                (p + 3) % 4: (k[(p + 3) % 4] * opposite + k[(p + 2) % 4] * z) / c,
            }
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

    def _is_even(self, links: Sequence[Link], zs: dict[int, Any]) -> bool:
        """Return whether an even number of folds round some vertex is negative, certainly: no sheet is closed so.

        A fold at 180 degrees, z = 0, has a sign as well: the one that was chosen (with the other it is in another
        choice), or that which a vertex asks for.
        """
        signs = {c: _sign(z[0]) for c, z in zs.items()}
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

    def _none(self, links: Sequence[Link], low: Any, high: Any) -> tuple[bool, int, int]:
        """Return whether no state closes in an interval; a difference that is steep there, and the sign of its slope."""
        self.counts["intervals"] += 1
        theta = arb(low).union(arb(high))
        middle = theta.mid()
        away = theta - middle
        known, at, _ = self._states(links, middle)
        zs, loops, unreal = self._states(links, theta, known)
        if unreal or self._is_even(links, zs):
            return True, 0, 0
        for one, here in itertools.zip_longest(loops, at):
            if _sign(one[0]) or (here is not None and _sign(here[0] + one[1] * away)):
                return True, 0, 0
        steep = next((i for i, one in enumerate(loops) if _sign(one[1])), 0)
        return False, steep, _sign(loops[steep][1]) if loops else 0

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

    def _difference(self, links: Sequence[Link], loop: int, theta: float) -> int:
        loops = self._states(links, arb(theta))[1]
        return _sign(loops[loop][0]) if len(loops) > loop else 0

    def _narrowed(
        self, links: Sequence[Link], loop: int, low: float, high: float, slope: int
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
        if not (all(_sign(z[0]) for z in zs.values()) and _sign(loops[0][1]) and ends[0] * ends[1] < 0):
            self.open.append(f"{name}: whether a loop closes")
        elif len(loops) > 1:
            self.open.append(f"{name}: several loops close, as far as is known")
        else:
            sine = theta.sin()
            folds = [_fold(zs[c][0], sine) for c in range(len(zs))]
            self._closes(folds)
            self.counts["rigid states"] += 1
            self._found += [folds, [-a for a in folds]]

    def _identically(self, signs: tuple[int, ...]) -> Along | None:
        """Return the curve along which all loops of these vertices close identically; None where they do not."""
        links = self._links(signs)
        zs, loops, unreal = self._states(links, arb(1) / 128)
        if unreal or not all(_sign(z[0]) for z in zs.values()) or self._is_even(links, zs):
            return None
        if any(abs(g[0]) > CLOSES for g in loops):
            return None
        values = {c: abs(float(z[0].mid())) for c, z in zs.items()}
        means: list[float] = []
        classes: dict[int, int] = {}
        for c, x in values.items():
            near = [i for i, y in enumerate(means) if abs(x - y) <= ALIKE * (1 + x)]
            classes[c] = near[0] if near else len(means)
            means += [] if near else [x]
        turns = {c: _sign(z[0]) for c, z in zs.items()}
        known = {classes[self.drive]}
        kinds: list[tuple[tuple[int, int, int], ...]] = []
        few: list[Link] = []
        for link in links:
            seen = list(_ways(link.vertex, classes, turns))
            if any(way in kinds for way in seen):
                continue
            own = [classes[c] for c in link.vertex.creases]
            place = [i for i, k in enumerate(own) if k in known]
            if len(place) != 1 or len(set(own)) < 4:
                return None
            few.append(Link(link.vertex, place[0], 0))
            known |= set(own)
            kinds.append(seen[0])
        order = sorted(classes)
        return Along(
            tuple(few),
            self.drive,
            tuple(classes[c] for c in order),
            tuple(turns[c] for c in order),
        )

    def _curve(self, along: Along) -> None:
        """Add the minima of a curve through the flat state, given by the fold that reaches 180 degrees first."""
        self.counts["curves"] += 1
        along = self._driven(along)
        even = not any(self.said.rest)
        for side in (1, -1):
            for low, high, bend in self._alike(along, side):
                ends = [self._slopes(along, side, arb(x))[0] for x in (low, high)]
                if even and low == 0:
                    continue
                if not all(map(_sign, ends)):
                    self.open.append(f"the slope along a curve near theta = {low:.6g}")
                elif _sign(ends[0]) != _sign(ends[1]):
                    self.maxima += bend < 0
                    if bend > 0:
                        self._add(along, side, *self._bisected(along, side, low, high))
            end = _sign(self._slopes(along, side, arb.pi() / 2)[0])
            if not end:
                self.open.append("the slope at the end of a curve")
            elif end < 0:
                self._add(along, side, arb.pi() / 2, arb.pi() / 2)

    def _driven(self, along: Along) -> Along:
        """Return a curve given by the class that reaches 180 degrees first, and links from it."""
        # along the curve as it is given, by halving: the last state where no z has changed its sign
        low, high = 1.0 / 128, 0.5 * math.pi
        first = along.classes[along.drive]
        for _ in range(40):
            middle = 0.5 * (low + high)
            zs = self._classes(along, arb(middle))
            if zs is None or any(not z[0] > 0 for z in zs.values()):
                high = middle
            else:
                low = middle
        at = self._classes(along, arb(low))
        if at is not None and high < 0.5 * math.pi:
            first = min(at, key=lambda c: float(at[c][0].mid()))
        if first == along.classes[along.drive]:
            return along
        drive = along.classes.index(first)
        turn = along.signs[drive]
        left, links, known = list(along.links), [], {first}
        while left:
            of = [[along.classes[c] for c in link.vertex.creases] for link in left]
            i = next(i for i, own in enumerate(of) if known & {*own})
            links.append(left[i]._replace(place=next(j for j, k in enumerate(of[i]) if k in known)))
            known |= {*of[i]}
            del left[i]
        return Along(
            tuple(links), drive, along.classes, tuple(turn * s for s in along.signs)
        )

    def _classes(self, along: Along, theta: Any) -> dict[int, Any] | None:
        """Return |z| of each class as series, from the few vertices that define them; None where that is not real."""
        x = arb_series([arb(theta), 1], 3)
        s = x.sin()
        square = s * s
        found = {along.classes[along.drive]: x.cos()}
        for vertex, p, _ in along.links:
            own = [along.classes[c] for c in vertex.creases]
            signs = [along.signs[c] for c in vertex.creases]
            k, z = vertex.beside, signs[p] * found[own[p]]
            c = vertex.across[p]
            ratio = k[(p + 1) % 4] * k[(p + 2) % 4] / (k[p] * k[(p + 3) % 4])
            under = (square + z * z) * ratio - square
            if not under[0] > 0:
                return None
            opposite = signs[(p + 2) % 4] * under.sqrt()
            values = {
                (p + 1) % 4: -(k[(p + 1) % 4] * z + k[p] * opposite) / c,
                (p + 2) % 4: opposite,
                (p + 3) % 4: (k[(p + 3) % 4] * opposite + k[(p + 2) % 4] * z) / c,
            }
            for i, value in values.items():
                found[own[i]] = signs[i] * value
        return found

    def _folds(self, along: Along, side: int, theta: Any) -> list[Any] | None:
        """Return all folds as series in theta, on a side of the flat state; None where one may be beyond its limit."""
        zs = self._classes(along, theta)
        drive = along.classes[along.drive]
        if zs is None or any(not z[0] > 0 for c, z in zs.items() if c != drive):
            return None
        x = arb_series([arb(theta), 1], 3)
        s = x.sin()
        of = {}
        for c, z in zs.items():
            if c == drive:
                of[c] = 2 * x
            elif float(z[0].mid()) > float(s[0].mid()):
                of[c] = 2 * (s / z).atan()
            else:
                of[c] = arb.pi() - 2 * (z / s).atan()
        return [side * t * of[c] for c, t in zip(along.classes, along.signs, strict=True)]

    def _slopes(self, along: Along, side: int, theta: Any) -> tuple[Any, Any]:
        """Return U' and U'' over theta."""
        folds = self._folds(along, side, theta)
        if folds is None:
            return arb.nan(), arb.nan()
        total = arb_series([0], 3)
        for k, rest, fold in zip(self.disk.stiffness, self.disk.rest, folds, strict=True):
            total += k * (fold - rest) ** 2
        return total[1], 2 * total[2]

    def _alike(self, along: Along, side: int) -> list[tuple[float, float, int]]:
        """Return intervals in which U'' has a sign, beyond which U' has one."""
        front = [(0.0, QUARTER, 0)]
        found: list[tuple[float, float, int]] = []
        looked = 0
        while front:
            low, high, depth = front.pop()
            looked += 1
            first, second = self._slopes(along, side, arb(low).union(arb(high)))
            middle = 0.5 * (low + high)
            at = self._slopes(along, side, arb(middle))[0] + second * arb(0, 0.5 * (high - low))
            if _sign(first) or _sign(at):
                continue
            if bend := _sign(second):
                if found and found[-1][1] == low and found[-1][2] == bend:
                    found[-1] = (found[-1][0], high, bend)
                else:
                    found.append((low, high, bend))
            elif depth == DEPTH or looked > PIECES:
                self.open.append(f"where the energy is least along a curve, near theta = {low:.6g}")
            else:
                front += [(middle, high, depth + 1), (low, middle, depth + 1)]
        return found

    def _bisected(self, along: Along, side: int, low: float, high: float) -> tuple[Any, Any]:
        """Return where U' changes from negative to positive."""
        while (middle := 0.5 * (low + high)) not in (low, high):
            sign = _sign(self._slopes(along, side, arb(middle))[0])
            if not sign:
                break
            low, high = (low, middle) if sign > 0 else (middle, high)
        return low, high

    def _add(self, along: Along, side: int, low: Any, high: Any) -> None:
        theta = arb(low).union(arb(high))
        folds = self._folds(along, side, theta)
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
            if not all(abs(x) < CLOSES for x in (a - 1, *rest)):
                raise Refused("states of the statement do not close")


def _root(under: Any) -> Any:
    """Return the square root of a series; where it may be 0, its value alone."""
    if under[0] > 0:
        return under.sqrt()
    value = arb(0).union(abs(under[0]).upper().sqrt())
    return arb_series([value, arb.nan(), arb.nan()], 3)


def _fold(z: Any, sine: Any) -> Any:
    """Return phi in (-pi, pi) with sine cot(phi/2) = z, sine > 0."""
    if float(abs(z).mid()) > float(sine.mid()):
        return 2 * (sine / z).atan()
    return (1 if z > 0 else -1) * arb.pi() - 2 * (z / sine).atan()


def _ways(
    vertex: Round, classes: dict[int, int], turns: dict[int, int]
) -> Iterator[tuple[tuple[int, int, int], ...]]:
    """Yield a vertex as it is seen from each crease, both ways round: classes, signs (the first +1), sectors."""
    for p, way in itertools.product(range(4), (1, -1)):
        places = [(p + way * i) % 4 for i in range(4)]
        turn = turns[vertex.creases[p]]
        yield tuple(
            (
                classes[vertex.creases[i]],
                turn * turns[vertex.creases[i]],
                vertex.sectors[i if way > 0 else (i - 1) % 4],
            )
            for i in places
        )


def _sign(x: Any) -> int:
    return 1 if x > 0 else -1 if x < 0 else 0
