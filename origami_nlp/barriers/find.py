"""Barriers: for each pair of minima the lowest pass between them, and a path through it.

A graph of admissible states (`graph`) and its merge tree (`merge_tree`) say where sublevel
sets of the energy first meet; Newton on the KKT system makes the top of each lowest path an exact pass
(`passes`, `refine`).  `full` looks at the same pairs without the symmetry.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np

from origami_nlp.arguments import (
    check_callback,
    check_flag,
    check_number,
    check_type,
    check_until,
    check_whole,
    refuse,
)
from origami_nlp.barriers.descents import descent_barriers
from origami_nlp.barriers.full import Exits, FullPass, full_pass
from origami_nlp.barriers.graph import side_of_flat
from origami_nlp.barriers.passes import PROVED, Pass, critical_at, slide
from origami_nlp.barriers.refine import RefinedGraph
from origami_nlp.barriers.result import Barriers, Join, Unlisted
from origami_nlp.barriers.signs import pattern_barriers
from origami_nlp.barriers.traced import vertex_barriers
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State
from origami_nlp.minima import MinimaResult, find_minima, judge_in_full_space, with_merge_tree
from origami_nlp.numerics import MergeTree
from origami_nlp.pattern import Pattern, Scene, as_origami
from origami_nlp.pattern_states import find_states
from origami_nlp.problem import Model

SPACINGS = (0.02, 0.5)
"""Smallest and largest spacing of a mesh [rad]."""

MOST_UNLISTED = 3
"""Basins of the graph that are followed downhill."""
_OF_TWO = {
    "full": "states of one degree of freedom have passes on their curves alone",
    "spacing": "curves are traced, there is no lattice",
}
_OF_MORE = dict.fromkeys(("full", "spacing"), "with two a graph of states takes it")
"""What a graph of states takes alone, and why."""
_OF_A_PATTERN = dict.fromkeys(
    ("seconds", "progress"), "the graph of two degrees of freedom takes seconds"
)
"""What a pattern alone takes, and why."""
SEARCHING = 0.5
"""Share of a time limit that the search for minima gets."""
PER_WELL = 4
"""States of a graph between two extremes of a law's torque, as far as its least spacing allows."""
SPACING = 0.12
"""Lattice of the graph [rad]."""


def find_barriers(
    origami: Scene | Pattern | str | PathLike[str],
    result: MinimaResult | None = None,
    *,
    full: bool | None = None,
    spacing: float | None = None,
    seed: int = 0,
    seconds: float | None = None,
    progress: Callable[[str], object] | None = None,
) -> Barriers:
    """Find the lowest pass between every two minima of a vertex or of a pattern.

    Of a pattern paths go along traced curves, and through states with a vertex flat: where two minima differ in the
    sign of a vertex (`MinimaResult.signs`), every path passes one, which bounds the barrier from below.
    With one degree of freedom passes are those of all curves of closed states, exactly.  Of a vertex they join states
    that wind once round the axis, or `Scene.winding` times: no path within the symmetry leads to others.  With three or
    more degrees of freedom they are upper bounds by paths that descents show, and exact where the flat state parts two
    minima, or a thin set is left, and a path climbs no higher.

    Parameters
    ----------
    origami
        A scene or a pattern, as `find_minima` takes it.
    result
        Its minima, of `find_minima`; found here if not given.
    full
        Of two degrees of freedom: also look for lower passes that break the symmetry.
    spacing
        Of two degrees of freedom: lattice of the graph of states [rad]; None: 0.12.
    seed
        Of the search for minima and for thin sets.
    seconds
        Of a pattern, wall time: what was found by then is returned, and what was left out named.  None: the search for
        minima takes 300 s at most, the one with each vertex flat 60 s.
    progress
        Of a pattern, called with what it is at.

    Returns
    -------
    Barriers
        A pass for every pair, the merge tree and the graph; its `result` has the escape barriers that follow.

    Raises
    ------
    OptionError
        If a scene has dead loads or no degree of freedom, neither a curve nor a vertex with a sign is known of a
        pattern, or an argument is not what it must be.

    Examples
    --------
    >>> import origami_nlp as o
    >>> scene = o.examples.degree6("pi/4", ratio=0.01)
    >>> found = o.find_barriers(scene, o.find_minima(scene, max_starts=16), spacing=0.5)
    >>> [(p.from_state, p.to_state, p.pass_kind) for p in found.passes]
    [(1, 2, 'flat state')]
    """
    until = check_until(seconds)
    check_callback("progress", progress)
    scene = as_origami(origami)
    if full is not None:
        check_flag("full", full)
    if spacing is not None:
        check_number("spacing", spacing, *SPACINGS)
    check_whole("seed", seed, 0)
    if not isinstance(scene, Scene):
        refuse("pattern", _OF_TWO, full=full, spacing=spacing)
        if result is None:
            left = None if seconds is None else SEARCHING * max(until - time.monotonic(), 0.0)
            result = find_states(
                scene, seed=seed, escape=False, seconds=left, progress=_in_words(progress)
            )
        check_type("result", result, MinimaResult)
        return pattern_barriers(result, until, progress)
    refuse("vertex", _OF_A_PATTERN, seconds=seconds, progress=progress)
    scene.check_no_forces("barriers")
    if result is not None:
        check_type("result", result, MinimaResult)
    check_dof(scene)
    model = Model(scene)
    if model.dof != 2:
        number, reasons = f"{model.dof} degrees", _OF_MORE
        if model.dof == 1:
            number, reasons = "one degree", _OF_TWO
        refuse(f"vertex of {number} of freedom", reasons, full=full or None, spacing=spacing)
    found: Any = result
    if found is None:
        found = find_minima(
            scene.of_one_winding, seed=seed, full=bool(full), prove=False, escape=False
        )
    return _of_vertex(scene, model, found, bool(full), spacing or _spacing(scene), seed)


