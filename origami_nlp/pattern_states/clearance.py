"""Where facets cross along a curve, and that they do not touch unseen between two states at which it was asked.

As seen from one facet the corners of another move over a step along their chords, but for a remainder of second order:
their second derivatives are bounded by how fast the creases between both turn, times the way over the paper from these
creases, which no fold makes longer.  A plane that parts both facets by more than that at both ends of the step parts
them all along; otherwise the step is halved.  Facets round one vertex always touch there: rays take the place of
corners.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy as sp

from origami_nlp.io import ShortRepr
from origami_nlp.numerics import CLOSURE_TOL, DEEP
from origami_nlp.pattern_problem import PatternProblem, cross_each_other, crossings_among
from origami_nlp.pattern_states.interpolant import Interpolant, halves
from origami_nlp.pattern_states.parting import axes_across, planes, sectors_apart, shadows_apart

MOST_HALVINGS = 3
"""Of a step in which a pair might touch."""
HALVINGS = 20
"""Of the way from a state of a curve to the next one in which facets cross, until they touch."""
FAR = 1e200
"""Longer than any distance, and finite."""
MOST_STEPS = 64
"""Of a curve at once: some 10 MB."""
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
        How many parts of each step of the curve, the first and the last aside, facets might cross in unseen: they touch
        at both ends, or were not shown to be apart; [T].
    """

    states: np.ndarray
    crosses: np.ndarray
    unclear: np.ndarray


