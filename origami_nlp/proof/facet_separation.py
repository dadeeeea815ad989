"""Which facets are apart, cross or touch at certified states: signs of every ray off every facet, by intervals.

Arcs i and j of the sphere, shorter than pi, have a common point exactly where none of the four numbers n_i.c_j,
-n_i.c_{j+1}, -n_j.c_i, n_j.c_{i+1} has the opposite sign of another; they cross where all have one sign strictly.
Where some are exactly zero, closed contacts are the reason:

- Crease e fully folded to the side a: ray e + 1 is in the plane of facet e - 1, and the planes of facets e - 1 and e +
  1 meet there only.  With sector e narrower than sector e - 1 the ray is inside facet e - 1, and facet e + 1 leaves it
  to the side a where a phi_{e+1} < 0, and crosses it where a phi_{e+1} > 0.  With sector e wider the two are apart.
  The same backwards.
- Ray k on facet j, inside its arc: facets k - 1 and k touch it from one side where rays k - 1 and k + 1 are on this
  side, and cross it where they are on different ones.  A flap that begins with a fully folded crease and goes on flat
  over the next one has ray k - 1 (or k + 1) in the plane as well, on the side to which that crease is folded.
- Rays of a D_1 wedge on each other, on the mirror: the facets touch where their planes differ.

Images of a wedge are apart as long as its rays are between the mirrors: fold limits and the gaps of the vertex
(`problem.model_reduction`) say so.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from origami_nlp.numerics import CONTACT_TOL, EPS
from origami_nlp.proof.pieces import piece_of
from origami_nlp.proof.reduced import ReducedVertex
from origami_nlp.proof.rows import Triples, variables
from origami_nlp.proof.touches import Row

APART, CROSSED, UNCLEAR = 1, -1, 0


@dataclass(frozen=True)
class Contacts:
    """What the facets do at one state.

    Attributes
    ----------
    verdict
        `APART`: all but the contacts that are held; `CROSSED`: some certainly cross; `UNCLEAR`.
    sides
        On which side each touch is open, +1 or -1 of its gap.
    """

    verdict: int
    sides: tuple[int, ...]


class Signs:
    """Signs of what separates facets, at R states known to a radius.

    Parameters
    ----------
    vertex
        With contact ``full``.
    x, radius, pins
        States [R, n], how well each is known [R], and the strata [R, n].
    """

    def __init__(
        self, vertex: ReducedVertex, x: np.ndarray, radius: np.ndarray, pins: np.ndarray
    ) -> None:
        self.vertex, self.pins = vertex, pins
        self.cyclic = vertex.kind == "C"
        # a root is known to its radius; pinned angles are +-pi exactly
        wide = np.where(pins == 0, radius[:, None], 0.0)
        low, high = np.nextafter(x - wide, -9.0), np.nextafter(x + wide, 9.0)
        piece = piece_of(vertex)
        self.chain = chain = piece.chain
        self.folded = chain.fold(*variables(low.T, high.T))
        n = chain.around
        facets = n if self.cyclic else n - 1
        # ray k off facet j, [R, k, j]
        self.off = np.zeros((len(x), n, facets), dtype=int)
        apart = [(k, j) for j in range(facets) for k in range(n) if k not in (j, (j + 1) % n)]
        signs = self._signs([chain.gap(*chain.shortest(k, j)) for k, j in apart])
        for (k, j), sign in zip(apart, signs, strict=True):
            self.off[:, k, j] = sign
        self.bent = _sign_of_sine(low, high, pins)
        self.open = np.abs(x) + wide < 0.5 * math.pi
        walls = [] if self.cyclic else list(vertex.walls)
        wanted = [chain.behind(*vertex.gaps[i].rays) for i in walls]  # type: ignore[misc]
        self.walls = dict(zip(walls, self._signs(wanted), strict=True))
        # of D_1 wedges whose touches are proved: the turn of the first three rays
        self.turn = self._signs([(0, 1, 2)])[0] if n > 2 else np.zeros(len(x), dtype=int)
        # ray k inside the arc of facet j, given that it is in its plane: few are asked for
        self.inside = cache(self._inside)

    def _signs(self, wanted: list[tuple[int, int, int]]) -> np.ndarray:
        """Return the signs of triple products, [T, R]."""
        return Triples(self.chain, wanted).at(self.folded).affine().signs()

    def _inside(self, k: int, j: int) -> np.ndarray:
        """Whether ray k is between rays j and j + 1, +1 or -1; 0 where it is unclear, [R]."""
        signs = self._signs(self.chain.inside(*self.chain.shortest(k, j)))
        return np.where((signs < 0).all(axis=0), 1, np.where((signs > 0).any(axis=0), -1, 0))

    def contacts(self, r: int, touches: tuple[Row, ...]) -> Contacts:
        """Describe what the facets do at state number r, where `touches` are held."""
        sides = tuple(self._side(r, t) for t in touches)
        verdicts = [self._pair(r, i, j, touches) for i, j in self.vertex.pairs]
        if not self.cyclic:
            held = {t.gap for t in touches}
            verdicts += [int(s[r]) for i, s in self.walls.items() if i not in held]
        if CROSSED in (*verdicts, *(CROSSED if s is None else APART for s in sides)):
            return Contacts(CROSSED, ())
        clear = all(v == APART for v in verdicts) and all(sides)
        return Contacts(APART if clear else UNCLEAR, tuple(int(s or 0) for s in sides))

    def _side(self, r: int, t: Row) -> int | None:
        """Open side of a touch; 0 where it is unclear, None where facets intersect."""
        if t.kind in ("start", "end"):
            return 1
        if t.kind == "meet":
            # gap (k, j) = -(angle of the rays) times a positive number, open where -turn is the angle's sign
            return int(self.turn[r]) if not self.pins[r].any() else 0
        k, j = t.rays
        n, pins = self.off.shape[1], self.pins[r]
        if self.inside(k, j)[r] <= 0:
            return 0
        # neighbours of the ray that touches: both on one side, the facets stay on it; on two, they pass through
        before, after = self.off[r, (k - 1) % n, j], self.off[r, (k + 1) % n, j]
        if self._flat_flap(r, j + 1, j + 2, k - 1):
            before = pins[(j + 1) % n] or pins[(j + 2) % n]
        if self._flat_flap(r, j, j - 1, k + 1):
            after = pins[j] or pins[(j - 1) % n]
        if not before or not after:
            return 0
        return int(before) if before == after else None

    def _flat_flap(self, r: int, near: int, far: int, ray: int) -> bool:
        """Whether `ray` is `far`, and of creases `near` and `far` one is fully folded and the other flat, or nearly."""
        n, pins = self.off.shape[1], self.pins[r]
        near, far = near % n, far % n
        at_limit, flat = (near, far) if pins[near] else (far, near)
        return (
            ray % n == far and bool(pins[at_limit]) and not pins[flat] and bool(self.open[r, flat])
        )

    def _pair(self, r: int, i: int, j: int, touches: tuple[Row, ...]) -> int:
        """What facets i and j do at state r."""
        n, off = self.off.shape[1], self.off[r]
        # the four numbers of the module docstring: both signs, no common point; one sign strictly, they cross
        v = [off[j, i], -off[(j + 1) % n, i], -off[i, j], off[(i + 1) % n, j]]
        if min(v) < 0 < max(v):
            return APART
        if min(v) > 0 or max(v) < 0:
            return CROSSED
        orders = ((i, j), (j, i))
        for a, b in orders:
            if any(t.kind == "facet" and t.rays in ((b, a), ((b + 1) % n, a)) for t in touches):
                return APART  # `_side` says how
        for a, b in orders:
            if self.cyclic and (stacked := self._stacked(r, a, b)) is not None:
                return stacked
        for a, b in orders:
            # crease e fully folded between facet a = e - 1 and the one before b = e + 1
            e = (a + 1) % n
            if (a + 2) % n == b and (a + 2 < n or self.cyclic):
                found = self._beyond(r, e, (e + 1) % n, e, (e - 1) % n)
                found = self._beyond(r, b, e, e, b) if found is None else found
                if found is not None:
                    held = any(t.rays in (((a + 3) % n, a), ((b - 2) % n, b)) for t in touches)
                    return APART if held and found == UNCLEAR else found
        if not self.cyclic:
            return self._on_mirror(r, touches)
        return UNCLEAR

    def _stacked(self, r: int, a: int, b: int) -> int | None:
        """What facets a and b do where e, e + 1 are fully folded and they are A = e - 1, C = e + 1, or next to these.

        On the line of facet B = e, from crease e on: A is [0, A], C is [B - C, B].  Fully folded to different sides the
        three are a zigzag: A, B and C lie in this order, and stay so as soon as both creases open.  Fully folded to one
        side they are rolled up: the facet beyond A or the one beyond C is caught between layers, unless A and C do not
        reach each other.
        """
        n, pins = self.off.shape[1], self.pins[r]
        for e in range(n):
            low, one, two, high = (e - 1) % n, e, (e + 1) % n, (e + 2) % n
            if not (pins[one] and pins[two]):
                continue
            width = self.vertex.sectors
            room = float(width[one] - width[low] - width[two])
            out = [self.bent[r, low], self.bent[r, high]]
            if (a, b) == (low, two):
                if pins[one] != pins[two]:
                    return APART
                if abs(room) <= CONTACT_TOL or not all(out):
                    return UNCLEAR
                return APART if room > 0 else CROSSED
            # the facet beyond A and C, beyond C and A: only at the tip, where this is on the other
            for pair, crease, tip, narrow, wide, rest in (
                (((e - 2) % n, two), one, low, low, one, two),
                ((low, high), two, high, two, one, low),
            ):
                if (a, b) != pair:
                    continue
                reach = float(width[one] - width[narrow])  # from the tip to the other crease
                if (
                    not self.bent[r, tip]
                    or min(abs(reach), abs(reach - width[rest])) <= CONTACT_TOL
                ):
                    return UNCLEAR
                return (
                    self._beyond(r, crease, tip, narrow, wide) if 0 < reach < width[rest] else APART
                )
        return None

    def _beyond(self, r: int, e: int, tip: int, narrow: int, wide: int) -> int | None:
        """What the facet beyond `tip` and facet `wide` do, crease e fully folded; None where that is no reason."""
        pins = self._crease(self.pins[r], e)
        if not pins:
            return None
        sectors = self.vertex.sectors
        bent = self._crease(self.bent[r], tip)
        gap = sectors[narrow] - sectors[wide]
        if not bent or abs(gap) <= CONTACT_TOL:
            return UNCLEAR
        return APART if gap > 0 or pins * bent < 0 else CROSSED

    def _crease(self, values: np.ndarray, ray: int) -> int:
        """The entry of the variable at a ray; 0 where it is no crease."""
        has = self.vertex.has_crease
        return int(values[sum(has[:ray])]) if has[ray] else 0

    def _on_mirror(self, r: int, touches: tuple[Row, ...]) -> int:
        """Facets 0 and 2 of a D_1 wedge where one lies on the mirror, or their mirror rays on each other."""
        if touches:
            return APART if self.turn[r] and not self.pins[r].any() else UNCLEAR
        first, last = self._crease(self.pins[r], 0), self._crease(self.pins[r], 3)
        if first and not last and self.inside(3, 0)[r]:
            return APART if self.inside(3, 0)[r] < 0 else CROSSED
        if last and not first and self.inside(0, 2)[r]:
            return APART if self.inside(0, 2)[r] < 0 else CROSSED
        return UNCLEAR


def _sign_of_sine(low: np.ndarray, high: np.ndarray, pins: np.ndarray) -> np.ndarray:
    """Sign of the sine of angles within (-pi, pi), [R, n]; 0 where unclear."""
    clear = (np.maximum(np.abs(low), np.abs(high)) < math.pi - 4 * EPS) & (pins == 0)
    return np.where(clear & (low > 0), 1, np.where(clear & (high < 0), -1, 0))