def _spacing(scene: Scene) -> float:
    """Return a spacing in which no well of a hinge law is lost."""
    finest = min((law.finest for law in scene.laws if law is not None), default=math.inf)
    return min(SPACING, max(SPACINGS[0], finest / PER_WELL))


def _in_words(progress: Callable[[str], object] | None) -> Callable[[int, int, str], object] | None:
    """Return what a search calls, in words."""
    if progress is None:
        return None
    return lambda starts, minima, at: progress(f"{starts} starts, {minima} minima, {at}")


def _of_vertex(
    scene: Scene, model: Model, result: MinimaResult, full: bool, spacing: float, seed: int
) -> Barriers:
    """Find the barriers of a vertex."""
    # no path within the symmetry leads from one winding to another
    here = tuple(m for m in result.minima if m.winding == model.structure.winding)
    if len(here) < len(result.minima):
        result = replace(result, minima=here)
    if model.dof == 1:
        return vertex_barriers(model, result)
    if model.dof > 2:
        return descent_barriers(model, result)
    work = RefinedGraph(
        model, [model.reduce(np.array(m.fold_angles)) for m in result.minima], spacing, seed
    )
    tree = work.refine()
    passes = tuple(
        _pass_between(work, tree, i, j)
        for i in range(len(work.minima))
        for j in range(i + 1, len(work.minima))
    )
    merges = tuple(
        Join(
            m.height, work.kind_of(m), tuple(k + 1 for k in m.first), tuple(k + 1 for k in m.second)
        )
        for m in tree.merges
    )
    unlisted: list[Unlisted] = []
    for life, v in tree.others:
        if len(unlisted) == MOST_UNLISTED:
            break
        if model.refuses(work.graph.states[v]):
            continue  # a touching state without a layer order: the graph does not ask for one
        down = slide(model, work.graph.states[v], work.minima)
        lands = down.lands_on + 1 if down is not None and down.lands_on is not None else None
        unlisted.append(Unlisted(life, tuple(model.expand(work.graph.states[v]).tolist()), lands))
    broken = _without_symmetry(scene, result, passes) if full else ()
    heights = np.full((len(work.minima),) * 2, math.inf)
    for p in passes:
        heights[p.from_state - 1, p.to_state - 1] = p.energy
    why = f"the lowest pass of a graph of states {spacing:g} rad apart, made exact"
    result = replace(result, minima=tuple(with_merge_tree(model, result.minima, heights, why)))
    return Barriers(result, passes, merges, work.graph, tuple(unlisted), broken)


def check_dof(scene: Scene) -> None:
    """Raise an error for a scene that no symmetric motion folds.

    Raises
    ------
    OptionError
        With the number of degrees of freedom it has.
    """
    dof = Model(scene).dof
    if dof < 1:
        raise OptionError(
            f"[model] symmetry = {scene.symmetry!r} leaves {dof} degrees of freedom; barriers need one: "
            "state another symmetry"
        )


def _without_symmetry(
    scene: Scene, result: MinimaResult, passes: tuple[Pass, ...]
) -> tuple[FullPass, ...]:
    """Bound the barriers of the pairs whose ends are stable in the full space."""
    verdicts = [
        m.full_space or judge_in_full_space(scene, np.array(m.fold_angles)) for m in result.minima
    ]
    known: dict[int, Exits] = {}
    others = [np.array(p.fold_angles) for p in passes if p.fold_angles]
    out = []
    for p in passes:
        pair = (p.from_state, p.to_state)
        if all(verdicts[k - 1].verdict == "stable" for k in pair) and len(p.path):
            states = [np.array(result.minima[k - 1].fold_angles) for k in pair]
            out.append(full_pass(scene, p, (states[0], states[1]), known, others))
    return tuple(out)


def _pass_between(work: RefinedGraph, tree: MergeTree, i: int, j: int) -> Pass:
    """Return the pass between minima i and j (0-based) with its path."""
    model, g = work.model, work.graph
    merge = tree.barrier(i, j)
    mesh = work.mesh.barrier(i, j)
    rough = mesh.height if mesh else math.inf
    if merge is None:
        none = np.empty((0, model.scene.degree))
        why = "no admissible path found: the minima lie in different components"
        return Pass(i + 1, j + 1, math.inf, "none", (), (), math.nan, none, none[:, 0], rough, why)
    v = work.top(merge)
    states = work.path(tree, merge, i, j)
    energy = float(g.energy[v]) if v in work.exact else merge.height
    x = g.states[v] if v in work.exact else states[int(model.energies(states).argmax())]
    kind = work.kind_of(merge)
    at = State(model, x)
    critical = critical_at(at) if kind not in ("mesh", "flat state", "singular") else None
    sides = side_of_flat(model.expand(np.array([work.minima[i], work.minima[j]])))
    # one minimum above the flat state, one below
    if kind == "flat state" and sides[0] * sides[1] < 0 and model.scene.contact == "full":
        why = PROVED
    elif work.only_exit(v, i, j):
        why = "one of the minima lies on a lower-dimensional set of states, which is left only here"
    else:
        why = f"no lower path on {len(g.states)} states, {work.spacing:g} rad apart"
    return Pass(
        i + 1,
        j + 1,
        energy,
        kind,
        tuple(model.expand(x).tolist()),
        tuple(model.name(row) for row in at.pieces[0]),
        critical.residual if critical else math.nan,
        model.expand(states),
        model.energies(states),
        rough,
        why,
    )
