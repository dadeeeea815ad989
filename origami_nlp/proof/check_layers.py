"""Can a sheet whose creases are folded by +-180 degrees or not at all be stacked?  Decided facet on facet, for a check.

Of two facets that overlap one is above, and (Demaine and O'Rourke, Geometric Folding Algorithms, 11.4)

- a crease says by its sign which of its two facets is above;
- where a crease, folded or not, lies inside another facet, that one is above both facets of the crease, or below both;
- two creases on one line, with facets on one side of it, do not interleave: both facets of one are between those of the
  other, or none is; where one is not folded, no facet of it is between those of the other, and where neither is, those
  of one are both above those of the other;
- of three facets that overlap in one place, the order is transitive.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import TypeAlias

from origami_nlp.proof.check_strip_sheet import FlatDisk

DEEP = 1e-7
"""Overlap, over the size of the sheet, from which facets lie on each other."""
GRAZING = 1e-12
"""Overlap, over the size of the sheet, up to which they do not; between the two nothing is decided."""
SEARCHED = 20_000
"""Orders that are tried of one state, at most."""
Point: TypeAlias = complex


class LayersUnclear(Exception):
    """It cannot be decided."""


class FlatLayers:
    """A sheet with all creases folded by +-180 degrees, but for those at 0: what lies on what hangs on no sign.

    Raises
    ------
    LayersUnclear
        If facets all but overlap.
    """

    def __init__(self, disk: FlatDisk, flat: frozenset[int] = frozenset()) -> None:
        self.flat = flat
        points = [complex(*map(float, p)) for p in disk.points]
        self.size = max(abs(p - points[0]) for p in points)
        # images z -> u z + v, or u conj(z) + v of facets that are turned over
        at: dict[int, tuple[complex, complex, bool]] = {0: (1, 0, False)}
        for g, f, c, _ in disk.walk():
            if c in flat:
                at[g] = at[f]
                continue
            a, b = (self._image(at[f], points[i]) for i in disk.said.creases[c])
            u, v, over = at[f]
            turn = (b - a) / (b - a).conjugate()
            at[g] = (turn * u.conjugate(), a + turn * (v - a).conjugate(), not over)
        self.over = {f: way[2] for f, way in at.items()}
        self.rings = [
            _anticlockwise([self._image(at[f], points[i]) for i in ring])
            for f, ring in enumerate(disk.facets)
        ]
        # of each crease the facet on its left, that on its right, and its image
        self.creases = [
            (
                disk.beside[a, b],
                disk.beside[b, a],
                [self._image(at[disk.beside[a, b]], points[i]) for i in (a, b)],
            )
            for a, b in disk.said.creases
        ]
        self._rules()

    @staticmethod
    def _image(way: tuple[complex, complex, bool], z: complex) -> complex:
        u, v, over = way
        return u * (z.conjugate() if over else z) + v

    def _rules(self) -> None:
        many = range(len(self.rings))
        self.pairs = [p for p in itertools.combinations(many, 2) if self._overlap(*p)]
        of = {p: k for k, p in enumerate(self.pairs)}

        def order(f: int, g: int) -> tuple[int, int]:
            """Return the number of a pair, and the sign with which it says that g is above f."""
            return (of[f, g], 1) if (f, g) in of else (of[g, f], -1)

        folded = [c not in self.flat for c in range(len(self.creases))]
        self.first = [
            order(f, g) if fold else None
            for (f, g, _), fold in zip(self.creases, folded, strict=True)
        ]
        self.rules: list[tuple[tuple[int, ...], Callable[[Sequence[int]], bool]]] = []

        def alike(one: tuple[int, int], two: tuple[int, int]) -> None:
            (i, s), (j, t) = one, two
            self.rules.append(((i, j), lambda x: s * x[0] == t * x[1]))

        for f, g, ends in self.creases:
            for h in set(many) - {f, g}:
                if self._within(ends, self.rings[h]):
                    alike(order(f, h), order(g, h))
        for c, d in itertools.combinations(range(len(self.creases)), 2):
            if folded[d] and not folded[c]:
                c, d = d, c
            (f, g, one), (h, k, two) = self.creases[c], self.creases[d]
            if len({f, g, h, k}) < 4 or not self._along(one, two):
                continue
            if not folded[d]:
                h, k = (h, k) if self._side(one, f) == self._side(one, h) else (k, h)
                alike(order(f, h), order(g, h if folded[c] else k))
                continue
            if self._side(one, f) != self._side(one, h):
                continue
            four = [order(a, b) for a, b in ((f, h), (g, h), (f, k), (g, k))]
            signs = [s for _, s in four]
            self.rules.append(
                (
                    tuple(i for i, _ in four),
                    lambda x, s=signs: (x[0] * s[0] == x[1] * s[1]) == (x[2] * s[2] == x[3] * s[3]),  # type: ignore[misc]
                )
            )
            # and the other way round: whether f, g are between h and k
            self.rules.append(
                (
                    tuple(i for i, _ in four),
                    lambda x, s=signs: (x[0] * s[0] == x[2] * s[2]) == (x[1] * s[1] == x[3] * s[3]),  # type: ignore[misc]
                )
            )
        for a, b, c in itertools.combinations(many, 3):
            if {(a, b), (a, c), (b, c)} <= of.keys():
                common = _clipped(_clipped(self.rings[a], self.rings[b]), self.rings[c])
                if self._is_deep(_depth(common)):
                    self.rules.append(
                        ((of[a, b], of[b, c], of[a, c]), lambda x: not x[0] == x[1] == -x[2])
                    )
        self.rules_of: list[list[int]] = [[] for _ in self.pairs]
        for r, (places, _) in enumerate(self.rules):
            for i in set(places):
                self.rules_of[i].append(r)

    def _is_deep(self, depth: float) -> bool:
        if GRAZING * self.size < depth < DEEP * self.size:
            raise LayersUnclear
        return depth > GRAZING * self.size

    def _overlap(self, f: int, g: int) -> bool:
        return self._is_deep(_depth(_clipped(self.rings[f], self.rings[g])))

    def _within(self, ends: Sequence[Point], ring: Sequence[Point]) -> bool:
        """Return whether a piece of a segment is inside a polygon, not on its border."""
        a, b = ends
        low, high = 0.0, 1.0
        for p, q in zip(ring, [*ring[1:], ring[0]], strict=True):
            unit = (q - p) / abs(q - p)
            one, two = ((unit.conjugate() * (z - p)).imag for z in (a, b))
            if not (self._is_deep(max(one, 0.0)) or self._is_deep(max(two, 0.0))):
                return False
            if one < 0 < two:
                low = max(low, one / (one - two))
            elif two < 0 < one:
                high = min(high, one / (one - two))
        return self._is_deep(max((high - low) * abs(b - a), 0.0))

    def _along(self, one: Sequence[Point], two: Sequence[Point]) -> bool:
        """Return whether two segments have a piece in common."""
        a, b = one
        unit = (b - a) / abs(b - a)
        ends = [unit.conjugate() * (z - a) for z in two]
        off = max(abs(z.imag) for z in ends)
        low, high = sorted(z.real for z in ends)
        shared = min(high, abs(b - a)) - max(low, 0.0)
        return self._is_deep(max(shared, 0.0)) and not self._is_deep(off)

    def _side(self, ends: Sequence[Point], f: int) -> bool:
        a, b = ends
        middle = sum(self.rings[f]) / len(self.rings[f])
        return ((b - a).conjugate() * (middle - a)).imag > 0

    def can_be_stacked(self, signs: Sequence[int]) -> bool:
        """Return whether there is an order, given the sign of each crease.

        Raises
        ------
        LayersUnclear
            If too many would have to be tried.
        """
        value = [0] * len(self.pairs)
        tried = 0

        def put(i: int, x: int, done: list[int]) -> bool:
            """Say what pair i is, and all that follows where one pair of a rule is left."""
            front = [(i, x)]
            while front:
                j, y = front.pop()
                if value[j]:
                    if value[j] != y:
                        return False
                    continue
                value[j] = y
                done.append(j)
                for r in self.rules_of[j]:
                    places, holds = self.rules[r]
                    left = [p for p in dict.fromkeys(places) if not value[p]]
                    if len(left) > 1:
                        continue
                    fits = []
                    for z in (1, -1) if left else (0,):
                        if left:
                            value[left[0]] = z
                        if holds([value[p] for p in places]):
                            fits.append(z)
                    if left:
                        value[left[0]] = 0
                    if not fits:
                        return False
                    if left and len(fits) == 1:
                        front.append((left[0], fits[0]))
            return True

        def search() -> bool:
            nonlocal tried
            tried += 1
            if tried > SEARCHED:
                raise LayersUnclear
            free = next((i for i, x in enumerate(value) if not x), None)
            if free is None:
                return True
            for x in (1, -1):
                done: list[int] = []
                if put(free, x, done) and search():
                    return True
                for j in done:
                    value[j] = 0
            return False

        for first, (f, _, _), sign in zip(self.first, self.creases, signs, strict=True):
            if first is None:
                continue
            i, s = first
            # a valley lifts the other facet to the side of this one's normal
            if not put(i, s * sign * (-1 if self.over[f] else 1), []):
                return False
        return search()


def _anticlockwise(ring: list[Point]) -> list[Point]:
    area = sum((a.conjugate() * b).imag for a, b in zip(ring, [*ring[1:], ring[0]], strict=True))
    return ring if area > 0 else ring[::-1]


def _clipped(ring: list[Point], other: Sequence[Point]) -> list[Point]:
    """Return what of a convex polygon is in another."""
    for p, q in zip(other, [*other[1:], other[0]], strict=True):
        far = [((q - p).conjugate() * (z - p)).imag for z in ring]
        out = []
        for k, z in enumerate(ring):
            n = (k + 1) % len(ring)
            if far[k] >= 0:
                out.append(z)
            if far[k] * far[n] < 0:
                out.append(z + far[k] / (far[k] - far[n]) * (ring[n] - z))
        ring = out
        if not ring:
            break
    return ring


def _depth(ring: Sequence[Point]) -> float:
    """Return about how wide a convex polygon is: its area over its length."""
    if len(ring) < 3:
        return 0.0
    area = sum((a.conjugate() * b).imag for a, b in zip(ring, [*ring[1:], ring[0]], strict=True))
    return abs(area) / max(abs(a - b) for a, b in itertools.combinations(ring, 2))
