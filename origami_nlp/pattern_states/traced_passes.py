"""Passes between the stable states of a sheet along its traced curves: which states they join, and how high.

Each curve is cut at its samples, where the energy is stationary, where closure loses rank (other curves leave there)
and at the stable states on it: between two cuts the energy is monotone.  Curves that meet have that state in common.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, NEAR_SINGULAR_TOL, MergeTree, groups, merge_tree
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states.clearance import Stretches
from origami_nlp.pattern_states.curves import LONG, TracedCurve
from origami_nlp.pattern_states.interpolant import ON_CURVE, Interpolant, stationary

SHARES = np.linspace(0.0, 1.0, 7)
"""Of a stretch beside touching facets, at which it is asked whether facets cross."""


@dataclass(frozen=True, eq=False)
class TracedPasses:
    """The merge tree of traced curves.

    tree: over the minima.  states, energies: of the vertices, [V, n], [V].  edges: [E, 2].
    on_curves: minima that are states of the curves.
    """

    tree: MergeTree
    states: np.ndarray
    energies: np.ndarray
    edges: np.ndarray
    on_curves: np.ndarray

    def heights(self) -> np.ndarray:
        """Energy of the lowest pass between two minima, [M, M]; inf where no curve leads from one to the other."""
        many = len(self.on_curves)
        out = np.full((many, many), math.inf)
        for merge in self.tree.merges:
            for i in merge.first:
                out[i, list(merge.second)] = merge.height
        return np.minimum(out, out.T)

    def top(self, i: int, j: int) -> np.ndarray:
        """Return the pass between two minima that are joined, [n]."""
        merge = self.tree.barrier(i, j)
        assert merge is not None
        ends = self.edges[merge.edge]
        top: np.ndarray = self.states[ends[self.energies[ends].argmax()]]
        return top


@dataclass(frozen=True, eq=False)
class CurvePasses:
    """What traced curves say of leaving states.

    Attributes
    ----------
    sure
        Over stretches on which it is known whether facets cross; energies over the mean stiffness.
    passes
        Over all on which they were not seen to cross.
    heights
        Of the edges of `passes`, [E].
    open
        Vertices from which more may lead than these curves: where closure loses rank, and where a curve was lost.
    """

    sure: TracedPasses
    passes: TracedPasses
    heights: np.ndarray
    open: np.ndarray
    _parts: dict[int, np.ndarray] = field(default_factory=dict, repr=False)

    def least(self, k: int, others: Sequence[int], level: float) -> float:
        """Return an energy that every motion from state k to a lower state, or to some others, passes.

        inf where its curve ends at limits and contacts both ways.
        """
        energies = self.passes.energies
        first = len(energies) - len(self.passes.on_curves)
        start = first + k
        ends = self.open | (energies < energies[start] - level)
        ends[[first + j for j in others]] = True
        ends[start] = False
        levels = np.unique(self.heights)

        def reaches(k: int) -> bool:
            """Whether a way that climbs no higher than a level leads to an end."""
            if k not in self._parts:
                below = self.passes.edges[self.heights <= levels[k]]
                self._parts[k] = groups(len(energies), below)
            part = self._parts[k]
            return bool(ends[part == part[start]].any())

        # the higher the level, the more hangs together
        k = bisect_left(range(len(levels)), True, key=reaches)
        return max(float(levels[k]), float(energies[start])) if k < len(levels) else math.inf


def curve_passes(
    problem: PatternProblem, curves: Sequence[TracedCurve], minima: np.ndarray
) -> CurvePasses | None:
    """Build the merge tree of traced curves.

    Parameters
    ----------
    problem
        The problem.
    curves
        Of it.
    minima
        States [M, n].

    Returns
    -------
    CurvePasses
        None without curves.
    """
    if not curves or not len(minima):
        return None
    junctions: list[np.ndarray] = []
    for traced in curves:
        for x in traced.meets:
            if not any(np.abs(x - y).max() <= ON_CURVE for y in junctions):
                junctions.append(x)
    network = _Network(problem, [*junctions, *minima])
    network.open |= set(range(len(junctions)))
    for traced in curves:
        network.add(traced)
    # minima last, see `TracedPasses`
    first, count = len(junctions), len(network.states)
    order = np.r_[0:first, first + len(minima) : count, first : first + len(minima)]
    back = np.argsort(order)
    states = np.array(network.states)[order]
    energies = np.array([problem.scaled_energy(x) for x in states])
    edges = back[np.array(network.edges, int).reshape(-1, 2)]
    clear = np.array(network.clear, bool)
    heights = energies[edges].max(axis=1) if len(edges) else np.zeros(0)
    leaves = list(range(count - len(minima), count))
    sure, passes = (
        TracedPasses(
            merge_tree(energies, edges[which], heights[which], leaves),
            states,
            energies,
            edges[which],
            np.isin(leaves, edges[which]),
        )
        for which in (clear, np.ones(len(clear), bool))
    )
    opened = np.zeros(count, bool)
    opened[back[sorted(network.open)]] = True
    return CurvePasses(sure, passes, heights, opened)


class _Network:
    """States on curves and stretches between them."""

    def __init__(self, problem: PatternProblem, known: list[np.ndarray]) -> None:
        self.problem, self.states, self.known = problem, known, len(known)
        self.edges: list[tuple[int, int]] = []
        self.clear: list[bool] = []
        self.open: set[int] = set()
        self._asked: dict[
            tuple[float, float], bool
        ] = {}  # stretches of the curve that is added, see `_passes`

    def add(self, traced: TracedCurve) -> None:
        """Add a curve, cut into stretches."""
        curve, self._asked = traced.curve, {}
        cuts: list[tuple[float, int]] = []
        for k in np.flatnonzero(curve.may_hold(np.array(self.states[: self.known]))).tolist():
            cuts += [(at, k) for at in places(self.problem, curve, self.states[k])]
        for i, x in enumerate(curve.states):
            cuts.append((float(i), self._new(x)))
        for step, u, _ in stationary(self.problem, curve):
            cuts.append((step + u, self._new(self._closed(curve, step + u))))
        cuts.sort()
        known = [k for _, k in cuts if k < self.known]
        for x in traced.meets:
            if not any(np.abs(self.states[k] - x).max() <= ON_CURVE for k in known):
                nearest = min(cuts, key=lambda cut: np.abs(self.states[cut[1]] - x).max())
                self.open.add(nearest[1])
        for end, cut in zip(curve.ends, (cuts[0], cuts[-1]), strict=True):
            if end not in ("limit", "closed"):
                self.open.add(cut[1])
        seen = traced.stretches
        many = len(curve.control)
        unclear = np.zeros(many, int) if seen is None else seen.unclear
        flags = None if seen is None else list(_flags(curve, seen))
        for (p, a), (q, b) in itertools.pairwise(cuts):
            if flags is None or self._passes(curve, flags, p, q):
                step = min(int((p + q) / 2), many - 1)
                self.edges.append((a, b))
                self.clear.append(curve.fits and not unclear[step])
        if "closed" in curve.ends:
            self.edges.append((cuts[0][1], cuts[-1][1]))
            self.clear.append(curve.fits)

    def _new(self, x: np.ndarray) -> int:
        self.states.append(x)
        return len(self.states) - 1

    def _closed(self, curve: Interpolant, at: float) -> np.ndarray:
        """Return the closed state at a place of a curve, as exactly as closure determines it."""
        step = min(int(at), len(curve.control) - 1)
        x = curve.at(step, at - step)
        limits = self.problem.fold_limits
        at_limit = limits.room(x) <= ON_CURVE**2
        x = np.where(at_limit, limits.hold(x, limits.side(x)), x)
        new, residual = self.problem.project(x, at_limit)
        return new if residual <= CLOSURE_TOL and np.abs(new - x).max() <= ON_CURVE else x

    def _passes(self, curve: Interpolant, flags: list[list[bool]], p: float, q: float) -> bool:
        """Return whether facets do not cross on a stretch inside one step: known between samples apart, else asked."""
        many = len(curve.control)
        step = min(int((p + q) / 2), many - 1)
        if all(flags[step]):
            return False
        if 0 < step < many - 1 and not any(flags[step]):
            return True
        if curve.odd and step == many - 1:  # mirrored it crosses as well
            p, q = many - q, many - p
        if (p, q) not in self._asked:
            shares = (self._closed(curve, p + (q - p) * share) for share in SHARES)
            self._asked[p, q] = not any(map(self.problem.crossings.find, shares))
        return self._asked[p, q]


def _flags(curve: Interpolant, seen: Stretches) -> Iterator[list[bool]]:
    """Yield for each step whether facets cross at the states of it that were looked at."""
    at = 0
    for last in curve.states[1:]:
        flags = [bool(seen.crosses[at])]
        while flags[1:] == [] or not np.array_equal(seen.states[at], last):
            at += 1
            flags.append(bool(seen.crosses[at]))
        yield flags


def places(problem: PatternProblem, curve: Interpolant, phi: np.ndarray) -> list[float]:
    """Return where on a curve a state is, as steps and shares of them, by its polynomials (as in `TracedCurves`)."""
    apart = np.linalg.norm(curve.states - phi, axis=1)
    padded = np.r_[math.inf, apart, math.inf]
    low = (apart <= padded[:-2]) & (apart <= padded[2:]) & (apart <= 2 * LONG * problem.size**0.5)
    found: list[float] = []
    for i in np.flatnonzero(low).tolist():
        for step in (i - 1, i):
            if not 0 <= step < len(curve.control):
                continue
            at, best = curve.nearest(step, phi)
            near = any(abs(step + at - other) < NEAR_SINGULAR_TOL for other in found)
            if best < ON_CURVE and not near:
                found.append(step + at)
    return found
