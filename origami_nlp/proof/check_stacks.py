"""The check of a proof with contact of a mesh with creases in one line: facets that lie on each other along curves.

The statement is that of `check_mesh`; each closed state is in one set, in which rows are 0, at +-180 degrees, or move.
In a set creases that do not move join facets to parts that move as one.  With the others at 0 all facets are in one
plane, and if those of different parts do not overlap there, layers have an order all over the set exactly if they have
one there (`check_layers`): about the line of a crease that moves, paper goes on from part to part as if it were flat.
Then

- two parts on both sides of the line of all creases that move are in two half planes: they do not cross;
- three parts in a row between parallel lines, the outer two convex, are asked about over both folds
  (`check_row_pairs`);
- else intervals of T decide (`check_mesh_contact`), of facets that lie on each other all over one for all.

A state is a minimum if facets can be as they are, and the energy falls into no set where they do not cross.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from flint import arb

from origami_nlp.proof.check_layers import GRAZING, FlatLayers, LayersUnclear, Point
from origami_nlp.proof.check_mesh import FREE, TURNED, RowGroup, _sign
from origami_nlp.proof.check_mesh_contact import APART, CROSSING, UNKNOWN, MeshContactCheck
from origami_nlp.proof.check_row_pairs import CheckedPair, CheckedRow, crossing
from origami_nlp.proof.check_strip_contact import CheckedContact

Still: TypeAlias = tuple[int | None, ...]
"""Of each crease: 0, or +-1 at +-180 degrees; None where it moves."""
MovingRows: TypeAlias = tuple[RowGroup, int, Any]
"""Rows that move as one, on a side of T = 0, and how far they are folded: 0 or pi beside these."""


class StackCheck(MeshContactCheck):
    """Find again what a certificate claims, with contact, creases in one line or not."""

    def _decide(self) -> None:
        if not any(any(c.straight) for c in self.crossings):
            super()._decide()
            return
        self.counts = {"sets": 0, "curves": 0, "intervals": 0, "stacks": 0}
        self.contact = CheckedContact(self.disk, arb(0, 4 * self.said.deviation))
        self._far = self.contact.pairs
        self._layers: dict[frozenset[int], FlatLayers | None] = {}
        self._stacks: dict[Still, int] = {}
        self._pairs: dict[tuple[Still, tuple[tuple[RowGroup, int], ...]], CheckedPair | int] = {}
        self._ways_of: dict[tuple[Still, RowGroup], dict[int, int]] = {}
        total = 3 ** len(self.rows)
        for done, kinds in enumerate(itertools.product(range(3), repeat=len(self.rows))):
            self._found += list(self._set(kinds))
            self.progress(done + 1, total)

    def _set(self, kinds: Sequence[int]) -> Iterator[list[Any]]:
        for along, moving in self._signed(kinds):
            if moving:
                self._found += list(self._touches(kinds, along, moving))
        yield from super()._set(kinds)

    def _touches(
        self, kinds: Sequence[int], along: dict[int, int], moving: list[RowGroup]
    ) -> Iterator[list[Any]]:
        """Yield the states of a set that touching facets hold; leave open what is not decided."""
        turned = [r for r, k in enumerate(kinds) if k == TURNED]
        why = "whether facets that touch hold a state while rows move"
        for sides in itertools.product((1, -1), repeat=len(turned)):
            at = dict(zip(turned, sides, strict=True))
            still = tuple(
                None if kinds[r] == FREE else at.get(r, 0) * along.get(c, 0)
                for c, r in enumerate(self.row)
            )
            if len(moving) == 1:
                found = {self._facets(still, [(moving[0], s, None)]) for s in (1, -1)}
                if UNKNOWN in found or len(found) > 1:
                    self.open.append(why)
                continue
            for ways in itertools.product((1, -1), repeat=len(moving)):
                pair = self._pair(still, list(zip(moving, ways, strict=True)))
                if not isinstance(pair, CheckedPair):
                    self.open += [why] * (pair == UNKNOWN)
                    continue
                held, whole = pair.held()
                self.open += [why] * (not whole)
                for both in held:
                    folds = [arb(0) if s is None else s * arb.pi() for s in still]
                    for group, side, fold in zip(moving, ways, both, strict=True):
                        for c, _, sign, _ in group.creases:
                            folds[c] = side * sign * fold
                    if any(slope <= 0 for slope, *_ in self._all_leaving(kinds, folds)):
                        self.open.append("whether rows leave a state that facets hold")
                    else:
                        self._closes(folds)
                        yield folds

    def _stays(
        self, kinds: Sequence[int], folds: Sequence[Any], moving: Sequence[RowGroup] = ()
    ) -> bool:
        if not any(any(c.straight) for c in self.crossings):
            return super()._stays(kinds, folds, moving)
        still = tuple(
            None if kinds[r] == FREE else _sign(f) for r, f in zip(self.row, folds, strict=True)
        )
        own: list[MovingRows] = [
            (g, _sign(folds[g.creases[0][0]]) * g.creases[0][2], abs(folds[g.creases[0][0]]))
            for g in moving
        ]
        certain = True
        leaving = list(self._all_leaving(kinds, folds))
        for slope, group, sides in leaving:
            if slope > 0:
                continue
            beside = _without(still, group)
            for side in sides:
                border = abs(folds[group.creases[0][0]])
                facets = self._facets(beside, [*own, (group, side, border)])
                if slope and facets == APART:
                    return False
                certain &= bool(slope) and facets == CROSSING
        for one, two in itertools.combinations(leaving, 2):
            if certain and min(one[0], two[0]) < 0 and not _share(one[1], two[1]):
                falls = self._falls_at_once(kinds, folds, still, (one[1], two[1]))
                if falls:
                    return False
                certain &= falls is not None
        facets = self._facets(still, own)
        if facets != CROSSING and not (certain and facets == APART):
            self.open.append("whether facets let the energy fall from a state along a curve")
        return certain and facets == APART

    def _falls_at_once(
        self, kinds: Sequence[int], folds: Sequence[Any], still: Still, groups: Sequence[RowGroup]
    ) -> bool | None:
        """Return whether the energy falls from a state as two groups of rows leave it at once; None: not certain."""
        rows = {r for g in groups for _, r, *_ in g.creases}
        free = [FREE if r in rows else k for r, k in enumerate(kinds)]
        beside = _without(_without(still, groups[0]), groups[1])
        if not any(
            all(any(_alike(g, m) for m in moving) for g in groups)
            and all(
                len({_sign(folds[c]) * along[c] for c, x in enumerate(self.row) if x == r}) == 1
                for r, k in enumerate(free)
                if k == TURNED
            )
            for along, moving in self._signed(free)
        ):
            return False
        corner, ways = [], []
        for g in groups:
            signs = {_sign(folds[c]) * sign for c, _, sign, _ in g.creases}
            if len(signs) > 1:
                return False
            corner.append(int(signs == {0}))
            ways.append((1, -1) if signs == {0} else tuple(signs))
        found = set()
        for sides in itertools.product(*ways):
            pair = self._pair(beside, list(zip(groups, sides, strict=True)))
            if isinstance(pair, CheckedPair):
                found.add(pair.falls((corner[0], corner[1])))
            else:
                found.add(False if pair == CROSSING else None)
        return True if True in found else None if None in found else False

    def _facets(self, still: Still, moving: Sequence[MovingRows]) -> int:
        """Return what facets do where groups of rows move, on a side of T = 0, two at these folds or beside them."""
        if len(moving) == 1:
            ((group, side, _),) = moving
            if (still, group) not in self._ways_of:
                self._ways_of[still, group] = self._both_sides(still, group)
            return self._ways_of[still, group][side]
        if not moving:
            return self._stacked(still)
        pair = self._pair(still, [(g, s) for g, s, _ in moving])
        if not isinstance(pair, CheckedPair):
            return pair
        return {-1: APART, 1: CROSSING}.get(pair.known(*(x for *_, x in moving)), UNKNOWN)

    def _pair(self, still: Still, moving: Sequence[tuple[RowGroup, int]]) -> CheckedPair | int:
        """Return two rows that move, on these sides; CROSSING or UNKNOWN where layers decide, or nothing does."""
        key = still, tuple(moving)
        if key not in self._pairs:
            layers = self._stacked(still)
            self._pairs[key] = self._in_a_row(still, moving) if layers == APART else layers
        return self._pairs[key]

    def _flat(self, still: Still) -> FlatLayers:
        """Return the sheet in the plane, creases that move at 0."""
        flat = frozenset(c for c, s in enumerate(still) if not s)
        if flat not in self._layers:
            try:
                self._layers[flat] = FlatLayers(self.disk, flat)
            except LayersUnclear:
                self._layers[flat] = None
        found = self._layers[flat]
        if found is None:
            raise LayersUnclear
        return found

    def _parts(self, still: Still) -> list[int]:
        """Return of each facet the first one of its part."""
        part = list(range(len(self.disk.facets)))
        for (f, g, _), s in zip(self._flat(still).creases, still, strict=True):
            if s is not None:
                part = [part[f] if p == part[g] else p for p in part]
        return part

    def _stacked(self, still: Still) -> int:
        """Return whether layers have an order: APART, CROSSING or UNKNOWN."""
        if still not in self._stacks:
            self.counts["stacks"] += 1
            try:
                layers, part = self._flat(still), self._parts(still)
                if any(part[f] != part[g] for f, g in layers.pairs):
                    raise LayersUnclear
                paper = layers.can_be_stacked([s or 0 for s in still])
                self._stacks[still] = APART if paper else CROSSING
            except LayersUnclear:
                self._stacks[still] = UNKNOWN
        return self._stacks[still]

    def _both_sides(self, still: Still, group: RowGroup) -> dict[int, int]:
        """Return what facets do all over each side of T = 0."""
        layers = self._stacked(still)
        if layers != APART or self._about_one_line(still):
            return {1: layers, -1: layers}
        self._still, self.contact.pairs = still, self._apart_from(still)
        found = {}
        for side in (1, -1):
            ends = min(0.0, float(side)), max(0.0, float(side))
            kinds = {s.kind for x in (0, side) for s in self._stretches(group, x, *ends)}
            found[side] = kinds.pop() if kinds in ({APART}, {CROSSING}) else UNKNOWN
        return found

    def _apart_from(self, still: Still) -> list[tuple[int, int]]:
        """Return pairs of facets to be asked about: of different parts, and of those on each other the first."""
        part, alike = self._parts(still), self._distinct(still)
        pairs = itertools.combinations(alike, 2)
        # facets that share a vertex do not cross, nor do those that lie on them
        return [
            (f, g)
            for f, g in pairs
            if part[f] != part[g]
            and all((min(p), max(p)) in self._far for p in itertools.product(alike[f], alike[g]))
        ]

    def _distinct(self, still: Still) -> dict[int, list[int]]:
        """Return facets, the first of those of a part that lie on each other all over, and these."""
        layers, part = self._flat(still), self._parts(still)
        alike: dict[int, list[int]] = {}
        for f, ring in enumerate(layers.rings):
            first = next(
                (
                    g
                    for g in alike
                    if part[f] == part[g]
                    and len(ring) == len(layers.rings[g])
                    and max(min(abs(z - w) for w in layers.rings[g]) for z in ring)
                    <= GRAZING * layers.size
                ),
                f,
            )
            alike.setdefault(first, []).append(f)
        return alike

    def _in_frame(
        self, still: Still
    ) -> tuple[dict[int, list[Point]], dict[int, list[list[Point]]], float]:
        """Return creases that move, and distinct facets of each part, with the first such crease on the real axis."""
        layers, part = self._flat(still), self._parts(still)
        moving = {c: layers.creases[c][2] for c, s in enumerate(still) if s is None}
        a, b = next(iter(moving.values()))
        turn = (b - a).conjugate() / abs(b - a)
        lines = {c: [turn * (z - a) for z in ends] for c, ends in moving.items()}
        parts: dict[int, list[list[Point]]] = {}
        for f in self._distinct(still):
            parts.setdefault(part[f], []).append([turn * (z - a) for z in layers.rings[f]])
        return lines, parts, GRAZING * layers.size

    def _about_one_line(self, still: Still) -> bool:
        """Return whether two parts lie on both sides of one line with all creases that move."""
        lines, parts, room = self._in_frame(still)
        off = sorted(_heights(p) for p in parts.values())
        one = all(abs(z.imag) <= room for ends in lines.values() for z in ends)
        return one and len(off) == 2 and off[0][1] <= room and off[1][0] >= -room

    def _in_a_row(self, still: Still, moving: Sequence[tuple[RowGroup, int]]) -> CheckedPair | int:
        """Return what is known of three parts between two parallel lines, if they are such, else UNKNOWN."""
        if len(moving) != 2 or any(powers for g, _ in moving for *_, powers in g.creases):
            return UNKNOWN
        layers, part = self._flat(still), self._parts(still)
        pairs = itertools.combinations(self._distinct(still), 2)
        if any(pair in layers.pairs for pair in pairs):
            return UNKNOWN
        lines, parts, room = self._in_frame(still)
        far = max((z.imag for ends in lines.values() for z in ends), key=abs)
        if far < 0:
            parts = {k: [[z.conjugate() for z in ring] for ring in p] for k, p in parts.items()}
            lines = {c: [z.conjugate() for z in ends] for c, ends in lines.items()}
            far = -far
        low, middle, high = sorted(parts, key=lambda k: _heights(parts[k]))[:3] + [0] * (
            3 - len(parts)
        )
        rows = [_heights([[z for c, *_ in g.creases for z in lines[c]]]) for g, _ in moving]
        ends = [_heights(parts[k]) for k in (low, middle, high)]
        ordered = ends[0][1] <= room and ends[1][0] >= -room and ends[1][1] <= far + room
        if len(parts) != 3 or far <= room or not ordered or ends[2][0] < far - room:
            return UNKNOWN
        if any(b - a > room for a, b in rows) or abs(rows[0][0] - rows[1][0]) < far - room:
            return UNKNOWN
        below = _outline([[complex(z.real, -z.imag) for z in ring] for ring in parts[low]], room)
        above = _outline([[z - 1j * far for z in ring] for ring in parts[high]], room)
        faces = {
            side
            * sign
            * (
                -1
                if layers.over[next(f for f in layers.creases[c][:2] if part[f] == middle)]
                else 1
            )
            for g, side in moving
            for c, _, sign, _ in g.creases
        }
        if not below or not above:
            return UNKNOWN
        first_below = abs(rows[0][0]) <= room
        one, two = (below, above) if first_below else (above, below)
        apart = [{(0, 0): arb(-1)}]
        found = crossing(far, one, two, room) if len(faces) == 1 else apart
        return CheckedPair(found, (self._row_energy(*moving[0]), self._row_energy(*moving[1])))

    def _row_energy(self, group: RowGroup, side: int) -> CheckedRow:
        k, load = Fraction(0), Fraction(0)
        for c, _, sign, _ in group.creases:
            own = Fraction(self.said.stiffness[c])
            k, load = k + own, load + own * side * sign * Fraction(self.said.rest[c])
        return CheckedRow(k, load)


def _without(still: Still, group: RowGroup) -> Still:
    """Return what is still where a group moves as well."""
    moved = {c for c, *_ in group.creases}
    return tuple(None if c in moved else s for c, s in enumerate(still))


def _share(one: RowGroup, two: RowGroup) -> bool:
    return bool({r for _, r, *_ in one.creases} & {r for _, r, *_ in two.creases})


def _alike(one: RowGroup, two: RowGroup) -> bool:
    """Return whether the same creases move, to the same sides or all to the others."""
    signs = [{c: sign for c, _, sign, _ in g.creases} for g in (one, two)]
    return (
        signs[0].keys() == signs[1].keys()
        and len({signs[0][c] * signs[1][c] for c in signs[0]}) == 1
    )


def _heights(rings: Sequence[Sequence[Point]]) -> tuple[float, float]:
    """Return the least and the largest imaginary part of polygons."""
    off = [z.imag for ring in rings for z in ring]
    return min(off), max(off)


def _area(ring: Sequence[Point]) -> float:
    return 0.5 * sum(
        (a.conjugate() * b).imag for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)
    )


def _outline(rings: list[list[Point]], room: float) -> list[Point]:
    """Return a convex outline that polygons without overlap fill; none if they do not."""
    top = max(z.imag for ring in rings for z in ring)
    # corners at one height to rounding are at one
    near = {
        z: min((0.0, top, z.imag), key=lambda y: (abs(y - z.imag) > room, y == z.imag))
        for ring in rings
        for z in ring
    }
    corners = sorted({complex(z.real, y) for z, y in near.items()}, key=lambda z: (z.real, z.imag))
    hull: list[Point] = []
    for way in (corners, corners[::-1]):
        start = len(hull)
        for z in way:
            while (
                len(hull) > start + 1
                and ((hull[-1] - hull[-2]).conjugate() * (z - hull[-2])).imag <= 0
            ):
                hull.pop()
            hull.append(z)
        hull.pop()
    filled = sum(abs(_area(ring)) for ring in rings)
    size = max(abs(z - hull[0]) for z in hull)
    return hull if abs(filled - _area(hull)) <= room * size else []
