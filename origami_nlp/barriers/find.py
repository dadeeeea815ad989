"""Barriers: for each pair of minima the lowest pass between them that is known, and a path through it.

Along traced curves where there are some, exactly with one degree of freedom (`graph`), and
along ways on one terrain (`search.Terrain`): escape paths, straight walks, and descents from saddles, which
Newton on the KKT system finds where the lowest ways are highest (`passes`).  `graph` says what lies below as well.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from origami_nlp.arguments import check_callback, check_until, check_whole
from origami_nlp.barriers.graph import bounded, flat_bound, is_lowest, passes_over
from origami_nlp.barriers.passes import both_sides, critical_near
from origami_nlp.barriers.result import Barriers
from origami_nlp.errors import OutOfTime, unless_stopped
from origami_nlp.escapes import (
    ALONE,
    MOST_CREASES,
    TRACED,
    Escape,
    Terrain,
    barriers,
    down_to,
    energy_scale,
    escape_paths_of_each,
    highest,
    images_of,
    is_first,
    level_of,
    number_of,
    rounded_up,
)
from origami_nlp.minima import MinimaResult, check_result
from origami_nlp.numerics import DUPLICATE_TOL, groups
from origami_nlp.pattern import Scene, Stated, as_origami
from origami_nlp.pattern_states import PassGraph, PathDown, find_states, graph_of_curves

SECONDS = 60.0
"""For ways of each kind, of wall time."""


def find_barriers(
    origami: Stated,
    result: MinimaResult | None = None,
    *,
    seed: int = 0,
    seconds: float | None = None,
    progress: Callable[[str], object] | None = None,
) -> Barriers:
    """Find the lowest pass between every two minima of a vertex or of a pattern.

    With one degree of freedom passes are those of all curves of closed states, exactly.  With more they are upper
    bounds by paths: along traced curves, by descents out of each minimum, straight to others, and over saddles; exact
    where the flat state of a vertex parts two minima and a path climbs no higher.  Of a vertex they join states that
    wind once round the axis, or `Scene.winding` times: no path within the symmetry leads to others.

    Parameters
    ----------
    origami
        A scene or a pattern, as `find_minima` takes it.
    result
        Its minima, of `find_minima`; found here if not given.
    seed
        Of the search for minima.
    seconds
        Wall time: what was found by then is returned, and what was left out named.  None: a search for minima of a
        pattern takes 300 s at most, and each part of the search for paths 60 s.
    progress
        Called with what it is at.

    Returns
    -------
    Barriers
        A pass for every pair and the merge tree; its `result` has the escape barriers that follow.

    Raises
    ------
    OptionError
        If a scene has dead loads, or an argument is not what it must be.
    Interrupted
        If the user interrupts it: a `KeyboardInterrupt` whose ``result`` holds what was found.

    Examples
    --------
    >>> import origami_nlp as o
    >>> scene = o.examples.degree6("pi/4", ratio=0.01)
    >>> found = o.find_barriers(scene, o.find_minima(scene, max_starts=16))
    >>> [(p.from_state, p.to_state, p.pass_kind) for p in found.passes]
    [(1, 2, 'flat state')]
    """
    until = check_until(seconds)
    check_callback("progress", progress)
    say = progress or (lambda _: None)
    stated = as_origami(origami)
    check_whole("seed", seed, 0)
    if isinstance(stated, Scene):
        stated.check_no_forces("barriers")
        stated = stated.of_one_winding
    if result is None:
        # half of a time limit is for paths
        left = None if seconds is None else 0.5 * max(until - time.monotonic(), 0.0)
        say("search for minima")
        result = find_states(stated, seed=seed, prove=False, escape=False, seconds=left)
    check_result(result, stated)
    if isinstance(stated, Scene):
        # no path within the symmetry leads from one winding to another
        here = tuple(m for m in result.minima if m.winding == stated.windings[0])
        result = replace(result, minima=here) if len(here) < len(result.minima) else result
    problem, before = result.model, result.model.until
    problem.until = until
    try:
        found = _Paths(result, say).barriers()
        return unless_stopped(found, found.stopped)
    finally:
        problem.until = before


class _Paths:
    """Curves and ways between minima, until the time of their problem is over."""

    def __init__(self, result: MinimaResult, say: Callable[[str], object]) -> None:
        self.result, self._say, self.problem = result, say, result.model
        minima = np.array([m.fold_angles for m in result.minima])
        minima = minima.reshape(-1, self.problem.pattern.creases)
        self.minima, self.stopped = self.problem.reduce(minima), False
        self.late = ["the search for minima"] * (result.search.stopped_by == "time")
        self.beyond = np.full(len(result.minima), math.inf)
        self.ways, self.loose = list[PathDown](), list[int]()
        self.traced = PassGraph(self.problem, len(minima), self.minima)

    def barriers(self) -> Barriers:
        """Find them."""
        result, posed, many = self.result, self.problem, len(self.minima)
        if not many:
            return Barriers(result, (), (), (*self.late,))
        energies = np.array([m.energy for m in result.minima])
        level = level_of(energies, energy_scale(posed.pattern.stiffness))
        curves = partial(graph_of_curves, posed, result.curves, self.minima)
        self.traced = self._in_time("passes along traced curves", curves) or self.traced
        sure = partial(is_lowest, result, self.traced, level / posed.scale)
        open_ = set[int]() if result.curves else {*range(many)}
        for i, j in itertools.combinations(range(many), 2):
            merge = self.traced.tree.barrier(i, j)
            if merge is None or not sure(i, j, merge.height):
                open_ |= {i, j}
        moves = [k for k in sorted(open_) if result.minima[k].local_dimension]
        self.loose = moves if posed.size <= MOST_CREASES else []
        self.terrain = Terrain(posed, self.minima)
        for part, find in (
            ("ways between minima", self._between),
            ("escape paths", self._escapes),
            ("saddles beside paths", self._over_saddles),
        ):
            self._in_time(part, lambda find=find: self.ways.extend(find()))  # type: ignore[misc]
        found, flat = passes_over(result, self.traced.with_ways(self.ways), sure), flat_bound(posed)
        passes = tuple(bounded(p, result, flat, level) for p in found.passes)
        found = replace(found, passes=passes, left_out=(*self.late,), stopped=self.stopped)
        return replace(found, result=self._with_escapes(found.matrix(), energies, level))

    def _with_escapes(
        self, heights: np.ndarray, energies: np.ndarray, level: float
    ) -> MinimaResult:
        """Return the minima with what passes of some heights [M, M] say of leaving them, where no less is known."""
        scale, listed = energy_scale(np.array(self.result.origami.stiffness)), [*self.result.minima]
        np.fill_diagonal(heights, math.inf)
        for k, (barrier, to) in enumerate(barriers(energies, heights, level, scale, self.beyond)):
            known = listed[k].escape
            exact = known is not None and known.method in (TRACED, ALONE)
            if math.isfinite(barrier) and not (known and (exact or known.barrier <= barrier)):
                listed[k] = replace(listed[k], escape=Escape.bound(barrier, to, scale))
        return replace(self.result, minima=tuple(listed))

    def _in_time(self, part: str, work: Callable[[], object]) -> Any:
        """Do a part of the work for `SECONDS` at most, and note if the time ended it."""
        self._say(part)
        until = self.problem.until
        try:
            self.problem.until = min(until, time.monotonic() + SECONDS * (not self.stopped))
            self.problem.check_time()
            return work()
        except (OutOfTime, KeyboardInterrupt) as stop:
            self.late.append(part)
            self.stopped |= isinstance(stop, KeyboardInterrupt)
        finally:
            self.problem.until = until
        return None

    def _escapes(self) -> Iterator[PathDown]:
        """Go escape paths out of each minimum on to where they end, those of images under symmetries as these."""
        terrain = self.terrain
        images = images_of(terrain.minima, self.problem.moves)
        # minima are in order of energy
        # out of those of lowest energy, images under symmetries not counted
        first = [k for k in self.loose if is_first(k, images)][:12]
        for k, found in escape_paths_of_each(terrain, first):
            for way in found:
                if way.to < 0:
                    for j in {k, *images[:, k].tolist()} - {-1}:
                        self.beyond[j] = min(self.beyond[j], way.height)
                elif (down := down_to(terrain, way.states[-1])) is not None and down[1] != k:
                    states = np.concatenate([terrain.minima[k][None], way.states, down[0][1:]])
                    for one in self._checked(states, down[1], k):
                        yield from self._with_images(one, terrain.minima)

    def _with_images(self, way: PathDown, nodes: np.ndarray) -> Iterator[PathDown]:
        """Go through a way between some states, minima the first, and its images under symmetries of all springs."""
        seen = set[tuple[int, int]]()
        for states in (way.states.copy(), *(move(way.states) for move in self.problem.moves)):
            ends = number_of(states[0], nodes), number_of(states[-1], nodes)
            if min(ends) >= 0 and ends not in seen:
                seen.add(ends)
                states[[0, -1]] = nodes[[*ends]]
                start = ends[0] if ends[0] < len(self.minima) else -1
                yield PathDown(states, ends[1], start, way.energy)

    def _between(self) -> Iterator[PathDown]:
        """Walk from minima to the flat state, and to each other, over any height, where no way is known yet.

        From where a walk meets contact it goes down.  Each way is closed, and facets do not cross at the states that
        are looked at.
        """
        terrain, problem = self.terrain, self.terrain.problem
        minima, many, flat = terrain.minima, len(terrain.minima), np.zeros(problem.size)
        lies = problem.pattern.lies_flat and not problem.refuses(flat)
        nodes = np.concatenate([minima, flat[None][: int(lies)]])
        joined = [(m.first[0], m.second[0]) for m in self.traced.tree.merges]
        # on different sides of flat vertices: no straight way leads from one to the other
        sides = terrain.sides(nodes)
        differ = (sides[:, None] * sides < 0).any(axis=2)

        def apart(one: int, other: int) -> bool:
            group = groups(len(nodes), joined)
            return bool(group[one] != group[other])

        def whole(start: int, to: int, path: np.ndarray) -> Iterator[PathDown]:
            passed = terrain.through_flat(path)
            if passed is None or (passed := terrain.with_tops(passed)) is None:
                return
            passed[[0, -1]] = nodes[[start, to]]
            for one in self._with_images(PathDown(passed, to, start), nodes):
                joined.append((one.to, one.start if one.start >= 0 else many))
                yield one

        for k in np.flatnonzero(~differ[many, :many]).tolist() if lies else ():
            path, arrives = terrain.walk_to(minima[k], flat)
            if arrives and (k, many) not in joined:
                yield from whole(many, k, path[::-1])
        # more decimals of distances are rounding
        far = np.linalg.norm(minima[:, None] - minima, axis=2).round(6)
        pairs, group, descents = set(), groups(len(nodes), joined), 60
        for k in range(many):
            # walks lead to the nearest ones, while no way to them is known
            nearest = np.argsort(far[k], kind="stable").tolist()
            others = [j for j in nearest if group[j] != group[k] and not differ[k, j]]
            pairs |= {(min(k, j), max(k, j)) for j in others[:8]}
        for pair in sorted(pairs, key=lambda pair: (far[pair], pair)):
            for k, to in (pair, pair[::-1]):
                if not apart(k, to):
                    break
                path, arrives = terrain.walk_to(minima[k], minima[to])
                if not arrives and len(path) > 1 and descents:
                    descents -= 1
                    down = down_to(terrain, path[-1])
                    if (arrives := down is not None and apart(k, down[1])) and down is not None:
                        to, path = down[1], np.concatenate([path, down[0][1:]])
                if arrives:
                    yield from whole(k, to, path)

    def _over_saddles(self) -> Iterator[PathDown]:
        """Go down both sides of saddles beside the highest states of the lowest ways."""
        terrain, known, tried = self.terrain, list[np.ndarray](), set[bytes]()
        # beside those first that the most pairs of minima pass
        while len(tried) < 40:
            graph = self.traced.with_ways(self.ways)
            merges = sorted(graph.tree.merges, key=lambda m: -len(m.first) * len(m.second))
            tops = (graph.states[graph.top(merge.edge)] for merge in merges)
            top = next((x for x in tops if x.tobytes() not in tried), None)
            if top is None:
                return
            tried.add(top.tobytes())
            # within 0.3 rad of the highest state of a way
            for one in critical_near(terrain.problem, top, 0.3):
                if not any(np.abs(one.x - x).max() <= DUPLICATE_TOL for x in known):
                    known.append(one.x)
                    for states, to in both_sides(terrain, one):
                        yield from self._checked(states, to)

    def _checked(self, states: np.ndarray, to: int, start: int = -1) -> Iterator[PathDown]:
        """Cut steps of a way finely, and bound what it climbs; nothing where that leaves closed admissible states."""
        terrain = self.terrain
        apart = [True, *(np.abs(a - b).max() > 0 for a, b in itertools.pairwise(states))]
        if (found := highest(terrain, to, states[apart])) is not None:
            rise, top, dense = found
            if start < 0 and np.array_equal(top, dense[0]):
                yield PathDown(dense, to)
                return
            high = max(0.0, float(terrain.rise(to, dense[0]))) if start >= 0 else 0.0
            # of an unrefined way more than two digits hang on where its steps were cut
            rise = high + float(rounded_up(rise - high))
            yield PathDown(dense, to, start, terrain.problem.energy(terrain.minima[to]) + rise)
