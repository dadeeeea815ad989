"""Where facets cross along a curve, and that they do not touch unseen between two states at which it was asked.

Over a step the facets of a pair move relative to each other by at most the turns of the creases between them times
their distance from these creases, which no fold makes longer than the way over the paper.  Where the gaps at both ends
of a step add up to more than that, the pair does not touch inside; otherwise the step is halved.  A gap is bounded
from below by planes between the facets.  Facets round one vertex touch in a point always: for them gaps are angles.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy as sp

from origami_nlp.io import ShortRepr
from origami_nlp.numerics import CLOSURE_TOL, CURVED, DEEP, NONZERO, cross
from origami_nlp.pattern_problem import PatternProblem, cross_each_other
from origami_nlp.pattern_states.interpolant import Interpolant, halves

MOST_HALVINGS = 3
"""Of a step in which a pair might touch."""
FAR = 1e200
"""Longer than any distance, and finite, so that no fold moves over it makes 0."""
MOST_PIECES = 64
"""Convex pieces of facets up to which gaps are asked for; beyond, only crossings at the states of a curve."""


@dataclass(frozen=True, eq=False, repr=False)
class Stretches(ShortRepr):
    """Closed states along a curve, and whether facets cross there.

    Attributes
    ----------
    states
        In the order of the curve, [S, n] [rad].
    crosses
        Of bool, [S].
    unclear
        Parts of steps between states without crossings, the first and the last step aside, in which facets might cross
        unseen: they touch at both ends, or were not shown to be apart.
    """

    states: np.ndarray
    crosses: np.ndarray
    unclear: int


class Clearance:
    """Gaps of the facets of a sheet, and how far creases can move them.

    Parameters
    ----------
    problem
        The problem.
    """

    def __init__(self, problem: PatternProblem) -> None:
        self.problem = problem
        c = problem.crossings
        first, second = np.triu_indices(len(c.pieces), 1)
        low, high = (
            np.minimum(c.facet[first], c.facet[second]),
            np.maximum(c.facet[first], c.facet[second]),
        )
        # not pieces of one facet, nor convex facets that a crease joins: their planes meet in its line alone
        keep = (low != high) & ~np.isin(low * problem.pattern.facets + high, c.joined)
        self.first, self.second = first[keep], second[keep]

    @cached_property
    def _apex(self) -> np.ndarray:
        """Corner that the pieces of each pair share, -1 for none, -2 for several, [K]."""
        pieces = self.problem.crossings.pieces
        out = np.full(len(self.first), -1)
        for k, (i, j) in enumerate(zip(self.first, self.second, strict=True)):
            self.problem.check_time()
            common = np.intersect1d(pieces[i], pieces[j])
            if len(common):
                out[k] = common[0] if len(common) == 1 else -2
        return out

    @cached_property
    def _radii(self) -> np.ndarray:
        """Sum of the radii of the pieces of each pair about their middles, [K]: facets are rigid."""
        flat = self.problem.crossings.placed(np.zeros(self.problem.pattern.creases))
        radius = np.linalg.norm(flat - flat.mean(axis=1, keepdims=True), axis=2).max(axis=1)
        out: np.ndarray = radius[self.first] + radius[self.second]
        return out

    @cached_property
    def _arms(self) -> np.ndarray:
        """Distance that a turn of each crease moves the pieces of each pair apart, at most, [K, n]; 1 for angles."""
        p, c = self.problem.pattern, self.problem.crossings
        ways, before = self._ways(), self._before()
        crease_between = {}
        for k, (i, j) in enumerate(zip(p.left.tolist(), p.right.tolist(), strict=True)):
            crease_between[i, j] = crease_between[j, i] = k
        out = np.zeros((len(self.first), p.creases))
        for k, (i, j) in enumerate(zip(self.first, self.second, strict=True)):
            self.problem.check_time()
            if self._apex[k] == -2:
                out[k] = FAR  # never shown to be apart where anything moves
                continue
            path, here, there = [], int(c.facet[j]), int(c.facet[i])
            while here != there:
                path.append(crease_between[here, int(before[there, here])])
                here = int(before[there, here])
            if self._apex[k] >= 0 and all(self._apex[k] in p.ends[crease] for crease in path):
                out[k, path] = 1.0
                continue
            moved = [ways[path][:, c.pieces[x]].max(axis=1) for x in (i, j)]
            out[k, path] = min(moved, key=lambda m: float(m.sum()))
        return out

    def _before(self) -> np.ndarray:
        """Facet before each on a shortest walk from each, [F, F]."""
        p = self.problem.pattern
        graph = np.zeros((p.facets, p.facets))
        graph[p.left, p.right] = graph[p.right, p.left] = 1.0
        _, before = sp.sparse.csgraph.shortest_path(
            graph, unweighted=True, return_predecessors=True
        )
        found: np.ndarray = before
        return found

    def _ways(self) -> np.ndarray:
        """Length of a way over the paper from each crease to each corner, [n, V]: no folded state is longer."""
        p = self.problem.pattern
        n, many, size = p.creases, len(p.corners), self.problem.crossings.size
        points = np.vstack([p.corners, p.corners[p.ends].mean(axis=1)])
        length = np.full((many + n, many + n), np.inf)
        for facet in range(p.facets):
            on = {v for k in np.flatnonzero(p.facet_of == facet) for v in p.polygons[k]}
            on |= {many + int(k) for k in np.flatnonzero((p.left == facet) | (p.right == facet))}
            here = sorted(on)
            # over the size: SciPy takes lengths below 1e-8 for none
            apart = np.linalg.norm(points[here][:, None] - points[here], axis=2) / size
            length[np.ix_(here, here)] = np.minimum(length[np.ix_(here, here)], apart)
        ways = sp.sparse.csgraph.shortest_path(np.where(np.isinf(length), 0.0, length))[
            many:, :many
        ]
        return np.minimum(size * ways, FAR)

    def crosses(self, placed: np.ndarray) -> bool:
        """Return whether facets cross, from corners of pieces in space [P, q, 3]."""
        a, b = placed[self.first], placed[self.second]
        near = (a.min(axis=1) <= b.max(axis=1)).all(axis=1) & (b.min(axis=1) <= a.max(axis=1)).all(
            axis=1
        )
        deep = DEEP * self.problem.crossings.size
        return bool(near.any() and cross_each_other(a[near], b[near], deep).any())

    def gaps(self, placed: np.ndarray, need: np.ndarray, pairs: np.ndarray) -> np.ndarray:
        """Return lower bounds of the gaps of pairs, as far as they matter, [k].

        Parameters
        ----------
        placed
            Corners of pieces in space, [P, q, 3].
        need
            Gaps from which on a pair does not matter, [k].
        pairs
            Which of all, k of them.
        """
        middle, apex = placed.mean(axis=1), self._apex[pairs]
        first, second = self.first[pairs], self.second[pairs]
        # balls about the facets bound their gap: few pairs are asked for more
        out = np.linalg.norm(middle[second] - middle[first], axis=1) - self._radii[pairs]
        out = np.maximum(out, 0.0)
        out[apex != -1] = 0.0
        for axes in (lambda a, b: (b - a).mean(axis=1)[:, None], _axes):
            close = np.flatnonzero((out <= need) & (apex == -1))
            if not len(close):
                break
            a, b = placed[first[close]], placed[second[close]]
            out[close] = np.maximum(out[close], _apart(a, b, axes(a, b)))
        corner = np.flatnonzero(apex >= 0)
        if len(corner):
            at = self._rays[pairs[corner]]
            # [k, 2, 3, 3]: apex and two neighbours of either piece
            tips = placed[at[..., 0], at[..., 1]]
            rays = tips[:, :, 1:] - tips[:, :, :1]
            rays /= np.linalg.norm(rays, axis=3, keepdims=True)
            out[corner] = _angles(rays[:, 0], rays[:, 1])
        return out

    @cached_property
    def _rays(self) -> np.ndarray:
        """Where the apex of each pair and its neighbours are: piece and corner, [K, 2, 3, 2]; 0 where there is none."""
        pieces = self.problem.crossings.pieces
        at = np.zeros((len(self.first), 2, 3, 2), int)
        for k in np.flatnonzero(self._apex >= 0):
            both = []
            for i in (self.first[k], self.second[k]):
                ring = pieces[i].tolist()
                many = len(set(ring))  # padded by the first corner
                m = ring.index(int(self._apex[k]))
                both.append([(i, m), (i, (m - 1) % many), (i, (m + 1) % many)])
            at[k] = both
        return at

    def along(self, curve: Interpolant) -> Stretches:
        """Ask along a curve where facets cross, with further states where two might touch between those it has.

        Parameters
        ----------
        curve
            Of `interpolate`.

        Returns
        -------
        Stretches
            What was seen.
        """
        c = self.problem.crossings
        states, placed = list(curve.states), [c.placed(x) for x in curve.states]
        crosses = [self.crosses(x) for x in placed]
        if len(c.pieces) > MOST_PIECES or not len(self.first):
            return Stretches(
                np.array(states), np.array(crosses), len(states) - 1 if len(self.first) else 0
            )
        out, flags, unclear = [states[0]], [crosses[0]], 0
        for i, control in enumerate(curve.control):
            self.problem.check_time()
            ends = (placed[i], crosses[i]), (placed[i + 1], crosses[i + 1])
            # folded flat at an end, facets lie on each other
            at_end = i in (0, len(curve.control) - 1)
            every = np.arange(len(self.first))
            for inside in () if at_end else self._within(control, *ends, every):
                if inside is None:
                    unclear += 1
                else:
                    out.append(inside[0])
                    flags.append(inside[1])
            out.append(states[i + 1])
            flags.append(crosses[i + 1])
        return Stretches(np.array(out), np.array(flags), unclear)

    def _within(
        self,
        control: np.ndarray,
        a: tuple[np.ndarray, bool],
        b: tuple[np.ndarray, bool],
        pairs: np.ndarray,
        depth: int = 0,
    ) -> Iterator[tuple[np.ndarray, bool] | None]:
        """Go through states to be added inside a step, and whether facets cross; None for a part left unclear.

        Only `pairs` might touch in it: a half of a step asks no more for those that the whole showed to be apart.
        """
        if a[1] or b[1]:
            return
        # a polynomial turns no crease by more, in sum, than its control points do
        reach = self._arms[pairs] @ np.abs(np.diff(control, axis=0)).sum(axis=0)
        # to touch inside, a pair would close the gap of one end and open that of the other
        room = self.gaps(a[0], reach, pairs)
        close = np.flatnonzero(room < reach)
        room = room[close] + self.gaps(b[0], reach[close], pairs[close])
        close = close[still := room < reach[close]]
        if not len(close):
            return
        if (room[still] < DEEP * self.problem.crossings.size).all():  # they lie on each other
            yield None
            return
        before, after = halves(control)
        phi, residual = self.problem.project(before[-1])
        if depth == MOST_HALVINGS or residual > CLOSURE_TOL:
            yield None
            return
        x = self.problem.crossings.placed(phi)
        middle = x, self.crosses(x)
        yield from self._within(before, a, middle, pairs[close], depth + 1)
        yield phi, middle[1]
        yield from self._within(after, middle, b, pairs[close], depth + 1)


def _axes(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Directions across which convex polygons [K, q, 3] may be apart: of sides, planes, and both, [K, A, 3]."""
    sides = [np.roll(x, -1, axis=1) - x for x in (a, b)]
    normals = [
        cross(x - x[:, :1], s).sum(axis=1)[:, None] for x, s in zip((a, b), sides, strict=True)
    ]
    across = cross(sides[0][:, :, None], sides[1][:, None]).reshape(len(a), -1, 3)
    inside = [cross(s, n) for s, n in zip(sides, normals, strict=True)]
    corners = (b[:, None] - a[:, :, None]).reshape(len(a), -1, 3)
    return np.concatenate([*normals, across, *inside, corners], axis=1)


