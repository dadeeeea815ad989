"""Orders of the layers of a flat-folded sheet: propagation of constraints between pairs of facets, and search.

Facets joined by creases that stay open are one.  For every two that overlap one is above.  That of a folded crease is
given by its sign; the others must be transitive where three overlap; no facet passes between the two of a crease that
lies across it; and of two creases that lie on each other, with facets on the same side, the facets of one do not
interleave with those of the other.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np

from origami_nlp.sheets.sheet import Sheet

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

MOST_PAIRS = 2_000
"""Overlapping pairs of facets that are ordered."""
MOST_NODES = 5_000
"""Guesses of a search."""
THIN = 1e-6
"""Overlaps narrower than this share of the sheet's size are none."""

Pair = tuple[int, int]
Rule = tuple[tuple[Pair, ...], frozenset[tuple[bool, ...]]]


class Stack:
    """The facets of a sheet whose creases are open (0) or folded flat (+-pi), as an ordering problem.

    Parameters
    ----------
    sheet
        The programme.
    phi
        Fold angles, each 0 or +-pi, [n]; the reference state is flat.
    """

    def __init__(self, sheet: Sheet, phi: np.ndarray) -> None:
        from shapely import unary_union
        from shapely.geometry import LineString, Polygon
        from shapely.strtree import STRtree

        pattern, crossings = sheet.pattern, sheet.crossings
        self.size = crossings.size
        turn, shift = crossings.poses.motions(phi)
        root = crossings.poses.root
        normal = _normal(sheet)
        u = pattern.directions[0]
        frame = np.array([u, np.cross(normal, u)])
        group = _groups(pattern.facets, pattern.left, pattern.right, phi == 0.0)
        up = np.einsum("fij,j,i->f", turn, normal, turn[root] @ normal) > 0
        pieces: dict[int, list[BaseGeometry]] = {}
        for x, f in zip(crossings.placed(phi) @ frame.T, crossings.facet, strict=True):
            pieces.setdefault(int(group[f]), []).append(Polygon(x).buffer(0))
        self.paper = [unary_union(pieces[g]) for g in range(len(pieces))]
        self.known: dict[Pair, bool] = {}
        self.contradiction = False
        self.creases = []
        for c in np.flatnonzero(phi != 0.0):
            f = int(pattern.left[c])
            i, j = int(group[f]), int(group[pattern.right[c]])
            ends = pattern.corners[pattern.ends[c]] @ turn[f].T + shift[f]
            self.creases.append((i, j, LineString(ends @ frame.T)))
            # a valley brings the other facet to the side that is up in the pattern
            below = bool(up[f]) == (phi[c] > 0)
            pair, above = (i, j) if i < j else (j, i), not below
            value = above if i < j else not above
            if self.known.setdefault(pair, value) != value:
                self.known[pair] = value
                self.contradiction = True
        self.tree = STRtree(self.paper)
        self.pairs = sorted(
            (int(i), int(j))
            for i, j in zip(*self.tree.query(self.paper), strict=True)
            if i < j and self._overlap(self.paper[i], self.paper[j])
        )

    def _overlap(self, *bodies: BaseGeometry) -> bool:
        """Tell whether areas have an area in common."""
        common = bodies[0]
        for body in bodies[1:]:
            common = common.intersection(body)
        return bool(common.area > (THIN * self.size) ** 2 * 1e3)

    def rules(self) -> list[Rule]:
        """List what orders must obey."""
        pairs = set(self.pairs)
        rules: list[Rule] = []
        beside: dict[int, set[int]] = {}
        for i, j in self.pairs:
            beside.setdefault(i, set()).add(j)
        for i, j in self.pairs:
            for k in beside.get(j, set()) & beside[i]:
                if self._overlap(self.paper[i], self.paper[j], self.paper[k]):
                    rules.append((((i, j), (j, k), (i, k)), TRANSITIVE))
        for i, j, line in self.creases:
            for k in map(int, self.tree.query(line)):
                if k in (i, j):
                    continue
                inside = line.intersection(self.paper[k].buffer(-THIN * self.size))
                if inside.length > THIN * self.size:
                    rules.append(_rule(((i, k), (j, k)), lambda a, b: a == b))
        for (i, j, one), (k, m, other) in itertools.combinations(self.creases, 2):
            if len({i, j, k, m}) < 4 or not {_pair(i, k), _pair(j, m)} <= pairs:
                continue
            common = one.intersection(other.buffer(THIN * self.size))
            if common.length <= 10 * THIN * self.size or not self._same_side(common, i, k):
                continue
            rules.append(_rule(((i, k), (i, m), (j, k), (j, m)), _nested))
        return rules

    def _same_side(self, line: BaseGeometry, i: int, k: int) -> bool:
        """Tell whether facets lie on the same side of a common piece of their borders."""
        thin = line.buffer(100 * THIN * self.size, cap_style="flat")
        both = self.paper[i].intersection(self.paper[k]).intersection(thin)
        return bool(both.area > 0.25 * thin.area)

    def order(self) -> dict[Pair, bool] | None:
        """Return which of each pair is above: True if the first; None if there is no order.

        Raises
        ------
        TimeoutError
            If the search is given up.
        """
        if self.contradiction:
            return None
        rules = self.rules()
        of: dict[Pair, list[Rule]] = {}
        for rule in rules:
            for pair in rule[0]:
                of.setdefault(pair, []).append(rule)
        first = _propagate(dict(self.known), rules, of)
        nodes, stack = 0, [] if first is None else [first]
        while stack:
            values = stack.pop()
            left = [p for p in self.pairs if p not in values]
            if not left:
                return values
            nodes += 1
            if nodes > MOST_NODES:
                raise TimeoutError
            pair = max(left, key=lambda p: len(of.get(p, ())))
            for guess in (True, False):
                more = _propagate({**values, pair: guess}, of.get(pair, []), of)
                if more is not None:
                    stack.append(more)
        return None


