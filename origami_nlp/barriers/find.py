"""Barriers: for each pair of minima the lowest pass between them that is known, and a path through it.

With one degree of freedom along traced curves (`traced`), of a vertex with more along descents (`descents`), of a
pattern along curves and paths over any height (`patterns`); Newton on the KKT system makes the top of a path an exact
pass where it is a saddle (`passes`).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

from origami_nlp.arguments import (
    check_callback,
    check_type,
    check_until,
    check_whole,
    refuse,
)
from origami_nlp.barriers.descents import descent_barriers
from origami_nlp.barriers.patterns import pattern_barriers
from origami_nlp.barriers.result import Barriers
from origami_nlp.barriers.traced import vertex_barriers
from origami_nlp.errors import OptionError
from origami_nlp.minima import MinimaResult, find_minima
from origami_nlp.pattern import Scene, Stated, as_origami
from origami_nlp.pattern_states import find_states
from origami_nlp.problem import Model

_OF_A_PATTERN = dict.fromkeys(("seconds", "progress"), "barriers of a vertex take seconds")
"""What a pattern alone takes, and why."""
SEARCHING = 0.5
"""Share of a time limit that the search for minima gets."""


def find_barriers(
    origami: Stated,
    result: MinimaResult | None = None,
    *,
    seed: int = 0,
    seconds: float | None = None,
    progress: Callable[[str], object] | None = None,
) -> Barriers:
    """Find the lowest pass between every two minima of a vertex or of a pattern.

    Of a pattern paths go along traced curves and, with contact, over any height.  With one degree of freedom passes are
    those of all curves of closed states, exactly.  Of a vertex they join states that wind once round the axis, or
    `Scene.winding` times: no path within the symmetry leads to others.  With two or more degrees of freedom they are
    upper bounds by paths that descents show, and exact where the flat state parts two minima and a path climbs no
    higher.

    Parameters
    ----------
    origami
        A scene or a pattern, as `find_minima` takes it.
    result
        Its minima, of `find_minima`; found here if not given.
    seed
        Of the search for minima.
    seconds
        Of a pattern, wall time: what was found by then is returned, and what was left out named.  None: the search for
        minima takes 300 s at most.
    progress
        Of a pattern, called with what it is at.

    Returns
    -------
    Barriers
        A pass for every pair and the merge tree; its `result` has the escape barriers that follow.

    Raises
    ------
    OptionError
        If a scene has dead loads or no degree of freedom, facets of a pattern may cross and no curve of it is known,
        or an argument is not what it must be.

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
    scene = as_origami(origami)
    check_whole("seed", seed, 0)
    if not isinstance(scene, Scene):
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
    if result is None:
        result = find_minima(scene.of_one_winding, prove=False, escape=False, seed=seed)
    # no path within the symmetry leads from one winding to another
    here = tuple(m for m in result.minima if m.winding == model.structure.winding)
    if len(here) < len(result.minima):
        result = replace(result, minima=here)
    return vertex_barriers(model, result) if model.dof == 1 else descent_barriers(model, result)


def _in_words(progress: Callable[[str], object] | None) -> Callable[[int, int, str], object] | None:
    """Return what a search calls, in words."""
    if progress is None:
        return None
    return lambda starts, minima, at: progress(f"{starts} starts, {minima} minima, {at}")


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
