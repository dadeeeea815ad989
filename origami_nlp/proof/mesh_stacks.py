"""Contact of meshes that fold flat with creases in one line, as far as it is decided: facets in stacks.

While some curves of a product move, creases at 0 and +-180 degrees are still, and facets that hang together by them are
one block: a plane stack that moves as one.  Whether the layers of all blocks have an order is the same all along,
and is asked at one state (`pattern_problem.order_layers`).  Facets of different blocks do not cross where

- a crease that moves joins the blocks, and each facet lies on one side of its line: so in two half planes about it;
- they lie within different sectors of a vertex that closes as paper (`strip_contact`);
- intervals say so, as of meshes without creases in line (`mesh_contact`).

Two rows that move by themselves join three blocks by two parallel lines: where these meet is decided over both folds
(`row_pairs`).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, INSIDE
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import PatternProblem, order_layers
from origami_nlp.proof.balls import exact
from origami_nlp.proof.mesh_contact import FoldingContact, FoldingCurve, FoldingEnergy
from origami_nlp.proof.mesh_curves import CurveEnergy
from origami_nlp.proof.mesh_states import Curve, FoldingMesh
from origami_nlp.proof.row_pairs import Condition, RowEnergy, RowPair, condition
from origami_nlp.proof.strip_contact import APART, CROSSING, UNKNOWN
from origami_nlp.proof.strips import along_curves

Still = tuple[int | None, ...]
"""Of each crease: 0, or +-1 where it is at +-180 degrees; None where it moves."""
SAMPLE = 0.6
"""Theta where the order of layers is asked [rad]."""
MOST_BOXES = 1_000
"""Of a curve."""


class MeshStacks:
    """What the facets of a mesh do while some of its curves move.

    Attributes
    ----------
    deviation
        By how much lengths that are taken as equal differ, over the size of the sheet.
    boxes
        How many boxes of theta were examined.
    """

    def __init__(self, mesh: FoldingMesh, pattern: Pattern, most: int, until: float) -> None:
        self.mesh, self.pattern, self.most, self.until = mesh, pattern, most, until
        self.problem = PatternProblem(pattern)
        self.size = float(np.ptp(pattern.corners, axis=0).max())
        self.deviation, self.boxes = 0.0, 0
        self._known: dict[tuple[Still, Curve], list[tuple[float, float, int]]] = {}
        self._blocks: dict[tuple[bool | None, ...], Blocks] = {}
        self._pairs: dict[tuple[Still, tuple[tuple[Curve, int], ...]], RowPair | int] = {}

    def blocks(self, still: Still) -> Blocks:
        """Return the blocks of facets that move as one."""
        key = tuple(None if s is None else bool(s) for s in still)
        if key not in self._blocks:
            self._blocks[key] = found = Blocks(self.pattern, key, self.size)
            self.deviation = max(self.deviation, found.deviation / self.size)
        return self._blocks[key]

    def ordered(self, still: Still, phi: np.ndarray) -> int:
        """Return whether the layers of blocks have an order at a state: APART, CROSSING or UNKNOWN."""
        if not self.blocks(still).clear:
            return UNKNOWN
        found = {"ordered": APART, "crosses": CROSSING}
        return found.get(order_layers(self.problem, phi).verdict, UNKNOWN)

    def sample(self, still: Still, moving: Sequence[tuple[Curve, int]]) -> np.ndarray:
        """Return a state in which these curves are on these sides of theta = 0."""
        phi = math.pi * np.array([s or 0 for s in still], float)
        for curve, side in moving:
            for m in curve:
                kappa = float(self.mesh.multiplier(m.key).centre)
                for c, s in m.creases:
                    phi[c] = 2 * s * m.sign * side * math.atan(kappa * math.tan(SAMPLE))
        return phi

    def along(self, still: Still, curve: Curve) -> list[tuple[float, float, int]]:
        """Return what facets do over boxes of theta along one curve, the others still."""
        key = still, curve
        if key not in self._known:
            self._known[key] = self._along(still, curve)
        return self._known[key]

    def _along(self, still: Still, curve: Curve) -> list[tuple[float, float, int]]:
        layers = {s: self.ordered(still, self.sample(still, [(curve, s)])) for s in (-1, 1)}
        far = self.blocks(still).far_pairs()
        found = [(-math.pi, 0.0, APART), (0.0, math.pi, APART)]
        if far and APART in layers.values():
            facets = FoldingContact(self.pattern, max(self.mesh.deviation, self.deviation), far)
            one = FoldingCurve(self.mesh, curve, self.pattern, still)
            turns = np.array([[one.turns[c]] for c in range(self.mesh.creases)], float)
            left = min(max(0, self.most - self.boxes), MOST_BOXES)
            energy = FoldingEnergy(one, self.pattern, turns)
            _, (claims,), examined = along_curves(energy, facets, left, self.until)
            self.boxes += examined
            self.deviation = max(self.deviation, facets.deviation)
            kinds = {"crossing": CROSSING, "open": UNKNOWN, "touching": UNKNOWN}
            found = [
                (low, high, kinds.get(claim, APART))
                for low, high, claim in zip(
                    claims.ends, claims.ends[1:], claims.claims, strict=False
                )
            ]
        # of all states of a side
        out = []
        for low, high, status in found:
            for side, (a, b) in ((-1, (low, min(high, 0.0))), (1, (max(low, 0.0), high))):
                if a < b:
                    out.append((a, b, status if layers[side] == APART else layers[side]))
        return out

    def near(self, still: Still, curve: Curve, low: float, high: float) -> int:
        """Return what facets do near theta in between, all along it."""
        found = {s for a, b, s in self.along(still, curve) if a < high and b > low}
        return found.pop() if len(found) == 1 else UNKNOWN

    def pair(self, still: Still, moving: Sequence[tuple[Curve, int]]) -> RowPair | int:
        """Return two curves that move by themselves, on these sides of their flat states; where the order of layers
        decides, or nothing does, CROSSING or UNKNOWN.
        """
        key = still, tuple(moving)
        if key not in self._pairs:
            layers = self.ordered(still, self.sample(still, moving))
            self._pairs[key] = self._pair(still, moving) if layers == APART else layers
        return self._pairs[key]

    def _pair(self, still: Still, moving: Sequence[tuple[Curve, int]]) -> RowPair | int:
        if len(moving) != 2 or any(len(curve) > 1 for curve, _ in moving):
            return UNKNOWN
        rows = []
        for curve, side in moving:
            energy = CurveEnergy(self.mesh, curve, self.pattern.stiffness, self.pattern.rest)
            ((_, k, load),) = energy.rows
            rows.append(RowEnergy(k, exact(float(side)) * load))
        folded = [
            {c: side * s * m.sign for m in curve for c, s in m.creases} for curve, side in moving
        ]
        found = self.blocks(still).parallel(folded[0], folded[1])
        if found is None:
            return UNKNOWN
        conditions, off = found
        self.deviation = max(self.deviation, off / self.size)
        return RowPair(conditions, (rows[0], rows[1]), CLOSURE_TOL * self.size)


class Blocks:
    """Facets that hang together by creases that are still, in the plane of each block.

    Attributes
    ----------
    clear
        Whether corners and lines of sides in one plane are certainly apart, or on each other but for what is rounded.
    deviation
        By how much they are off each other then.
    """

    def __init__(self, pattern: Pattern, folded: tuple[bool | None, ...], size: float) -> None:
        self.pattern, self.room = pattern, CLOSURE_TOL * size
        piece = {int(f): k for k, f in enumerate(pattern.facet_of)}
        both = zip(pattern.left.tolist(), pattern.right.tolist(), strict=True)
        self.beside = [(piece[a], piece[b]) for a, b in both]
        self.moving = [c for c, f in enumerate(folded) if f is None]
        # where all corners of the sheet are if it is turned over with a facet
        self.at: dict[int, np.ndarray] = {}
        self.of: dict[int, int] = {}
        for first in range(len(pattern.polygons)):
            if first in self.of:
                continue
            self.at[first], self.of[first] = pattern.corners[:, :2] @ (1, 1j), first
            front = [first]
            for here in front:
                for c, pair in enumerate(self.beside):
                    if folded[c] is None or here not in pair:
                        continue
                    there = pair[here == pair[0]]
                    if there not in self.of:
                        z = self.at[here]
                        a, b = z[pattern.ends[c]]
                        mirrored = a + (b - a) / np.conj(b - a) * np.conj(z - a)
                        self.at[there], self.of[there] = mirrored if folded[c] else z, first
                        front.append(there)
        self.corners = [self.at[k][list(p)] for k, p in enumerate(pattern.polygons)]
        self.deviation, self.clear = 0.0, True
        for f, g in itertools.permutations(range(len(self.corners)), 2):
            if self.of[f] != self.of[g]:
                continue
            for a, b in zip(self.corners[g], np.roll(self.corners[g], -1), strict=True):
                off = np.abs(_beyond(self.corners[f], a, b))
                self.clear &= not ((off > self.room) & (off < INSIDE * size)).any()
                self.deviation = max(self.deviation, float(off[off <= self.room].max(initial=0.0)))

    def far_pairs(self) -> list[tuple[int, int]]:
        """Return pairs of facets of different blocks that intervals must be asked about."""
        pairs = itertools.combinations(range(len(self.corners)), 2)
        return [
            (f, g)
            for f, g in pairs
            if self.of[f] != self.of[g] and not (self._about_line(f, g) or self._in_sectors(f, g))
        ]

    def _about_line(self, f: int, g: int) -> bool:
        """Return whether two facets are in half planes about the line of a crease that moves."""
        for c in self.moving:
            for one, two in (self.beside[c], self.beside[c][::-1]):
                if (self.of[f], self.of[g]) == (self.of[one], self.of[two]):
                    far = [
                        _beyond(self.corners[x], *self.at[y][self.pattern.ends[c]])
                        for x, y in ((f, one), (g, two))
                    ]
                    if all(x.min() >= -self.room or x.max() <= self.room for x in far):
                        return True
        return False

    def _in_sectors(self, f: int, g: int) -> bool:
        """Return whether two facets are within two sectors of a vertex, in different blocks."""
        for v in self.pattern.vertices:
            held = [{self.of[k] for k in self._sectors(v.vertex, x)} for x in (f, g)]
            if self.of[f] in held[0] and self.of[g] in held[1]:
                return True
        return False

    def _sectors(self, v: int, f: int) -> list[int]:
        """Return facets round a vertex whose sectors hold a facet of their block."""
        found = []
        for k, polygon in enumerate(self.pattern.polygons):
            if v not in polygon or self.of[k] != self.of[f]:
                continue
            z, i = self.corners[k], polygon.index(v)
            after, before = z[(i + 1) % len(z)], z[i - 1]
            inside = [
                np.sign(_beyond(other, z[i], end)) * _beyond(self.corners[f], z[i], end)
                for end, other in ((after, before), (before, after))
            ]
            if min(x.min() for x in inside) >= -self.room:
                found.append(k)
        return found

    def parallel(
        self, one: dict[int, int], two: dict[int, int]
    ) -> tuple[list[Condition], float] | None:
        """Return when outer blocks cross that two rows of creases join to one between them, folded to these sides.

        None where blocks are no trapezia between parallel lines; and by how much lengths are not what is meant.
        """
        sides = [{frozenset(self.of[k] for k in self.beside[c]) for c in row} for row in (one, two)]
        if len(set(self.of.values())) != 3 or any(len(s) != 1 or len(*s) != 2 for s in sides):
            return None
        (first,), (second,) = sides
        middle = first & second
        if len(middle) != 1:
            return None
        (m,) = middle
        along = self._axis(next(iter(one)), m)
        bounds, width, faces = [], 0.0, set()
        for row, block in ((one, first), (two, second)):
            (outer,) = block - middle
            lines = [self._axis(c, m) for c in row]
            # all in one line, parallel to the other row
            off = [abs(np.conj(along[1]) * d).imag for _, d in lines]
            off += [abs(_beyond(a, *_ends(*lines[0]))) for a, _ in lines]
            if max(off) > self.room:
                return None
            width = max(width, float(abs(_beyond(lines[0][0], *_ends(*along)))))
            origin, heading = lines[0]
            sense = (np.conj(along[1]) * heading).real
            shift = (np.conj(along[1]) * (origin - along[0])).real
            found = self._bounds(outer, self._axis(next(iter(row)), outer))
            if found is None:
                return None
            wide, low, high = found
            ends = np.sort(np.array([shift + sense * low, shift + sense * high]), axis=0)
            bounds.append((wide, *ends))
            faces.add(frozenset(s * self._turned(c, m) for c, s in row.items()))
        own = np.concatenate([z for k, z in enumerate(self.corners) if self.of[k] == m])
        inside = _beyond(own, *_ends(*along))
        if (
            width <= self.room
            or np.ptp(inside) > width + self.room
            or any(len(f) > 1 for f in faces)
        ):
            return None
        if len(faces) > 1:
            return [
                Condition([(-1.0, 0, 0, 0)], frozenset())
            ], 0.0  # on both sides of the block between
        return _crossing(width, bounds[0], bounds[1], self.room)

    def _turned(self, crease: int, block: int) -> int:
        """Return -1 if the facet of a block beside a crease is turned over in its plane."""
        k = next(k for k in self.beside[crease] if self.of[k] == block)
        flat = self.pattern.corners[list(self.pattern.polygons[k]), :2] @ (1, 1j)
        areas = [(np.conj(z) * np.roll(z, -1)).imag.sum() for z in (flat, self.corners[k])]
        return 1 if areas[0] * areas[1] > 0 else -1

    def _axis(self, crease: int, block: int) -> tuple[complex, complex]:
        """Return a point and the direction of a crease that moves, in the plane of a block."""
        k = next(k for k in self.beside[crease] if self.of[k] == block)
        a, b = self.at[k][self.pattern.ends[crease]]
        return a, (b - a) / abs(b - a)

    def _bounds(
        self, block: int, axis: tuple[complex, complex]
    ) -> tuple[float, np.ndarray, np.ndarray] | None:
        """Return the width of a block beside a line, and between which numbers it lies along it, at the line and far
        away, [2]; None where it is no trapezium.
        """
        a, d = axis
        facets = [(np.conj(d) * (z - a)) for k, z in enumerate(self.corners) if self.of[k] == block]
        off = np.concatenate([z.imag for z in facets])
        sign = 1.0 if off.max() > -off.min() else -1.0
        width = float((sign * off).max())
        spans = []
        for z in facets:
            near, away = (np.abs(sign * z.imag - x) <= self.room for x in (0.0, width))
            if not (near | away).all() or not (near.any() and away.any()):
                return None
            spans.append([[z.real[x].min(), z.real[x].max()] for x in (near, away)])
        spans.sort()
        total = np.array(spans[0])
        for span in np.array(spans[1:]):
            # beside it, or on it: no gap, and one row of sides at each end
            if (span[:, 0] > total[:, 1] + self.room).any() or (span < total - self.room)[
                :, 0
            ].any():
                return None
            total[:, 1] = np.fmax(total[:, 1], span[:, 1])
        return width, total[:, 0], total[:, 1]


def _crossing(
    width: float,
    one: tuple[float, np.ndarray, np.ndarray],
    two: tuple[float, np.ndarray, np.ndarray],
    room: float,
) -> tuple[list[Condition], float]:
    """Return when two trapezia cross beside a block: of each its width, and its ends at its row and far away."""
    (a, low, high), (b, below, above) = one, two
    found = [condition(a, -width, 0.0, room), condition(b, 0.0, -width, room)]
    for sign, of_one, of_two in ((1.0, high, below), (-1.0, low, above)):
        # sign (one(s) - two(t)) > 0, times sin(p + q)
        share = sign * width * np.diff(of_one)[0] / a, -sign * width * np.diff(of_two)[0] / b
        found.append(condition(sign * (of_one[0] - of_two[0]), *share, room))
    return [f for f, _ in found], max(off for _, off in found)


def _beyond(x: np.ndarray | complex, a: complex, b: complex) -> np.ndarray:
    """Return how far points are to the left of the line from a to b."""
    return np.asarray((np.conj(b - a) * (x - a)).imag / abs(b - a))


def _ends(a: complex, d: complex) -> tuple[complex, complex]:
    return a, a + d
