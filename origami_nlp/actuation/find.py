"""Actuate a vertex or a pattern: torques on creases, from the flat state or from another, one load after the other."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np

from origami_nlp.actuation.branches import driven_alone, driven_by_signs, released
from origami_nlp.actuation.cones import FlatMotion
from origami_nlp.actuation.driving import DrivenSet
from origami_nlp.actuation.result import Actuation, FlatBranch
from origami_nlp.actuation.transitions import TransitionGraph
from origami_nlp.arguments import check_flag, check_number, check_until, check_whole, shown
from origami_nlp.errors import OptionError, OutOfTime
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import CONTACT_TOL
from origami_nlp.pattern import Pattern, Scene, as_origami, scene_pattern
from origami_nlp.pattern_states import find_states

Torques = Mapping[int, float | str]
SIGNS = {"+": 1, "-": -1}
"""Torques of which only the sign is stated."""
MOST_DRIVEN = 12
"""Branches for which the fewest driven creases are looked for."""


def actuate(
    origami: Scene | Pattern | str | PathLike[str],
    torques: Torques | Sequence[Torques] | None = None,
    *,
    start: str | int | JudgedState = "flat",
    relaxed: bool = False,
    effort: str = "normal",
    seed: int = 0,
    seconds: float | None = None,
) -> Actuation:
    """Put torques on creases: which states are reached, is the fold unique, and which few creases would make it so.

    From the flat state a sheet goes along a branch if torques and springs work on it to first order.  The fold is
    unique if they do so on exactly one branch, of one degree of freedom (Tachi and Hull, 2017).  What is reached is the
    first minimum along each branch that is started, the torques constant.

    Parameters
    ----------
    origami
        A scene or a pattern, as `find_minima` takes it; facets may not cross, and no symmetry is imposed.
    torques
        On creases by their numbers (1-based) [N m], towards valley > 0; several of these: loads that are put on and
        taken off one after the other.  None: branches of the flat state, and the fewest creases that start one alone.
        Signs alone, "+" or "-" on each crease: which branches torques of some sizes start alone (`relaxed` only).
    start
        ``"flat"``; a stable state without torques: its number (1-based), by energy, or itself; ``"all"``: all of them,
        with the graph of where each load leads from each.
    relaxed
        Whether springs are at rest in the flat state, whatever rest angles are stated: what torques do by themselves.
    effort, seed
        Of the search for stable states, see `find_minima`.
    seconds
        Wall time, to a second or two; what was left out is named.  None: no limit.

    Returns
    -------
    Actuation
        Branches, states and transitions.

    Raises
    ------
    OptionError
        If an argument is not what it must be, or there is no such stable state.

    Examples
    --------
    One Miura vertex is folded uniquely by torques on creases 2 and 3; no torques do so with a sheet of four:

    >>> import origami_nlp as o
    >>> o.actuate("miura:2x2", {2: 0.01, 3: 0.01}, relaxed=True).unique, o.actuate("miura:3x3").can_be_unique
    (True, False)
    """
    until, pattern = check_until(seconds), _sheet(origami)
    check_flag("relaxed", relaxed)
    if relaxed:
        pattern = pattern.with_springs(pattern.stiffness.tolist(), 0.0)
    signs = _signs(pattern, torques, relaxed)
    given = [torques] if isinstance(torques, Mapping) else torques or ()
    loads = () if signs else tuple(_load(pattern, t) for t in given)
    if signs and start != "flat":
        raise OptionError("torques: signs alone act on the flat state, start = 'flat'")
    if not loads and start != "flat":
        raise OptionError("torques is missing: say what is to act on that state, {crease: torque}")
    if isinstance(start, str) and start not in ("flat", "all"):
        raise OptionError(f"start = {shown(start)} must be 'flat', 'all', or a stable state")
    graph, left_out = TransitionGraph(pattern, loads, until), list[str]()
    branches, reached, driven, reason = (
        list[FlatBranch](),
        list[JudgedState](),
        list[DrivenSet](),
        "",
    )
    if start == "flat" or start == "all":
        if not pattern.is_flat and start == "flat":
            raise OptionError(
                "start = 'flat': the sheet cannot lie flat; give the number of a stable state"
            )
        low, high = pattern.limit_angles
        beyond = np.flatnonzero((low > CONTACT_TOL) | (high < -CONTACT_TOL))
        if len(beyond) and start == "flat":
            raise OptionError(
                f"start = 'flat': the flat state is beyond the stop of crease {beyond[0] + 1}; give the number of a "
                "stable state"
            )
        if pattern.is_flat and not len(beyond):
            try:
                found, reason = graph.flat
                if loads and start == "flat":
                    branches, reached = graph.released(1)
                else:
                    none = np.zeros(pattern.creases)
                    branches, reached = released(pattern, none, found, until, release=False)
                driven = _driven_sets(found, branches, signs)
            except OutOfTime:
                left_out.append(
                    "seconds: the time was over before branches of the flat state were followed"
                )
                reason = reason or "the time was over"
    if start != "flat" or len(loads) > 1:
        _go(graph, start, {"effort": effort, "seed": seed})
    return Actuation(
        pattern, loads, tuple(branches), tuple(reached), tuple(driven),
        tuple(graph.states), tuple(graph.found), tuple(graph.walk), reason, (*left_out, *graph.left_out),
        signs,
    )  # fmt: skip


def _go(graph: TransitionGraph, start: Any, asked: dict[str, Any]) -> None:
    """Apply loads: one after the other from one state, or each from all."""
    if start == "flat":
        graph.go(0)
        return
    number = 1
    if isinstance(start, JudgedState):
        graph.states = [start]
    else:
        limit: dict[str, Any] = (
            {} if graph.until == math.inf else {"seconds": max(graph.until - time.monotonic(), 0.0)}
        )
        found = find_states(graph.pattern, escape=False, prove=False, **asked, **limit).minima
        graph.states = [m for m in found if np.any(m.phi)]
        if start == "all":
            graph.all(len(graph.states) < len(found))
            return
        if not found:
            raise OptionError("no stable state was found without torques")
        chosen = found[check_whole("start", start, 1, len(found)) - 1]
        number = 1 + graph.states.index(chosen) if np.any(chosen.phi) else 0
    graph.go(number)


def _sheet(origami: Any) -> Pattern:
    stated = as_origami(origami)
    if isinstance(stated, Scene):
        if stated.contact != "full":
            raise OptionError(
                f"contact = {stated.contact!r} of the scene must be 'full': facets are not to cross"
            )
        stated = replace(scene_pattern(stated), name=stated.title)
    stated.check_alone("actuation")
    return stated


def _load(pattern: Pattern, torques: Any) -> np.ndarray:
    if not isinstance(torques, Mapping) or not torques:
        raise OptionError(
            f"torques = {shown(torques)} must be {{crease: torque}}, or several of these"
        )
    out = np.zeros(pattern.creases)
    for crease, torque in torques.items():
        out[check_whole("crease", crease, 1, pattern.creases) - 1] = check_number(
            f"torque on crease {crease}", torque
        )
    if not out.any():
        raise OptionError("torques: all of them are 0")
    return out


def _signs(pattern: Pattern, torques: Any, relaxed: bool) -> tuple[int, ...]:
    """Return the signs of torques on all creases; none where sizes are stated, or nothing is."""
    if not isinstance(torques, Mapping) or not any(isinstance(t, str) for t in torques.values()):
        return ()
    if not all(isinstance(t, str) and t in SIGNS for t in torques.values()):
        raise OptionError(
            f"torques = {shown(torques)} must be numbers, or '+' or '-' on each crease"
        )
    if not relaxed and pattern.rest.any():
        raise OptionError(
            "torques: beside springs that work signs alone say nothing: springs at rest when flat (relaxed)"
        )
    out = [0] * pattern.creases
    for crease, sign in torques.items():
        out[check_whole("crease", crease, 1, pattern.creases) - 1] = SIGNS[sign]
    return tuple(out)


def _driven_sets(
    found: Sequence[FlatMotion], branches: Sequence[FlatBranch], signs: Sequence[int]
) -> list[DrivenSet]:
    """Find the fewest creases that start a branch alone, of those that are started first; or sizes of torques."""
    if signs:
        return driven_by_signs(found, signs)
    order = sorted(range(len(found)), key=lambda k: branches[k].work <= 0)
    some = [
        driven_alone(found, k) for k in [k for k in order if branches[k].drivable][:MOST_DRIVEN]
    ]
    return sorted((d for d in some if d is not None), key=lambda d: d.branch)
