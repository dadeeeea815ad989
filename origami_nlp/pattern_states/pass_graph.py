"""Which states ways join, and how high these climb: traced curves, and explicit ways, as a graph over the minima.

Each curve is cut at its samples, where the energy is stationary, where closure loses rank (other curves leave there)
and at the stable states on it: between two cuts the energy is monotone.  Curves that meet have that state in common;
explicit ways begin and end at minima, or begin at states from which several go down.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, NEAR_SINGULAR_TOL, MergeTree, groups, merge_tree
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states.clearance import Stretches
from origami_nlp.pattern_states.curves import LONG, TracedCurve
from origami_nlp.pattern_states.interpolant import ON_CURVE, Interpolant, stationary

SHARES = np.linspace(0.0, 1.0, 7)
"""Of a stretch beside touching facets, at which it is asked whether facets cross."""


class PathDown(NamedTuple):
    """Closed admissible states [S, n] that end at a minimum.

    to: its number (from 0).  start: number of the minimum that it begins at; -1 for another state, from which other
    ways may begin.  energy: what it does not climb above [the problem's units]; nan where its highest state is exact.
    """

    states: np.ndarray
    to: int
    start: int = -1
    energy: float = math.nan


class Edge(NamedTuple):
    """Two states that a way joins, by number.

    least: what it climbs to at least, over the scale; -inf: the higher of both.  sure: whether it is known that facets
    do not cross on it, and how high it climbs.
    """

    one: int
    two: int
    least: float = -math.inf
    sure: bool = False


@dataclass(frozen=True, eq=False)
class PassGraph:
    """A graph of states; energies over the scale of the problem.

    Attributes
    ----------
    problem
        The problem.
    minima
        How many of the states are minima: the first ones.
    states
        [V, n].
    edges
        Between them.
    open
        States from which more may lead than these ways: where closure loses rank, and where a curve was lost.
    inner
        States that are but somewhere on a way.
    """

    problem: PatternProblem
    minima: int
    states: np.ndarray
    edges: tuple[Edge, ...] = ()
    open: frozenset[int] = frozenset()
    inner: frozenset[int] = frozenset()

    @cached_property
    def _parts(self) -> dict[int, np.ndarray]:
        """Of the levels of the edges, by number, what hangs together below."""
        return {}

    @cached_property
    def energies(self) -> np.ndarray:
        """Of the states, [V]."""
        return np.asarray(self.problem.energies(self.states) / self.problem.scale)

    @cached_property
    def pairs(self) -> np.ndarray:
        """Ends of the edges, [E, 2]."""
        return np.array([e[:2] for e in self.edges], int).reshape(-1, 2)

    @cached_property
    def height(self) -> np.ndarray:
        """Of the edges, [E]."""
        ends = self.energies[self.pairs].max(axis=1, initial=-math.inf)
        return np.maximum(ends, [e.least for e in self.edges]) if len(ends) else ends

    @cached_property
    def tree(self) -> MergeTree:
        """The merge tree of the minima."""
        return merge_tree(self.energies, self.pairs, self.height, self.minima)

    @cached_property
    def sure(self) -> PassGraph:
        """The same of the edges that are sure."""
        some = replace(self, edges=tuple(e for e in self.edges if e.sure))
        vars(some)["energies"] = self.energies
        return some

    def heights(self) -> np.ndarray:
        """Energy of the lowest pass between two minima, [M, M]; inf where no way leads from one to the other."""
        out = np.full((self.minima, self.minima), math.inf)
        for merge in self.tree.merges:
            for i in merge.first:
                out[i, list(merge.second)] = merge.height
        return np.minimum(out, out.T)

    def top(self, edge: int) -> int:
        """Return the number of the higher end of an edge."""
        ends = self.pairs[edge]
        return int(ends[self.energies[ends].argmax()])

    def least(self, k: int, others: Sequence[int], level: float) -> float:
        """Return an energy that every motion from minimum k to a lower state, or to some others, passes.

        inf where its curve ends at limits and contacts both ways.
        """
        ends = self.energies < self.energies[k] - level
        ends[[*self.open, *others]] = True
        ends[k] = False
        levels = np.unique(self.height)

        def reaches(at: int) -> bool:
            """Whether a way that climbs no higher than a level leads to an end."""
            if at not in self._parts:  # which is asked of many pairs of minima
                below = self.pairs[self.height <= levels[at]]
                self._parts[at] = groups(len(ends), below)
            part = self._parts[at]
            return bool(ends[part == part[k]].any())

        # the higher the level, the more hangs together
        at = bisect_left(range(len(levels)), True, key=reaches)
        return max(float(levels[at]), float(self.energies[k])) if at < len(levels) else math.inf

    def with_ways(self, ways: Sequence[PathDown]) -> PassGraph:
        """Return the graph with explicit ways as well."""
        states, edges, inner = list(self.states), list(self.edges), set(self.inner)
        tops: dict[bytes, int] = {}
        for way in ways:
            start = way.start
            if start < 0:
                start = tops.setdefault(way.states[0].tobytes(), len(states))
                states += [way.states[0]] * (start == len(states))
            first = len(states)
            states += list(way.states[1:-1])
            inner |= set(range(first, len(states)))
            along = [start, *range(first, len(states)), way.to]
            least = np.full(len(along), -math.inf)
            if not math.isnan(way.energy):
                highest = int(self.problem.energies(way.states).argmax())
                least[highest] = way.energy / self.problem.scale
            edges += map(Edge, along, along[1:], np.maximum(least[:-1], least[1:]).tolist())
        made = {"states": np.array(states), "edges": tuple(edges), "inner": frozenset(inner)}
        return replace(self, **made)  # type: ignore[arg-type]


def graph_of_curves(
    problem: PatternProblem, curves: Sequence[TracedCurve], minima: np.ndarray
) -> PassGraph:
    """Return the graph of traced curves over minima [M, n]."""
    network = _Network(problem, minima)
    for traced in curves:
        for x in traced.meets:
            if not any(np.abs(x - y).max() <= ON_CURVE for y in network.states[len(minima) :]):
                network.open.add(network.new(x))
    network.known = len(network.states)
    for traced in curves:
        network.add(traced)
    found = np.array(network.states).reshape(-1, problem.size)
    return PassGraph(problem, len(minima), found, tuple(network.edges), frozenset(network.open))


class _Network:
    """States on curves and stretches between them; the first that are known lie on several."""

    def __init__(self, problem: PatternProblem, minima: np.ndarray) -> None:
        self.problem, self.states, self.known = problem, list(minima), len(minima)
        self.edges: list[Edge] = []
        self.open: set[int] = set()
        # stretches of the curve that is added, see `_passes`
        self._asked: dict[tuple[float, float], bool] = {}

    def add(self, traced: TracedCurve) -> None:
        """Add a curve, cut into stretches."""
        curve, self._asked = traced.curve, {}
        cuts: list[tuple[float, int]] = []
        known = np.array(self.states[: self.known]).reshape(-1, self.problem.size)
        for k in np.flatnonzero(curve.may_hold(known)).tolist():
            cuts += [(at, k) for at in places(self.problem, curve, self.states[k])]
        met = [k for _, k in cuts]
        for i, x in enumerate(curve.states):
            cuts.append((float(i), self.new(x)))
        for step, u, _ in stationary(self.problem, curve):
            cuts.append((step + u, self.new(self._closed(curve, step + u))))
        cuts.sort()
        for x in traced.meets:
            if not any(np.abs(self.states[k] - x).max() <= ON_CURVE for k in met):
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
                self.edges.append(Edge(a, b, sure=curve.fits and not unclear[step]))
        if "closed" in curve.ends:
            self.edges.append(Edge(cuts[0][1], cuts[-1][1], sure=curve.fits))

    def new(self, x: np.ndarray) -> int:
        """Add a state, and return its number."""
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
