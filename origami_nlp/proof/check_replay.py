"""The check of a proof, claim by claim: points, then the tree, node by node.  What it states and trusts: `check`."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from flint import arb, ctx

from origami_nlp.proof.certificate import (
    CLOSED,
    CONTRACT,
    FLAT,
    KINDS,
    MINOR,
    NARROW,
    NONE,
    ROOT,
    SINGULAR,
    SPLIT,
    TWIN,
    Certificate,
    CertifiedPoint,
)
from origami_nlp.proof.check_bounds import States
from origami_nlp.proof.check_domains import VertexChain
from origami_nlp.proof.check_flat import falls, isolated
from origami_nlp.proof.check_forms import AROUND, Box, nonzero
from origami_nlp.proof.check_points import CheckedStratum, Located, Refused
from origami_nlp.proof.check_wedges import SymmetricPiece, piece_of
from origami_nlp.proof.check_whole import check_identity, closing_numbers

FINE, COARSE = 128, 64
"""Bits for points, and for the many boxes of the tree."""
TRIES = 400
"""Boxes that a leaf or a removed part is cut into, at most, where it is not clear at once."""
HALVINGS = 6
"""How often the radius in which a point is alone is halved; the shell around it is then searched."""
STATED = 2.0**-30
"""Relative accuracy of energies and moments as they are stated: nothing rests on them."""
TOLD = 1_000
"""Nodes between two reports of how far the check is."""


@contextmanager
def _bits(count: int) -> Iterator[None]:
    before = ctx.prec
    ctx.prec = count
    try:
        yield
    finally:
        ctx.prec = before


class Replay:
    """One check on its way.

    Parameters
    ----------
    certificate
        What is checked.
    progress
        As for `check_proof`.
    """

    def __init__(self, certificate: Certificate, progress: Callable[[int, int], object]) -> None:
        self.certificate, self.progress = certificate, progress
        self.found: list[Located] = []
        self.counts: Counter[int] = Counter()
        self.flat_falls = self.flat_shown = False

    def run(self) -> None:
        """Check everything but what the certificate holds of other windings.

        Raises
        ------
        Refused
            At the first claim that is not confirmed.
        """
        scene = self.certificate.scene
        if scene.contact != "fold-limits":
            raise Refused(f'contact = "{scene.contact}": only "fold-limits" is checked')
        if not scene.vertex.flat:
            raise Refused("a vertex that does not lie flat is not checked")
        with _bits(FINE):
            self._covers_the_vertex()
            self._points()
        with _bits(COARSE):
            self.piece = piece_of(self.certificate.scene)
            self._alone()
            self._tree()
            # the flat state closes with the first number alone
            winds = (scene.winding or 1) > 1
            # beyond a stop it is no state; at one, what is beside it is not on both sides
            ends = self.piece.limits
            outside = any(low > 0 or high < 0 for low, high in ends)
            inside = all(low < 0 < high for low, high in ends)
            falling = inside and isinstance(self.piece, VertexChain) and falls(self.piece)
            self.flat_falls = winds or outside or falling

    def _covers_the_vertex(self) -> None:
        """Check that the whole vertex closes where the piece does, and nowhere that no tree covers."""
        scene, others = self.certificate.scene, self.certificate.others
        if scene.group.is_trivial:
            if others:
                raise Refused("states without symmetry have no windings")
            return
        piece = piece_of(scene)
        assert isinstance(piece, SymmetricPiece)
        check_identity(scene, piece)
        given = [one.scene.winding for one in others]
        if any(one.others or replace(one.scene, winding=None) != scene for one in others):
            raise Refused("what it holds of other windings is about another scene")
        numbers = closing_numbers(scene.group.order)
        # each root of T_n(c) + 1 is one way to close: the largest winds once, the k-th after it 2 k + 1 times
        asked = [] if scene.winding else [2 * k + 1 for k in range(1, len(numbers))]
        for winding in asked:
            if winding not in given:
                number = float(numbers[winding // 2].mid())
                raise Refused(
                    f"the whole vertex also closes where the number of its piece is {number:.6g}, states that wind "
                    f"{winding} times round the axis: no tree covers them"
                )
        if given != asked:
            raise Refused(f"it holds states that wind {given} times, not {asked}")

    # ------------------------------------------------------------ points

    def _points(self) -> None:
        """Check that each point is there, of its kind, and that no two are one."""
        piece = piece_of(self.certificate.scene)
        for number, point in enumerate(self.certificate.points, start=1):
            try:
                found = self._point(CheckedStratum(piece, point.stratum), point)
            except Refused as problem:
                raise Refused(f"point {number}: {problem}") from None
            for other, (p, one) in enumerate(zip(self.certificate.points, self.found), start=1):  # noqa: B905
                pairs = zip(one.x, found.x, strict=True)
                if p.stratum == point.stratum and all(a.overlaps(b) for a, b in pairs):
                    raise Refused(f"points {other} and {number} may be one and the same")
            self.found.append(found)

    def _point(self, stratum: Any, point: CertifiedPoint) -> Located:
        if len(stratum.free) < stratum.rank or len(point.moment) != stratum.rank:
            raise Refused(f"fewer than {stratum.rank} free creases, or numbers of its moment")
        if not 0 <= point.radius <= point.unique_radius <= 1:
            raise Refused("its radii are not 0 <= radius <= unique_radius <= 1")
        found: Located = stratum.locate(point.x, point.moment)
        off = [abs(a - arb(b)) for a, b in zip(found.x, point.x, strict=True)]
        near = [a for a, s in zip(off, point.stratum, strict=True) if not s]
        # the true point lies in the ball found here, not at the doubles that are stated
        if not all(a <= point.radius for a in near):
            raise Refused(f"the true one is not within {point.radius:.3g} rad of what is stated")
        if not all(a < math.ulp(4.0) for a, s in zip(off, point.stratum, strict=True) if s):
            raise Refused("a pinned crease is not at its limit")
        for crease, (claimed, true) in enumerate(
            zip(point.pinned_signs, found.signs, strict=True), start=1
        ):
            if claimed and claimed != true:
                raise Refused(f"the sign at crease {crease} is {true or 'unclear'}, not {claimed}")
        if point.index is not None and point.index != found.index:
            shown = "unclear" if found.index is None else found.index
            raise Refused(f"its index is {shown}, not {point.index}")
        if point.is_minimum is not None and point.is_minimum is not found.is_minimum:
            raise Refused(f"is_minimum is {found.is_minimum}, not {point.is_minimum}")
        reach = stratum.reach(found, point.radius) + found.energy.abs_upper() * STATED
        if not abs(found.energy - arb(point.energy)) <= reach:
            raise Refused("its energy is another")
        near = stratum.moments(point.x, point.radius, [m.mid() for m in found.moment])
        size = AROUND * STATED * sum((m.abs_upper() for m in found.moment), arb(0))
        if not all((m + size).overlaps(arb(v)) for m, v in zip(near, point.moment, strict=True)):
            raise Refused("its moment is another")
        return found

    def _alone(self) -> None:
        """Check that each point is alone within its radius: near it at once, around that by search."""
        for number, (point, one) in enumerate(
            zip(self.certificate.points, self.found, strict=True), start=1
        ):
            stratum, radius = CheckedStratum(self.piece, point.stratum), point.unique_radius
            for halving in range(HALVINGS + 1):
                try:
                    if stratum.alone(point.x, radius, one.moment):
                        break
                except Refused:
                    pass
                if halving == HALVINGS or radius / 2 <= point.radius:
                    raise Refused(
                        f"point {number}: nothing shows that it is alone within {radius:.3g} rad"
                    )
                radius /= 2
            if radius < point.unique_radius:
                self._shell(number, point, radius)

    def _shell(self, number: int, point: CertifiedPoint, inner: float) -> None:
        """Check that nothing critical lies around a point, between two radii."""
        pins, box = point.stratum, [_outer(v, point.unique_radius) for v in point.x]
        for j in _free(pins):
            (low, high), near = box[j], _inner(point.x[j], inner)
            for part in ((low, near[0]), (near[1], high)):
                slab = (*box[:j], part, *box[j + 1 :])
                if not self._absent(slab, pins, critical=True):
                    raise Refused(
                        f"point {number}: nothing shows that it is alone within "
                        f"{point.unique_radius:.3g} rad"
                    )
            # slabs in turn, each beside the core in one angle: together they cover the shell
            box[j] = near

    # ------------------------------------------------------------ the tree

    def _tree(self) -> None:
        """Check the tree: all strata, every split, contraction and leaf."""
        nodes, n = self.certificate.nodes, self.piece.count
        kinds, numbers = nodes.kind.tolist(), nodes.number.tolist()
        boxes = iter(nodes.boxes)
        up, place = math.inf, 0
        limits = self.piece.limits
        beyond = [(math.nextafter(low, -up), math.nextafter(high, up)) for low, high in limits]
        # preorder: the stack holds what is still to be covered of this stratum, and must be empty at its end
        for pins in itertools.product((0, 1, -1), repeat=n):
            stack: list[Box] = [
                tuple((limits[i][s > 0],) * 2 if s else beyond[i] for i, s in enumerate(pins))
            ]
            while stack:
                if place == len(kinds):
                    raise Refused(f"the tree ends within {_stratum(pins)}: space is left uncovered")
                kind, number, box = kinds[place], numbers[place], stack.pop()
                try:
                    if kind == SPLIT:
                        stack += self._split(box, pins, number)
                    elif kind in (CONTRACT, NARROW):
                        ends = next(boxes).tolist()
                        stack.append(self._contracted(box, pins, ends, kind == NARROW))
                    else:
                        self._leaf(box, pins, kind, number)
                except Refused as problem:
                    raise Refused(
                        f"node {place + 1} ({KINDS[kind]}, {_stratum(pins)}): {problem}"
                    ) from None
                self.counts[kind] += 1
                place += 1
                if place % TOLD == 0:
                    self.progress(place, len(kinds))
        if place < len(kinds):
            raise Refused(f"the tree has {len(kinds) - place} nodes more than its strata")

    def _split(self, box: Box, pins: Sequence[int], axis: int) -> list[Box]:
        if not 0 <= axis < len(box) or pins[axis]:
            raise Refused(f"splits crease {axis + 1}, which is not free")
        return _halves(box, axis)

    def _contracted(
        self, box: Box, pins: Sequence[int], ends: list[list[float]], critical: bool
    ) -> Box:
        """Return the smaller box, once what it leaves out is known to hold no closed (or critical) state."""
        states = States(self.piece, box, pins)
        kept = [(max(low, a), min(high, b)) for (low, high), a, b in zip(box, *ends, strict=True)]
        free = _free(pins)
        for j in free:
            if not kept[j][0] <= kept[j][1]:
                raise Refused(f"the new box lies outside the old one at crease {j + 1}")
        if critical and any(states.beyond(j, box[j], kept[j]) for j in free):
            states.add_critical()
        new = list(box)
        for j in free:
            for part in states.beyond(j, box[j], kept[j]):
                if not self._absent((*new[:j], part, *new[j + 1 :]), pins, critical):
                    what = "critical" if critical else "closed"
                    raise Refused(f"what is cut off at crease {j + 1} may hold a {what} state")
            new[j] = kept[j]
        return tuple(new)

    def _leaf(self, box: Box, pins: Sequence[int], kind: int, number: int) -> None:
        """Check the reason of a leaf."""
        n = len(box)
        if kind == CLOSED:
            if not self._absent(box, pins):
                raise Refused("the box may hold a closed state")
        elif kind == NONE:
            if not self._absent(box, pins, critical=True):
                raise Refused("the box may hold a critical state")
        elif kind == MINOR:
            some = [i for i in range(n) if number >> i & 1]
            if len(some) != self.piece.rank + 1 or number >> n or any(pins[i] for i in some):
                raise Refused(f"names no {self.piece.rank + 1} free creases")
            if not self._absent(box, pins, excluded=lambda b: self._differs(some, b, pins)):
                raise Refused(f"the minor of creases {_listed(some)} may vanish")
        elif kind == TWIN:
            a, b = divmod(number, n)
            row = None
            if 0 <= a < n and not pins[a] and not pins[b]:
                row = self.piece.twin_row(a, b, box, pins)
            if row is None:
                raise Refused("names no free creases that coincide")
            if not nonzero(row):
                raise Refused(f"the torques of creases {_listed((a, b))} may agree")
        elif kind == FLAT:
            self._flat(box, pins)
        else:
            self._within(box, pins, kind, number)

    def _differs(self, some: Sequence[int], box: Box, pins: Sequence[int]) -> bool:
        return nonzero(next(self.piece.minors([some], box, pins)))

    def _flat(self, box: Box, pins: Sequence[int]) -> None:
        r0 = self.certificate.r0
        if any(pins) or not all(-r0 <= low and high <= r0 for low, high in box):
            raise Refused(f"does not lie within {r0:g} rad of the flat state")
        if not self.flat_shown:
            if not isinstance(self.piece, VertexChain) or isolated(self.piece, r0) is None:
                raise Refused(f"nothing shows that no state within {r0:g} rad of flat is critical")
            self.flat_shown = True

    def _within(self, box: Box, pins: Sequence[int], kind: int, number: int) -> None:
        """Check that a leaf lies in the box that it names."""
        c = self.certificate
        name, named = (
            ("point", c.points)
            if kind == ROOT
            else ("singular", c.singular)
            if kind == SINGULAR
            else ("undecided", c.undecided)
        )
        if not 0 <= number < len(named):
            raise Refused(f"there is no {name} {number + 1}")
        one = named[number]
        if tuple(pins) != one.stratum:
            raise Refused(f"{name} {number + 1} is of another stratum")
        for j in _free(pins):
            if isinstance(one, CertifiedPoint):
                low, high = _inner(one.x[j], one.unique_radius)
            else:
                # listed as open in the certificate: nothing is claimed of it
                low, high = one.lower[j], one.upper[j]
            if not (low <= box[j][0] and box[j][1] <= high):
                raise Refused(f"is not inside the box of {name} {number + 1}")

    # ------------------------------------------------------------ what a box does not hold

    def _absent(
        self,
        box: Box,
        pins: Sequence[int],
        critical: bool = False,
        excluded: Callable[[Box], bool] | None = None,
    ) -> bool:
        """Show that a box holds no closed state (no critical one; none but where `excluded`), by cutting it up."""
        free, stack = _free(pins), [box]
        for _ in range(TRIES):
            one = stack.pop()
            if excluded is None or not excluded(one):
                states = States(self.piece, one, pins)
                if critical:
                    states.add_critical()
                if not states.empty:
                    # a point cannot be cut any further
                    if not free:
                        return False
                    stack += _halves(states.narrowed(one), _widest(one, free))
            if not stack:
                return True
        return False


def _free(pins: Sequence[int]) -> list[int]:
    return [j for j, s in enumerate(pins) if not s]


def _widest(box: Box, free: Sequence[int]) -> int:
    return max(free, key=lambda j: box[j][1] - box[j][0])


def _halves(box: Box, axis: int) -> list[Box]:
    """Upper and lower half of a box: a stack gives the lower first."""
    low, high = box[axis]
    middle = 0.5 * (low + high)
    return [(*box[:axis], half, *box[axis + 1 :]) for half in ((middle, high), (low, middle))]


def _inner(middle: float, radius: float) -> tuple[float, float]:
    """Return doubles within `radius` of `middle`."""
    return math.nextafter(middle - radius, math.inf), math.nextafter(middle + radius, -math.inf)


def _outer(middle: float, radius: float) -> tuple[float, float]:
    """Return doubles that enclose all within `radius` of `middle`."""
    return math.nextafter(middle - radius, -math.inf), math.nextafter(middle + radius, math.inf)


def _listed(creases: Sequence[int]) -> str:
    return ", ".join(str(i + 1) for i in creases)


def _stratum(pins: Sequence[int]) -> str:
    return "stratum " + "".join("0+-"[s] for s in pins)
