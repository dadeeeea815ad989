"""The passes between minima that a graph of traced curves and explicit ways shows, and what bounds them from below.

With one degree of freedom a motion follows its curve, and leaves it at states where curves meet alone.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from origami_nlp.barriers.passes import Known, Pass, PassKind, critical_near
from origami_nlp.barriers.result import Barriers, Join
from origami_nlp.errors import OutOfTime
from origami_nlp.kkt import State
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import (
    BESIDE_SINGULAR,
    DUPLICATE_TOL,
    INPUT_TOL,
    NEAR_SINGULAR_TOL,
    SETTLED,
)
from origami_nlp.pattern_problem import PatternProblem, angle_sums
from origami_nlp.pattern_states import PassGraph

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
