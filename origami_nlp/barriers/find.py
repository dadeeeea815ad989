"""Barriers: for each pair of minima the lowest pass between them that is known, and a path through it.

Along traced curves where there are some, exactly with one degree of freedom, and along ways on one terrain
(`escapes.Terrain`): escape paths, straight walks, and descents from saddles, which Newton on the KKT system finds where
the lowest ways are highest (`passes`).
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
from origami_nlp.barriers.passes import Known, Pass, PassKind, both_sides, critical_near
from origami_nlp.barriers.result import Barriers, Join
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
from origami_nlp.kkt import State
from origami_nlp.minima import MinimaResult, check_result
from origami_nlp.numerics import (
    BESIDE_SINGULAR,
    DUPLICATE_TOL,
    INPUT_TOL,
    NEAR_SINGULAR_TOL,
    SETTLED,
    groups,
)
from origami_nlp.pattern import Scene, Stated, as_origami
from origami_nlp.pattern_problem import PatternProblem, angle_sums
from origami_nlp.pattern_states import PassGraph, PathDown, find_states, graph_of_curves

SECONDS = 60.0
"""For ways of each kind, of wall time."""
SHOWN = (
    "the lowest path that is known, on traced curves, by descents, straight, or over a saddle: an upper bound; "
    "contact may be missed between its states, and lower ones are not excluded"
)
FOLLOWED = (
    "no lower path: motions from the first state follow traced curves, up to where others meet them"
)
NONE = "no admissible path is known"
PROVED = "proved: admissible states above and below the flat state meet there only"
NEVER = "no path: with less than 360 degrees of paper a vertex keeps its sign (proved)"
STOPPED = "no path: each makes a vertex flat, which a stop forbids (proved)"
RIGID = "no path: one of the two is isolated, as its certificate says"

Sure = Callable[[int, int, float], bool]


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
        scale, listed = energy_scale(self.problem.pattern.stiffness), [*self.result.minima]
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


def passes_over(result: MinimaResult, found: PassGraph, sure: Sure) -> Barriers:
    """Return the passes over a graph of states; sure: whether no path between two minima is lower than some height."""
    pairs = itertools.combinations(range(found.minima), 2)
    passes = {(i + 1, j + 1): _between(result, found, sure, i, j) for i, j in pairs}
    merges = []
    for merge in found.tree.merges:
        first, second = (tuple(k + 1 for k in side) for side in (merge.first, merge.second))
        one = passes[min(first[0], second[0]), max(first[0], second[0])]
        merges.append(Join(one.energy, one.pass_kind, first, second))
    return Barriers(result, tuple(passes.values()), tuple(merges))


def _between(result: MinimaResult, found: PassGraph, sure: Sure, i: int, j: int) -> Pass:
    """Return the pass between minima i and j (0-based) with its path."""
    merge, problem, states = found.tree.barrier(i, j), found.problem, found.states[:0]
    energy, more, kind = math.inf, dict[str, Any](), "none"
    every = merge is not None and sure(i, j, merge.height)
    if merge is not None:
        node, states = found.top(merge.edge), found.states[found.tree.path(i, j)]
        top = found.states[node]
        try:
            at, kind, residual = _made_exact(
                problem, top, "bound" if node in found.inner else "corner"
            )
            closed = tuple(problem.name(c) for c in at.pieces[0])
        except OutOfTime:
            at, kind, residual, closed = State(problem, top), "bound", math.nan, ()
        energy = float(merge.height * problem.scale) if kind == "bound" else at.energy
        angles = tuple(problem.expand(at.x).tolist())
        more = {"fold_angles": angles, "contacts": closed, "residual": residual, "every": every}
    rises = [energy - result.minima[k].energy for k in (i, j)]
    known, why = (Known.EXACT, FOLLOWED) if every else (Known.BOUND, SHOWN if more else NONE)
    path = problem.expand(states), problem.energies(states)
    return Pass(i + 1, j + 1, *rises, energy, None, kind, known, why, *path, **more)  # type: ignore[arg-type, call-arg]


def _made_exact(
    problem: Any, top: np.ndarray, otherwise: PassKind
) -> tuple[State, PassKind, float]:
    """Return the state of a pass near the top of a path [n], its kind (`otherwise`: no saddle) and its residual."""
    exact = critical_near(problem, top, NEAR_SINGULAR_TOL)
    if exact:
        return State(problem, exact[0].x), exact[0].kind, exact[0].residual  # type: ignore[return-value]
    at = State(problem, top)
    if at.regular:
        return at, otherwise, math.nan
    return at, "flat state" if np.abs(top).max() <= SETTLED else "singular", math.nan


def is_lowest(
    result: MinimaResult, traced: PassGraph, level: float, i: int, j: int, height: float
) -> bool:
    """Whether curves show that no path from minimum i to j is lower than one of a height, but for a level."""
    sure = traced.sure.tree.barrier(i, j)
    if result.minima[i].dof > 1 or sure is None or sure.height > height + level:
        return False
    # over states at which other curves may leave, no more is known than that energy
    return bool(traced.least(i, [j], level) >= height - level)


def side_of_flat(fold_angles: np.ndarray) -> np.ndarray:
    """Return on which side of the flat state admissible states [..., N] lie: the sign of the sum of all fold angles.

    Up (+1) and down (-1) are joined by admissible states only through the flat state (0), symmetric or not: round
    every other one |sum phi| >= 2 pi - area(K) > 0, with K the convex hull of the spherical polygon of the vertex,
    facets that touch included (proved in docs/validation/landscapes.md).
    """
    phi = np.asarray(fold_angles, dtype=float)
    total = phi.sum(axis=-1)
    unclear = np.abs(total) <= phi.shape[-1] * DUPLICATE_TOL
    flat = np.abs(phi).max(axis=-1) <= BESIDE_SINGULAR
    return np.where(flat | unclear, 0, np.sign(total)).astype(int)


def flat_bound(problem: PatternProblem) -> tuple[float, str]:
    """Return what paths between the sides of the flat state climb to at least, and why; nan: nothing parts them."""
    vertices, pattern = problem.pattern.vertices, problem.pattern
    if not problem.contact or len(vertices) != 1 or len(vertices[0].creases) != pattern.creases:
        return math.nan, SHOWN
    paper = angle_sums(pattern)[vertices[0].vertex] - 2 * math.pi
    if paper > INPUT_TOL:
        return math.nan, SHOWN
    if paper < -INPUT_TOL:
        return math.inf, NEVER
    flat = np.zeros(problem.size)
    if not problem.fold_limits.inside(flat).all():
        return math.inf, STOPPED
    return float(problem.energy(flat)), PROVED


def bounded(p: Pass, result: MinimaResult, flat: tuple[float, str], level: float) -> Pass:
    """Add what bounds a pass from below.

    flat: see `flat_bound`.  level: energies that are no more apart are the same.
    """
    one, two = (result.minima[k - 1] for k in p.pair)
    if not (len(p.path) or (one.local_dimension and two.local_dimension)):
        return replace(p, known=Known.EXACT, why=RIGID)
    least, why = flat
    across = side_of_flat(np.array(one.fold_angles)) * side_of_flat(np.array(two.fold_angles)) < 0
    if math.isnan(least) or not across or p.known is Known.EXACT:
        return p
    exact = {"known": Known.EXACT, "why": why} if p.energy <= least + level else {}
    return replace(p, least=least, **exact)  # type: ignore[arg-type]
