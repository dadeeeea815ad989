"""Where the facets of a pattern are in space: rigid motions from the reference state, along a tree of creases."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
import scipy as sp

from origami_nlp.numerics import address, rotations
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem.compiled_facets import GapsInC, library

MOVES = 1e-3
"""A crease folded by more moves [rad]."""


class Poses:
    """The facets of a pattern, moved by its fold angles; one facet, in the middle, stays where it is.

    Parameters
    ----------
    pattern
        The pattern; of a cell that repeats its neighbours are placed as well.
    orbits
        Of states that keep a symmetry: what is a fold angle here is then a variable.

    Attributes
    ----------
    pattern
        What is placed: the pattern, or the cell amid its neighbours, whose creases are copies of the cell's.
    root
        The facet that stays.
    """

    def __init__(self, pattern: Pattern, orbits: Any = None) -> None:
        self.cell, self.orbits = pattern.cell, orbits
        pattern = self.pattern = pattern.spread
        n, f = pattern.creases, pattern.facets
        both = np.r_[pattern.left, pattern.right], np.r_[pattern.right, pattern.left]
        # scipy before 1.13 walks graphs of such indices only
        ends = tuple(x.astype(np.int32) for x in both)
        self._graph = sp.sparse.csr_array((np.ones(2 * n), ends), shape=(f, f))
        own = len(self.centres) // (
            len(self.cell.copies) if self.cell else 1
        )  # the cell itself comes first
        middle = self.centres[:own].mean(axis=0)
        self.root = int(np.linalg.norm(self.centres - middle, axis=1).argmin())
        # shortest walks from the middle: errors grow with the number of turns
        order, before = sp.sparse.csgraph.breadth_first_order(
            self._graph, self.root, directed=False
        )
        across: dict[tuple[int, int], tuple[int, float]] = {}
        for c, (a, b) in enumerate(zip(pattern.left.tolist(), pattern.right.tolist(), strict=True)):
            across.setdefault((a, b), (c, -1.0))  # from left to right
            across.setdefault((b, a), (c, 1.0))
        depth = np.zeros(f, int)
        for facet in order[1:]:
            depth[facet] = depth[before[facet]] + 1
        self._levels: list[tuple[np.ndarray, np.ndarray, slice]] = []
        across_all: list[tuple[int, float]] = []
        self._paths: dict[tuple[int, int], tuple[tuple[int, float], ...]] = {}
        for level in range(1, int(depth.max(initial=0)) + 1):
            here = order[depth[order] == level]
            steps = [across[int(before[k]), int(k)] for k in here]
            first = len(across_all)
            across_all += steps
            self._levels.append((here, before[here], slice(first, len(across_all))))
        self._crossed = np.array([c for c, _ in across_all], int)
        self._senses = np.array([s for _, s in across_all])
        self._senses_between: dict[tuple[int, int], np.ndarray] = {}
        self._last: tuple[bytes, tuple[np.ndarray, np.ndarray]] | None = None

    def moved(self, pattern: Pattern) -> Poses:
        """Return poses of a pattern of the same facets, measured in another reference state; of one without a cell."""
        other = copy.copy(self)
        for name in ("centres", "walks", "_gaps"):
            vars(other).pop(name, None)
        other.pattern, other._last = pattern, None
        return other

    @cached_property
    def centres(self) -> np.ndarray:
        """Means of the corners of each facet in the reference state, [F, 3]."""
        p = self.pattern
        many = np.array([len(polygon) for polygon in p.polygons], int)
        facet, total = np.repeat(p.facet_of, many), np.zeros((p.facets, 3))
        np.add.at(total, facet, p.corners[np.concatenate([*p.polygons]).astype(int)])
        return total / np.bincount(facet, minlength=p.facets)[:, None]

    def copied(self, x: np.ndarray) -> np.ndarray:
        """Return the fold angles of all that is placed, of variables [..., n]."""
        if self.orbits is not None:
            return self.orbits.expand(x)
        return x[..., self.cell.crease_of] if self.cell else x

    def own(self, creases: Sequence[int]) -> np.ndarray:
        """Return which variables some of the creases that are placed follow, [k]."""
        placed = np.array(creases, int)
        if self.orbits is not None:
            return np.asarray(self.orbits.orbit[placed])
        return self.cell.crease_of[placed] if self.cell else placed

    def signs(self, creases: Sequence[int]) -> np.ndarray:
        """Return with which sign some of the creases that are placed follow them, [k]."""
        return np.ones(len(creases)) if self.orbits is None else self.orbits.sign[list(creases)]

    def gathered(self, rows: np.ndarray) -> np.ndarray:
        """Return derivatives by the variables, of those by the fold angles of all that is placed, [..., n]."""
        if self.orbits is not None:
            return self.orbits.gather(rows)
        if self.cell is None:
            return rows
        out = np.zeros((len(self.cell.letters), *rows.shape[:-1]))
        np.add.at(out, self.cell.crease_of, np.moveaxis(rows, -1, 0))
        return np.moveaxis(out, 0, -1)

    def motions(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return rotations [F, 3, 3] and translations [F, 3] of the facets from the reference state, read only."""
        key = phi.tobytes()
        if self._last is None or self._last[0] != key:
            # all that judges a state asks for them in turn
            self._last = key, self._moved(phi)
        return self._last[1]

    def _moved(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        p, crossed = self.pattern, self._crossed
        turn, shift = np.zeros((p.facets, 3, 3)), np.zeros((p.facets, 3))
        turn[self.root] = np.eye(3)
        if self._placed_in_c(phi, turn, shift):
            return turn, shift
        r = rotations(
            self._senses[:, None] * p.directions[crossed], (self.copied(phi) - p.reference)[crossed]
        )
        o = p.corners[p.ends[crossed, 0]]
        # x -> R_parent (o + r (x - o)) + t_parent
        inner = o - np.einsum("kij,kj->ki", r, o)
        for here, parent, level in self._levels:
            turn[here] = turn[parent] @ r[level]
            shift[here] = np.einsum("kij,kj->ki", turn[parent], inner[level]) + shift[parent]
        turn.flags.writeable = shift.flags.writeable = False
        return turn, shift

    def __getstate__(self) -> dict[str, Any]:
        return {k: v for k, v in vars(self).items() if k not in ("compiled", "_gaps")}

    @cached_property
    def compiled(self) -> Any:
        """Compiled functions; None where nothing can be compiled."""
        return library()

    @cached_property
    def _gaps(self) -> GapsInC:
        p = self.pattern
        return GapsInC((p.left, p.directions, p.corners[p.ends[:, 0]]))

    def gaps_in_c(
        self, pairs: Sequence[Any], turn: np.ndarray, shift: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Return gaps [K] and rows of pairs of features (`ContactPair`); None where sides run along each other."""
        gaps, corners, which = self._gaps, self.pattern.corners, []
        for one in pairs:
            if (k := gaps.numbers.get(one)) is None:
                k = gaps.add(one, one.reference(corners), self.senses(*one.facets))
            which.append(k)
        return gaps(which, turn, shift)

    def _placed_in_c(self, phi: np.ndarray, turn: np.ndarray, shift: np.ndarray) -> bool:
        """Place all facets but the root by a compiled function; whether there is one."""
        if self.compiled is None:
            return False
        angles = np.ascontiguousarray(self.copied(phi) - self.pattern.reference, np.float64)
        at = map(address, (*self.walks, angles, turn, shift))
        self.compiled.place(len(self._crossed), *at)
        turn.flags.writeable = shift.flags.writeable = False
        return True

    @cached_property
    def walks(self) -> tuple[np.ndarray, ...]:
        """Of each step of the walks: facet reached, the one before, crease; the directed axis and a point of it."""
        p, crossed = self.pattern, self._crossed
        none = [np.zeros(0, int)]
        here = np.concatenate([*(here for here, _, _ in self._levels), *none]).astype(np.int64)
        before = np.concatenate([*(parent for _, parent, _ in self._levels), *none])
        axes = np.ascontiguousarray(self._senses[:, None] * p.directions[crossed])
        points = np.ascontiguousarray(p.corners[p.ends[crossed, 0]])
        return here, before.astype(np.int64), crossed.astype(np.int64), axes, points

    def polygons(self, phi: np.ndarray) -> list[np.ndarray]:
        """Return the corners of every piece of paper in space, [P] arrays [q, 3]."""
        turn, shift = self.motions(phi)
        p = self.pattern
        return [
            p.corners[list(polygon)] @ turn[f].T + shift[f]
            for polygon, f in zip(p.polygons, p.facet_of, strict=True)
        ]

    def corners(self, phi: np.ndarray) -> np.ndarray:
        """Return the corners in space, each as a part of the first piece that has it, [V, 3]."""
        turn, shift = self.motions(phi)
        out = np.full_like(self.pattern.corners, np.nan)
        for polygon, f in zip(self.pattern.polygons, self.pattern.facet_of, strict=True):
            new = [v for v in polygon if np.isnan(out[v, 0])]
            out[new] = self.pattern.corners[new] @ turn[f].T + shift[f]
        return out

    def apart(self, phi: np.ndarray) -> float:
        """Return how far copies of a corner on neighbouring facets are apart: 0 but for rounding where loops close."""
        turn, shift = self.motions(phi)
        p = self.pattern
        ends = p.corners[p.ends]  # [n, 2, 3]
        left = np.einsum("kij,kej->kei", turn[p.left], ends) + shift[p.left][:, None]
        right = np.einsum("kij,kej->kei", turn[p.right], ends) + shift[p.right][:, None]
        return float(np.abs(left - right).max(initial=0.0))

    def senses(self, a: int, b: int) -> np.ndarray:
        """Return how a shortest walk from facet a to facet b crosses each crease: +1, -1, or 0 for not at all, [n]."""
        if (a, b) not in self._senses_between:
            row = np.zeros(self.pattern.creases)
            for crease, sense in self.path(a, b):
                row[crease] = sense
            self._senses_between[a, b] = row
        return self._senses_between[a, b]

    def path(self, a: int, b: int) -> tuple[tuple[int, float], ...]:
        """Return the creases of a shortest walk from facet a to facet b, with the sense in which each is crossed."""
        if (a, b) in self._paths:
            return self._paths[a, b]
        _, before = sp.sparse.csgraph.shortest_path(
            self._graph, indices=a, unweighted=True, return_predecessors=True
        )
        p, walk, here = self.pattern, [], b
        while here != a:
            there = int(before[here])
            c = int(
                np.flatnonzero(
                    ((p.left == here) & (p.right == there))
                    | ((p.left == there) & (p.right == here))
                )[0]
            )
            walk.append((c, 1.0 if p.left[c] == here else -1.0))
            here = there
        self._paths[a, b] = tuple(walk[::-1])
        return self._paths[a, b]
