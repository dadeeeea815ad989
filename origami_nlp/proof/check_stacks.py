"""The check of a proof with contact of a mesh with creases in one line: facets that lie on each other along curves.

The statement is that of `check_mesh`; each closed state is in one set, in which rows are 0, at +-180 degrees, or move.
In a set creases that do not move join facets to parts that move as one.  With the others at 0 all facets are in one
plane, and if those of different parts do not overlap there, layers have an order all over the set exactly if they have
one there (`check_layers`): about the line of a crease that moves, paper goes on from part to part as if it were flat.
Then

- two parts on both sides of the line of all creases that move are in two half planes: they do not cross;
- three parts in a row between parallel lines: if the outer ones are no wider than the middle one, and share no less
  where they are nearer to it, no contact holds a state as long as the energy falls from all folds of 90 to 180 degrees
  (the triangle of the two lines and the place where they cross has angles below 90 degrees at these; as both grow by
  their sines, both its sides grow);
- else intervals of T decide (`check_mesh_contact`), of facets that lie on each other all over one for all.

A state is a minimum if facets can be as they are, and the energy falls into no set where they do not cross.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from flint import arb

from origami_nlp.proof.check_layers import GRAZING, FlatLayers, LayersUnclear, Point
from origami_nlp.proof.check_mesh import FREE, TURNED, RowGroup, _sign
from origami_nlp.proof.check_mesh_contact import APART, CROSSING, UNKNOWN, MeshContactCheck
from origami_nlp.proof.check_strip_contact import CheckedContact

Still: TypeAlias = tuple[int | None, ...]
"""Of each crease: 0, or +-1 at +-180 degrees; None where it moves."""
QUARTER = math.nextafter(0.5 * math.pi, 0.0)
"""Not above pi/2: folds are below it where the energy is least [rad]."""


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
        self._ways_of: dict[tuple[Still, RowGroup], dict[int, int]] = {}
        total = 3 ** len(self.rows)
        for done, kinds in enumerate(itertools.product(range(3), repeat=len(self.rows))):
            self._found += list(self._set(kinds))
            self.progress(done + 1, total)

    def _set(self, kinds: Sequence[int]) -> Iterator[list[Any]]:
        for along, moving in self._signed(kinds):
            if moving:
                self._touches(kinds, along, moving)
        yield from super()._set(kinds)

    def _touches(self, kinds: Sequence[int], along: dict[int, int], moving: list[RowGroup]) -> None:
        """Leave open whether touching facets hold a state of a set, unless they certainly do not."""
        turned = [r for r, k in enumerate(kinds) if k == TURNED]
        for sides in itertools.product((1, -1), repeat=len(turned)):
            at = dict(zip(turned, sides, strict=True))
            still = tuple(
                None if kinds[r] == FREE else at.get(r, 0) * along.get(c, 0)
                for c, r in enumerate(self.row)
            )
            found = {self._facets(still, [(g, s) for g in moving]) for s in (1, -1)}
            if UNKNOWN in found or len(found) > 1:
                self.open.append("whether facets that touch hold a state while rows move")

    def _stays(
        self, kinds: Sequence[int], folds: Sequence[Any], moving: Sequence[RowGroup] = ()
    ) -> bool:
        if not any(any(c.straight) for c in self.crossings):
            return super()._stays(kinds, folds, moving)
        still = tuple(
            None if kinds[r] == FREE else _sign(f) for r, f in zip(self.row, folds, strict=True)
        )
        own = [(g, _sign(folds[g.creases[0][0]]) * g.creases[0][2]) for g in moving]
        certain = True
        leaving = list(self._all_leaving(kinds, folds))
        for slope, group, sides in leaving:
            if slope > 0:
                continue
            beside = list(still)
            for c, *_ in group.creases:
                beside[c] = None
            for side in sides:
                facets = self._facets(tuple(beside), [*own, (group, side)])
                if slope and facets == APART:
                    return False
                # where others move as well, facets may be apart
                alone = not own and all(_share(group, other) for _, other, _ in leaving)
                certain &= bool(slope) and facets == CROSSING and alone
        facets = self._facets(still, own)
        if facets != CROSSING and not (certain and facets == APART):
            self.open.append("whether facets let the energy fall from a state along a curve")
        return certain and facets == APART

    def _facets(self, still: Still, moving: Sequence[tuple[RowGroup, int]]) -> int:
        """Return what facets do where groups of rows move, on a side of T = 0 each; of two groups in part of that."""
        if len(moving) == 1:
            ((group, side),) = moving
            if (still, group) not in self._ways_of:
                self._ways_of[still, group] = self._both_sides(still, group)
            return self._ways_of[still, group][side]
        layers = self._stacked(still)
        if not moving or layers != APART:
            return layers
        groups = [g for g, _ in moving]
        return APART if len(groups) == 2 and self._open_up(still, groups) else UNKNOWN

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
    ) -> tuple[dict[int, list[Point]], list[list[list[Point]]], float]:
        """Return creases that move, and distinct facets of each part, with the first such crease on the real axis."""
        layers, part = self._flat(still), self._parts(still)
        moving = {c: layers.creases[c][2] for c, s in enumerate(still) if s is None}
        a, b = next(iter(moving.values()))
        turn = (b - a).conjugate() / abs(b - a)
        lines = {c: [turn * (z - a) for z in ends] for c, ends in moving.items()}
        parts: dict[int, list[list[Point]]] = {}
        for f in self._distinct(still):
            parts.setdefault(part[f], []).append([turn * (z - a) for z in layers.rings[f]])
        return lines, list(parts.values()), GRAZING * layers.size

    def _about_one_line(self, still: Still) -> bool:
        """Return whether two parts lie on both sides of one line with all creases that move."""
        lines, parts, room = self._in_frame(still)
        off = sorted(_heights(p) for p in parts)
        one = all(abs(z.imag) <= room for ends in lines.values() for z in ends)
        return one and len(off) == 2 and off[0][1] <= room and off[1][0] >= -room

    def _open_up(self, still: Still, groups: Sequence[RowGroup]) -> bool:
        """Return whether no contact holds a state in which these two groups move, each a row by itself."""
        for group in groups:
            k = [Fraction(self.said.stiffness[c]) for c, *_ in group.creases]
            torques = (
                x * s * Fraction(self.said.rest[c])
                for x, (c, _, s, _) in zip(k, group.creases, strict=True)
            )
            load = sum(torques, Fraction(0))
            alone = not any(powers for *_, powers in group.creases)
            total = sum(k, Fraction(0))
            if not (alone and total and abs(load / total) < Fraction(QUARTER)):
                return False
        pairs = itertools.combinations(self._distinct(still), 2)
        if any(pair in self._flat(still).pairs for pair in pairs):
            return False
        lines, parts, room = self._in_frame(still)
        far = max((z.imag for ends in lines.values() for z in ends), key=abs)
        if far < 0:
            parts = [[[z.conjugate() for z in ring] for ring in p] for p in parts]
            lines = {c: [z.conjugate() for z in ends] for c, ends in lines.items()}
            far = -far
        rows = [_heights([[z for c, *_ in g.creases for z in lines[c]]]) for g in groups]
        parts.sort(key=_heights)
        if len(parts) != 3 or any(high - low > room for low, high in rows):
            return False
        (low, one), (two, three), (four, high) = map(_heights, parts)
        inside = one <= room and two >= -room and three <= far + room and four >= far - room
        if not inside or max(-low, high - far) > far + room:
            return False
        below = _outline([[complex(z.real, -z.imag) for z in ring] for ring in parts[0]], room)
        above = _outline([[z - 1j * far for z in ring] for ring in parts[2]], room)
        return bool(below and above) and _nearer_shares_more(below, above, room)


def _share(one: RowGroup, two: RowGroup) -> bool:
    return bool({r for _, r, *_ in one.creases} & {r for _, r, *_ in two.creases})


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


def _section(hull: list[Point], height: float) -> tuple[float, float]:
    """Return between which real parts a convex polygon is at a height."""
    found = []
    for a, b in zip(hull, [*hull[1:], hull[0]], strict=True):
        if min(a.imag, b.imag) <= height <= max(a.imag, b.imag):
            ends = (a.real, b.real) if a.imag == b.imag else ()
            share = 0.0 if a.imag == b.imag else (height - a.imag) / (b.imag - a.imag)
            found += [*ends] or [a.real + share * (b.real - a.real)]
    return min(found), max(found)


def _nearer_shares_more(below: list[Point], above: list[Point], room: float) -> bool:
    """Return whether two convex polygons over the real axis share paper at lower sections if they do at higher ones."""
    tables = [
        [_section(hull, h) for h in sorted({z.imag for z in hull})] for hull in (below, above)
    ]
    for one, two in (tables, tables[::-1]):
        # what a section of one reaches beyond the beginning of one of the other: concave, linear between corners
        reach = [[high - low for low, _ in two] for _, high in one]
        values = [x for row in reach for x in row]
        if min(values) > room or max(values) <= room:
            continue
        falls = [b - a for row in reach for a, b in itertools.pairwise(row)]
        falls += [y - x for a, b in itertools.pairwise(reach) for x, y in zip(a, b, strict=True)]
        if max(falls) > room:
            return False
    return True
