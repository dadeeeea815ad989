"""Graphs of states that paths pass: traced curves and explicit ways, their merge tree, and the passes between minima.

Ways, and curves where some are traced, meet at minima and at states from which several go down; the merge tree of this
graph has the lowest pass that they show between every two minima.  With one degree of freedom a motion follows its
curve, and leaves it at states where curves meet alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.barriers.bounds import FOLLOWED, NONE, SHOWN
from origami_nlp.barriers.passes import Known, Pass, PassKind, critical_near
from origami_nlp.barriers.result import Barriers, Join
from origami_nlp.errors import OutOfTime
from origami_nlp.escapes import energy_scale, level_of
from origami_nlp.kkt import State
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import NEAR_SINGULAR_TOL, SETTLED, merge_tree
from origami_nlp.pattern_states import TracedPasses, curve_passes


class PathDown(NamedTuple):
    """Closed admissible states [S, n] that end at a minimum.

    to: its number (from 0).  start: number of the minimum that it begins at; -1 for another state, from which other
    ways may begin.  energy: what it does not climb above [the problem's units]; nan where its highest state is exact.
    """

    states: np.ndarray
    to: int
    start: int = -1
    energy: float = math.nan


def graph_of(
    problem: Any, minima: np.ndarray, ways: Sequence[PathDown], traced: TracedPasses | None
) -> tuple[TracedPasses, np.ndarray]:
    """Join ways, and curves where some are traced, to a graph, and say which of its states are but on a way, [V].

    Parameters
    ----------
    problem
        Whose states they are.
    minima
        In the problem's variables, [M, n].
    ways
        Paths to them.
    traced
        Curves; their minima are these.
    """
    many, tops = len(minima), list[np.ndarray]()
    first = 0 if traced is None else len(traced.states) - many
    at = []
    for way in ways:
        if way.start >= 0:
            at.append(-1)
            continue
        same = (k for k, x in enumerate(tops) if np.abs(x - way.states[0]).max() == 0)
        at.append(next(same, len(tops)))
        if at[-1] == len(tops):
            tops.append(way.states[0])
    shift = len(tops) + sum(len(way.states) - 2 for way in ways)
    states = [np.zeros((0, problem.size)), np.array(tops).reshape(-1, problem.size)]
    edges: list[np.ndarray] = []
    if traced is not None:
        states[0] = traced.states[:first]
        # minima are last
        edges.append(np.where(traced.edges >= first, traced.edges + shift, traced.edges))
    begin, known = first + len(tops), list[tuple[int, float]]()
    for top, way in zip(at, ways, strict=True):
        inner = way.states[1:-1]
        numbers = [
            first + top if way.start < 0 else first + shift + way.start,
            *range(begin, begin + len(inner)),
            first + shift + way.to,
        ]
        edges.append(np.column_stack([numbers[:-1], numbers[1:]]))
        if not math.isnan(way.energy):
            highest = int(problem.energies(way.states).argmax())
            known.append((numbers[highest], way.energy / problem.scale))
        states.append(inner)
        begin += len(inner)
    nodes = np.concatenate([*states, minima])
    energies = problem.energies(nodes) / problem.scale
    joined = np.concatenate(edges).astype(int) if edges else np.zeros((0, 2), int)
    heights = energies[joined].max(axis=1) if len(joined) else np.zeros(0)
    for node, height in known:
        over = (joined == node).any(axis=1)
        heights[over] = np.maximum(heights[over], height)
    leaves = list(range(len(nodes) - many, len(nodes)))
    tree = merge_tree(energies, joined, heights, leaves)
    cut = (np.arange(len(nodes)) >= first + len(tops)) & (np.arange(len(nodes)) < leaves[0])
    return TracedPasses(tree, nodes, energies, joined, np.isin(leaves, joined)), cut


def passes_over(
    problem: Any,
    result: MinimaResult,
    found: TracedPasses,
    unit: float,
    why: Callable[[int, int, float], str] = lambda *_: "",
    cut: np.ndarray | None = None,
) -> Barriers:
    """Return the passes over a graph of states.

    unit: of its energies.  why: why there is no lower path between two minima than one of some energy; "" where there
    may be.  cut: which states are but somewhere on a way, [V].
    """
    many = len(result.minima)
    cut = np.zeros(len(found.states), bool) if cut is None else cut
    passes = tuple(
        _between(problem, found, unit, i, j, why, cut)
        for i in range(many)
        for j in range(i + 1, many)
    )
    kinds = {(p.from_state - 1, p.to_state - 1): p for p in passes}
    merges = []
    for merge in found.tree.merges:
        one = kinds[min(merge.first[0], merge.second[0]), max(merge.first[0], merge.second[0])]
        sides = (tuple(k + 1 for k in side) for side in (merge.first, merge.second))
        merges.append(Join(one.energy, one.pass_kind, *sides))
    return Barriers(result, passes, tuple(merges))


def _between(
    problem: Any,
    found: TracedPasses,
    unit: float,
    i: int,
    j: int,
    why: Callable[[int, int, float], str],
    cut: np.ndarray,
) -> Pass:
    """Return the pass between minima i and j (0-based) with its path."""
    merge = found.tree.barrier(i, j)
    reason = why(i, j, math.inf if merge is None else merge.height)
    known = Known.EXACT if reason else Known.BOUND
    if merge is None:
        none = np.zeros((0, len(problem.expand(found.states[0]))))
        reason = "no curve leads from one to the other" if reason else NONE
        return Pass(
            i + 1, j + 1, math.inf, "none", (), (), math.nan, none, none[:, 0], reason, known
        )
    ends = found.edges[merge.edge]
    node = int(ends[found.energies[ends].argmax()])
    top, first = found.states[node], len(found.states) - len(found.on_curves)
    try:
        at, kind, residual = _made_exact(problem, top, "bound" if cut[node] else "corner")
        closed = tuple(problem.name(c) for c in at.pieces[0])
    except OutOfTime:
        at, kind, residual, closed = State(problem, top), "bound", math.nan, ()
    height = float(merge.height * unit)
    way = found.tree.path(first + i, first + j)
    assert way is not None
    states = found.states[way[0]]
    energies = problem.energies(states)
    return Pass(
        i + 1,
        j + 1,
        height if kind == "bound" else at.energy,
        kind,
        tuple(problem.expand(at.x).tolist()),
        closed,
        residual,
        problem.expand(states),
        energies,
        reason or SHOWN,
        known,
        bool(reason),
    )


def _made_exact(
    problem: Any, top: np.ndarray, otherwise: PassKind
) -> tuple[State, PassKind, float]:
    """Return the state of a pass near the top of a path [n], its kind (`otherwise`: no saddle) and its residual."""
    exact = critical_near(problem, top[None], NEAR_SINGULAR_TOL)
    if exact:
        return State(problem, exact[0].x), exact[0].kind, exact[0].residual  # type: ignore[return-value]
    at = State(problem, top)
    if at.regular:
        return at, otherwise, math.nan
    return at, "flat state" if np.abs(top).max() <= SETTLED else "singular", math.nan


def pattern_passes(result: MinimaResult) -> tuple[Barriers, TracedPasses] | None:
    """Return the barriers of a pattern on its traced curves, and these curves; None where none are known."""
    problem = result.model
    states = np.array([problem.reduce(m.phi) for m in result.minima])
    traced = curve_passes(problem, result.curves, states) if len(states) else None
    if traced is None:
        return None
    scale = energy_scale(problem.pattern.stiffness)
    level = level_of(problem.energies(states), scale) / problem.scale

    def why(i: int, j: int, height: float) -> str:
        if result.minima[i].dof > 1:
            return ""
        sure = traced.sure.tree.barrier(i, j)
        known = sure is not None and sure.height <= height + level
        # over states at which other curves may leave, no more is known than that energy
        return FOLLOWED if known and traced.least(i, [j], level) >= height - level else ""

    return passes_over(problem, result, traced.passes, problem.scale, why), traced.passes