TRANSITIVE = frozenset(
    v
    for v in itertools.product((False, True), repeat=3)
    if v not in {(True, True, False), (False, False, True)}
)


def _pair(i: int, j: int) -> Pair:
    return (i, j) if i < j else (j, i)


def _nested(ik: bool, im: bool, jk: bool, jm: bool) -> bool:
    """Tell whether i and j are both between k and m or both not, and the other way round."""
    i_between, j_between = ik != im, jk != jm
    k_between, m_between = ik != jk, im != jm
    return i_between == j_between and k_between == m_between


def _rule(pairs, allowed) -> Rule:  # type: ignore[no-untyped-def]
    """Write a rule on ordered pairs as one on pairs (smaller, larger)."""
    flip = [i > j for i, j in pairs]
    values = itertools.product((False, True), repeat=len(pairs))
    good = frozenset(v for v in values if allowed(*(a != f for a, f in zip(v, flip, strict=True))))
    return tuple(_pair(i, j) for i, j in pairs), good


def _propagate(
    values: dict[Pair, bool], queue: list[Rule], of: dict[Pair, list[Rule]]
) -> dict[Pair, bool] | None:
    """Fill in what rules force; None if they contradict each other."""
    queue = list(queue)
    while queue:
        pairs, allowed = queue.pop()
        known = [values.get(p) for p in pairs]
        left = [
            v for v in allowed if all(k is None or k == a for k, a in zip(known, v, strict=True))
        ]
        if not left:
            return None
        for n, pair in enumerate(pairs):
            if known[n] is None and len({v[n] for v in left}) == 1:
                values[pair] = left[0][n]
                queue += of.get(pair, [])
    return values


def _groups(count: int, left: np.ndarray, right: np.ndarray, joined: np.ndarray) -> np.ndarray:
    """Number the facets that open creases join, [F]."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ones = np.ones(int(joined.sum()))
    graph = coo_array((ones, (left[joined], right[joined])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def _normal(sheet: Sheet) -> np.ndarray:
    """Return the normal of the flat reference state, on the side where valleys open."""
    p = sheet.pattern
    x = p.corners[list(p.polygons[0])]
    normal = np.cross(x - x[0], np.roll(x, -1, axis=0) - x[0]).sum(axis=0)
    return np.asarray(normal / np.linalg.norm(normal))


def is_flat_folded(sheet: Sheet, phi: np.ndarray) -> bool:
    """Tell whether every crease is open or folded flat, from a flat reference state."""
    return sheet.pattern.is_flat and bool(np.isin(np.abs(phi), (0.0, math.pi)).all())