class Clearance:
    """Which facets of a sheet might touch between states of a curve, and where they cross.

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
        keep = (low != high) & ~np.isin(low * c.pattern.facets + high, c.joined)
        keep &= c.counts(first, second)
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
    def _pieces(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Corners of the pieces in the reference state, their middles and radii, over the sheet's size: [P, q, 3]."""
        c = self.problem.crossings
        corners = self.problem.pattern.corners[c.pieces] / c.size
        middles = corners.mean(axis=1)
        radii = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
        return corners, middles, radii

    @cached_property
    def _between(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Both pieces of each pair, the one taken to move last, and of the creases between them two things.

        [2, K]; whether a crease is one of them [K, n]; the longest way over the paper from each to what it moves, over
        the sheet's size, 1 for rays [K, n].
        """
        p, c = self.problem.pattern, self.problem.crossings
        ways, before = self._ways() / c.size, self._before()
        crease_between = {}
        for k, (i, j) in enumerate(zip(p.left.tolist(), p.right.tolist(), strict=True)):
            crease_between[i, j] = crease_between[j, i] = k
        pair, (on, arms) = (
            np.array([self.first, self.second]),
            np.zeros((2, len(self.first), p.creases)),
        )
        for k, (i, j) in enumerate(pair.T):
            self.problem.check_time()
            path, here, there = [], int(c.facet[j]), int(c.facet[i])
            while here != there:
                path.append(crease_between[here, int(before[there, here])])
                here = int(before[there, here])
            one, other = (ways[path][:, c.pieces[x]].max(axis=1) for x in (i, j))
            if one.sum() < other.sum():
                pair[:, k] = j, i
            on[k, path] = 1.0
            arms[k, path] = (
                1.0 if self._apex[k] >= 0 else min(one, other, key=lambda m: float(m.sum()))
            )
        return pair, on, arms

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

    def crosses(self, states: np.ndarray) -> np.ndarray:
        """Return at which closed states [S, n] facets cross, of bool [S]."""
        c = self.problem.crossings
        placed = np.array([c.carried(*c.poses.motions(phi)) for phi in states])
        return self._crosses(placed)

    def _crosses(self, placed: np.ndarray) -> np.ndarray:
        """Return at which states facets cross, from corners of pieces in space [S, P, q, 3]."""
        deep = DEEP * self.problem.crossings.size
        if (hit := crossings_among(placed, self.first, self.second, deep)) is not None:
            return np.asarray(hit.any(axis=1))
        low, high = placed.min(axis=2), placed.max(axis=2)
        near = np.ones((len(placed), len(self.first)), bool)
        for i in range(3):
            near &= low[:, self.first, i] <= high[:, self.second, i]
            near &= low[:, self.second, i] <= high[:, self.first, i]
        s, k = np.nonzero(near)
        a, b = placed[s, self.first[k]], placed[s, self.second[k]]
        out = np.zeros(len(placed), bool)
        out[s[cross_each_other(a, b, deep)]] = True
        return out

    @cached_property
    def _rays(self) -> np.ndarray:
        """Unit rays in the reference state along both sides of the pieces at the apex of each pair, [2, K, 2, 3]."""
        corners, pieces = self._pieces[0], self.problem.crossings.pieces
        rays = np.zeros((2, len(self.first), 2, 3))
        for k in np.flatnonzero(self._apex >= 0):
            for which, i in enumerate(self._between[0][:, k]):
                ring = pieces[i].tolist()
                many = len(set(ring))  # padded by the first corner
                m = ring.index(int(self._apex[k]))
                sides = corners[i, [(m - 1) % many, (m + 1) % many]] - corners[i, m]
                rays[which, k] = sides / np.linalg.norm(sides, axis=1, keepdims=True)
        return rays

    def remainders(self, control: np.ndarray) -> np.ndarray:
        """Bound how far corners, or rays, of one facet of each pair are off their chords over steps, as the other sees.

        Parameters
        ----------
        control
            Control points of each step, [T, 6, n].

        Returns
        -------
        numpy.ndarray
            Over the sheet's size, [T, K].
        """
        _, on, arms = self._between
        speed, bend = _bounds(self.problem.expand(control))
        # |x''| <= sum_k |phi_k''| a_k + sum_kl |phi_k' phi_l'| a_l, l the crease nearer to what moves;
        # from a chord a curve is no further than |x''| / 8
        out: np.ndarray = (bend @ arms.T + 2 * (speed @ on.T) * (speed @ arms.T)) / 8
        return out

    def touching(
        self,
        before: tuple[np.ndarray, np.ndarray],
        after: tuple[np.ndarray, np.ndarray],
        control: np.ndarray,
        pairs: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return which pairs might touch inside steps.

        Parameters
        ----------
        before, after
            Motions of the facets at both ends of each step, [T, F, 3, 3] and [T, F, 3], as `Poses.motions`.
        control
            Control points of each step, [T, 6, n].
        pairs
            Which of all pairs are asked for, [K].

        Returns
        -------
        step, pair : numpy.ndarray
            Each step and pair that were not shown to be apart, [N].
        lying : numpy.ndarray
            Which of them touch at both ends, of bool [N].
        """
        still, moving = self._between[0][:, pairs]
        off = self.remainders(control)[:, pairs]
        c, (corners, _, radii) = self.problem.crossings, self._pieces
        here, there = c.facet[still], c.facet[moving]

        def seen(step: np.ndarray, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            """Return motions of the moving pieces as seen from the other, at both ends: [2, N, 3, 3], [2, N, 3]."""
            out = []
            for turn, shift in (before, after):
                back = turn[step, here[k]].swapaxes(1, 2)
                away = (shift[step, there[k]] - shift[step, here[k]]) / c.size
                out.append((back @ turn[step, there[k]], (back @ away[:, :, None])[:, :, 0]))
            return np.array([t for t, _ in out]), np.array([s for _, s in out])

        apex = self._apex[pairs]
        every = np.flatnonzero(apex == -1)
        y = self._middles(before, after, still[every], moving[every])
        # the chord of two middles is no nearer to a third than this
        near = np.linalg.norm(y, axis=3).sum(axis=0) - np.linalg.norm(y[1] - y[0], axis=2)
        step, k = np.nonzero(near / 2 - radii[moving[every]] - radii[still[every]] <= off[:, every])
        k = every[k]
        turn, shift = seen(step, k)
        a, b = corners[still[k]], corners[moving[k]] @ turn.swapaxes(2, 3) + shift[:, :, None]
        lying = np.zeros(len(k), bool)
        left = np.arange(len(k))
        for axes in (lambda a, b: (b - a).mean(axis=1)[:, None], planes, axes_across):
            if not len(left):
                break
            middle = 0.5 * (b[0, left] + b[1, left])
            gap, at_ends = shadows_apart(a[left], b[:, left], axes(a[left], middle))
            lying[left] = at_ends < DEEP
            left = left[gap <= off[step[left], k[left]]]
        at = np.repeat(np.arange(len(control)), (apex >= 0).sum())
        corner = np.tile(np.flatnonzero(apex >= 0), len(control))
        first, second = (x[pairs[corner]] for x in self._rays)
        turn, _ = seen(at, corner)
        gap, at_ends = sectors_apart(first, second @ turn.swapaxes(2, 3))
        touch = gap <= off[at, corner]
        # several corners in common: never shown to be apart where anything moves
        more = np.tile(np.flatnonzero(apex == -2), len(control))
        of_more = np.repeat(np.arange(len(control)), (apex == -2).sum())
        return (
            np.concatenate([step[left], at[touch], of_more]),
            pairs[np.concatenate([k[left], corner[touch], more])],
            np.concatenate([lying[left], at_ends[touch] < DEEP, np.ones(len(more), bool)]),
        )

    def _middles(
        self,
        before: tuple[np.ndarray, np.ndarray],
        after: tuple[np.ndarray, np.ndarray],
        still: np.ndarray,
        moving: np.ndarray,
    ) -> np.ndarray:
        """Return the middles of pieces [K], less those of others [K], as these see them at both ends, [2, T, K, 3]."""
        c, middles = self.problem.crossings, self._pieces[1]
        out = []
        for turn, shift in (before, after):
            back = turn[:, c.facet].swapaxes(2, 3)
            placed = (turn[:, c.facet] @ middles[..., None])[..., 0] + shift[:, c.facet] / c.size
            # of all pairs at once: one product of matrices a step
            steps, many = placed.shape[:2]
            seen = (back.reshape(steps, 3 * many, 3) @ placed.swapaxes(1, 2)).reshape(
                steps, many, 3, many
            )
            out.append(seen[:, still, :, moving] - seen[:, still, :, still])
        return np.array(out).swapaxes(1, 2)

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
        problem, c = self.problem, self.problem.crossings
        many = len(curve.control)
        # the rest of an odd curve is its mirror image, in which as much crosses
        begin = many // 2 if curve.odd else 0
        motions = [c.poses.motions(x) for x in curve.states[begin:]]
        turn, shift = (np.array(x) for x in zip(*motions, strict=True))
        crosses = self._crosses(np.array([c.carried(*motion) for motion in motions]))
        if curve.odd:
            crosses = np.concatenate([crosses[:1:-1], crosses])
        if len(c.pieces) > MOST_PIECES or c.cell or not len(self.first):
            return Stretches(curve.states, crosses, np.full(many, int(len(self.first) > 0)))
        # folded flat at an end of the curve, facets lie on each other
        steps = np.flatnonzero(~crosses[1:-2] & ~crosses[2:-1]) + 1
        steps = steps[steps >= begin]
        found: dict[int, list[Any]] = {}
        for few in np.array_split(steps, range(MOST_STEPS, len(steps), MOST_STEPS)):
            if not len(few):
                break
            problem.check_time()
            k = few - begin
            ends = ((turn[k], shift[k]), (turn[k + 1], shift[k + 1]))
            at, pairs, lying = self.touching(*ends, curve.control[few], np.arange(len(self.first)))
            for i, step in enumerate(few.tolist()):
                problem.check_time()
                which = at == i
                given = motions[k[i]], motions[k[i] + 1], pairs[which], lying[which]
                found[step] = list(self._within(curve.control[step], *given)) if which.any() else []
        if curve.odd:
            for i in range(begin):
                seen = reversed(found.get(many - 1 - i, []))
                found[i] = [x and (-x[0], x[1]) for x in seen]
        out, flags, unclear = [curve.states[:1]], [crosses[:1]], np.zeros(many, int)
        for i in range(many):
            inside = [x for x in found.get(i, []) if x is not None]
            unclear[i] = len(found.get(i, [])) - len(inside)
            out += [*(x[None] for x, _ in inside), curve.states[i + 1 : i + 2]]
            flags += [*(np.array([f]) for _, f in inside), crosses[i + 1 : i + 2]]
        return Stretches(np.concatenate(out), np.concatenate(flags), unclear)

    def _within(
        self,
        control: np.ndarray,
        a: tuple[np.ndarray, np.ndarray],
        b: tuple[np.ndarray, np.ndarray],
        pairs: np.ndarray,
        lying: np.ndarray,
        depth: int = 0,
    ) -> Iterator[tuple[np.ndarray, bool] | None]:
        """Go through states to be added inside a step, and whether facets cross; None for a part left unclear.

        Only `pairs` might touch in it: a half of a step asks no more for those that the whole showed to be apart.
        """
        before, after = halves(control)
        phi, residual = self.problem.project(before[-1])
        if lying.all() or depth == MOST_HALVINGS or residual > CLOSURE_TOL:
            yield None
            return
        c = self.problem.crossings
        x = c.poses.motions(phi)
        crosses = bool(self._crosses(c.carried(*x)[None])[0])
        for half, one, other in ((before, a, x), (after, x, b)):
            if not crosses:
                begun, ended = ((turn[None], shift[None]) for turn, shift in (one, other))
                _, left, flat = self.touching(begun, ended, half[None], pairs)
                if len(left):
                    yield from self._within(half, one, other, left, flat, depth + 1)
            if half is before:
                yield phi, crosses


def _bounds(control: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bound first and second derivatives of steps: those of Bezier polynomials are within those of control points."""
    speed = 5 * np.abs(np.diff(control, axis=1)).max(axis=1)
    return speed, 20 * np.abs(np.diff(control, 2, axis=1)).max(axis=1)


def last_free(
    problem: PatternProblem, free: np.ndarray, crossed: np.ndarray, halvings: int = HALVINGS
) -> tuple[np.ndarray, np.ndarray]:
    """Bisect between a closed state [n] without crossings and one with some near by: the last one, and the first."""
    for _ in range(halvings):
        middle, residual = problem.project(0.5 * (free + crossed))
        if residual > CLOSURE_TOL:
            break
        if problem.crossings.find(middle):
            crossed = middle
        else:
            free = middle
    return free, crossed