def _apart(a: np.ndarray, b: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Largest gap of the shadows of polygons [K, q, 3] along axes [K, A, 3]: no more than their distance, [K]."""
    size = np.linalg.norm(axes, axis=2)
    unit = axes / np.maximum(size, NONZERO)[..., None]
    # the gap of the shadows along any direction bounds the distance from below: the largest is taken
    of_a, of_b = np.einsum("kai,kqi->kaq", unit, a), np.einsum("kai,kqi->kaq", unit, b)
    gap = np.maximum(of_b.min(axis=2) - of_a.max(axis=2), of_a.min(axis=2) - of_b.max(axis=2))
    gap[size < CURVED * size.max(axis=1, keepdims=True)] = 0.0
    return np.maximum(gap.max(axis=1), 0.0)


def _angles(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Lower bounds of the angles between sectors with a common apex, from unit rays [K, 2, 3] each: [K]."""
    between = (b[:, None] - a[:, :, None]).reshape(len(a), -1, 3)
    planes = np.stack([cross(a[:, 0], a[:, 1]), cross(b[:, 0], b[:, 1])], axis=1)
    planes /= np.linalg.norm(planes, axis=2, keepdims=True)
    feet = [
        x - np.einsum("kri,ki->kr", x, p)[..., None] * p[:, None]
        for x, p in ((b, planes[:, 0]), (a, planes[:, 1]))
    ]
    feet = [x / np.maximum(np.linalg.norm(x, axis=2, keepdims=True), NONZERO) for x in feet]
    middle = (b.sum(axis=1) - a.sum(axis=1))[:, None]
    n = np.concatenate([between, planes, -planes, b - feet[0], feet[1] - a, middle], axis=1)
    n = n / np.maximum(np.linalg.norm(n, axis=2, keepdims=True), NONZERO)
    low = -np.einsum("kai,kri->kar", n, a).max(axis=2)
    high = np.einsum("kai,kri->kar", n, b).min(axis=2)
    # on an arc between two rays on one side of a plane nothing is closer to the plane than both
    good = (low >= 0) & (high >= 0)
    angle = np.arcsin(np.clip(low, 0, 1)) + np.arcsin(np.clip(high, 0, 1))
    out: np.ndarray = np.where(good, angle, 0.0).max(axis=1)
    return out
