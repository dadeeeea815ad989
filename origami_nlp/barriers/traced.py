"""Barriers where one degree of freedom is left: passes along all curves of closed states, of a vertex or of a pattern.

With one degree of freedom a motion follows its curve, and leaves it at states where curves meet alone: the merge tree
of the curves, cut where the energy is stationary, holds the lowest pass between every two states on them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from origami_nlp.barriers.passes import EVERY, FOLLOWED, Pass, PassKind, critical_near
from origami_nlp.barriers.result import Barriers, Join
from origami_nlp.errors import OptionError, OutOfTime
from origami_nlp.kkt import State, energy_scale, level_of, project
from origami_nlp.minima import MinimaResult, TracedPasses, trace, traced_passes
from origami_nlp.numerics import CLOSURE_TOL, NEAR_SINGULAR_TOL, SAME_ENERGY, SETTLED
from origami_nlp.pattern_states import curve_passes

APART = 0.2
"""Length of a step of a path [rad]."""
ASIDE = 0.9
"""The projected middle of a step is nearer to both ends than this share of its length."""
EXPLICIT = (
    "the lowest path that is known, on traced curves, straight, or over a saddle: an upper bound; contact may be "
    "missed between its states, and lower ones are not excluded"
)
"""That nothing bounds a barrier from below."""


def vertex_barriers(model: Any, result: MinimaResult) -> Barriers:
    """Return the barriers of a vertex with one degree of freedom.

    Raises
    ------
    OptionError
        If its curves could not be resolved.
    """
    states = np.array([model.reduce(np.array(m.fold_angles)) for m in result.minima])
    states = states.reshape(-1, model.size)
    energies = np.array([m.energy for m in result.minima])
    curves = trace(model)
    found = None
    if curves.complete and model.has_limits:
        found = traced_passes(model, curves.curves, curves.branches, states, energies)
    if found is None:
        raise OptionError(
            "the curves of the one degree of freedom could not be resolved: passes may be missing"
        )
    return passes_over(model, result, found, 1.0, lambda i, j, height: EVERY)


def pattern_passes(result: MinimaResult) -> tuple[Barriers, TracedPasses] | None:
    """Return the barriers of a pattern on its traced curves, and these curves; None where none are known."""
    problem, states = result.model, np.array([m.fold_angles for m in result.minima])
    traced = curve_passes(problem, result.curves, states) if len(states) else None
    if traced is None:
        return None
    scale = energy_scale(result.pattern.stiffness)
    level = level_of(problem.energies(states), scale) / problem.scale

    def why(i: int, j: int, height: float) -> str:
        if result.minima[i].dof > 1:
            return EXPLICIT
        sure = traced.sure.tree.barrier(i, j)
        known = sure is not None and sure.height <= height + level
        # over states at which other curves may leave, no more is known than that energy
        return FOLLOWED if known and traced.least(i, [j], level) >= height - level else EXPLICIT

    return passes_over(problem, result, traced.passes, problem.scale, why), traced.passes


def passes_over(
    problem: Any,
    result: Any,
    found: TracedPasses,
    unit: float,
    why: Callable[[int, int, float], str],
    otherwise: PassKind = "corner",
) -> Barriers:
    """Return the passes over a graph of states; unit: of their energies; otherwise: regular tops that are no saddle."""
    many, known = len(result.minima), _Steps()
    passes = tuple(
        _between(problem, found, unit, i, j, why, otherwise, known)
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


_Steps = dict[bytes, np.ndarray]


def _filled(problem: Any, states: np.ndarray, known: _Steps) -> np.ndarray:
    """Add states between those of a path that are further apart than `APART`; admissible as the stretch is.

    known: what was added between two states, which many paths pass, both ways.
    """
    out = [states[:1]]
    for k, (a, b) in enumerate(itertools.pairwise(states)):
        key = a.tobytes() + b.tobytes()
        if key not in known:
            try:
                known[key] = _filled_step(problem, a, b)
            except OutOfTime:
                return np.concatenate([*out, states[k + 1 :]])
            known[b.tobytes() + a.tobytes()] = np.concatenate([known[key][-2::-1], a[None]])
        out.append(known[key])
    return np.concatenate(out)


def _filled_step(problem: Any, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return states between two and the second, [S, n], as `_filled`."""
    size = float(np.linalg.norm(problem.root * (b - a)))
    if size <= APART:
        return b[None]
    middle, residual = project(problem, (a + b) / 2)
    longer = max(float(np.linalg.norm(problem.root * (middle - end))) for end in (a, b))
    # a projection that goes far aside has come to another curve
    if residual > CLOSURE_TOL or not longer < ASIDE * size:
        return b[None]
    return np.concatenate([_filled_step(problem, *ends) for ends in ((a, middle), (middle, b))])


def _between(
    problem: Any,
    found: TracedPasses,
    unit: float,
    i: int,
    j: int,
    why: Callable[[int, int, float], str],
    otherwise: PassKind,
    known: _Steps,
) -> Pass:
    """Return the pass between minima i and j (0-based) with its path."""
    merge = found.tree.barrier(i, j)
    if merge is None:
        none = np.zeros((0, len(problem.expand(found.states[0]))))
        every = why(i, j, math.inf) == EVERY
        words = "no curve leads from one to the other" if every else "no admissible path is known"
        return Pass(i + 1, j + 1, math.inf, "none", (), (), math.nan, none, none[:, 0], words)
    top, first = found.top(i, j), len(found.states) - len(found.on_curves)
    try:
        at, kind, residual = _made_exact(problem, top, otherwise)
        closed = tuple(problem.name(c) for c in at.pieces[0])
    except OutOfTime:
        at, kind, residual, closed = State(problem, top), "bound", math.nan, ()
    height = float(merge.height * unit)
    if otherwise == "bound" and kind == "bound" and height <= at.energy + SAME_ENERGY * unit:
        kind = "singular"  # a state from which ways go down to both sides: none was cut
    way = found.tree.path(first + i, first + j)
    assert way is not None
    states = _filled(problem, found.states[way[0]], known)
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
        why(i, j, merge.height),
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
